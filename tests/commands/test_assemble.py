"""``eurdf assemble``: a closed configuration, shown and written to the description."""

from __future__ import annotations

import json
import re
import shutil
from collections.abc import Callable
from pathlib import Path
from typing import Any

import jsonschema
import numpy as np
import pytest

import eurdf
from eurdf.commands.main import main
from eurdf.commands.output import output_schemas
from support.places import DATA, ROBOTS

Run = Callable[..., tuple[int, str, str]]

#: The workbench without its `assembled`, with the crank turned: open until it is assembled.
DESCRIPTION = """\
# A bench
extended_urdf: "2.0"
urdf: workbench.urdf   # beside it
closures:
  - name: pin  # of the rocker
    type: 3d
    frames: [rod_tip, rocker_top]
joints:
  hand_ball: {type: spherical, merges: [wrist_x, wrist_y, wrist_z]}
actuators:   # two
  - motor
  - grip
frames:
  - {name: rocker_top, link: rocker, xyz: [0, 0.3, 0]}

# ours
x-note: kept
"""
READY = """\
configurations:
  # a place to start from
  ready: {motor: 0.5, grip: 0.1}  # open
"""


def bench(folder: Path, description: str = DESCRIPTION, urdf: Callable[[str], str] = str) -> Path:
    file = folder / "robot.yaml"
    file.write_bytes(description.encode())
    (folder / "workbench.urdf").write_text(urdf((DATA / "workbench.urdf").read_text(encoding="utf-8")))
    return file


def largest_row(path: Path) -> float:
    robot = eurdf.load(path, geometry=False)
    return float(np.abs(eurdf.residual(robot, robot.configurations["assembled"])).max())


def test_coordinates_are_shown_with_units(folder: Path, run: Run) -> None:
    bench(folder, DESCRIPTION + READY)
    code, out, err = run("assemble", "robot.yaml", "--from", "ready", "--hold", "motor")
    assert (code, err) == (0, "")
    assert re.fullmatch(r"workbench  closed, residual \d\.\de-1\d, from ready", out.splitlines()[0])
    assert [re.split(r"  +", line)[1:] for line in out.splitlines()[3:6]] == [
        ["spherical", "0", "0", "0", "1", "quaternion x y z w"],
        ["prismatic", "0.1", "m", "actuated"],
        ["revolute", "0.5", "rad", "held, actuated"],
    ]
    assert (folder / "robot.yaml").read_text() == DESCRIPTION + READY


@pytest.mark.parametrize("name", ["delta", "digit_leg", "kangaroo_2legs", "slider_crank", "tesla_optimus_ankle"])
def test_json_matches_schema_and_has_all_coordinates(name: str, run: Run) -> None:
    code, out, err = run("assemble", name, "--json")
    assert (code, err) == (0, "")
    found = json.loads(out)
    jsonschema.Draft202012Validator(output_schemas()["assemble.schema.json"]).validate(found)
    robot = eurdf.load(name, geometry=False)
    shown = {joint["name"]: tuple(one["value"] for one in joint["coordinates"]) for joint in found["joints"]}
    assert shown == robot.joint_positions(robot.configurations["assembled"])
    assert (found["start"], found["closes"], found["file"], found["written"]) == ("assembled", True, None, False)


def test_written_configuration_changes_nothing_else(folder: Path, run: Run) -> None:
    file = bench(folder)
    code, _, err = run("assemble", "robot.yaml", "--write")
    assert (code, err) == (0, "wrote the configuration 'assembled' to 'robot.yaml'\n")
    text = file.read_text(encoding="utf-8")
    (line,) = re.findall(r"^  assembled: .*\n", text, re.MULTILINE)
    assert text.replace(f"configurations:\n{line}", "") == DESCRIPTION
    assert text.index("rocker_top, link") < text.index("configurations:\n") < text.index("\n# ours")
    assert largest_row(file) <= 1e-12
    assert eurdf.check(file).ok
    assert run("assemble", "robot.yaml", "--write")[::2] == (
        0,
        "'robot.yaml' already has this configuration as 'assembled': nothing to do\n",
    )
    assert file.read_text(encoding="utf-8") == text
    found = json.loads(run("assemble", "robot.yaml", "--write", "--json")[1])
    assert (found["file"], found["written"]) == ("robot.yaml", False)


