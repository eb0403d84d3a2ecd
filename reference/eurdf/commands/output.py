"""Writing to the standard streams: styled on a terminal, plain text elsewhere."""

from __future__ import annotations

import io
import json
import os
import sys
from collections.abc import Iterable
from typing import TYPE_CHECKING, Any, TextIO

if TYPE_CHECKING:
    from rich.console import Console, RenderableType
    from rich.table import Table
    from rich.text import Text

    from eurdf.diagnostics.text import Line

# A table in a file is as wide as it needs to be.
_UNBOUNDED = 10_000


def is_terminal(stream: TextIO) -> bool:
    """Whether to style the output: on a terminal or with FORCE_COLOR, but not with TERM=dumb."""
    if os.environ.get("FORCE_COLOR"):
        return True
    return stream.isatty() and os.environ.get("TERM") != "dumb"


def has_boxes(stream: TextIO) -> bool:
    """Whether the stream is a terminal that shows more than ASCII."""
    return is_terminal(stream) and (stream.encoding or "").lower().replace("-", "") == "utf8"


def columns() -> int:
    """Width of the terminal."""
    import shutil  # only now: it imports what unpacks archives

    return max(40, shutil.get_terminal_size().columns)


def write_text(text: str) -> None:
    """Write the text of a file to the standard output in UTF-8, whatever the locale."""
    if isinstance(sys.stdout, io.TextIOWrapper):
        sys.stdout.reconfigure(encoding="utf-8")
    sys.stdout.write(text)


def write_json(value: dict[str, Any]) -> None:
    """Write one JSON value to the standard output."""
    write_text(json.dumps(value, indent=2, allow_nan=False) + "\n")


def write_lines(lines: Iterable[Line], stream: TextIO) -> None:
    """Write styled lines without wrapping; none of them is a command of a workflow."""
    from eurdf.diagnostics.visible import no_command

    if not is_terminal(stream):
        for line in lines:
            stream.write(no_command("".join(piece for piece, _ in line).rstrip()) + "\n")
        return
    from rich.text import Text

    console = _console(stream)
    with console.capture() as captured:
        for line in lines:
            console.print(Text.assemble(*line), soft_wrap=True)
    stream.write("".join(map(no_command, captured.get().splitlines(keepends=True))))


def write_rendered(*renderables: RenderableType) -> None:
    """Write rich renderables to the standard output, separated by empty lines; no line is a command of a workflow."""
    from eurdf.diagnostics.visible import no_command

    console = _console(sys.stdout)
    with console.capture() as captured:
        console.print(renderables[0])
        for renderable in renderables[1:]:
            console.print()
            console.print(renderable)
    sys.stdout.write("".join(no_command(line.rstrip()) + "\n" for line in captured.get().splitlines()))


def new_table(*headings: str) -> Table:
    """An empty table for the standard output, with lines on a terminal."""
    from rich import box
    from rich.table import Table

    table = Table(
        box=box.SIMPLE_HEAD if has_boxes(sys.stdout) else None,
        border_style="dim",
        header_style="dim",
        show_edge=False,
        pad_edge=False,
    )
    for heading in headings:
        table.add_column(heading, overflow="fold")
    return table


def cell(text: str, style: str = "") -> Text:
    """A table cell: text without markup, with control characters made visible."""
    from rich.text import Text

    from eurdf.diagnostics.visible import visible

    return Text(visible(text), style=style)


def _console(stream: TextIO) -> Console:
    # Render into a capture: on a broken pipe, rich would exit with code 1.
    from rich.console import Console

    terminal = is_terminal(stream)
    return Console(
        force_terminal=terminal,
        width=columns() if terminal else _UNBOUNDED,
        highlight=False,
        markup=False,
        emoji=False,
        safe_box=not has_boxes(stream),
    )
