"""The solvers in JavaScript, run by Node.js, give what the reference gives."""

from __future__ import annotations

import json
import subprocess
import tempfile
from collections.abc import Sequence
from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np
import pinocchio as pin
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

import eurdf
from eurdf.kinematics.position_limit import position_limits
from eurdf.pinocchio.robot import build_robot
from eurdf.writing.description import describe_mechanism
from support.described import strut
from support.linkage import described, n_bar
from support.mechanisms import closed_tree, one_loop
from support.places import ROBOTS
from support.processes import JAVASCRIPT, why_not_installed
from support.wild import FACTS, WILD

MISSING = why_not_installed("yaml", "saxes")
pytestmark = pytest.mark.skipif(bool(MISSING), reason=MISSING)

PROGRAM = """
import { readFileSync } from "node:fs";
import { read } from "extended-urdf";
import * as closing from "extended-urdf/closing";
import { Mechanism } from "extended-urdf/mechanism";
const answers = JSON.parse(readFileSync(0, "utf8")).map(({ description, urdf, queries }) => {
  const { robot, diagnostics } = read({
    description: description && { name: "robot.yaml", text: description },
    urdf: { name: "robot.urdf", text: urdf },
  });
  if (!robot) throw new Error(JSON.stringify(diagnostics));
  const mechanism = new Mechanism(robot);
  let drive;
  const special = {
    drive: (q) => { drive = new closing.Drive(mechanism, q); },
    move: (...given) => drive.move(...given),
  };
  const ask = (name, given) => (special[name] ?? closing[name].bind(null, mechanism))(...given);
  return queries.map(([name, ...given]) => ask(name, given));
});
process.stdout.write(JSON.stringify(answers));
"""

FEW = ("digit_leg", "delta", "robotiq_2f85", "toddlerbot_2legs")
ALL = (*eurdf.collection_names(), *(name for name, facts in FACTS.items() if facts["closes"]))
robots = pytest.mark.parametrize(
    "names", [pytest.param(FEW, id="few"), pytest.param(ALL, id="all", marks=pytest.mark.slow)]
)


class Subject:
    """A robot of the reference, and the texts of its two files."""

    def __init__(self, description: str, urdf: str) -> None:
        self.files = {"description": description, "urdf": urdf}
        with tempfile.TemporaryDirectory() as folder:
            for name, text in (("robot.yaml", description), ("robot.urdf", urdf)):
                (Path(folder) / name).write_text(text, encoding="utf-8")
            self.robot = eurdf.load(folder, geometry=False)
        self.first = eurdf.assemble(self.robot, tolerance=1e-12).q

    def named(self, q: Any) -> dict[str, list[float]]:
        return {joint: list(own) for joint, own in self.robot.joint_positions(q).items()}

    def poses(self, q: Any) -> Any:
        """Rotation and origin of each joint in the world (n, 12), at q (nq,) or by name."""
        data = self.robot.model.createData()
        pin.forwardKinematics(self.robot.model, data, self.robot.configuration(q) if isinstance(q, dict) else q)
        return np.array([np.r_[pose.rotation.ravel(), pose.translation] for pose in data.oMi])

    def pose(self, link: str, q: Any) -> Any:
        data, model = self.robot.model.createData(), self.robot.model
        pin.framesForwardKinematics(model, data, q)
        return data.oMf[model.getFrameId(link, pin.FrameType.BODY)].copy()

    def residual(self, q: dict[str, Any]) -> float:
        r, _ = eurdf.residual_and_jacobian(self.robot, self.robot.configuration(q))
        return float(np.abs(r).max(initial=0.0))


def collected(name: str) -> Subject:
    folder = WILD / name if name in FACTS else ROBOTS / name
    return Subject(*((folder / file).read_text(encoding="utf-8") for file in ("robot.yaml", "robot.urdf")))


def written(robot: eurdf.Robot) -> Subject:
    files = describe_mechanism(robot.mechanism)
    return Subject(files.yaml, files.urdf.decode())


def ask(cases: Sequence[tuple[Subject, Sequence[tuple[Any, ...]]]]) -> list[list[Any]]:
    """What the package answers to the queries of each robot: the name of a function, and arguments."""
    text = json.dumps([{**subject.files, "queries": queries} for subject, queries in cases])
    node = ["node", "--input-type=module", "-e", PROGRAM]
    done = subprocess.run(node, cwd=JAVASCRIPT, input=text, capture_output=True, text=True, check=False)
    assert done.returncode == 0, done.stderr
    answers: list[list[Any]] = json.loads(done.stdout)
    return answers


