"""Two robots stand on both feet and squat: motor torques, forces of the ground, and how far the feet are from slipping.

Run as ``python examples/stand.py``; needs MuJoCo.

Each foot is a 6d contact. The torso goes down and up again, upright; the motor torques are the least ones, in squares,
that produce this motion. A foot does not slip if the force of the ground is within the friction cone, and does not tip
if the centre of pressure is within the sole. The springs of Digit are locked. Joints have no friction here.
"""

from __future__ import annotations

from typing import NamedTuple

import mujoco
import numpy as np
import numpy.typing as npt
import pinocchio as pin
from lxml import etree

import eurdf

Array = npt.NDArray[np.float64]

PERIOD = 2.0  # s
SAMPLES = 8  # in a period
FRICTION = 0.6  # coefficient of friction between rubber and a floor
FEET = ("left_foot", "right_foot")

#: Of each robot its torso, and how far it goes down, m.
ROBOTS = {"digit_2legs": ("torso", 0.3), "kangaroo_2legs": ("pelvis", 0.15)}


class Sole(NamedTuple):
    """The underside of a foot, in the axes of the foot.

    Attributes:
        center: Its centre (3,), m.
        half: Half its length and width (2,), m.
    """

    center: Array
    half: Array


class Ground(NamedTuple):
    """What the ground does to a foot.

    Attributes:
        wrench: Force, N, and moment, N·m, at the centre of the sole, in the axes of the foot (6,).
        friction: Force by which the tangential one is below what would slip, N.
        pressure: Distance of the centre of pressure from the edge of the sole, m; negative outside.
    """

    wrench: Array
    friction: float
    pressure: float


class Moment(NamedTuple):
    """One moment of a squat.

    Attributes:
        t: Time, s.
        lowering: By how much the torso is below where it is when standing, m.
        q: Configuration (nq,).
        v: Velocity (nv,), rad/s and m/s.
        a: Acceleration (nv,), rad/s² and m/s².
        u: Motor torques (nu,), N·m, and forces, N.
        ground: By foot.
    """

    t: float
    lowering: float
    q: Array
    v: Array
    a: Array
    u: Array
    ground: dict[str, Ground]


class Compared(NamedTuple):
    """Largest differences from other computations.

    Attributes:
        momentum: Of what the ground does, from the change of momentum and the weight: N, N·m.
        pinocchio: Of the accelerations, from those of `pin.constraintDynamics`, relative to 1 plus the largest.
        mujoco: Of the accelerations from rest with these torques, from MuJoCo's equations, likewise.
    """

    momentum: float
    pinocchio: float
    mujoco: float


