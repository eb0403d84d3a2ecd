"""What is shown where the pointer rests: what is named there, what a key means, which clause is violated."""

from __future__ import annotations

import math
from collections.abc import Iterator

from lsprotocol import types as lsp

from eurdf.diagnostics import REGISTRY, Diagnostic
from eurdf.diagnostics.lines import Lines
from eurdf.diagnostics.sarif import help_uri
from eurdf.editor.completion import about
from eurdf.editor.cursor import cursor_at, types_at
from eurdf.editor.documents import is_xml_file
from eurdf.editor.names import Occurrence
from eurdf.editor.open_robots import KnownRobot, OpenRobots
from eurdf.editor.shown import place_of
from eurdf.format.mappings import Key, Record
from eurdf.mechanism.constraint import Closure, Constraint
from eurdf.mechanism.joint import Joint
from eurdf.mechanism.mechanism import Mechanism


def hover(robots: OpenRobots, path: str, at: lsp.Position) -> lsp.Hover | None:
    """What is known of a place of a document, as Markdown; None for nothing."""
    lines = Lines(robots.documents.text(path))
    index = robots.documents.index(lines, at)
    parts = [*_of_name(robots, path, index)]
    if not parts and not is_xml_file(path) and (key := _key_at(lines.text, index)) is not None:
        parts = [f"**{key.title}**", key.text]
    for found in robots.found().get(path, ()):
        where = place_of(robots, path, found)
        if where.start <= at <= where.end:
            parts.append(_clause(found))
    return lsp.Hover(lsp.MarkupContent(lsp.MarkupKind.Markdown, "\n\n".join(parts))) if parts else None


def _clause(found: Diagnostic) -> str:
    rule, page = REGISTRY[found.code], help_uri(found.code)
    code = f"[`{found.code}`]({page})" if page.startswith("http") else f"`{found.code}`"
    return f"{code} {rule.clause or 'advice'}: {rule.title}"


def _key_at(text: str, index: int) -> Key | None:
    """The key of the format that is at a character."""
    cursor = cursor_at(text, index)
    if cursor is None or not cursor.is_key:
        return None
    word = text[cursor.start : cursor.end]
    kinds = types_at(cursor.data, cursor.pointer, cursor.version)
    records = [each for each in kinds if isinstance(each, Record) and word in each.keys(cursor.version)]
    return records[0].keys(cursor.version)[word] if records else None


def _of_name(robots: OpenRobots, path: str, index: int) -> Iterator[str]:
    names = robots.names(path)
    here = names.at(path, index)
    if here is None:
        return
    defined = names.of(here.kind).get(here.name, here)
    yield f"**{here.kind} `{here.name}`**"
    examined = robots.examined.get(robots.robots_of(path)[0], KnownRobot())
    mechanism = examined.mechanism
    joint = None if mechanism is None else next((each for each in mechanism.joints if each.name == here.name), None)
    if here.kind == "joint" and mechanism is not None and joint is not None:
        yield from _of_joint(mechanism, joint, defined)
    elif here.kind == "joint":
        yield about(defined)
    elif mechanism is not None:
        yield from _of_others(mechanism, here, examined)


def _of_joint(mechanism: Mechanism, joint: Joint, defined: Occurrence) -> Iterator[str]:
    stated = defined.element.get("type") if defined.element is not None else joint.type.value
    in_urdf = "" if stated == joint.type.value else f" ({stated} in the URDF)"
    yield f"{joint.type.value}{in_urdf}: `{joint.parent}` → `{joint.child}`"
    if joint.type.is_fixed:
        return
    if joint.axes:
        yield "axis " + ", ".join(_vector(axis) for axis in joint.axes)
    ranges = [f"{_number(low)} … {_number(high)}" for low, high in joint.ranges if math.isfinite(high - low)]
    efforts = [_number(each) for each in joint.properties.effort if math.isfinite(each)]
    if ranges:
        yield f"range {', '.join(ranges)} (rad, m)"
    if efforts:
        yield f"effort up to {', '.join(efforts)} (N·m, N)"
    if joint.mimic is not None:
        yield f"follows `{joint.mimic.joint}`: {_number(joint.mimic.multiplier)} q + {_number(joint.mimic.offset)}"
    elif joint.name in mechanism.actuators:
        name = mechanism.motor(joint.name).name
        yield "actuated" + ("" if name == joint.name else f", by actuator `{name}`")
    else:
        yield "passive"


def _of_others(mechanism: Mechanism, here: Occurrence, examined: KnownRobot) -> Iterator[str]:
    body = next((each for each in mechanism.bodies if each.name == here.name), None)
    constraint = next((each for each in mechanism.constraints if each.name == here.name), None)
    frame = next((each for each in mechanism.frames if each.name == here.name), None)
    if here.kind == "link" and body is not None:
        yield "no mass" if body.inertia is None else f"{_number(body.inertia.mass)} kg"
    elif here.kind == "frame" and frame is not None:
        yield f"on body `{frame.body}`, at {_vector(frame.pose.xyz)} m"
    elif here.kind in ("closure", "coupling") and constraint is not None:
        yield from _of_constraint(constraint, examined)


def _of_constraint(constraint: Constraint, examined: KnownRobot) -> Iterator[str]:
    between = f": `{constraint.a.body}` and `{constraint.b.body}`" if isinstance(constraint, Closure) else ""
    yield f"{constraint.rows} constraint row{'s' * (constraint.rows > 1)}{between}"
    if examined.figures is None:
        return
    opening = examined.figures.openings.get(constraint.name)
    if opening is not None:
        yield f"{'open' if opening.is_open else 'closed'}: {opening.position:.1e} m, {opening.angle:.1e} rad"
    loop = next((each for each in examined.figures.analysis.loops if constraint.name in each.closures), None)
    if loop is not None:
        with_others = [name for name in loop.closures if name != constraint.name]
        among = f", with {', '.join(f'`{name}`' for name in with_others)}" if with_others else ""
        yield f"its loops{among} have mobility {loop.mobility}, {loop.actuated} actuated"


def _number(value: float) -> str:
    return f"{value:.4g}"


def _vector(values: tuple[float, ...]) -> str:
    return f"({', '.join(map(_number, values))})"
