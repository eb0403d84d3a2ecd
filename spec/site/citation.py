"""Functions that enforce a clause (their docstring cites it, or they report its diagnostic), and cases that cite it."""

from __future__ import annotations

import ast
import re
from collections.abc import Iterable, Iterator
from dataclasses import dataclass
from pathlib import Path

import yaml

from eurdf.diagnostics import REGISTRY
from eurdf_conformance.corpus import protocol_rule
from spec.site.clause import ROOT

#: Folders of packages whose functions enforce clauses.
PACKAGES = (ROOT / "reference", ROOT / "conformance")

#: Parts of the suite whose functions cite clauses without enforcing them.
NOT_ENFORCING = frozenset({"corpus", "judging", "oracle", "properties", "suite"})

#: The cases of the conformance suite.
CORPUS = ROOT / "conformance" / "eurdf_conformance" / "corpus" / "cases"

# The loader of libyaml is ten times as fast.
_Loader: type[yaml.SafeLoader] = getattr(yaml, "CSafeLoader", yaml.SafeLoader)

# An id, and short forms of further ids after it: "EU-URD-009, -010, -014 to -018, and EU-INR-002".
_CITED = re.compile(r"(?P<family>EU-[A-Z]{3}-)(?P<number>[0-9]{3})(?P<more>(?:(?:,? and |, | to )-[0-9]{3})*)")
# What a file contains that cites a clause: to look for it is far quicker than to parse the file.
_MENTIONED = re.compile("|".join(["EU-[A-Z]{3}-", *map(re.escape, REGISTRY)]))
_MORE = re.compile(r"(?P<to> to )?-(?P<number>[0-9]{3})")
_SPELLED_OUT = re.compile(r"(?P<family>EU-[A-Z]{3})-(?P<first>[0-9]{3}) to (?P=family)-(?P<last>[0-9]{3})")


@dataclass(frozen=True, slots=True)
class Citation:
    """A citation of a clause.

    Attributes:
        clause: Id of the clause.
        source: Qualified name of the function or class, or the name of the case.
        path: Its file.
        line: Line of the function, class or case there.
    """

    clause: str
    source: str
    path: Path
    line: int


def cited(text: str) -> list[str]:
    """Ids of the clauses that a text cites; ``EU-URD-014 to -018`` cites five."""
    text = _SPELLED_OUT.sub(r"\g<family>-\g<first> to -\g<last>", text)
    ids: dict[str, None] = {}
    for match in _CITED.finditer(text):
        numbers = [int(match["number"])]
        for more in _MORE.finditer(match["more"]):
            number = int(more["number"])
            numbers.extend(range(numbers[-1] + 1, number + 1) if more["to"] else [number])
        ids.update(dict.fromkeys(f"{match['family']}{number:03}" for number in numbers))
    return list(ids)


def function_citations(packages: Iterable[Path] = PACKAGES) -> list[Citation]:
    """The clauses that functions, classes and methods enforce, by qualified name.

    A function enforces what its docstring cites, and the clause of a diagnostic that it names in its code.

    Args:
        packages: Folders of import packages.
    """
    return [
        citation
        for package in packages
        for path in sorted(package.rglob("*.py"))
        if NOT_ENFORCING.isdisjoint(path.relative_to(package).parts)
        for citation in citations_in(path, package)
    ]


def case_citations(corpus: Path = CORPUS) -> list[Citation] | None:
    """The clauses that cases of the conformance suite cite, by topic and name; None if there is no suite."""
    if not corpus.is_dir():
        return None
    citations = []
    for path in sorted(corpus.rglob("*.yaml")):
        case = yaml.load(path.read_text(encoding="utf-8"), _Loader) or {}
        name = path.relative_to(corpus).with_suffix("").as_posix()
        citations += [Citation(clause, name, path, 1) for clause in case.get("clauses", [])]
    return citations


def suite_citations() -> list[Citation] | None:
    """The clauses that the conformance suite cites; None if there is no suite.

    A rule of the protocol counts as a case named ``protocol/`` and the name of the rule.
    """
    cases = case_citations()
    path = Path(protocol_rule.__file__)
    return cases and [
        *cases,
        *(
            Citation(clause, f"protocol/{rule.name}", path, 1)
            for rule in vars(protocol_rule).values()
            if isinstance(rule, protocol_rule.ProtocolRule)
            for clause in rule.clauses
        ),
    ]


def citations_in(path: Path, package: Path) -> list[Citation]:
    """The clauses that the functions, classes and methods of one file cite.

    Args:
        path: The file.
        package: The folder that its import name begins in.
    """
    parts = list(path.relative_to(package).with_suffix("").parts)
    if parts[-1] == "__init__":
        del parts[-1]
    text = path.read_text(encoding="utf-8")
    if not _MENTIONED.search(text):
        return []
    tree = ast.parse(text, str(path))
    citations = []
    for name, definition in _definitions(tree, ".".join(parts)):
        of_codes = (REGISTRY[code].clause for code in _codes(definition))
        clauses = [*cited(ast.get_docstring(definition) or ""), *(clause for clause in of_codes if clause is not None)]
        citations += [Citation(clause, name, path, definition.lineno) for clause in dict.fromkeys(clauses)]
    return citations


def _codes(definition: ast.AST) -> Iterator[str]:
    """Codes of diagnostics in the code of a function or class, without those in nested functions."""
    for node in ast.iter_child_nodes(definition):
        if isinstance(node, ast.Constant) and isinstance(node.value, str) and node.value in REGISTRY:
            yield node.value
        if not isinstance(node, ast.FunctionDef | ast.AsyncFunctionDef | ast.ClassDef):
            yield from _codes(node)


def _definitions(
    parent: ast.AST, scope: str
) -> Iterator[tuple[str, ast.FunctionDef | ast.AsyncFunctionDef | ast.ClassDef]]:
    for node in ast.iter_child_nodes(parent):
        if isinstance(node, ast.FunctionDef | ast.AsyncFunctionDef | ast.ClassDef):
            name = f"{scope}.{node.name}"
            yield name, node
            yield from _definitions(node, name)
        else:
            yield from _definitions(node, scope)
