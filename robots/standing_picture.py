"""Draws the squats of `examples/stand.py` with the forces of the ground: ``python -m robots.standing_picture``."""

from __future__ import annotations

import math
import sys
from collections.abc import Iterator, Sequence
from dataclasses import replace
from pathlib import Path

import numpy as np
import pinocchio as pin

import eurdf
from eurdf.viewing.picture import Color, Drawn, Image, axes_of, drawn, save_picture, seen
from eurdf.viewing.surface import Surface
from examples import stand
from robots.drawing import draw

_VIEW = (1.0, -0.8, 0.3)
_PIXELS = 225, 440  # width and height of each view
_HEIGHT = 1.62  # m, of what a view shows
_UP = 0.72  # m, of its centre above the ground
_LENGTH = 1.0 / 700.0  # of an arrow, m/N
_CONE = 0.22  # height of a friction cone, m
_AROUND = 36  # vertices on a circle
_FORCE: Color = (0.85, 0.2, 0.15, 1.0)
_FRICTION: Color = (0.95, 0.65, 0.1, 0.3)
_GROUND: Color = (0.55, 0.57, 0.6, 0.35)


def cone(top: float, radius: float, base: float = 0.0, base_radius: float = 0.0) -> Surface:
    """A cone, or a part of one, about the z axis, from the height of its base to that of its top, m."""
    turn = np.linspace(0.0, 2.0 * math.pi, _AROUND, endpoint=False)
    circle = np.column_stack((np.cos(turn), np.sin(turn), np.zeros(_AROUND)))
    rings = base_radius * circle + (0.0, 0.0, base), radius * circle + (0.0, 0.0, top)
    here, following = np.arange(_AROUND), np.roll(np.arange(_AROUND), -1)
    sides = [(here, following, following + _AROUND), (here, following + _AROUND, here + _AROUND)]
    return Surface(np.concatenate(rings), np.concatenate([np.stack(each, axis=1) for each in sides]), True)


def forces(robot: eurdf.Robot, moment: stand.Moment) -> Iterator[tuple[Surface, Color]]:
    """An arrow for the force of the ground on each foot, from the centre of pressure, and the friction cone there."""
    data = robot.model.createData()
    pin.framesForwardKinematics(robot.model, data, moment.q)
    for foot, ground in moment.ground.items():
        oMf = data.oMf[robot.model.getFrameId(foot)]
        force, (mx, my, _) = ground.wrench[:3], ground.wrench[3:]
        pressure = stand.sole_of(robot, foot).center + np.array((-my, mx, 0.0)) / force[2]
        along = pin.SE3(pin.Quaternion.FromTwoVectors(np.array((0.0, 0.0, 1.0)), force).matrix(), pressure)
        length = _LENGTH * float(np.linalg.norm(force))
        arrow = cone(length, 0.011, 0.0, 0.011), cone(length + 0.08, 0.0, length, 0.032)
        for surface, color, place in (
            (arrow[0], _FORCE, oMf * along),
            (arrow[1], _FORCE, oMf * along),
            (cone(_CONE, stand.FRICTION * _CONE), _FRICTION, oMf * pin.SE3(np.eye(3), pressure)),
        ):
            yield replace(surface, vertices=surface.vertices @ place.rotation.T + place.translation), color


def picture() -> Image:
    """Each robot upright and at its lowest, side by side."""
    images = []
    for name in stand.ROBOTS:
        robot, moments, _ = stand.main(name)
        low = _lowest(robot, moments[0])
        center = axes_of(_VIEW) @ np.array((-0.08, 0.0, low + _UP))
        for moment in (moments[0], moments[len(moments) // 2]):
            shown = drawn(robot, moment.q, loops=False)
            solids = [*shown.solids, *forces(robot, moment)]
            floor = cone(low, 0.36, low, 0.0)
            solids.append((replace(floor, vertices=floor.vertices - (0.06, 0.0, 0.001)), _GROUND))
            everything = Drawn(solids, shown.lines, shown.dots, np.concatenate([each.vertices for each, _ in solids]))
            images.append(seen(everything, _VIEW, center, _PIXELS, _PIXELS[1] / _HEIGHT))
    return np.concatenate(images, axis=1)


def _lowest(robot: eurdf.Robot, moment: stand.Moment) -> float:
    """Height of the soles, m."""
    data = robot.model.createData()
    pin.framesForwardKinematics(robot.model, data, moment.q)
    foot = stand.FEET[0]
    return float(data.oMf[robot.model.getFrameId(foot)].act(stand.sole_of(robot, foot).center)[2])


def main(arguments: Sequence[str] | None = None) -> int:
    """Draws the picture; 0 if it is drawn, 2 if it cannot be."""
    default = Path(__file__).parents[1] / "docs/pictures/stand.png"
    return draw(
        "standing_picture", "Draw robots that stand.", default, lambda file: save_picture(picture(), file), arguments
    )


if __name__ == "__main__":
    sys.exit(main())