def ask_one(subject: Subject, *queries: tuple[Any, ...]) -> list[Any]:
    return ask([(subject, queries)])[0]


def sweepable(robot: eurdf.Robot) -> list[str]:
    return [name for name in robot.actuation.joints if len(robot.tree.velocities_of(name)) == 1]


def links_of(robot: eurdf.Robot) -> list[str]:
    """All but the root link."""
    return [frame.name for frame in robot.model.frames if frame.type == pin.FrameType.BODY][1:]


def assert_swept(subject: Subject, joint: str, found: dict[str, Any]) -> None:
    """The path in both directions is that of the reference, with its end and all configurations."""
    expected = eurdf.sweep(subject.robot, joint, subject.first, steps=4)
    for path, mine in ((expected.lower, found["lower"]), (expected.upper, found["upper"])):
        assert (mine["end"], mine["joint"], len(mine["configurations"])) == (
            path.end,
            path.joint,
            len(path.configurations),
        )
        assert mine["reached"] == pytest.approx(path.reached, abs=1e-9)
        for q, other in zip(path.configurations, mine["configurations"], strict=True):
            np.testing.assert_allclose(subject.poses(other), subject.poses(q), atol=1e-9)


@robots
def test_actuators_have_the_range_of_motion_of_the_reference(names: Sequence[str]) -> None:
    subjects = [collected(name) for name in names]
    joints = [sweepable(subject.robot)[:: max(1, len(subject.robot.actuation.joints) - 1)] for subject in subjects]
    cases = [
        (subject, [("sweep", subject.named(subject.first), joint, {"steps": 4}) for joint in own])
        for subject, own in zip(subjects, joints, strict=True)
    ]
    for subject, own, answers in zip(subjects, joints, ask(cases), strict=True):
        for joint, found in zip(own, answers, strict=True):
            assert_swept(subject, joint, found)


@robots
def test_analysis_is_that_of_the_reference(names: Sequence[str]) -> None:
    subjects = [collected(name) for name in names]
    for subject, (found,) in zip(subjects, ask([(subject, [("analyze",)]) for subject in subjects]), strict=True):
        expected = eurdf.analyze(subject.robot)
        for key in ("nv", "nc", "rank", "mobility", "uncontrolled"):
            assert found[key] == getattr(expected, key), (subject.robot.mechanism.name, key)
        dependent = [set(together) for together in found["dependentActuators"]]
        assert dependent == [set(together) for together in expected.dependent_actuators]


@robots
def test_open_loops_close_where_those_of_the_reference_close(names: Sequence[str]) -> None:
    random = np.random.default_rng(2)
    subjects = [collected(name) for name in names]
    starts = [s.robot.tree.integrate(s.first, random.uniform(-0.05, 0.05, s.robot.tree.nv)) for s in subjects]
    cases = [
        (s, [("assemble", s.named(q)), ("assemble", s.named(q), {"limits": True})])
        for s, q in zip(subjects, starts, strict=True)
    ]
    for subject, q, answers in zip(subjects, starts, ask(cases), strict=True):
        robot, limits = subject.robot, position_limits(subject.robot)
        for found, within in zip(answers, (False, True), strict=True):
            expected = eurdf.assemble(robot, q, tolerance=1e-12, limits=within)
            assert found["closes"] == expected.closes
            if not expected.closes:
                continue
            assert found["open"] == []
            assert subject.residual(found["q"]) <= max(1e-11, 2.0 * expected.residual)
            end = robot.configuration(found["q"])
            # Where loops leave motions free, these depend on rounding.
            apart = robot.tree.difference(expected.q, end)
            np.testing.assert_allclose(apart, 0.0, atol=1e-5)
            np.testing.assert_allclose(eurdf.residual_and_jacobian(robot, end)[1] @ apart, 0.0, atol=1e-9)
            # Only joints of the loops move, so others may be beyond their limits.
            assert not within or (limits.excess(end) <= np.maximum(limits.excess(expected.q), 0.0) + 1e-9).all()


