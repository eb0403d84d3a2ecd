"""The graph of links and loops as SVG: the tree as indented lines, and an arc for each closure."""

from __future__ import annotations

from eurdf.mechanism.mechanism import Mechanism
from eurdf.viewing.text import escaped

# Pixels: height of a line, indentation of a child, width of a letter, distance between arcs.
_LINE, _INDENT, _LETTER, _ARC = 18, 12, 7, 12

_TREE, _CLOSURE, _ACTUATED = "#868e96", "#8c3cc8", "#14a03c"


def graph_svg(mechanism: Mechanism) -> str:
    """The graph of a mechanism as SVG; names in it are escaped.

    Each line is a link, below the one that it hangs from; those moved by an actuated joint are bold. Each arc is a
    closure, from the link of its frame A to that of its frame B. Joints and closures are named under the pointer.
    """
    index = {body.name: number for number, body in enumerate(mechanism.bodies)}
    parents = [-1, *(index[joint.parent] for joint in mechanism.joints)]
    depths: list[int] = []
    for parent in parents:  # a parent comes before its children
        depths.append(0 if parent < 0 else depths[parent] + 1)
    labels = [mechanism.bodies[0].name]
    labels += [joint.child for joint in mechanism.joints]
    titles = ["root", *(f"{joint.type} joint {joint.name}" for joint in mechanism.joints)]
    left = [_INDENT * (depth + 1) for depth in depths]
    ends = [x + _LETTER * len(label) + 6 for x, label in zip(left, labels, strict=True)]
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
        shapes.append(
            f'<text x="{left[number]}" y="{middle[number] + 4}" {style}>{escaped(label)}{_title(titles[number])}</text>'
        )
    out = max(ends)
    for number, closure in enumerate(mechanism.closures):
        a, b = index[closure.a.body], index[closure.b.body]
        x = out + _ARC * (number + 1)
        line = f"M {ends[a]} {middle[a]} H {x - 5} Q {x} {middle[a]} {x} {(middle[a] + middle[b]) / 2:g}"
        line += f" Q {x} {middle[b]} {x - 5} {middle[b]} H {ends[b]}"
        shapes.append(_path(line, _CLOSURE, f"{closure.name} ({closure.type})"))
    width, height = out + _ARC * (len(mechanism.closures) + 1), _LINE * len(labels)
    return (
        '<div style="overflow-x: auto; padding: 2px 8px">'
        f'<svg xmlns="http://www.w3.org/2000/svg" width="{width}" height="{height}" font-size="12" '
        f'font-family="monospace">{"".join(shapes)}</svg></div>'
    )


def _path(line: str, color: str, title: str = "") -> str:
    return f'<path d="{line}" fill="none" stroke="{color}" stroke-width="1.5">{_title(title)}</path>'


def _title(text: str) -> str:
    """What is shown under the pointer."""
    return f"<title>{escaped(text)}</title>" if text else ""
