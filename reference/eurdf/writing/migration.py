"""From version 1 of the format to version 2, with the same model."""

from __future__ import annotations

from dataclasses import dataclass

from eurdf.diagnostics import Diagnostics
from eurdf.format.urdf.data import Urdf
from eurdf.format.urdf.elements import UrdfReader
from eurdf.format.urdf.mimics import check_mimics
from eurdf.linking.link import reread
from eurdf.linking.robot_files import ReadRobot
from eurdf.mechanism.mechanism import Mechanism
from eurdf.mechanism.same_model import differences, with_universal_joints
from eurdf.reading.xml_reader import XmlReporter
from eurdf.reading.yaml_node import json_pointer
from eurdf.writing.migrated_text import MigratedText, NotMigratable, own_keys


@dataclass(frozen=True, slots=True, repr=False)
class Migration:
    """A description in version 2: its text, what was done, one sentence each, and the mechanism that it describes."""

    text: str
    notes: tuple[str, ...]
    mechanism: Mechanism

    def __repr__(self) -> str:
        return f"<Migration to version {self.mechanism.version}: {self.mechanism!r}; {len(self.notes)} notes>"


def migrate(read: ReadRobot, urdf_path: str = "robot.urdf", schema: str | None = None) -> Migration:
    """Write a robot's description of version 1 in version 2; for the paths see `MigratedText`.

    What version 1 does by itself is said; user data and the comments are kept. The text is read once more, and only
    returned where it describes the same model.

    Raises:
        NotMigratable: Version 2 cannot say the same.
    """
    description, urdf, before = read.description, read.urdf, read.mechanism
    _refuse_wrong_mimics(urdf)
    migrated = MigratedText(description, urdf, merged_by_rule(read), urdf_path, schema)
    text = migrated.text()
    after, diagnostics = reread(text, urdf, description.document.source.file)
    if after is None:
        raise NotMigratable(f"version 2 does not allow it: {diagnostics.errors[0].message}", ())
    found = differences(before, after)
    own = {str(key): value for (key,), value in description.own_data.items()}
    expected = {json_pointer([name]): own[key] for key, name in own_keys(own).items()}
    if repr(expected) != repr(dict(after.own_data)):
        found.append("your own data differ")
    if found:
        raise NotMigratable(f"version 2 would not be the same model: {'; '.join(found)}", ())
    return Migration(text, (*migrated.notes, *_order(before, after)), after)


def _refuse_wrong_mimics(urdf: Urdf) -> None:
    """Refuse, by `NotMigratable`, mimic joints that are errors in version 2; version 1 ignores them (EU-ONE-009)."""
    diagnostics = Diagnostics()
    reporter = XmlReporter(urdf.document, diagnostics)
    check_mimics(UrdfReader(reporter, reporter), urdf.joints)
    if diagnostics.errors:
        found = diagnostics.errors[0]
        raise NotMigratable(
            f"{found.message}; version 1 ignores <mimic> and version 2 does not: remove it from the URDF (line "
            f"{found.line}) and migrate again, which changes nothing in version 1",
            (),
        )


def merged_by_rule(read: ReadRobot) -> dict[str, tuple[str, str, str]]:
    """For each spherical joint that version 1 made of three revolutes by itself, their names (EU-ONE-007)."""
    description, urdf, mechanism = read.description, read.urdf, read.mechanism
    listed = {entry.name for entry in description.joints}
    carrying = {joint.child: joint.name for joint in urdf.joints.values()}

    def chain(third: str) -> tuple[str, str, str]:
        second = carrying[urdf.joints[third].parent]
        return carrying[urdf.joints[second].parent], second, third

    return {
        joint.name: chain(joint.name) for joint in mechanism.joints if joint.type.is_ball and joint.name not in listed
    }


def _order(before: Mechanism, after: Mechanism) -> list[str]:
    """Velocities follow the names of joints: one name in place of two may take another place among its siblings."""
    names = [[joint.name for joint in mechanism.joints] for mechanism in (with_universal_joints(before), after)]
    if names[0] == names[1]:
        return []
    return ["the order of the joints, and so of coordinates and velocities, differs"]
