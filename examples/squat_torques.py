"""Draws the motor torques of a squat, by inverse kinematics and inverse dynamics of a leg of Digit.

Run as ``python examples/squat_torques.py [FOLDER]``: it writes ``squat_torques.png``, for which it needs matplotlib.

The model holds the torso still. So here the foot goes up and down, flat and below the hip, which is a squat as seen
from the torso: there, everything weighs more by what the torso accelerates upwards, and the ground pushes the foot. The
leg carries itself and half the torso. What would tip them over sideways is left to the other leg, which does the same.
Joints have no friction here.
"""

from __future__ import annotations

import sys
from pathlib import Path
from typing import Any, NamedTuple

import numpy as np
import numpy.typing as npt
import pinocchio as pin
from scipy.spatial import ConvexHull

import eurdf

Array = npt.NDArray[np.float64]

PERIOD = 2.0  # s
DEPTH = 0.3  # m
SAMPLES = 200  # in a period
GRAVITY = 9.81  # m/s²
GROUND = -1.0224  # m, height of the underside of the sole, seen from the torso of the leg as drawn

#: Of each motor, what it is called, and the colour and the line it is drawn in.
MOTORS = {
    "motor_hip_x": ("hip roll", "#b9bcc2", "-"),
    "motor_hip_z": ("hip yaw", "#85898f", "--"),
    "motor_hip_y": ("hip pitch", "#20639b", "-"),
    "motor_knee": ("knee", "#d1495b", "-"),
    "motor_shin1": ("toe A", "#edae49", "-"),
    "motor_shin2": ("toe B", "#3caea3", "--"),
}


class Squat(NamedTuple):
    """A squat, at equal steps of time over one period. The axes are those of the torso, which stays upright.

    Attributes:
        robot: The robot.
        t: Times (n,), s.
        lowering: By how much the torso is below where it is when standing (n,), m.
        upwards: Acceleration of the torso (n,), m/s².
        q: Configurations (n, nq).
        v: Velocities (n, nv), rad/s.
        a: Accelerations (n, nv), rad/s².
        u: Motor torques (n, nu), N·m.
        ground: What the ground does to the foot (n, 6): force, N, and moment about the ankle, N·m.
    """

    robot: eurdf.Robot
    t: Array
    lowering: Array
    upwards: Array
    q: Array
    v: Array
    a: Array
    u: Array
    ground: Array


def main(folder: Path) -> Squat:
    """Find the squat, and write the picture of it.

    Raises:
        ModuleNotFoundError: There is no matplotlib.
    """
    figure = new_figure()
    found = squat()
    draw(found, figure)
    folder.mkdir(parents=True, exist_ok=True)
    figure.savefig(folder / "squat_torques.png", dpi=150)
    return found


def squat() -> Squat:
    """Find the motion, and the torques that it takes."""
    robot = eurdf.load("digit_leg")
    model = robot.model
    t = np.linspace(0.0, PERIOD, SAMPLES, endpoint=False)
    rate = 2.0 * np.pi / PERIOD
    lowering = DEPTH / 2.0 * (1.0 - np.cos(rate * t))
    upwards = -DEPTH / 2.0 * rate**2 * np.cos(rate * t)

    q = bent(robot, lowering)
    v, a = derivatives(robot, q, PERIOD / SAMPLES)
    achievable, u, ground = [], [], []
    for k in range(SAMPLES):
        model.gravity.linear = np.array([0.0, 0.0, -GRAVITY - upwards[k]])
        external = {"foot": ground_reaction(robot, q[k], v[k], a[k])}
        # The motors have no hold on the rods, which may spin about their own lines.
        achievable.append(eurdf.kinematics.achievable_acceleration(robot, q[k], v[k], a[k], external=external))
        u.append(eurdf.inverse_dynamics(robot, q[k], v[k], achievable[k], external=external).u)
        ground.append(external["foot"])
    return Squat(robot, t, lowering, upwards, q, v, np.array(achievable), np.array(u), np.array(ground))


