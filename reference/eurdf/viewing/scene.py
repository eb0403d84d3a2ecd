"""What is drawn of a robot: surfaces fixed to bodies, axes, frames and closures, and where they are at a configuration.

Knows no viewer and no renderer.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING, Any, Literal

import coal
import numpy as np
import pinocchio as pin

from eurdf.array import Matrix, Vector
from eurdf.closures.se3 import quaternion_of
from eurdf.convert.inertia import along_principal_axes
from eurdf.kinematics.evaluate import Frames, frames_at
from eurdf.kinematics.opening import Opening
from eurdf.kinematics.residual import all_openings
from eurdf.mechanism.body import Anchor
from eurdf.mechanism.joint import Joint
from eurdf.mechanism.pose import X, Y, Z, direction
from eurdf.pinocchio.frames import body_frame_ids, placement_of
from eurdf.pinocchio.memory import working_memory
from eurdf.viewing.surface import Surface, sphere, surface_of

if TYPE_CHECKING:
    from eurdf.pinocchio.robot import Robot

Kind = Literal["visual", "collision", "inertia"]
Color = tuple[float, float, float, float]

#: Red, green, blue, alpha from 0 to 1.
COLLISION: Color = (0.95, 0.6, 0.1, 0.45)
INERTIA: Color = (0.25, 0.45, 0.9, 0.5)


@dataclass(frozen=True, slots=True, eq=False)
class BodySurface:
    """A surface fixed to a body.

    Attributes:
        kind: What it is.
        body: Index of the body.
        pose: Pose of the surface in the body's frame, `pin.SE3`.
        surface: Its triangles.
        color: Red, green, blue, alpha from 0 to 1.
    """

    kind: Kind
    body: int
    pose: Any
    surface: Surface
    color: Color

    def vertices_at(self, placed: PlacedRobot) -> Matrix:
        """The vertices (n, 3) in the world, m."""
        oMp = placed.pose(self.body) * self.pose
        return np.asarray(self.surface.vertices @ oMp.rotation.T + oMp.translation)


@dataclass(frozen=True, slots=True, eq=False)
class Axis:
    """An axis of a moving joint.

    Attributes:
        joint: Name of the joint.
        body: Index of the child body, to which the axis is fixed here.
        origin: A point (3,) on it, in the child's frame, m.
        direction: Unit vector (3,), in the child's frame.
        actuated: Whether the joint is actuated.
    """

    joint: str
    body: int
    origin: Vector
    direction: Vector
    actuated: bool


@dataclass(frozen=True, slots=True, eq=False)
class Link:
    """A closure or contact between two bodies.

    Attributes:
        name: Name of the closure.
        bodies: Indices of the bodies that carry frame A and frame B; -1 is the world.
        poses: Poses of A and B in these bodies, `pin.SE3`.
    """

    name: str
    bodies: tuple[int, int]
    poses: tuple[Any, Any]


@dataclass(frozen=True, slots=True, eq=False)
class PlacedRobot:
    """A robot at a configuration.

    Attributes:
        poses: Pose of each body in the world (n, 7): position, m, and quaternion x, y, z, w.
        openings: How far each constraint is open, in file order.
    """

    poses: Matrix
    openings: tuple[Opening, ...]

    @property
    def origins(self) -> Matrix:
        """Origin of each body in the world (n, 3), m."""
        return self.poses[:, :3]

    @property
    def wxyzs(self) -> Matrix:
        """Orientation of each body in the world (n, 4): quaternion w, x, y, z."""
        return self.poses[:, (6, 3, 4, 5)]

    def pose(self, body: int) -> Any:
        """Pose of a body in the world, `pin.SE3`; that of the world, -1, is the identity."""
        return pin.SE3.Identity() if body < 0 else pin.XYZQUATToSE3(self.poses[body])


def wxyz(pose: Any) -> Vector:
    """Orientation of a pose, `pin.SE3`: quaternion w, x, y, z."""
    x, y, z, w = pin.SE3ToXYZQUAT(pose)[3:]
    return np.array((w, x, y, z))


class Scene:
    """What can be drawn of a robot.

    Attributes:
        robot: The robot.
        bodies: Names of the bodies.
        parents: For each body the index of the one that it hangs from; -1 for the root.
        parts: The surfaces.
        axes: The axes of the moving joints.
        frames: The frames of the description: name, index of the body, pose in it.
        links: The closures.
        size: Length of the diagonal of the robot's bounding box in the configuration it was made at, m.
        center: Center (3,) of that box.
        lowest: Least height of that box, m.
    """

    def __init__(self, robot: Robot, q: Vector) -> None:
        """Collect what there is, with the shapes that were loaded; q (nq,) is a configuration that shows the size."""
        mechanism = robot.mechanism
        self.robot = robot
        self.bodies = tuple(body.name for body in mechanism.bodies)
        index = {name: number for number, name in enumerate(self.bodies)}
        self.parents = (-1, *(index[joint.parent] for joint in mechanism.joints))
        self.parts = (*_shapes(robot, "visual"), *_shapes(robot, "collision"), *_ellipsoids(robot))
        actuated = set(mechanism.actuators)
        self.axes = tuple(
            axis for joint in mechanism.joints for axis in _axes(joint, index[joint.child], joint.name in actuated)
        )
        self.frames = tuple((each.name, index[each.body], placement_of(each.pose)) for each in mechanism.frames)
        self.links = tuple(
            Link(
                closure.name,
                (index.get(closure.a.body, -1), index[closure.b.body]),
                (placement_of(closure.a.pose), placement_of(closure.b.pose)),
            )
            for closure in (*mechanism.closures, *mechanism.contacts)
        )
        points = self._points(self.at(q))
        low, high = points.min(axis=0), points.max(axis=0)
        self.size = float(np.linalg.norm(high - low)) or 1.0
        self.center: Vector = (low + high) / 2.0
        self.lowest = float(low[2])

    @property
    def has_visuals(self) -> bool:
        """Whether there is a visual shape."""
        return any(part.kind == "visual" for part in self.parts)

    def at(self, q: Vector) -> PlacedRobot:
        """Where everything is at a configuration (nq,)."""
        with working_memory(self.robot, _body_frames) as memory:
            (rotations,), (origins,) = memory.poses(memory.at(q[None]))
            poses = np.concatenate((origins, quaternion_of(rotations)), axis=1)
            return PlacedRobot(poses, all_openings(self.robot, q))

    def skeleton(self, placed: PlacedRobot) -> Matrix:
        """Lines (n, 2, 3) from the origin of each body to that of its parent, in the world, m."""
        pairs = [(parent, child) for child, parent in enumerate(self.parents) if parent >= 0]
        return placed.origins[np.array(pairs, dtype=np.intp).reshape(-1, 2)]

    def axis_lines(self, placed: PlacedRobot) -> Matrix:
        """The axes (n, 2, 3) as lines in the world, m."""
        half = 0.05 * self.size
        lines = [
            [placed.pose(axis.body).act(axis.origin + side * half * axis.direction) for side in (-1.0, 1.0)]
            for axis in self.axes
        ]
        return np.array(lines).reshape(-1, 2, 3)

    def closure_lines(self, placed: PlacedRobot) -> Matrix:
        """For each closure three lines, (n, 3, 2, 3), in the world, m.

        They lead from the origin of the body of A to A, from A to B, and from B to the origin of its body. A place in
        the world is connected to nothing else.
        """
        lines = []
        for link in self.links:
            (a, b), (in_a, in_b) = (placed.pose(body) for body in link.bodies), link.poses
            points = (a.translation, a.act(in_a.translation), b.act(in_b.translation), b.translation)
            points = (points[1], *points[1:]) if link.bodies[0] < 0 else points
            lines.append([points[:2], points[1:3], points[2:]])
        return np.array(lines).reshape(-1, 3, 2, 3)

    def _points(self, placed: PlacedRobot) -> Matrix:
        clouds = [placed.origins]
        for part in self.parts:
            if part.kind != "inertia" and len(part.surface.vertices):
                clouds.append(part.vertices_at(placed))
        return np.concatenate(clouds)


def _body_frames(robot: Robot) -> Frames:
    tree = robot.tree
    return frames_at(tree, [tree.site(Anchor(body.name)) for body in robot.mechanism.bodies], few=True)


def _shapes(robot: Robot, kind: Literal["visual", "collision"]) -> list[BodySurface]:
    if robot.geometry is None:
        return []
    geometry_model = robot.geometry.visual if kind == "visual" else robot.geometry.collision
    ids = body_frame_ids(robot.mechanism)
    numbers = {ids[body.name]: number for number, body in enumerate(robot.mechanism.bodies)}
    meshes: dict[tuple[str, tuple[float, ...]], Surface] = {}
    parts = []
    for shape in geometry_model.geometryObjects:
        frame = robot.model.frames[shape.parentFrame]
        if isinstance(shape.geometry, coal.BVHModelBase):
            # A mesh that several shapes share is converted once.
            key = shape.meshPath, tuple(np.asarray(shape.meshScale).tolist())
            surface = meshes[key] = meshes.get(key) or surface_of(shape.geometry)
        else:
            surface = surface_of(shape.geometry)
        red, green, blue, alpha = np.clip(shape.meshColor, 0.0, 1.0).tolist()
        color = (red, green, blue, alpha) if kind == "visual" else COLLISION
        parts.append(
            BodySurface(kind, numbers[shape.parentFrame], frame.placement.actInv(shape.placement), surface, color)
        )
    return parts


def _ellipsoids(robot: Robot) -> list[BodySurface]:
    """For each body with mass the ellipsoid of constant density with the same mass and moments of inertia."""
    parts = []
    for number, body in enumerate(robot.mechanism.bodies):
        if body.inertia is None or not body.inertia.mass > 0.0:
            continue
        found = along_principal_axes(body.inertia)
        moments = np.array(found.moments)[[0, 3, 5]]
        # Of half axes a, b, c: a² = 5/2 (I_b + I_c - I_a) / m. Moments that no body can have, which a diagnostic
        # reports, make a half axis of 0.
        half_axes = np.sqrt(np.maximum(2.5 * (moments.sum() - 2.0 * moments) / found.mass, 0.0))
        parts.append(BodySurface("inertia", number, placement_of(found.pose), sphere().scaled(half_axes), INERTIA))
    return parts


def _axes(joint: Joint, body: int, actuated: bool) -> list[Axis]:
    """The axes of a joint, fixed to its child: three for a ball, those of the plane and its normal for a planar one."""
    if joint.type.nv in (0, 6):
        return []
    in_child = placement_of(joint.offset).inverse()
    return [
        Axis(joint.name, body, in_child.translation, in_child.rotation @ np.array(direction(axis)), actuated)
        for axis in joint.axes or (X, Y, Z)
    ]
