"""Robots at each bound of EU-FIL-002, and one beyond: made when they are asked for, since their files are large."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Mapping
from dataclasses import dataclass
from functools import cached_property
from pathlib import Path
from typing import Any

from eurdf_conformance.corpus.case import CasePlace, InvalidCase, ValidCase
from eurdf_conformance.corpus.read import CorpusCase, suite_cases
from eurdf_conformance.feature import Feature
from eurdf_conformance.level import Level, Version
from eurdf_conformance.properties.files import DESCRIPTION, URDF

#: The clause that they test, and the first part of their names.
CLAUSE, BOUNDS = "EU-FIL-002", "bounds"

_Files = tuple[bytes, bytes]

_HEAD: Mapping[Version, str] = {"1": "name_mot: []\n", "2": 'extended_urdf: "2.0"\n'}
_INERTIAL = '<inertial><mass value="1"/><inertia ixx="1" ixy="0" ixz="0" iyy="1" iyz="0" izz="1"/></inertial>'


def _robot(*content: str, own: str = "") -> bytes:
    return f'<robot name="large"{own}><link name="base"/>{"".join(content)}</robot>'.encode()


def _hanging(name: str, joint: str, link: str = "", *, parent: str = "base", own: str = "") -> str:
    """A link that hangs from the base, or from another link."""
    return (
        f'<link name="{name}">{link}</link>'
        f'<joint name="to_{name}" type="{joint}"><parent link="{parent}"/><child link="{name}"/>{own}</joint>'
    )


def _description_bytes(version: Version, count: int) -> _Files:
    head = _HEAD[version].encode()
    return head + b"#" * (count - len(head) - 1) + b"\n", _robot()


def _urdf_bytes(version: Version, count: int) -> _Files:
    robot = _robot()
    return _HEAD[version].encode(), robot + b"\n" * (count - len(robot))


def _nodes(version: Version, count: int) -> _Files:
    # The mapping; the key that is there, its value; the key of the list, the list; the list that has the anchor.
    aliases = 20_000
    return (
        f"{_HEAD[version]}x-list: [&a [1, 2], {'*a, ' * aliases}{'1, ' * (count - 8 - aliases)}]\n".encode(),
        _robot(),
    )


def _tags_and_attributes(version: Version, count: int) -> _Files:
    rest = count - sum(_robot().count(each) for each in (b"<", b"="))
    return _HEAD[version].encode(), _robot("<x/>" * rest)


def _attribute_bytes(version: Version, count: int) -> _Files:
    """Of characters of two bytes each, and one of one byte if the count is odd."""
    return _HEAD[version].encode(), _robot(own=f' note="{"é" * (count // 2)}{"x" * (count % 2)}"')


def _joints(version: Version, count: int) -> _Files:
    return _HEAD[version].encode(), _robot(*(_hanging(f"l{i}", "fixed") for i in range(count)))


def _joints_with_merged_ones(version: Version, count: int) -> _Files:
    """A merge does not change the count."""
    axes = {"x": "1 0 0", "y": "0 1 0", "z": "0 0 1"}
    chain = [
        _hanging(name, "continuous", parent=parent, own=f'<axis xyz="{axes[name]}"/>')
        for parent, name in (("base", "x"), ("x", "y"), ("y", "z"))
    ]
    others = [_hanging(f"l{i}", "fixed") for i in range(count - 3)]
    merged = f"{_HEAD[version]}joints: {{ball: {{type: spherical, merges: [to_x, to_y, to_z]}}}}\n"
    return merged.encode(), _robot(*chain, *others)


def _joints_with_split_ones(version: Version, count: int) -> _Files:
    """A thousand of the joints are split in two."""
    links = [_hanging(f"u{i}", "continuous", _INERTIAL) for i in range(1_000)]
    split = [f"to_u{i}" for i in range(len(links))]
    others = [_hanging(f"l{i}", "fixed") for i in range(count - 2 * len(split))]
    types = ["UJOINT_XY"] * len(split)
    description = f"{_HEAD[version]}joint_name: [{', '.join(split)}]\njoint_type: [{', '.join(types)}]\n"
    return description.encode(), _robot(*links, *others)


def _velocities(version: Version, count: int) -> _Files:
    free, rest = divmod(count, 6)
    links = [_hanging(f"f{i}", "floating", _INERTIAL) for i in range(free)]
    return _HEAD[version].encode(), _robot(*links, *(_hanging(f"c{i}", "continuous", _INERTIAL) for i in range(rest)))


def _velocities_with_mimic(version: Version, count: int) -> _Files:
    """Half of the velocities are those of mimic joints, and the root, which does not count, is free."""
    leader = _hanging("leader", "continuous", _INERTIAL)
    links = [
        _hanging(f"c{i}", "continuous", _INERTIAL, own='<mimic joint="to_leader"/>' if i % 2 else "")
        for i in range(count - 1)
    ]
    return f"{_HEAD[version]}root: floating\n".encode(), _robot(leader, *links)


def _rows(version: Version, count: int) -> _Files:
    """Frames along the axis of the one joint: at zero, all closures are closed."""
    closures = (
        f"  - {{name: c{i}, type: {'6d' if i < count // 6 else '3d'}, "
        f"frames: [{{link: arm, xyz: [{i}, 0, 0]}}, {{link: base, xyz: [{i}, 0, 0]}}]}}\n"
        for i in range(count // 6 + (count % 6 >= 3))
    )
    return f"{_HEAD[version]}closures:\n{''.join(closures)}".encode(), _robot(_hanging("arm", "continuous", _INERTIAL))


@dataclass(frozen=True)
class Bound:
    """A bound of the table of EU-FIL-002.

    Attributes:
        name: What is counted.
        most: The largest count that is within the bound.
        beyond: The smallest count that is not.
        files: Description and URDF of a robot with so many.
        versions: The versions of the format in which it is tested.
        features: The features that its files use.
    """

    name: str
    most: int
    beyond: int
    files: Callable[[Version, int], _Files]
    versions: tuple[Version, ...] = ("1", "2")
    features: frozenset[Feature] = frozenset()


ALL = (
    # These two in one version: a reader of YAML in Python takes seconds for such a text.
    Bound("description-bytes", 1 << 24, (1 << 24) + 1, _description_bytes, ("2",)),
    Bound("urdf-bytes", 1 << 24, (1 << 24) + 1, _urdf_bytes),
    Bound("nodes", 100_000, 100_001, _nodes, ("2",)),
    Bound("tags-and-attributes", 1_000_000, 1_000_001, _tags_and_attributes),
    Bound("attribute-bytes", 10_000_000, 10_000_001, _attribute_bytes),
    Bound("joints", 10_000, 10_001, _joints),
    Bound("joints-with-merged-ones", 10_000, 10_001, _joints_with_merged_ones, ("2",), frozenset({Feature.SPHERICAL})),
    Bound("joints-with-split-ones", 10_000, 10_001, _joints_with_split_ones, ("1",), frozenset({Feature.UNIVERSAL})),
    Bound("velocities", 4_000, 4_001, _velocities, features=frozenset({Feature.FLOATING})),
    Bound(
        "velocities-with-mimic-joints",
        4_000,
        4_001,
        _velocities_with_mimic,
        ("2",),
        frozenset({Feature.MIMIC, Feature.FLOATING_ROOT}),
    ),
    # In version 1 frames are links, of which there would be too many; rows of version 2.0 come in threes.
    Bound("rows", 19_998, 20_001, _rows, ("2",)),
)


@dataclass(frozen=True)
class BoundCase(CorpusCase):
    """A case that is made when it is asked for."""

    bound: Bound
    count: int

    @cached_property
    def files(self) -> dict[str, bytes]:
        """The contents of its files, by name."""
        return dict(zip((DESCRIPTION, URDF), self.bound.files(self.case.version, self.count), strict=True))

    @property
    def features(self) -> frozenset[Feature]:
        """The features that its files use."""
        return self.bound.features

    @property
    def levels(self) -> tuple[Level, ...]:
        """The levels at which it is tested: no robot of such a size is described or moved."""
        return (Level.ACCEPT,)


def bound_cases() -> Iterator[BoundCase]:
    """Two cases for each bound and version: at the bound, and beyond it."""
    for bound in ALL:
        for version in bound.versions:
            for count in (bound.most, bound.beyond):
                name = f"{BOUNDS}/{bound.name}-{count}-{version}"
                yield BoundCase(_said(bound, version, count), name, Path(f"{name}.yaml"), suite_cases(), bound, count)


def _said(bound: Bound, version: Version, count: int) -> ValidCase | InvalidCase:
    what = bound.name.replace("-", " ")
    common: dict[str, Any] = {
        "id": "bounds",
        "title": f"A robot with {count:,} {what}, {'at' if count == bound.most else 'beyond'} the bound.",
        "version": version,
        "clauses": [CLAUSE],
        "description": DESCRIPTION,
        "urdf": URDF,
    }
    if count == bound.most:
        return ValidCase(valid=True, **common)
    place = CasePlace(
        file=DESCRIPTION if bound.name in ("description-bytes", "nodes", "rows") else URDF, line=None, column=None
    )
    # Not checked: there is no edit of a stored case.
    return InvalidCase.model_construct(
        valid=False,
        code="file-too-large",
        place=place,
        fix="Make it smaller.",
        either=False,
        features=[],
        twin=None,
        **common,
    )
