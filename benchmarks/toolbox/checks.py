"""Calls of the published functions, by row, and what comes of them."""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np
import pinocchio as pin
import yaml

import eurdf
from benchmarks.toolbox.calls import checkout
from benchmarks.toolbox.outcome import (
    Agrees,
    Case,
    Compare,
    Fails,
    Off,
    Outcome,
    frame_error,
    more_motor,
    opening,
    same,
    stretch,
)
from benchmarks.toolbox.robots import PUBLISHED

#: Robots of the cases, with a frame that their motors move. One has 6d closures, one 3d ones; the rows of the planar
#: one are redundant.
FRAMES = {"digit_leg": "foot", "digit_leg_3d": "foot", "five_bar": "tool"}
SIX, THREE, PLANAR = ("digit_leg",), ("digit_leg_3d",), ("five_bar",)
LEGS, ALL = SIX + THREE, SIX + THREE + PLANAR
NONE = ()


@dataclass(frozen=True)
class Check:
    """A call of their side, and what comes of it.

    Attributes:
        call: An expression of `benchmarks.toolbox.theirs`; ``{f}`` is each name of the row.
        compare: How far its value is from ours, or from what it should be.
        old: With Pinocchio 3.4, for which it was written.
        new: With Pinocchio 4.1, if it is something else.
        what: What is compared, where the row does not say so.
        robots: Of the collection.
    """

    call: str
    compare: Compare
    old: Outcome
    new: Outcome | None = None
    what: str = ""
    robots: tuple[str, ...] = ALL


def K(of: Case) -> Any:  # noqa: N802 - as in the specification
    """The constraint Jacobian at q."""
    return eurdf.residual_and_jacobian(of.robot, of.q)[1]


def passive(of: Case) -> Any:
    """Indices of the velocities without a motor."""
    return np.setdiff1d(np.arange(of.robot.model.nv), of.robot.actuation.idx_v)


def nearest(of: Case) -> Any:
    """The closed configuration nearest to the open one."""
    return eurdf.project_configuration(of.robot, of.near)


def locked_mass_matrix(of: Case) -> Any:
    """M at the neutral configuration, the first motor locked there."""
    locked = eurdf.lock(of.robot, of.robot.actuation.joints[0], pin.neutral(of.robot.model))
    return eurdf.mass_matrix(locked, pin.neutral(locked.model))


def dynamics(of: Case) -> Any:
    """Torques and closure forces of the motion."""
    return eurdf.inverse_dynamics(of.robot, of.q, of.vc, of.ac)


def nearest_torques(of: Case, u0: Any) -> Any:
    """The torques nearest to given ones, where one motor is superfluous."""
    folder = Path(eurdf.__file__).parents[2] / "robots" / of.name
    said = yaml.safe_load((folder / "robot.yaml").read_text(encoding="utf-8"))
    said["actuators"].append(more_motor(of.robot))
    robot = eurdf.load(said, folder / "robot.urdf", geometry=False)
    return eurdf.inverse_dynamics(robot, of.q, of.vc, of.ac, u0=u0).u


def _same_closures(_: object, theirs: Any) -> float:
    ours = eurdf.generate(checkout() / "robots" / "cassie_like" / "robot.urdf").found.closures
    return float({frozenset(pair) for pair in theirs} != {frozenset(each.frames) for each in ours})


def nothing(_: Any, __: Any) -> float:
    """For a call that fails: whatever it returned would be wrong."""
    return float("inf")


def is_(number: float) -> Compare:
    """The difference to a number."""
    return same(lambda _: number)


EQUAL = Agrees(0.0)
NO_SIZE = Fails("'RigidConstraintModel' object has no attribute 'size'", "no `RigidConstraintModel.size`")
NO_MOTORS = Fails("'ActuationModel' object has no attribute 'nv_mot'", "no `ActuationModel.nv_mot`")
UNFIT = Fails("did not match C++ signature", "other arguments of `pin.initConstraintDynamics`")
NO_MODULE = Fails("No module named", "a module is missing")
SOLVER = Fails("Solver failed", "the solver")
BY_HAND = "attributes set by hand"
LENGTHS = "lengths of quaternions"

