"""Mimic joints of the URDF to which the description gives a coordinate of their own."""

from __future__ import annotations

from collections.abc import Iterable

from eurdf.format.joint_model import Joint
from eurdf.format.urdf.data import Urdf
from eurdf.reading.reporter import YamlReporter


def freed_joints(entries: Iterable[Joint], urdf: Urdf, reporter: YamlReporter) -> set[str]:
    """EU-JNT-033, EU-JNT-034: the joints whose ``<mimic>`` has no effect, because their entry states ``mimic: false``.

    An entry that merges joints frees those of them that mimic.

    Args:
        entries: The entries of joints, as written.
        urdf: The URDF.
        reporter: Gets what is found.
    """
    freed: set[str] = set()
    for entry in entries:
        if entry.mimic is not False:
            continue
        named = entry.merges or (entry.name,)
        mimicking = {name for name in named if name in urdf.joints and urdf.joints[name].mimic}
        # An unknown joint is reported as such.
        if not mimicking and all(name in urdf.joints for name in named):
            what = f"joint '{entry.name}' mimics no other" if not entry.merges else "none of the merged joints is one"
            reporter.report(
                "joint-not-mimic",
                f"'mimic: false' frees a mimic joint, but {what}",
                (*entry.pointer, "mimic"),
                "remove 'mimic'",
            )
        freed |= mimicking
    return freed
