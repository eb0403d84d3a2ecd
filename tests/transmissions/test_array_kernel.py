"""The transmission as functions of arrays, in several namespaces, and as a file of its own."""

from __future__ import annotations

import ast
import importlib.util
import sys
from pathlib import Path
from types import ModuleType
from typing import Any

import array_api_strict
import numpy as np
import pytest

import eurdf
from support.mechanisms import one_loop
from support.transmissions import DRIVEN, OF_TWO_JOINTS

ANKLE = DRIVEN["unitree_g1_ankle"]
FAST = ("unitree_g1_ankle", "digit_leg", "five_bar")


def namespace(name: str) -> Any:
    """A namespace of the array API, in double precision."""
    if name == "array_api_strict":
        return array_api_strict
    if name == "jax.numpy":
        pytest.importorskip("jax").config.update("jax_enable_x64", True)
    return pytest.importorskip(name)


@pytest.fixture(scope="module")
def ankle() -> Any:
    """The prepared ankle of the G1, positions of its workspace (N, 2), and its map in NumPy."""
    robot = eurdf.load("unitree_g1_ankle", geometry=False)
    prepared = eurdf.transmissions.prepare_transmission(robot, ANKLE)
    return prepared, eurdf.transmissions.workspace(robot, ANKLE, grid=6).positions, prepared.array_map(np)


@pytest.mark.parametrize(
    ("name", "joints"),
    [
        pytest.param(name, joints, marks=[] if name in FAST else [pytest.mark.slow])
        for name, joints in [*OF_TWO_JOINTS, ("kangaroo_leg", DRIVEN["kangaroo_leg"])]
    ],
)
def test_it_is_exact_everywhere_in_the_workspace(name: str, joints: tuple[str, ...]) -> None:
    robot = eurdf.load(name, geometry=False)
    ranges = dict.fromkeys(joints, (-0.5, 0.5)) if len(joints) > 2 else {}
    prepared = eurdf.transmissions.prepare_transmission(robot, joints, ranges=ranges)
    space = eurdf.transmissions.workspace(robot, joints, grid=4 if len(joints) > 2 else 6, ranges=ranges)
    found = prepared.array_map(np).at_joints(space.positions)
    prepared.reset(space.first)
    for k, position in enumerate(space.positions):
        expected = prepared.at_joints(position)
        assert found.positions[k] == pytest.approx(expected.positions, abs=1e-9)
        assert found.G[k] == pytest.approx(expected.G, rel=1e-8, abs=1e-8)
        assert found.B[k] @ expected.G == pytest.approx(np.eye(len(joints)), abs=1e-7)


@pytest.mark.parametrize(
    ("types", "closure", "seed", "options"),
    [
        (("revolute", "helical", "spherical", "cylindrical"), "6d", 1, {}),
        (("continuous", "prismatic", "spherical", "universal"), "6d", 16, {}),
        (("revolute", "continuous", "spherical", "revolute"), "hinge", 3, {}),
        (("prismatic", "revolute", "revolute", "prismatic"), "3d", 1, {}),
        (("revolute", "revolute"), "distance", 6, {}),
        (("revolute", "revolute", "universal", "prismatic"), "3d", 1, {"coupled": True}),
        (("revolute", "revolute", "spherical", "universal"), "6d", 23, {"follower": True}),
    ],
)
def test_every_joint_and_constraint_is_supported(
    types: tuple[str, ...], closure: str, seed: int, options: dict[str, bool]
) -> None:
    robot = one_loop(types, closure, seed, **options)
    start = np.array(robot.mechanism.configurations["assembled"]["j0"])
    ranges = {"j0": (float(start[0]) - 0.05, float(start[0]) + 0.05)}
    prepared = eurdf.transmissions.prepare_transmission(robot, "j0", ranges=ranges)
    positions = start + np.linspace(-0.05, 0.05, 9)[:, None]
    found = prepared.array_map(np).at_joints(positions)
    for k, position in enumerate(positions):
        expected = prepared.at_joints(position)
        assert found.positions[k] == pytest.approx(expected.positions, abs=1e-9)
        assert found.G[k] == pytest.approx(expected.G, rel=1e-8, abs=1e-8)
        assert found.B[k] == pytest.approx(1.0 / expected.G, rel=1e-7)


@pytest.mark.parametrize("name", ["array_api_strict", "torch", "jax.numpy"])
def test_namespaces_agree(ankle: Any, name: str) -> None:
    prepared, positions, expected = ankle
    xp = namespace(name)
    found, torque = prepared.array_map(xp), np.full_like(positions, 60.0)
    for dtype, bound in ((xp.float64, 1e-11), (xp.float32, 1e-4)):
        q, asked, most = (
            xp.asarray(each.tolist(), dtype=dtype) for each in (positions, torque, np.array([25.0, 20.0]))
        )
        pairs = [
            *zip(found.at_joints(q), expected.at_joints(positions), strict=True),
            (found.torque_limits(q, most), expected.torque_limits(positions, np.array([25.0, 20.0]))),
            (found.clip(q, asked, most), expected.clip(positions, torque, np.array([25.0, 20.0]))),
            (found.reflected_inertia(q, 0.01), expected.reflected_inertia(positions, 0.01)),
            *zip(found.halfplanes, expected.halfplanes, strict=True),
        ]
        for k, (one, other) in enumerate(pairs):
            assert k > 5 or one.dtype == dtype
            least = bound if k <= 5 else 1e-6
            np.testing.assert_allclose(np.asarray(one), other, rtol=least, atol=least)


