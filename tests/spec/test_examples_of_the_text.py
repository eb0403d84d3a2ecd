"""Every example in the specification is what it says it is, and every diagnostic is given by the edit that shows it."""

from __future__ import annotations

from pathlib import Path

import pytest

from eurdf.diagnostics import REGISTRY
from spec.site.blocks import Directive
from spec.site.clause import read_chapters
from spec.site.example import (
    EXAMPLES,
    Example,
    NotAnEdit,
    ShownDiagnostic,
    diagnostic_of,
    read_diagnostics,
    read_examples,
    with_elements,
    with_keys,
)

CHAPTERS = read_chapters()
SHOWN = read_diagnostics(CHAPTERS)
BY_EDIT = [shown for shown in SHOWN if shown.diff is not None]


def _where(shown: Example | ShownDiagnostic) -> str:
    return f"{shown.chapter}:{shown.line}-{shown.code or 'valid'}"


@pytest.mark.parametrize("example", read_examples(CHAPTERS), ids=_where)
def test_example_gives_exactly_its_diagnostic(example: Example) -> None:
    outcome = example.shown().check()
    assert outcome.codes == example.expected, outcome.text


@pytest.mark.parametrize("shown", BY_EDIT, ids=_where)
def test_diagnostic_edit_gives_only_that_diagnostic(shown: ShownDiagnostic) -> None:
    outcome = shown.faulty().check()
    assert outcome.codes == (shown.code,), outcome.text


@pytest.mark.parametrize("shown", BY_EDIT, ids=_where)
def test_unedited_example_is_valid(shown: ShownDiagnostic) -> None:
    outcome = shown.sound().check()
    assert outcome.codes == (), outcome.text


def test_every_diagnostic_is_shown() -> None:
    shown = [one.code for one in SHOWN]
    assert [code for code in REGISTRY if code not in shown] == []


@pytest.mark.parametrize("folder", sorted(EXAMPLES.iterdir()), ids=lambda folder: folder.name)
def test_every_example_robot_is_used(folder: Path) -> None:
    used = {shown.robot for shown in SHOWN} | {example.robot for example in read_examples(CHAPTERS)}
    assert folder.name in used


BASE = """\
# a robot
extended_urdf: "2.0"
closures:
- name: pin
  type: 3d

"joints": {}
"""


def test_fragment_replaces_its_keys() -> None:
    fragment = "actuators: [motor]\nclosures: []\n"
    assert with_keys(BASE, fragment) == (
        '# a robot\nextended_urdf: "2.0"\nclosures: []\n"joints": {}\nactuators: [motor]\n'
    )


def test_elements_are_appended_to_urdf() -> None:
    assert with_elements('<robot name="a">\n</robot>\n', "<link/>\n") == '<robot name="a">\n<link/>\n</robot>\n'


def _directive(name: str, argument: str, body: str, **options: str) -> Directive:
    return Directive(1, name, argument, options, body, 2)


DIFF = """\
```diff
     type: 3d
-    frames: [coupler_tip, rocker_tip]
+    frames: [coupler_tpi, rocker_tip]
```
A name is misspelt.

Twice.
"""


def test_edit_knows_its_changed_lines() -> None:
    edit = diagnostic_of(_directive("diagnostic", "unknown-frame", DIFF), "here").edit()
    before, after = edit.before.split("\n"), edit.after.split("\n")
    assert (edit.removed, edit.added) == (1, 1)
    assert before[edit.start] == "    frames: [coupler_tip, rocker_tip]"
    assert after[edit.start] == "    frames: [coupler_tpi, rocker_tip]"
    assert before[: edit.start] == after[: edit.start]


@pytest.mark.parametrize(
    ("diff", "why"),
    [
        ("-nothing like it\n+something", "occur 0 times"),
        ('-    <axis xyz="0 0 1"/>\n+    <axis xyz="0 0 2"/>', "not once"),
        ("+something", "needs a line"),
        ("@@ -1 +1 @@\n-a\n+b", "must begin with"),
    ],
)
def test_impossible_diff_is_no_edit(diff: str, why: str) -> None:
    shown = diagnostic_of(_directive("diagnostic", "xml-syntax", f"```diff\n{diff}\n```", file="robot.urdf"), "here")
    with pytest.raises(NotAnEdit, match=why):
        shown.edit()


def test_diagnostic_text_excludes_its_diff() -> None:
    shown = diagnostic_of(_directive("diagnostic", "unknown-frame", DIFF), "here")
    assert shown.text == "A name is misspelt.\n\nTwice."