def test_byte_order_mark_and_line_breaks_are_kept(folder: Path, run: Run) -> None:
    file = bench(folder)
    before = b"\xef\xbb\xbf" + DESCRIPTION.replace("\n", "\r\n").encode()
    file.write_bytes(before)
    assert run("assemble", "robot.yaml", "--write")[0] == 0
    after = file.read_bytes()
    assert after.startswith(b"\xef\xbb\xbf# A bench\r\n")
    assert re.sub(rb"configurations:\r\n  assembled: .*\r\n", b"", after) == before
    assert largest_row(file) <= 1e-12


def test_different_assembled_is_replaced_only_with_force(folder: Path, run: Run) -> None:
    file = bench(folder, DESCRIPTION + READY + "  assembled:\n    # the motor\n    motor: 0.1  # rad\n")
    before = file.read_text()
    code, out, err = run("assemble", "robot.yaml", "--write", "--hold", "motor")
    assert code == 2
    assert out.startswith("workbench  closed")
    assert err == ("eurdf: 'robot.yaml' already has a different configuration 'assembled'; --force replaces it\n")
    assert file.read_text() == before
    code, _, err = run("assemble", "robot.yaml", "--write", "--hold", "motor", "--force")
    assert (code, err) == (0, "wrote the configuration 'assembled' to 'robot.yaml'\n")
    after = file.read_text()
    assert after.startswith(before.removesuffix("\n"))  # the motor is held at 0.1
    assert [line.split(":")[0].strip() for line in after[len(before) :].splitlines()] == ["elbow", "pivot"]
    assert largest_row(file) <= 1e-12


def test_floating_root_is_stated_only_if_moved(folder: Path, run: Run) -> None:
    floating = DESCRIPTION.replace("closures:", "root: floating\nclosures:")
    file = bench(folder, floating + "configurations: {up: {root_joint: [0, 0, 1, 0, 0, 0, 1], motor: 0.5}}\n")
    assert run("assemble", "robot.yaml", "--write", "--from", "up")[0] == 0
    assert "assembled: {root_joint: [0, 0, 1, 0, 0, 0, 1], " in file.read_text().replace("\n    ", " ")
    assert eurdf.check(file).ok


def open_bench(urdf: str) -> str:
    return urdf.replace('<origin xyz="0.6 -0.3 0.1"/>', '<origin xyz="1.6 -0.3 0.1"/>')


@pytest.mark.parametrize("options", [(), ("--write",), ("--write", "--force", "--json")])
def test_impossible_loops_exit_1_and_list_openings(folder: Path, run: Run, options: tuple[str, ...]) -> None:
    file = bench(folder, urdf=open_bench)
    code, out, err = run("assemble", "robot.yaml", *options)
    assert code == 1
    # A rocker of 0.3 m is 0.7 m or more away from the end of 0.2 m and 0.4 m.
    first, *rest = err.splitlines()
    assert re.match(r"no configuration was found that closes the loops; least open: 'pin' by \d{3} mm$", first)
    assert rest == (["nothing was written to 'robot.yaml'"] if options else [])
    assert file.read_text() == DESCRIPTION
    if "--json" in options:
        found = json.loads(out)
        assert [(closure["name"], closure["closed"]) for closure in found["closures"]] == [("pin", False)]
        assert found["closures"][0]["position"] > 0.1
    else:
        assert re.search(r"^pin +\d\.\de-01 +0\.0e\+00  open$", out, re.MULTILINE)