def bent(robot: eurdf.Robot, lowering: Array) -> Array:
    """Configurations (n, nq) in which the foot is raised so much, each found from the one before."""
    q = robot.configurations["assembled"]
    pin.forwardKinematics(robot.model, robot.data, q)
    standing = pin.updateFramePlacement(robot.model, robot.data, robot.model.getFrameId("foot")).copy()
    found = []
    for height in lowering:
        foot = pin.SE3(standing.rotation, standing.translation + np.array([0.0, 0.0, height]))
        solution = eurdf.inverse_kinematics(robot, {"foot": foot}, q)
        if not solution.converged:
            raise ValueError(f"the leg cannot bend by {height:.3f} m: {solution.errors[0]}")
        q = solution.q
        found.append(q)
    return np.array(found)


def derivatives(robot: eurdf.Robot, q: Array, step: float) -> tuple[Array, Array]:
    """Velocities and accelerations (n, nv) of a periodic motion: central differences, put on the closures."""
    velocities, accelerations = [], []
    for before, here, after in zip(np.roll(q, 1, axis=0), q, np.roll(q, -1, axis=0), strict=True):
        ahead, behind = pin.difference(robot.model, here, after), pin.difference(robot.model, here, before)
        v = eurdf.project_velocity(robot, here, (ahead - behind) / (2.0 * step))
        velocities.append(v)
        accelerations.append(eurdf.project_acceleration(robot, here, v, (ahead + behind) / step**2))
    return np.array(velocities), np.array(accelerations)


def ground_reaction(robot: eurdf.Robot, q: Array, v: Array, a: Array) -> Array:
    """What the ground does to the foot (6,), at the ankle: it carries the leg and half the torso, fore and aft."""
    model, data = robot.model, robot.data
    pin.forwardKinematics(model, data, q)
    pin.rnea(model, data, q, v, a)
    leg = data.oMi[1].act(data.f[1])  # what moves the leg so, the loops within it being no matter, at the origin
    torso = model.inertias[0]
    weight = pin.Force(-0.5 * torso.mass * model.gravity.linear, np.zeros(3))
    ankle = pin.updateFramePlacement(model, data, model.getFrameId("foot")).translation
    carried = leg + pin.SE3(np.eye(3), torso.lever).act(weight)
    wrench = pin.SE3(np.eye(3), ankle).actInv(carried)
    return np.asarray(wrench.vector * [1.0, 0.0, 1.0, 0.0, 1.0, 0.0])


def new_figure() -> Any:
    """An empty figure.

    Raises:
        ModuleNotFoundError: There is no matplotlib.
    """
    try:
        from matplotlib.figure import Figure
    except ModuleNotFoundError as missing:
        message = "the picture of the squat needs matplotlib: pip install -e '.[examples]'"
        raise ModuleNotFoundError(message, name=missing.name) from missing
    return Figure(figsize=(8.0, 9.0), layout="constrained")


def draw(found: Squat, figure: Any) -> None:
    """Draw the leg, its motor angles and its motor torques over one period."""
    robot = found.robot
    figure.suptitle(f"A squat of Digit: {100 * DEPTH:.0f} cm down and up again in {PERIOD:g} s", fontsize=15)
    poses, angles, torques = figure.subplots(3, 1, sharex=True, height_ratios=[1.25, 1.0, 1.0])
    draw_poses(found, poses)

    # A period closes where it began.
    t = np.append(found.t, PERIOD)
    turned = np.degrees(found.q[:, robot.actuation.idx_q] - found.q[0, robot.actuation.idx_q])
    for axes, curves in ((angles, turned), (torques, found.u)):
        for name, curve in zip(robot.actuation.joints, curves.T, strict=True):
            label, colour, line = MOTORS[name]
            axes.plot(t, np.append(curve, curve[0]), line, color=colour, label=label, linewidth=2.2)
        axes.axhline(0.0, color="#40444b", linewidth=0.8, zorder=0)
        axes.grid(color="#e6e8eb", linewidth=0.8)
        axes.set_axisbelow(True)
        axes.spines[["top", "right"]].set_visible(False)
    angles.set_ylabel("motor angle from standing [°]")
    torques.set_ylabel("motor torque [N·m]")
    torques.set_xlabel("time [s]")
    torques.set_xlim(0.0, PERIOD)
    figure.legend(*angles.get_legend_handles_labels(), loc="outside lower center", ncols=6, frameon=False)


