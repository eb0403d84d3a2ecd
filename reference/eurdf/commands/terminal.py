"""Writing to the standard streams: styled on a terminal, plain text elsewhere."""

from __future__ import annotations

import io
import json
import os
import sys
from collections.abc import Callable, Iterable, Iterator, Sequence
from contextlib import contextmanager
from contextvars import ContextVar
from threading import Timer
from typing import TYPE_CHECKING, Any, NamedTuple, TextIO, TypeAlias

if TYPE_CHECKING:
    from rich.console import Console
    from rich.table import Table as RichTable
    from rich.text import Text

    from eurdf.diagnostics import Diagnostic
    from eurdf.diagnostics.report import Report
    from eurdf.diagnostics.text import Line

#: A wait of this many seconds is shown on a terminal.
PATIENCE = 1.0

# Columns between two columns of a table, and those that a sentence in it needs at least.
_GAP, _SENTENCE = 3, 40

# A table in a file is as wide as it needs to be.
_UNBOUNDED = 10_000


class Style(NamedTuple):
    """What the user chose of the output: no notes, or no colours."""

    quiet: bool = False
    no_color: bool = False


_PLAIN = Style()

#: The style of the command that runs.
STYLE: ContextVar[Style] = ContextVar("STYLE", default=_PLAIN)


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


def write_notes(sentences: Iterable[str], *, quiet: bool = True) -> None:
    """Write to the standard error, a line each; if they may be left out, not with ``--quiet``."""
    from eurdf.diagnostics.wording import no_command, visible

    if quiet and STYLE.get().quiet:
        return
    for sentence in sentences:
        sys.stderr.write(f"{no_command(visible(sentence))}\n")


def write_reports(
    reports: Sequence[Report], strict: bool = False, stream: TextIO | None = None, *, verdict: bool = True
) -> None:
    """Write diagnostics, and verdicts unless they are not wanted, as text, to the standard output by default."""
    from eurdf.diagnostics.text import SOURCE_WIDTH, report_lines, summary_line, total_line
    from eurdf.diagnostics.wording import visible

    stream = stream or sys.stdout
    width = min(columns() - len("12345 | "), 2 * SOURCE_WIDTH) if is_terminal(stream) else SOURCE_WIDTH
    bar = "│" if has_boxes(stream) else "|"
    if STYLE.get().quiet or not verdict:
        write_lines((line for report in reports for line in report_lines(report, width, bar)), stream)
        return
    for report in reports:
        write_lines([*report_lines(report, width, bar), summary_line(report, strict)], stream)
        if report.diagnostics and len(reports) > 1:
            write_lines([[]], stream)
    if len(reports) > 1:
        write_lines([total_line(reports, strict)], stream)
    else:
        write_lines([[(f"note: {visible(note)}", "dim")] for report in reports for note in report.notes], stream)


def write_refusal(path: str, diagnostics: Iterable[Diagnostic], as_json: bool, stream: TextIO | None = None) -> None:
    """Write the diagnostics of a robot that cannot be built: as JSON, or to a stream, the standard error by default."""
    from eurdf.diagnostics.report import Report, reports_to_json

    report = Report(path, tuple(diagnostics))
    if as_json:
        write_json(reports_to_json([report]))
    else:
        write_reports([report], stream=stream or sys.stderr)


@contextmanager
def progress_bar(what: str, after: float = PATIENCE) -> Iterator[Callable[[float, float], None] | None]:
    """A bar on the standard error, if that is a terminal, while the context lasts, from so many seconds on.

    Yields:
        What to call with the amount that is done and the whole; None if there is no bar.
    """
    if not (sys.stderr.isatty() and is_terminal(sys.stderr)) or STYLE.get().quiet:
        yield None
        return
    from rich.progress import Progress

    bar = Progress(console=_console(sys.stderr), transient=True)
    task = bar.add_task(what, total=None)
    timer = Timer(after, bar.start)
    timer.daemon = True
    if after:
        timer.start()
    else:
        bar.start()
    try:
        yield lambda done, whole: bar.update(task, completed=done, total=whole)
    finally:
        timer.cancel()
        if after:
            timer.join()
        bar.stop()


