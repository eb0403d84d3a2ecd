"""The transmission prepared once, for control loops: positions and their derivatives both ways at each cycle."""

from __future__ import annotations

from collections.abc import Iterable
from contextlib import suppress
from typing import TYPE_CHECKING, Any, Literal, NamedTuple

import numpy as np

from eurdf.array import Matrix, Vector
from eurdf.errors import NoTransmission
from eurdf.kinematics.named import Named, vector_of
from eurdf.loading import of_any_robot
from eurdf.transmissions.array_kernel import ArrayMap
from eurdf.transmissions.array_tables import array_tables, python_source
from eurdf.transmissions.c_source import c_source
from eurdf.transmissions.drive import STEPS, Drive, closed_pose
from eurdf.transmissions.first_guess import Prediction, Ranges, WorkspacePoses, sign_of
from eurdf.transmissions.generated_source import GeneratedSource
from eurdf.transmissions.motors import sides
from eurdf.transmissions.reachable_set import grid_axes
from eurdf.transmissions.ros2_package import ros2_package
from eurdf.transmissions.selection import Selection
from eurdf.transmissions.transmission import Transmission, at_one

if TYPE_CHECKING:
    from eurdf.pinocchio.robot import Robot


class MotorSide(NamedTuple):
    """The motors at positions of the serial joints.

    Attributes:
        positions: Positions (nm,) of the motors, rad or m.
        G: (nm, nJ) with v_m = G v_J and τ_J = Gᵀ τ_m.
    """

    positions: Vector
    G: Matrix


class SerialSide(NamedTuple):
    """The serial joints at positions of the motors.

    Attributes:
        positions: Positions (nJ,) of the serial joints, rad or m.
        B: (nJ, nm) with v_J = B v_m; G⁻¹ where G is square.
    """

    positions: Vector
    B: Matrix


