"""Joints of every type, in the URDF and with changes by the description."""

from __future__ import annotations

from functools import cache, partial
from typing import Any, Literal, get_args

from hypothesis import strategies as st
from hypothesis.strategies import DrawFn, SearchStrategy

from eurdf_conformance.comparison.coordinates import COORDINATES, VELOCITIES
from eurdf_conformance.level import Version
from eurdf_conformance.properties.mechanism import Change, Joint, Limit, Mimic, PerNumber, Pose, Vector
from eurdf_conformance.properties.strategies.numbers import axes, axis_pairs, decimals, poses

Plain = Literal["revolute", "continuous", "prismatic", "planar", "floating", "fixed"]
PLAIN: tuple[Plain, ...] = get_args(Plain)

#: What becomes of a joint, and what it may be in the URDF, EU-JNT-005.
BECOMES: dict[str, tuple[Plain, ...]] = {
    "spherical": ("revolute", "continuous"),
    "universal": ("revolute", "continuous"),
    "fixed": ("revolute", "continuous", "prismatic", "planar", "floating"),
    "cylindrical": ("revolute", "continuous", "prismatic"),
    "helical": ("revolute", "continuous", "prismatic"),
}
LETTERS = ("xy", "xz", "yx", "yz", "zx", "zy")

#: Types that mimic and are mimicked, EU-URD-023, and those whose coordinates limits bound, EU-JNT-009.
FOLLOWING = ("revolute", "continuous", "prismatic")
_BOUNDED = ("revolute", "prismatic", "universal", "cylindrical", "helical")

#: Coordinates are drawn within these, m and rad, and limits beyond.
LENGTH, ANGLE = 0.5, 1.6


@cache
def urdf_joints(kind: Plain) -> SearchStrategy[Joint]:
    """A joint of the URDF between two links."""
    if kind == "fixed":
        return st.builds(lambda origin: _joint(kind, origin, None, None, None, None), poses())
    ranged = kind in ("revolute", "prismatic")
    limits = st.builds(
        Limit,
        effort=decimals(0, 50, 1),
        velocity=decimals(0, 10, 1),
        lower=decimals(-4, -2, 1) if ranged else st.none(),
        upper=decimals(2, 4, 1) if ranged else st.none(),
    )
    axis: SearchStrategy[Vector | None] = st.none() | axes()
    if kind in ("planar", "floating"):
        axis = st.just((0.0, 0.0, 1.0)) if kind == "planar" else st.none()
    some = st.none() | decimals(0, 1)
    limit = limits if ranged else st.none() | limits
    return st.builds(partial(_joint, kind), poses(), axis, limit, some, some)


def _joint(
    kind: Plain, origin: Pose, axis: Vector | None, limit: Limit | None, damping: float | None, friction: float | None
) -> Joint:
    return Joint(
        name="",
        type=kind,
        parent="",
        child="",
        origin=origin,
        axis=axis,
        limit=limit,
        damping=damping,
        friction=friction,
    )


@cache
def mimics(leader: str) -> SearchStrategy[Mimic]:
    """A mimic with a positive or negative multiplier."""
    return st.builds(
        Mimic, joint=st.just(leader), multiplier=decimals(-2, 2, 1).filter(bool), offset=decimals(-0.5, 0.5)
    )


@st.composite
def changes(draw: DrawFn, kind: Any, was: Plain, version: Version) -> Change:
    """What the description states about a joint.

    Args:
        draw: Of Hypothesis.
        kind: What it becomes, or None.
        was: Its type in the URDF.
        version: Of the description.
    """
    plain = version == "1"
    said: dict[str, Any] = {"type": kind}
    if kind == "universal":
        letters = st.sampled_from(LETTERS)
        said["axes"] = draw(letters if plain else letters | axis_pairs())
    if kind == "helical":
        said["pitch"] = draw(decimals(-0.5, 0.5).filter(bool))
    if plain or kind == "fixed":
        return Change(**said)
    said |= draw(stated(kind or was))
    return Change(**said, **(draw(springs(kind or was)) if version == "2.1" else {}))


@st.composite
def stated(draw: DrawFn, kind: str) -> dict[str, Any]:
    """Properties in the description, which replace the URDF's, and user data."""
    nq, nv = COORDINATES[kind], VELOCITIES[kind]
    ranges = {"armature": (0, 0.5), "damping": (0, 2), "friction": (0, 2), "velocity": (0, 9), "effort": (0, 9)}
    ranges |= {"lower": (-4, -2), "upper": (2, 4)} if kind in _BOUNDED else {}
    names: list[str] = draw(st.lists(st.sampled_from(sorted(ranges)), unique=True, max_size=3))
    said: dict[str, Any] = {}
    for name in names:
        count = nq if name in ("lower", "upper") else nv
        said[name] = draw(_per_number(*ranges[name], count))
    with_own = draw(st.booleans())
    if said and with_own:
        said["own"] = {"x-bearing": {"series": draw(st.integers(600, 700)), "play": [2e-05, None, True, "no"]}}
    return said


@cache
def of_mimics() -> SearchStrategy[Change]:
    """What the description of version 2.1 may state about a mimic joint that it does not free, EU-JNT-030."""
    names = st.lists(st.sampled_from(["armature", "damping", "friction"]), unique=True)
    numbers = names.flatmap(lambda some: st.fixed_dictionaries({name: _per_number(0, 2, 1) for name in some}))
    return st.builds(lambda said, spring: Change(**said, **spring), numbers, springs("revolute"))


@cache
def springs(kind: str) -> SearchStrategy[dict[str, Any]]:
    """A spring on each coordinate, or none, of a type of joint: EU-JNT-031."""
    if kind not in (*_BOUNDED, "continuous"):
        return st.just({})
    count = COORDINATES[kind]
    spring = {"stiffness": _per_number(0, 900, count)}
    return st.just({}) | st.fixed_dictionaries(spring, optional={"rest": _per_number(-2, 2, count)})


@cache
def _per_number(low: float, high: float, count: int) -> SearchStrategy[PerNumber]:
    numbers = decimals(low, high)
    return numbers | st.tuples(*[numbers] * count)
