"""`eurdf import`: files, losses, refusals."""

from __future__ import annotations

import json
import re
import sys
from pathlib import Path

import jsonschema
import pytest

import eurdf
from benchmarks.fuzz.watched import Watched
from eurdf.commands.main import main
from eurdf.commands.output import output_schemas
from eurdf.convert.import_format import import_format
from eurdf.convert.import_robot import COMMON
from eurdf.reading.other_formats import IMPORTED

BODY = '<geom type="sphere" size="0.1" mass="1"/>'
FOUR_BAR = f"""\
<mujoco model="four_bar">
  <compiler angle="radian"/>
  <worldbody>
    <body name="base">
      {BODY}
      <body name="crank" pos="0 0 0.1">
        <joint name="drive" axis="0 1 0" springref="0"/>
        {BODY}
        <body name="coupler" pos="0 0 0.2">
          <joint name="elbow" axis="0 1 0"/>
          {BODY}
          <site name="reach" pos="0.3 0 0"/>
        </body>
      </body>
      <body name="rocker" pos="0.3 0 0.1">
        <joint name="pivot" axis="0 1 0"/>
        {BODY}
        <site name="end" pos="0.01 0 0.2"/>
      </body>
      <site name="tool" pos="0 0 1"/>
    </body>
  </worldbody>
  <equality><connect name="pin" site1="reach" site2="end"/></equality>
  <actuator><motor name="drive" joint="drive" ctrlrange="-3 3"/></actuator>
</mujoco>
"""


