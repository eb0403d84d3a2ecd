"""Several certificates on one page: levels and topics by parser, what each gets wrong, and clauses that differ."""

from __future__ import annotations

import re
from collections import Counter, defaultdict
from collections.abc import Iterator, Sequence

from eurdf_conformance.certificate.certificate import Certificate, ClauseResult, Failure
from eurdf_conformance.certificate.markdown import markdown
from eurdf_conformance.certificate.page import Element, element, marked_up, page, table
from eurdf_conformance.certificate.report import level_cell
from eurdf_conformance.certificate.summary import level_count, parser_title
from eurdf_conformance.corpus.clause import read_clauses
from eurdf_conformance.judging.verdict import NO_FAILURE, Verdict
from eurdf_conformance.level import VERSIONS, Level

_TITLE = "Parsers of Extended URDF compared"

#: What a parser is asked at each level.
_ASKED = {
    Level.ACCEPT: "accepts valid files, and rejects those with an error",
    Level.STRUCTURE: "returns what it has read: links, joints, limits, closures, actuators",
    Level.KINEMATICS: "computes poses, and the residuals and Jacobians of the closures",
    Level.DYNAMICS: "computes the mass matrix, the mass and the centre of mass",
    Level.DIAGNOSE: "names each error and its line",
}

#: Kinds of failures, and how each is recognised by the verdict and by what is wrong.
_KINDS = (
    ("Rejects valid files", Verdict.FAILED, "rejects a valid description"),
    ("Accepts files with an error", Verdict.FAILED, "accepts an invalid description"),
    ("Reads or computes something else", Verdict.FAILED, ""),
    *((f"Ends as {verdict}", verdict, "") for verdict in Verdict if verdict not in {*NO_FAILURE, Verdict.FAILED}),
)

#: A difference: where it is, what it is of, and the two values. Names in it differ from case to case.
_DIFFERENCE = re.compile(r"^/\S*: (?P<of>.*?): expected ", re.MULTILINE)
_NAME = re.compile(r"'[^']*(?:'|$)")


def comparison_page(certificates: Sequence[Certificate]) -> str:
    """The page as the text of its HTML file; parsers are in the order given."""
    return page(_TITLE, _comparison(certificates), "comparison")


def comparison_markdown(certificates: Sequence[Certificate]) -> str:
    """The page as the text of a Markdown file."""
    return markdown(_comparison(certificates))


def _comparison(certificates: Sequence[Certificate]) -> list[Element]:
    parts = _parsers, _levels, _topics, _wrong, _clauses
    return [element("h1", _TITLE), *(content for part in parts for content in part(certificates))]


def _parsers(certificates: Sequence[Certificate]) -> Iterator[Element]:
    cases = " and ".join(dict.fromkeys(each.suite.corpus[:19] for each in certificates))
    run = f"Each parser was run for this page, on the cases of corpus {cases}. What is asked at each level:"
    yield element("p", run)
    yield element("ul", *(element("li", f"{level.value}: the parser {asked}") for level, asked in _ASKED.items()))
    yield element("p", "Items passed of all items. ✓ certified, ✗ claimed but not certified.", class_="soft")
    yield element("h2", "Parsers")
    dated = any(each.date for each in certificates)
    rows = (
        (
            element("th", title, scope="row"),
            element("td", each.parser.language if each.parser else "could not be started"),
            element("td", each.suite.version),
            element("td", f"{each.scope.seed}"),
            *([element("td", each.date or "unknown")] if dated else []),
        )
        for title, each in zip(_titles(certificates), certificates, strict=True)
    )
    yield table("Parsers", ("parser", "language", "suite", "seed", *(["date"] if dated else [])), rows)
    if len({(each.suite.clauses, each.suite.corpus) for each in certificates}) > 1:
        said = "These certificates come from different versions of the suite, which may test different things."
        yield element("p", said, class_="headline bad")


def _titles(certificates: Sequence[Certificate]) -> list[str]:
    """A unique title for each certificate, with the language, and then a number, where name and version are equal."""
    titles = [parser_title(each) for each in certificates]
    languages = [each.parser.language if each.parser else "" for each in certificates]
    said = Counter(titles)
    titles = [
        f"{title} ({language})" if said[title] > 1 and language else title
        for title, language in zip(titles, languages, strict=True)
    ]
    said = Counter(titles)
    return [
        f"{title}, no. {titles[:index].count(title) + 1}" if said[title] > 1 else title
        for index, title in enumerate(titles)
    ]