def test_motors_differentiate_to_their_matrix(ankle: Any) -> None:
    prepared, positions, expected = ankle
    G = expected.at_joints(positions).G
    torch = namespace("torch")
    q = torch.asarray(positions).requires_grad_()
    motors = prepared.array_map(torch).at_joints(q).positions
    for k in range(2):
        (gradient,) = torch.autograd.grad(motors[:, k].sum(), q, retain_graph=True)
        np.testing.assert_allclose(gradient, G[:, k], atol=1e-7)


@pytest.mark.slow
def test_jax_compiles_and_differentiates(ankle: Any) -> None:
    prepared, positions, expected = ankle
    found, jax = prepared.array_map(namespace("jax.numpy")), pytest.importorskip("jax")
    at = expected.at_joints(positions)
    for one, other in zip(jax.jit(found.at_joints)(positions), at, strict=True):
        np.testing.assert_allclose(one, other, atol=1e-11)
    jacobian = jax.jit(jax.vmap(jax.jacfwd(lambda q: found.at_joints(q).positions)))
    np.testing.assert_allclose(jacobian(positions), at.G, atol=1e-7)


def test_torques_and_inertia_are_those_of_the_transmission(ankle: Any) -> None:
    prepared, positions, found = ankle
    robot, asked = eurdf.load("unitree_g1_ankle", geometry=False), np.array([70.0, 30.0])
    for k in range(0, len(positions), 5):
        prepared.at_joints(positions[k])
        at = eurdf.transmission(robot, ANKLE, prepared.q)
        clipped = at.joint_torque(np.clip(at.motor_torque(asked), -20.0, 20.0))
        assert found.clip(positions[k], asked, 20.0) == pytest.approx(clipped, rel=1e-7)
        limits = eurdf.transmissions.serial_limits(robot, ANKLE, prepared.q)
        assert found.torque_limits(positions[k], 25.0) == pytest.approx(limits.torque_axes[:, 1], rel=1e-7)
        inertia = eurdf.transmissions.reflected_inertia(
            robot, ANKLE, prepared.q, armature={"motor_a": 0.003, "motor_b": 0.004}
        )
        rotors = found.reflected_inertia(positions[k], np.array([0.003, 0.004]))
        assert rotors == pytest.approx(inertia.rotors, rel=1e-7, abs=1e-12)


@pytest.mark.parametrize(("name", "joints"), [("unitree_g1_ankle", ANKLE), ("five_bar", OF_TWO_JOINTS[-1][1])])
def test_halfplanes_are_in_the_workspace(name: str, joints: tuple[str, ...]) -> None:
    robot = eurdf.load(name, geometry=False)
    found = eurdf.transmissions.prepare_transmission(robot, joints).array_map(np)
    (A, b), space = found.halfplanes, eurdf.transmissions.workspace(robot, joints, grid=31)
    inside = (space.positions @ A.T <= b).all(axis=1)
    assert found.covered > 0.6
    assert inside.mean() == pytest.approx(found.covered, abs=0.15)
    nodes = np.stack([each.ravel() for each in np.meshgrid(*space.axes, indexing="ij")], axis=1)
    reached = space.on_grid(np.ones(len(space.q))).ravel() == 1.0
    deep = (b - nodes @ A.T).min(axis=1) > 0.02  # more than what the boundary bends between points of its grid
    assert reached[deep].all()


def test_other_positions_give_nan(ankle: Any) -> None:
    _, positions, found = ankle
    other = np.array([[2.0, 0.0], [np.nan, 0.0], [0.5, 0.3], *positions[:1]])
    for each in found.at_joints(other):
        assert np.isnan(each).reshape(4, -1).all(axis=1).tolist() == [True, True, True, False]


def test_unsuitable_arrays_are_refused(ankle: Any) -> None:
    *_, found = ankle
    for wrong in ([0.0, 0.0], np.zeros(2, int)):
        with pytest.raises(TypeError, match="array of floating-point numbers"):
            found.at_joints(wrong)
    with pytest.raises(ValueError, match=r"shape \(3,\); the map needs \(\.\.\., 2\): free_pitch, free_roll"):
        found.at_joints(np.zeros(3))
    assert found.at_joints(np.zeros((0, 3, 2))).G.shape == (0, 3, 2, 2)


def test_maps_that_do_not_exist_name_the_reason() -> None:
    loop = one_loop(["revolute", "revolute", "floating"], "6d", 7, coupled=True)
    with pytest.raises(ValueError, match="'j2' is floating"):
        eurdf.transmissions.prepare_transmission(loop, "j0", ranges={"j0": (-0.1, 0.1)}).array_map(np)
    bars, motors = eurdf.load("four_bar", geometry=False), ["motor_crank", "free_coupler"]
    with pytest.raises(ValueError, match="as many motors as joints; here 1 joints have 2 motors"):
        eurdf.transmissions.prepare_transmission(bars, "free_rocker", motors=motors).array_map(np)


def test_the_file_is_the_same_without_eurdf(ankle: Any, tmp_path: Path) -> None:
    prepared, positions, found = ankle
    (path,) = prepared.python_source("ankle").write(tmp_path)
    text = path.read_text(encoding="utf-8")
    imports = [each for each in ast.walk(ast.parse(text)) if isinstance(each, ast.Import | ast.ImportFrom)]
    modules = {name.name if isinstance(each, ast.Import) else each.module for each in imports for name in each.names}
    assert {str(module).partition(".")[0] for module in modules} <= {"__future__", *sys.stdlib_module_names}
    for one, other in zip(module(path).array_map(np).at_joints(positions), found.at_joints(positions), strict=True):
        np.testing.assert_array_equal(one, other)


def module(path: Path) -> ModuleType:
    """A Python file, imported."""
    spec = importlib.util.spec_from_file_location(path.stem, path)
    assert spec is not None
    assert spec.loader is not None
    made = importlib.util.module_from_spec(spec)
    spec.loader.exec_module(made)
    return made
