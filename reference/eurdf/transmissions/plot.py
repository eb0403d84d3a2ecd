"""A figure of a workspace: what the joints can reach, and how limits and inertia vary there."""

from __future__ import annotations

import io
import os
from collections.abc import Mapping
from pathlib import Path
from typing import Any, cast

import numpy as np

from eurdf.array import Matrix, Vector
from eurdf.diagnostics.extras import install_command
from eurdf.errors import MissingExtra
from eurdf.transmissions.inertia import reflected_inertia
from eurdf.transmissions.limits import CommonLimits, serial_limits
from eurdf.transmissions.motors import unlimited_motors
from eurdf.transmissions.reach import Stop
from eurdf.transmissions.reachable_set import Workspace
from eurdf.writing.atomic_file import write_atomically

#: Kinds of file that a figure can be.
FORMATS = ("png", "svg", "pdf")

# A figure is as wide as a page of a paper with two columns, in.
_WIDTH = 7.16
_DOTS_PER_INCH = 200
# Colors for readers who do not distinguish red and green (Okabe, Ito, 2008).
_COLORS = ("#0072B2", "#E69F00", "#009E73", "#CC79A7", "#56B4E9", "#D55E00", "#F0E442", "#999999")
_SINGULAR = "#000000"
_STYLES: dict[str, Any] = {
    "font.size": 7.0,
    "axes.titlesize": 7.0,
    "axes.linewidth": 0.6,
    "xtick.major.width": 0.6,
    "ytick.major.width": 0.6,
    "svg.hashsalt": "eurdf",
}
# Units of the torque, the velocity and the inertia of a joint by that of its position, and the factor of the inertia.
_UNITS = {"rad": ("N·m", "rad/s", "10⁻³ kg·m²", 1e3), "m": ("N", "m/s", "kg", 1.0)}
# Points closer to a singular pose than this, in the condition number of G, are not drawn.
_WORST_CONDITION = 1e4


#: Values over the workspace: what they are, with their unit, and one for each point (N,).
_Field = tuple[str, Vector]


def plot_workspace(
    found: Workspace, file: str | os.PathLike[str], *, armature: Mapping[str, float] | None = None
) -> Path:
    """Draw a workspace of one or two joints.

    For each joint: the largest torque and the largest velocity that it can have alone, and the inertia of motors and
    linkage that it feels, Gᵀ I_m G and that of rods and cranks. Over two joints they are filled contours; the outline
    of what the joints reach has the color of what stops them, black at singular poses. Where a motor has no limit, the
    condition number of G is drawn in place of torque and velocity.

    Args:
        found: What `workspace` returned.
        file: Where to write; its ending is ``.png``, ``.svg`` or ``.pdf``. An existing file is replaced.
        armature: By motor, as in `reflected_inertia`.

    Returns:
        The file.

    Raises:
        MissingExtra: The extra ``plot`` is not installed.
        ValueError: The workspace has more than two joints, or the ending is another one.
        OSError: The file cannot be written.
    """
    path = Path(file)
    if path.suffix.lower().lstrip(".") not in FORMATS:
        raise ValueError(f"'{path}' has the ending '{path.suffix}'; a figure ends in .png, .svg or .pdf")
    if len(found.joints) > 2:
        raise ValueError(f"the workspace has {len(found.joints)} joints; a figure shows one or two")
    try:
        import matplotlib
        from matplotlib.figure import Figure
    except ImportError:
        raise MissingExtra("a figure needs matplotlib: " + install_command("plot"), "plot") from None
    with matplotlib.rc_context(_STYLES):
        figure = Figure(layout="constrained", dpi=_DOTS_PER_INCH)
        (_curves if len(found.joints) == 1 else _maps)(figure, found, armature)
        # The same figure gives the same file.
        undated: dict[str, Any] = {"svg": {"Date": None}, "pdf": {"CreationDate": None}}.get(
            path.suffix[1:].lower(), {}
        )
        content = io.BytesIO()
        figure.savefig(content, format=path.suffix[1:].lower(), metadata=undated)
    write_atomically(path, content.getvalue())
    return path


