"""What pages of the site refer to by name: clauses, diagnostics, and the properties of the schemas."""

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
    """Where something stands, and what is said of it where a pointer rests on a link to it."""

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
        """Where each thing stands, by what it is and its name."""
        targets: dict[tuple[str, str], Target] = self.data["targets"]
        return targets

    def note(self, what: str, name: str, title: str) -> None:
        """Take in something that stands on the page being read, at the anchor of its own name."""
        page = self.env.current_document.docname
        self.targets[what, f"{page}#{name}" if what == "property" else name] = Target(page, name, title)
        # So that a Markdown link with the anchor is known to lead somewhere.
        self.env.domains.standard_domain.anonlabels[f"{page}#{name}"] = (page, name)

    def clear_doc(self, docname: str) -> None:
        """Forget what stood on a page."""
        self.data["targets"] = {key: target for key, target in self.targets.items() if target.page != docname}

    def merge_domaindata(self, docnames: Iterable[str], otherdata: dict[str, dict[tuple[str, str], Target]]) -> None:
        """Take in what another process read."""
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
        """The link to what a role names, or None where there is no such thing."""
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
        """Nothing: what is meant is said by the role."""
        return []

    def get_objects(self) -> Iterator[tuple[str, str, str, str, str, int]]:
        """What the search finds by name."""
        for (what, _), target in self.targets.items():
            yield target.anchor, target.anchor, what, target.page, target.anchor, 1


class NameRole(SphinxRole):
    """A role that links to a clause or a diagnostic by its name."""

    def __init__(self, what: str) -> None:
        super().__init__()
        self.what = what

    def run(self) -> tuple[list[Node], list[system_message]]:
        """The link, which is resolved when all pages are read."""
        reference = reference_to(self.what, self.text, self.env.current_document.docname)
        self.set_source_info(reference)
        return [reference], []


def reference_to(what: str, name: str, page: str) -> pending_xref:
    """A link to a clause or a diagnostic, from a page."""
    text = nodes.literal(name, name, classes=["eu-ref", f"eu-ref-{what}"])
    return pending_xref(
        name, text, refdomain=NAME, reftype=what, reftarget=name, refdoc=page, refexplicit=False, refwarn=True
    )
