"""The formats to import from: one file a format."""

from __future__ import annotations

from eurdf.importing import drake, loop_joint, sdf, urdf_plus
from eurdf.importing.import_format import ImportFormat
from eurdf.importing.mjcf import read as mjcf

#: Every format, by its name.
FORMATS: dict[str, ImportFormat] = {each.FORMAT.name: each.FORMAT for each in (mjcf, sdf, loop_joint, drake, urdf_plus)}
