"""The case that CONTRIBUTING adds from beginning to end."""

from __future__ import annotations

import re
import shlex
import shutil
import subprocess
import sys
from pathlib import Path

import pytest

from eurdf_conformance.corpus import lint, show
from eurdf_conformance.corpus.read import CASES
from eurdf_conformance.strict_yaml import load_strictly
from support.places import ROOT

SECTION = (ROOT / "CONTRIBUTING.md").read_text(encoding="utf-8").partition("\n## A case for the suite\n")[2]
SECTION = SECTION.partition("\n## ")[0]
NAME = "urdf/damping-fortran-exponent"


def blocks(language: str) -> list[str]:
    return re.findall(rf"^```{language}\n(.*?)^```$", SECTION, re.DOTALL | re.MULTILINE)


def command(program: str) -> tuple[list[str], str]:
    """The arguments of a shown command, and its output."""
    (found,) = [block for block in blocks("console") if block.startswith(f"$ {program}")]
    line, _, output = found.partition("\n")
    return shlex.split(line.removeprefix(f"$ {program}")), output


def same(shown: str, given: str) -> bool:
    """Whether an output is as shown, where … is any text."""
    return re.fullmatch(".*?".join(map(re.escape, shown.split("…"))), given, re.DOTALL) is not None


def test_lint_reports_what_the_shown_case_lacks(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    (text,) = blocks("yaml")
    assert f"cases/{NAME}.yaml`" in SECTION
    (tmp_path / "urdf").mkdir()
    for path in (CASES / "urdf").glob("every-element*"):  # the twin, and its base
        shutil.copyfile(path, tmp_path / "urdf" / path.name)
    path = tmp_path / f"{NAME}.yaml"
    path.write_text(text, encoding="utf-8")
    assert lint.main([str(tmp_path)]) == 1
    # Most clauses have no case among these.
    given = re.sub(r"missing: .*\n", "", capsys.readouterr().out)
    shown = command("python -m eurdf_conformance.corpus.lint")[1]
    assert same(shown.replace("0 clauses", "… clauses"), given), given
    added = text.replace("clauses: [", "clauses: [EU-URD-007, ")
    path.write_text(added, encoding="utf-8")
    assert lint.main([str(tmp_path)]) == 0
    assert load_strictly(added) == load_strictly((CASES / f"{NAME}.yaml").read_text(encoding="utf-8"))


def test_show_prints_the_shown_case(capsys: pytest.CaptureFixture[str]) -> None:
    arguments, shown = command("python -m eurdf_conformance.corpus.show")
    assert show.main(arguments) == 0
    assert capsys.readouterr().out == shown


@pytest.mark.slow
def test_run_of_the_shown_case_passes() -> None:
    arguments, shown = command("pytest")
    argv = [sys.executable, "-m", "pytest", *arguments, "-p", "no:cacheprovider"]
    done = subprocess.run(argv, cwd=ROOT, capture_output=True, text=True, timeout=120, check=False)
    assert same(shown.rstrip("\n"), done.stdout.rstrip("\n")), done.stdout
    assert done.returncode == 0
