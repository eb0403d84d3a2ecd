"""The claims about other programs in the comparison: each has a rerun, and those of installed programs hold."""

from __future__ import annotations

import importlib.util

import pytest

from benchmarks.claims.claims import CLAIMS, PAGE, Rerun, rerun, unclaimed


def test_every_mark_on_the_page_has_a_rerun() -> None:
    page = PAGE.read_text(encoding="utf-8")
    assert unclaimed(page) == []
    assert unclaimed(page + "\nThe moon is round \u25b8.") == ["no rerun of: " + "…" + unmarked(page)]
    changed = page.replace("TAMSI rejects", "TAMSI likes")
    assert [error.split(":")[0] for error in unclaimed(changed)] == ["the page contains 0 times", "no rerun of"]


def unmarked(page: str) -> str:
    return " ".join(f"{page} The moon is round \u25b8".split())[-61:]


def test_rerun_reports_failure_and_crash(monkeypatch: pytest.MonkeyPatch) -> None:
    assert rerun("pinocchio", "no_such_function").outcome == "does not hold"
    monkeypatch.setattr(importlib.util, "find_spec", lambda name: None)
    assert rerun("drake", "solvers").outcome == "not run"


@pytest.mark.slow
@pytest.mark.parametrize("program", ["pinocchio", "mujoco", "usd"])
def test_claims_hold(program: str) -> None:
    found: list[Rerun] = [rerun(*each) for claim in CLAIMS for each in claim.reruns if each[0] == program]
    assert found
    if all(each.outcome == "not run" for each in found):
        pytest.skip(found[0].seen)
    assert [each for each in found if each.outcome != "holds"] == []
