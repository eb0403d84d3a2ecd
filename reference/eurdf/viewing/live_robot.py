"""A robot on a page that moves it without a server: its data, and the scripts in ``live`` that read them."""

from __future__ import annotations

import html
import json
import math
from collections.abc import Iterable, Mapping, Sequence
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np

from eurdf.array import Vector
from eurdf.kinematics.position_limit import position_limits
from eurdf.kinematics.scale import characteristic_length, row_scale, velocity_scale
from eurdf.mechanism.constraint import Closure, Constraint, Coupling
from eurdf.mechanism.mechanism import ROOT_JOINT, Mechanism, root_joint
from eurdf.mechanism.pose import Pose, direction
from eurdf.viewing.scene import Scene
from eurdf.viewing.session import Session
from eurdf.viewing.surface import Surface

if TYPE_CHECKING:
    from eurdf.pinocchio.robot import Robot

_FOLDER = Path(__file__).parent / "live"
#: What a page loads, in this order, to show robots.
SCRIPTS = tuple(
    _FOLDER / f"{name}.js" for name in ("linear_algebra", "mechanism", "springs", "motion", "drawing", "live_page")
)
STYLE = _FOLDER / "live_page.css"
_PAGE_STYLE = _FOLDER / "offline_page.css"  # of a page with nothing else

_HELP = "Drag to turn the robot; Shift and drag to move it; click it and scroll, or pinch, to zoom."
_GRAY = (0.9, 0.9, 0.9, 1.0)  # of a shape without a colour


def live_page(robot: Robot, q: Vector | None = None) -> str:
    """A page that moves a robot without a server and a network: one file; for the arguments see `live_robot`."""
    name = html.escape(robot.mechanism.name)
    style = "".join(file.read_text(encoding="utf-8") for file in (STYLE, _PAGE_STYLE))
    scripts = "".join(f"<script>{script.read_text(encoding='utf-8')}</script>" for script in SCRIPTS)
    return (
        f'<!doctype html><html lang="en"><head><meta charset="utf-8"><title>{name}</title>'
        '<meta name="viewport" content="width=device-width, initial-scale=1">'
        f"<style>{style}</style></head>"
        f"<body><main><h1>{name}</h1>{live_view(robot, q)}</main><footer>{_HELP}</footer>{scripts}</body></html>\n"
    )


def live_view(robot: Robot, q: Vector | None = None) -> str:
    """HTML for a page that loads `SCRIPTS` and `STYLE`: the robot, and a slider for each actuator.

    The arguments are those of `live_robot`. No name in it can be taken for markup.
    """
    data = json.dumps(live_robot(robot, q), separators=(",", ":")).replace("<", "\\u003c")
    return f'<div class="eu-live"><script type="application/json">{data}</script></div>'


def live_robot(robot: Robot, q: Vector | None = None) -> dict[str, Any]:
    """A robot with all that the scripts of a live page need, as values of JSON.

    The units are m and rad, quaternions are x y z w, indices count from 0. The first joint of a robot with a floating
    root is that of the root; body -1 is the world. Configurations have the coordinates of each joint, as files have
    them.

    Args:
        robot: The robot, with its visual geometry.
        q: Where to start (nq,), closed if it is open; by default ``assembled``, or a closed configuration that is
            found.

    Returns:
        ``name``; ``bodies``; ``joints``; ``constraints``, with the factors that make their rows dimensionless;
        ``units`` and limits of the velocities; ``held``, the velocities of the actuators; ``sliders``, except those of
        planar, spherical and floating joints; ``springs``;
        ``start`` and ``configurations``; ``shapes``; ``center``, ``size`` and ``lowest`` of the robot.
    """
    session = Session(robot, q)
    mechanism, tree, scene = robot.mechanism, robot.tree, Scene(robot, session.q)
    limits, length = position_limits(robot), characteristic_length(robot)
    root = [ROOT_JOINT] if mechanism.root == "floating" else []
    velocities = {name: list(map(int, tree.velocities_of(name))) for name in (*root, *robot.slots)}
    bodies = {body.name: index for index, body in enumerate(mechanism.bodies)}
    joints = _joints(mechanism, bodies, velocities)
    numbers = {joint["name"]: index for index, joint in enumerate(joints)}
    scales = iter(row_scale(robot, length).tolist())
    springs = zip(tree.springs.idx_v, tree.springs.stiffness, tree.springs.ratio, tree.springs.shift, strict=True)
    return {
        "name": mechanism.name,
        "bodies": [body.name for body in mechanism.bodies],
        "joints": joints,
        "constraints": [_constraint(each, bodies, numbers, scales) for each in robot.constraints],
        "units": velocity_scale(robot, length).tolist(),
        "lower": [value if math.isfinite(value) else None for value in limits.lower.tolist()],
        "upper": [value if math.isfinite(value) else None for value in limits.upper.tolist()],
        "held": robot.actuation.idx_v.tolist(),
        "sliders": [
            {
                **{name: getattr(slider, name) for name in ("joint", "label", "unit", "lower", "upper", "velocity")},
                "follow": [each for name in slider.follow for each in velocities[name]],
                "dependent": any(slider.joint in each for each in session.analysis.dependent_actuators),
            }
            for slider in session.sliders
            if slider.velocity is not None
        ],
        "springs": [
            {"velocity": int(velocity), "stiffness": float(k), "ratio": float(ratio), "shift": float(shift)}
            for velocity, k, ratio, shift in springs
        ],
        "start": _coordinates(robot, joints, session.q),
        "configurations": {name: _coordinates(robot, joints, q) for name, q in robot.configurations.items()},
        "shapes": _shapes(mechanism, bodies, scene),
        "center": scene.center.tolist(),
        "size": scene.size,
        "lowest": scene.lowest,
    }


