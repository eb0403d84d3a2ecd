"""The reference passes every case of the suite, here in one process."""

from __future__ import annotations

import pytest

from eurdf_conformance.adapters.reference import Reference
from eurdf_conformance.corpus.read import all_cases
from eurdf_conformance.judging.conversation import Conversation
from eurdf_conformance.judging.judge import judge
from eurdf_conformance.judging.verdict import Verdict
from eurdf_conformance.runner.in_process import InProcess

CASES = all_cases()


@pytest.mark.parametrize("topic", sorted({case.topic for case in CASES}))
def test_reference_passes_the_cases_of_a_topic(topic: str) -> None:
    conversation = Conversation(InProcess(Reference()))
    failed = []
    for case in CASES:
        for level in case.levels if case.topic == topic else ():
            result = judge(case, level, conversation)
            if result.verdict is not Verdict.PASSED:
                failed.append(f"{case.name}/{level}: {result.verdict}")
    assert failed == []
