"""URDF texts, written by hand and at random, and the mechanisms they are."""

from __future__ import annotations

from typing import Any, Literal

import pinocchio as pin
from hypothesis import strategies as st

from eurdf.diagnostics import Diagnostics
from eurdf.format.urdf.read import read_urdf
from eurdf.linking.link import link
from eurdf.mechanism.mechanism import Mechanism
from eurdf.reading.source import Source
from eurdf.reading.xml_reader import read_xml

Root = Literal["fixed", "floating"]


def mechanism_of(text: str, root: Root = "fixed", mimic: bool = True) -> Mechanism:
    diagnostics = Diagnostics()
    urdf = read_urdf(read_xml(Source("robot.urdf", text, text.encode())), diagnostics)
    mechanism = None if urdf is None else link(urdf, None, diagnostics, root, mimic=mimic)
    assert mechanism is not None, [str(found) for found in diagnostics]
    return mechanism


def pinocchios_own(text: str, root: Root = "fixed", mimic: bool = True) -> Any:
    if root == "fixed":
        return pin.buildModelFromXML(text, mimic=mimic)
    return pin.buildModelFromXML(text, pin.JointModelFreeFlyer(), mimic=mimic)


def robot(*elements: str, name: str = "robot", version: str = "") -> str:
    stated = f' version="{version}"' if version else ""
    return f'<robot name="{name}"{stated}>{"".join(elements)}</robot>'


def pinocchio_reads(version: str) -> bool:
    """Whether Pinocchio's own reader of URDF knows a version of it."""
    try:
        pinocchios_own(robot(link_element("base"), version=version))
    except ValueError:
        return False
    return True


def link_element(name: str, content: str = "") -> str:
    return f'<link name="{name}">{content}</link>'


def inertial(mass: float = 1.0, origin: str = "", moments: tuple[float, ...] = (0.1, 0, 0, 0.2, 0, 0.25)) -> str:
    names = ("ixx", "ixy", "ixz", "iyy", "iyz", "izz")
    inertia = " ".join(f'{name}="{value!r}"' for name, value in zip(names, moments, strict=True))
    return f'<inertial>{origin}<mass value="{mass!r}"/><inertia {inertia}/></inertial>'


def joint_element(
    name: str, kind: str, parent: str, child: str, content: str = '<limit effort="1" velocity="1"/>', origin: str = ""
) -> str:
    return (
        f'<joint name="{name}" type="{kind}">{origin}<parent link="{parent}"/><child link="{child}"/>{content}</joint>'
    )


def vector(values: Any) -> str:
    return " ".join(repr(float(value)) for value in values)


NUMBERS = st.one_of(
    st.sampled_from([0.0, 1.0, -1.0, 0.5, -0.0]),
    st.floats(-3.0, 3.0, allow_subnormal=False).filter(lambda x: abs(x) > 1e-9),
)
VECTORS = st.tuples(NUMBERS, NUMBERS, NUMBERS)
QUATERNIONS = st.tuples(*[NUMBERS] * 4).filter(any)
#: Versions of URDF that Pinocchio's reader knows: 1.1 and 1.2 came with the urdfdom of 2026.
VERSIONS = st.sampled_from([version for version in ("", "1.0", "1.1", "1.2") if pinocchio_reads(version)])
POSITIVE = st.floats(1e-3, 10.0)


@st.composite
def origins(draw: st.DrawFn, version: str = "") -> str:
    xyz = f' xyz="{vector(draw(VECTORS))}"' if draw(st.booleans()) else ""
    rpy = f' rpy="{vector(draw(VECTORS))}"' if draw(st.booleans()) else ""
    if version and draw(st.booleans()):
        quaternion = f' quat_xyzw="{vector(draw(QUATERNIONS))}"'
        rpy = quaternion if version >= "1.1" else rpy + quaternion
    return f"<origin{xyz}{rpy}/>" if xyz or rpy else ""


