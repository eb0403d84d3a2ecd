"""The rows of the page: every public function of the published code, what it computes, ours, and the difference."""

from __future__ import annotations

from dataclasses import dataclass


@dataclass(frozen=True)
class Row:
    """Functions of theirs that do the same.

    Attributes:
        theirs: Their names, separated by blanks.
        computes: What they compute.
        ours: The same in this package.
        difference: What is unlike.
        unrun: Why nothing runs them; empty if `benchmarks.toolbox.checks` has calls of them.
    """

    theirs: str
    computes: str
    ours: str
    difference: str
    unrun: str = ""


COORDINATES = (
    Row(
        "ActuationModel",
        "which joints are actuated",
        "`robot.actuation`",
        "theirs selects the joints whose names are equal to given ones; a name without a joint is ignored in silence, "
        "in ours it is an error. `str()` of theirs fails",
    ),
    Row(
        "ActuationData",
        "work memory and selection matrices",
        "`robot.actuation.selection`",
        "no work memory; S (nv, nu) in file order. Theirs uses attributes that `ActuationModel` does not set; if you "
        "set them by hand, it needs six motors or more",
    ),
    Row(
        "qmot qfree",
        "the actuated and the other coordinates of q",
        "`eurdf.split_configuration`",
        "both at once; a wrong shape is an error",
    ),
    Row(
        "vmot vfree",
        "the same for a velocity",
        "`eurdf.kinematics.split_velocity`",
        "both at once; a wrong shape is an error",
    ),
    Row(
        "mergeq mergev",
        "one vector from the two parts",
        "`eurdf.merge_configuration`, `eurdf.kinematics.merge_velocity`",
        "a wrong shape is an error; no CasADi",
    ),
    Row(
        "freezeJoints",
        "a robot with joints locked",
        "`eurdf.lock`",
        "joints by name; the given robot is unchanged; mimic joints, frames and configurations are kept; what lost its "
        "meaning is listed; `eurdf.errors.LockedOpen` if a closure would stay open",
    ),
    Row(
        "freeze",
        "the same for a `RobotWrapper` with constraint models",
        "`eurdf.lock`",
        "theirs changes the robot that it is given",
    ),
)

CLOSURES = (
    Row(
        "constraintResidual6d",
        "log₆ of the pose of B in A",
        "`eurdf.residual`",
        "the same six numbers (EU-CLO-008)",
    ),
    Row(
        "constraintResidual3d",
        "the difference of the two origins",
        "`eurdf.residual`",
        "theirs: A minus B, expressed in the world; ours: the origin of B in A (EU-CLO-009)",
    ),
    Row(
        "constraintResidual constraintsResidual",
        "the residual of one closure, of all",
        "`eurdf.residual`, `eurdf.residual_and_jacobian`",
        "all at once, with the exact derivative; `eurdf.kinematics.closure_openings` gives metres and radians for each "
        "closure",
    ),
    Row(
        "separateConstraintJacobian",
        "its actuated columns, and the others",
        "`eurdf.residual_and_jacobian`",
        "K S with `robot.actuation.selection`; the other columns are those not in `robot.actuation.idx_v`",
    ),
    Row(
        "pin.getConstraintJacobian",
        "rows of a constraint Jacobian, by Pinocchio; their functions use it",
        "`eurdf.residual_and_jacobian`",
        "minus K at a closed configuration. In Pinocchio 4 call `constraint_model.calc(model, data, constraint_data)` "
        "before, which theirs do not; in Pinocchio 3 there is no such call",
    ),
)

