"""From the names in a URDF to a description of it."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Mapping
from dataclasses import dataclass, replace

from eurdf.closures.hinge import HingeClosure
from eurdf.closures.point import PointClosure
from eurdf.diagnostics import Diagnostics, enumerated
from eurdf.format.conventions import VERSION2_0, VERSION2_1, is_own_key
from eurdf.format.urdf.data import Urdf
from eurdf.format.yaml_text import Value, YamlEntry, entries_of, lines_of, modeline, text_of
from eurdf.linking.joints import joint_of
from eurdf.linking.link import reread
from eurdf.linking.merging import find_chains
from eurdf.mechanism.body import Anchor
from eurdf.mechanism.mechanism import Mechanism, Root
from eurdf.mechanism.spanning_tree import rigid_poses
from eurdf.writing.closure_choice import choose_types
from eurdf.writing.joined_closures import Apart, join_points
from eurdf.writing.naming_conventions import (
    ClosureType,
    Conventions,
    Found,
    GeneratedVersion,
    NamedClosure,
    find,
    hints,
    mimic_pairs,
    with_type,
)


@dataclass(frozen=True, slots=True, repr=False)
class Generation:
    """A description that was generated.

    Attributes:
        text: Of the YAML file.
        version: Of the description.
        found: What the names say.
        merges: For each spherical joint made of three revolutes whose axes meet, their names.
        mechanism: That the text describes; None where the names say what cannot be.
        diagnostics: Found in the text.
        notes: Why closures have the types that they have, where their names do not say it; one sentence each.
        hints: How to get closures, or motors, where the names say none; one sentence each.
    """

    text: str
    version: GeneratedVersion
    found: Found
    merges: Mapping[str, tuple[str, str, str]]
    mechanism: Mechanism | None
    diagnostics: Diagnostics
    notes: tuple[str, ...] = ()
    hints: tuple[str, ...] = ()

    def __repr__(self) -> str:
        found = self.found
        return f"<Generation: version {self.version}, {len(found.closures)} closures, {len(found.motors)} motors>"


def generate(
    urdf: Urdf,
    conventions: Conventions,
    version: GeneratedVersion | None = None,
    root: Root = "fixed",
    urdf_path: str = "robot.urdf",
    schema: Callable[[GeneratedVersion], str | None] = lambda _: None,
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
        schema: For a version, the path of its schema from the folder of the description, for the first line; None for
            no such line.
        closure_type: Type of every closure; by default what their names say, and else what `choose_types` finds.
    """
    if version == "1" and root != "fixed":
        raise ValueError("version 1 cannot say that the root floats")
    found = find(urdf, conventions)
    if closure_type is not None:
        found = with_type(found, closure_type)

    def written(found: Found) -> Generation:
        mates = Mates(found, (), ()) if closure_type is not None else revolute_mates(found, urdf)
        chosen = version or ("2.1" if mates.hinges else "2")
        said = mates.found if chosen == "2.1" else found
        merges = _merges(urdf, said, chosen)
        # The version, and so the schema, is not known before every type is.
        reference = None if any(closure.type is None for closure in found.closures) else schema(chosen)
        number = VERSION2_1 if chosen == "2.1" else VERSION2_0
        head, *rest = _version1(said) if chosen == "1" else _version2(said, merges, root, urdf_path, number)
        text = text_of([head._replace(above=() if reference is None else (modeline(reference),)), *rest])
        mechanism, diagnostics = reread(text, urdf, "the description")
        notes, advice = _mate_notes(mates, chosen), hints(urdf, said, conventions)
        return Generation(text, chosen, said, merges, mechanism, diagnostics, notes, advice)

    generation = written(found)
    undecided = [index for index, closure in enumerate(generation.found.closures) if closure.type is None]
    if generation.mechanism is None or not undecided:
        return generation
    # Version 1 has no names of closures; their order is that of the file in both versions.
    mechanism, closures = generation.mechanism, generation.found.closures
    names = {mechanism.closures[index].name: closures[index].name for index in undecided}
    choice = choose_types(mechanism, names, [closure.name for closure in closures])
    types = {names[name]: kind for name, kind in choice.types.items()}
    found = replace(
        found, closures=tuple(replace(each, type=types.get(each.name, each.type)) for each in found.closures)
    )
    generation = written(found)
    return replace(generation, notes=(*generation.notes, *choice.notes))