def narrow(urdf: str) -> str:
    """The rocker closes at 0 alone where the motor is at 0; here it may not come near."""
    return urdf.replace('<limit lower="-3" upper="3" effort="5"', '<limit lower="0.05" upper="0.3" effort="5"')


def test_limits_are_respected_if_possible(folder: Path, run: Run) -> None:
    file = bench(folder, urdf=narrow)
    assert run("assemble", "robot.yaml", "--write")[0] == 0
    robot = eurdf.load(file, geometry=False)
    (pivot,) = robot.joint_positions(robot.configurations["assembled"])["pivot"]
    assert 0.05 - 1e-9 <= pivot <= 0.3 + 1e-9
    assert largest_row(file) <= 1e-12
    assert eurdf.check(file).ok


def test_configuration_beyond_limits_is_shown_not_written(folder: Path, run: Run) -> None:
    file = bench(folder, urdf=narrow)
    code, out, err = run("assemble", "robot.yaml", "--hold", "motor")
    assert code == 0
    assert re.search(r"^pivot +revolute +0 +rad +beyond its limits$", out, re.MULTILINE)
    message = "the loops close only with joints beyond their limits: 'pivot' at 0 rad (limits 0.05 to 0.3)\n"
    assert re.sub("at -?[0-9.e-]+ rad", "at 0 rad", err) == message
    code, _, err = run("assemble", "robot.yaml", "--hold", "motor", "--write")
    assert (code, err.splitlines()[1]) == (1, "nothing was written to 'robot.yaml'")
    assert file.read_text() == DESCRIPTION
    code, _, err = run("assemble", "robot.yaml", "--hold", "motor", "--limits")
    assert code == 1
    first, second = err.splitlines()
    assert first.startswith("no configuration was found that closes the loops with 'motor' held; least open: 'pin' by ")
    assert second == "joints at their limits: 'pivot' (lower limit 0.05)"


def test_joint_outside_loops_is_written_within_its_limits(folder: Path, run: Run) -> None:
    file = bench(
        folder, urdf=lambda urdf: urdf.replace('<limit lower="-0.1" upper="0.2"', '<limit lower="0.05" upper="0.2"')
    )
    code, _, err = run("assemble", "robot.yaml", "--hold", "grip", "--write")
    assert code == 1
    assert "beyond their limits: 'grip' at 0 m (limits 0.05 to 0.2)" in err
    assert run("assemble", "robot.yaml", "--write")[0] == 0
    robot = eurdf.load(file, geometry=False)
    assert robot.joint_positions(robot.configurations["assembled"])["grip"] == (0.05,)
    assert eurdf.check(file).ok


def test_zero_range_does_not_prevent_writing(folder: Path, run: Run) -> None:
    given, none = 'lower="-3" upper="3" effort="5"', 'lower="0" upper="0" effort="5"'
    file = bench(folder, urdf=lambda urdf: urdf.replace(given, none))
    code, out, _ = run("assemble", "robot.yaml", "--write")
    assert code == 0
    assert "beyond its limits" not in out
    assert eurdf.check(file).ok


def test_version_1_is_assembled_but_not_written(folder: Path, run: Run) -> None:
    shutil.copytree(ROBOTS / "four_bar", folder / "bar")
    code, out, err = run("assemble", "bar/robot.v1.yaml")
    assert (code, err) == (0, "")
    assert out.startswith("four_bar  closed")
    message = "'bar/robot.v1.yaml' has version 1, which has no configurations; `eurdf migrate` converts it to version 2"
    assert run("assemble", "bar/robot.v1.yaml", "--write") == (2, "", f"eurdf: {message}\n")


@pytest.mark.parametrize("options", [(), ("--write",)])
def test_plain_urdf_has_no_loops(folder: Path, run: Run, options: tuple[str, ...]) -> None:
    bench(folder)
    code, out, err = run("assemble", "workbench.urdf", *options)
    assert (code, out) == (2, "")
    assert err == (
        "eurdf: 'workbench.urdf' is a plain URDF, without loops; `eurdf generate` writes a description with closures\n"
    )