CONFIGURATIONS = (
    Row(
        "closedLoopMount closedLoopMountCasadi",
        "the nearest closed configuration within limits",
        "`eurdf.project_configuration`, `eurdf.assemble`",
        "`project_configuration` finds the nearest, without limits; `assemble` is fast, finds a near one and restarts "
        "if it gets stuck, with `limits=True` within limits. Redundant rows, as of a planar loop with a 6d closure, "
        "are allowed",
    ),
    Row(
        "closedLoopMountScipy",
        "the nearest closed configuration",
        "`eurdf.project_configuration`",
        "theirs does not report a failure: with redundant rows it returns the open start",
    ),
    Row(
        "closedLoopMountProximal configurationProjectionProximal",
        "a closed configuration",
        "`eurdf.assemble`",
        "states whether it converged; theirs returns the result after 100 steps; for a 3d closure theirs uses the "
        "linear part of log₆, ours the origin of B in A",
    ),
    Row(
        "configurationProjection",
        "the nearest closed configuration, weighted",
        "`eurdf.project_configuration`",
        "weights as a matrix or a diagonal; `eurdf.errors.NotClosable` if none exists, where theirs waits for a key",
    ),
    Row(
        "partialLoopClosure",
        "the least open configuration with some joints held, within limits",
        "`eurdf.assemble` with `hold`, `hold_at` and `limits`",
        "joints by name; also a ball joint about some of its axes, where theirs holds an entry of its rotation matrix",
    ),
    Row(
        "partialLoopClosureFrames",
        "the least open configuration with some frames held, within limits",
        "`eurdf.inverse_kinematics`",
        "the frames by name, with their poses; `hold` holds joints, too",
    ),
    Row(
        "closedLoopForwardKinematics closedLoopForwardKinematicsCasadi",
        "the configuration with given motor positions",
        "`eurdf.forward_kinematics`",
        "stays on the branch of `q0`; any joints, also by name; springs are in equilibrium, without gravity; limits "
        "are ignored; `eurdf.errors.NotClosable` if the positions cannot be reached",
    ),
    Row(
        "closedLoopForwardKinematicsScipy",
        "the same",
        "`eurdf.forward_kinematics`",
        "as above. Theirs starts at the neutral configuration alone, and takes quaternions for four numbers, so that "
        "they do not keep their length",
    ),
    Row(
        "closedLoopInverseKinematics closedLoopInverseKinematicsCasadi",
        "a configuration with one frame at a target",
        "`eurdf.inverse_kinematics`",
        "one or several frames; a position instead of `onlytranslation`; within joint limits by default; limits of 0 "
        "and 0, as in a URDF without limits, are ignored; the result gives the error of each frame and its reason. "
        "Theirs takes quaternions for four numbers",
    ),
    Row(
        "closedLoopInverseKinematicsScipy",
        "the same",
        "`eurdf.inverse_kinematics`",
        "as above; theirs does not report a failure",
    ),
    Row(
        "closedLoopInverseKinematicsProximal",
        "the same",
        "`eurdf.inverse_kinematics`",
        "as above; theirs starts at the neutral configuration, and returns the result after 100 steps",
    ),
)

VELOCITIES = (
    Row(
        "velocityProjection",
        "the nearest velocity that keeps the loops closed",
        "`eurdf.project_velocity`",
        "exact, not an optimization solved to 1e-5; may be weighted. Theirs calls no `calc`",
    ),
    Row(
        "accelerationProjection",
        "the nearest such acceleration",
        "`eurdf.project_acceleration`",
        "exact; also with 3d closures, where theirs has six numbers on the right and three rows on the left; may be "
        "weighted, for example by the mass matrix",
    ),
    Row(
        "computeDerivative_dq_dqmot",
        "the derivative of all velocities by the motor velocities",
        "`eurdf.kinematics.dq_dq_actuated`",
        "the same matrix if the motors are independent; otherwise `eurdf.errors.DependentActuators` names the "
        "dependent ones. Theirs uses attributes that its models do not have",
    ),
    Row(
        "computeClosedLoopFrameJacobian",
        "the Jacobian of a frame by the motors",
        "`eurdf.actuated_jacobian`",
        "theirs in the frame's own axes; ours in these or in the world's axes",
    ),
    Row(
        "inverseConstraintKinematicsSpeed",
        "the velocity of all joints that gives a frame a twist",
        "`eurdf.differential_inverse_kinematics`",
        "v = C (J C)⁺ twist, bounded near singular configurations; dependent actuators are allowed; the twist in the "
        "axes that you choose. Theirs reserves room for six motors less than there are",
    ),
)

DYNAMICS = (
    Row(
        "closedLoopInverseDynamicsCasadi",
        "motor torques and closure forces of a motion",
        "`eurdf.inverse_dynamics`",
        "the forces have the opposite sign: theirs act on the body of A, ours on the body of B; finds the "
        "torques nearest to `u0`, weighted, where theirs finds those nearest to **minus** the given ones; "
        "external forces, damping and friction; `eurdf.errors.InconsistentMotion` for a motion that opens the loops, "
        "`eurdf.errors.UnderactuatedMotion` for one that the motors cannot produce; "
        "`eurdf.kinematics.achievable_acceleration` gives the nearest possible one",
    ),
)

