"""Files are written whole or not at all: by threads, by processes that are killed, and on a full disk."""

import os
import random
import shutil
import subprocess
import sys
import tempfile
import time
from collections.abc import Callable
from concurrent.futures import ThreadPoolExecutor
from pathlib import Path

import pytest

import eurdf
from eurdf.commands.main import main
from eurdf.commands.output_file import write_new
from eurdf.errors import CannotRun
from eurdf.writing.atomic_file import write_atomically, write_together
from eurdf.writing.output_folder import write_files
from support.places import ROBOTS

NAMES = ("robot.urdf", "robot.yaml", "README.md", "meshes/a.stl", "meshes/b.stl")
KEPT = ("mine.txt", "meshes/mine.stl", "notes/mine.md")

WRITES_FOREVER = """
import itertools, sys
from eurdf.writing.output_folder import write_files
folder, number, *names = sys.argv[1:]
print("started", flush=True)
for count in itertools.count(int(number)):
    write_files(folder, {name: 2000 * f"{count}\\n".encode() for name in names}, force=True)
"""

FULL_DISK = """
import contextlib, io, os, resource, sys
sys.dont_write_bytecode = True  # Python would write half of it
from eurdf.commands.main import main
resource.setrlimit(resource.RLIMIT_FSIZE, (2048, 2048))
for line in sys.stdin:
    said = io.StringIO()
    with contextlib.redirect_stderr(said), contextlib.redirect_stdout(io.StringIO()):
        code = main(line.split())
    print(code, said.getvalue().strip().splitlines()[-1])
"""