class PreparedTransmission:
    """Positions and velocities of motors and serial joints at any pose of a workspace, on its branch.

    The workspace is that around the first pose. In it, a call does not depend on those before: for one or two joints,
    polynomials predict the pose, and two Newton steps make it exact; for more, a path leads from the last pose if that
    is near, or from the nearest one of some poses of the workspace. Beyond it, or if its joints have no limits, a
    straight path leads from the pose of the call before, on its branch.

    The workspace is searched by the first call that needs it, which takes some tenths of a second. A call with an error
    keeps the pose of the call before. Use one object for each thread.

    Attributes:
        joints: Names of the serial joints.
        motors: Names of the motors.
    """

    def __init__(self, at: Transmission, joints: Selection, motors: Selection, ranges: Ranges | None = None) -> None:
        self._at, self._joints, self._motors = at, joints, motors
        self.joints, self.motors = at.joints, at.motors
        self._first = self._q = at.q
        self._by_joints = Drive(at, joints, motors)
        self._by_motors: Drive | None = None
        self._workspace = WorkspacePoses(at.robot, joints, motors, self._first, ranges)
        self._predictions: dict[Selection, Prediction | None] = {}
        # Last positions of joints without limits, whose turns are counted from call to call.
        self._angles: dict[Selection, Vector] = {}

    def __getstate__(self) -> Any:
        """What is pickled and copied: what makes it, and where it is. The working memory is made anew."""
        kept = ("_first", "_q", "_workspace", "_predictions")
        position = {name: getattr(self, name) for name in kept} | {"_angles": dict(self._angles)}
        return (self._at, self._joints, self._motors), position

    def __setstate__(self, state: Any) -> None:
        made_of, position = state
        self.__init__(*made_of)  # type: ignore[misc]
        self.__dict__.update(position)

    @property
    def q(self) -> Vector:
        """The last pose (nq,), closed. Joints that the transmission does not move are as at the beginning."""
        return np.array(self._q)

    def reset(self, q: Named) -> None:
        """Start from another closed pose (nq,), which can be on another branch. It is the first pose from here on.

        The workspace around it is searched anew.

        Raises:
            NotClosable: The loops cannot be closed near q.
            ValueError: ``q`` is not a configuration.
        """
        self._first = self._q = closed_pose(self._at.robot, q)
        self._angles.clear()
        self._workspace, self._predictions = self._workspace.around(self._first), {}

    def start_at_joints(self, positions: Named) -> None:
        """Start at positions (nJ,) of the serial joints; beyond the workspace from the first pose, not the last one.

        Turns are counted from here. The errors are those of `at_joints`.
        """
        self._start_at(self._by_joints, positions)

    def start_at_motors(self, positions: Named) -> None:
        """Start at positions (nm,) of the motors; beyond the workspace from the first pose, not the last one.

        Turns are counted from here. The errors are those of `at_motors`.
        """
        self._start_at(self._drive_of_motors, positions)

    def at_joints(self, positions: Named) -> MotorSide:
        """The motors at positions (nJ,) of the serial joints, rad or m; zero for joints that are not named.

        An angle without limits counts turns: it is within half a turn of that of the call before.

        Raises:
            NotClosable: The loops cannot be closed at the positions.
            TooFar: They can, but not everywhere on the straight path from the last pose.
            NoTransmission: The joints do not determine the motors there.
            ValueError: ``positions`` does not fit.
        """
        return MotorSide(*self._move(self._by_joints, positions))

    def at_motors(self, positions: Named) -> SerialSide:
        """The serial joints at positions (nm,) of the motors, rad or m.

        Turns are counted, and errors raised, as by `at_joints`; here the motors have to determine the joints.
        """
        return SerialSide(*self._move(self._drive_of_motors, positions))

    def c_source(
        self,
        prefix: str | None = None,
        *,
        steps: int = STEPS,
        substeps: int = 16,
        real: Literal["double", "float"] = "double",
    ) -> GeneratedSource:
        """The same as dependency-free C99: a header and a source file.

        Each function allocates nothing, takes a bounded number of steps, and returns a status: ``NOT_CLOSED`` where
        Python raises `NotClosable`, ``TOO_FAR`` for `TooFar`, ``SINGULAR`` for `NoTransmission`, ``NOT_FINITE`` for
        `ValueError`. The functions from motors to joints are left out where the motors depend on each other.

        A call at a cycle takes fewer substeps than in Python and does not search for closed poses. It
        returns ``TOO_FAR`` where it does not reach the positions. It returns G, and its inverse if the motors determine
        the joints.

        Args:
            prefix: Of the names in C, and name of the files. By default the robot's name and ``_transmission``.
            steps: Maximum number of Newton steps in a substep, after the first one.
            substeps: Maximum number of substeps of a path, in a call at a cycle.
            real: The type of the numbers. With ``float``, loops are closed to 1e-6 m and rad instead of 1e-11.

        Returns:
            The files. Their first pose is the last one here.

        Raises:
            ValueError: An argument does not fit; or a joint or constraint is of a type that C does not support.
        """
        drives = [self._by_joints]
        with suppress(NoTransmission):
            drives.append(self._drive_of_motors)
        return c_source(drives, self._workspace, self._q, prefix, steps, substeps, real)

    def ros2_package(
        self, prefix: str | None = None, *, real: Literal["double", "float"] = "double"
    ) -> GeneratedSource:
        """The C in a package of ROS 2: a ``transmission_interface::Transmission`` that ros2_control's hardware loads.

        The class is header-only and maps positions, velocities and efforts both ways. With it are its loader, a plugin
        of pluginlib; the files of ament_cmake; and ``transmission.xml``, the element for the URDF.

        Args:
            prefix: As in `c_source`; the name of the package is this and ``_ros2``.
            real: As in `c_source`.

        Returns:
            The files, by their path in the package.

        Raises:
            NoTransmission: The motors do not determine the joints, or depend on each other.
            ValueError: As in `c_source`.
        """
        _ = self._drive_of_motors  # raises the error
        source = self.c_source(prefix, real=real)
        return ros2_package(source, self._at.robot.mechanism.name, self.joints, self.motors, real)

    def array_map(self, xp: Any) -> ArrayMap:
        """The map from joints to motors for arrays of many positions, on the branch of the first pose.

        The first call searches the workspace, which takes some seconds.

        Args:
            xp: A namespace of the array API: NumPy, `jax.numpy`, torch, …

        Raises:
            ValueError: There are not as many motors as joints; a joint or constraint of the loops is of another type
                than the map supports; or polynomials do not predict the poses of the workspace well enough.
        """
        return ArrayMap(xp, array_tables(self._by_joints, self._workspace))

    def python_source(self, prefix: str | None = None) -> GeneratedSource:
        """The same as `array_map` as one Python file without dependencies, with a function ``array_map(xp)``.

        Args:
            prefix: The name of the file without ``.py``; by default the robot's name and ``_transmission``.

        Raises:
            ValueError: The prefix is no identifier, or as `array_map` raises.
        """
        return python_source(self._by_joints, self._workspace, prefix)

    @property
    def _drive_of_motors(self) -> Drive:
        if self._by_motors is None:
            self._by_motors = Drive(self._at, self._motors, self._joints)
        return self._by_motors

    def _move(self, drive: Drive, positions: Named) -> tuple[Vector, Matrix]:
        asked = drive.asked
        q, derivative = self._closed_at(drive, self._q, vector_of(positions, drive.given.names, "positions"))
        found = asked.read(q)
        if asked.circular.any():
            before = self._angles.get(asked, asked.read(self._q))
            found = self._angles[asked] = asked.nearest(found, before)
        self._q = q
        return found, derivative

    def _prediction(self, drive: Drive) -> Prediction | None:
        """The polynomials of the positions that a drive is given, made when first asked for."""
        if drive.given not in self._predictions:
            self._predictions[drive.given], _ = self._workspace.prediction(drive)
        return self._predictions[drive.given]

    def _closed_at(self, drive: Drive, origin: Vector, positions: Vector) -> tuple[Vector, Matrix]:
        """The closed pose (nq,) at the positions, and the derivative there; beyond the workspace from an origin."""
        prediction = self._prediction(drive)
        if prediction is not None:
            motion = prediction.motion(positions)
            found = motion is not None and drive.predicted(prediction.reference, motion, positions, prediction.error)
            if found:
                there, D = drive.derived(found)
                if sign_of(D) == prediction.sign:  # else there is a dead point between
                    return there, D
            return drive.move(origin, positions)
        near = drive.near(origin, positions)
        nearest = self._workspace.nearest(drive.given, positions) if near is None else None
        if nearest is not None:
            _, near = drive.along(nearest, positions)
        return drive.move(origin, positions) if near is None else drive.derived(near)

    def _start_at(self, drive: Drive, positions: Named) -> None:
        given, asked = drive.given, drive.asked
        positions = vector_of(positions, given.names, "positions")
        q, _ = self._closed_at(drive, self._first, positions)
        self._angles = {
            given: np.array(positions),
            asked: asked.nearest(asked.read(q), asked.read(self._first)),
        }
        self._q = q

    def __repr__(self) -> str:
        return f"<PreparedTransmission: motors {', '.join(self.motors)}; joints {', '.join(self.joints)}>"