def _mate_notes(mates: Mates, version: GeneratedVersion) -> tuple[str, ...]:
    """What is said of revolute mates: that they are hinges, or that several points hold them."""
    notes = []
    for points in mates.hinges:
        names = enumerated(points)
        if version == "2.1":
            notes.append(f"{names} are one hinge, which needs version 2.1: their points are as far apart in both parts")
        else:
            notes.append(f"{names} hold a hinge, each 3d; --version 2.1 writes one hinge")
    notes += [f"{apart}: correct the frames" for apart in mates.apart]
    explained = {name for names in (*mates.hinges, *(apart.names for apart in mates.apart)) for name in names}
    named = {closure.name for closure in mates.found.closures if closure.hinge} - explained
    for closure in mates.found.closures:
        second = f"{closure.name}_z"
        if {closure.name, second} <= named:
            notes.append(f"'{closure.name}' and '{second}' are named as a hinge, but state no axis: each is 3d")
    return tuple(notes)


def _merges(urdf: Urdf, found: Found, version: GeneratedVersion) -> dict[str, tuple[str, str, str]]:
    """EU-ONE-007, but for motors, which version 1 would merge as well."""
    joints = {joint.name: joint_of(joint) for joint in urdf.joints.values()}
    links = {_link(urdf, frame) for closure in found.closures for frame in closure.frames}
    excluded = {*found.sphericals, *found.universals, *mimic_pairs(urdf), *(() if version == "1" else found.motors)}
    chains = [tuple(joint.name for joint in chain.joints) for chain in find_chains(urdf, joints, excluded, links)]
    # A key that begins with x- would be user data.
    return {third: (first, second, third) for first, second, third in chains if version == "1" or not is_own_key(third)}


@dataclass(frozen=True, slots=True)
class Mates:
    """What the 3d closures of a URDF say by their points.

    Attributes:
        found: What the names say, with one hinge in the place of the closures that hold it.
        hinges: For each hinge, the names of these closures; the first is its own.
        apart: 3d closures of the same two parts that cannot both be closed.
    """

    found: Found
    hinges: tuple[tuple[str, ...], ...]
    apart: tuple[Apart, ...]


def revolute_mates(found: Found, urdf: Urdf) -> Mates:
    """Let one hinge take the place of the 3d closures of two parts whose points are on one axis.

    The axis in each frame points from its first point to the one that is farthest from it.
    """
    points = [
        PointClosure(closure.name, *(Anchor(_link(urdf, frame)) for frame in closure.frames))
        for closure in found.closures
        if closure.type == "3d"
    ]
    joined = join_points(points, rigid_poses(urdf.root, urdf.walk()))
    closures = {closure.name: closure for closure in found.closures}
    hinges = []
    for each in joined.joined:
        if isinstance(each.closure, HingeClosure):
            hinges.append(each.points)
            first = closures[each.closure.name]
            closures[first.name] = NamedClosure(first.name, "hinge", first.frames, axes=each.closure.axes)
            for name in each.points[1:]:
                del closures[name]
    return Mates(replace(found, closures=tuple(closures.values())), tuple(hinges), joined.apart)


def _link(urdf: Urdf, frame: str) -> str:
    return frame if frame in urdf.links else urdf.joints[frame].child


# -- text ---------------------------------------------------------------------------------------------------------


def _version2(
    found: Found, merges: Mapping[str, tuple[str, str, str]], root: Root, urdf_path: str, version: str
) -> Iterator[YamlEntry]:
    """The entries of a description in version 2.0, which has no hinges, or 2.1."""
    joints: dict[str, Value] = dict.fromkeys(found.sphericals, "spherical")
    joints |= {name: {"type": "universal", "axes": axes} for name, axes in found.universals.items()}
    joints |= {name: {"type": "spherical", "merges": three} for name, three in merges.items()}
    content: dict[str, Value] = {
        "extended_urdf": version,
        "urdf": urdf_path,
        "root": "" if root == "fixed" else root,
        "closures": [
            {"name": closure.name, "type": closure.type or "6d", "frames": closure.frames, **closure.axis_keys}
            for closure in found.closures
        ],
        "joints": joints,
        "actuators": found.motors,
    }
    return entries_of({key: value for key, value in content.items() if value})


def _version1(found: Found) -> Iterator[YamlEntry]:
    """The entries of a description in version 1, which merges revolutes by itself."""
    values: dict[str, Value] = {
        "closed_loop": [closure.frames for closure in found.closures],
        "type": [closure.type or "6d" for closure in found.closures],
        "name_mot": found.motors,
        "joint_name": [*found.sphericals, *found.universals],
        "joint_type": [
            *["SPHERICAL"] * len(found.sphericals),
            *(f"UJOINT_{axes.upper()}" for axes in found.universals.values()),
        ],
    }
    # Without any key of the format, it would still be a description of version 1: of nothing.
    return (YamlEntry(lines_of(key, value)) for key, value in values.items() if value or key in ("closed_loop", "type"))
