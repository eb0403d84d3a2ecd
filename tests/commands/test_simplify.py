"""`eurdf simplify`: output and files; and the note of `eurdf check`."""

from __future__ import annotations

import json
from pathlib import Path

import jsonschema
import pytest

import eurdf
from eurdf.commands.main import main
from eurdf.commands.output import output_schemas


def test_command_writes_nothing_over_files(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    out = str(tmp_path / "out")
    assert main(["simplify", "talos_leg"]) == 0
    shown, notes = capsys.readouterr()
    assert "velocities            13     10" in shown
    assert "closure 'rod' is 3d" in notes
    assert main(["simplify", "talos_leg", "-o", out]) == 0
    assert eurdf.check(out).diagnostics == ()
    capsys.readouterr()
    assert main(["simplify", "talos_leg", "-o", out]) == 2
    assert "--force replaces it" in capsys.readouterr().err
    assert main(["simplify", "talos_leg", "-o", out, "--force", "--json"]) == 0
    found = json.loads(capsys.readouterr().out)
    jsonschema.Draft202012Validator(output_schemas()["simplify.schema.json"]).validate(found)
    assert found["before"] == {"nv": 13, "nc": 6}
    assert len(found["files"]) == 3
    assert main(["simplify", "four_bar", "-o", str(tmp_path / "none")]) == 0
    assert "nothing to simplify" in capsys.readouterr().out
    assert not (tmp_path / "none").exists()


def test_check_notes_what_is_saved(capsys: pytest.CaptureFixture[str]) -> None:
    (note,) = eurdf.check("talos_leg").notes
    assert "without 3 of 13 velocities and 3 of 6 constraint rows" in note
    assert main(["check", "talos_leg"]) == 0
    assert f"note: {note}" in capsys.readouterr().out
    assert eurdf.check("four_bar").notes == ()
