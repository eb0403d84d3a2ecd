"""The reference of the Python functions: ``{api}`` lists public names, and autodoc shows their docstrings."""

from __future__ import annotations

import importlib
import inspect
import re
from collections.abc import Mapping
from functools import cache
from typing import Any, ClassVar

from docutils import nodes
from docutils.nodes import Element, Node, system_message
from docutils.parsers.rst import directives
from sphinx.addnodes import desc_content, pending_xref
from sphinx.application import Sphinx
from sphinx.environment import BuildEnvironment
from sphinx.util.docutils import SphinxDirective, SphinxRole
from sphinx.util.inspect import stringify_signature
from sphinx.util.typing import stringify_annotation

import eurdf
from eurdf.diagnostics import REGISTRY
from spec.site.domain import reference_to

PACKAGE = "eurdf"

#: The public modules, except that of batches.
DOORS = ("results", "errors", "kinematics", "springs", "transmissions", "convert", "viewing")

# Modules that need an extra: their names are documented on a page of their own.
_ADAPTERS = ("crocoddyl", "pink")

# Marks the reference of a name in backticks.
_QUOTED = "eu-quoted"

#: Types that the first page explains, and those of other packages.
EXPLAINED = frozenset({"ArrayLike", "Executor", "Matrix", "Named", "Path", "RobotSource", "Vector", "os.PathLike"})

# A name in an annotation that may be an alias.
_ALIAS = re.compile(r"(?<![\w.'\"])[A-Z]\w*\b(?![.'\"])")

# What is below the line, after one letter: B_J, τ_m.
_SUBSCRIPT = re.compile(r"(?:(?<=\b[^\W\d_])|(?<=[²Δ][^\W\d_]))_([A-Za-z]{1,2})(?![A-Za-z0-9_(])")

# A name in the text of a page; a file such as eurdf.yaml is none.
_PUBLIC_NAME = re.compile(rf"{PACKAGE}(?!\.(?:{'|'.join(_ADAPTERS)})\b)(\.[A-Za-z]\w*)+")

# The module of a type, where Sphinx writes that it need not be shown.
_QUALIFIED = re.compile(r"~(?:\w+\.)*")

_CODE = re.compile(r"(`+[^`]*`+)")
_CLAUSE = re.compile(r"(?<![`\w-])EU-[A-Z]{3}-[0-9]{3}(?!`)")


class ApiDirective(SphinxDirective):
    """``{api}``: public functions and classes, one name per line; ``:of: eurdf.batch`` names another module.

    ``:home:`` makes this place the one that links to the module lead to.
    """

    has_content = True
    option_spec: ClassVar = {"of": directives.unchanged_required, "home": directives.flag}

    def run(self) -> list[Node]:
        """Their documentation."""
        module = self.options.get("of", PACKAGE)
        entries = [f"{_directive_of(module, name)}:: {module}.{name}" for name in "\n".join(self.content).split()]
        scope = f".. py:{'module' if 'home' in self.options else 'currentmodule'}:: {module}\n"
        lines = ["```{eval-rst}", scope, *(f".. {entry}\n" for entry in entries), "```"]
        return self.parse_text_to_nodes("\n".join(lines), offset=self.content_offset)


def _directive_of(module: str, name: str) -> str:
    value = getattr(importlib.import_module(module), name)
    if inspect.isclass(value):
        return "autoexception" if issubclass(value, BaseException) else "autoclass"
    return "autofunction" if inspect.isfunction(value) else "autodata"


class DocstringName(SphinxRole):
    """What a docstring has in single backticks: a link to the public name or diagnostic, or else code."""

    def run(self) -> tuple[list[Node], list[system_message]]:
        """The link; it is resolved after all pages are read."""
        if self.text in REGISTRY:
            return [reference_to("code", self.text, self.env.current_document.docname)], []
        reference = _reference(
            self.text, nodes.literal("", self.text, classes=["py", "py-obj"]), self.env.current_document.docname
        )
        for scope in ("py:module", "py:class"):
            reference[scope] = self.env.ref_context.get(scope)
        self.set_source_info(reference)
        return [reference], []


def _reference(name: str, shown: nodes.literal, page: str) -> pending_xref:
    """A link to the documentation of a name, which is resolved after all pages are read."""
    options = {"refdoc": page, "refexplicit": False, "refwarn": False, _QUOTED: True}
    return pending_xref("", shown, refdomain="py", reftype="obj", reftarget=name, **options)


def _signature(
    app: Sphinx, what: str, name: str, value: Any, options: Any, shown: str | None, returned: str | None
) -> tuple[str, str] | None:
    """The signature with the annotations of the source; an alias that is not public becomes what it means.

    Classes have none: functions return their objects.
    """
    if what in ("class", "exception"):
        return None if shown is None else ("", "")
    if what not in ("function", "method") or not inspect.isfunction(value):
        return None
    signature = inspect.signature(value)
    names = inspect.getmodule(inspect.unwrap(value)).__dict__
    parameters = [
        each.replace(annotation=_spelled_out(each.annotation, names)) for each in signature.parameters.values()
    ]
    shown = stringify_signature(
        signature.replace(parameters=parameters[1:] if what == "method" else parameters), show_return_annotation=False
    )
    result = signature.return_annotation
    return shown, "" if result is signature.empty else _spelled_out(result, names)


