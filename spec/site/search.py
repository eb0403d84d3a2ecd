"""The words under which the search finds a section, in addition to those of its text.

How results are ordered is in ``static/scorer.js``.
"""

from __future__ import annotations

from docutils import nodes
from docutils.nodes import Node
from sphinx.addnodes import index
from sphinx.domains.index import IndexDirective
from sphinx.util.nodes import process_index_entry


class SectionIndexDirective(IndexDirective):
    """``{index}``: names words for the section that contains it.

    The directive of Sphinx has an anchor of its own, which can be empty. The search of Sphinx fails at a result without
    text.
    """

    def run(self) -> list[Node]:
        """The entries, which lead to the section."""
        section = self.state_machine.node
        if not isinstance(section, nodes.section):
            raise self.error("{index} must be in a section, to which the search leads")
        found = index(inline=False, entries=process_index_entry(self.arguments[0], section["ids"][0]))
        self.set_source_info(found)
        return [found]