@pytest.fixture
def here(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    monkeypatch.setenv("PYTHONPATH", str(Path(eurdf.__file__).parents[1]), prepend=os.pathsep)
    monkeypatch.chdir(tmp_path)
    return tmp_path


def files_in(folder: Path) -> set[str]:
    return {str(path.relative_to(folder)) for path in folder.rglob("*") if not path.is_dir()}


def kills(folder: Path, count: int, seed: int) -> int:
    """Kill a process that writes the files again and again, and look at them; how often they had changed."""
    chance, seen = random.Random(seed), {0}
    for name in KEPT:
        (folder / name).parent.mkdir(parents=True, exist_ok=True)
        (folder / name).write_text("mine")
    write_files(folder, dict.fromkeys(NAMES, 2000 * b"0\n"))
    for _ in range(count):
        command = [sys.executable, "-c", WRITES_FOREVER, str(folder), str(max(seen) + 1), *NAMES]
        with subprocess.Popen(command, stdout=subprocess.PIPE) as process:
            assert process.stdout is not None
            process.stdout.readline()
            time.sleep(chance.uniform(0.0, 0.2))
            process.kill()
        number = int((folder / NAMES[0]).read_text().split("\n")[0])
        assert {(folder / name).read_text() for name in NAMES} == {2000 * f"{number}\n"}
        assert {(folder / name).read_text() for name in KEPT} == {"mine"}
        seen.add(number)
    return len(seen) - 1


@pytest.mark.parametrize("count", [8, pytest.param(100, marks=pytest.mark.slow)])
def test_killed_process_leaves_all_old_files_or_all_new_ones(here: Path, count: int) -> None:
    assert kills(here / "out", count, seed=count)
    write_files(here / "out", dict.fromkeys(NAMES, b"end"), force=True)
    assert files_in(here) == {f"out/{name}" for name in (*NAMES, *KEPT)}


def test_threads_and_processes_write_the_same_files(here: Path) -> None:
    def write(thread: int) -> None:
        for number in range(20):
            write_atomically("one.yaml", 2000 * f"{thread} {number}\n")
            write_files("set", {name: 2000 * f"{thread} {number}\n".encode() for name in NAMES}, force=True)

    with ThreadPoolExecutor(4) as pool:
        list(pool.map(write, range(4)))
    assert len(set(Path("one.yaml").read_text().splitlines())) == 1
    assert len({Path("set", name).read_text() for name in NAMES}) == 1
    assert files_in(here) == {"one.yaml", *(f"set/{name}" for name in NAMES)}


def test_files_that_another_program_writes_meanwhile_survive(here: Path) -> None:
    write_files("out", dict.fromkeys(NAMES, b"0"))

    def write_log() -> set[str]:
        written = set()
        for number in range(400):
            name = f"out/{number % 40}.log"
            Path("log.tmp").write_text(str(number))
            os.replace("log.tmp", name)
            written.add(name)
        return written

    with ThreadPoolExecutor(1) as pool:
        logging = pool.submit(write_log)
        while not logging.done():
            write_files("out", dict.fromkeys(NAMES, b"1"), force=True)
    assert files_in(here) == {f"out/{name}" for name in NAMES} | logging.result()
    assert all(int(Path(name).read_text()) % 40 == int(Path(name).stem) for name in logging.result())


def test_next_write_removes_what_a_killed_process_left(here: Path) -> None:
    for name in ("a.yaml", "out/a.yaml"):
        write_files(".", {name: b"1"})
        left = Path(tempfile.mkdtemp(".tmp", ".eurdf-", Path(name).parent))
        (left / "0").write_text("half")
    Path(".eurdf-notes").mkdir()
    write_atomically("a.yaml", "2")
    write_atomically("out/a.yaml", "2")
    assert sorted(os.listdir()) == [".eurdf-notes", "a.yaml", "out"]
    assert os.listdir("out") == ["a.yaml"]


def test_permissions_links_and_times_of_other_files_are_kept(here: Path) -> None:
    write_files("out", {"a": b"1", "sub/b": b"1"})
    Path("out/mine").write_text("mine")
    Path("out/link").symlink_to("mine")
    Path("out/folder").symlink_to(here)
    Path("out").chmod(0o750)
    Path("out/a").chmod(0o640)
    before = os.lstat("out/mine")
    write_files("out", {"a": b"2", "sub/b": b"2", "new": b"2"}, force=True)
    assert os.path.samestat(before, os.lstat("out/mine"))
    assert os.lstat("out/mine").st_nlink == 1
    assert os.readlink("out/link") == "mine"
    assert Path("out/folder").is_symlink()
    assert [os.stat(f"out/{name}").st_mode & 0o777 for name in (".", "a")] == [0o750, 0o640]
    Path("plain").touch()
    assert os.stat("out/new").st_mode == os.stat("plain").st_mode


def test_working_folder_stays_the_same_folder(here: Path) -> None:
    before = os.stat(".")
    write_files(".", {"a": b"1", "sub/b": b"1"})
    write_files(".", {"a": b"2", "sub/b": b"2"}, force=True)
    assert os.path.samestat(before, os.stat(here))
    assert files_in(here) == {"a", "sub/b"}


@pytest.mark.parametrize("write", [write_together, lambda files: write_files(".", files, force=True)])
def test_one_file_that_cannot_be_written_changes_none(here: Path, write: Callable[..., object]) -> None:
    Path("a").write_text("before")
    Path("z").mkdir()
    with pytest.raises(IsADirectoryError, match="'z'"):
        write({"a": b"after", "b": b"after", "z": b"after"})
    assert Path("a").read_text() == "before"
    assert sorted(os.listdir()) == ["a", "z"]


def test_dangling_link_is_not_written_through_without_force(here: Path) -> None:
    Path("link").symlink_to("target")
    with pytest.raises(CannotRun, match="'link' already exists"):
        write_new("link", "text")
    with pytest.raises(FileExistsError):
        write_atomically("link", "text", replace=False)
    assert not Path("target").exists()
    write_new("link", "text", force=True)
    assert Path("target").read_text() == "text"


def test_devices_and_pipes_are_not_replaced(here: Path) -> None:
    os.mkfifo("pipe")
    for path in ("pipe", os.devnull):
        with pytest.raises(CannotRun, match=f"cannot write '{path}': it is a device or a pipe"):
            write_new(path, "text", force=True)
        with pytest.raises(OSError, match="a device or a pipe"):
            write_files(Path(path).parent, {Path(path).name: b"text"}, force=True)


def test_full_disk_leaves_no_file_and_names_it(here: Path) -> None:
    shutil.copytree(ROBOTS / "digit_leg", "leg")
    text = Path("leg/robot.yaml").read_text()
    Path("open.yaml").write_text(
        text[: text.index("configurations:")].replace("robot.urdf", "leg/robot.urdf") + 3000 * "#"
    )
    eurdf.export("leg", "sdf").write("sdf")
    before = files_in(here)
    commands = {
        "generate leg/robot.urdf -o new.yaml": "extended-urdf-2.0.schema.json",
        "migrate leg/robot.v1.yaml -o new.yaml": "extended-urdf-2.0.schema.json",
        "assemble open.yaml --write": "open.yaml",
        "schema -o new.json": "new.json",
        "view leg -o new.html": "new.html",
        "picture leg -o new.svg --graph": "new.svg",
        "export leg --to mjcf -o new": "new/robot.xml",
        "export leg --to mjcf -o sdf --force": "sdf/robot.xml",
        "import sdf/robot.sdf -o new": "new/robot.urdf",
        "transmission unitree_g1_ankle --joints free_pitch free_roll --c new": "new/",
        "transmission unitree_g1_ankle --joints free_pitch free_roll --ros2 new": "new/",
    }
    said = subprocess.run(
        [sys.executable, "-c", FULL_DISK], input="\n".join(commands), capture_output=True, text=True, check=True
    ).stdout.splitlines()
    assert len(said) == len(commands)
    for line, file in zip(said, commands.values(), strict=True):
        assert line.startswith("2 eurdf: cannot write '")
        assert file in line
        assert line.endswith("': File too large")
    assert files_in(here) == before
    assert not Path("new").exists()


@pytest.mark.parametrize(
    ("command", "file"),
    [
        ("generate leg/robot.urdf -o new.yaml", "new.yaml"),
        ("generate leg/robot.urdf -o new.yaml", "extended-urdf-2.0.schema.json"),
        ("migrate leg/robot.v1.yaml -o new.yaml", "new.yaml"),
        ("migrate leg/robot.v1.yaml -o new.yaml", "extended-urdf-2.0.schema.json"),
        ("schema --for leg/robot.urdf -o new.json", "new.json"),
        ("export leg --to sdf -o new", "new/robot.sdf"),
        ("import there/robot.sdf -o new", "new/robot.yaml"),
        ("transmission unitree_g1_ankle --joints free_pitch free_roll --ros2 new", "new/package.xml"),
        ("view leg -o new.html", "new.html"),
        ("picture leg -o new.svg --graph", "new.svg"),
    ],
)
def test_existing_file_is_replaced_only_with_force(
    here: Path, command: str, file: str, capsys: pytest.CaptureFixture[str]
) -> None:
    shutil.copytree(ROBOTS / "four_bar", "leg")
    eurdf.export("leg", "sdf").write("there")
    (here / file).parent.mkdir(exist_ok=True)
    (here / file).write_text("mine")
    before = files_in(here)
    assert main(command.split()) == 2
    said = capsys.readouterr().err
    assert f"'{file}' already exists" in said
    assert "--force" in said
    assert files_in(here) == before
    assert (here / file).read_text() == "mine"
    assert main([*command.split(), "--force"]) == 0
    assert (here / file).read_text() != "mine"
