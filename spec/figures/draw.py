"""Draws the figures of the specification: ``python -m spec.figures.draw`` writes them beside this file.

Pages are light or dark: lines and words are in ``currentColor``, bodies in colours that work on both.
"""

from __future__ import annotations

import math
import re
from collections.abc import Iterable, Sequence
from pathlib import Path
from xml.sax.saxutils import escape

import numpy as np
import pinocchio as pin

import eurdf

FIGURES = Path(__file__).resolve().parent
TUTORIAL = FIGURES.parent / "examples" / "tutorial"

Point = tuple[float, float]

INK = "currentColor"
PARENT = "#8b9099"  # the parent of a joint
CHILD = "#3d8bd4"  # its child
OTHER = "#3f9d6b"  # the child of that, or the body across a cut
MOTION = "#d97a1e"  # axes, and motion along and about them

_BAR = 9.0  # width of a bar
_LINE = 1.6  # width of a line


class Drawing:
    """Builds an SVG. Angles are in degrees, from x towards y, which points down."""

    def __init__(self, width: float, height: float) -> None:
        self._size = width, height
        self._parts: list[str] = []
        self._offset = 0.0, 0.0

    def at(self, x: float, y: float) -> None:
        """Set the origin of what follows."""
        self._offset = x, y

    def line(self, points: Iterable[Point], colour: str = INK, width: float = _LINE, dash: str = "") -> None:
        """A line through points."""
        style = f' stroke-dasharray="{dash}"' if dash else ""
        where = " ".join(f"{x:.1f},{y:.1f}" for x, y in map(self._moved, points))
        self._parts.append(f'<polyline points="{where}" stroke="{colour}" stroke-width="{width:g}"{style}/>')

    def bar(self, start: Point, end: Point, colour: str, width: float = _BAR) -> None:
        """A long body."""
        self.line([start, end], colour, width)

    def disc(self, centre: Point, radius: float, fill: str = "none", stroke: str = INK, width: float = _LINE) -> None:
        """A disc, or a circle."""
        x, y = self._moved(centre)
        paint = f'fill="{fill}" stroke="{stroke}" stroke-width="{width:g}"'
        self._parts.append(f'<circle cx="{x:.1f}" cy="{y:.1f}" r="{radius:g}" {paint}/>')

    def box(self, corner: Point, opposite: Point, colour: str) -> None:
        """A body that is not long."""
        (x0, y0), (x1, y1) = self._moved(corner), self._moved(opposite)
        where = f'x="{x0:.1f}" y="{y0:.1f}" width="{x1 - x0:.1f}" height="{y1 - y0:.1f}" rx="5"'
        self._parts.append(f'<rect {where} fill="{colour}"/>')

    def arrow(self, start: Point, end: Point, colour: str = MOTION, width: float = _LINE + 0.4) -> None:
        """A line with a head."""
        self._arrow([start, end], colour, width)

    def turn(
        self,
        centre: Point,
        radii: Point,
        first: float,
        last: float,
        tilt: float = 0.0,
        colour: str = MOTION,
    ) -> None:
        """An arrow along an ellipse, whose first axis is turned by an angle."""
        self._arrow(ellipse(centre, radii, first, last, tilt), colour, _LINE + 0.4)

    def ground(self, centre: Point) -> None:
        """A pivot on the ground."""
        x, y = centre
        self.line([(x, y), (x - 11, y + 17), (x + 11, y + 17), (x, y)])
        self.line([(x - 18, y + 17), (x + 18, y + 17)])
        for step in range(-2, 3):
            self.line([(x + 8 * step, y + 17), (x + 8 * step - 6, y + 24)], width=1.1)

    def pin(self, centre: Point) -> None:
        """A pin between two bars."""
        self.disc(centre, 4.5, fill=INK, stroke="none")

    def words(self, at: Point, text: str, size: float = 15.0, anchor: str = "start", colour: str = INK) -> None:
        """A line of text; ``^`` sets the next letter high, ``|`` low."""
        x, y = self._moved(at)
        spans = re.sub(
            r"([|^])(\w)", lambda match: _shifted(match[2], 4 if match[1] == "|" else -6, size), escape(text)
        )
        place = f'x="{x:.1f}" y="{y:.1f}" font-size="{size:g}" text-anchor="{anchor}"'
        self._parts.append(f'<text {place} fill="{colour}" stroke="none">{spans}</text>')

    def write(self, path: Path) -> None:
        """Write the file."""
        path.write_text(self.text(), encoding="utf-8")

    def text(self) -> str:
        """The file."""
        width, height = self._size
        return "\n".join(
            [
                f'<svg xmlns="http://www.w3.org/2000/svg" width="{width:g}" height="{height:g}"'
                f' viewBox="0 0 {width:g} {height:g}" fill="none" stroke-linecap="round" stroke-linejoin="round"'
                ' font-family="system-ui, sans-serif">',
                *self._parts,
                "</svg>",
                "",
            ]
        )

    def _arrow(self, points: Sequence[Point], colour: str, width: float) -> None:
        (x0, y0), (x1, y1) = points[-2], points[-1]
        angle = math.atan2(y1 - y0, x1 - x0)
        head = [(x1 - 9 * math.cos(angle + side), y1 - 9 * math.sin(angle + side)) for side in (0.42, -0.42)]
        self.line(points, colour, width)
        where = " ".join(f"{x:.1f},{y:.1f}" for x, y in map(self._moved, [(x1, y1), *head]))
        self._parts.append(f'<polygon points="{where}" fill="{colour}" stroke="{colour}"/>')

    def _moved(self, point: Point) -> Point:
        return point[0] + self._offset[0], point[1] + self._offset[1]


