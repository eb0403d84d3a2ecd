"""3d closures of the same two bodies that are one hinge, or one 6d closure."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from lxml import etree

import eurdf
from eurdf.closures.point import PointClosure
from eurdf.mechanism.body import Anchor
from eurdf.mechanism.pose import IDENTITY, Pose
from eurdf.pinocchio.robot import build_robot
from eurdf.writing.joined_closures import JoinedClosures, join_points
from support import by_hand

#: Points in a body, m, and the type of the closures that they become.
SHAPES: dict[str, tuple[list[tuple[float, float, float]], list[str]]] = {
    "point": ([(0.1, 0.2, 0.3)], ["3d"]),
    "two": ([(0.1, 0.2, 0.3), (0.1, 0.2, 0.4)], ["hinge"]),
    "line": ([(0.1, 0, 0), (0.2, 0.02, 0.01), (0.4, 0.06, 0.03)], ["hinge"]),
    "triangle": ([(0, 0, 0), (0.3, 0, 0), (0, 0.2, 0)], ["6d"]),
    "tetrahedron": ([(0, 0, 0), (0.3, 0, 0), (0, 0.2, 0), (0, 0, 0.1)], ["6d"]),
    "one point twice": ([(0.1, 0.2, 0.3), (0.1, 0.2, 0.3)], ["3d", "3d"]),
}


def joined(points: Any, others: Any, turned: bool = False) -> JoinedClosures:
    """The closures of points in body a, and others in body b, every second one stated from b to a."""
    closures = []
    for index, (p, q) in enumerate(zip(points, others, strict=True)):
        ends = [Anchor("a", Pose(tuple(map(float, p)))), Anchor("b", Pose(tuple(map(float, q))))]
        closures.append(PointClosure(f"c{index}", *(reversed(ends) if turned and index % 2 else ends)))
    return join_points(closures, {"a": ("a", IDENTITY), "b": ("b", IDENTITY)})


@given(shape=st.sampled_from(sorted(SHAPES)), seed=st.integers(0, 99), six_digits=st.booleans(), turned=st.booleans())
def test_points_become_what_they_hold(shape: str, seed: int, six_digits: bool, turned: bool) -> None:
    points, types = SHAPES[shape]
    there = by_hand.some_pose(np.random.default_rng(seed))  # of body b in body a, where the points meet
    here = [there.inverse().act(point) for point in points]
    if six_digits:
        here = [tuple(float(f"{number:.6g}") for number in point) for point in here]
    found = joined(points, here, turned)
    assert [closure.type for closure in found.closures] == types
    assert found.apart == ()
    (closure, *_) = found.closures
    a, b = there.inverse() * closure.a.pose, closure.b.pose
    np.testing.assert_allclose(a.xyz, b.xyz, atol=1e-5)
    for axes in [closure.axes] if closure.type == "hinge" else [(e, e) for e in np.eye(3)] if types == ["6d"] else []:
        np.testing.assert_allclose(a.rotate(tuple(axes[0])), b.rotate(tuple(axes[1])), atol=1e-4)


@pytest.mark.parametrize(
    ("points", "others"),
    [
        ([(0, 0, 0), (0, 0, 0.1)], [(0, 0, 0), (0, 0, 0.1001)]),  # not as far apart
        ([(0, 0, 0), (0, 0, 0)], [(0, 0, 0), (0, 0, 0.1)]),
        (SHAPES["tetrahedron"][0], np.array(SHAPES["tetrahedron"][0]) * (1, 1, -1)),  # a mirror image
    ],
)
def test_points_that_cannot_meet_are_not_joined(points: Any, others: Any) -> None:
    found = joined(points, others)
    assert found.closures[-1].type == "3d"
    assert len(found.closures) > 1


@pytest.mark.parametrize("name", ["doggo_leg", "double_wishbone", "screw_press", "toddlerbot_2legs"])
def test_hinges_of_two_connects_without_names_return(name: str, tmp_path: Path) -> None:
    # As onshape-to-robot writes them: two unnamed <connect> of sites, positions with six digits.
    robot = eurdf.load(name, geometry=False)
    path = eurdf.export(robot, "mjcf").write(tmp_path)[0]
    tree = etree.parse(path)
    for element in tree.iter("connect"):
        del element.attrib["name"]
        for site in tree.xpath("//site[@name=$a or @name=$b]", a=element.get("site1"), b=element.get("site2")):
            site.set("pos", " ".join(f"{float(word):.6g}" for word in site.get("pos", "0 0 0").split()))
    tree.write(path)
    imported = eurdf.import_robot(path)
    there = build_robot(imported.mechanism, geometry=False)
    kinds = [sorted(each.type for each in one.mechanism.closures) for one in (robot, there)]
    assert kinds[0] == kinds[1]
    assert imported.closes
    before, after = eurdf.analyze(robot), eurdf.analyze(there)
    driven = sum(constraint.type == "coupling" for constraint in there.mechanism.constraints)
    driven -= sum(constraint.type == "coupling" for constraint in robot.mechanism.constraints)  # mimic joints
    assert (after.mobility, after.rank, after.nc) == (before.mobility, before.rank + driven, before.nc + driven)
    hinges = {closure.name for closure in there.mechanism.closures if closure.type == "hinge"}
    assert {loss.name for loss in imported.losses if loss.code == "import-joined-points"} == hinges