_RESIDUAL = same(lambda of: eurdf.residual(of.robot, of.near))
_SPLIT_Q = same(lambda of: np.concatenate(eurdf.split_configuration(of.robot, of.q)))
_SPLIT_V = same(lambda of: np.concatenate(eurdf.kinematics.split_velocity(of.robot, of.v)))
_DISTANCES = same(lambda of: np.linalg.norm(eurdf.residual(of.robot, of.near).reshape(-1, 3), axis=1))
_PARTS = same(lambda of: -np.hstack([K(of) @ of.S, K(of)[:, passive(of)]]))
_PROJECTED_V = same(lambda of: eurdf.project_velocity(of.robot, of.q, of.v))
_PROJECTED_A = same(lambda of: eurdf.project_acceleration(of.robot, of.q, of.vc, of.a))
_BY_MOTORS = same(lambda of: eurdf.kinematics.dq_dq_actuated(of.robot, of.q))
_FRAME_BY_MOTORS = same(lambda of: eurdf.actuated_jacobian(of.robot, of.frame, of.q))
_IDS = same(lambda of: [model.joint1_id for model in of.robot.constraint_models])
_MOTORS = same(lambda of: [of.robot.model.getJointId(name) for name in of.robot.actuation.joints])

_ALL = "model, data, cms, cds"
_FREEZE = "{f}(model, cms, am, visual, collision, [int(am.mot_joints_ids[0])])[0]"
_FORWARD = f"{{f}}({_ALL}, am, motors)"
_INVERSE = f"{{f}}({_ALL}, pin.SE3(target), q, frame_name)"
_TORQUES = "{f}(model, cms, q, vc, ac, S, 0.0 * u0[1:])"
_FOUND = "len({f}(with_frames('closedloop1_A closedloop1_B %s_A %s_B'), cstr_frames_ids=%s))"
_IMPORT = "importlib.import_module('example_parallel_robots.%s')"

