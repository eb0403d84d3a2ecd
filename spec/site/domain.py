"""The named items of the site: clauses, diagnostics and the properties of the schemas."""

from __future__ import annotations

from collections.abc import Iterable, Iterator
from typing import ClassVar, NamedTuple

from docutils import nodes
from docutils.nodes import Element, Node, system_message
from sphinx.addnodes import pending_xref
from sphinx.builders import Builder
from sphinx.domains import Domain, ObjType
from sphinx.environment import BuildEnvironment
from sphinx.util.docutils import SphinxRole
from sphinx.util.nodes import make_refnode

NAME = "eurdf"


class Target(NamedTuple):
    """The place of a named item, and the tooltip of links to it; a diagnostic is a page, and its anchor is empty."""

    page: str
    anchor: str
    title: str


class SpecificationDomain(Domain):
    """Clauses, diagnostics and schema properties, by name."""

    name = NAME
    label = "Extended URDF"
    object_types: ClassVar = {
        "clause": ObjType("clause", "clause"),
        "code": ObjType("diagnostic", "code"),
        "property": ObjType("property", "property"),
    }
    initial_data: ClassVar = {"targets": {}}
    data_version = 1

    @property
    def targets(self) -> dict[tuple[str, str], Target]:
        """The place of each item, by kind and name."""
        targets: dict[tuple[str, str], Target] = self.data["targets"]
        return targets

    def note(self, what: str, name: str, title: str) -> None:
        """Record an item on the current page; its anchor is its name, but the page of a diagnostic is all about it."""
        page = self.env.current_document.docname
        if what == "code":
            self.targets[what, name] = Target(page, "", title)
            return
        self.targets[what, f"{page}#{name}" if what == "property" else name] = Target(page, name, title)
        # So that a Markdown link to the anchor is valid.
        self.env.domains.standard_domain.anonlabels[f"{page}#{name}"] = (page, name)

    def clear_doc(self, docname: str) -> None:
        """Remove the items of a page."""
        self.data["targets"] = {key: target for key, target in self.targets.items() if target.page != docname}

    def merge_domaindata(self, docnames: Iterable[str], otherdata: dict[str, dict[tuple[str, str], Target]]) -> None:
        """Merge the data of another process."""
        pages = set(docnames)
        self.targets.update({key: target for key, target in otherdata["targets"].items() if target.page in pages})

    def resolve_xref(
        self,
        env: BuildEnvironment,
        fromdocname: str,
        builder: Builder,
        typ: str,
        target: str,
        node: pending_xref,
        contnode: Element,
    ) -> nodes.reference | None:
        """The link to what a role names, or None if it does not exist."""
        found = self.targets.get((typ, target))
        if found is None:
            return None
        return make_refnode(builder, fromdocname, found.page, found.anchor, contnode, found.title)

    def resolve_any_xref(
        self,
        env: BuildEnvironment,
        fromdocname: str,
        builder: Builder,
        target: str,
        node: pending_xref,
        contnode: Element,
    ) -> list[tuple[str, nodes.reference]]:
        """Nothing: the role determines the kind of the target."""
        return []

    def get_objects(self) -> Iterator[tuple[str, str, str, str, str, int]]:
        """The items, by name: the search finds them, except diagnostics, which it finds as pages."""
        for (what, key), target in self.targets.items():
            name = target.anchor or key
            yield name, name, what, target.page, target.anchor, 1 if target.anchor else -1


class NameRole(SphinxRole):
    """A role that links to a clause or a diagnostic by its name."""

    def __init__(self, what: str) -> None:
        super().__init__()
        self.what = what

    def run(self) -> tuple[list[Node], list[system_message]]:
        """The link; it is resolved after all pages are read."""
        reference = reference_to(self.what, self.text, self.env.current_document.docname)
        self.set_source_info(reference)
        return [reference], []


def reference_to(what: str, name: str, page: str) -> pending_xref:
    """A link to a clause or a diagnostic, from a page."""
    text = nodes.literal(name, name, classes=["eu-ref", f"eu-ref-{what}"])
    return pending_xref(
        name, text, refdomain=NAME, reftype=what, reftarget=name, refdoc=page, refexplicit=False, refwarn=True
    )
