"""What a parser is given says nothing of what is expected, and no parser changes what is expected of it."""

from __future__ import annotations

import os
import shlex
import shutil
import subprocess
import sys
from itertools import pairwise
from pathlib import Path
from types import SimpleNamespace
from typing import Any

import pytest

from eurdf_conformance.corpus.case import InvalidCase
from eurdf_conformance.corpus.read import CASES, all_cases
from eurdf_conformance.judging.conversation import Conversation
from eurdf_conformance.judging.handout import Handout
from eurdf_conformance.judging.judge import judge
from eurdf_conformance.judging.verdict import Verdict
from eurdf_conformance.level import Level
from eurdf_conformance.properties.harness import Harness
from eurdf_conformance.protocol.message import Accepted, Rejected
from eurdf_conformance.protocol.reply import accepted, rejected
from eurdf_conformance.runner.in_process import InProcess
from eurdf_conformance.suite import untouched
from eurdf_conformance.suite.options import OPTIONS, Options
from eurdf_conformance.suite.plugin import pytest_collection_modifyitems

ROOT = Path(__file__).parents[2]
ALL = all_cases()


class Peeking:
    """Reads no robot: it looks for what the suite says of the case, beside the files and where their path leads."""

    name, version, language, claims = "peeking", "1", "Python", {"1": [Level.ACCEPT], "2": [Level.ACCEPT]}

    def load(self, description: Path, urdf: Path) -> Accepted | Rejected:
        folders = [folder for folder in (*description.parents, *urdf.parents) if folder.name]
        said = [path for folder in folders for path in (folder / "case.yaml", folder.with_suffix(".yaml"))]
        said += [CASES / folder.parent.name / f"{folder.name}.yaml" for folder in folders]
        is_invalid = any(path.is_file() and "\nvalid: false" in path.read_text(encoding="utf-8") for path in said)
        return rejected("it is said to be") if is_invalid else accepted()


def test_parser_that_looks_up_the_case_is_not_certified() -> None:
    conversation = Conversation(InProcess(Peeking()))
    invalid = [case for case in ALL if isinstance(case.case, InvalidCase) and not case.case.either]
    assert {judge(case, Level.ACCEPT, conversation).verdict for case in invalid} == {Verdict.FAILED}


def test_parser_receives_the_files_of_the_case_and_nothing_else() -> None:
    handout = Handout()
    for case in ALL[::7]:
        description, urdf = handout.files(case)
        folder = description.parent
        found = {str(path.relative_to(folder)): path.read_bytes() for path in folder.rglob("*") if path.is_file()}
        assert found == case.files
        assert (description, urdf) == (folder / case.case.description, folder / case.case.urdf)


def test_folder_of_a_case_is_fresh_and_has_no_meaning() -> None:
    handout, seen = Handout(), set[Path]()
    case = next(case for case in ALL if case.name == "urdf/gantry")
    for _ in range(3):
        folder = handout.files(case)[0].parent
        assert not folder.exists() or folder not in seen
        assert not any(word in str(folder) for word in ("gantry", "urdf", case.id, "case", "cases"))
        assert not any(path.exists() for path in seen)  # nothing of an earlier case is left to compare with
        seen.add(folder)
    assert len(seen) == 3


def test_files_are_removed_with_the_handout() -> None:
    handout = Handout()
    folder = handout.files(ALL[0])[0].parent
    del handout
    assert not folder.exists()


def test_folder_of_a_random_mechanism_has_no_meaning(tmp_path: Path) -> None:
    from eurdf_conformance.properties.example import frozen_examples
    from eurdf_conformance.properties.query import query_of

    seen: list[Path] = []

    class Keeping(Peeking):
        def load(self, description: Path, urdf: Path) -> Accepted | Rejected:
            seen.append(description.parent)
            return accepted()

    for _ in range(2):
        harness = Harness(InProcess(Keeping()), tmp_path)
        harness.load(query_of(frozen_examples("2")[0].mechanism, "2"))
    assert len({folder.name for folder in seen}) == 2


# --- the order -------------------------------------------------------------------------------------------------------


def ordered(seed: int, **options: Any) -> list[str]:
    """The order in which items are asked."""
    folder = "conformance/eurdf_conformance/suite"
    ids = [f"{folder}/test_corpus.py::test_case[{case.name}/{level}]" for case in ALL[:60] for level in case.levels]
    ids += [f"{folder}/test_protocol.py::test_protocol[protocol/start-{version}/accept]" for version in "12"]
    items = [SimpleNamespace(nodeid=nodeid, name=nodeid.partition("::")[2]) for nodeid in ids]
    config = SimpleNamespace(stash={OPTIONS: Options(seed=seed, **options)})
    pytest_collection_modifyitems(config, items)  # type: ignore[arg-type]
    found = [item.nodeid.partition("[")[2].removesuffix("]") for item in items]
    assert sorted(found) == sorted(nodeid.partition("[")[2].removesuffix("]") for nodeid in ids)
    return found


