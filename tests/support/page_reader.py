"""Who does what a page of the specification shows, and compares what it prints with what is shown."""

from __future__ import annotations

import contextlib
import io
import os
import re
import shlex
import subprocess
from collections.abc import Iterator
from dataclasses import dataclass, field
from pathlib import Path

from eurdf.commands.main import main
from spec.site.blocks import Block, Code, Directive, Prose, read_blocks

# What is zero but for rounding is another number on each machine.
_NOISE = re.compile(r"\b\d(?:\.\d+)?e-1[0-9]\b|\b0\.0e\+00\b")


_NAMED_FILE = re.compile(r"`(?P<name>[\w./-]+)`:$")


def _named_file(block: Block) -> str | None:
    found = _NAMED_FILE.search(block.text) if isinstance(block, Prose) else None
    return found["name"] if found else None


@dataclass
class PageReader:
    """Somebody who does what a page of the specification shows, in a folder of their own.

    Attributes:
        page: The page.
        folder: The folder.
        written: Files that the last command wrote, and that the text is to show next.
        names: What the Python of the page has defined.
        told: What was shown and given, block by block: its line, what is shown, what is given.
    """

    page: Path
    folder: Path
    written: list[Path] = field(default_factory=list)
    names: dict[str, object] = field(default_factory=dict)
    told: list[tuple[int, str, str]] = field(default_factory=list)

    def follow(self) -> None:
        """Do all that is shown, in order."""
        before = Path.cwd()
        os.chdir(self.folder)
        try:
            self._follow(read_blocks(self.page.read_text(encoding="utf-8")))
        finally:
            os.chdir(before)

    def _follow(self, blocks: Iterator[Block]) -> None:
        printed: str | None = None
        named: str | None = None
        for block in blocks:
            file, named = named, _named_file(block)
            if file is not None and isinstance(block, Code):
                self._file(block, self.folder / file)
            elif printed is not None:
                assert isinstance(block, Code), f"line {block.line}: what the code before it prints is not shown"
                assert block.language == "text", f"line {block.line}: what the code before it prints is not shown"
                self._compare(block, block.text, printed)
                printed = None
            elif isinstance(block, Directive) and block.name == "example":
                self._write(block)
            elif isinstance(block, Code) and block.language == "console":
                self._run(block)
            elif isinstance(block, Code) and block.language == "sh":
                for command in block.text.splitlines():
                    self._succeed(command)
            elif isinstance(block, Code) and block.language == "python":
                printed = self._execute(block) or None
        assert printed is None, "what the last code prints is not shown"

    def _write(self, block: Directive) -> None:
        path = self.folder / block.options.get("file", "robot.yaml")
        if path in self.written:
            self._compare(block, block.body, path.read_text(encoding="utf-8"))
        self.written.clear()
        path.write_text(block.body + "\n", encoding="utf-8")

    def _file(self, block: Code, path: Path) -> None:
        """What a paragraph that ends in "`NAME`:" introduces: a file that was written, or that is to be."""
        if path.exists():
            self._compare(block, block.text, path.read_text(encoding="utf-8"))
        else:
            path.write_text(block.text + "\n", encoding="utf-8")

    def _run(self, block: Code) -> None:
        command, _, shown = block.text.partition("\n")
        prompt, program, *arguments = shlex.split(command)
        assert (prompt, program) in {("$", "eurdf"), ("$", "cc")}
        before = {path: path.stat().st_mtime_ns for path in self.folder.iterdir()}
        if program == "cc":
            given = subprocess.run(command[1:], shell=True, check=True, capture_output=True, text=True).stdout
        else:
            _, given = self._answer(arguments)
        self.written = [path for path in self.folder.iterdir() if before.get(path) != path.stat().st_mtime_ns]
        self._compare(block, shown, given.replace(f"{self.folder}/", ""))

    def _succeed(self, command: str) -> None:
        program, *arguments = shlex.split(command, comments=True)
        assert program == "eurdf"
        code, output = self._answer(arguments)
        assert code == 0, f"{command}: {output}"

    def _answer(self, arguments: list[str]) -> tuple[int, str]:
        """The exit code and what is written."""
        output = io.StringIO()
        with contextlib.redirect_stdout(output), contextlib.redirect_stderr(output):
            return main(arguments), output.getvalue()

    def _execute(self, block: Code) -> str:
        output = io.StringIO()
        code = compile("\n" * block.line + block.text, str(self.page), "exec")
        with contextlib.redirect_stdout(output):
            exec(code, self.names)
        return output.getvalue()

    def _compare(self, block: Block, shown: str, given: str) -> None:
        self.told.append((block.line, _NOISE.sub("0", shown.strip()), _NOISE.sub("0", given.strip())))
