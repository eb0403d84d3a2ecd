"""Certificates: what they say, that they are the same for the same run, and what people see of them."""

from __future__ import annotations

import json
import re
import shutil
from dataclasses import replace
from pathlib import Path
from typing import Any

import jsonschema
import pytest
from lxml import etree, html
from markdown_it import MarkdownIt

from eurdf_conformance.certificate import certificate as certificate_module
from eurdf_conformance.certificate import fingerprint
from eurdf_conformance.certificate.badge import badge, badge_texts
from eurdf_conformance.certificate.certificate import Certificate, NoCertificate, certificate_schema, read_certificate
from eurdf_conformance.certificate.comparison_page import comparison_markdown, comparison_page
from eurdf_conformance.certificate.fingerprint import clauses_hash
from eurdf_conformance.certificate.issue import issue
from eurdf_conformance.certificate.report import report
from eurdf_conformance.certificate.write import write_certificate
from eurdf_conformance.command import replay as replay_module
from eurdf_conformance.command.replay import (
    file_differences,
    own_errors,
    replay_differences,
    replay_schema,
    suite_differences,
)
from eurdf_conformance.corpus.clause import read_clauses
from eurdf_conformance.corpus.read import CASES, all_cases, read_case
from eurdf_conformance.corpus.release import corpus_hash, files_hash
from eurdf_conformance.judging.known_failures import KnownFailure, KnownFailures
from eurdf_conformance.judging.result import Result
from eurdf_conformance.judging.verdict import Verdict
from eurdf_conformance.level import Level
from eurdf_conformance.suite.item import case_items
from eurdf_conformance.suite.options import Options
from eurdf_conformance.suite.reproduce import PACKAGE
from eurdf_conformance.write_together import write_together
from suite_runs import INVALID, PLANNED, VALID, result, run, started

ALL = {version: list(Level) for version in ("1", "2")}
HOSTILE = "<script>alert(1)</script> & \x1b[31m\0\u202e"


def text_of(page: str) -> str:
    """What a parser of a page sees, on one line."""
    return " ".join(" ".join(html.document_fromstring(page).find("body").itertext()).split())


@pytest.fixture(scope="module")
def failed() -> Certificate:
    return issue(run({(INVALID, Level.ACCEPT): Verdict.FAILED}))


# --- the certificate -------------------------------------------------------------------------------------------------


def test_the_certificate_schema_is_current_and_accepts_a_certificate(failed: Certificate) -> None:
    file = Path(certificate_module.__file__).with_name("certificate.schema.json")
    schema = json.loads(file.read_text(encoding="utf-8"))
    assert schema == certificate_schema()
    jsonschema.Draft202012Validator.check_schema(schema)
    jsonschema.Draft202012Validator(schema).validate(json.loads(failed.to_text()))
    jsonschema.Draft202012Validator(schema).validate(json.loads(issue(run(started=None)).to_text()))


def test_a_certificate_shows_what_failed_and_why(failed: Certificate) -> None:
    (failure,) = failed.failures
    assert (failure.id, failure.level, failure.verdict) == (INVALID, Level.ACCEPT, Verdict.FAILED)
    assert failure.difference == "/outcome: expected"
    assert [(each.id, each.passed, each.items) for each in failed.clauses] == [
        ("EU-CLO-001", 0, 1),
        ("EU-CLO-008", 2, 2),
    ]
    assert not failed.certified
    accept = failed.at("2", Level.ACCEPT)
    assert accept is not None
    assert (accept.counts, accept.certified) == ({Verdict.PASSED: 1, Verdict.FAILED: 1}, False)


def test_a_certificate_is_independent_of_order_and_time() -> None:
    first = run({(INVALID, Level.ACCEPT): Verdict.FAILED})
    second = replace(first, results=tuple(replace(each, seconds=7.0) for each in reversed(first.results)))
    assert issue(second).to_text() == issue(first).to_text()


def test_a_certificate_contains_no_request_ids() -> None:
    texts = set()
    for number in (4, 51):
        line = f'a line that is no answer: {{"id": {number}, "outcome": "acepted"}}'
        broken = result(PLANNED[0], Verdict.MALFORMED, line)
        lost = result(PLANNED[1], Verdict.MISPLACED, f"an answer to request {number}")
        texts.add(issue(run(results=(broken, lost))).to_text())
    assert len(texts) == 1
    assert "acepted" in texts.pop()