@of_any_robot
def prepare_transmission(
    robot: Robot,
    joints: str | Iterable[str],
    q: Named | None = None,
    *,
    motors: str | Iterable[str] | None = None,
    ranges: Ranges | None = None,
) -> PreparedTransmission:
    """Prepare the transmission between serial joints and motors for a control loop.

    Newton's method starts from a predicted pose: with r(q) = 0 the constraints, x the other joints of the loops and g
    the given ones, K_x Δx = -r with g held, and dx/dg = -K_x⁺ K_g at the solution. Beyond the workspace it starts from
    the pose of the call before; where the motion since then is long, where it does not converge in few steps, or where
    these are not small against the first one, the motion is divided into substeps on a straight path. Springs are held
    as in `eurdf.transmission`.

    Args:
        robot: The robot.
        joints: Names of the serial joints.
        q: A pose to start from (nq,); it decides on the branch. The loops are closed first if they are open. The
            default is the `assembled` configuration, or the neutral one if there is none.
        motors: Names of the motors. By default the actuated joints that move the joints, as in `eurdf.transmission`.
        ranges: Of the workspace that calls do not depend on the last pose in, as in `workspace`.

    Raises:
        NotClosable: The loops cannot be closed near q.
        NoTransmission: The joints do not determine the motors, or depend on each other.
        ValueError: An argument does not fit.
    """
    serial, by = sides(robot, joints, motors)
    first = closed_pose(robot, q)
    if ranges is not None:
        grid_axes(robot, serial, serial.read(first), None, ranges)  # an error is for the one who gave them
    return PreparedTransmission(at_one(robot, serial, first, by), serial, by, ranges)
