"""Which inertias are those of real bodies, and what a joint at the end of the tree must move."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest
from hypothesis import assume, given, settings
from hypothesis import strategies as st

from support.described import codes, load, mass_matrix, q_of
from support.plain_urdf import inertial, joint_element, link_element, robot, vector

LIMIT = '<limit lower="-2" upper="2" effort="1" velocity="1"/>'


def _inertial(mass: float, moments: Any, xyz: Any = (0, 0, 0), rpy: Any = (0, 0, 0)) -> str:
    m = np.asarray(moments, dtype=float)
    m = np.diag(m) if m.ndim == 1 else m
    origin = f'<origin xyz="{vector(xyz)}" rpy="{vector(rpy)}"/>'
    return inertial(float(mass), origin, tuple(float(m[i, j]) for i, j in zip(*np.triu_indices(3), strict=True)))


def _one(mass: float, moments: Any) -> list[str]:
    return codes(robot(link_element("base", _inertial(mass, moments))))


def _turned(moments: Any, seed: int) -> Any:
    R, _ = np.linalg.qr(np.random.default_rng(seed).normal(size=(3, 3)))
    return R @ np.diag(moments) @ R.T


@st.composite
def _bodies(draw: st.DrawFn) -> tuple[float, Any]:
    """Mass and moments of a cloud of point masses, of any size; flat, thin, or a point as well."""
    count = draw(st.integers(1, 6))
    size = 10.0 ** draw(st.integers(-4, 2))
    random = np.random.default_rng(draw(st.integers(0, 2**32 - 1)))
    stretch = draw(st.sampled_from([(1, 1, 1), (1, 1, 0), (1, 0, 0), (1, 1, 1e-4), (0, 0, 0)]))
    points = size * random.normal(size=(count, 3)) * stretch
    masses = random.uniform(0.1, 5.0, count)
    points -= masses @ points / masses.sum()
    own = _turned((1, 1, 1), draw(st.integers(0, 99)))
    moments = sum(m * ((p @ p) * np.eye(3) - np.outer(p, p)) for m, p in zip(masses, points @ own.T, strict=True))
    return float(masses.sum()), moments


@settings(max_examples=150, deadline=None)
@given(_bodies())
def test_real_mass_distributions_are_accepted(real: tuple[float, Any]) -> None:
    assert _one(*real) == []


@settings(max_examples=60, deadline=None)
@given(st.tuples(*[st.floats(0.0, 10.0)] * 2), st.floats(1e-5, 10.0), st.integers(0, 2**32 - 1), st.floats(1e-6, 1e6))
def test_negative_principal_moment_is_detected(others: Any, negative: float, seed: int, size: float) -> None:
    moments = np.array((*others, -negative))
    assume(negative > 2e-6 * np.abs(moments).max())
    assert _one(1.0, _turned(moments * size, seed)) == ["inertia-not-psd"]


@settings(max_examples=60, deadline=None)
@given(st.tuples(*[st.floats(1e-3, 10.0)] * 2), st.floats(1e-5, 10.0), st.integers(0, 2**32 - 1), st.floats(1e-6, 1e6))
def test_triangle_violation_is_detected(others: Any, more: float, seed: int, size: float) -> None:
    moments = np.array((*others, sum(others) + more))
    assume(more > 2e-6 * moments.max())
    assert _one(1.0, _turned(moments * size, seed)) == ["inertia-triangle"]


def test_inertia_errors_do_not_prevent_loading() -> None:
    joint = joint_element("j", "revolute", "base", "tip", f'<axis xyz="0 0 1"/>{LIMIT}')
    loaded = load(robot(link_element("base", _inertial(1, (1, 1, -1))), link_element("tip"), joint))
    assert [found.code for found in loaded.diagnostics] == ["inertia-not-psd", "leaf-without-inertia"]


# -- what a joint at the end of the tree moves ------------------------------------------------------------------------

POINT, NONE = (0, 0, 0), ""
ROD_X = (0, 1, 1)  # a thin rod along x

CYLINDER, SCREW, CARDAN = "cylindrical", "{type: helical, pitch: 1}", "{type: universal, axes: xy}"

#: title: what the last joint is (a kind of the URDF, an entry), what it moves, whether that resists all its motions
LEAVES: dict[str, tuple[str, str, str, bool]] = {
    "a revolute that moves nothing": ("revolute", "", NONE, False),
    "a revolute that moves a point on its axis": ("revolute", "", _inertial(1, POINT, (0, 0, 3)), False),
    "a revolute that moves a point off its axis": ("revolute", "", _inertial(1, POINT, (1, 0, 0)), True),
    "a revolute about a thin rod": ("revolute", "", _inertial(1, ROD_X, rpy=(0, np.pi / 2, 0)), False),
    "a revolute across a thin rod": ("revolute", "", _inertial(1, ROD_X), True),
    "a revolute that moves a flywheel without mass": ("revolute", "", _inertial(0, (0, 0, 1)), True),
    "a continuous joint that moves a point on its axis": ("continuous", "", _inertial(1, POINT), False),
    "a slider that moves a point": ("prismatic", "", _inertial(1, POINT), True),
    "a slider that moves a flywheel without mass": ("prismatic", "", _inertial(0, (1, 1, 1)), False),
    "a slider that moves nothing": ("prismatic", "", NONE, False),
    "a ball that moves a point off its centre": ("revolute", "spherical", _inertial(1, POINT, (1, 2, 3)), False),
    "a ball that moves a rod through its centre": ("revolute", "spherical", _inertial(1, ROD_X, (1, 0, 0)), False),
    "a ball that moves a rod beside its centre": ("revolute", "spherical", _inertial(1, ROD_X, (0, 1, 0)), True),
    "a ball that moves a body": ("revolute", "spherical", _inertial(1, (1, 1, 1)), True),
    "a cardan that moves a point on its first axis": ("revolute", CARDAN, _inertial(1, POINT, (1, 0, 0)), True),
    "a cardan that moves a point on its second axis": ("revolute", CARDAN, _inertial(1, POINT, (0, 1, 0)), False),
    "a cylindrical joint that moves a point off its axis": ("revolute", CYLINDER, _inertial(1, POINT, (1, 0, 0)), True),
    "a cylindrical joint that moves a point on its axis": ("revolute", CYLINDER, _inertial(1, POINT, (0, 0, 1)), False),
    "a cylindrical joint that moves a flywheel without mass": ("revolute", CYLINDER, _inertial(0, (1, 1, 1)), False),
    "a screw that moves a point on its axis": ("revolute", SCREW, _inertial(1, POINT), True),
    "a screw that moves a flywheel without mass": ("revolute", SCREW, _inertial(0, (0, 0, 1)), True),
    "a screw that moves a moment about another axis": ("revolute", SCREW, _inertial(0, (1, 0, 0)), False),
    "a planar joint that moves a point": ("planar", "", _inertial(1, POINT, (1, 2, 3)), False),
    "a planar joint that moves a rod in its plane": ("planar", "", _inertial(1, ROD_X, (1, 2, 3)), True),
    "a planar joint that moves a flywheel without mass": ("planar", "", _inertial(0, (1, 1, 1)), False),
    "a free joint that moves a rod": ("floating", "", _inertial(1, ROD_X, (1, 2, 3)), False),
    "a free joint that moves a body": ("floating", "", _inertial(1, (1, 1, 1), (1, 2, 3)), True),
    "a free joint that moves a point at its origin": ("floating", "", _inertial(1, POINT), False),
    "a locked joint that moves nothing": ("revolute", "fixed", NONE, True),
}


def _leaf(kind: str, inside: str, more: str = "") -> str:
    """base -j- tip, where j turns or slides about z."""
    content = "" if kind == "floating" else f'<axis xyz="0 0 1"/>{LIMIT}'
    origin = '<origin xyz="1 2 3" rpy="0.1 0.2 0.3"/>'
    return robot(
        link_element("base", _inertial(1, (1, 1, 1))),
        link_element("tip", inside),
        joint_element("j", kind, "base", "tip", content, origin),
        more,
    )


@pytest.mark.parametrize("title", LEAVES)
def test_leaf_rule_agrees_with_mass_matrix(title: str) -> None:
    kind, entry, inertial, resists = LEAVES[title]
    urdf, yaml = _leaf(kind, inertial), f"joints: {{j: {entry}}}\n" if entry else ""
    found = [code for code in codes(urdf, yaml) if code != "inertia-triangle"]
    assert found == ([] if resists else ["leaf-without-inertia"])
    loaded = load(urdf, yaml)
    coordinates = {"j": (0.7, 0.3)} if "universal" in entry else {}
    smallest = np.linalg.eigvalsh(mass_matrix(loaded.model, q_of(loaded, coordinates))).min(initial=1.0)
    assert (smallest > 1e-10) == resists