def test_a_certificate_has_a_date_only_if_given(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.delenv("SOURCE_DATE_EPOCH", raising=False)
    assert issue(run()).date is None
    monkeypatch.setenv("SOURCE_DATE_EPOCH", "1760000000")
    assert issue(run()).date == "2025-10-09"


def test_known_failure_is_marked_as_known() -> None:
    known = KnownFailure(id=INVALID, level=Level.ACCEPT, verdict=Verdict.FAILED, reason="An open issue.")
    given = issue(run({(INVALID, Level.ACCEPT): Verdict.FAILED}, known_failures=KnownFailures((known,))))
    assert [failure.known for failure in given.failures] == [True]
    assert (given.certified, given.unexpected) == (False, ())
    assert "known failures: 1" in text_of(report(given))


# --- its hashes ------------------------------------------------------------------------------------------------------


def test_the_hash_of_files_depends_on_names_and_bytes_alone() -> None:
    given = files_hash({"a": b"1", "b": b"2"})
    assert files_hash({"b": b"2", "a": b"1"}) == given
    others = [{"a": b"2", "b": b"1"}, {"a": b"1", "c": b"2"}, {"a": b"1"}, {"a": b"12", "b": b""}]
    assert given not in map(files_hash, others)


def test_the_hash_of_the_corpus_ignores_the_order_of_cases() -> None:
    cases = all_cases()
    assert corpus_hash(reversed(cases)) == corpus_hash(cases) == corpus_hash()
    assert corpus_hash(cases[1:]) != corpus_hash(cases)


def test_the_hash_of_the_corpus_covers_the_files_it_uses(tmp_path: Path) -> None:
    for topic in ("frames", "closures"):
        shutil.copytree(CASES / topic, tmp_path / topic)

    def hashed() -> str:
        return corpus_hash([read_case(tmp_path / "frames" / "closure-at-unknown-frame.yaml")])

    before = hashed()
    (tmp_path / "frames" / ".DS_Store").write_bytes(b"a file manager was here")
    assert hashed() == before
    twin = tmp_path / "closures" / "parallelogram-3d-closure.yaml"
    twin.write_text(twin.read_text(encoding="utf-8").replace('name="parallelogram"', 'name="other"'), encoding="utf-8")
    assert hashed() != before


def test_the_hash_of_the_properties_covers_their_examples(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    before = fingerprint.properties_hash()
    (tmp_path / "frozen.json").write_bytes(fingerprint.FROZEN.read_bytes() + b"\n")
    monkeypatch.setattr(fingerprint, "FROZEN", tmp_path / "frozen.json")
    assert fingerprint.properties_hash() != before


def test_the_hash_of_the_clauses_covers_their_texts() -> None:
    first, *others = read_clauses().values()
    assert clauses_hash([*others, first]) == clauses_hash()
    assert clauses_hash([replace(first, text="Something else."), *others]) != clauses_hash()


# --- its files -------------------------------------------------------------------------------------------------------


def test_a_certificate_is_written_as_three_files_and_read_again(failed: Certificate, tmp_path: Path) -> None:
    folder = tmp_path / "deep" / "certificate"
    write_certificate(folder, failed)
    assert sorted(path.name for path in folder.iterdir()) == ["badge.svg", "certificate.json", "report.html"]
    assert read_certificate(folder) == read_certificate(folder / "certificate.json") == failed


def test_files_are_written_all_or_none(tmp_path: Path) -> None:
    (tmp_path / "a").write_text("before", encoding="utf-8")
    (tmp_path / "b").mkdir()
    with pytest.raises(IsADirectoryError):
        write_together({tmp_path / "a": b"after", tmp_path / "b": b"after"})
    assert (tmp_path / "a").read_text(encoding="utf-8") == "before"
    assert sorted(path.name for path in tmp_path.iterdir()) == ["a", "b"]


@pytest.mark.parametrize("text", ["", "[]", "{", '{"certificate": "2.0"}', '{"certificate": NaN}'])
def test_a_file_that_is_not_a_certificate_is_refused(text: str, tmp_path: Path) -> None:
    (tmp_path / "certificate.json").write_text(text, encoding="utf-8")
    with pytest.raises(NoCertificate, match="is not a certificate"):
        read_certificate(tmp_path)


def test_a_certificate_with_an_unknown_key_is_refused(failed: Certificate, tmp_path: Path) -> None:
    value = json.loads(failed.to_text()) | {"stars": 5}
    (tmp_path / "certificate.json").write_text(json.dumps(value), encoding="utf-8")
    with pytest.raises(NoCertificate, match="/stars"):
        read_certificate(tmp_path)


# --- what people see -------------------------------------------------------------------------------------------------


def test_the_report_shows_levels_failures_and_clauses(failed: Certificate) -> None:
    page = text_of(report(failed))
    assert "my_parser 0.3" in page
    assert "Certified for version 2: structure. Not for version 2: accept" in page
    assert "✗ not certified: 1 failed, 1 of 2 passed" in page
    assert "/outcome: expected" in page
    assert f"Run it again: pytest conformance/ -k {INVALID}/accept" in page
    assert read_clauses()["EU-CLO-001"].text in page


def test_every_link_of_the_report_has_a_target(failed: Certificate) -> None:
    document = html.document_fromstring(report(failed))
    targets = [link.get("href").removeprefix("#") for link in document.iter("a")]
    assert targets
    assert set(targets) <= set(document.xpath("//@id"))
    assert len(document.xpath("//@id")) == len(set(document.xpath("//@id")))


def test_the_report_and_the_comparison_load_no_other_files(failed: Certificate) -> None:
    for page in (report(failed), comparison_page([failed, failed])):
        assert not re.findall(r"(?:src|href)=\"(?!#)|url\(|@import|https?:", page)
        assert "<script" not in page


def test_texts_of_a_parser_are_escaped_in_pages_and_badges(failed: Certificate) -> None:
    said = started({"2": [Level.ACCEPT]}, name=HOSTILE)
    given = issue(run({(INVALID, Level.ACCEPT): Verdict.FAILED}, started=said, parser=f"cmd:{HOSTILE}"))
    for page in (report(given), comparison_page([given, failed])):
        assert "<script" not in page
        assert "\x1b" not in page
        assert "\\x1b[31m\\x00\\u202e" in page
    etree.fromstring(badge(given))


def test_the_report_shows_once_why_a_parser_did_not_start() -> None:
    lost = tuple(result(each, Verdict.NOT_STARTED, "there is no such program") for each in PLANNED)
    page = text_of(report(issue(run(started=None, results=lost))))
    assert "could not be started" in page
    assert page.count("there is no such program") == 1


@pytest.mark.parametrize(
    ("claims", "verdicts", "texts"),
    [
        ({"2": [Level.ACCEPT, Level.STRUCTURE]}, {}, ("Extended URDF 2", "accept structure")),
        ({"2": [Level.ACCEPT, Level.STRUCTURE]}, {(VALID, Level.ACCEPT): 1}, ("Extended URDF 2", "structure")),
        ({"2": [Level.ACCEPT]}, {(VALID, Level.ACCEPT): 1}, ("Extended URDF", "not certified")),
    ],
)
def test_the_badge_names_only_certified_levels(
    claims: dict[str, list[Level]], verdicts: dict[tuple[str, Level], int], texts: tuple[str, str]
) -> None:
    given = issue(run(dict.fromkeys(verdicts, Verdict.FAILED), claims=claims))
    assert badge_texts(given) == texts


def certified_as(certificate: Certificate, levels: dict[str, set[Level]]) -> Certificate:
    changed = (
        each.model_copy(update={"certified": each.level in levels.get(each.version, ())}) for each in certificate.levels
    )
    return certificate.model_copy(update={"levels": tuple(changed)})


def test_badge_shows_all_levels_by_version(failed: Certificate) -> None:
    every = set(Level)
    assert badge_texts(certified_as(failed, {"1": every, "2": every})) == ("Extended URDF 1 and 2", "all levels")
    three = certified_as(failed, {"1": every, "2": every, "2.1": every})
    assert badge_texts(three) == ("Extended URDF 1, 2 and 2.1", "all levels")
    assert badge_texts(certified_as(failed, {"1": {Level.ACCEPT}, "2": every})) == (
        "Extended URDF",
        "1: accept, 2: all levels",
    )


def test_the_badge_has_a_title_and_its_texts_fit(failed: Certificate) -> None:
    svg = etree.fromstring(badge(failed))
    space = {"s": "http://www.w3.org/2000/svg"}
    assert svg.get("role") == "img"
    assert svg.findtext("s:title", namespaces=space) == svg.get("aria-label") == "Extended URDF 2: structure"
    boxes = svg.findall("s:g/s:rect", space)
    texts = svg.findall("s:g/s:text", space)
    for box, text in zip(boxes, texts, strict=True):
        begin, width = float(box.get("x", "0")), float(box.get("width", "0"))
        assert begin < float(text.get("x", "0"))
        assert float(text.get("x", "0")) + float(text.get("textLength", "0")) < begin + width
    assert float(svg.get("width", "0")) == sum(float(box.get("width", "0")) for box in boxes)


# --- several ---------------------------------------------------------------------------------------------------------


def test_a_comparison_shows_only_clauses_with_different_results(failed: Certificate) -> None:
    other = issue(run(started=started({"2": [Level.ACCEPT, Level.STRUCTURE]}, name="your_parser")))
    page = text_of(comparison_page([failed, other]))
    assert "my_parser 0.3" in page
    assert "your_parser 0.3" in page
    assert "Clauses with different results (1 of 2)" in page
    assert "✗ 0 of 1 ✓ 1 of 1" in page
    assert "EU-CLO-008" not in page
    assert "different versions of the suite" not in page


def test_a_comparison_tells_in_words_what_each_parser_gets_wrong(failed: Certificate) -> None:
    page = text_of(comparison_page([failed, issue(run(started=started({"2": [Level.ACCEPT]}, name="your_parser")))]))
    assert "Failures by topic topic my_parser 0.3 your_parser 0.3 closures 1 0" in page
    told = "Reads or computes something else: 1 closures Two closures may not have one name. accept of version 2"
    assert f"my_parser 0.3 {told} your_parser 0.3 Nothing at the levels that it claims." in page


def test_a_comparison_in_markdown_says_the_same(failed: Certificate) -> None:
    other = issue(run(started=started({"2": [Level.ACCEPT]}, name="your_parser |*`_<b>$")))
    page = comparison_page([failed, other])
    made = MarkdownIt().enable("table").render(comparison_markdown([failed, other]))
    captions = re.compile("<caption>.*?</caption>")
    assert text_of(made).split() == text_of(captions.sub("", page)).split()
    for tag in ("table", "tr", "h3", "details", "li", "code", "b"):
        assert made.count(f"<{tag}>") == len(re.findall(f"<{tag}[ >]", page)), tag


def test_a_comparison_distinguishes_parsers_with_the_same_name(failed: Certificate) -> None:
    assert failed.parser is not None
    other = failed.model_copy(update={"parser": failed.parser.model_copy(update={"language": "Rust"})})
    heads = re.findall(r"<th[^>]*>(my_parser[^<]*)</th>", comparison_page([failed, other, other]))
    assert list(dict.fromkeys(heads)) == [
        "my_parser 0.3 (C++)",
        "my_parser 0.3 (Rust), no. 1",
        "my_parser 0.3 (Rust), no. 2",
    ]


def test_a_comparison_reports_different_versions_of_the_suite(failed: Certificate) -> None:
    older = failed.suite.model_copy(update={"corpus": f"sha256:{'0' * 64}"})
    assert "different versions of the suite" in comparison_page([failed, failed.model_copy(update={"suite": older})])


# --- again -----------------------------------------------------------------------------------------------------------


def test_equal_second_run_has_no_differences(failed: Certificate) -> None:
    again = issue(run({(INVALID, Level.ACCEPT): Verdict.FAILED}, parser="cmd:elsewhere/my_parser"))
    assert replay_differences(failed, again) == []
    assert suite_differences(failed) == []


def test_differing_second_run_lists_differences(failed: Certificate) -> None:
    changed = started({"2": [Level.ACCEPT]}, name="my_other_parser")
    again = issue(run({(VALID, Level.ACCEPT): Verdict.CRASHED}, claims={"2": [Level.ACCEPT]}, started=changed))
    assert replay_differences(failed, again) == [
        "parser, name: 'my_parser' then, 'my_other_parser' now",
        "version 2, accept: not certified: 1 failed, 1 of 2 passed then, not certified: 1 crashed, 1 of 2 passed now",
        "version 2, structure: certified: 1 passed then, not claimed now",
        "closures/aaaaa1/accept: no failure then, crashed now",
        "closures/bbbbb2/accept: failed then, no failure now",
    ]


@pytest.mark.parametrize(("given", "same"), [("0.3000000002", True), ("0.30001", False)])
def test_a_second_run_is_compared_up_to_rounding(failed: Certificate, given: str, same: bool) -> None:
    def failing(number: str) -> Certificate:
        difference = f"/values/0/mass: the mass: expected 0.25, got {number}"
        return forged(failed, failures=[each.model_dump() | {"difference": difference} for each in failed.failures])

    found = replay_differences(failing("0.3"), failing(given))
    assert [": fails differently: " in each for each in found] == [True] * (not same)


def forged(certificate: Certificate, **changes: object) -> Certificate:
    """What somebody made of a certificate by hand."""
    return Certificate.model_validate(certificate.model_dump() | changes)


def test_inflated_certificate_is_detected(failed: Certificate) -> None:
    levels = [each.model_dump() | {"certified": True} for each in failed.levels]
    clauses = [*failed.clauses, {"id": "EU-XXX-999", "items": 7, "passed": 7}]
    better = [each.model_dump() | {"passed": each.items} for each in failed.clauses]
    says = "the certificate contradicts the results of its cases"
    assert replay_differences(forged(failed, certified=True), failed) == [says]
    assert replay_differences(forged(failed, clauses=clauses), failed) == [
        "clause EU-XXX-999: 7 of 7 passed then, absent now"
    ]
    assert replay_differences(forged(failed, clauses=better), failed) == [
        "clause EU-CLO-001: 1 of 1 passed then, 0 of 1 passed now"
    ]
    assert replay_differences(forged(failed, levels=levels), failed)
    not_claimed = [
        row if row["claimed"] else each for each, row in zip(levels, failed.model_dump()["levels"], strict=True)
    ]
    assert replay_differences(forged(failed, levels=not_claimed), failed) == [says]


def test_page_or_badge_of_another_certificate_is_detected(failed: Certificate, tmp_path: Path) -> None:
    write_certificate(tmp_path, failed)
    assert file_differences(tmp_path, failed) == []
    (tmp_path / "badge.svg").write_text(badge(issue(run())), encoding="utf-8")
    assert file_differences(tmp_path, failed) == ["badge.svg: it does not show this certificate"]


def test_missing_badge_or_page_is_reported(failed: Certificate, tmp_path: Path) -> None:
    write_certificate(tmp_path, failed)
    (tmp_path / "badge.svg").unlink()
    (tmp_path / "report.html").rename(tmp_path / "my_report.html")
    told = ["report.html: it is missing", "badge.svg: it is missing"]
    assert file_differences(tmp_path, failed) == told
    assert file_differences(tmp_path / "certificate.json", failed) == []  # of which nobody says what is beside it


def test_a_reformatted_certificate_is_detected(failed: Certificate, tmp_path: Path) -> None:
    write_certificate(tmp_path, failed)
    file = tmp_path / "certificate.json"
    text = file.read_text(encoding="utf-8")
    file.write_text(
        text.replace('"certified": false,\n  "levels"', '"certified": true,\n  "certified": false,\n  "levels"')
    )
    assert read_certificate(file) == failed
    told = ["certificate.json: (top level): duplicate key 'certified'"]
    assert file_differences(tmp_path, read_certificate(file)) == file_differences(file, failed) == told
    file.write_text(text.replace("\n", ""), encoding="utf-8")
    assert file_differences(file, failed) == ["certificate.json: not formatted as the suite writes it"]


#: A case of the suite, and what became of it in a run whose parser was expected to fail otherwise, or to pass.
REAL = next(found.item for found in case_items(all_cases()) if found.item.level == Level.ACCEPT)


def with_known(verdict: Verdict, *known: tuple[str, Verdict], **options: Any) -> Certificate:
    """A certificate of a run of one case of the suite that came to a verdict, and of known failures."""
    failures = [KnownFailure(id=id_, level=Level.ACCEPT, verdict=of, reason="An issue.") for id_, of in known]
    given = Options("cmd:./my_parser", **options)
    of_case = Result(REAL, verdict, ("/outcome: expected",), given.reproduce(REAL))
    claims = started({REAL.version: [Level.ACCEPT]})
    return issue(
        run(
            started=claims,
            planned=(REAL,),
            results=(of_case,),
            known_failures=KnownFailures(tuple(failures)),
            explore=given.explore,
            seed=given.seed,
        )
    )


SOUND = [
    with_known(Verdict.FAILED),
    with_known(Verdict.FAILED, (REAL.id, Verdict.FAILED)),
    with_known(Verdict.FAILED, (REAL.id, Verdict.CRASHED)),
    with_known(Verdict.PASSED, (REAL.id, Verdict.CRASHED)),
    with_known(Verdict.FAILED, ("closures/nobody", Verdict.FAILED), (f"{REAL.id}/accept", Verdict.FAILED)),
    with_known(Verdict.FAILED, suite=PACKAGE, timeout=2.5, explore=3, seed=9),
    with_known(Verdict.TIMED_OUT, start_timeout=1e-05),
    issue(run(claims=ALL, results=())),
]


@pytest.mark.parametrize("certificate", SOUND)
def test_a_certificate_of_the_suite_is_consistent(certificate: Certificate) -> None:
    assert own_errors(certificate) == []


def forged_failure(certificate: Certificate, **changes: object) -> Certificate:
    (failure,) = certificate.failures
    return forged(certificate, failures=[failure.model_dump() | changes])


@pytest.mark.parametrize(
    "command",
    [
        "rm -rf /",
        "",
        *(
            SOUND[0].failures[0].reproduce.replace(before, after)
            for before, after in (
                ("pytest ", "pytest  "),
                ("pytest ", "pytest --parser-timeout=$(reboot) "),
                ("./my_parser", "./their_parser"),
                ("conformance/", "conformance/ ; reboot"),
                ("-k ", "--explore=5 -k "),
                ("/accept", "/structure"),
            )
        ),
    ],
)
def test_wrong_command_of_a_case_is_detected(command: str) -> None:
    name = f"{REAL.id}/accept"
    told = [f"{name}: the reproduce command is not one of the suite: {command}"]
    assert own_errors(forged_failure(SOUND[0], reproduce=command)) == told


def test_a_wrong_count_of_known_failures_is_reported() -> None:
    version = f"version {REAL.version}, accept"
    assert own_errors(forged_failure(SOUND[0], known=True)) == [
        f"{version}: known_failures is 0, but 1 failures are known"
    ]
    assert own_errors(forged_failure(SOUND[1], known=False)) == [
        f"{version}: known_failures is 1, but 0 failures are known"
    ]
    levels = [each.model_dump() | {"known_failures": 3} for each in SOUND[0].levels if each.known_failures == 0]
    assert own_errors(forged(SOUND[0], levels=levels))
    not_run = own_errors(forged_failure(SOUND[1], verdict="not run"))
    assert not_run == [f"{REAL.id}/accept: known failure, but the item was not run"]


@pytest.mark.parametrize(
    ("index", "sentence"),
    [
        (0, "x"),
        (0, "all is well/accept: known as 'certified', but it is better"),
        (0, f"{REAL.id}/accept: listed as 'failed' but passes; remove it from the known failures"),
        (0, f"{REAL.id}/accept: listed as 'skipped', but the verdict is 'crashed'"),
        (0, f"{REAL.id}/accept: the suite has no such item"),
        (1, f"{REAL.id}/accept: listed as 'skipped', but the verdict is 'failed'"),
        (3, f"{REAL.id}/accept: listed as 'skipped', but the verdict is 'failed'"),
        (0, "closures/nobody/accept: the suite has no such item, and is wrong"),
    ],
)
def test_a_message_about_known_failures_must_follow_from_the_failures(index: int, sentence: str) -> None:
    told = f"unexpected: does not follow from the failures: {sentence}"
    assert own_errors(forged(SOUND[index], unexpected=[sentence])) == [told]


def test_certificate_of_another_corpus_is_detected(failed: Certificate) -> None:
    older = failed.suite.model_copy(update={"corpus": f"sha256:{'0' * 64}"})
    (said,) = suite_differences(failed.model_copy(update={"suite": older}))
    assert said.startswith("suite, corpus: sha256:000")


def test_the_schema_of_a_replay_is_current() -> None:
    file = Path(replay_module.__file__).with_name("replay.schema.json")
    assert json.loads(file.read_text(encoding="utf-8")) == replay_schema()
