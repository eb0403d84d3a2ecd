"""The Sphinx extension that shows the specification as a site."""

from __future__ import annotations

from typing import Any

from sphinx.application import Sphinx

from spec.site import accessible, api, figures, math, pages, robots
from spec.site.directives import DIRECTIVES
from spec.site.domain import NameRole, SpecificationDomain
from spec.site.search import SectionIndexDirective


def setup(app: Sphinx) -> dict[str, Any]:
    """Add the directives, the roles, and the rendering of equations and drawings."""
    app.add_domain(SpecificationDomain)
    for name, directive in DIRECTIVES.items():
        app.add_directive(name, directive)
    app.add_directive("index", SectionIndexDirective, override=True)
    for what in ("clause", "code"):
        app.add_role(what, NameRole(what), override=True)
    accessible.setup(app)
    math.setup(app)
    figures.setup(app)
    pages.setup(app)
    api.setup(app)
    robots.setup(app)
    return {"version": "1", "parallel_read_safe": True, "parallel_write_safe": True}
