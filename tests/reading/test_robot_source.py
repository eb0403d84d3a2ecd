"""What a robot may be given by beside a path: a text, standard input, a pipe; and a path that leads nowhere."""

from __future__ import annotations

import os
import shutil
import subprocess
import sys
from pathlib import Path
from typing import Any

import numpy as np
import pytest
import yaml
from hypothesis import given
from hypothesis import strategies as st

import eurdf
from eurdf.collection.near_paths import near_path
from eurdf.diagnostics import FileError
from eurdf.diagnostics.sarif import sarif_log
from eurdf.diagnostics.text import report_lines
from eurdf.errors import RobotNotFound
from eurdf.mechanism.same_model import differences
from eurdf.reading import robot_source
from eurdf.reading.robot_source import source_of
from eurdf.reading.yaml_reader import read_yaml
from support.described import ARM as URDF
from support.described import ARM_DESCRIPTION as DESCRIPTION
from support.places import ROBOTS

FOUR_BAR = ROBOTS / "four_bar"
MISSPELT = DESCRIPTION.replace("shoulder", "sholder")
SHOWN = "    2 | actuators: [sholder]\n      |             ^^^^^^^\n"


@pytest.fixture(autouse=True)
def folder(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    monkeypatch.chdir(tmp_path)
    monkeypatch.setenv("PYTHONPATH", str(Path(eurdf.__file__).parents[1]), prepend=os.pathsep)
    return tmp_path


def eurdf_with(stdin: str | bytes | int, *argv: str, **options: object) -> subprocess.CompletedProcess[str]:
    """Run a command with a standard input."""
    more = (
        {"stdin": stdin} if isinstance(stdin, int) else {"input": stdin if isinstance(stdin, str) else stdin.decode()}
    )
    command = [sys.executable, "-m", "eurdf", *argv]
    return subprocess.run(command, capture_output=True, text=True, timeout=60, check=False, **more, **options)


def in_bash(line: str) -> subprocess.CompletedProcess[str]:
    """Run a line of bash in which ``eurdf`` is the command."""
    if shutil.which("bash") is None:
        pytest.skip("process substitution needs bash")
    program = f'eurdf() {{ "{sys.executable}" -m eurdf "$@"; }}; {line}'
    return subprocess.run(["bash", "-c", program], capture_output=True, text=True, timeout=60, check=False)


# --- a text ----------------------------------------------------------------------------------------------------------


@pytest.mark.parametrize("text", [URDF, URDF.encode(), "\ufeff" + URDF, "\n " + URDF, b"\xef\xbb\xbf" + URDF.encode()])
def test_urdf_is_accepted_as_text(text: str | bytes) -> None:
    assert eurdf.load(text).model.names[1] == "shoulder"
    assert eurdf.check(text).ok


def test_two_texts_give_the_robot_of_their_files() -> None:
    texts = [(FOUR_BAR / name).read_text(encoding="utf-8") for name in ("robot.yaml", "robot.urdf")]
    robot, same = eurdf.load(*texts), eurdf.load(FOUR_BAR)
    assert robot.model == same.model
    assert robot.mechanism == same.mechanism


def test_description_text_finds_urdf_in_working_directory(folder: Path) -> None:
    (folder / "robot.urdf").write_text(URDF, encoding="utf-8")
    assert eurdf.load(DESCRIPTION).actuation.joints == ("shoulder",)


def test_diagnostic_in_text_shows_line_and_source() -> None:
    report = eurdf.check(MISSPELT, URDF.replace('value="2"', 'value="two"'))
    places = [(found.file, found.line) for found in report.diagnostics]
    assert places == [("<urdf>", 4)]
    report = eurdf.check(MISSPELT, URDF)
    assert [(found.file, found.line, found.column) for found in report.diagnostics] == [("<description>", 2, 13)]
    lines = "".join("".join(piece for piece, _ in line).rstrip() + "\n" for line in report_lines(report))
    assert SHOWN in lines
    location = sarif_log([report], "1")["runs"][0]["results"][0]["locations"][0]["physicalLocation"]
    assert location["region"]["startLine"] == 2


def test_line_ends_of_text_match_files() -> None:
    text = MISSPELT.replace("\n", "\r", 1)
    report = eurdf.check(text + "\n# end", URDF)
    assert [found.line for found in report.diagnostics] == [2]
    assert any("actuators" in piece for line in report_lines(report) for piece, _ in line)


def test_existing_file_precedes_text(folder: Path) -> None:
    for name in ("<arm>", "two\nlines"):
        (folder / name).write_text(DESCRIPTION, encoding="utf-8")
        (folder / "robot.urdf").write_text(URDF, encoding="utf-8")
        assert eurdf.load(name).actuation.joints == ("shoulder",)


@pytest.mark.parametrize(
    "text", ["name_mot: [shoulder]", '"name_mot": [shoulder]', "{name_mot: [shoulder]}", "--- {name_mot: [shoulder]}"]
)
def test_description_text_may_have_one_line(text: str) -> None:
    assert eurdf.load(text, URDF).actuation.joints == ("shoulder",)


@pytest.mark.parametrize("path", ["C:/arm.yaml", "http://arm", "arm:yaml"])
def test_path_with_colon_is_no_text(path: str) -> None:
    with pytest.raises(RobotNotFound):
        eurdf.load(path)


def test_mapping_is_read_as_its_file() -> None:
    content = yaml.safe_load((FOUR_BAR / "robot.yaml").read_text(encoding="utf-8"))
    robot = eurdf.load(content, FOUR_BAR / "robot.urdf")
    assert differences(robot.mechanism, eurdf.load(FOUR_BAR).mechanism) == []
    assert eurdf.residual(content | {"urdf": str(FOUR_BAR / "robot.urdf")}, np.zeros(robot.model.nq)).shape == (3,)


_PLAIN = st.none() | st.booleans() | st.integers(-99, 99) | st.floats(-1e9, 1e9) | st.text()


@given(st.dictionaries(st.text(max_size=3), st.recursive(_PLAIN, st.lists, max_leaves=5), max_size=3))
def test_values_of_mapping_are_read_as_they_are(values: dict[str, Any]) -> None:
    source = source_of({"x-a": values})
    assert source is not None
    assert repr(read_yaml(source).data["x-a"]) == repr(values)


def test_mapping_may_have_values_of_numpy() -> None:
    robot = eurdf.load({"name_mot": ("shoulder",), "own": np.array([1e-5, 2.0]), "n": np.float64(1e-5)}, URDF)
    assert robot.mechanism.own_data == {"/own": [1e-5, 2.0], "/n": 1e-5}


@pytest.mark.parametrize(
    ("content", "reason"),
    [
        ({1: 2}, "has the key 1"),
        ({"x-a": {2.0: 1}}, r"\['x-a'\] has the key"),
        ({"x-a": [object()]}, r"\['x-a'\]\[0\] is <"),
    ],
)
def test_what_no_description_contains_is_refused(content: Any, reason: str) -> None:
    with pytest.raises(ValueError, match=reason):
        eurdf.load(content, URDF)


def test_infinite_number_of_mapping_is_reported() -> None:
    assert [found.code for found in eurdf.check({"x-a": float("-inf")}, URDF).diagnostics] == ["yaml-not-finite"]


def test_mapping_that_contains_itself_is_refused() -> None:
    content: dict[str, Any] = {}
    content["x-a"] = content
    with pytest.raises(ValueError, match="contains itself"):
        eurdf.load(content, URDF)


def test_mapping_is_no_urdf() -> None:
    with pytest.raises(ValueError, match="urdf is a mapping"):
        eurdf.load(DESCRIPTION, {"a": 1})  # type: ignore[arg-type]


def test_invalid_unicode_text_is_reported() -> None:
    assert [found.code for found in eurdf.check("<robot \ud800/>").diagnostics] == ["file-not-utf8"]
    assert [found.code for found in eurdf.check(b"<robot \xff/>").diagnostics] == ["file-not-utf8"]
    assert [found.code for found in eurdf.check(b"").diagnostics] == ["file-unreadable"]


def test_too_long_text_is_refused() -> None:
    with pytest.raises(FileError, match="more than 10 bytes"):
        source_of(URDF, limit=10)


def test_urdf_beside_folder_without_description_is_used(folder: Path) -> None:
    (folder / "robot.urdf").write_text(URDF, encoding="utf-8")
    with pytest.raises(eurdf.errors.RobotNotFound, match="no YAML file to use with"):
        eurdf.check(folder, "other.urdf")


# --- standard input --------------------------------------------------------------------------------------------------


def test_piped_description_shows_wrong_line(folder: Path) -> None:
    (folder / "robot.urdf").write_text(URDF, encoding="utf-8")
    done = eurdf_with(MISSPELT, "check", "-")
    assert done.returncode == 1
    assert done.stdout.startswith("<stdin>:2:13: error: ")
    assert SHOWN in done.stdout
    assert done.stdout.endswith("<stdin>: 1 error\n")


def test_urdf_of_description_is_read_from_stdin(folder: Path) -> None:
    (folder / "arm.yaml").write_text(DESCRIPTION, encoding="utf-8")
    assert eurdf_with(URDF, "check", "arm.yaml", "--urdf", "-").stdout == "arm.yaml: valid\n"
    done = eurdf_with(URDF.replace('"2"', '"two"'), "check", "arm.yaml", "--urdf", "-")
    assert done.stdout.startswith("<stdin>:4:28: error: ")
    assert '    4 |     <inertial><mass value="two"/>' in done.stdout


@pytest.mark.parametrize(
    ("stdin", "said"),
    [("", "<stdin> is empty"), (" \n", "<stdin> is empty"), ("<robot", "<stdin>:1:1: error"), ("a: [", "<stdin>:")],
)
def test_bad_standard_input_is_robot_error(stdin: str, said: str) -> None:
    done = eurdf_with(stdin, "check", "-")
    assert done.returncode == 1
    assert said in done.stdout


def test_closed_standard_input_is_error(folder: Path) -> None:
    done = in_bash("eurdf check - <&-")
    assert (done.returncode, done.stderr) == (1, "")
    assert "standard input is closed" in done.stdout


@pytest.mark.parametrize(
    "argv", [("-", "--urdf", "-"), ("arm.yaml", "other.yaml", "--urdf", "-")], ids=["as both", "for two robots"]
)
def test_standard_input_is_read_once(folder: Path, argv: tuple[str, ...]) -> None:
    for name in ("arm.yaml", "other.yaml"):
        (folder / name).write_text(DESCRIPTION, encoding="utf-8")
    done = eurdf_with(URDF, "check", *argv)
    assert (done.returncode, done.stdout, done.stderr.count("\n")) == (2, "", 1)


def test_standard_input_is_read_up_to_limit(folder: Path) -> None:
    done = in_bash("(printf '<robot>'; yes) | eurdf check -")  # yes never ends by itself
    assert done.returncode == 1
    assert "file-too-large" in done.stdout


# --- pipes -----------------------------------------------------------------------------------------------------------


def test_both_files_come_from_process_substitution(folder: Path) -> None:
    (folder / "arm").mkdir()
    (folder / "arm" / "a.urdf").write_text(URDF, encoding="utf-8")
    (folder / "arm" / "a.yaml").write_text(MISSPELT, encoding="utf-8")
    assert in_bash("eurdf check <(cat arm/a.urdf)").returncode == 0
    done = in_bash("eurdf check <(cat arm/a.yaml) --urdf <(sleep 0.3; cat arm/a.urdf)")
    assert (done.returncode, done.stderr) == (1, "")
    assert SHOWN in done.stdout


def test_missing_urdf_of_pipe_is_in_working_directory(folder: Path) -> None:
    (folder / "a.yaml").write_text(DESCRIPTION, encoding="utf-8")
    (folder / "a.urdf").write_text(URDF, encoding="utf-8")
    assert "hint: there is 'a.urdf': write urdf: a.urdf\n" in in_bash("eurdf check <(cat a.yaml)").stdout


def test_slow_pipe_writer_is_awaited(folder: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    os.mkfifo("pipe")
    monkeypatch.setattr(robot_source, "PATIENCE", 0.2)
    assert "nothing writes" in str(eurdf.check("pipe").diagnostics[0])
    writer = subprocess.Popen(["sh", "-c", "exec > pipe; sleep 0.5; cat robot"], text=True)
    (folder / "robot").write_text(URDF, encoding="utf-8")
    monkeypatch.setattr(robot_source, "PATIENCE", 30)
    assert eurdf.check("pipe").ok
    assert writer.wait(timeout=10) == 0


def test_pipe_is_read_up_to_limit(folder: Path) -> None:
    os.mkfifo("pipe")
    writer = subprocess.Popen(["sh", "-c", "yes > pipe"], stderr=subprocess.DEVNULL)
    with pytest.raises(FileError, match="more than 100,000 bytes"):
        source_of("pipe", limit=100_000)
    assert writer.wait(timeout=10) != 0


# --- paths that lead nowhere -----------------------------------------------------------------------------------------


@pytest.mark.parametrize(
    ("path", "near"),
    [
        ("four_bra", "four_bar"),  # of the collection
        ("robots/left_lge", "robots/left_leg"),
        ("robot/left_leg", "robots"),
        ("robots/left_leg/arm.yaml", "robots/left_leg/arm.yml"),
        ("robots/left_leg/arm", "robots/left_leg/arm.yml"),
        ("./ROBOTS", "./robots"),
        ("robots/left_leg/notes.yml", None),
        ("nothing_like_it", None),
        ("a\0b", None),
    ],
)
def test_missing_path_suggests_a_similar_one(folder: Path, path: str, near: str | None) -> None:
    leg = folder / "robots" / "left_leg"
    leg.mkdir(parents=True)
    (leg / "arm.yml").write_text(DESCRIPTION, encoding="utf-8")
    (leg / "notes.txt").touch()
    assert near_path(path, eurdf.collection_names()) == near
    with pytest.raises(eurdf.errors.RobotNotFound) as caught:
        eurdf.check(path)
    said = str(caught.value)
    assert said.endswith(f"did you mean '{near}'?" if near else "`eurdf robots` lists the collection")
    assert "cassie" not in said


#: Robots of Gepetto/example-parallel-robots, by their names and folders, beside those that have the same name here.
PUBLISHED = {
    "battobot": "battobot_6d",
    "cassie_leg": "cassie_like",
    "delta": "robot_delta",
    "digit_2legs": "digit_2legs_6D digit_like_2legs digit_like_2legs_6D digit_like_2legs_old",
    "digit_leg": "digit_like",
    "disney_2legs": "disney_robot",
    "disney_leg": "disney_like",
    "five_bar": "5bar 5bar_linkage",
    "five_bar_3d": "5bar3d 5bar_linkage_iso3d",
    "five_bar_6d": "5bar6d 5bar_linkage_iso6d",
    "kangaroo_2legs": "kangaroo_like_2leg kangaroo_like_2legs",
    "kangaroo_leg": "kangaroo_like",
    "talos_2legs": "talos_2legs_urdf talos_full_closed talos_only_leg true_talos_2_legs",
    "talos_leg": "talos_like",
    "wl16_leg": "wl16_like",
}


def test_a_published_name_suggests_the_robot_here(folder: Path) -> None:
    for ours, theirs in PUBLISHED.items():
        assert ours in eurdf.collection_names()
        for name in theirs.split():
            with pytest.raises(eurdf.errors.RobotNotFound, match=rf"there is no '{name}'.*did you mean '{ours}'\?$"):
                eurdf.load(name)


@pytest.mark.parametrize("command", ["check", "info", "assemble"])
def test_missing_urdf_or_folder_suggests_similar_one(
    folder: Path, command: str, capsys: pytest.CaptureFixture[str]
) -> None:
    from eurdf.commands.main import main

    (folder / "packages").mkdir()
    (folder / "arm.urdf").write_text(URDF, encoding="utf-8")
    (folder / "arm.yaml").write_text(DESCRIPTION, encoding="utf-8")
    assert main([command, "arm.yaml", "--urdf", "arms.urdf"]) == 2
    assert capsys.readouterr().err == "eurdf: the URDF 'arms.urdf' does not exist; did you mean 'arm.urdf'?\n"
    assert main([command, "arm.yaml", "--urdf", "arm.urdf", "--package-dir", "package"]) == 2
    assert capsys.readouterr().err == "eurdf: --package-dir: 'package' is not a folder; did you mean 'packages'?\n"


# --- commands that write a description -------------------------------------------------------------------------------


def test_description_is_generated_from_standard_input(folder: Path) -> None:
    done = eurdf_with(URDF, "generate", "-", "--motor", "shoulder", "-o", "arm.yaml")
    assert done.returncode == 0
    assert "the URDF came from <stdin>; write it to 'robot.urdf'" in done.stderr
    (folder / "robot.urdf").write_text(URDF, encoding="utf-8")
    assert eurdf.load("arm.yaml").actuation.joints == ("shoulder",)


def test_standard_input_is_migrated(folder: Path) -> None:
    (folder / "leg").mkdir()
    shutil.copy(FOUR_BAR / "robot.urdf", folder / "leg" / "leg.urdf")
    text = (FOUR_BAR / "robot.v1.yaml").read_text(encoding="utf-8")
    done = eurdf_with(text, "migrate", "-", "--urdf", "leg/leg.urdf", "-o", "two.yaml")
    assert done.returncode == 0
    assert eurdf.load("two.yaml").mechanism.version == "2.0"
    done = in_bash(f"eurdf migrate '{FOUR_BAR / 'robot.v1.yaml'}' --urdf <(cat leg/leg.urdf)")
    assert "urdf: robot.urdf" in done.stdout
    assert "write it to 'robot.urdf'" in done.stderr


def test_schema_for_urdf_from_stdin_contains_joints() -> None:
    assert '"shoulder"' in eurdf_with(URDF, "schema", "--for", "-").stdout
    done = eurdf_with("<robot", "schema", "--for", "-")
    assert (done.returncode, done.stdout) == (1, "")
    assert "<stdin>:1:1: error" in done.stderr


def test_configuration_is_not_written_to_standard_input(folder: Path) -> None:
    text = (FOUR_BAR / "robot.yaml").read_text(encoding="utf-8")
    done = eurdf_with(text, "assemble", "-", "--urdf", str(FOUR_BAR / "robot.urdf"), "--write")
    assert (done.returncode, done.stdout) == (2, "")
    assert "saving needs a file" in done.stderr


# --- a folder whose files cannot be read -----------------------------------------------------------------------------


@pytest.mark.parametrize("name", ["robot.yaml", "robot.yml", "leg.yaml", "leg.eurdf.yaml"])
@pytest.mark.parametrize("target", ["nowhere.yaml", ".", "loop"])
def test_unreadable_description_beside_urdf_is_an_error(folder: Path, name: str, target: str) -> None:
    """Else the closures that it states would be dropped in silence."""
    (folder / "robot.urdf").write_text(URDF, encoding="utf-8")
    (folder / name).symlink_to(name if target == "loop" else target)
    report = eurdf.check(folder)
    if target == ".":  # a folder is no description
        assert report.ok
        return
    assert [found.code for found in report.diagnostics] == ["file-unreadable"]
    with pytest.raises(eurdf.InvalidRobot):
        eurdf.load(folder)
    ended = eurdf_with("", "check", ".")
    assert (ended.returncode, ": valid" in ended.stdout) == (1, False)


def test_pipe_named_as_description_is_an_error(folder: Path) -> None:
    (folder / "robot.urdf").write_text(URDF, encoding="utf-8")
    os.mkfifo(folder / "robot.yaml")
    assert [found.code for found in eurdf.check(folder).diagnostics] == ["file-unreadable"]


def test_folder_that_cannot_be_read_is_an_error(folder: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    def refuse(path: object) -> None:
        raise PermissionError(13, "Permission denied", os.fspath(folder))

    monkeypatch.setattr(os, "scandir", refuse)
    monkeypatch.setattr(os, "listdir", refuse)
    report = eurdf.check(folder)
    assert [found.code for found in report.diagnostics] == ["file-unreadable"]
    assert f"the folder '{folder}' cannot be read: permission denied" in report.diagnostics[0].message


@pytest.mark.parametrize("given_to", ["path", "urdf"])
def test_empty_path_is_not_the_working_directory(folder: Path, given_to: str) -> None:
    (folder / "robot.urdf").write_text(URDF, encoding="utf-8")
    (folder / "robot.yaml").write_text(DESCRIPTION, encoding="utf-8")
    for function in (eurdf.check, eurdf.load):
        with pytest.raises(eurdf.errors.RobotNotFound, match="is empty"):
            function(**{"path": "robot.yaml", given_to: ""})
    argv = ["check", ""] if given_to == "path" else ["check", "robot.yaml", "--urdf", ""]
    assert eurdf_with("", *argv).returncode == 2
