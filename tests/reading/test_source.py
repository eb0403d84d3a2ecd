"""Reading a file as text: what is refused, and where a character stands."""

from __future__ import annotations

import os
import re
from pathlib import Path

import pytest
from hypothesis import given
from hypothesis import strategies as st

from eurdf.diagnostics import Fault
from eurdf.reading.source import FILE_LIMIT, Source, read_source
from support.watchdog import watchdog


def fault_of(path: str | os.PathLike[str], **options: int) -> Fault:
    with watchdog(), pytest.raises(Fault) as caught:
        read_source(path, **options)
    return caught.value


def write(folder: Path, data: bytes) -> Path:
    path = folder / "robot.yaml"
    path.write_bytes(data)
    return path


def test_the_text_is_what_the_file_holds_line_breaks_included(tmp_path: Path) -> None:
    data = "é: 1\r\nb: 日本\rc: 🤖\n".encode()
    source = read_source(write(tmp_path, data))
    assert source == Source(str(tmp_path / "robot.yaml"), data.decode(), data)


def test_a_byte_order_mark_is_no_part_of_the_text(tmp_path: Path) -> None:
    source = read_source(write(tmp_path, b"\xef\xbb\xbfa: 1"))
    assert (source.text, source.data) == ("a: 1", b"a: 1")


def test_the_file_is_named_as_the_user_gave_it(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    write(tmp_path, b"a: 1")
    monkeypatch.chdir(tmp_path)
    assert read_source("./robot.yaml").file == "./robot.yaml"


def test_a_file_as_large_as_the_limit_is_read_and_one_byte_more_is_refused(tmp_path: Path) -> None:
    path = write(tmp_path, b"x" * 100_000)
    assert len(read_source(path, limit=100_000).data) == 100_000
    assert fault_of(path, limit=99_999).diagnostic.code == "file-too-large"


def test_a_file_of_100_megabytes_is_refused_without_being_read(tmp_path: Path) -> None:
    path = tmp_path / "robot.urdf"
    with path.open("wb") as file:
        file.truncate(100_000_000)
    diagnostic = fault_of(path).diagnostic
    assert diagnostic.code == "file-too-large"
    assert f"{FILE_LIMIT:,} bytes" in diagnostic.message


@pytest.mark.skipif(not os.path.exists("/proc/self/status"), reason="there is no /proc here")
def test_a_file_whose_size_is_not_known_beforehand_is_read_up_to_the_limit() -> None:
    assert read_source("/proc/self/status").text.startswith("Name:")
    assert fault_of("/proc/self/status", limit=10).diagnostic.code == "file-too-large"


def test_a_missing_file_is_a_fault_that_says_so(tmp_path: Path) -> None:
    diagnostic = fault_of(tmp_path / "robot.yaml").diagnostic
    assert diagnostic.code == "file-unreadable"
    assert diagnostic.message == f"'{tmp_path / 'robot.yaml'}' cannot be read: no such file or directory"


def test_a_folder_is_a_fault_that_says_so(tmp_path: Path) -> None:
    diagnostic = fault_of(tmp_path).diagnostic
    assert (diagnostic.code, diagnostic.message) == ("file-unreadable", f"'{tmp_path}' is a folder, not a file")


def test_a_pipe_that_nobody_writes_into_does_not_block(tmp_path: Path) -> None:
    os.mkfifo(tmp_path / "robot.yaml")
    assert fault_of(tmp_path / "robot.yaml").diagnostic.code == "file-unreadable"


def test_an_endless_device_is_refused() -> None:
    assert fault_of("/dev/zero").diagnostic.code == "file-unreadable"


def test_a_path_with_a_nul_in_it_is_a_fault() -> None:
    assert fault_of("robot\0.yaml").diagnostic.code == "file-unreadable"


def test_refusing_files_leaves_no_file_open(tmp_path: Path) -> None:
    before = len(os.listdir("/dev/fd"))
    for path in (tmp_path, "/dev/zero", tmp_path / "missing"):
        fault_of(path)
    fault_of(write(tmp_path, b"xx"), limit=1)
    assert len(os.listdir("/dev/fd")) == before


@pytest.mark.parametrize("encoding", ["utf-16", "utf-16-le", "utf-16-be", "utf-32", "utf-32-le", "utf-32-be"])
def test_utf_16_and_utf_32_are_refused_with_what_to_do(tmp_path: Path, encoding: str) -> None:
    diagnostic = fault_of(write(tmp_path, "a: 1\n".encode(encoding))).diagnostic
    assert diagnostic.code == "file-not-utf8"
    assert "UTF-16" in diagnostic.message
    assert "UTF-8" in str(diagnostic.hint)


@pytest.mark.parametrize(
    ("data", "position"),
    [
        (b"caf\xe9: 1", (1, 4)),
        ("é: 1\r\nü: x".encode() + b"\x80", (2, 5)),
        (b"a: 1\n\xed\xa0\x80", (2, 1)),  # a surrogate
        (b"a: 1\nb: \xc3", (2, 4)),
        (b"\x89PNG\r\n\x1a\n\0\0", (1, 1)),
    ],
)
def test_what_is_not_utf_8_is_refused_at_its_first_wrong_byte(
    tmp_path: Path, data: bytes, position: tuple[int, int]
) -> None:
    diagnostic = fault_of(write(tmp_path, data)).diagnostic
    assert (diagnostic.code, diagnostic.line, diagnostic.column) == ("file-not-utf8", *position)


@given(st.text(alphabet="ab\n\ré\x85\x0b\x0c\x1c\u2028🤖"))
def test_lines_are_those_of_an_editor_and_columns_count_characters(text: str) -> None:
    source = Source("robot.yaml", text, text.encode())
    for index in range(len(text) + 1):
        if text[index - 1 : index + 1] != "\r\n":
            lines = re.split(r"\r\n|\r|\n", text[:index])
            assert source.position(index) == (len(lines), len(lines[-1]) + 1)


def test_a_place_that_ends_on_another_line_has_no_end_column() -> None:
    source = Source("robot.yaml", "ab\ncd", b"ab\ncd")
    place = source.place(1, 2, "/a")
    assert (place.line, place.column, place.end_column, place.pointer) == (1, 2, 3, "/a")
    assert source.place(1, 4).end_column is None