def test_seed_decides_the_order_of_the_cases() -> None:
    assert ordered(1) == ordered(1)
    assert ordered(1) != ordered(2)
    names = list(dict.fromkeys(item.rpartition("/")[0] for item in ordered(1)))[2:]
    assert names != [case.name for case in ALL[:60]]


def test_protocol_is_first_and_levels_of_a_case_are_together() -> None:
    found = ordered(3)
    assert [item.startswith("protocol/") for item in found[:3]] == [True, True, False]
    names = [item.rpartition("/")[0] for item in found[2:]]
    assert sum(one != other for one, other in pairwise(names)) == len(set(names)) - 1


# --- the corpus ------------------------------------------------------------------------------------------------------


@pytest.fixture
def copied(tmp_path: Path) -> Path:
    """A copy of the suite with what it needs, to be damaged."""
    shutil.copytree(ROOT / "conformance", tmp_path / "conformance", ignore=shutil.ignore_patterns("__pycache__"))
    for name in ("spec", "LICENSE"):
        (tmp_path / name).symlink_to(ROOT / name)
    (tmp_path / "pytest.ini").write_text("[pytest]\n", encoding="utf-8")
    return tmp_path


#: A parser that makes the expectation of a case its own while it is asked, and may undo that.
TAMPERING = """
import json, pathlib, sys
path = pathlib.Path(sys.argv[1])
before = path.read_bytes()
for line in sys.stdin:
    request = json.loads(line)
    answer = {"start": {"outcome": "started", "protocol": "1.0", "claims": {"2": ["accept"]},
                        "parser": {"name": "tampering", "version": "1", "language": "Python"}},
              "load": {"outcome": "accepted", "robot": None, "issues": []},
              "stop": {"outcome": "stopped"}}[request["command"]]
    if request["command"] == "load":
        path.write_bytes(before + b" ")
        if "undo" in sys.argv:
            path.write_bytes(before)
    print(json.dumps({"id": request["id"], **answer}), flush=True)
"""


@pytest.mark.slow
@pytest.mark.parametrize(("program", "undo"), [("pytest", "undo"), ("eurdf", "keep")])
def test_run_with_a_changed_corpus_is_void(copied: Path, program: str, undo: str) -> None:
    (copied / "tampering.py").write_text(TAMPERING, encoding="utf-8")
    target = copied / "conformance/eurdf_conformance/corpus/cases/closures/parallelogram-3d-closure.expected.json"
    parser = "cmd:" + shlex.join([sys.executable, str(copied / "tampering.py"), str(target), undo])
    asked = [f"--parser={parser}", "--level=accept", "--format-version=2", "--seed=0", "--certificate=out"]
    arguments = {
        "pytest": ["conformance/", "-n0", "-k", "parallelogram-3d-closure", "-p", "no:cacheprovider", *asked],
        "eurdf": ["certify", "--smoke", *[each for each in asked if "seed" not in each]],
    }[program]
    path = os.pathsep.join((str(copied / "conformance"), str(ROOT / "reference")))
    done = subprocess.run(
        [sys.executable, "-m", program, *arguments],
        cwd=copied,
        env=os.environ | {"PYTHONPATH": path},
        capture_output=True,
        text=True,
        timeout=300,
    )
    assert done.returncode == (1 if program == "pytest" else 2), done.stdout + done.stderr
    assert "the run is void: files of the corpus were changed while it ran: " in done.stdout + done.stderr
    assert str(target) in done.stdout + done.stderr
    assert not (copied / "out" / "certificate.json").exists()


def test_untouched_corpus_voids_nothing(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    file = tmp_path / "closures" / "one.yaml"
    file.parent.mkdir()
    file.write_text("id: one", encoding="utf-8")
    monkeypatch.setattr(untouched, "CASES", tmp_path)
    before = untouched.snapshot()
    assert file in before
    assert untouched.void_text(before) is None
    (tmp_path / "closures" / "two.yaml").write_text("id: two", encoding="utf-8")
    assert "two.yaml" in (untouched.void_text(before) or "")
    file.unlink()
    assert "one.yaml" in (untouched.void_text(before) or "")
