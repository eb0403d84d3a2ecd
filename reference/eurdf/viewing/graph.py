"""The graph of links and loops as SVG: the tree as indented lines, and an arc for each closure or coupling."""

from __future__ import annotations

import html
import os
from itertools import pairwise

from eurdf.diagnostics.wording import visible
from eurdf.mechanism.constraint import Constraint
from eurdf.mechanism.mechanism import Mechanism
from eurdf.writing.atomic_file import write_atomically

# Pixels: height of a line, indentation of a child, width of a letter, distance between arcs.
_LINE, _INDENT, _LETTER, _ARC = 18, 12, 7, 12

_TREE, _ACTUATED = "#868e96", "#14a03c"
# Of arcs: the first where names are shown under the pointer, in turn where they are written.
_CLOSURES = ("#8c3cc8", "#c2410c", "#1864ab", "#a61e4d", "#0b7285", "#7a5c00")


def graph_svg(mechanism: Mechanism, *, named: bool = False) -> str:
    """The graph of a mechanism as SVG; names in it are escaped.

    Each line is a link, below the one that it hangs from; those moved by an actuated joint are bold. Each arc is a
    closure, from the link of its frame A to that of its frame B, or a coupling, at the links that its joints move.

    Args:
        mechanism: The mechanism.
        named: Whether to write the names of joints beside their links and those of closures and couplings beside their
            arcs, as a picture needs; otherwise they are shown under the pointer.
    """
    index = {body.name: number for number, body in enumerate(mechanism.bodies)}
    parents = [-1, *(index[joint.parent] for joint in mechanism.joints)]
    depths: list[int] = []
    for parent in parents:  # a parent comes before its children
        depths.append(0 if parent < 0 else depths[parent] + 1)
    labels = [mechanism.bodies[0].name]
    labels += [joint.child for joint in mechanism.joints]
    titles = ["root", *(f"{joint.type} joint {joint.name}" for joint in mechanism.joints)]
    beside = ["", *(f"{joint.name} ({joint.type})" for joint in mechanism.joints)] if named else [""] * len(labels)
    left = [_INDENT * (depth + 1) for depth in depths]
    ends = [x + _LETTER * _length(label) + 6 for x, label in zip(left, labels, strict=True)]
    names_at = [*ends]
    ends = [end + (_LETTER * _length(text) + 8 if text else 0) for end, text in zip(ends, beside, strict=True)]
    middle = [_LINE * number + _LINE // 2 for number in range(len(labels))]
    shapes = []
    for number, parent in enumerate(parents):
        if parent >= 0:
            x = left[parent] + 2
            shapes.append(_path(f"M {x} {middle[parent] + 8} V {middle[number]} H {left[number] - 2}", _TREE))
    actuated = set(mechanism.actuators)
    for number, label in enumerate(labels):
        drives = number > 0 and mechanism.joints[number - 1].name in actuated
        style = f'font-weight="bold" fill="{_ACTUATED}"' if drives else 'fill="currentColor"'
        shapes.append(_text(left[number], middle[number], style, label, titles[number]))
        if beside[number]:
            shapes.append(_text(names_at[number] + 4, middle[number], f'fill="{_TREE}"', beside[number]))
    out = max(ends)
    carried = {joint.name: number + 1 for number, joint in enumerate(mechanism.joints)}
    arcs: list[tuple[Constraint, list[int]]]
    arcs = [(closure, [index[anchor.body] for anchor in closure.anchors]) for closure in mechanism.closures]
    arcs += [(coupling, [carried[joint] for joint in coupling.joints]) for coupling in mechanism.couplings]
    label_at = out + _ARC * (len(arcs) + 1)
    wide, row = label_at, 0
    for number, (constraint, links) in enumerate(arcs):
        color = _CLOSURES[number % len(_CLOSURES)] if named else _CLOSURES[0]
        x = out + _ARC * (number + 1)
        title = f"{constraint.name} ({constraint.type})"
        for a, b in pairwise(sorted(links)):
            line = f"M {ends[a]} {middle[a]} H {x - 5} Q {x} {middle[a]} {x} {(middle[a] + middle[b]) / 2:g}"
            line += f" Q {x} {middle[b]} {x - 5} {middle[b]} H {ends[b]}"
            shapes.append(_path(line, color, title))
        if named:
            shapes.append(_text(label_at, _LINE * row + _LINE // 2, f'fill="{color}"', title))
            wide, row = max(wide, label_at + _LETTER * _length(title) + 6), row + 1
    return (
        f'<svg xmlns="http://www.w3.org/2000/svg" width="{wide}" height="{_LINE * max(len(labels), row)}" '
        f'font-size="12" font-family="monospace">{"".join(shapes)}</svg>'
    )


def save_graph(mechanism: Mechanism, file: str | os.PathLike[str]) -> None:
    """Write the graph with all names, black on white, to an SVG file; an existing one is replaced.

    Raises:
        OSError: It cannot be written.
    """
    drawn = graph_svg(mechanism, named=True)
    head, _, rest = drawn.partition(">")
    page = f'{head} color="black"><rect width="100%" height="100%" fill="white"/>{rest}\n'
    write_atomically(file, page)


def _length(text: str) -> int:
    """Letters of a text as it is shown."""
    return len(visible(text))


def _escaped(text: str) -> str:
    """A text as SVG that shows it as it is: names come from files and can contain anything."""
    return html.escape(visible(text))


def _text(x: int, middle: int, style: str, text: str, title: str = "") -> str:
    return f'<text x="{x}" y="{middle + 4}" {style}>{_escaped(text)}{_title(title)}</text>'


def _path(line: str, color: str, title: str = "") -> str:
    return f'<path d="{line}" fill="none" stroke="{color}" stroke-width="1.5">{_title(title)}</path>'


def _title(text: str) -> str:
    """What is shown under the pointer."""
    return f"<title>{_escaped(text)}</title>" if text else ""
