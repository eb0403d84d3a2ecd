"""The formats to import from: one file a format."""

from __future__ import annotations

from eurdf.importing.formats import drake, loop_joint, mjcf, sdf, urdf_plus
from eurdf.importing.robot_read import ImportFormat

#: Every format, by its name.
FORMATS: dict[str, ImportFormat] = {each.FORMAT.name: each.FORMAT for each in (mjcf, sdf, loop_joint, drake, urdf_plus)}