def test_robot_with_errors_is_refused_with_diagnostics(folder: Path, run: Run) -> None:
    bench(folder, DESCRIPTION.replace("rod_tip", "rod_tpi"))
    code, out, err = run("assemble", "robot.yaml")
    assert (code, out) == (1, "")
    assert "did you mean 'rod_tip'?" in err
    code, out, err = run("assemble", "robot.yaml", "--json")
    assert (code, err) == (1, "")
    jsonschema.Draft202012Validator(output_schemas()["diagnostics-report.schema.json"]).validate(json.loads(out))


@pytest.mark.parametrize(
    ("options", "message"),
    [
        (("--hold", "motr"), "the model has no joint 'motr'; did you mean 'motor'?"),
        (("--from", "raedy"), "there is no configuration 'raedy'; did you mean 'ready'?"),
        (("--from", "x"), "there is no configuration 'x'; the configurations are: ready, neutral"),
        (("--urdf", "none.urdf"), "the URDF 'none.urdf' does not exist"),
        (("--force",), "--force has no effect without --write; add --write"),
    ],
)
def test_wrong_option_is_reported(folder: Path, run: Run, options: tuple[str, ...], message: str) -> None:
    bench(folder, DESCRIPTION + READY)
    assert run("assemble", "robot.yaml", *options) == (2, "", f"eurdf: {message}\n")


def test_collection_robot_is_not_written(run: Run) -> None:
    code, _, err = run("assemble", "four_bar", "--write")
    assert code == 2
    assert err.startswith("eurdf: 'four_bar' is a robot of the collection; copy its folder")


def test_uneditable_file_is_unchanged(folder: Path, run: Run) -> None:
    text = DESCRIPTION + "x-c: &c {ready: {}}\nconfigurations: *c\n"
    file = bench(folder, text)
    code, _, err = run("assemble", "robot.yaml", "--write")
    assert code == 2
    assert err == "eurdf: cannot write to 'robot.yaml': 'configurations' is an alias, or empty; edit the file by hand\n"
    assert file.read_text() == text


def test_concurrently_changed_file_is_not_overwritten(folder: Path, run: Run, monkeypatch: pytest.MonkeyPatch) -> None:
    import eurdf.writing.saved_configuration as saving

    file = bench(folder)
    compute = saving.with_closed_configuration

    def meanwhile(*arguments: Any) -> Any:
        file.write_text("changed\n")
        return compute(*arguments)

    monkeypatch.setattr(saving, "with_closed_configuration", meanwhile)
    code, _, err = run("assemble", "robot.yaml", "--write")
    assert (code, file.read_text()) == (2, "changed\n")
    assert err == ("eurdf: another program changed 'robot.yaml' in the meantime; nothing was written, try again\n")


@pytest.mark.parametrize(
    ("stated", "message"),
    [("", "residual 0; `eurdf assemble` shows a configuration"), ("configurations: {assembled: {}}\n", "residual 0")],
)
def test_info_suggests_assemble_without_stated_configuration(
    folder: Path, capsys: pytest.CaptureFixture[str], stated: str, message: str
) -> None:
    bench(folder, DESCRIPTION + stated)
    assert main(["info", "robot.yaml"]) == 0
    (line,) = re.findall(r"^loops +close  (.*)$", capsys.readouterr().out, re.MULTILINE)
    assert re.sub(r"\d\.\de[-+]\d\d", "0", line) == message


def test_stated_neutral_joint_stays_stated(folder: Path, run: Run) -> None:
    file = bench(folder, DESCRIPTION + READY + "  assembled: {stage: 0.1, pivot: 0.3}\n")
    assert run("assemble", "robot.yaml", "--write", "--from", "neutral", "--hold", "motor", "--force")[0] == 0
    assert re.search(r"^  assembled: \{stage: 0, pivot: 0\}$", file.read_text(), re.MULTILINE)
