"""The command line."""

import glob
import json
import os
import signal
import subprocess
import sys
from collections.abc import Callable
from pathlib import Path
from typing import Any

import jsonschema
import pytest

import eurdf
from eurdf.commands.main import COMMANDS, main
from eurdf.commands.output import output_schemas
from eurdf.commands.selection import select
from eurdf.diagnostics import Diagnostic, Place
from eurdf.diagnostics.report import Report
from support.described import ARM as URDF
from support.described import ARM_DESCRIPTION as DESCRIPTION
from support.processes import on_a_terminal

ACTUATES_NOTHING = """\
extended_urdf: "2.0"
actuators: [sholder]
"""

Run = Callable[..., tuple[int, str, str]]


@pytest.fixture(autouse=True)
def _processes_import_the_same_package(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setenv("PYTHONPATH", str(Path(eurdf.__file__).parents[1]), prepend=os.pathsep)


def robot(folder: Path, description: str = DESCRIPTION, urdf: str = URDF) -> Path:
    folder.mkdir(parents=True, exist_ok=True)
    (folder / "robot.urdf").write_text(urdf, encoding="utf-8")
    (folder / "robot.yaml").write_text(description, encoding="utf-8")
    return folder


def finds(monkeypatch: pytest.MonkeyPatch, *codes: str) -> None:
    """Let every check find just these."""
    found = tuple(Diagnostic(code, "it is wrong", Place("robot.yaml", 1)) for code in codes)
    monkeypatch.setitem(vars(eurdf), "check", lambda path, **options: Report(path, found))


def in_a_process(*argv: str, **options: Any) -> subprocess.CompletedProcess[str]:
    return subprocess.run([sys.executable, "-m", "eurdf", *argv], capture_output=True, text=True, timeout=60, **options)


# --- check -----------------------------------------------------------------------------------------------------------


def test_valid_robot_exits_0(folder: Path, run: Run) -> None:
    robot(folder / "arm")
    assert run("check", "arm") == (0, "arm: valid\n", "")


def test_error_is_shown_with_place_and_exits_1(folder: Path, run: Run) -> None:
    robot(folder / "arm", ACTUATES_NOTHING)
    code, out, err = run("check", "arm")
    assert code == 1
    assert out.startswith("arm/robot.yaml:2:13: error: ")
    assert "    2 | actuators: [sholder]\n      |             ^^^^^^^\n" in out
    assert "= fix: write 'shoulder'" in out
    assert out.endswith("arm: 1 error; --fix applies 1 fix\n")
    assert err == ""


def test_every_robot_below_a_folder_is_checked(folder: Path, run: Run) -> None:
    robot(folder / "robots" / "a")
    robot(folder / "robots" / "b", ACTUATES_NOTHING)
    robot(folder / "robots" / "deep" / "c")
    code, out, _ = run("check", "robots")
    assert code == 1
    assert [line for line in out.splitlines() if line.startswith("robots/") and " error: " not in line] == [
        "robots/a: valid",
        "robots/b: 1 error; --fix applies 1 fix",
        "robots/deep/c: valid",
    ]
    assert out.endswith("3 robots: 2 passed, 1 failed (1 error)\n")


def test_duplicate_robot_is_checked_once(folder: Path, run: Run) -> None:
    robot(folder / "arm")
    assert run("check", "arm", "arm")[1] == "arm: valid\n"


def test_urdf_option_replaces_named_urdf(folder: Path, run: Run) -> None:
    robot(folder / "arm", urdf="<robot")
    (folder / "other.urdf").write_text(URDF, encoding="utf-8")
    assert run("check", "arm")[0] == 1
    assert run("check", "arm", "--urdf", "other.urdf")[0] == 0


def test_warning_fails_only_strict_check(folder: Path, run: Run, monkeypatch: pytest.MonkeyPatch) -> None:
    robot(folder)
    finds(monkeypatch, "near-miss-key")
    assert run("check", ".")[0] == 0
    assert run("check", ".", "--strict")[0] == 1
    assert json.loads(run("check", ".", "--json")[1])["ok"]
    assert not json.loads(run("check", ".", "--json", "--strict")[1])["ok"]


def test_ignored_advice_is_left_out(folder: Path, run: Run, monkeypatch: pytest.MonkeyPatch) -> None:
    robot(folder)
    finds(monkeypatch, "x-asymmetric", "x-no-actuator")
    code, out, _ = run("check", ".", "--strict", "--ignore", "x-asymmetric")
    assert (code, "x-asymmetric" in out, "x-no-actuator" in out) == (1, False, True)
    assert run("check", ".", "--strict", "--ignore", "x-asymmetric", "--ignore", "x-no-actuator")[0] == 0
    with pytest.raises(SystemExit):
        run("check", ".", "--ignore", "unknown-frame")


def test_check_json_matches_published_schema(folder: Path, run: Run) -> None:
    robot(folder / "a")
    robot(folder / "b", ACTUATES_NOTHING)
    code, out, _ = run("check", "a", "b", "--json")
    document = json.loads(out)
    jsonschema.Draft202012Validator(output_schemas()["diagnostics-report.schema.json"]).validate(document)
    assert code == 1
    assert [(entry["path"], entry["ok"]) for entry in document["robots"]] == [("a", True), ("b", False)]
    (found,) = document["robots"][1]["diagnostics"]
    assert (found["code"], found["line"], found["column"]) == ("unknown-actuator", 2, 13)


def test_check_sarif_names_the_place(folder: Path, run: Run) -> None:
    robot(folder / "my arm", ACTUATES_NOTHING)
    code, out, _ = run("check", "my arm", "--format", "sarif")
    (result,) = json.loads(out)["runs"][0]["results"]
    place = result["locations"][0]["physicalLocation"]
    assert code == 1
    assert place["artifactLocation"]["uri"] == "my%20arm/robot.yaml"
    assert place["region"] == {"startLine": 2, "startColumn": 13, "endColumn": 20}


@pytest.mark.parametrize("format_", ["text", "json", "sarif"])
def test_missing_path_exits_2_with_message(folder: Path, run: Run, format_: str) -> None:
    code, out, err = run("check", "nowhere", "--format", format_)
    assert code == 2
    assert "'nowhere'" in err
    assert err.count("\n") == 1
    assert out == "" or format_ == "json"


@pytest.mark.parametrize(
    "argv",
    [
        "check nowhere --json",
        "info four_bar --json --jsn",
        "nothing --json",
        "export four_bar --to mujoco --json",
        "transmission four_bar --joints nobody --json",
    ],
)
def test_error_is_also_a_json_object(argv: str, capsys: pytest.CaptureFixture[str]) -> None:
    try:
        code: object = main(argv.split())
    except SystemExit as exit_:
        code = exit_.code
    out, err = capsys.readouterr()
    found = json.loads(out)
    jsonschema.Draft202012Validator(output_schemas()["error.schema.json"]).validate(found)
    assert code == 2
    assert found["error"] in err


@pytest.mark.parametrize(
    ("argv", "meant"),
    [
        ("chek four_bar", "did you mean 'check'?"),
        ("nothing", "`eurdf help` lists the commands"),
        ("help improt", "did you mean 'import'?"),
        ("info four_bar --jsn", "eurdf info: unrecognized arguments: --jsn; did you mean '--json'?"),
        ("info four_bar --root=fixd", "did you mean 'fixed'?"),
        ("export four_bar --to MuJoCo", "did you mean 'mjcf'?"),
        ("export four_bar --to isaac-sim", "did you mean 'usd'?"),
        ("export four_bar --to rviz", "the formats are: mjcf, "),
        ("import a.sdf -o b --from gazebo", "did you mean 'sdf'?"),
    ],
)
def test_wrong_word_names_the_meant_one(argv: str, meant: str, capsys: pytest.CaptureFixture[str]) -> None:
    with pytest.raises(SystemExit) as exit_:
        main(argv.split())
    assert exit_.value.code == 2
    assert meant in capsys.readouterr().err


@pytest.mark.parametrize("argv", [["schema", "-o"], ["view", "four_bar", "-o"]])
def test_written_file_is_named_as_json(folder: Path, run: Run, argv: list[str]) -> None:
    code, out, err = run(*argv, "file", "--json")
    found = json.loads(out)
    jsonschema.Draft202012Validator(output_schemas()["written.schema.json"]).validate(found)
    assert (code, found, err) == (0, {"files": ["file"], "url": None}, "wrote 'file'\n")
    assert (folder / "file").is_file()


def test_quiet_command_writes_results_and_errors_only(folder: Path, run: Run) -> None:
    robot(folder / "arm")
    assert run("check", "arm", "-q") == (0, "", "")
    assert run("schema", "-q", "-o", "s.json") == (0, "", "")
    assert run("--quiet", "schema", "-o", "s.json")[2] == "eurdf: 's.json' already exists; --force replaces it\n"
    assert run("info", "arm", "-q")[1].startswith("arm ")
    robot(folder / "arm", ACTUATES_NOTHING)
    assert run("check", "arm", "-q")[1].startswith("arm/robot.yaml:2:13: error: ")
    assert "\narm: 1 error" in run("check", "arm")[1]


@pytest.mark.parametrize("path", ["x" * 5000, "a\0b", "a\x1b[31mb", ""])
def test_impossible_path_exits_2_in_one_line(folder: Path, run: Run, path: str) -> None:
    code, out, err = run("check", path)
    assert (code, out) == (2, "")
    assert err.endswith("\n")
    assert err[:-1].isprintable()


def test_folder_without_robot_exits_2(folder: Path, run: Run) -> None:
    (folder / "empty").mkdir()
    code, out, err = run("check", "empty")
    assert (code, out) == (2, "")
    assert "'empty'" in err


@pytest.mark.parametrize(
    "argv", [["chek"], ["check"], ["check", "a", "--format", "xml"], ["info"], ["schema", "--version", "3"]]
)
def test_bad_usage_exits_2(argv: list[str]) -> None:
    with pytest.raises(SystemExit) as exit_:
        main(argv)
    assert exit_.value.code == 2


@pytest.mark.parametrize("name", ["stdout", "stderr"])
def test_closed_stream_changes_nothing_else(name: str, folder: Path) -> None:
    robot(folder)
    program = f"import sys; sys.{name} = None; from eurdf.commands.main import main; sys.exit(main(['check', '.']))"
    done = subprocess.run([sys.executable, "-c", program], capture_output=True, text=True, timeout=60, check=False)
    assert (done.returncode, done.stderr) == (0, "")
    assert done.stdout == ("" if name == "stdout" else ".: valid\n")


# --- which robots a path refers to -----------------------------------------------------------------------------------


def test_description_is_recognized_by_its_keys(folder: Path) -> None:
    (folder / "two.yaml").write_text('# arm\nextended_urdf: "2.0"\n', encoding="utf-8")
    (folder / "one.yml").write_text("'closed_loop' : []\n", encoding="utf-8")
    (folder / "quoted.yaml").write_text('"extended_urdf": "2.0"\n', encoding="utf-8")
    (folder / "other.yaml").write_text("ros:\n  closed_loop: []\nnot_extended_urdf: 1\n", encoding="utf-8")
    (folder / "binary.yaml").write_bytes(bytes(range(256)))
    assert select(["."]) == ["./one.yml", "./quoted.yaml", "./two.yaml"]


def test_description_is_recognized_by_its_file_name(folder: Path) -> None:
    for name in ("left.eurdf.yaml", "right.eurdf.yml"):
        (folder / name).write_text('extended_urfd: "2.0"\n', encoding="utf-8")
    (folder / "mkdocs.yml").write_text("site_name: A site\n", encoding="utf-8")
    assert select(["."]) == select(["."], allow_none=True) == ["./left.eurdf.yaml", "./right.eurdf.yml"]


def test_key_is_found_anywhere_in_the_file(folder: Path) -> None:
    for name in ("one.yaml", "two.yaml"):
        (folder / name).write_text("#" * (5 << 20) + '\nextended_urdf: "2.0"\n', encoding="utf-8")
    assert select(["."]) == ["./one.yaml", "./two.yaml"]


def test_yaml_beside_robot_yaml_belongs_to_it(folder: Path) -> None:
    robot(folder / "arm")
    (folder / "arm" / "robot.v1.yaml").write_text("closed_loop: []\n", encoding="utf-8")
    assert select(["arm"]) == ["arm"]
    assert select(["."]) == ["./arm"]


def test_hidden_folders_and_links_are_skipped(folder: Path) -> None:
    robot(folder / "arm")
    robot(folder / ".git" / "arm")
    (folder / "loop").symlink_to(folder)
    assert select(["."]) == ["./arm"]


def test_folder_with_single_urdf_is_a_robot(folder: Path) -> None:
    (folder / "robot.urdf").write_text(URDF, encoding="utf-8")
    assert select(["."]) == ["."]


def test_empty_folder_is_error_unless_allowed(folder: Path, run: Run) -> None:
    (folder / "mkdocs.yml").write_text("site_name: A site\n", encoding="utf-8")
    assert run("check", ".")[0] == 1  # the one YAML file of a folder is its description
    assert run("check", "--allow-none", ".") == (0, ".: no robot\n", "")
    assert json.loads(run("check", "--allow-none", ".", "--json")[1])["robots"] == []
    robot(folder / "arm")
    assert run("check", "--allow-none", ".")[1] == "./arm: valid\n"
    assert run("check", "--allow-none", "nowhere")[0] == 2


def test_folders_without_robot_among_others_are_skipped(folder: Path, run: Run) -> None:
    robot(folder / "robots" / "arm")
    robot(folder / "robots" / "broken", ACTUATES_NOTHING)
    robot(folder / "robots" / "group" / "leg")
    for name, content in (
        ("quality/__init__.py", ""),
        ("xacros/macros.xacro", "<robot/>"),
        ("meshes/deep/a.stl", ""),
        ("xacros/limits.yaml", "speed: 2\n"),
    ):
        (folder / "robots" / name).parent.mkdir(parents=True, exist_ok=True)
        (folder / "robots" / name).write_text(content, encoding="utf-8")
    paths = sorted(glob.glob("robots/*/"))
    code, out, err = run("check", *paths)
    assert (code, err) == (
        1,
        "skipped 3 folders without a robot: 'robots/meshes/', 'robots/quality/', 'robots/xacros/'\n",
    )
    assert "robots/arm/: valid" in out
    assert "robots/group/leg: valid" in out
    report = json.loads(run("check", *paths, "--json")[1])
    jsonschema.validate(report, output_schemas()["diagnostics-report.schema.json"])
    assert report["skipped"] == ["robots/meshes/", "robots/quality/", "robots/xacros/"]
    assert run("check", "robots/arm", "robots/quality")[0] == 0
    for alone in (["robots/quality"], ["robots/quality", "robots/meshes"], ["robots/arm", "nowhere"]):
        assert run("check", *alone)[0] == 2
    (folder / "robots" / "quality" / "a.urdf").write_text(URDF, encoding="utf-8")
    (folder / "robots" / "quality" / "b.urdf").write_text(URDF, encoding="utf-8")
    code, _, err = run("check", *paths)
    assert (code, "contains 2 URDFs; name the file" in err) == (2, True)


# --- info ------------------------------------------------------------------------------------------------------------


def test_info_of_four_bar_shows_mobility(folder: Path, run: Run) -> None:
    code, out, _ = run("info", "four_bar", "--json")
    info = json.loads(out)
    jsonschema.Draft202012Validator(output_schemas()["info.schema.json"]).validate(info)
    assert code == 0
    expected = {
        "version": "2.0",
        "root": "fixed",
        "nv": 3,
        "joints": 3,
        "closures": 1,
        "nc": 3,
        "rank": 2,
        "mobility": 1,
        "redundant": 1,
        "uncontrolled": 0,
        "actuated": 1,
        "closes": True,
    }
    assert {key: info[key] for key in expected} == expected
    assert info["residual"] < 1e-9
    assert info["mass"] == pytest.approx(1.4)  # with that of the root link
    assert [joint["actuated"] for joint in info["joint_list"]].count(True) == 1
    assert [closure["rows"] for closure in info["closure_list"]] == [3]


def test_info_distinguishes_mimic_joint_from_leader(folder: Path, run: Run) -> None:
    follower = """\
  <link name="finger">
    <inertial><mass value="1"/><inertia ixx="0.1" ixy="0" ixz="0" iyy="0.1" iyz="0" izz="0.1"/></inertial>
  </link>
  <joint name="a_follower" type="continuous">
    <parent link="base"/><child link="finger"/><axis xyz="0 0 1"/><mimic joint="shoulder" multiplier="2"/>
  </joint>
</robot>"""
    robot(folder, urdf=URDF.replace("</robot>", follower))
    for root, extra in (("fixed", []), ("floating", [("root_joint", 6, False, None)])):
        info = json.loads(run("info", ".", "--json", "--root", root)[1])
        assert [(j["name"], j["nv"], j["actuated"], j["mimics"]) for j in info["joint_list"]] == [
            *extra,
            ("a_follower", 0, False, "shoulder"),
            ("shoulder", 1, True, None),
        ]
        assert info["joints"] == len(info["joint_list"])
        assert info["nv"] == sum(joint["nv"] for joint in info["joint_list"])
        assert info["nq"] == sum(joint["nq"] for joint in info["joint_list"])


def test_info_works_without_closures(folder: Path, run: Run) -> None:
    (folder / "arm.urdf").write_text(URDF, encoding="utf-8")
    info = json.loads(run("info", "arm.urdf", "--json")[1])
    jsonschema.Draft202012Validator(output_schemas()["info.schema.json"]).validate(info)
    assert info["version"] == ""
    assert (info["closures"], info["nc"], info["rank"], info["mobility"], info["uncontrolled"]) == (0, 0, 0, 1, 1)
    assert info["closes"] is True
    assert info["residual"] == 0.0


def test_info_is_plain_ascii_without_terminal(folder: Path, run: Run) -> None:
    code, out, _ = run("info", "four_bar")
    assert code == 0
    assert out.isascii()
    assert "\x1b" not in out
    assert not any(line != line.rstrip() for line in out.splitlines())
    words = [line.split() for line in out.splitlines()]
    assert ["mobility", "1"] in [line[:2] for line in words]
    assert ["uncontrolled", "0"] in [line[:2] for line in words]


def test_info_shows_warnings_before_its_tables(folder: Path, run: Run) -> None:
    robot(folder, urdf=URDF.replace("</robot>", '<loop name="l"/></robot>'))
    out = run("info", ".")[1]
    title, first, *_ = out.splitlines()
    assert title.endswith(", 1 warning")
    assert "warning: " in first
    assert out.index("warning: ") < out.index("mobility")


def test_info_escapes_markup_and_controls(folder: Path, run: Run) -> None:
    name = "[red]up&#27;per[/red]"
    robot(folder, urdf=URDF.replace("upper", "[red]upper[/red]").replace('name="arm"', 'name="&#x202e;[b]arm"'))
    out = run("info", ".")[1]
    assert "[red]upper[/red]" in out
    assert r"\u202e[b]arm" in out
    assert name not in out


def test_info_of_refused_robot_exits_1_with_reason(folder: Path, run: Run) -> None:
    robot(folder, ACTUATES_NOTHING)
    code, out, _ = run("info", ".")
    assert code == 1
    assert "did you mean 'shoulder'?" in out
    code, out, _ = run("info", ".", "--json")
    assert code == 1
    assert [found["code"] for found in json.loads(out)["robots"][0]["diagnostics"]] == ["unknown-actuator"]


def test_info_of_several_robots_asks_for_one(folder: Path, run: Run) -> None:
    robot(folder / "a")
    robot(folder / "b")
    code, _, err = run("info", ".")
    assert code == 2
    assert "2 robots" in err


# --- the process -----------------------------------------------------------------------------------------------------


def test_help_lists_all_commands_and_version() -> None:
    result = in_a_process("--help")
    assert result.returncode == 0
    for command in COMMANDS:
        assert f"\n    {command} " in result.stdout
    assert in_a_process().stdout == in_a_process("help").stdout == result.stdout
    assert in_a_process("help", "info").stdout == in_a_process("info", "--help").stdout
    assert in_a_process("--version").stdout == f"eurdf {eurdf.__version__}\n"


@pytest.mark.parametrize("argv", [["--help"], ["schema"], ["check", "--help"]])
def test_fast_commands_load_no_simulator(argv: list[str]) -> None:
    code = (
        "import sys\nfrom eurdf.commands.main import main\n"
        "try:\n    main(sys.argv[1:])\nexcept SystemExit: pass\n"
        "sys.stderr.write(str('pinocchio' in sys.modules))"
    )
    result = subprocess.run([sys.executable, "-c", code, *argv], capture_output=True, text=True, timeout=60)
    assert result.stderr == "False"


def test_ascii_locale_shows_escapes(folder: Path) -> None:
    robot(folder / "名", ACTUATES_NOTHING + "x-note: é名\n")
    result = in_a_process("check", "名", env={**os.environ, "PYTHONIOENCODING": "ascii", "PYTHONUTF8": "0"})
    assert result.returncode == 1
    assert result.stdout.isascii()
    assert result.stderr == ""


def test_file_output_is_utf8_in_every_locale() -> None:
    code = "from eurdf.commands.terminal import write_text; write_text('name: é名\\n')"
    environment = {**os.environ, "PYTHONIOENCODING": "ascii", "PYTHONUTF8": "0"}
    written = subprocess.run([sys.executable, "-c", code], capture_output=True, timeout=60, env=environment).stdout
    assert written.decode("utf-8") == "name: é名\n"


@pytest.mark.parametrize(("variables", "coloured"), [({}, False), ({"FORCE_COLOR": "1"}, True)])
def test_pipe_is_coloured_only_on_request(folder: Path, variables: dict[str, str], coloured: bool) -> None:
    robot(folder)
    environment = {name: value for name, value in os.environ.items() if name not in ("FORCE_COLOR", "NO_COLOR")}
    result = in_a_process("check", ".", env={**environment, "TERM": "xterm-256color", **variables})
    assert ("\x1b[32mvalid" in result.stdout) == coloured


def test_closed_pipe_ends_command_quietly(folder: Path) -> None:
    robot(folder, ACTUATES_NOTHING)
    paths = [f"./{'./' * i}robot.yaml" for i in range(500)]
    process = subprocess.Popen(
        [sys.executable, "-c", _CHECK_QUICKLY, *paths], stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True
    )
    assert process.stdout is not None
    assert process.stderr is not None
    process.stdout.readline()
    process.stdout.close()
    errors = process.stderr.read()
    process.stderr.close()
    assert process.wait(timeout=60) == 141
    assert errors == ""


_CHECK_QUICKLY = """
import sys
import eurdf
from eurdf.diagnostics import Diagnostic, Place
from eurdf.diagnostics.report import Report
from eurdf.commands.main import main
eurdf.check = lambda path, **options: Report(path, (Diagnostic("wrong-type", "it is wrong", Place(path, 1, 1)),))
sys.exit(main(["check", *sys.argv[1:]]))
"""

_INTERRUPT_AT_IMPORT = """
import atexit, os, signal, sys
from eurdf.__main__ import start
moment = sys.argv.pop(1)
def interrupt():
    os.kill(os.getpid(), signal.SIGINT)
class Finder:
    def find_spec(name, path, target=None):
        if name == moment:
            interrupt()
if moment == "the end":
    atexit.register(interrupt)
sys.meta_path.insert(0, Finder)
sys.exit(start())
"""


def interrupted(moment: str, handler: Any) -> subprocess.CompletedProcess[str]:
    """A check that is interrupted when it imports a module; SIGINT is first as the parent process left it."""
    return subprocess.run(
        [sys.executable, "-c", _INTERRUPT_AT_IMPORT, moment, "check", "."],
        capture_output=True,
        text=True,
        timeout=120,
        preexec_fn=lambda: signal.signal(signal.SIGINT, handler),
    )


@pytest.mark.parametrize("moment", ["eurdf.commands.main", "eurdf.loading", "lxml", "the end"])
def test_interrupt_ends_command_quietly(folder: Path, moment: str) -> None:
    robot(folder)
    ended = interrupted(moment, signal.SIG_DFL)
    assert ended.returncode in (130, -signal.SIGINT)  # a shell reports both as 130
    assert ended.stderr == ""
    assert moment == "the end" or ended.stdout == ""


def test_ignored_interrupt_stays_ignored(folder: Path) -> None:
    robot(folder)
    ended = interrupted("lxml", signal.SIG_IGN)
    assert (ended.returncode, ended.stdout, ended.stderr) == (0, ".: valid\n", "")


def test_internal_error_is_not_blamed_on_robot(folder: Path, run: Run, monkeypatch: pytest.MonkeyPatch) -> None:
    def broken(path: str, **options: Any) -> Report:
        raise RuntimeError("impossible")

    robot(folder)
    monkeypatch.setitem(vars(eurdf), "check", broken)
    code, _, err = run("check", ".")
    assert code == 2
    assert "RuntimeError: impossible" in err
    assert err.endswith("eurdf: this is a bug in eurdf, not an error of the robot; please report it\n")


def test_terminal_output_has_colours_and_no_wrapping(folder: Path) -> None:
    robot(folder, ACTUATES_NOTHING + "x-note: " + "long " * 100 + "\n")
    _, seen = on_a_terminal(["-m", "eurdf", "check", "."])
    assert "\x1b[1;31merror\x1b[0m" in seen
    assert "│" in seen
    assert "\x1b[1;31m" not in on_a_terminal(["-m", "eurdf", "check", ".", "--no-color"])[1]
    piped = in_a_process("check", ".").stdout
    assert "\x1b" not in piped
    assert "│" not in piped


@pytest.mark.parametrize("quiet", [[], ["-q"]])
def test_terminal_says_what_takes_long(folder: Path, quiet: list[str]) -> None:
    robot(folder / "arm")
    code = (
        "import sys, time, eurdf\nfrom eurdf.commands.main import main\n"
        "load = eurdf.load\n"
        "def late(*given, **options):\n    time.sleep(1.5)\n    return load(*given, **options)\n"
        "eurdf.load = late\nsys.exit(main(sys.argv[1:]))"
    )
    exit_code, text = on_a_terminal(["-c", code, "info", "arm", *quiet])
    assert exit_code == 0
    assert ("analysing the loops" in text) == (not quiet)


def test_terminal_shows_progress_of_many_robots(folder: Path) -> None:
    for name in "abcdef":
        robot(folder / name)
    _, seen = on_a_terminal(["-c", _CHECK_QUICKLY, "."])
    assert "checking" in seen
    assert seen.index("checking") < seen.index("error")