def _maps(figure: Any, found: Workspace, armature: Mapping[str, float] | None) -> None:
    """Contours over two joints: a row for each joint, a column for each quantity."""
    from matplotlib.path import Path as Curve
    from matplotlib.tri import Triangulation

    positions = np.vstack((found.positions, [point.position for point in found.boundary]))
    q = np.vstack((found.q, [point.q for point in found.boundary]))
    drawable = _drawable(found, q)
    positions, q = positions[drawable], q[drawable]
    fields = _fields(found, q, armature)
    columns = len(fields[0])
    figure.set_size_inches(_WIDTH, 0.42 + 1.72 * len(fields))
    axes = figure.subplots(len(fields), columns, sharex=True, sharey=True, squeeze=False)
    curves = [np.array([found.boundary[index].position for index in curve]) for curve in found.outlines]
    degrees = _in_degrees(found)
    triangles = Triangulation(*(degrees * positions).T)
    centres = positions[triangles.triangles].mean(axis=1)
    inside = Curve(curves[0]).contains_points(centres)
    for hole in curves[1:]:
        inside &= ~Curve(hole).contains_points(centres)
    triangles.set_mask(~inside)
    units = _shown_units(found)
    colors = _colors(found)
    for row, own in enumerate(fields):
        for column, (title, values) in enumerate(own):
            axis = axes[row, column]
            filled = axis.tricontourf(triangles, values, levels=12, cmap="viridis")
            lines = axis.tricontour(triangles, values, levels=filled.levels[2:-1:3], colors="white", linewidths=0.5)
            axis.clabel(lines, fontsize=5.5, fmt="%.3g")
            bar = figure.colorbar(filled, ax=axis, pad=0.02, aspect=25)
            bar.outline.set_linewidth(0.4)
            bar.ax.tick_params(labelsize=5.5, width=0.4)
            axis.set_title(title)
            _draw_outlines(axis, found, colors)
            axis.use_sticky_edges = False  # else the filled contours hide half of the outline
            axis.margins(0.04)
            if row == len(fields) - 1:
                axis.set_xlabel(f"{found.joints[0]} [{units[0]}]")
            if column == 0:
                axis.set_ylabel(f"{found.joints[1]} [{units[1]}]")
    _legend(figure, colors)


def _curves(figure: Any, found: Workspace, armature: Mapping[str, float] | None) -> None:
    """Curves over one joint."""
    order = np.argsort(found.positions[:, 0])
    q = found.q[order]
    drawable = _drawable(found, q)
    positions, q = found.positions[order][drawable], q[drawable]
    (fields,) = _fields(found, q, armature)
    figure.set_size_inches(_WIDTH, 2.2)
    axes = figure.subplots(1, len(fields), squeeze=False)[0]
    (degrees,), (unit,) = _in_degrees(found), _shown_units(found)
    colors = _colors(found)
    for axis, (title, values) in zip(axes, fields, strict=True):
        axis.plot(degrees * positions[:, 0], values, color=_COLORS[0], linewidth=1.0)
        axis.set_title(title)
        axis.set_xlabel(f"{found.joints[0]} [{unit}]")
        axis.set_ylim(bottom=0.0)
        for point in found.boundary:
            axis.axvline(degrees * point.position[0], color=colors[point.stop], linewidth=1.2)
    _legend(figure, colors)


def _drawable(found: Workspace, q: Matrix) -> Any:
    """Which configurations (B,) are not nearly singular."""
    return np.nan_to_num(found.transmissions_at(q).condition, nan=np.inf) < _WORST_CONDITION


def _fields(found: Workspace, q: Matrix, armature: Mapping[str, float] | None) -> list[list[_Field]]:
    """The quantities of each joint at configurations (B, nq)."""
    robot, (joints, motors) = found.robot, found.selections
    limits = condition = None
    if unlimited_motors(robot, motors):
        condition = found.transmissions_at(q).condition
    else:
        limits = cast(CommonLimits, serial_limits(robot, joints.joints, q, motors=motors.joints))
    inertia = reflected_inertia(robot, joints.joints, q, motors=motors.joints, armature=armature).equivalent_armature
    rows: list[list[_Field]] = []
    for k, (name, unit) in enumerate(zip(joints.names, found.units, strict=True)):
        force, speed, inert, scale = _UNITS[unit]
        row = [("condition number of G", condition)] if condition is not None else []
        if limits is not None:
            row.append((f"{name}: torque [{force}]", np.abs(limits.torque_axes[:, k]).min(axis=1)))
            row.append((f"{name}: velocity [{speed}]", np.abs(limits.velocity_axes[:, k]).min(axis=1)))
        rows.append([*row, (f"{name}: inertia [{inert}]", scale * inertia[:, k, k])])
    return rows


def _in_degrees(found: Workspace) -> Vector:
    """Factors (nJ,) that turn rad into degrees, and leave m."""
    return np.array([180.0 / np.pi if unit == "rad" else 1.0 for unit in found.units])


def _shown_units(found: Workspace) -> list[str]:
    return ["°" if unit == "rad" else unit for unit in found.units]


def _draw_outlines(axis: Any, found: Workspace, colors: Mapping[Stop, str]) -> None:
    """The curves, each part in the color of the stop at its ends."""
    degrees = _in_degrees(found)
    for curve in found.outlines:
        points = [found.boundary[index] for index in curve]
        for one, other in zip(points, [*points[1:], points[0]], strict=True):
            x, y = zip(degrees * one.position, degrees * other.position, strict=True)
            axis.plot(x, y, color=colors[one.stop], linewidth=1.6, solid_capstyle="round")


def _colors(found: Workspace) -> dict[Stop, str]:
    """The color of each stop; singular poses are black."""
    others = [stop for stop in found.stops if stop.joint]
    colors = {stop: _COLORS[index % len(_COLORS)] for index, stop in enumerate(others)}
    return {stop: colors.get(stop, _SINGULAR) for stop in found.stops}


def _legend(figure: Any, colors: Mapping[Stop, str]) -> None:
    from matplotlib.lines import Line2D

    lines = [Line2D([], [], color=color, linewidth=1.6, label=str(stop)) for stop, color in colors.items()]
    figure.legend(handles=lines, loc="outside lower center", ncols=min(4, len(lines)), frameon=False, fontsize=6.0)
