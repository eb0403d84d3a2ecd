"""The formats, one file each; a format sees a mechanism and nothing else of a robot."""

from __future__ import annotations

from eurdf.exporting.formats import drake, loop_joint, mjcf, sdf, urdf, usd
from eurdf.exporting.written import Format

#: Every format, by name. A new one is a file here and its line.
FORMATS: dict[str, Format] = {
    each.name: each
    for each in (
        mjcf.FORMAT,
        usd.FORMAT,
        drake.FORMAT,
        loop_joint.FORMAT,
        sdf.FORMAT,
        urdf.FORMAT,
    )
}