@robots
def test_dragged_link_reaches_what_the_loops_allow(names: Sequence[str]) -> None:
    random = np.random.default_rng(5)
    cases, subjects = [], [collected(name) for name in names]
    for subject in subjects:
        robot = subject.robot
        away = robot.tree.integrate(subject.first, random.uniform(-0.1, 0.1, robot.tree.nv))
        goal = eurdf.assemble(robot, position_limits(robot).clip(away), limits=True).q
        queries = []
        for link in random.choice(links_of(robot), 3).tolist():
            pose, point = subject.pose(link, goal), random.uniform(-0.1, 0.1, 3)
            task = {"link": link, "point": point.tolist(), "target": (pose * point).tolist()}
            queries += [
                ("drag", subject.named(subject.first), each)
                for each in (task, {**task, "rotation": pose.rotation.tolist()})
            ]
        cases.append((subject, queries))
    for (subject, queries), answers in zip(cases, ask(cases), strict=True):
        robot = subject.robot
        least, most = position_limits(robot).excess(subject.first), position_limits(robot)
        for (_, _, task), found in zip(queries, answers, strict=True):
            q = robot.configuration(found["q"])
            pose = subject.pose(task["link"], q)
            assert subject.residual(found["q"]) < 1e-9
            assert (most.excess(q) <= np.maximum(least, 0.0) + 1e-9).all()
            left = np.linalg.norm(pose * np.array(task["point"]) - task["target"])
            assert found["error"] == pytest.approx(left, abs=1e-9)
            assert left < 1e-6, (robot.mechanism.name, task, found["atLimits"])


def moved(subject: Subject, *moves: tuple[str, int, float]) -> list[Any]:
    """Where motions of coordinates, one after the other, lead from the first configuration, and what stops them."""
    drive = ("drive", subject.named(subject.first))
    _, *found = ask_one(subject, drive, *(("move", *move) for move in moves))
    assert all(subject.residual(each["q"]) < 1e-11 for each in found)
    return found


def test_actuators_lead_where_forward_kinematics_leads() -> None:
    for name in ("stewart_platform", "unitree_g1_ankle", "delta", "five_bar"):
        subject = collected(name)
        goals = {joint: subject.named(subject.first)[joint][0] + 0.02 for joint in sweepable(subject.robot)}
        found = moved(subject, *((joint, 0, goal) for joint, goal in goals.items()))
        assert [each["stop"] for each in found] == [None] * len(goals)
        expected = eurdf.forward_kinematics(subject.robot, list(goals.values()), subject.first)
        origins = [subject.poses(q)[:, 9:] for q in (found[-1]["q"], expected)]  # rods may turn about their lines
        np.testing.assert_allclose(*origins, atol=1e-9)


@pytest.mark.parametrize("kind", ["planar", "spherical", "floating"])
def test_coordinate_of_a_pose_moves_alone(kind: str) -> None:
    mechanism = strut(kind).mechanism
    subject = written(build_robot(mechanism, geometry=False))
    at = np.zeros({"planar": 3, "spherical": 3, "floating": 6}[kind])
    for index, value in ((0, 0.2), (len(at) - 1, -0.4), (1, 0.1)):
        at[index] = value
    found = moved(subject, ("mover", 0, 0.2), ("mover", len(at) - 1, -0.4), ("mover", 1, 0.1))
    assert [each["stop"] for each in found] == [None] * 3
    q = found[-1]["q"]["mover"]
    reached = q if kind == "planar" else [*q[:-4], *pin.log3(pin.Quaternion(np.array(q[-4:])).matrix())]
    np.testing.assert_allclose(reached, at, atol=1e-8)


def test_rotation_vector_stops_at_half_a_turn() -> None:
    mechanism = strut("spherical", 9.0).mechanism
    (found,) = moved(written(build_robot(mechanism, geometry=False)), ("mover", 2, 4.0))
    assert (found["stop"]["reason"], found["stop"]["joint"]) == ("half turn", "mover")
    assert found["stop"]["value"] == pytest.approx(np.pi, abs=1e-5)


def test_springs_decide_the_motion_that_no_actuator_controls() -> None:
    urdf, yaml = described(n_bar(5, "3d"))
    for springs in (
        "  j2: {stiffness: 7, rest: 0.2}\n",
        "  j1: {stiffness: 3, rest: 0.4}\n  j2: {stiffness: 7, rest: 0.2}\n",
    ):
        subject = Subject(f'extended_urdf: "2.1"\nurdf: robot.urdf\n{yaml}joints:\n{springs}', urdf)
        (actuator,) = subject.robot.actuation.joints
        (found,) = moved(subject, (actuator, 0, 0.3))
        np.testing.assert_allclose(
            subject.robot.configuration(found["q"]), eurdf.forward_kinematics(subject.robot, [0.3]), atol=1e-6
        )