def write_shown(*shown: Table | Sequence[Cell]) -> None:
    """Write tables and lines to the standard output, separated by empty lines; none is a command of a workflow.

    Only on a terminal does it load rich, which takes longer than most commands have to write.
    """
    from eurdf.diagnostics.wording import no_command

    if is_terminal(sys.stdout):
        console = _console(sys.stdout)
        with console.capture() as captured:
            for number, each in enumerate(shown):
                if number:
                    console.print()
                console.print(each.styled() if isinstance(each, Table) else _styled(each))
        lines = captured.get().splitlines()
    else:
        plain: Iterator[list[str]] = (each.lines() if isinstance(each, Table) else [_plain(each)] for each in shown)
        lines = [line for each in plain for line in ["", *each]][1:]
    sys.stdout.write("".join(no_command(line.rstrip()) + "\n" for line in lines))


#: A text, or a text and its rich style; control characters are made visible where it is written.
Cell: TypeAlias = "str | Sequence[str]"


class Table:
    """A table for the standard output, with lines on a terminal.

    Args:
        headings: Of the columns; if all are empty, the table has none.
        rows: The cells of each row.
        right: The columns that are aligned to the right.
        spare: The columns that a narrow terminal leaves out, the first of them first; it says which. Sentences are
            folded, and where there is still no room, all else.
    """

    def __init__(
        self, *headings: str, rows: Iterable[Iterable[Cell]], right: Iterable[int] = (), spare: Iterable[int] = ()
    ) -> None:
        self.headings, self.rows, self.right, self.spare = headings, [[*row] for row in rows], {*right}, [*spare]

    def lines(self) -> list[str]:
        """As text in columns."""
        from eurdf.diagnostics.text import cells

        rows, widths = self._cells(), self._widths()

        def padded(column: int, text: str) -> str:
            space = " " * (widths[column] - cells(text))
            return space + text if column in self.right else text + space

        return ["  ".join(padded(*each) for each in enumerate(row)) for row in rows]

    def _cells(self) -> list[list[str]]:
        """As text, with the headings if there are any."""
        rows = [self.headings, *self.rows] if any(self.headings) else self.rows
        return [[_plain([cell]) for cell in row] for row in rows]

    def _widths(self) -> list[int]:
        from eurdf.diagnostics.text import cells

        return [max(map(cells, column)) for column in zip(*self._cells(), strict=True)]

    def _shown(self, room: int) -> tuple[list[int], set[int]]:
        """The columns for which a terminal has room, and those of them that must not be folded."""
        folded = {number for row in self.rows for number, cell in enumerate(row) if " " in _plain([cell])}
        widths = enumerate(self._widths())
        needed = {n: min(width, _SENTENCE) if n in folded else width for n, width in widths if width}
        for column in self.spare:
            if column in needed and sum(needed.values()) + _GAP * (len(needed) - 1) > room:
                del needed[column]
        fits = sum(needed.values()) + _GAP * (len(needed) - 1) <= room
        return [*needed], {*needed} - folded if fits else set()

    def styled(self) -> RichTable:
        """For a terminal."""
        from rich import box
        from rich.table import Table as RichTable

        columns_shown, whole = self._shown(columns())
        left_out = [heading for number, heading in enumerate(self.headings) if number not in columns_shown and heading]
        table = RichTable(
            box=box.SIMPLE_HEAD if has_boxes(sys.stdout) else None,
            border_style="dim",
            header_style="dim",
            show_edge=False,
            pad_edge=False,
            show_header=any(self.headings),
            caption=f"a wider terminal also shows: {', '.join(left_out)}" if left_out else None,
            caption_justify="left",
        )
        for number in columns_shown:
            justify: Any = "right" if number in self.right else "left"
            table.add_column(
                _styled([self.headings[number]]), overflow="fold", justify=justify, no_wrap=number in whole
            )
        for row in self.rows:
            table.add_row(*(_styled([row[number]]) for number in columns_shown))
        return table


def _pieces(cells: Iterable[Cell]) -> Iterator[tuple[str, str]]:
    from eurdf.diagnostics.wording import visible

    for cell in cells:
        text, style = (cell, "") if isinstance(cell, str) else cell
        yield visible(text), style


def _plain(cells: Iterable[Cell]) -> str:
    return "".join(text for text, _ in _pieces(cells))


def _styled(cells: Iterable[Cell]) -> Text:
    from rich.text import Text

    return Text.assemble(*_pieces(cells))


def _console(stream: TextIO) -> Console:
    # Render into a capture: on a broken pipe, rich would exit with code 1.
    from rich.console import Console

    terminal = is_terminal(stream)
    return Console(
        force_terminal=terminal,
        file=stream,
        no_color=STYLE.get().no_color or None,
        width=columns() if terminal else _UNBOUNDED,
        highlight=False,
        markup=False,
        emoji=False,
        safe_box=not has_boxes(stream),
    )
