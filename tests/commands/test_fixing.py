"""``eurdf check --fix`` and ``--diff``: what they change, and what they leave alone."""

from __future__ import annotations

import io
import json
import shutil
from pathlib import Path

import pytest

from commands.conftest import Run
from eurdf.commands.fixing import fixing
from eurdf.errors import CannotRun
from support.described import ARM as URDF
from support.described import body
from support.places import ROBOTS
from support.plain_urdf import joint_element, link_element
from support.plain_urdf import robot as robot_element

RIGHT = '# An arm.\nextended_urdf: "2.0"\nactuators: [shoulder]  # one\n'
BROKEN = URDF.replace("continuous", "continous")
WRONG = RIGHT.replace('"2.0"', "2.0").replace("shoulder", "sholder")


def arm(folder: Path, description: str = WRONG, urdf: str = URDF) -> Path:
    folder.mkdir(parents=True, exist_ok=True)
    (folder / "robot.urdf").write_bytes(urdf.encode())
    (folder / "robot.yaml").write_bytes(description.encode())
    return folder / "robot.yaml"


def test_fixes_of_both_files_leave_the_rest_as_it_is(folder: Path, run: Run) -> None:
    right = URDF.replace("\n", "\r\n")
    file = arm(folder / "arm", "\ufeff" + WRONG.replace("\n", "\r\n"), BROKEN.replace("\n", "\r\n"))
    code, out, err = run("check", "arm", "--fix")
    assert (code, err) == (0, "")
    assert out.splitlines()[-1] == "arm: valid"
    assert "fixed arm/robot.yaml:3:13: write 'shoulder' [unknown-actuator]" in out
    assert file.read_bytes().decode() == "\ufeff" + RIGHT.replace("\n", "\r\n")
    assert file.with_suffix(".urdf").read_bytes().decode() == right


def test_diff_shows_changes_and_makes_none(folder: Path, run: Run) -> None:
    file = arm(folder / "arm")
    code, out, err = run("check", "arm", "--diff")
    assert (code, err) == (0, "")
    assert out.splitlines()[:2] == ["--- arm/robot.yaml", "+++ arm/robot.yaml"]
    assert [line for line in out.splitlines()[2:] if line[0] in "+-"] == [
        *("-extended_urdf: 2.0", "-actuators: [sholder]  # one"),
        *('+extended_urdf: "2.0"', "+actuators: [shoulder]  # one"),
    ]
    assert file.read_text() == WRONG
    assert run("check", "arm", "--diff", "--format", "json")[0] == 2


def test_report_has_edits_of_each_fix(folder: Path, run: Run) -> None:
    arm(folder / "arm", RIGHT.replace("shoulder", "sholder"))
    (found,) = json.loads(run("check", "arm", "--format", "json")[1])["robots"][0]["diagnostics"]
    edit = {"file": "arm/robot.yaml", "line": 3, "column": 13, "end_line": 3, "end_column": 20, "text": "shoulder"}
    assert found["fix"] == {"summary": "write 'shoulder'", "edits": [edit]}
    code, out, err = run("check", "arm", "--fix", "--format", "json")
    assert (code, json.loads(out)["robots"][0]["diagnostics"]) == (0, [])
    assert err.startswith("fixed ")


def test_name_with_two_likely_meanings_is_a_question(folder: Path, run: Run) -> None:
    joints = [joint_element(f"hinge_{side}", "continuous", "base", f"arm_{side}") for side in "ab"]
    urdf = robot_element(link_element("base"), body("arm_a"), body("arm_b"), *joints)
    description = RIGHT.replace("shoulder", "hinge_c")
    file = arm(folder / "arm", description, urdf)
    code, out, _ = run("check", "arm", "--fix")
    assert code == 1
    assert "= hint: did you mean 'hinge_" in out
    assert file.read_text() == description


def test_frame_is_the_one_that_closes_the_loop(folder: Path, run: Run) -> None:
    shutil.copytree(ROBOTS / "digit_leg", "leg", ignore=shutil.ignore_patterns("*.png", "*.py"))
    file, right = Path("leg/robot.yaml"), Path("leg/robot.yaml").read_text()
    file.write_text(right.replace("[rod1_a, rod1_b]", "[rod1_a, rod1_c]"))  # rod1_a is as near
    assert run("check", "leg", "--fix")[0] == 0
    assert file.read_text() == right


@pytest.mark.parametrize("given", ["four_bar", str(ROBOTS / "four_bar"), "-", RIGHT])
def test_what_is_no_file_of_the_user_is_refused(
    folder: Path, run: Run, given: str, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr("sys.stdin", io.TextIOWrapper(io.BytesIO(WRONG.encode())))
    code, out, err = run("check", given, "--fix")
    assert (code, out) == (2, "")
    assert "robot of the collection" in err or "change files" in err


def test_urdf_elsewhere_is_changed_only_if_it_is_given(folder: Path, run: Run) -> None:
    arm(folder / "other", urdf=BROKEN)
    file = arm(folder / "arm", 'extended_urdf: "2.0"\nurdf: ../other/robot.urdf\nactuators: [shoulder]\n')
    before = (folder / "other" / "robot.urdf").read_text()
    run("check", file, "--fix")
    assert (folder / "other" / "robot.urdf").read_text() == before
    run("check", file, "--fix", "--urdf", "other/robot.urdf")
    assert (folder / "other" / "robot.urdf").read_text() == URDF


def test_nothing_is_written_if_one_file_has_changed(folder: Path) -> None:
    file = arm(folder / "arm", urdf=BROKEN)
    done = fixing("arm")
    assert set(done.texts) == {"arm/robot.yaml", "arm/robot.urdf"}
    file.with_suffix(".urdf").write_text(URDF)
    with pytest.raises(CannotRun, match=r"changed 'arm/robot\.urdf' in the meantime"):
        done.write()
    assert file.read_text() == WRONG


def test_joint_listed_twice_may_be_another_one(folder: Path, run: Run) -> None:
    joints = [joint_element(f"{side}_hinge", "continuous", "base", f"{side}_arm") for side in ("left", "right")]
    urdf = robot_element(link_element("base"), body("left_arm"), body("right_arm"), *joints)
    file = arm(folder / "arm", RIGHT.replace("[shoulder]", "[left_hinge, left_hinge]"), urdf)
    before = file.read_text()
    assert run("check", "arm", "--fix")[0] == 1
    assert file.read_text() == before
    file.write_text(before.replace("left_hinge, left_hinge", "left_hinge, right_hinge, left_hinge"))
    assert run("check", "arm", "--fix")[0] == 0
    assert "[left_hinge, right_hinge]" in file.read_text()
