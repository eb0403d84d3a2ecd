"""Writing to the standard streams: styled on a terminal, plain text elsewhere."""

from __future__ import annotations

import io
import json
import os
import sys
from collections.abc import Callable, Iterable, Iterator, Sequence
from contextlib import contextmanager
from typing import TYPE_CHECKING, Any, TextIO

if TYPE_CHECKING:
    from rich.console import Console, RenderableType
    from rich.table import Table
    from rich.text import Text

    from eurdf.diagnostics import Diagnostic
    from eurdf.diagnostics.report import Report
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
    from eurdf.diagnostics.wording import no_command

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


def write_notes(sentences: Iterable[str]) -> None:
    """Write to the standard error, a line each."""
    from eurdf.diagnostics.wording import no_command, visible

    for sentence in sentences:
        sys.stderr.write(f"{no_command(visible(sentence))}\n")


def write_reports(reports: Sequence[Report], strict: bool = False, stream: TextIO | None = None) -> None:
    """Write diagnostics and verdicts as text, to the standard output by default."""
    from eurdf.diagnostics.text import SOURCE_WIDTH, report_lines, summary_line, total_line

    stream = stream or sys.stdout
    width = min(columns() - len("12345 | "), 2 * SOURCE_WIDTH) if is_terminal(stream) else SOURCE_WIDTH
    bar = "│" if has_boxes(stream) else "|"
    for report in reports:
        write_lines([*report_lines(report, width, bar), summary_line(report, strict)], stream)
        if report.diagnostics and len(reports) > 1:
            write_lines([[]], stream)
    if len(reports) > 1:
        write_lines([total_line(reports, strict)], stream)


def write_refusal(path: str, diagnostics: Iterable[Diagnostic], as_json: bool, stream: TextIO | None = None) -> None:
    """Write the diagnostics of a robot that cannot be built: as JSON, or to a stream, the standard error by default."""
    from eurdf.diagnostics.report import Report, reports_to_json

    report = Report(path, tuple(diagnostics))
    if as_json:
        write_json(reports_to_json([report]))
    else:
        write_reports([report], stream=stream or sys.stderr)


@contextmanager
def progress_bar(what: str, wanted: bool = True) -> Iterator[Callable[[float, float], None] | None]:
    """A bar on the standard error, if that is a terminal, while the context lasts.

    Yields:
        What to call with the amount that is done and the whole; None if there is no bar.
    """
    if not (wanted and sys.stderr.isatty() and is_terminal(sys.stderr)):
        yield None
        return
    from rich.console import Console
    from rich.progress import Progress

    with Progress(console=Console(stderr=True), transient=True) as bar:
        task = bar.add_task(what)
        yield lambda done, whole: bar.update(task, completed=done, total=whole)


def write_rendered(*renderables: RenderableType) -> None:
    """Write rich renderables to the standard output, separated by empty lines; no line is a command of a workflow."""
    from eurdf.diagnostics.wording import no_command

    console = _console(sys.stdout)
    with console.capture() as captured:
        console.print(renderables[0])
        for renderable in renderables[1:]:
            console.print()
            console.print(renderable)
    sys.stdout.write("".join(no_command(line.rstrip()) + "\n" for line in captured.get().splitlines()))


def new_table(*headings: str, rows: Iterable[Iterable[Any]] = (), right: Iterable[int] = ()) -> Table:
    """A table for the standard output, with lines on a terminal; the columns ``right`` are aligned to the right."""
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
    for column in right:
        table.columns[column].justify = "right"
    for row in rows:
        table.add_row(*row)
    return table


def cell(text: str, style: str = "") -> Text:
    """A table cell: text without markup, with control characters made visible."""
    from rich.text import Text

    from eurdf.diagnostics.wording import visible

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