def _spelled_out(annotation: Any, names: Mapping[str, Any]) -> Any:
    """An annotation with aliases of types in place of their names, except those that the pages explain."""
    if not isinstance(annotation, str):
        return annotation

    def meaning(match: re.Match[str]) -> str:
        value = names.get(match[0])
        if (
            value is None
            or isinstance(value, type)
            or match[0] in EXPLAINED
            or value.__class__.__module__ == "builtins"
        ):
            return match[0]
        return _QUALIFIED.sub("", stringify_annotation(value, "smart"))

    return _ALIAS.sub(meaning, annotation)


def _docstring(app: Sphinx, what: str, name: str, value: Any, options: Any, lines: list[str]) -> None:
    """Make a docstring reStructuredText: link the clauses that it cites; a bar and what is returned are plain text."""
    returns = what in ("attribute", "property")
    for index, line in enumerate(lines):
        pieces = _CODE.split(line)
        pieces[::2] = [_CLAUSE.sub(r":clause:`\g<0>`", text).replace("|", r"\|") for text in pieces[::2]]
        lines[index] = "".join(pieces)
        if returns and line.strip():  # else words before a colon would be taken for a type
            indent = len(line) - len(line.lstrip())
            lines[index] = f"{lines[index][:indent]}: {lines[index][indent:]}"
        returns = line.strip() == "Returns:"


def _without_contents(app: Sphinx, what: str, name: str, value: Any, options: Any, lines: list[str]) -> None:
    """Leave attributes out of the contents of the page: they are many, and each page copies the contents of all."""
    for index in reversed(range(len(lines))):
        before, found, _ = lines[index].partition(".. attribute::")
        if found and not before.strip():
            lines.insert(index + 1, f"{before}   :no-contents-entry:")


def _skipped(app: Sphinx, what: str, name: str, value: Any, skip: bool, options: Any) -> bool | None:
    """Leave out the fields of a named tuple as members: the docstring of the class explains them."""
    return True if type(value).__name__ == "_tuplegetter" else None


def _typeset(app: Sphinx, document: nodes.document) -> None:
    """In docstrings, show a colon after the name of a parameter instead of two hyphens, and subscripts as such."""
    for shown in document.findall(desc_content):
        for text in list(shown.findall(nodes.Text)):
            if text.parent is None or isinstance(text.parent, nodes.literal | nodes.literal_block | nodes.subscript):
                continue
            pieces = _SUBSCRIPT.split(": " if text == " -- " else text)
            if len(pieces) > 1 or pieces[0] != text:
                made = [nodes.subscript("", each) if n % 2 else nodes.Text(each) for n, each in enumerate(pieces)]
                text.parent.replace(text, made)


def _link_names(app: Sphinx, document: nodes.document) -> None:
    """Link each public name in the text of a page, as `eurdf.load`, to its documentation."""
    for literal in list(document.findall(nodes.literal)):
        text, parent = literal.astext(), literal.parent
        if _PUBLIC_NAME.fullmatch(text) and not isinstance(parent, nodes.reference | pending_xref):
            parent.replace(literal, _reference(text, literal.deepcopy(), app.env.current_document.docname))


def _unresolved(app: Sphinx, env: BuildEnvironment, node: pending_xref, text: Element) -> Element | None:
    """A type that has no page is text, and so is what is in backticks unless it is a dotted name of the package."""
    if node["refdomain"] != "py":
        return None
    is_public_name = node.get(_QUOTED) and str(node["reftarget"]).startswith(f"{PACKAGE}.")
    return None if is_public_name else text


def _qualify(app: Sphinx, document: nodes.document) -> None:
    """Complete public names with their modules: docstrings have them without."""
    for node in document.findall(pending_xref):
        first = str(node["reftarget"]).partition(".")[0]
        if node["refdomain"] == "py" and first in _modules():
            of_batches = node.get("py:module") == eurdf.batch.__name__ and hasattr(eurdf.batch, first)
            node["reftarget"] = f"{eurdf.batch.__name__ if of_batches else _modules()[first]}.{node['reftarget']}"
            node.attributes.pop("refspecific", None)


@cache
def _modules() -> dict[str, str]:
    """The module of each public name, except those of batches, which are also names for one robot."""
    modules = (eurdf, *(getattr(eurdf, each) for each in DOORS))
    found = ((name, getattr(each, name), each.__name__) for each in reversed(modules) for name in dir(each))
    return {name: module for name, value, module in found if str(getattr(value, "__module__", "")).startswith(PACKAGE)}


def setup(app: Sphinx) -> None:
    """Add the directive and the role, and connect to autodoc."""
    app.setup_extension("sphinx.ext.autodoc")
    app.setup_extension("sphinx.ext.napoleon")
    app.add_directive("api", ApiDirective)
    app.add_role("docstring-name", DocstringName())
    app.connect("autodoc-process-signature", _signature)
    app.connect("autodoc-process-docstring", _docstring, priority=400)  # before napoleon
    app.connect("autodoc-process-docstring", _without_contents, priority=600)  # after napoleon
    app.connect("autodoc-skip-member", _skipped)
    app.connect("doctree-read", _typeset)
    app.connect("doctree-read", _link_names)
    app.connect("doctree-read", _qualify)
    app.connect("missing-reference", _unresolved)
