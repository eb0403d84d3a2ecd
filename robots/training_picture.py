"""Draws what a serial model of the G1's ankle costs, as it is trained with: ``python -m robots.training_picture``.

The serial model is the widespread one: two motors at each joint, with a ratio of 1:1.
"""

from __future__ import annotations

import sys
from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any, cast

import numpy as np
import numpy.typing as npt

import eurdf
from eurdf.diagnostics.extras import install_command
from robots.drawing import draw

Vector = npt.NDArray[np.float64]

JOINTS = ("free_pitch", "free_roll")
ROTOR = 0.003609725  # kg·m², one motor 5020 after its gear
ARMATURE, TORQUE = 2.0 * ROTOR, 50.0  # of each joint of the serial model, kg·m² and N·m
PITCHES = (-40.0, 0.0, 20.0)  # where torques are drawn, degrees; toes up is negative
_BLUE, _ORANGE, _GREEN, _GREY = "#0072B2", "#D55E00", "#009E73", "#666666"  # Okabe, Ito, 2008
_STYLES: dict[str, Any] = {"font.size": 8.0, "axes.titlesize": 9.0, "axes.linewidth": 0.6}
_SIZE, _DOTS = (9.6, 3.5), 110  # inches, dots per inch


@dataclass(frozen=True)
class Costs:
    """The ankle against the serial model.

    Attributes:
        torques: For each of `PITCHES` the corners (4, 2) of the torques of the motors, pitch and roll, N·m.
        positions: Pitch and roll (N, 2) over the workspace, rad.
        inertia: Armature of pitch and roll (N, 2) there, relative to `ARMATURE`.
        reach: Outline (M, 2) of the workspace, rad.
        box: Limits (2, 2) of pitch and roll in the URDF, lower and upper, rad.
    """

    torques: tuple[Vector, ...]
    positions: Vector
    inertia: Vector
    reach: Vector
    box: Vector


def costs(grid: int = 41) -> Costs:
    """Computed on a grid of this many points along each joint."""
    robot = eurdf.load("unitree_g1_ankle", geometry=False)
    space = eurdf.transmissions.workspace(robot, JOINTS, grid=grid)
    rotors = dict.fromkeys(space.motors, ROTOR)
    inertia = eurdf.transmissions.reflected_inertia(robot, JOINTS, space.q, armature=rotors).rotors
    torques = []
    for pitch in np.radians(PITCHES):
        at = eurdf.transmissions.actuator_values(robot, {JOINTS[0]: pitch, JOINTS[1]: 0.0}).q
        torques.append(cast(Any, eurdf.transmissions.serial_limits(robot, JOINTS, at)).torque.vertices)
    (outline,) = space.outlines
    reach = np.array([space.boundary[index].position for index in outline])
    joints = {joint.name: joint for joint in robot.mechanism.joints}
    box = np.array([joints[name].ranges[0] for name in JOINTS])
    return Costs(tuple(torques), space.positions, np.diagonal(inertia, axis1=1, axis2=2) / ARMATURE, reach, box)


def save(file: Path, found: Costs | None = None) -> None:
    """Draw the three costs side by side."""
    try:
        import matplotlib
        from matplotlib.figure import Figure
    except ImportError:
        command = install_command("plot")
        raise eurdf.errors.MissingExtra(f"a figure needs matplotlib: {command}", "plot") from None
    found = found or costs()
    with matplotlib.rc_context(_STYLES):
        figure = Figure(figsize=_SIZE, dpi=_DOTS, layout="constrained", facecolor="white")
        for axis, panel in zip(figure.subplots(1, 3), (_torque, _inertia, _reach), strict=True):
            panel(axis, found)
        figure.savefig(file)


def _torque(axis: Any, found: Costs) -> None:
    square = TORQUE * np.array(((1, 1), (-1, 1), (-1, -1), (1, -1), (1, 1)))
    axis.fill(*square.T, color=_GREY, alpha=0.15, linewidth=0)
    axis.plot(*square.T, color=_GREY, linewidth=1.2, linestyle=":", label="serial model")
    for pitch, corners, color, style in zip(
        PITCHES, found.torques, (_ORANGE, _BLUE, _GREEN), ("--", "-", "-."), strict=True
    ):
        closed = np.vstack((corners, corners[:1]))
        axis.plot(closed[:, 1], closed[:, 0], color=color, linestyle=style, linewidth=1.5, label=f"pitch {pitch:.0f}°")
    axis.set(title="Torque that the motors have", xlabel="roll [N·m]", ylabel="pitch [N·m]", aspect="equal")
    axis.set(xlim=(-105.0, 105.0), ylim=(-105.0, 105.0))
    axis.legend(fontsize=6.5, loc="upper right", frameon=False)


def _inertia(axis: Any, found: Costs) -> None:
    pitch, roll = np.degrees(found.positions).T
    columns = np.unique(pitch)
    for joint, color, style in ((0, _BLUE, "-"), (1, _ORANGE, "--")):
        own = [found.inertia[pitch == column, joint] for column in columns]
        axis.fill_between(
            columns, *zip(*((each.min(), each.max()) for each in own), strict=True), color=color, alpha=0.25
        )
        level = np.abs(roll) < 1e-9
        axis.plot(pitch[level], found.inertia[level, joint], color=color, linestyle=style, label=JOINTS[joint][5:])
    axis.axhline(1.0, color=_GREY, linestyle=":", linewidth=1.2, label="serial model")
    axis.set_yscale("log")
    axis.set_yticks((0.5, 1, 2, 5, 10), ("½", "1", "2", "5", "10"))
    axis.minorticks_off()
    axis.set(title="Armature, at no roll and at all", xlabel="pitch [°]", ylabel="ratio to 2 · 0.00361 kg·m²")
    axis.legend(fontsize=6.5, frameon=False)


def _reach(axis: Any, found: Costs) -> None:
    (pitch, roll), reach = np.degrees(found.box), np.degrees(found.reach)
    axis.fill(
        (roll[0], roll[1], roll[1], roll[0]),
        (pitch[0], pitch[0], pitch[1], pitch[1]),
        color=_ORANGE,
        alpha=0.25,
        linewidth=0,
        hatch="///",
        label="serial model alone",
    )
    axis.fill(reach[:, 1], reach[:, 0], facecolor="white", linewidth=0)
    axis.fill(reach[:, 1], reach[:, 0], facecolor=_BLUE, alpha=0.35, edgecolor=_BLUE, label="the ankle")
    axis.set(title="Reach", xlabel="roll [°]", ylabel="pitch [°]")
    axis.legend(fontsize=6.5, loc="center")


def main(arguments: Sequence[str] | None = None) -> int:
    """Draws the picture; 0 if it is drawn, 2 if it cannot be."""
    default = Path(__file__).parents[1] / "docs/pictures/g1_ankle_training.png"
    return draw("training_picture", "Draw what a serial model of an ankle costs.", default, save, arguments)


if __name__ == "__main__":
    sys.exit(main())
