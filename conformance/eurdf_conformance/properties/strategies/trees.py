"""Spanning trees: links, joints, their changes by the description, and configurations."""

from __future__ import annotations

from dataclasses import dataclass, field
from functools import cache
from typing import Any

from hypothesis import strategies as st
from hypothesis.strategies import DrawFn, SearchStrategy

from eurdf_conformance.level import Version
from eurdf_conformance.properties.mechanism import (
    Actuator,
    Change,
    Configuration,
    Coordinates,
    Joint,
    Link,
    Mechanism,
)
from eurdf_conformance.properties.strategies.inertias import inertias
from eurdf_conformance.properties.strategies.joints import (
    ANGLE,
    BECOMES,
    FOLLOWING,
    LENGTH,
    PLAIN,
    Plain,
    changes,
    mimics,
    of_mimics,
    urdf_joints,
)
from eurdf_conformance.properties.strategies.merges import chains
from eurdf_conformance.properties.strategies.numbers import decimals, quaternions

#: What version 1 cannot express.
_VERSION_2 = ("cylindrical", "helical")


@dataclass
class Growth:
    """A tree under construction."""

    version: Version
    links: list[Link] = field(default_factory=list)
    joints: list[Joint] = field(default_factory=list)
    changes: dict[str, Change] = field(default_factory=dict)
    #: Links that can carry another joint.
    free: list[str] = field(default_factory=list)
    #: Joints that can be mimicked.
    leaders: list[str] = field(default_factory=list)

    def new_links(self, count: int) -> list[str]:
        """Names of the next links."""
        return [f"link{len(self.links) + i}" for i in range(count)]


@st.composite
def trees(draw: DrawFn, version: Version, most: int = 6) -> Mechanism:
    """A tree that version 2 or both versions can express, with the configurations `assembled` and `open`."""
    growth = Growth(version)
    growth.links.append(Link(name="link0", inertia=draw(st.none() | inertias())))
    growth.free.append("link0")
    for _ in range(most):
        if not draw(grown(growth)):
            break
    mechanism = Mechanism(
        root=draw(st.sampled_from(["fixed", "floating"])) if version != "1" else "fixed",
        links=tuple(growth.links),
        joints=tuple(growth.joints),
        changes=growth.changes,
    )
    following = {joint.name for joint in mechanism.joints if mechanism.mimics(joint)}
    movers = {name: kind for name, kind in mechanism.types().items() if name not in following}
    names = st.lists(st.sampled_from(sorted(movers)), unique=True, max_size=3) if movers else st.just([])
    driven = [name for name in draw(names) if name != "root_joint"]
    return mechanism.replace(
        actuators=tuple(draw(actuators(name, version)) for name in driven),
        configurations={
            "assembled": draw(configurations(movers, every=True)),
            "open": draw(configurations(movers, every=False)),
        },
        own={"x-note": draw(st.sampled_from(["no", 12, {"012": [1.5, "1e-3"]}]))} if version != "1" else {},
    )


@st.composite
def grown(draw: DrawFn, growth: Growth) -> bool:
    """Add a joint of any type, and draw whether to go on.

    All that is drawn for a joint is drawn here, so that Hypothesis can leave out any one of them.
    """
    version = growth.version
    kinds = ["merged", *(kind for kind in BECOMES if version != "1" or kind not in _VERSION_2)]
    kinds = [*PLAIN, *(["mimic"] if version != "1" else []), *kinds]  # in version 1 no joint mimics
    kind = draw(st.sampled_from(kinds))
    if kind == "merged":
        grow_ball(draw, growth)
    else:
        grow_joint(draw, growth, kind)
    return draw(st.integers(0, 3)) > 0


