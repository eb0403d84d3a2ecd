"""What is wrong is told with another code or severity, twice, or not at all; or it is made no difference of."""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path
from typing import Any

from eurdf.diagnostics import Diagnostic
from eurdf.diagnostics.registry import REGISTRY, Phase
from eurdf.format import read_extension
from eurdf.format.urdf import Urdf
from eurdf.linking import description, link
from eurdf.linking.description import Description
from eurdf.linking.frame_names import FrameNames
from eurdf.linking.replacement import _Replacement
from eurdf.linking.urdf_tree import joint_of
from eurdf_conformance.adapters.reference import Reference
from eurdf_conformance.level import Level
from eurdf_conformance.mutants.deviation import Deviation, around, instead, result
from eurdf_conformance.mutants.mutant import mutant
from eurdf_conformance.mutants.of_the_reference import each_issue, has, issues, refused
from eurdf_conformance.protocol.message import Accepted, Issue, Rejected
from eurdf_conformance.protocol.reply import accepted, rejected, unsupported
from eurdf_conformance.verdict.verdict import Verdict

_Answer = Accepted | Rejected
_LATE = (Phase.INERTIA, Phase.CLOSURE)


def _answers(change: Callable[[_Answer], _Answer]) -> Deviation:
    return result(Reference, "load", change)


def _phases(answer: _Answer) -> set[Phase]:
    return {REGISTRY[issue.code or ""].phase for issue in answer.issues if issue.severity == "error"}


@mutant("EU-CNF-001")
def everything_accepted() -> Deviation:
    """Whatever is wrong, the answer is accepted, with the errors beside it."""
    return _answers(lambda answer: accepted(None, answer.issues) if isinstance(answer, Rejected) else answer)


@mutant("EU-CNF-001")
def semantic_errors_accepted() -> Deviation:
    """Errors of phase semantic are told beside an acceptance, as those of inertia may be."""

    def built(answer: _Answer) -> _Answer:
        return accepted(None, answer.issues) if _phases(answer) == {Phase.SEMANTIC} else answer

    return _answers(built)


@mutant("EU-CNF-002")
def warnings_reject() -> Deviation:
    """A description that deserves a warning is rejected."""
    return _answers(lambda answer: rejected(*answer.issues) if answer.issues else answer)


@mutant("EU-CNF-003")
def late_errors_are_not_told() -> Deviation:
    """A robot with an error of inertia or closure is accepted without a word."""
    return issues(lambda found: [issue for issue in found if REGISTRY[issue.code or ""].phase not in _LATE])


@mutant("EU-URD-025")
def ranges_of_replaced_joints_are_missed() -> Deviation:
    """A joint without a range in the URDF is warned about, whatever the description makes of it."""

    def check(original: Any, urdf: Urdf, joints: Any, *arguments: Any) -> Any:
        return original(urdf, {joint.name: joint_of(joint) for joint in urdf.walk()}, *arguments)

    return around(link, "check_ranges", check)


@mutant("EU-PRO-004", caught_by=frozenset({Verdict.ERRORED}))
def fault_is_a_failure() -> Deviation:
    """Where the description is wrong, the reader says that it failed, as what raises an exception does."""

    def failed(answer: _Answer) -> _Answer:
        if isinstance(answer, Rejected):
            raise ValueError(answer.issues[0].message)
        return answer

    return _answers(failed)


@mutant("EU-SEC-005", caught_by=frozenset({Verdict.ERRORED}))
def fault_of_a_file_is_not_caught() -> Deviation:
    """What the parser of a file raises is caught by nobody."""
    return instead(description, "Fault", KeyboardInterrupt)


@mutant("EU-SEC-005", caught_by=frozenset({Verdict.ERRORED}))
def tree_is_walked_by_recursion() -> Deviation:
    """A function that calls itself for each link on a link walks the tree, and fails where it is 1000 links deep."""

    def walked(read: Description) -> Description:
        deep = {"": 0}
        for joint in () if read.urdf is None else read.urdf.walk():
            deep[joint.child] = deep.get(joint.parent, 0) + 1
        if max(deep.values()) > 1000:
            raise RecursionError("maximum recursion depth exceeded")
        return read

    return result(Reference, "describe", walked)


@mutant("EU-PRO-005", caught_by=frozenset({Verdict.ERRORED}))
def gone_after_a_rejection() -> Deviation:
    """After it has rejected a description, the reader reads nothing."""

    def load(original: Any, self: Any, description: Path, urdf: Path) -> _Answer:
        if vars(self).get("rejects"):
            raise RuntimeError("the parser is not in a state to read")
        answer: _Answer = original(self, description, urdf)
        self.rejects = isinstance(answer, Rejected)
        return answer

    return around(Reference, "load", load)