@st.composite
def inertials(draw: st.DrawFn, version: str = "") -> str:
    if draw(st.integers(0, 3)) == 0:
        return ""
    xx, yy, zz = draw(st.tuples(POSITIVE, POSITIVE, POSITIVE))
    xy, xz, yz = draw(st.tuples(*[st.floats(-1e-3, 1e-3) | NUMBERS] * 3))  # some are of no body
    mass = draw(st.sampled_from([0.0, 1.0]) | POSITIVE)
    return inertial(mass, draw(origins(version)), (xx, xy, xz, yy, yz, zz))


@st.composite
def limits(draw: st.DrawFn, kind: str, version: str) -> str:
    lower, upper = sorted(draw(st.tuples(NUMBERS, NUMBERS)))
    velocity, effort = draw(st.tuples(POSITIVE, POSITIVE))
    position, rates = [f'lower="{lower!r}"', f'upper="{upper!r}"'], [f'velocity="{velocity!r}"', f'effort="{effort!r}"']
    if version == "1.2":
        rates = [text for text in rates if draw(st.booleans())]
    if version == "1.2" and kind not in ("revolute", "prismatic"):
        position = [text for text in position if draw(st.booleans())]
    return f"<limit {' '.join(position + rates)}/>"


@st.composite
def axes(draw: st.DrawFn) -> str:
    unit = ["1 0 0", "0 1 0", "0 0 1", "0 0 -1", "0 2 0", "1e-13 0 1", "1e-11 1 0"]
    free = VECTORS.filter(any).map(vector)
    return f'<axis xyz="{draw(st.sampled_from(unit) | free)}"/>' if draw(st.integers(0, 3)) else ""


@st.composite
def trees(draw: st.DrawFn, versions: st.SearchStrategy[str] = VERSIONS) -> str:
    """A robot that Pinocchio's parser takes with ``mimic=True``; the order of names is not that of the file."""
    count, version = draw(st.integers(1, 8)), draw(versions)
    names = draw(st.permutations([f"j{index}" for index in range(1, count)]))
    parents = [draw(st.integers(0, index)) for index in range(count - 1)]
    kinds = [
        draw(st.sampled_from(["revolute", "continuous", "prismatic", "planar", "floating", "fixed"])) for _ in names
    ]
    elements = [link_element(f"l{index}", draw(inertials(version))) for index in range(count)]
    visited = _depth_first(names, parents)
    followers: set[str] = set()
    for index, (name, kind) in enumerate(zip(names, kinds, strict=True)):
        content = draw(axes())
        if kind in ("revolute", "prismatic") or draw(st.booleans()):
            content += draw(limits(kind, version))
        if draw(st.booleans()):
            damping, friction = draw(st.tuples(POSITIVE, POSITIVE))
            content += f'<dynamics damping="{damping!r}" friction="{friction!r}"/>'
        alike = ("continuous",) if kind == "continuous" else ("revolute", "prismatic")
        leaders = [
            other
            for other, other_kind in zip(names, kinds, strict=True)
            if kind in (*alike, "continuous")
            and other_kind in alike
            and other not in followers
            and visited.index(other) < visited.index(name)
        ]
        # A later joint of the file may already follow this one; then this one must not follow another.
        if leaders and not any(f'<mimic joint="{name}"' in element for element in elements) and draw(st.booleans()):
            multiplier, offset = draw(st.tuples(NUMBERS, NUMBERS))
            if kind == "continuous":
                # Pinocchio forgets the turns of its leader: of another number of turns, its own model is wrong.
                multiplier = float(round(multiplier))
            leader = draw(st.sampled_from(leaders))
            content += f'<mimic joint="{leader}" multiplier="{multiplier!r}" offset="{offset!r}"/>'
            followers.add(name)
        origin = draw(origins(version))
        elements.append(joint_element(name, kind, f"l{parents[index]}", f"l{index + 1}", content, origin))
    return robot(*elements, version=version)


def _depth_first(names: list[str], parents: list[int]) -> list[str]:
    order: list[str] = []

    def visit(parent: int) -> None:
        children = [index for index in range(len(names)) if parents[index] == parent]
        for index in sorted(children, key=lambda index: names[index]):
            order.append(names[index])
            visit(index + 1)

    visit(0)
    return order
