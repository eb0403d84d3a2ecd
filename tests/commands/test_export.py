"""`eurdf export` and `eurdf.export`: files, losses, refusals."""

from __future__ import annotations

import json
import os
import re
from pathlib import Path

import jsonschema
import pytest

import eurdf
from eurdf.commands.main import main
from eurdf.commands.output import output_schemas
from eurdf.convert.export_format import export_format
from eurdf.convert.formats import EXPORTS
from eurdf.convert.losses import ELEMENTS, Effect
from eurdf.convert.table import page_of, written
from eurdf.writing.output_folder import write_files
from support.places import ROBOTS, ROOT

pytestmark = pytest.mark.usefixtures("folder")


@pytest.mark.parametrize("name", EXPORTS)
def test_losses_are_registered_well(name: str) -> None:
    codes = [kind.code for kind in export_format(name).rows]
    assert len(set(codes)) == len(codes)
    for kind in export_format(name).rows:
        assert kind.concept in ELEMENTS
        assert re.fullmatch("export(-[a-z0-9]+)+", kind.code)
        assert kind.title
        assert kind.hint
        assert bool(kind.error) == (kind.effect is Effect.APPROXIMATE)


def test_files_are_written_to_a_folder_named_after_the_robot(folder: Path, capsys: pytest.CaptureFixture[str]) -> None:
    assert main(["export", "four_bar", "--to", "mjcf"]) == 0
    out, err = capsys.readouterr()
    assert [path.name for path in folder.rglob("*")] == ["four_bar_mjcf", "robot.xml"]
    assert err == f"wrote '{Path('four_bar_mjcf/robot.xml')}'\n"
    (closure,) = eurdf.load("four_bar", geometry=False).constraints
    assert re.search(rf"robot\.yaml:\d+: '{closure.name}': becomes a 'connect'", out)
    assert "3d closure: approximate [export-soft-3d]" in out


@pytest.mark.parametrize(("name", "to"), [("kangaroo_leg", "mjcf"), ("excavator", "urdf")])
def test_json_lists_every_loss_with_its_place(capsys: pytest.CaptureFixture[str], name: str, to: str) -> None:
    assert main(["export", name, "--to", to, "--json"]) == 0
    found = json.loads(capsys.readouterr().out)
    jsonschema.Draft202012Validator(output_schemas()["export.schema.json"]).validate(found)
    assert (found["format"], found["refused"]) == (to, None)
    assert all(Path(file).is_file() for file in found["files"])
    losses = eurdf.export(name, to).losses
    assert [(each["code"], each["name"]) for each in found["losses"]] == [(loss.code, loss.name) for loss in losses]
    motors = {motor.name: joint for joint, motor in eurdf.load(name, geometry=False).mechanism.motors.items()}
    for each in found["losses"]:
        if each["concept"] in ("velocity limit", "actuator"):
            joint = motors.get(each["name"], each["name"])
            assert f'<joint name="{joint}"' in Path(each["file"]).read_text().splitlines()[each["line"] - 1]


def test_strict_refuses_losses(folder: Path, capsys: pytest.CaptureFixture[str]) -> None:
    assert main(["export", "four_bar", "--to", "mjcf", "--strict", "--json"]) == 1
    found = json.loads(capsys.readouterr().out)
    jsonschema.Draft202012Validator(output_schemas()["export.schema.json"]).validate(found)
    assert (found["files"], found["refused"]) == ([], "nothing was written: --strict refuses losses")
    assert main(["export", "four_bar", "--to", "mjcf", "--strict"]) == 1
    out, err = capsys.readouterr()
    assert "export-soft-3d" in out
    assert "nothing was written: --strict refuses losses" in err
    assert not list(folder.iterdir())
    with pytest.raises(eurdf.errors.CannotExport) as refused:
        eurdf.export("four_bar", "mjcf", strict=True)
    assert refused.value.losses


def test_unknown_configuration_is_refused(capsys: pytest.CaptureFixture[str]) -> None:
    assert main(["export", "four_bar", "--to", "mjcf", "--configuration", "asembled"]) == 2
    assert "there is no configuration 'asembled'; did you mean 'assembled'?" in capsys.readouterr().err


def test_unknown_format_is_refused() -> None:
    with pytest.raises(ValueError, match=r"there is no format 'mjfc'; did you mean 'mjcf'\?"):
        eurdf.export("four_bar", "mjfc")


def test_loop_of_another_dialect_is_not_lost_in_silence(folder: Path, capsys: pytest.CaptureFixture[str]) -> None:
    text = '<robot name="r"><link name="base"/><loop_joint name="pin" type="revolute"/></robot>'
    (folder / "isaac.urdf").write_text(text, encoding="utf-8")
    assert main(["export", "isaac.urdf", "--to", "mjcf", "--json"]) == 0
    captured = capsys.readouterr()
    assert "isaac.urdf:1:36: warning: <loop_joint>" in captured.err
    assert "eurdf import" in captured.err
    assert json.loads(captured.out)["refused"] is None


def test_name_of_the_robot_leads_to_no_other_folder(folder: Path) -> None:
    (folder / "robot.urdf").write_text('<robot name="../../x y"><link name="a"/></robot>')
    assert main(["export", "robot.urdf", "--to", "mjcf"]) == 0
    assert (folder / "_.._x_y_mjcf" / "robot.xml").is_file()


def test_robot_without_assembled_gets_a_closed_keyframe(folder: Path) -> None:
    source = ROBOTS / "four_bar"
    text = re.sub(r"(?m)^configurations:\n(  .*\n)+", "", (source / "robot.yaml").read_text())
    assert "assembled" not in text
    given = eurdf.load(text, urdf=(source / "robot.urdf").read_text())
    export = eurdf.export(given, "mjcf")
    (key,) = re.findall(rb'<key name="assembled" qpos="(.*?)"', export.main)
    q = export.coordinates.from_q([float(value) for value in key.split()])
    assert abs(eurdf.residual(given, q)).max() < 1e-9


@pytest.mark.parametrize("name", ["../a", "link/a"])
def test_nothing_is_written_outside_the_folder(folder: Path, name: str) -> None:
    (folder / "out").mkdir()
    (folder / "away").mkdir()
    (folder / "out" / "link").symlink_to(folder / "away")
    with pytest.raises(PermissionError, match="is outside the folder"):
        write_files(folder / "out", {name: b"1"}, force=True)
    assert not list((folder / "away").iterdir())
    assert sorted(os.listdir(folder)) == ["away", "out"]


def test_tables_of_losses_are_current() -> None:
    docs = ROOT / "docs"
    for page, text in written(docs).items():
        assert page.read_text(encoding="utf-8") == text
    for name, each in ((name, export_format(name)) for name in EXPORTS):
        page = (docs / page_of(name)).read_text(encoding="utf-8")
        assert [kind.code for kind in each.rows if f"`{kind.code}`" not in page] == []