@pytest.fixture(autouse=True)
def here(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    monkeypatch.chdir(tmp_path)
    (tmp_path / "four_bar.xml").write_text(FOUR_BAR)
    return tmp_path


@pytest.mark.parametrize("name", [*IMPORTED, "common"])
def test_losses_are_registered_well(name: str) -> None:
    losses = COMMON if name == "common" else import_format(name).losses
    codes = [kind.code for kind in losses]
    assert len(set(codes)) == len(codes)
    for kind in losses:
        assert re.fullmatch("import(-[a-z0-9]+)+", kind.code)
        assert kind.concept
        assert kind.title
        assert kind.hint


def test_files_are_written_and_losses_shown(here: Path, capsys: pytest.CaptureFixture[str]) -> None:
    (here / "LICENSE").write_text("Anyone may use it.\n")
    assert main(["import", "four_bar.xml", "-o", "out"]) == 0
    out, err = capsys.readouterr()
    files = ["LICENSE", "README.md", "extended-urdf-2.0.schema.json", "robot.urdf", "robot.yaml"]
    assert sorted(path.name for path in (here / "out").iterdir()) == files
    assert "1 constraint, 1 open at the reference pose, the most 'pin' by 10 mm; closed in the configuration" in err
    line = FOUR_BAR.splitlines().index('  <equality><connect name="pin" site1="reach" site2="end"/></equality>') + 1
    assert f"four_bar.xml:{line}: 'pin': becomes rigid" in out
    assert eurdf.check(here / "out").ok
    assert eurdf.analyze(eurdf.load(here / "out")).mobility == 1
    readme = (here / "out" / "README.md").read_text()
    assert "Imported from `four_bar.xml` (MJCF, for MuJoCo)" in readme
    assert "see `LICENSE`" in readme
    assert "| `pin` 0.01 m |" in readme
    assert "import-softness" in readme


def test_json_lists_every_loss_with_its_place(capsys: pytest.CaptureFixture[str]) -> None:
    assert main(["import", "four_bar.xml", "-o", "out", "--json"]) == 0
    found = json.loads(capsys.readouterr().out)
    jsonschema.Draft202012Validator(output_schemas()["import.schema.json"]).validate(found)
    losses = eurdf.import_robot("four_bar.xml").losses
    assert [(each["code"], each["name"]) for each in found["losses"]] == [(loss.code, loss.name) for loss in losses]
    assert found["format"] == "mjcf"
    assert found["closes"] is True
    places = [each["file"] for each in found["losses"]]
    assert set(places) == {"four_bar.xml"}  # as given
    assert found["opened"] == [{"name": "pin", "position": pytest.approx(0.01), "angle": 0.0}]
    assert main(["import", "four_bar.xml", "-o", "other", "--json", "--strict"]) == 1
    refused = json.loads(capsys.readouterr().out)
    jsonschema.Draft202012Validator(output_schemas()["import.schema.json"]).validate(refused)
    assert "it has losses" in refused["refused"]
    assert [each["code"] for each in refused["losses"]] == [each["code"] for each in found["losses"]]
    assert [each["file"] for each in refused["losses"]] == places


def test_strict_refuses_losses(here: Path, capsys: pytest.CaptureFixture[str]) -> None:
    assert main(["import", "four_bar.xml", "-o", "out", "--strict"]) == 1
    out, err = capsys.readouterr()
    assert "import-softness" in out
    assert "nothing was written: cannot import 'four_bar.xml': it has losses" in err
    assert not (here / "out").exists()


def test_file_with_an_error_is_refused(here: Path, capsys: pytest.CaptureFixture[str]) -> None:
    (here / "bad.xml").write_text("<mujoco><worldbody>")
    assert main(["import", "bad.xml", "-o", "out"]) == 1
    out, err = capsys.readouterr()
    assert out == ""
    assert err.startswith("nothing was written: cannot import 'bad.xml': bad.xml:1: ")
    assert not (here / "out").exists()


def test_missing_file_and_unknown_format_are_refused(capsys: pytest.CaptureFixture[str]) -> None:
    assert main(["import", "gone.xml", "-o", "out"]) == 2
    assert "'gone.xml' is not a file" in capsys.readouterr().err
    with pytest.raises(ValueError, match=r"there is no format 'mjfc'; did you mean 'mjcf'\?"):
        eurdf.import_robot("four_bar.xml", format="mjfc")


def test_missing_mujoco_is_an_error(capsys: pytest.CaptureFixture[str], monkeypatch: pytest.MonkeyPatch) -> None:
    from eurdf.convert.mjcf import compiled as mjcf_model

    monkeypatch.setattr(mjcf_model, "find_spec", lambda name: None)
    assert main(["import", "four_bar.xml", "-o", "out"]) == 2
    assert re.search(
        r"MuJoCo, which reads it, is not installed; install it with: .*\[mujoco\]", capsys.readouterr().err
    )


def test_mujoco_is_not_imported_by_the_caller(here: Path) -> None:
    import subprocess

    program = "import eurdf, sys; eurdf.import_robot('four_bar.xml'); sys.exit('mujoco' in sys.modules)"
    assert subprocess.run([sys.executable, "-c", program], check=False).returncode == 0


WITH_ERRORS = """<sdf version="1.11"><model name="r">
<link name="a"><inertial><mass>-1</mass></inertial></link>
<link name="b"><inertial><mass>1</mass><inertia><ixx>-3</ixx><iyy>1</iyy><izz>1</izz></inertia></inertial></link>
<joint name="j" type="revolute"><parent>a</parent><child>b</child><axis><xyz>0 0 1</xyz></axis></joint>
</model></sdf>"""


def test_robot_with_errors_is_written_and_they_are_shown(here: Path, capsys: pytest.CaptureFixture[str]) -> None:
    (here / "r.sdf").write_text(WITH_ERRORS)
    assert main(["import", "r.sdf", "-o", "out"]) == 1
    out = capsys.readouterr().out
    assert "link 'a' has the negative mass -1 kg [negative-mass EU-INR-001]" in out
    assert "out: 2 errors" in out
    checked = eurdf.check("out").diagnostics
    found = eurdf.import_robot("r.sdf")
    assert [(each.code, each.line) for each in found.errors] == [(each.code, each.line) for each in checked]
    assert {each.file for each in found.errors} == {"robot.urdf"}

    assert main(["import", "r.sdf", "-o", "other", "--json"]) == 1
    info = json.loads(capsys.readouterr().out)
    jsonschema.Draft202012Validator(output_schemas()["import.schema.json"]).validate(info)
    assert [each["file"] for each in info["diagnostics"]] == ["other/robot.urdf"] * 2

    assert main(["import", "r.sdf", "-o", "strict", "--strict"]) == 1
    out, err = capsys.readouterr()
    assert "negative-mass" in out
    assert "nothing was written: cannot import 'r.sdf': the robot has errors" in err
    assert not (here / "strict").exists()


@pytest.mark.parametrize(
    ("name", "content", "message"),
    [
        (
            "zero_axis.urdf",
            '<robot name="r"><link name="a"/><link name="b"/>\n<joint name="j" type="fixed"><parent link="a"/><child '
            'link="b"/></joint>\n<loop_joint name="l" type="revolute"><link1 link="a" xyz="0 0 0" rpy="0 0 0"/><link2 '
            'link="b" xyz="0 0 0" rpy="0 0 0"/>\n<axis xyz="0 0 0"/></loop_joint></robot>',
            "zero_axis.urdf:4: 'xyz' of <axis> is '0 0 0'; an axis must not be zero",
        ),
        ("inf.sdf", WITH_ERRORS.replace("-3", "inf"), "inf.sdf:3: <ixx> is 'inf'; it must be one finite number"),
        (
            "keyframe.xml",
            '<mujoco><worldbody><body><joint name="j"/><geom size=".1"/></body></worldbody>\n'
            '<keyframe><key qpos="nan"/></keyframe></mujoco>',
            "the coordinates of 'j' are nan; they must be finite",
        ),
        (
            "site.xml",
            '<mujoco><worldbody><body><joint/><geom size=".1"/>\n<site name="s" quat="1 1e308 0 0"/></body></worldbody>'
            "</mujoco>",
            "site.xml:2: site 's' has the quaternion 0 0 0 0; its length must be finite, and not zero",
        ),
        (
            "axis.xml",
            '<mujoco><worldbody><body><joint name="j" axis="1e308 1e308 0"/><geom size=".1"/></body></worldbody>'
            "</mujoco>",
            "joint 'j' has the axis 0 0 0; its length must be finite, and not zero",
        ),
    ],
)
def test_number_that_no_description_has_is_refused(
    name: str, content: str, message: str, here: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    (here / name).write_text(content)
    assert main(["import", name, "-o", "out"]) == 1
    err = capsys.readouterr().err
    assert message in err
    assert err.count("\n") == 1
    assert not (here / "out").exists()


def test_name_of_a_file_writes_no_line(here: Path) -> None:
    name = "a\nroot: floating #--.sdf"
    (here / name).write_text(WITH_ERRORS.replace("-1", "1").replace("-3", "1"))
    assert main(["import", name, "-o", "out"]) == 0
    assert eurdf.load("out", geometry=False).mechanism.root == "floating"  # as SDFormat has it, stated once
    yaml = (here / "out" / "robot.yaml").read_text()
    assert [line for line in yaml.splitlines() if line.startswith("root:")] == ["root: floating"]
    for file in ("robot.yaml", "robot.urdf", "README.md"):
        assert "\nroot: floating #" not in (here / "out" / file).read_text()


def test_damaged_files_are_refused_or_imported_as_they_are(tmp_path: Path) -> None:
    with Watched() as worker:
        outcomes = [worker.try_number(7, number, "import") for number in range(60)]
    assert not [outcome for outcome in outcomes if outcome.trouble]
    assert {outcome.kind for outcome in outcomes} == {f"import-{format_}" for format_ in IMPORTED}
    assert {"refused", "imported"} <= {outcome.word for outcome in outcomes}


def test_folder_is_imported_by_its_only_file(here: Path, capsys: pytest.CaptureFixture[str]) -> None:
    (here / "package.xml").write_text("<package/>")
    assert main(["import", ".", "-o", "out"]) == main(["import", "four_bar.xml", "-o", "same"]) == 0
    assert (here / "out/robot.yaml").read_text() == (here / "same/robot.yaml").read_text()
    (here / "other.sdf").write_text("<sdf/>")
    (here / "none").mkdir()
    capsys.readouterr()
    assert main(["import", ".", "-o", "out"]) == main(["import", "none", "-o", "out"]) == 2
    several, none = capsys.readouterr().err.splitlines()
    assert several.endswith("folder '.' contains 'four_bar.xml' and 'other.sdf'; name the file")
    assert none.endswith("folder 'none' contains no file of .xml, .sdf, .urdf, .usda, .usd; name the file")
    (here / "robot.xml").write_text("<mujoco>\n<worldbody>\n<nonsense/></worldbody></mujoco>")
    assert main(["import", ".", "-o", "out2"]) == 1  # as `eurdf export` names it
    assert "cannot import 'robot.xml'" in capsys.readouterr().err