def grow_joint(draw: DrawFn, growth: Growth, kind: Any) -> None:
    """Add a joint and its child link."""
    name, (child,) = f"joint{len(growth.joints)}", growth.new_links(1)
    parent = draw(st.sampled_from(growth.free))
    was: Plain = kind
    if kind in BECOMES and (kind != "fixed" or draw(st.booleans())):
        was = draw(st.sampled_from(BECOMES[kind]))
        growth.changes[name] = draw(changes(kind, was, growth.version))
    elif kind == "mimic" and not growth.leaders:
        was = kind = "revolute"
    elif kind == "mimic":
        was = draw(st.sampled_from(FOLLOWING))
    elif growth.version != "1" and kind != "fixed" and (change := draw(changes(None, was, growth.version))):
        growth.changes |= {name: change} if change.says_something else {}
    mimic = draw(mimics(draw(st.sampled_from(growth.leaders)))) if kind == "mimic" else None
    if mimic and growth.version == "2.1":
        kind, change = draw(changed_mimics(was))
        growth.changes |= {name: change} if change.says_something else {}
    ends = {"name": name, "parent": parent, "child": child, "mimic": mimic}
    if kind in (*FOLLOWING, "mimic"):
        growth.leaders.append(name)
    growth.joints.append(draw(urdf_joints(was)).model_copy(update=ends))
    # What does not move may weigh nothing.
    growth.links.append(Link(name=child, inertia=draw(st.none() | inertias() if kind == "fixed" else inertias())))
    growth.free.append(child)


@st.composite
def changed_mimics(draw: DrawFn, was: Plain) -> tuple[str, Change]:
    """What becomes of a joint that the URDF makes a mimic, and what the description of version 2.1 states about it."""
    if not draw(st.booleans()):
        return "mimic", draw(of_mimics())
    kind = draw(st.none() | st.sampled_from([kind for kind, types in BECOMES.items() if was in types]))
    return kind or was, draw(changes(kind, was, "2.1")).model_copy(update={"freed": True})


def grow_ball(draw: DrawFn, growth: Growth) -> None:
    """Add three joints that are merged into one, and its child link."""
    joints = [f"joint{len(growth.joints) + i}" for i in range(3)]
    links = growth.new_links(3)
    found, between = draw(chains(joints, [draw(st.sampled_from(growth.free)), *links]))
    name = joints[-1] if growth.version == "1" or draw(st.booleans()) else f"ball{len(growth.joints)}"
    growth.changes[name] = Change(type="spherical", merges=tuple(joints))
    growth.joints += found
    growth.links += [*between, Link(name=links[-1], inertia=draw(inertias()))]
    growth.free.append(links[-1])


@cache
def actuators(joint: str, version: Version) -> SearchStrategy[Actuator]:
    """A joint with a motor."""
    plain = st.just(Actuator(joint=joint))
    if version == "1":
        return plain
    gear = st.none() | decimals(-20, 20, 1).filter(bool)
    rotor = st.none() | decimals(0, 0.01, 4)
    geared = st.builds(Actuator, joint=st.just(joint), gear_ratio=gear, rotor_inertia=rotor)
    if version == "2":
        return plain | geared
    control = st.none() | st.tuples(decimals(-9, 0, 1), decimals(0, 9, 1))
    name = st.none() | st.just(f"motor of {joint}")
    return plain | st.builds(
        Actuator, joint=st.just(joint), gear_ratio=gear, rotor_inertia=rotor, name=name, control=control
    )


@st.composite
def configurations(draw: DrawFn, types: dict[str, str], *, every: bool) -> Configuration:
    """Coordinates of all joints, or of some; the others are at neutral."""
    return {name: draw(coordinates(kind)) for name, kind in types.items() if every or draw(st.booleans())}


@cache
def coordinates(kind: str) -> SearchStrategy[Coordinates]:
    """Coordinates of a type of joint, in the order of files."""
    length, angle = decimals(-LENGTH, LENGTH), decimals(-ANGLE, ANGLE)
    ways: dict[str, SearchStrategy[Coordinates]] = {
        "prismatic": st.tuples(length),
        "cylindrical": st.tuples(length, angle),
        "universal": st.tuples(angle, angle),
        "planar": st.tuples(length, length, angle),
        "spherical": quaternions(),
        "floating": st.builds(lambda p, q: (*p, *q), st.tuples(length, length, length), quaternions()),
    }
    return ways.get(kind, st.tuples(angle))