def main(name: str = "digit_2legs") -> tuple[eurdf.Robot, list[Moment], Compared]:
    """The robot with its feet on the ground, its squat, and how that compares."""
    robot = eurdf.load(name)
    robot = eurdf.lock(robot, [joint.name for joint in robot.mechanism.joints if any(joint.properties.stiffness)])
    q = eurdf.assemble(robot).q
    standing = robot.with_contacts(dict.fromkeys(FEET, "6d"), at=q)
    found = squat(standing, *ROBOTS[name])
    compared = Compared(
        max(momentum_error(standing, moment) for moment in found),
        max(pinocchio_error(standing, moment) for moment in found),
        mujoco_error(robot, standing, found[SAMPLES // 2].u),
    )
    return standing, found, compared


def squat(standing: eurdf.Robot, torso: str, depth: float) -> list[Moment]:
    """The torso goes down and up again, s = depth (1 - cos ω t) / 2."""
    q = standing.configurations["assembled"]
    pin.framesForwardKinematics(standing.model, standing.data, q)
    start = standing.data.oMf[standing.model.getFrameId(torso)].copy()
    # With the torso held too, the residual of its rows says where it is: (0, 0, -s) and no turn, in its own axes.
    guided = standing.with_contacts({torso: "6d"})
    down = np.zeros(guided.mechanism.nc)
    down[-6:-3] = start.rotation.T @ (0.0, 0.0, -1.0)
    soles, rate, found = {foot: sole_of(standing, foot) for foot in FEET}, 2.0 * np.pi / PERIOD, []
    for t in np.linspace(0.0, PERIOD, SAMPLES, endpoint=False).tolist():
        s, speed, change = (
            depth / 2.0 * np.array((1.0 - np.cos(rate * t), rate * np.sin(rate * t), rate**2 * np.cos(rate * t)))
        )
        target = pin.SE3(start.rotation, start.translation - (0.0, 0.0, s))
        solution = eurdf.inverse_kinematics(standing, {torso: target}, q)
        if not solution.converged:
            raise ValueError(f"the robot cannot bend by {s:.3f} m: {solution.reason}")
        q = solution.q
        K = eurdf.residual_and_jacobian(guided, q)[1]
        v = np.linalg.lstsq(K, speed * down)[0]
        a = np.linalg.lstsq(K, change * down + eurdf.kinematics.constraint_acceleration(guided, q, v))[0]
        a = eurdf.kinematics.achievable_acceleration(standing, q, v, a)  # no motor turns the rods about their lines
        dynamics = eurdf.inverse_dynamics(standing, q, v, a)
        ground = {foot: ground_of(dynamics.forces[foot], soles[foot]) for foot in FEET}
        found.append(Moment(t, float(s), q, v, a, dynamics.u, ground))
    return found


def sole_of(robot: eurdf.Robot, foot: str) -> Sole:
    """The underside of the box that a foot is drawn as."""
    (body,) = (body for body in robot.mechanism.bodies if body.name == foot)
    box = max((shape for shape in body.visuals if shape.kind == "box"), key=lambda shape: shape.size[0])
    length, width, height = box.size
    return Sole(np.array(box.pose.xyz) - (0.0, 0.0, height / 2.0), np.array((length, width)) / 2.0)


def ground_of(force: Array, sole: Sole) -> Ground:
    """What is known of the force of a contact, which acts at the origin of the foot."""
    wrench = pin.SE3(np.eye(3), sole.center).actInv(pin.Force(force)).vector
    fx, fy, fz, mx, my, _ = wrench
    center_of_pressure = np.array((-my, mx)) / fz
    margin = float((sole.half - np.abs(center_of_pressure)).min())
    return Ground(np.array(wrench), float(FRICTION * fz - np.hypot(fx, fy)), margin)


def momentum_error(standing: eurdf.Robot, moment: Moment) -> float:
    """Largest difference of what the ground does from the change of momentum less the weight, at the centre of mass."""
    model, data = standing.model, standing.model.createData()
    pin.computeCentroidalMomentumTimeVariation(model, data, moment.q, moment.v, moment.a)
    needed = data.dhg.vector - np.concatenate((data.mass[0] * model.gravity.linear, np.zeros(3)))
    pin.framesForwardKinematics(model, data, moment.q)
    for foot, ground in moment.ground.items():
        oMs = data.oMf[model.getFrameId(foot)] * pin.SE3(np.eye(3), sole_of(standing, foot).center)
        needed -= pin.SE3(np.eye(3), data.com[0]).actInv(oMs.act(pin.Force(ground.wrench))).vector
    return float(np.abs(needed).max())


def pinocchio_error(standing: eurdf.Robot, moment: Moment) -> float:
    """Relative difference of the acceleration from the one that Pinocchio's solver finds with the motor torques."""
    model, data = standing.model, standing.model.createData()
    models, datas = pin.StdVec_RigidConstraintModel(), pin.StdVec_RigidConstraintData()
    for each in standing.constraint_models:
        models.append(each)
        datas.append(each.createData())
    pin.initConstraintDynamics(model, data, models, datas)
    tau, settings = standing.actuation.selection @ moment.u, pin.ProximalSettings(1e-14, 1e-14, 1e-8, 50)
    a = pin.constraintDynamics(model, data, moment.q, moment.v, tau, models, datas, settings)
    return float(np.abs(a - moment.a).max() / (1.0 + np.abs(moment.a).max()))


def mujoco_error(robot: eurdf.Robot, standing: eurdf.Robot, u: Array) -> float:
    """Relative difference of the acceleration from rest from that of MuJoCo's M, bias forces and equality constraints.

    The feet are welds in the exported file. MuJoCo's own solver makes constraints soft; here its equations are solved
    with rigid ones. They lack K̇ v, so the velocity is zero.
    """
    export = eurdf.export(robot, "mjcf")
    root = etree.fromstring(export.main)
    equality = root.find("equality")
    assert equality is not None
    for foot in FEET:
        etree.SubElement(equality, "weld", body1=foot)
    model = mujoco.MjModel.from_xml_string(etree.tostring(root).decode())
    model.opt.jacobian = mujoco.mjtJacobian.mjJAC_DENSE
    data = mujoco.MjData(model)
    q, v = standing.configurations["assembled"], np.zeros(robot.model.nv)
    data.qpos[:] = export.coordinates.to_q(q)
    for joint, torque in zip(robot.actuation.joints, u, strict=True):
        data.qfrc_applied[model.joint(joint).dofadr] = torque
    mujoco.mj_forward(model, data)
    J = data.efc_J.reshape(-1, model.nv)[: data.ne]  # equality constraints come first
    M = np.zeros((model.nv, model.nv))
    for row, unit in zip(M, np.eye(model.nv), strict=True):
        mujoco.mj_mulM(model, data, row, unit)
    equations = np.block([[M, J.T], [J, np.zeros((len(J), len(J)))]])
    right = np.concatenate((data.qfrc_applied - data.qfrc_bias, np.zeros(len(J))))
    theirs = np.linalg.lstsq(equations, right)[0][: model.nv]
    ours = export.coordinates.to_a(q, v, eurdf.forward_dynamics(standing, q, v, u).a)
    return float(np.abs(theirs - ours).max() / (1.0 + np.abs(ours).max()))


if __name__ == "__main__":
    for robot_name in ROBOTS:
        robot_found, moments, errors = main(robot_name)
        units = {each.name: "N" if each.type == "prismatic" else "N·m" for each in robot_found.mechanism.joints}
        mass = sum(inertia.mass for inertia in robot_found.model.inertias)
        print(f"{robot_name}, {mass:.1f} kg, friction {FRICTION}")
        print("             largest torque                   force of the ground, margins of friction and pressure")
        print("   t   down  of a motor                       left foot                  right foot")
        for moment in moments:
            largest = int(np.abs(moment.u).round(6).argmax())
            joint = robot_found.actuation.joints[largest]
            feet = "  ".join(
                f"{each.wrench[2]:6.1f} N {each.friction:6.1f} N {1e3 * each.pressure:4.0f} mm"
                for each in moment.ground.values()
            )
            motor = f"{joint:22} {moment.u[largest]:7.1f} {units[joint]:3}"
            print(f"{moment.t:4.2f} s {moment.lowering:.2f} m  {motor}  {feet}")
        print(f"the forces differ by {errors.momentum:.1e} N or N·m from the change of momentum; the accelerations by")
        print(f"{errors.pinocchio:.1e} from Pinocchio's, and by {errors.mujoco:.1e} from MuJoCo's, relative\n")