FILES = (
    Row(
        "load completeRobotLoader getModelPath",
        "a robot by its name, or from a folder",
        "`eurdf.load`",
        "one call; errors raise `eurdf.InvalidRobot`, with line and column; theirs continues with defaults",
        "for [each of their robots](#their-robots)",
    ),
    Row("models ROBOTS", "the names of their robots", "`eurdf.collection_names`", "a list; theirs prints"),
    Row(
        "FiveBarLinkage FiveBarLinkageIso3D FiveBarLinkageIso6D Cassie Digit DigitBiped DigitBiped6d Disney "
        "DisneyBiped Kangaroo KangarooBiped Delta TalosLeg TalosBiped WL16 BattoBot",
        "where the files of a robot are, and whether its root floats",
        "`eurdf.load`",
        "a folder has the name of its robot; `root` is in the file",
        "not run: only data",
    ),
    Row(
        "TalosClosed",
        "Talos, from `example-robot-data`, with rods and closures added",
        '`eurdf.load("talos_2legs")`, `eurdf.load("talos_2legs_6d")`',
        "files in place of a program. Theirs needs `example_robot_data`, MeshCat and "
        "`sandbox_pinocchio_parallel_robots`, which is not published",
    ),
    Row(
        "talosOnlyLeg",
        "Talos with its upper body locked",
        '`eurdf.lock(eurdf.load("talos_2legs"), joints)`',
        "theirs loads a robot by a name that `load` does not know",
    ),
    Row(
        "getYAMLcontents",
        "what a YAML file says",
        "`robot.mechanism`",
        "checked, and names looked up; your own keys are in `robot.mechanism.own_data`, a mapping from the JSON "
        "pointer of a key to its value",
    ),
    Row(
        "generateYAML",
        "a YAML file from the names of joints and frames",
        "`eurdf.generate`, `eurdf generate`",
        "names are options; theirs makes every closure 6d, and writes over a `robot.yaml` that exists",
    ),
    Row(
        "getNameFrameConstraint",
        "the closures, from the names of frames",
        "`eurdf.generate`, `eurdf generate`",
        "theirs looks for parts of names: with a `closedloop10`, it loses `closedloop1`",
    ),
    Row(
        "simplifyModel",
        "three revolute joints through one point become a ball joint",
        "`eurdf.load`, in version 1; `eurdf.simplify`, for all versions",
        "`completeRobotLoader` does it to each robot; theirs does not see continuous joints",
        "for [each of their robots](#their-robots)",
    ),
    Row("unitest_SimplifyModel", "an example of `simplifyModel`", "", "calls it with too few arguments"),
)

PICTURES = (
    Row(
        "createSlidersInterface CheckboxConstraintCmd",
        "a window with sliders that move a robot",
        "[`eurdf view`](view.md)",
        "theirs imports its parts from where they are no longer",
    ),
    Row(
        "SlidersFrame SlidersManager",
        "parts of this window",
        "[`eurdf view`](view.md)",
        "no window of its own system: a page of the browser",
        "not run: needs Tk and a screen",
    ),
    Row(
        "addXYZAxisToFrames",
        "a sphere at each frame",
        "[`eurdf view`](view.md), which shows frames",
        "theirs gives each sphere the index of its frame as the index of a joint",
    ),
    Row(
        "addXYZAxisToJoints addXYZAxisToConstraints",
        "a sphere at each joint, at each frame of a closure",
        "[`eurdf view`](view.md), which shows axes and closures",
        "shapes of the robot are unchanged",
    ),
    Row(
        "renameConstraints",
        "names of closures, from the names of their joints",
        "the name of a closure in its file",
        "version 1 has no names: they are `closure_1`, …",
    ),
    Row(
        "addViewerBox addViewerSphere applyViewerConfiguration visualizeConstraints addFrames meshcat_material "
        "meshcat_transform replaceGeomByXYZAxis",
        "shapes in a window of MeshCat or Gepetto-viewer",
        "[`eurdf view`](view.md), `eurdf.view`",
        "closures and frames are shown without a call",
        "not run: needs a window of these viewers",
    ),
)

#: The table of each place on the page.
TABLES = {
    "coordinates": COORDINATES,
    "closures": CLOSURES,
    "configurations": CONFIGURATIONS,
    "velocities": VELOCITIES,
    "dynamics": DYNAMICS,
    "files": FILES,
    "pictures": PICTURES,
}
ROWS = tuple(row for rows in TABLES.values() for row in rows)
