"""From the names in a URDF to a description of it."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import replace

from eurdf.dataclass import dataclass
from eurdf.diagnostics import Diagnostics
from eurdf.format.own_key import is_own_key
from eurdf.format.urdf.data import Urdf
from eurdf.format.version import VERSION2_0, VERSION2_1
from eurdf.linking.merging import find_chains
from eurdf.linking.rereading import reread
from eurdf.linking.urdf_tree import joint_of
from eurdf.mechanism.mechanism import Mechanism, Root
from eurdf.writing.closure_choice import choose_types
from eurdf.writing.naming_conventions import (
    ClosureType,
    Conventions,
    Found,
    GeneratedVersion,
    find,
    version1_text,
    version2_text,
    with_type,
)
from eurdf.writing.revolute_mates import lowest_version, with_hinges


@dataclass(frozen=True, slots=True)
class Generation:
    """A description that was generated.

    Attributes:
        text: Of the YAML file.
        found: What the names say.
        merges: For each spherical joint made of three revolutes whose axes meet, their names.
        mechanism: That the text describes; None where the names say what cannot be.
        diagnostics: Found in the text.
        notes: Why closures have the types that they have, where their names do not say it; one sentence each.
    """

    text: str
    found: Found
    merges: Mapping[str, tuple[str, str, str]]
    mechanism: Mechanism | None
    diagnostics: Diagnostics
    notes: tuple[str, ...] = ()


def generate(
    urdf: Urdf,
    conventions: Conventions,
    version: GeneratedVersion | None = None,
    root: Root = "fixed",
    urdf_path: str = "robot.urdf",
    schema: str | None = None,
    closure_type: ClosureType | None = None,
) -> Generation:
    """Describe a robot by the names in its URDF.

    Three revolutes whose axes meet are merged as in version 1, unless one of them is a motor. The
    generated text is read back to check that it is valid.

    Args:
        urdf: The URDF.
        conventions: What its names mean.
        version: Version of the description; by default the lowest version 2 that suffices.
        root: Whether the root is fixed or floating; version 1 can only say fixed.
        urdf_path: Path of the URDF from the folder of the description; version 1 cannot say it.
        schema: Path of the schema from the folder of the description, for its first line; None for no such line.
        closure_type: Type of every closure; by default what their names say, and else what `choose_types` finds.
    """
    if version == "1" and root != "fixed":
        raise ValueError("version 1 cannot say that the root floats")
    if version is None:
        version = lowest_version(urdf, conventions) if closure_type is None else "2"
    found = find(urdf, conventions)
    if closure_type is not None:
        found = with_type(found, closure_type)
    hinged = with_hinges(found, urdf)
    if version == "2.1":
        found = hinged
    notes = _mate_notes(found, hinged)
    merges = _merges(urdf, found, version)

    def written(found: Found) -> tuple[str, Mechanism | None, Diagnostics]:
        if version == "1":
            text = version1_text(found, schema)
        else:
            text = version2_text(found, merges, root, urdf_path, schema, VERSION2_1 if version == "2.1" else VERSION2_0)
        return text, *reread(text, urdf, "the description")

    text, mechanism, diagnostics = written(found)
    undecided = [index for index, closure in enumerate(found.closures) if closure.type is None]
    if mechanism is not None and undecided:
        # Version 1 has no names of closures; their order is that of the file in both versions.
        names = {mechanism.closures[index].name: index for index in undecided}
        choice = choose_types(mechanism, names, [closure.name for closure in found.closures])
        closures = list(found.closures)
        for name, kind in choice.types.items():
            closures[names[name]] = replace(closures[names[name]], type=kind)
        found, notes = replace(found, closures=tuple(closures)), (*notes, *choice.notes)
        text, mechanism, diagnostics = written(found)
    return Generation(text, found, merges, mechanism, diagnostics, notes)


def _mate_notes(found: Found, hinged: Found) -> tuple[str, ...]:
    """What is said of revolute mates: that they are hinges, or that two points hold them."""
    notes = []
    for closure in hinged.closures:
        mate = f"'{closure.name}' is a revolute mate, since its frames have others on its axis"
        points = f"'{closure.name}' and '{closure.name}_z' hold the hinge, each 3d"
        if closure in found.closures and closure.type == "hinge":
            notes.append(f"{mate}: it is a hinge, which needs version 2.1")
        elif closure.type == "hinge":
            notes.append(f"{mate}: {points}; --version 2.1 writes one hinge")
        elif closure.hinge and any(other.name == f"{closure.name}_z" and other.hinge for other in found.closures):
            notes.append(f"{mate}: {points}")
    return tuple(notes)


def _merges(urdf: Urdf, found: Found, version: GeneratedVersion) -> dict[str, tuple[str, str, str]]:
    """EU-ONE-007, but for motors, which version 1 would merge as well."""
    joints = {joint.name: joint_of(joint) for joint in urdf.joints.values()}
    coupled = {name for joint in urdf.joints.values() if joint.mimic for name in (joint.name, joint.mimic.joint)}
    links = {
        frame if frame in urdf.links else urdf.joints[frame].child
        for closure in found.closures
        for frame in closure.frames
    }
    excluded = {*found.sphericals, *coupled, *(() if version == "1" else found.motors)}
    chains = [tuple(joint.name for joint in chain.joints) for chain in find_chains(urdf, joints, excluded, links)]
    # A key that begins with x- would be user data.
    return {third: (first, second, third) for first, second, third in chains if version == "1" or not is_own_key(third)}
