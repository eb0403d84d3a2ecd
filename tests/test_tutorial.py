"""The tutorial of the specification: done from its first block to its last, it gives what it shows."""

from __future__ import annotations

import contextlib
import io
import re
import shlex
from collections.abc import Iterator
from dataclasses import dataclass, field
from pathlib import Path

import pytest

from eurdf.commands.main import main
from spec.figures import draw
from spec.site.blocks import Block, Code, Directive, read_blocks

SPEC = Path(__file__).parents[1] / "spec"
TUTORIAL = SPEC / "tutorial.md"
ROBOT = SPEC / "examples" / "tutorial"

# What is zero but for rounding is another number on each machine.
_NOISE = re.compile(r"\b\d(?:\.\d+)?e-1[0-9]\b|\b0\.0e\+00\b")


@dataclass
class Reader:
    """Somebody who does what the tutorial shows, in a folder of their own.

    Attributes:
        folder: The folder.
        written: Files that the last command wrote, and that the text is to show next.
        names: What the Python of the tutorial has defined.
        told: What was shown and given, block by block: its line, what is shown, what is given.
    """

    folder: Path
    written: list[Path] = field(default_factory=list)
    names: dict[str, object] = field(default_factory=dict)
    told: list[tuple[int, str, str]] = field(default_factory=list)

    def follow(self, blocks: Iterator[Block]) -> None:
        """Do all that is shown, in order."""
        printed: str | None = None
        for block in blocks:
            if printed is not None:
                assert isinstance(block, Code), f"line {block.line}: what the code before it prints is not shown"
                assert block.language == "text", f"line {block.line}: what the code before it prints is not shown"
                self._compare(block, block.text, printed)
                printed = None
            elif isinstance(block, Directive) and block.name == "example":
                self._write(block)
            elif isinstance(block, Code) and block.language == "console":
                self._run(block)
            elif isinstance(block, Code) and block.language == "python":
                printed = self._execute(block) or None
        assert printed is None, "what the last code prints is not shown"

    def _write(self, block: Directive) -> None:
        path = self.folder / block.options.get("file", "robot.yaml")
        if path in self.written:
            self._compare(block, block.body, path.read_text(encoding="utf-8"))
        self.written.clear()
        path.write_text(block.body + "\n", encoding="utf-8")

    def _run(self, block: Code) -> None:
        command, _, shown = block.text.partition("\n")
        prompt, program, *arguments = shlex.split(command)
        assert (prompt, program) == ("$", "eurdf")
        before = {path: path.stat().st_mtime_ns for path in self.folder.iterdir()}
        output = io.StringIO()
        with contextlib.redirect_stdout(output), contextlib.redirect_stderr(output):
            main(arguments)
        self.written = [path for path in self.folder.iterdir() if before.get(path) != path.stat().st_mtime_ns]
        self._compare(block, shown, output.getvalue())

    def _execute(self, block: Code) -> str:
        output = io.StringIO()
        code = compile("\n" * block.line + block.text, str(TUTORIAL), "exec")
        with contextlib.redirect_stdout(output):
            exec(code, self.names)
        return output.getvalue()

    def _compare(self, block: Block, shown: str, given: str) -> None:
        self.told.append((block.line, _NOISE.sub("0", shown.strip()), _NOISE.sub("0", given.strip())))


@pytest.fixture(scope="module")
def reader(tmp_path_factory: pytest.TempPathFactory) -> Reader:
    """Who has done the tutorial."""
    reader = Reader(tmp_path_factory.mktemp("tutorial"))
    with contextlib.chdir(reader.folder):
        reader.follow(read_blocks(TUTORIAL.read_text(encoding="utf-8")))
    return reader


def test_each_command_and_each_piece_of_code_gives_what_the_tutorial_shows(reader: Reader) -> None:
    assert len(reader.told) > 10
    for line, shown, given in reader.told:
        assert given == shown, f"spec/tutorial.md:{line}"


def test_the_robot_that_the_tutorial_ends_with_is_the_one_among_the_examples(reader: Reader) -> None:
    for name in ("robot.urdf", "robot.yaml"):
        assert (reader.folder / name).read_text(encoding="utf-8") == (ROBOT / name).read_text(encoding="utf-8"), name


@pytest.mark.parametrize("name", sorted(draw.FIGURE))
def test_each_figure_is_the_one_that_the_program_draws(name: str) -> None:
    assert (SPEC / "figures" / f"{name}.svg").read_text(encoding="utf-8") == draw.FIGURE[name]().text()


def test_each_figure_takes_its_colours_from_the_page_or_is_seen_on_black_and_on_white() -> None:
    for path in sorted((SPEC / "figures").glob("*.svg")):
        for colour in set(re.findall(r'(?:fill|stroke)="([^"]+)"', path.read_text(encoding="utf-8"))):
            if colour not in ("none", draw.INK):
                assert _contrast(colour, 1.0) >= 3.0, f"{path.name}: {colour} on white"
                assert _contrast(colour, 0.0) >= 3.0, f"{path.name}: {colour} on black"


def _contrast(colour: str, ground: float) -> float:
    """Contrast ratio of a colour with a ground of a relative luminance, as WCAG 2 defines it."""
    parts = [int(colour[start : start + 2], 16) / 255 for start in (1, 3, 5)]
    linear = [part / 12.92 if part <= 0.04045 else ((part + 0.055) / 1.055) ** 2.4 for part in parts]
    luminance = sum(weight * part for weight, part in zip((0.2126, 0.7152, 0.0722), linear, strict=True))
    brighter, darker = max(luminance, ground), min(luminance, ground)
    return (brighter + 0.05) / (darker + 0.05)
