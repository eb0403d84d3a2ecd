"""Draws the leg of Digit while its foot is dragged, loops closed: ``python -m robots.moving_picture [-o FILE]``."""

from __future__ import annotations

import math
import sys
from collections.abc import Iterator, Sequence
from pathlib import Path

import numpy as np
import pinocchio as pin

import eurdf
from eurdf.array import Vector
from eurdf.viewing.picture import Drawn, Image, axes_of, drawn, seen, with_palette
from robots.drawing import draw

_ROBOT, _DRAGGED = "digit_leg", "foot"
_VIEWS = ((0.0, -1.0, 0.0), (1.0, -0.8, 0.35))
_PIXELS = 340, 460  # width and height of each view
_HEIGHT = 1.08  # m, of what a view shows
_CENTER = (-0.1, 0.08, -0.53)  # of the views, in the world, m: it leaves out most of the torso
_FRAMES, _TIME = 72, 55  # number of frames, and the time of each, ms
_COLORS = 96  # of all frames
_FOOT_TIP = (0.11, 0.0, 0.0)  # where the pointer holds the foot, in its frame, m
# An arrow that points to the origin, pixels.
_POINTER = ((0, 0), (0, 26), (6, 20), (10, 30), (15, 28), (11, 18), (19, 18))


def dragged(robot: eurdf.Robot, frames: int = _FRAMES) -> Iterator[tuple[Vector, Vector]]:
    """The closed configurations (nq,) while the foot is dragged along a closed curve, and where it is held (3,), m."""
    q = robot.configurations["assembled"]
    foot = robot.model.getFrameId(_DRAGGED)
    pin.framesForwardKinematics(robot.model, robot.data, q)
    start = pin.SE3(robot.data.oMf[foot])
    for number in range(frames):
        t = 2.0 * math.pi * number / frames
        shift = np.array((0.17 * math.sin(t), 0.05 * math.sin(2.0 * t), 0.13 * (1.0 - math.cos(t))))
        turn = pin.rpy.rpyToMatrix(0.18 * math.sin(2.0 * t), 0.3 * math.sin(t), 0.0)
        target = pin.SE3(start.rotation @ turn, start.translation + shift)
        found = eurdf.inverse_kinematics(robot, {_DRAGGED: target}, q, restarts=0)
        if not found.converged:
            raise ValueError(f"frame {number}: {found.reason}")
        q = found.q
        yield q, target.act(np.array(_FOOT_TIP))


def moving_picture(robot: eurdf.Robot, frames: int = _FRAMES) -> list[Image]:
    """The frames, pixels (height, width, 4)."""
    return [_frame(drawn(robot, q, loops=False), held) for q, held in dragged(robot, frames)]


def save_moving_picture(frames: Sequence[Image], file: Path) -> None:
    """Write frames to an animated WebP file that repeats without end.

    A palette makes it small without loss; where colours are lossy, WebP needs more for the transparency than for them.
    """
    from PIL import Image as Pillow

    colors, indices = with_palette(np.concatenate(frames), _COLORS)
    first, *others = (Pillow.fromarray(frame) for frame in colors[indices].reshape(len(frames), *frames[0].shape))
    first.save(file, format="WEBP", save_all=True, append_images=others, duration=_TIME, loop=0, lossless=True)


def _frame(shown: Drawn, held: Vector) -> Image:
    from PIL import Image as Pillow
    from PIL import ImageDraw

    scale = _PIXELS[1] / _HEIGHT
    images = []
    for view in _VIEWS:
        center = axes_of(view) @ np.array(_CENTER)
        image = Pillow.fromarray(seen(shown, view, center, _PIXELS, scale))
        right, up = scale * (axes_of(view) @ held - center)[:2]
        x, y = _PIXELS[0] / 2.0 + right, _PIXELS[1] / 2.0 - up
        ImageDraw.Draw(image).polygon([(x + dx, y + dy) for dx, dy in _POINTER], fill="white", outline="black", width=2)
        images.append(np.asarray(image))
    return np.concatenate(images, axis=1)


def main(arguments: Sequence[str] | None = None) -> int:
    """Draws the moving picture; 0 if it is drawn, 2 if it cannot be."""
    default = Path(__file__).parents[1] / "docs/pictures/digit_leg.webp"
    return draw(
        "moving_picture",
        "Draw a robot that is dragged.",
        default,
        lambda file: save_moving_picture(moving_picture(eurdf.load(_ROBOT)), file),
        arguments,
    )


if __name__ == "__main__":
    sys.exit(main())
