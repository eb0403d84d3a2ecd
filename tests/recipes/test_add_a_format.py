"""To add a format to export to, write its module and its name: the command, the losses and the tables know it at once.

Its page, ``docs/export_FORMAT.md``, gets its table from ``python -m eurdf.convert.table docs``. Many facts
go into a ``facts.py`` beside it, and what reads it back for ``--verify`` is a class in `eurdf.convert.verification`. A
format to import from is the module ``read.py`` of such a folder, and its line in `eurdf.reading.other_formats`.
"""

from __future__ import annotations

import json
from pathlib import Path
from typing import Any

import pytest

import eurdf
from eurdf.commands.main import main
from eurdf.convert.table import details, overview
from eurdf.errors import CannotExport
from support.changed_package import run_with

ROBOTS = Path(__file__).parents[2] / "robots"

FORMAT = (
    ("convert/formats.py", '"mjcf", "usd"', '"loop-table", '),
    ("convert/loop_table/__init__.py", "", '"""URDF with a table of its loops."""\n'),
    (
        "convert/loop_table/write.py",
        "",
        '''\
"""URDF with a table of its ball joints in loops."""

from eurdf.convert.export_format import ExportInput, ExportOutput, Format
from eurdf.convert.losses import Losses
from eurdf.convert.urdf.facts import EXACT, PLAIN_ROWS
from eurdf.convert.urdf.write import PlainTree


def write(given: ExportInput, losses: Losses) -> ExportOutput:
    """Write the URDF of a robot, and a line for each closure."""
    tree = PlainTree(given, losses)
    tree.write()
    urdf = tree.output()
    lines = [f"{each.name},{each.a.body},{each.b.body}" for each in given.mechanism.closures if each.type == "3d"]
    return ExportOutput({**urdf.files, "loops.csv": "\\n".join(lines).encode()}, urdf.coordinates)


FORMAT = Format(write, PLAIN_ROWS, (*EXACT, "3d closure"))
''',
    ),
)


def test_module_and_name_are_all_that_a_format_needs(tmp_path: Path) -> None:
    program = "import sys, test_add_a_format as recipe; from pathlib import Path; recipe.show(Path(sys.argv[1]))"
    found = json.loads(run_with(tmp_path, FORMAT, "-c", program, tmp_path).splitlines()[-1])
    assert found == {"delta": [], "digit_leg": ["6d", "6d", "6d"], "double_wishbone": found["double_wishbone"]}
    assert found["double_wishbone"]


def show(folder: Path) -> None:
    """What the package does with the format; prints the losses of closures."""
    lost: dict[str, Any] = {}
    for name in ("delta", "digit_leg", "double_wishbone"):
        export = eurdf.export(ROBOTS / name, "loop-table")
        closures = {closure.name: closure.type for closure in export.robot.mechanism.closures}
        of_closures = [loss for loss in export.losses if loss.name in closures]
        assert {loss.code for loss in of_closures} <= {"export-closure-kind"}
        assert all(f"'{closures[loss.name]}'" in loss.message for loss in of_closures)
        lost[name] = [closures[loss.name] for loss in of_closures]
        balls = [name for name, kind in closures.items() if kind == "3d"]
        assert [line.split(",")[0] for line in export.files["loops.csv"].decode().split()] == balls
    with pytest.raises(CannotExport, match="has losses in the format loop-table"):
        eurdf.export(ROBOTS / "digit_leg", "loop-table", strict=True)
    assert main(["export", str(ROBOTS / "delta"), "--to", "loop-table", "-o", str(folder / "delta")]) == 0
    assert (folder / "delta" / "loops.csv").exists()
    assert "export_loop_table.md" in overview()
    assert details("loop-table")
    print(json.dumps(lost))  # noqa: T201 - to the test
