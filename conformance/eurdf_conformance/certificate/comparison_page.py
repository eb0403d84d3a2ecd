"""Several certificates on one page: levels and topics by parser, what each gets wrong, and clauses that differ."""

from __future__ import annotations

from collections import Counter, defaultdict
from collections.abc import Iterator, Sequence

from eurdf_conformance.certificate.certificate import Certificate, ClauseResult, Failure
from eurdf_conformance.certificate.page import Element, element, marked_up, page, table
from eurdf_conformance.certificate.report import level_cell
from eurdf_conformance.certificate.summary import level_count, parser_title
from eurdf_conformance.corpus.clause import read_clauses
from eurdf_conformance.level import VERSIONS, Level


def comparison_page(certificates: Sequence[Certificate]) -> str:
    """The page as the text of its file; parsers are in the order given."""
    title = "Parsers of Extended URDF compared"
    parts = _parsers, _levels, _topics, _wrong, _clauses
    content = [content for part in parts for content in part(certificates)]
    return page(title, [element("h1", title), *content], "comparison")


def _parsers(certificates: Sequence[Certificate]) -> Iterator[Element]:
    yield element(
        "p",
        "Each parser was run for this page. Items passed of all items. ✓ certified, ✗ claimed but not certified.",
        class_="soft",
    )
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
    """For each parser the titles of the cases that it fails, once each, by topic."""
    yield element("h2", "What each parser gets wrong")
    for title, certificate in zip(_titles(certificates), certificates, strict=True):
        levels: defaultdict[tuple[str, str], dict[str, None]] = defaultdict(dict)
        for failure in certificate.failures:
            levels[_topic(failure), f"{failure.title} ({failure.verdict})"][f"{failure.version} {failure.level}"] = None
        if not levels:
            yield element("p", f"{title}: nothing at the levels that it claims.")
            continue
        items = (
            element("li", element("code", topic), f" {said} ", element("span", ", ".join(at), class_="soft"))
            for (topic, said), at in sorted(levels.items())
        )
        summary = f"{title} ({len(levels)})"
        yield element("details", element("summary", summary), element("ul", *items))


def _topic(failure: Failure) -> str:
    return failure.id.partition("/")[0]


def _clauses(certificates: Sequence[Certificate]) -> Iterator[Element]:
    results = [{each.id: each for each in certificate.clauses} for certificate in certificates]
    texts = {id_: clause.text for id_, clause in read_clauses().items()}
    ids = sorted({id_ for of_one in results for id_ in of_one})
    differing = [id_ for id_ in ids if len({_is_met(of_one.get(id_)) for of_one in results}) > 1]
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


def _is_met(result: ClauseResult | None) -> bool | None:
    return None if result is None else result.passed == result.items


def _clause_cell(result: ClauseResult | None) -> Element:
    if result is None:
        return element("td", "not tested", class_="none")
    met = _is_met(result)
    return element("td", f"{'✓' if met else '✗'} {result.passed} of {result.items}", class_="good" if met else "bad")