def draw_poses(found: Squat, axes: Any) -> None:
    """Draw the leg on the ground, seen from the right, at five times."""
    axes.set_axis_off()
    places = np.linspace(0.0, 1.0, 5)
    width = 0.24
    for place in places:
        k = round(place * SAMPLES) % SAMPLES
        inset = axes.inset_axes((place - width / 2.0, 0.0, width, 1.0))
        inset.set_axis_off()
        inset.set_aspect("equal", anchor="S")
        inset.set_xlim(-0.52, 0.33)
        inset.set_ylim(-1.03, 0.47)
        inset.axhline(GROUND, color="#40444b", linewidth=1.0)
        for outline, colour in outlines(found.robot, found.q[k]):
            inset.fill(outline[:, 0], outline[:, 1] - found.lowering[k], facecolor=colour, edgecolor="white", lw=0.4)


def outlines(robot: eurdf.Robot, q: Array) -> list[tuple[Array, Array]]:
    """Outline (n, 2), x and z in m, and colour of every shape, from the farthest to the nearest seen from the right."""
    visual_model: Any = robot.visual_model
    data = visual_model.createData()
    pin.updateGeometryPlacements(robot.model, robot.data, visual_model, data, q)
    shapes = []
    for shape, oMs in zip(visual_model.geometryObjects, data.oMg, strict=True):
        points = surface(shape.geometry) @ oMs.rotation.T + oMs.translation
        flat = points[:, [0, 2]]
        shapes.append((points[:, 1].mean(), flat[ConvexHull(flat).vertices], np.array(shape.meshColor)))
    shapes.sort(key=lambda shape: -shape[0])
    return [(outline, colour) for _, outline, colour in shapes]


def surface(geometry: Any) -> Array:
    """Points (n, 3) that a box, a cylinder or a sphere is the convex hull of, in its own axes, m."""
    corners = np.array([(x, y, z) for x in (-1.0, 1.0) for y in (-1.0, 1.0) for z in (-1.0, 1.0)])
    around = np.linspace(0.0, 2.0 * np.pi, 40)
    circle = np.column_stack([np.cos(around), np.sin(around)])
    kind = type(geometry).__name__
    if kind == "Box":
        return np.asarray(corners * geometry.halfSide)
    if kind == "Cylinder":
        ends = [np.column_stack([geometry.radius * circle, np.full(len(circle), h)]) for h in (-1.0, 1.0)]
        return np.asarray(np.vstack(ends) * [1.0, 1.0, geometry.halfLength])
    if kind == "Sphere":
        rings = [np.column_stack([circle * np.cos(h), np.full(len(circle), np.sin(h))]) for h in around[:20] - 1.5]
        return np.asarray(geometry.radius * np.vstack(rings))
    raise ValueError(f"a {kind} has no outline here")


if __name__ == "__main__":
    target = Path(sys.argv[1]) if sys.argv[1:] else Path()
    try:
        result = main(target)
    except ModuleNotFoundError as error:
        sys.exit(str(error))
    for joint, torque in zip(result.robot.actuation.joints, np.abs(result.u).max(axis=0), strict=True):
        print(f"{MOTORS[joint][0]:10} {torque:6.1f} N·m at most")
    print(f"written: {target / 'squat_torques.png'}")
