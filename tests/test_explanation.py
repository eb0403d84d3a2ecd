"""`eurdf.explain`: by subject what is wrong with a robot, and how it moves."""

from __future__ import annotations

import json
import shutil
from pathlib import Path

import jsonschema
import pytest

import eurdf
from eurdf.advice.passive import PassiveMotions
from eurdf.commands.main import main
from eurdf.commands.output import output_schemas
from support.places import ROBOTS


def leg(folder: Path, old: str, new: str) -> Path:
    """The leg of Digit with an edit of its description."""
    shutil.copytree(ROBOTS / "digit_leg", folder, ignore=shutil.ignore_patterns("*.png", "*.py"), dirs_exist_ok=True)
    file = folder / "robot.yaml"
    text = file.read_text(encoding="utf-8")
    assert old in text
    file.write_text(text.replace(old, new), encoding="utf-8")
    return folder


@pytest.mark.parametrize("name", ["four_bar", "digit_leg", "robotiq_2f85"])
def test_facts_of_a_valid_robot_are_those_of_the_analysis(name: str) -> None:
    robot = eurdf.load(name, geometry=False)
    analysis = eurdf.analyze(robot)
    said = {topic.subject: topic.facts for topic in eurdf.explain(name).topics}
    assert said == {topic.subject: topic.facts for topic in eurdf.explain(robot).topics}
    assert said["motions"][0].startswith(f"{analysis.mobility} motion")
    assert said["motions"][0].endswith(f"decide {analysis.controlled}")
    spins = [fact for fact in said["motions"] if fact.endswith("needs no actuator")]
    needing = PassiveMotions(robot).all_needing_actuators(analysis)
    assert len(spins) + len(needing) == analysis.uncontrolled
    assert said["actuators"] == ("no actuator depends on the others",)


def test_causes_are_the_diagnostics_of_a_check(tmp_path: Path) -> None:
    folder = leg(tmp_path, "motor_knee, ", "")
    found = eurdf.explain(folder)
    report = eurdf.check(folder)
    assert found.diagnostics == report.diagnostics != ()
    causes = {cause.code: topic.subject for topic in found.topics for cause in topic.causes}
    assert causes == {"x-uncontrolled-motion": "motions"}
    assert "x-uncontrolled-motion" in str(found)


def test_invalid_robot_is_explained_without_facts(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    folder = leg(tmp_path, "type: 6d", "type: 6D")
    (topic,) = eurdf.explain(folder).topics
    assert (topic.subject, topic.facts) == ("files", ())
    assert [(cause.hint, cause.certain) for cause in topic.causes] == [("write '6d'", True)] * 3
    assert main(["explain", str(folder)]) == 1
    assert "fix: write '6d'" in capsys.readouterr().out
    assert main(["explain", str(folder), "--json"]) == 1
    schema = output_schemas()["explain.schema.json"]
    jsonschema.Draft202012Validator(schema).validate(json.loads(capsys.readouterr().out))
