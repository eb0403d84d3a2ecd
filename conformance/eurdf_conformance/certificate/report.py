"""A certificate as a page for people: what is certified, what failed and why, by level and by clause."""

from __future__ import annotations

import re
from collections import defaultdict
from collections.abc import Callable, Iterator, Mapping

from eurdf_conformance.certificate.certificate import Certificate, Failure
from eurdf_conformance.certificate.page import Element, element, facts, marked_up, page, table
from eurdf_conformance.certificate.summary import headline, level_words, parser_title
from eurdf_conformance.corpus.clause import read_clauses
from eurdf_conformance.judging.level_result import LevelResult
from eurdf_conformance.level import VERSIONS, Level

# Number of failures that are unfolded at first; a parser that fails everything fails hundreds of items.
_OPEN = 10


def report(certificate: Certificate) -> str:
    """The page as the text of its file."""
    texts = {id_: clause.text for id_, clause in read_clauses().items()}
    title = f"{parser_title(certificate)}: conformance to Extended URDF"
    if certificate.parser is None:
        return page(title, [*_head(certificate), *_no_start(certificate), *_run(certificate)])
    parts = _levels, _unexpected, _failures
    content = [content for part in parts for content in part(certificate)]
    return page(title, [*_head(certificate), *content, *_clauses(certificate, texts), *_run(certificate)])


def level_cell(
    result: LevelResult | None, words: Callable[[LevelResult], str] = level_words, tried: bool = False
) -> Element:
    """The result of a level as a table cell.

    Args:
        result: Of the level; None where the certificate does not have it.
        words: What says it.
        tried: Whether it is of a run that can certify nothing.
    """
    if result is None:
        return element("td", "not claimed", class_="none")
    if tried or not (result.claimed and result.asked):
        return element("td", level_words(result, tried), class_="none")
    mark, tone = ("✓", "good") if result.certified else ("✗", "bad")
    return element("td", f"{mark} {words(result)}", class_=tone)


def _head(certificate: Certificate) -> Iterator[Element]:
    parser = certificate.parser
    yield element("h1", parser_title(certificate))
    language = f", a parser in {parser.language}" if parser else ""
    date = f", {certificate.date}" if certificate.date else ""
    yield element("p", f"Conformance to Extended URDF{language}{date}", class_="soft")
    some = any(each.certified for each in certificate.levels)
    tone = "good" if certificate.certified else "part" if some else "bad"
    yield element("p", headline(certificate), class_=f"headline {tone}")


def _no_start(certificate: Certificate) -> Iterator[Element]:
    # Every item failed for one reason.
    yield from (element("pre", failure.difference) for failure in certificate.failures[:1] if failure.difference)


def _levels(certificate: Certificate) -> Iterator[Element]:
    yield element("h2", "Levels")
    rows = (
        (
            element("th", level.value, scope="row"),
            *(level_cell(certificate.at(version, level), tried=certificate.scope.smoke) for version in VERSIONS),
        )
        for level in Level
    )
    yield table("Levels by version", ("level", *(f"version {version}" for version in VERSIONS)), rows)


def _unexpected(certificate: Certificate) -> Iterator[Element]:
    if certificate.unexpected:
        yield element("h2", "Differences from the known failures")
        yield element("ul", *(element("li", sentence) for sentence in certificate.unexpected))


def _failures(certificate: Certificate) -> Iterator[Element]:
    if not certificate.failures:
        return
    yield element("h2", f"Failures ({len(certificate.failures)})")
    groups: defaultdict[tuple[str, Level], list[Failure]] = defaultdict(list)
    for failure in certificate.failures:
        groups[failure.version, failure.level].append(failure)
    is_short = len(certificate.failures) <= _OPEN
    for (version, level), failures in sorted(
        groups.items(), key=lambda group: (group[0][0], list(Level).index(group[0][1]))
    ):
        yield element("h3", f"Version {version}, {level} ({len(failures)})")
        for failure in failures:
            yield _failure(failure, is_short)


def _failure(failure: Failure, is_open: bool) -> Element:
    known = " (known)" if failure.known else ""
    whole = element(
        "details",
        element(
            "summary",
            element("span", f"{failure.verdict}{known}", class_="verdict"),
            " ",
            element("code", f"{failure.id}/{failure.level}"),
            f" {failure.title}",
        ),
        *([element("pre", failure.difference)] if failure.difference else []),
        element("p", "Clauses: ", *_listed([_link(f"clause-{id_}", id_) for id_ in failure.clauses])),
        *([element("p", "Run it again: ", element("code", failure.reproduce))] if failure.reproduce else []),
        class_="failure",
        id=_anchor(failure),
    )
    if is_open:
        whole.set("open", "")
    return whole


def _clauses(certificate: Certificate, texts: Mapping[str, str]) -> Iterator[Element]:
    if not certificate.clauses:
        return
    failures: defaultdict[str, list[Failure]] = defaultdict(list)
    for failure in certificate.failures:
        for id_ in failure.clauses:
            failures[id_].append(failure)
    broken = [each for each in certificate.clauses if each.passed < each.items]
    met = [each for each in certificate.clauses if each.passed == each.items]
    for title, clauses in (("Clauses not met", broken), ("Clauses met", met)):
        if not clauses:
            continue
        yield element("h2", f"{title} ({len(clauses)})")
        rows = []
        for each in clauses:
            links = [_link(_anchor(failure), f"{failure.id}/{failure.level}") for failure in failures[each.id]]
            why = [element("div", *_listed(links), class_="soft")] if links else []
            rows.append(
                (
                    element("th", each.id, scope="row", class_="clause", id=f"clause-{each.id}"),
                    element("td", *marked_up(texts.get(each.id, "")), *why),
                    element("td", f"{each.passed} of {each.items}", class_="number"),
                )
            )
        whole = table(title, ("clause", "requirement", "passed"), rows)
        yield whole if clauses is broken else element("details", element("summary", "Show them"), whole)


def _run(certificate: Certificate) -> Iterator[Element]:
    suite, scope = certificate.suite, certificate.scope
    yield element("h2", "The run")
    yield facts(
        [
            ("--parser", certificate.parser_option),
            ("levels requested", ", ".join(scope.levels)),
            ("versions requested", ", ".join(scope.versions)),
            *([("further mechanisms", f"{scope.explore} for each property")] if scope.explore else []),
            ("seed", f"{scope.seed}"),
            *([("fresh cases", scope.fresh)] if scope.fresh else []),
            ("suite", suite.version),
            ("protocol", suite.protocol),
            ("clauses", suite.clauses),
            ("corpus", suite.corpus),
        ]
    )


def _listed(parts: list[Element]) -> Iterator[str | Element]:
    for index, part in enumerate(parts):
        if index:
            yield ", "
        yield part


def _link(anchor: str, text: str) -> Element:
    return element("a", text, href=f"#{anchor}")


def _anchor(failure: Failure) -> str:
    # Unique, since ids of cases consist of letters and digits.
    return re.sub(r"[^A-Za-z0-9_-]", "-", f"item-{failure.id}-{failure.level}")
