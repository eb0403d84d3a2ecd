"""Texts of the page. Names come from files and can contain anything: everything is escaped here."""

from __future__ import annotations

import html
import math
from collections.abc import Iterable, Sequence

from eurdf.diagnostics import Diagnostic
from eurdf.diagnostics.registry import Severity
from eurdf.diagnostics.wording import visible
from eurdf.kinematics.analysis import FIGURES, Analysis
from eurdf.kinematics.opening import Opening
from eurdf.transmissions.passive_limits import PassiveLimit

_BOX = "font-size: 13px; line-height: 1.4; padding: 2px 8px; overflow-wrap: anywhere"
_RED, _ORANGE, _GREEN = "#c92a2a", "#b35c00", "#2b7a3d"


def escaped(text: str) -> str:
    """A text as HTML that shows it as it is."""
    return html.escape(visible(text))


def box(*parts: str, color: str = "inherit") -> str:
    """A box with lines of HTML."""
    return f'<div style="{_BOX}; color: {color}">{"<br>".join(parts)}</div>'


def status(residual: float, openings: Sequence[Opening], messages: Iterable[str]) -> str:
    """The state of the loops, and what the user should know.

    Args:
        residual: Largest row of the residual, m or rad.
        openings: How far each constraint is open.
        messages: Why a motion stopped, and what went wrong.
    """
    is_open = [escaped(str(opening)) for opening in openings if opening.is_open]
    if not openings:
        loops = box("no loops")
    elif is_open:
        loops = box(f"loops are open: {'; '.join(is_open)}", color=_RED)
    else:
        loops = box(f"loops are closed, residual {residual:.1e}", color=_GREEN)
    return loops + "".join(box(escaped(message), color=_ORANGE) for message in messages)


def dimensions(analysis: Analysis) -> str:
    """The figures of `eurdf info`."""
    cells = "".join(
        f"<tr style='overflow-wrap: normal'><td>{name}</td>"
        f"<td style='text-align: right; padding: 0 8px'><b>{'-' if value is None else value}</b></td>"
        f"<td style='opacity: 0.7'>{meaning}</td></tr>"
        for name, meaning in FIGURES.items()
        for value in [getattr(analysis, name)]
    )
    dependent = [
        box(f"dependent actuators: {escaped(', '.join(joints))}", color=_ORANGE)
        for joints in analysis.dependent_actuators
    ]
    left_out = [box(escaped(analysis.left_out), color=_ORANGE)] if analysis.left_out else []
    return f'<div style="{_BOX}"><table>{cells}</table></div>' + "".join([*dependent, *left_out])


def gauge(analysis: Analysis) -> str:
    """The distances to singularity."""
    if analysis.singularity is None:
        return box("no loops, so no singularity of the closures")
    actuation = analysis.actuation_singularity
    held = "" if actuation is None else f"; with every actuator held {actuation:.2g}"
    return box(f"distance to singularity {analysis.singularity:.2g}{held}; 0 is singular")


def limits(found: Sequence[PassiveLimit]) -> str:
    """The velocities and torques of passive joints that the actuators allow."""
    if not found:
        return box("the actuators determine no passive joint")
    heads = "".join(f"<th style='text-align: right; padding-left: 8px'>{head}</th>" for head in ("velocity", "torque"))
    rows = "".join(
        f"<tr><td>{escaped(each.name)}</td>"
        + "".join(f"<td style='text-align: right; padding-left: 8px'>{escaped(cell)}</td>" for cell in _cells(each))
        + "</tr>"
        for each in found
    )
    table = f"<table><tr><th style='text-align: left'>passive joint</th>{heads}</tr>{rows}</table>"
    return box("what the limits of the actuators allow at this configuration, at one joint at a time", table)


def _cells(limit: PassiveLimit) -> tuple[str, str]:
    velocity = f"± {limit.velocity:.4g} {limit.unit}/s" if math.isfinite(limit.velocity) else "no limit"
    unit, (lower, upper) = "N" if limit.unit == "m" else "N·m", limit.torque
    if not (math.isfinite(lower) or math.isfinite(upper)):
        return velocity, "no limit"
    symmetric = math.isclose(-lower, upper, rel_tol=1e-9)
    return velocity, f"± {upper:.4g} {unit}" if symmetric else f"{lower:.4g} to {upper:.4g} {unit}"


def diagnostics(found: Sequence[Diagnostic]) -> str:
    """Diagnostics with file and line, errors first."""
    if not found:
        return box("no errors, no warnings", color=_GREEN)
    first = sorted(found, key=lambda each: each.severity is not Severity.ERROR)
    shown = []
    for each in first:
        hint = f"<br>hint: {escaped(each.hint)}" if each.hint else ""
        text = (
            f"{escaped(str(each.place))}: {each.severity.value}: {escaped(each.message)} [{escaped(each.code)}]{hint}"
        )
        shown.append(box(text, color=_RED if each.severity is Severity.ERROR else _ORANGE))
    return "".join(shown)


def first_error(found: Sequence[Diagnostic]) -> str:
    """The first error with its place, as a text without HTML."""
    return next((str(each) for each in found if each.severity is Severity.ERROR), "")