def _levels(certificates: Sequence[Certificate]) -> Iterator[Element]:
    for version in VERSIONS:
        title = f"Version {version}"
        yield element("h2", title)
        rows = (
            (
                element("th", level.value, scope="row"),
                *(level_cell(each.at(version, level), level_count, each.scope.smoke) for each in certificates),
            )
            for level in Level
        )
        yield table(title, ("level", *_titles(certificates)), rows)


def _topics(certificates: Sequence[Certificate]) -> Iterator[Element]:
    counts = [Counter(_topic(failure) for failure in each.failures) for each in certificates]
    topics = sorted(set().union(*counts))
    if not topics:
        return
    title = "Failures by topic"
    yield element("h2", title)
    rows = (
        (
            element("th", topic, scope="row"),
            *(element("td", f"{of_one[topic]}", class_="number") for of_one in counts),
        )
        for topic in topics
    )
    yield table(title, ("topic", *_titles(certificates)), rows)


def _wrong(certificates: Sequence[Certificate]) -> Iterator[Element]:
    """For each parser the titles of the cases that it fails, once each, by the kind of the failure and by topic."""
    yield element("h2", "What each parser gets wrong")
    for title, certificate in zip(_titles(certificates), certificates, strict=True):
        yield element("h3", title)
        of_kind = defaultdict[str, list[Failure]](list)
        for failure in certificate.failures:
            of_kind[_kind(failure)].append(failure)
        if not of_kind:
            yield element("p", "Nothing at the levels that it claims.")
        for kind in filter(of_kind.__contains__, (kind for kind, *_ in _KINDS)):
            yield element("details", element("summary", f"{kind}: {len(of_kind[kind])}"), *_failures(of_kind[kind]))


def _kind(failure: Failure) -> str:
    said = failure.difference or ""
    return next(kind for kind, verdict, words in _KINDS if verdict == failure.verdict and words in said)


def _failures(failures: Sequence[Failure]) -> Iterator[Element]:
    differing = Counter(
        _NAME.sub("…", found["of"])
        for failure in failures
        if (found := _DIFFERENCE.search(failure.difference or "")) and "/outcome:" not in found[0]
    )
    if differing:
        counted = ", ".join(f"{of} ({n})" for of, n in differing.most_common())
        yield element(
            "p", f"What differs first, where a revolute joint without limits counts as continuous: {counted}."
        )
    levels: defaultdict[tuple[str, str], dict[str, None]] = defaultdict(dict)
    for failure in failures:
        levels[_topic(failure), failure.title][f"{failure.level} of version {failure.version}"] = None
    items = (
        element(
            "li", element("code", topic), " ", *marked_up(title), " ", element("span", ", ".join(at), class_="soft")
        )
        for (topic, title), at in sorted(levels.items())
    )
    yield element("ul", *items)


def _topic(failure: Failure) -> str:
    return failure.id.partition("/")[0]


def _clauses(certificates: Sequence[Certificate]) -> Iterator[Element]:
    results = [{each.id: each for each in certificate.clauses} for certificate in certificates]
    texts = {id_: clause.text for id_, clause in read_clauses().items()}
    ids = sorted({id_ for of_one in results for id_ in of_one})
    differing = [id_ for id_ in ids if len({_is_met(of_one[id_]) for of_one in results if id_ in of_one}) > 1]
    title = "Clauses with different results"
    yield element("h2", f"{title} ({len(differing)} of {len(ids)})")
    if differing:
        rows = (
            (
                element("th", id_, element("div", *marked_up(texts.get(id_, "")), class_="says"), scope="row"),
                *(_clause_cell(of_one.get(id_)) for of_one in results),
            )
            for id_ in differing
        )
        yield table(title, ("clause", *_titles(certificates)), rows)


def _is_met(result: ClauseResult) -> bool:
    return result.passed == result.items


def _clause_cell(result: ClauseResult | None) -> Element:
    if result is None:
        return element("td", "not tested", class_="none")
    met = _is_met(result)
    return element("td", f"{'✓' if met else '✗'} {result.passed} of {result.items}", class_="good" if met else "bad")