def _shifted(letter: str, down: int, size: float) -> str:
    """A subscript or superscript; a zero-width span returns to the line, which an empty span would not."""
    return f'<tspan dy="{down}" font-size="{size * 0.72:g}">{letter}</tspan><tspan dy="{-down}">&#8203;</tspan>'


def ellipse(centre: Point, radii: Point, first: float, last: float, tilt: float = 0.0) -> list[Point]:
    """Points on an ellipse from one angle to another, its first axis turned by a third."""
    c, s = math.cos(math.radians(tilt)), math.sin(math.radians(tilt))
    count = max(2, round(abs(last - first) / 8))
    points = []
    for k in range(count + 1):
        at = math.radians(first + (last - first) * k / count)
        u, v = radii[0] * math.cos(at), radii[1] * math.sin(at)
        points.append((centre[0] + c * u - s * v, centre[1] + s * u + c * v))
    return points


# -- joints -------------------------------------------------------------------------------------------------------


def joints() -> Drawing:
    """The joints that URDF lacks, each with its axes and its coordinates; turns are right-handed."""
    drawing = Drawing(520, 560)
    for place, draw in enumerate((_spherical, _universal, _cylindrical, _helical)):
        drawing.at(260 * (place % 2), 280 * (place // 2))
        draw(drawing)
    return drawing


def _title(drawing: Drawing, name: str, coordinates: str) -> None:
    drawing.words((130, 20), name, 16, "middle")
    drawing.words((130, 270), f"coordinates {coordinates}", 15, "middle")


def _spherical(drawing: Drawing) -> None:
    ball = (130.0, 118.0)
    _title(drawing, "spherical", "x, y, z, w")
    drawing.bar((130, 40), (130, 82), PARENT, 16)
    drawing.line(ellipse(ball, (31, 31), 200, 340), PARENT, 12)
    drawing.bar(ball, (106, 232), CHILD, 16)
    drawing.disc(ball, 22, CHILD, "none")
    axis = (0.86, -0.51)
    ends = [(ball[0] + k * axis[0], ball[1] + k * axis[1]) for k in (-62, 92)]
    drawing.line([ends[0], ball], MOTION, dash="5 5")
    drawing.arrow(ball, ends[1])
    drawing.turn((ball[0] + 62 * axis[0], ball[1] + 62 * axis[1]), (20, 8), -210, 30, 59)
    drawing.words((ends[1][0] + 4, ends[1][1] - 8), "a")
    drawing.words((206, 116), "θ")


def _universal(drawing: Drawing) -> None:
    x, y = 130.0, 128.0
    far, near = (x + 27, y - 17), (x - 27, y + 17)
    _title(drawing, "universal", "θ₁, θ₂")
    drawing.bar((x, 40), (x, 70), PARENT, 16)
    drawing.line([(x - 52, y), (x - 52, 74), (x + 52, 74), (x + 52, y)], PARENT, 12)
    # The fork of the child has the other arm of the cross, which is perpendicular to the drawing.
    drawing.line([far, (far[0], far[1] + 62), (near[0], near[1] + 62)], CHILD, 12)
    drawing.bar((x, y + 64), (x - 4, 232), CHILD, 16)
    drawing.bar((x - 52, y), (x + 52, y), INK, 5)
    drawing.bar(far, near, INK, 5)
    drawing.line([near, (near[0], near[1] + 62)], CHILD, 12)
    drawing.disc(near, 4, INK, "none")
    drawing.line([(x - 96, y), (x - 56, y)], MOTION, dash="5 5")
    drawing.arrow((x + 58, y), (x + 104, y))
    drawing.turn((x + 82, y), (7, 20), -130, 130)
    drawing.words((x + 76, y - 30), "a₁, θ₁")
    drawing.line([far, (far[0] + 24, far[1] - 15)], MOTION, dash="5 5")
    drawing.arrow((near[0] - 6, near[1] + 4), (near[0] - 56, near[1] + 35))
    drawing.turn((near[0] - 30, near[1] + 19), (7, 19), 220, -60, -32)
    drawing.words((near[0] - 82, near[1] + 64), "a₂, θ₂")


def _cylindrical(drawing: Drawing) -> None:
    _title(drawing, "cylindrical", "d, θ")
    _shaft(drawing, "d", ())


def _helical(drawing: Drawing) -> None:
    x, pitch = 130.0, 20.0
    _title(drawing, "helical", "θ")
    # A right-handed thread rises from left to right on the side that is seen.
    _shaft(drawing, "θ h / 2π", [((x - 8, 84 + pitch * k), (x + 8, 84 + pitch * (k - 0.5))) for k in range(8)])
    top, low = 84 + pitch * 4.5, 84 + pitch * 5.5
    for y in (top, low):
        drawing.line([(x - 12, y), (x - 36, y)], width=1.1)
    drawing.line([(x - 30, top), (x - 30, low)], width=1.1)
    drawing.words((x - 48, (top + low) / 2 + 5), "h", anchor="middle")


def _shaft(drawing: Drawing, advance: str, thread: Iterable[tuple[Point, Point]]) -> None:
    """A shaft in a nut, what it moves by, and its axis."""
    x = 130.0
    drawing.line([(x - 68, 56), (x - 68, 126), (x - 28, 126)], PARENT, 16)
    drawing.line([(x, 30), (x, 60)], MOTION, dash="5 5")
    drawing.words((x + 8, 46), "a")
    drawing.bar((x, 70), (x, 232), CHILD, 16)
    for start, end in thread:
        drawing.line([start, end], INK, 1.8)
    drawing.box((x - 28, 110), (x + 28, 142), PARENT)
    drawing.arrow((x + 58, 98), (x + 58, 158))
    drawing.words((x + 68, 134), advance)
    drawing.turn((x, 212), (34, 10), -20, 200)
    drawing.words((x + 44, 212), "θ")
    drawing.arrow((x, 232), (x, 254))


# -- closures -----------------------------------------------------------------------------------------------------


def closures() -> Drawing:
    """The two types of closure, each a little open, so that its residual is seen."""
    drawing = Drawing(520, 320)
    _closure_3d(drawing)
    drawing.at(260, 0)
    _closure_6d(drawing)
    return drawing


def _frame(drawing: Drawing, origin: Point, angle: float, name: str, at: Point, length: float = 36.0) -> None:
    """A frame, with its x and y axes; its angle is counted upwards."""
    for turn in (0.0, 90.0):
        direction = math.radians(angle + turn)
        end = origin[0] + length * math.cos(direction), origin[1] - length * math.sin(direction)
        drawing.arrow(origin, end, INK, 1.5)
    drawing.words((origin[0] + at[0], origin[1] + at[1]), name, 17, "middle")


def _closure_3d(drawing: Drawing) -> None:
    drawing.words((130, 20), "3d: a pin or a ball", 16, "middle")
    a, b = (102.0, 128.0), (164.0, 148.0)
    drawing.bar((20, 210), a, CHILD)
    drawing.bar(b, (222, 252), OTHER)
    drawing.pin((20, 210))
    drawing.ground((222, 252))
    drawing.pin((222, 252))
    _frame(drawing, a, 45, "A", (0, -22))
    _frame(drawing, b, 30, "B", (-16, 24))
    drawing.arrow(a, b, MOTION, 2.6)
    drawing.words((122, 160), "p", 16)
    drawing.words((130, 308), "3 rows: p = 0", 15, "middle")


def _closure_6d(drawing: Drawing) -> None:
    drawing.words((130, 20), "6d: a rod, cut in two", 16, "middle")
    top, low = (60.0, 62.0), (206.0, 246.0)
    a, b = (112.0, 132.0), (158.0, 160.0)
    drawing.bar((14, 112), top, PARENT)
    drawing.bar(low, (238, 190), PARENT)
    drawing.bar(top, a, CHILD)
    drawing.bar(b, low, OTHER)
    drawing.disc(top, 8, INK, "none")
    drawing.disc(low, 8, INK, "none")
    drawing.words((top[0] + 14, top[1] - 2), "ball", 13)
    drawing.words((low[0] - 14, low[1] + 10), "ball", 13, "end")
    _frame(drawing, a, -53, "A", (-16, 16))
    _frame(drawing, b, -61, "B", (-14, 20))
    drawing.arrow(a, b, MOTION, 2.6)
    drawing.words((152, 128), "^AM|B", 16)
    drawing.words((130, 308), "6 rows: log₆ ^AM|B = 0", 15, "middle")


# -- tutorial -----------------------------------------------------------------------------------------------------


def tutorial() -> Drawing:
    """The four-bar of the tutorial where it is assembled, and what its pen draws, as the reference computes it."""
    robot = eurdf.load(TUTORIAL, geometry=False)
    model, data = robot.model, robot.data
    assembled = robot.configurations["assembled"]

    def place(q: np.ndarray, frame: str) -> Point:
        pin.forwardKinematics(model, data, q)
        x, y, _ = pin.updateFramePlacement(model, data, model.getFrameId(frame)).translation
        return 110 + 840 * float(x), 260 - 840 * float(y)

    drawing = Drawing(560, 400)
    curve, q = [], assembled
    for step in range(121):
        q = eurdf.forward_kinematics(robot, {"motor_crank": 2 * math.pi * step / 120}, q)
        curve.append(place(q, "pen"))
    bars = {
        "crank": ("crank", "coupler", PARENT),
        "coupler": ("coupler", "closing_rocker_pin_1", CHILD),
        "rocker": ("rocker", "closing_rocker_pin_2", OTHER),
    }
    centre = place(assembled, "crank")
    drawing.line(ellipse(centre, (840 * 0.12, 840 * 0.12), 0, 360), dash="2 6", width=1.2)
    drawing.line(curve, MOTION, 2.4)
    for start, end, colour in bars.values():
        drawing.bar(place(assembled, start), place(assembled, end), colour)
    pen, ends = place(assembled, "pen"), [place(assembled, end) for end in bars["coupler"][:2]]
    middle = (ends[0][0] + ends[1][0]) / 2, (ends[0][1] + ends[1][1]) / 2
    drawing.line([middle, pen], CHILD, 4)
    drawing.disc(pen, 5, MOTION, "none")
    for pivot in ("crank", "rocker"):
        drawing.ground(place(assembled, pivot))
    for joint in ("crank", "coupler", "rocker", "closing_rocker_pin_1"):
        drawing.pin(place(assembled, joint))

    def name(text: str, frame: str, right: float, down: float, anchor: str = "start") -> None:
        x, y = place(assembled, frame)
        drawing.words((x + right, y + down), text, 15, anchor)

    name("motor_crank", "crank", 0, 46, "middle")
    name("rocker_pivot", "rocker", 0, 46, "middle")
    name("crank_pin", "coupler", 12, 20)
    name("rocker_pin", "closing_rocker_pin_1", 14, -4)
    name("pen", "pen", -4, -12, "end")
    return drawing


FIGURE = {"joints": joints, "closures": closures, "tutorial": tutorial}


if __name__ == "__main__":
    for stem, draw in FIGURE.items():
        draw().write(FIGURES / f"{stem}.svg")
