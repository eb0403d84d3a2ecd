"""To add a requirement, write its row, its function and where that is called: every report has it at once.

The row names its clause, which gets an id in `spec/`, with a ``{diagnostic}`` in ``spec/diagnostics.md``. Add a row to
``tests/linking/test_link.py`` and cases to the suite, then run ``python -m spec.site.registry`` and
``python -m spec.site.lint``. The function has the id in its docstring: the page of the clause shows it.
"""

from __future__ import annotations

import contextlib
import io
import json
from pathlib import Path

import jsonschema

import eurdf
from eurdf.commands.main import main
from eurdf.diagnostics.report import report_schema
from support.changed_package import run_with
from support.described import body, revolute, written
from support.plain_urdf import robot

RULE = (
    (
        "diagnostics/registry.py",
        "closure-same-frame         EU-CLO-002",
        "closure-name-space         EU-CLO-099 warning The name of a closure contains a space.\n",
    ),
    (
        "linking/closures.py",
        "def _compliance(",
        '''\
def _is_one_word(entry: ClosureEntry, reporter: YamlReporter) -> None:
    """EU-CLO-099: the name of a closure has no space."""
    if " " in entry.name:
        hint = "write '_' in its place"
        message = f"the name of closure '{entry.name}' contains a space"
        reporter.report("closure-name-space", message, (*entry.pointer, "name"), hint)


''',
    ),
    (
        "linking/closures.py",
        "        a, b = map(names.find, entry.frames)\n",
        "        _is_one_word(entry, reporter)\n",
    ),
)

URDF = robot(body("base"), body("one"), body("two"), revolute("j1", "base", "one"), revolute("j2", "one", "two"))
YAML = """extended_urdf: "2.1"
closures:
  - {name: the pin, type: 3d, frames: [two, base]}
"""


def test_row_and_function_are_all_that_a_rule_needs(tmp_path: Path) -> None:
    folder = written(tmp_path, URDF, YAML)
    program = "import sys, test_add_a_rule as recipe; recipe.show(sys.argv[1])"
    run_with(tmp_path, RULE, "-c", program, folder)


def show(path: str) -> None:
    """What a parser that has the rule reports of a file that violates it."""
    (found,) = [each for each in eurdf.check(path).diagnostics if each.code == "closure-name-space"]
    assert (found.severity, found.clause, found.line, found.column) == ("warning", "EU-CLO-099", 3, 12)
    assert (found.pointer, found.hint) == ("/closures/0/name", "write '_' in its place")
    for format_ in ("json", "sarif", "text"):
        with contextlib.redirect_stdout(io.StringIO()) as out:
            main(["check", path, "--format", format_])
        assert "closure-name-space" in out.getvalue()
        if format_ == "json":
            jsonschema.validate(json.loads(out.getvalue()), report_schema())