CHECKS: dict[str, tuple[Check, ...]] = {
    "ActuationModel": (
        Check("am.mot_ids_v", same(lambda of: np.sort(of.robot.actuation.idx_v)), EQUAL),
        Check("len({f}(model, ['motor']).mot_ids_v)", is_(0.0), EQUAL, what="a part of a name selects nothing"),
        Check("str(am)", nothing, Fails("__str__ returned non-string", "it is no text"), what="`str()`"),
    ),
    "ActuationData": (
        Check("{f}(model, cms, am)", nothing, NO_MOTORS),
        Check(
            "completed(names)", nothing, Fails("negative dimensions", "fewer than six motors"), NO_SIZE, BY_HAND, PLANAR
        ),
        Check("completed(names).Smot", same(lambda of: of.S), EQUAL, NO_SIZE, BY_HAND, LEGS),
    ),
    "qmot qfree": (Check("np.concatenate([qmot(am, q), qfree(am, q)])", _SPLIT_Q, EQUAL),),
    "vmot vfree": (Check("np.concatenate([vmot(am, v), vfree(am, v)])", _SPLIT_V, EQUAL),),
    "mergeq mergev": (
        Check("mergeq(model, am, qmot(am, q), qfree(am, q))", same(lambda of: of.q), EQUAL),
        Check("mergev(model, am, vmot(am, v), vfree(am, v))", same(lambda of: of.v), EQUAL),
    ),
    "freezeJoints": (
        Check(f"neutral_mass_matrix({_FREEZE})", same(locked_mass_matrix), Agrees(1e-9), what="mass matrix"),
        Check(
            f"[{_FREEZE}, [c.joint1_id for c in cms]][1]", _IDS, Off(0.5, "changed"), what="joints of the given models"
        ),
    ),
    "freeze": (
        Check("neutral_mass_matrix(frozen(names))", same(locked_mass_matrix), Agrees(1e-9), what="mass matrix"),
    ),
    "constraintResidual6d": (
        Check(
            "np.hstack([{f}(model, data, c, d, near) for c, d in zip(cms, cds)])", _RESIDUAL, Agrees(1e-12), robots=SIX
        ),
    ),
    "constraintResidual3d": (
        Check(
            "np.linalg.norm([{f}(model, data, c, d, near) for c, d in zip(cms, cds)], axis=1)",
            _DISTANCES,
            Agrees(1e-12),
            what="distances",
            robots=THREE,
        ),
    ),
    "constraintResidual constraintsResidual": (
        Check(f"constraintsResidual({_ALL}, near)", _RESIDUAL, Agrees(1e-12), robots=SIX + PLANAR),
        Check("constraintResidual(model, data, cms[0], cds[0], near)", _RESIDUAL, Agrees(1e-12), robots=PLANAR),
    ),
    "separateConstraintJacobian": (
        Check(
            "np.hstack({f}(completed(names), np.vstack(jacobians(names))))",
            _PARTS,
            Agrees(1e-9),
            NO_SIZE,
            BY_HAND,
            LEGS,
        ),
    ),
    "pin.getConstraintJacobian": (
        Check("np.vstack(jacobians(names))", same(lambda of: -K(of)), Agrees(1e-9), what="after `calc`"),
        Check(
            "np.vstack(jacobians(names, calc=False))", same(lambda of: -K(of)), Agrees(1e-9), Off(0.5), "without `calc`"
        ),
    ),
    "closedLoopMount closedLoopMountCasadi": (
        Check(f"{{f}}({_ALL}, near)", same(nearest), Agrees(1e-6), robots=LEGS),
        Check(f"{{f}}({_ALL}, near)", nothing, SOLVER, robots=PLANAR),
    ),
    "closedLoopMountScipy": (
        Check(f"{{f}}({_ALL}, near)", same(nearest), Agrees(1e-3), robots=LEGS),
        Check(f"{{f}}({_ALL}, near)", opening, Off(0.01), what="opening", robots=PLANAR),
    ),
    "closedLoopMountProximal configurationProjectionProximal": (
        Check(f"{{f}}({_ALL}, near)", opening, Agrees(1e-9), NO_SIZE, "opening"),
    ),
    "configurationProjection": (Check(f"{{f}}({_ALL}, near)", same(nearest), Agrees(1e-6)),),
    "partialLoopClosure": (
        Check(f"{{f}}({_ALL}, [0], q_ref=near)", opening, Agrees(1e-4), what="opening"),
        Check(f"{{f}}({_ALL}, [0], q_ref=near)[0]", same(lambda of: of.near[0]), Agrees(1e-9), what="held joint"),
    ),
    "partialLoopClosureFrames": (
        Check(f"{{f}}({_ALL}, [frame], q_ref=q)", opening, Agrees(1e-4), what="opening", robots=LEGS),
        Check(
            f"{{f}}({_ALL}, [frame], q_ref=q)", nothing, Fails("waits for a key", "it waits for a key"), robots=PLANAR
        ),
    ),
    "closedLoopForwardKinematics closedLoopForwardKinematicsCasadi": (
        Check(
            _FORWARD, nothing, Fails("takes 4 positional arguments but 5 were given", "too many arguments of `mergev`")
        ),
    ),
    "closedLoopForwardKinematicsScipy": (
        Check(_FORWARD, opening, Agrees(1e-6), what="opening", robots=LEGS),
        Check(_FORWARD, stretch, Off(1e-4), what=LENGTHS, robots=LEGS),
        Check(_FORWARD, opening, Off(0.01), what="opening", robots=PLANAR),
        Check(
            f"{{f}}({_ALL}, am, motors, q)",
            nothing,
            Fails("could not be broadcast", "it compares `q_prec` with a list"),
            what="from a configuration",
        ),
    ),
    "closedLoopInverseKinematics closedLoopInverseKinematicsCasadi": (
        Check(_INVERSE, frame_error, Agrees(1e-6), what="frame", robots=LEGS),
        Check(_INVERSE, stretch, Off(1e-4), what=LENGTHS, robots=LEGS),
        Check(_INVERSE, nothing, SOLVER, robots=PLANAR),
    ),
    "closedLoopInverseKinematicsScipy": (
        Check(_INVERSE, frame_error, Agrees(1e-3), what="frame", robots=LEGS),
        Check(_INVERSE, frame_error, Off(0.01), what="frame", robots=PLANAR),
    ),
    "closedLoopInverseKinematicsProximal": (
        Check(f"{{f}}({_ALL}, pin.SE3(target), frame_name)", frame_error, Agrees(1e-6), NO_SIZE, "frame", SIX),
    ),
    "velocityProjection": (
        Check("{f}(model, data, q, v, cms, cds)", _PROJECTED_V, Agrees(1e-3), robots=SIX + PLANAR),
        Check("{f}(model, data, q, v, cms, cds)", _PROJECTED_V, Agrees(1e-3), Off(0.1), robots=THREE),
    ),
    "accelerationProjection": (
        Check("{f}(model, data, q, vc, a, cms, cds)", _PROJECTED_A, Agrees(1e-3), UNFIT, robots=SIX + PLANAR),
        Check(
            "{f}(model, data, q, vc, a, cms, cds)",
            nothing,
            Fails("proxsuite::proxqp", "sizes that do not match"),
            UNFIT,
            robots=THREE,
        ),
    ),
    "computeDerivative_dq_dqmot": (
        Check("{f}(am, completed(names), jacobians(names))", _BY_MOTORS, Agrees(1e-9), NO_SIZE, BY_HAND, LEGS),
    ),
    "computeClosedLoopFrameJacobian": (
        Check(f"{{f}}({_ALL}, am, completed(names), q, frame)", _FRAME_BY_MOTORS, Agrees(1e-9), NO_SIZE, BY_HAND, LEGS),
    ),
    "inverseConstraintKinematicsSpeed": (
        Check(
            f"{{f}}({_ALL}, am, completed(names), q, frame, twist)",
            nothing,
            Fails("could not broadcast input array", "too little room for the motors"),
            NO_SIZE,
            BY_HAND,
            LEGS,
        ),
    ),
    "closedLoopInverseDynamicsCasadi": (
        Check(f"{_TORQUES}[0]", same(lambda of: dynamics(of).u), Agrees(1e-3), NO_SIZE, "torques"),
        Check(
            f"{_TORQUES}[1]", same(lambda of: -np.hstack(dynamics(of).forces)), Agrees(1e-3), NO_SIZE, "forces", LEGS
        ),
        Check(
            "{f}(model, cms, q, vc, ac, more, u0)[0]",
            same(lambda of: nearest_torques(of, -of.u0)),
            Agrees(1e-3),
            NO_SIZE,
            "a motor more than needed, torques nearest to minus the given ones",
            LEGS,
        ),
    ),
    "models ROBOTS": (Check("len(ROBOTS)", is_(float(len(PUBLISHED))), EQUAL, what="how many", robots=NONE),),
    "TalosClosed": (
        Check(_IMPORT % "talos_closed", nothing, NO_MODULE, robots=NONE),
        Check(_IMPORT % "talos_closed_6d", nothing, NO_MODULE, robots=NONE),
    ),
    "talosOnlyLeg": (
        Check(
            _IMPORT % "talos_only_legs" + ".{f}()",
            nothing,
            Fails("talos_full_closed does not exist", "no robot of this name"),
            robots=NONE,
        ),
    ),
    "getYAMLcontents": (
        Check(
            "[model.getJointId(name) for name in {f}(folder, 'robot.v1.yaml')['name_mot']]",
            _MOTORS,
            EQUAL,
            what="motors",
        ),
    ),
    "generateYAML": (
        Check("[model.getJointId(name) for name in generated(folder)['name_mot']]", _MOTORS, EQUAL, what="motors"),
        Check("generated('robots/cassie_like')['closed_loop']", _same_closures, EQUAL, what="closures", robots=NONE),
    ),
    "getNameFrameConstraint": (
        Check(_FOUND % ("closedloop2", "closedloop2", [1, 2]), is_(2.0), EQUAL, what="1 and 2", robots=NONE),
        Check(
            _FOUND % ("closedloop10", "closedloop10", [1, 10]),
            is_(2.0),
            Off(0.5, "one is lost"),
            what="1 and 10",
            robots=NONE,
        ),
    ),
    "unitest_SimplifyModel": (Check("{f}()", nothing, NO_MODULE, robots=NONE),),
    "createSlidersInterface CheckboxConstraintCmd": (
        Check(
            "importlib.import_module('toolbox_parallel_robots.sliders.foo').{f}",
            nothing,
            Fails("No module named 'toolbox_parallel_robots.tk_robot_sliders'", "a module is missing"),
            robots=NONE,
        ),
    ),
    "addXYZAxisToFrames": (
        Check(
            "{f}(model, visual) or max(shape.parentJoint for shape in visual.geometryObjects)",
            same(lambda of: float(of.robot.model.njoints - 1)),
            Off(0.5, "not a joint of the model"),
            what="index of a joint",
        ),
    ),
    "addXYZAxisToJoints addXYZAxisToConstraints": (
        Check(
            "addXYZAxisToJoints(model, collision) or sum('XYZ' in shape.name for shape in collision.geometryObjects)",
            same(lambda of: float(of.robot.model.njoints)),
            EQUAL,
            what="number of spheres",
        ),
        Check(
            "addXYZAxisToConstraints(model, visual, cms) or sum('XYZ' in s.name for s in visual.geometryObjects)",
            same(lambda of: 2.0 * len(of.robot.constraints)),
            EQUAL,
            what="number of spheres",
        ),
    ),
    "renameConstraints": (
        Check(
            "{f}(SimpleNamespace(model=model, constraint_models=cms)) or len({c.name for c in cms})",
            same(lambda of: float(len(of.robot.constraints))),
            EQUAL,
            what="number of names",
        ),
    ),
}