def _joints(
    mechanism: Mechanism, bodies: Mapping[str, int], velocities: Mapping[str, list[int]]
) -> list[dict[str, Any]]:
    leaders = mechanism.leaders
    joints = list(mechanism.joints)
    parents = [bodies[joint.parent] for joint in joints]
    if mechanism.root == "floating":
        joints.insert(0, root_joint(mechanism.bodies[0].name))
        parents.insert(0, -1)
    numbers = {joint.name: index for index, joint in enumerate(joints)}
    found = []
    for joint, parent in zip(joints, parents, strict=True):
        leader = leaders.get(joint.name)
        found.append(
            {
                "name": joint.name,
                "type": joint.type.value,
                "parent": parent,
                "child": bodies[joint.child],
                "placement": _pose(joint.placement),
                "offset": _pose(joint.offset),
                "axes": [direction(axis) for axis in joint.axes],
                "pitch": joint.pitch,
                "velocities": velocities.get(leader.joint if leader else joint.name, []),
                "mimic": None
                if leader is None
                else {"joint": numbers[leader.joint], "multiplier": leader.multiplier, "offset": leader.offset},
            }
        )
    return found


def _constraint(
    constraint: Constraint, bodies: Mapping[str, int], joints: Mapping[str, int], scales: Iterable[float]
) -> dict[str, Any]:
    scale = iter(scales)
    found: dict[str, Any] = {"name": constraint.name, "type": constraint.type}
    found["scale"] = [next(scale) for _ in range(constraint.rows)]
    match constraint:
        case Coupling():
            found["joints"] = [joints[name] for name in constraint.joints]
            found["coefficients"] = [coefficient for _, coefficient in constraint.coefficients]
            found["offset"] = constraint.offset
        case Closure():
            anchors = [{"body": bodies.get(each.body, -1), "pose": _pose(each.pose)} for each in constraint.anchors]
            found["a"], found["b"] = anchors
            found |= constraint.own
            if "axes" in found:
                found["axes"] = [direction(axis) for axis in found["axes"]]
    return found


def _coordinates(robot: Robot, joints: Sequence[Mapping[str, Any]], q: Vector) -> list[list[float]]:
    own = robot.joint_positions(q)
    return [list(own.get(joint["name"], ())) for joint in joints]


def _shapes(mechanism: Mechanism, bodies: Mapping[str, int], scene: Scene) -> list[dict[str, Any]]:
    """The visual shapes; a mesh has its triangles, with the scale in them."""
    if not scene.has_visuals:
        return []
    parts = (part for part in scene.parts if part.kind == "visual")
    return [
        {
            "body": bodies[body.name],
            "kind": shape.kind,
            "pose": _pose(shape.pose),
            "color": [min(max(value, 0.0), 1.0) for value in shape.color or _GRAY],
            **(_triangles(part.surface) if shape.kind == "mesh" else {"size": list(shape.size)}),
        }
        for (body, shape), part in zip(
            ((body, shape) for body in mechanism.bodies for shape in body.visuals), parts, strict=True
        )
    ]


def _triangles(surface: Surface) -> dict[str, Any]:
    """Numbers to a part in 1e5 of the mesh, which no screen shows."""
    extent = float(np.ptp(surface.vertices, axis=0).max(initial=0.0)) or 1.0
    digits = max(0, 5 - math.floor(math.log10(extent)))
    vertices = np.round(surface.vertices, digits).ravel().tolist()
    return {"vertices": vertices, "triangles": surface.triangles.ravel().tolist()}


def _pose(pose: Pose) -> list[float]:
    return [*pose.xyz, *pose.quaternion]
