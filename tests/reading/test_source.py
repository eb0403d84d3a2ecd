"""Reading a file as text: what is refused, and the place of a character."""

from __future__ import annotations

import os
import re
from pathlib import Path

import pytest
from hypothesis import given
from hypothesis import strategies as st

from eurdf.diagnostics import FileError
from eurdf.reading.source import Source, read_source
from support.processes import watchdog


def error_of(path: str | os.PathLike[str], **options: int) -> FileError:
    with watchdog(), pytest.raises(FileError) as caught:
        read_source(path, **options)
    return caught.value


def write(folder: Path, data: bytes) -> Path:
    path = folder / "robot.yaml"
    path.write_bytes(data)
    return path


def test_file_is_named_as_given(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    write(tmp_path, b"a: 1")
    monkeypatch.chdir(tmp_path)
    assert read_source("./robot.yaml").file == "./robot.yaml"


def test_file_size_limit_is_exact(tmp_path: Path) -> None:
    path = write(tmp_path, b"x" * 100_000)
    assert len(read_source(path, limit=100_000).data) == 100_000
    assert error_of(path, limit=99_999).diagnostic.code == "file-too-large"


def test_only_a_regular_file_is_read(tmp_path: Path) -> None:
    os.mkfifo(tmp_path / "pipe")
    for path, reason in (
        (tmp_path / "no.yaml", f"'{tmp_path / 'no.yaml'}' cannot be read: no such file or directory"),
        (tmp_path, f"'{tmp_path}' is a folder, not a file"),
        *((f"/proc/self/{name}", "not a regular file") for name in ("environ", "status") if os.path.exists("/proc")),
        *((path, "is a pipe or a device, not a file") for path in (tmp_path / "pipe", "/dev/zero")),
    ):
        found = error_of(path).diagnostic
        assert found.code == "file-unreadable"
        assert reason in found.message


def test_refused_files_are_closed(tmp_path: Path) -> None:
    before = len(os.listdir("/dev/fd"))
    for path in (tmp_path, "/dev/zero", tmp_path / "missing"):
        error_of(path)
    error_of(write(tmp_path, b"xx"), limit=1)
    assert len(os.listdir("/dev/fd")) == before


@pytest.mark.parametrize("encoding", ["utf-16", "utf-16-le", "utf-16-be", "utf-32", "utf-32-le", "utf-32-be"])
def test_utf_16_and_utf_32_are_refused_with_hint(tmp_path: Path, encoding: str) -> None:
    diagnostic = error_of(write(tmp_path, "a: 1\n".encode(encoding))).diagnostic
    assert diagnostic.code == "file-not-utf8"
    assert "UTF-16" in diagnostic.message
    assert "UTF-8" in str(diagnostic.hint)


@given(st.text(alphabet="ab\n\ré\x85\x0b\x0c\x1c\u2028🤖"))
def test_lines_and_columns_match_editors(text: str) -> None:
    source = Source("robot.yaml", text, text.encode())
    for index in range(len(text) + 1):
        if text[index - 1 : index + 1] != "\r\n":
            lines = re.split(r"\r\n|\r|\n", text[:index])
            assert source.position(index) == (len(lines), len(lines[-1]) + 1)