def test_springs_press_passive_joints_against_their_limits() -> None:
    """The fingers of the gripper move parallel: the springs hold both couplers at their upper limit, 0."""
    subject = collected("robotiq_2f85")
    goals = (0.4, 0.7, 0.4)
    for goal, found in zip(goals, moved(subject, *(("motor", 0, goal) for goal in goals)), strict=True):
        held = {"motor": goal, "left_coupler_joint": 0.0, "right_coupler_joint": 0.0}
        expected = eurdf.forward_kinematics(subject.robot, held)
        np.testing.assert_allclose(subject.robot.configuration(found["q"]), expected, atol=1e-9)


def test_motion_stops_at_limits_and_dead_points() -> None:
    (limit,) = moved(collected("digit_leg"), ("motor_knee", 0, 2.0))
    assert (limit["stop"]["reason"], limit["stop"]["joint"]) == ("limit", "motor_knee")
    ankle = collected("unitree_g1_ankle")
    passive, again, back = moved(ankle, ("motor_a", 0, 1.0), ("motor_a", 0, 1.0), ("motor_a", 0, 0.0))
    assert (passive["stop"]["reason"], passive["stop"]["joint"]) == ("passive limit", "free_roll")
    assert passive["q"]["free_roll"][0] == pytest.approx(passive["stop"]["value"], abs=2e-9)
    assert again == passive
    assert back["stop"] is None
    five_bar = without_limits("five_bar")
    dead, home = moved(five_bar, ("motor_1", 0, 3.1), ("motor_1", 0, 0.0))
    assert dead["stop"]["reason"] == "dead point"
    assert dead["stop"]["value"] == pytest.approx(dead["q"]["motor_1"][0], abs=1e-9)
    np.testing.assert_allclose(five_bar.poses(home["q"]), five_bar.poses(five_bar.first), atol=1e-6)


def without_limits(name: str) -> Subject:
    """A robot of the collection whose revolute joints are continuous."""
    text = (ROBOTS / name / "robot.urdf").read_text(encoding="utf-8")
    yaml = (ROBOTS / name / "robot.yaml").read_text(encoding="utf-8")
    return Subject(yaml, text.replace('type="revolute"', 'type="continuous"'))


def test_dependent_actuator_is_blocked_unless_the_other_one_follows() -> None:
    yaml = (ROBOTS / "four_bar" / "robot.yaml").read_text(encoding="utf-8")
    urdf = (ROBOTS / "four_bar" / "robot.urdf").read_text(encoding="utf-8")
    subject = collected("four_bar")
    passive = next(joint for joint in subject.robot.slots if joint not in subject.robot.actuation.joints)
    both = Subject(yaml.replace("actuators: [motor_crank", f"actuators: [{passive}, motor_crank"), urdf)
    assert len(both.robot.actuation.joints) == 2
    (found,) = moved(both, ("motor_crank", 0, 0.5))
    assert found["stop"] is None
    assert found["q"]["motor_crank"][0] == pytest.approx(0.5, abs=1e-12)


TYPES = ["revolute", "continuous", "helical", "cylindrical", "universal", "planar", "spherical", "floating"]


@settings(max_examples=10, deadline=None)
@given(
    st.lists(st.sampled_from(TYPES), min_size=3, max_size=5),
    st.sampled_from(["3d", "6d", "hinge", "distance"]),
    st.integers(0, 2**16),
    st.booleans(),
    st.booleans(),
)
def test_random_loops_move_as_in_the_reference(
    types: list[str], kind: str, seed: int, follower: bool, coupled: bool
) -> None:
    robot = one_loop(["revolute", "prismatic", *types], kind, seed, follower=follower, coupled=coupled)
    subject = written(robot)
    first = subject.named(subject.first)
    analysis, found = ask_one(subject, ("analyze", first), ("sweep", first, "j1", {"steps": 4}))
    expected = eurdf.analyze(subject.robot, subject.first)
    assert (analysis["rank"], analysis["uncontrolled"]) == (expected.rank, expected.uncontrolled)
    assert_swept(subject, "j1", found)


def test_all_joints_and_constraints_move_on_fixed_and_floating_roots() -> None:
    for seed in range(2):
        robot, q = closed_tree(np.random.default_rng(seed), root="floating" if seed else "fixed")
        assembled = {"assembled": robot.joint_positions(q)}
        subject = written(build_robot(replace(robot.mechanism, configurations=assembled), geometry=False))
        first = subject.named(subject.first)
        analysis, *found = ask_one(
            subject, ("analyze",), *(("sweep", first, joint, {"steps": 4}) for joint in sweepable(robot))
        )
        expected = eurdf.analyze(subject.robot)
        assert (analysis["rank"], analysis["uncontrolled"]) == (expected.rank, expected.uncontrolled)
        for joint, each in zip(sweepable(robot), found, strict=True):
            assert_swept(subject, joint, each)