@mutant("EU-DIA-001")
def one_code_for_all() -> Deviation:
    """Whatever is wrong has one code."""
    return each_issue(lambda issue: {"code": "wrong-value"})


@mutant("EU-DIA-001")
def told_twice() -> Deviation:
    """What is wrong is told twice."""
    return issues(lambda found: [*found, *found])


@mutant("EU-DIA-001")
def no_codes() -> Deviation:
    """What is wrong has no code, only a sentence."""
    return each_issue(lambda issue: {"code": None})


@mutant("EU-DIA-002")
def what_follows_is_told() -> Deviation:
    """Beside a fault of a name it is told that no configuration closes the loops."""

    def more(found: list[Issue]) -> list[Issue]:
        if not any(issue.severity == "error" for issue in found):
            return found
        return [*found, found[0].model_copy(update={"code": "closure-cannot-close"})]

    return issues(more)


@mutant("EU-DIA-002", versions=("2",))  # version 1 adds no frames
def frame_at_fault_is_unknown() -> Deviation:
    """Where a frame of the description is at fault, each closure that uses it is told to use an unknown one."""

    def by_name(original: Any, self: Any, reference: Any) -> Any:
        if reference.name in self._frames and self._frames[reference.name] is None:
            self._diagnostics.report("unknown-frame", "it is unknown", self._document.place(reference.pointer))
        return original(self, reference)

    return around(FrameNames, "_by_name", by_name)


@mutant("EU-DIA-004")
def warnings_are_errors() -> Deviation:
    """Whatever is told is an error."""
    return each_issue(lambda issue: {"severity": "error"})


@mutant("EU-DIA-004")
def errors_are_warnings() -> Deviation:
    """Whatever is told is a warning."""
    return each_issue(lambda issue: {"severity": "warning"})


@mutant("EU-DIA-005")
def code_of_its_own() -> Deviation:
    """Codes are those of the reader's own, which do not begin with x-."""
    return each_issue(lambda issue: {"code": f"{issue.code}-error"})


@mutant("EU-CNF-004", versions=("2",))  # version 1 has no helical joints
def what_is_lacked_is_wrong() -> Deviation:
    """A reader that lacks helical joints says that they are wrong."""
    return refused(has(lambda joint: joint.type == "helical"))


@mutant("EU-CNF-005", caught_by=frozenset({Verdict.UNSUPPORTED}), versions=("2",))  # version 1 has neither
def less_than_is_claimed() -> Deviation:
    """A reader that claims a level lacks helical and universal joints, and says so."""

    def load(original: Any, self: Any, description: Path, urdf: Path) -> Any:
        answer = original(self, description, urdf)
        kinds = (
            {joint.type for joint in answer.robot.joints} if isinstance(answer, Accepted) and answer.robot else set()
        )
        return unsupported("joints") if kinds & {"helical", "universal"} else answer

    return around(Reference, "load", load)


@mutant("EU-CNF-004", versions=("2",))  # of version 1 it is universal_joint_stays_as_it_is
def what_is_lacked_is_left_out() -> Deviation:
    """A reader that lacks universal joints leaves them as the URDF has them."""
    return around(_Replacement, "universal", lambda original, self, joint: joint)


@mutant("EU-DIA-001", versions=("2",))  # of version 1 one key can be missing
def each_missing_key_is_told() -> Deviation:
    """Of a mapping that lacks several keys each is told, at one place, as by JSON Schema's validators."""

    def each(found: list[Diagnostic]) -> list[Diagnostic]:
        return [one for one in found for _ in range(1 + (one.code == "missing-key" and " and " in one.message))]

    return result(read_extension, "violations", each)


@mutant("EU-JNT-002", level=Level.DIAGNOSE, versions=("2",))  # version 1 has no merges
def joint_twice_in_merges_is_a_wrong_value() -> Deviation:
    """A joint that stands twice in `merges` is told as a wrong value of the list, as by JSON Schema's uniqueItems."""

    def merge(original: Any, self: _Replacement) -> Any:
        if len(set(self.entry.merges)) == len(self.entry.merges):
            return original(self)
        self.report("wrong-value", "the names must differ", "merges")
        return None

    return around(_Replacement, "merge", merge)


@mutant("EU-SCH-001", level=Level.DIAGNOSE, versions=("2",))
def lacking_version_is_told_of_any_key() -> Deviation:
    """Where the version is lacking, this is told of a key of version 2, though another stands before it."""

    def version(original: Any, document: Any, diagnostics: Any) -> Any:
        keys = [key for key in (*read_extension._VERSION2_KEYS, "metadata") if key in document.data]
        if {read_extension.VERSION_KEY, *read_extension._VERSION1_KEYS} & document.data.keys() or not keys:
            return original(document, diagnostics)
        diagnostics.report("missing-key", "the version is missing", document.place((keys[0],), key=True))
        return None

    return around(read_extension, "_version", version)
