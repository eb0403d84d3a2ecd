"""Reads, checks and publishes the specification.

`blocks` cuts the Markdown into directives, code and prose; `clause` and `example` read their contents; `lint`
checks the text, `registry` writes its clauses for programs, and `sphinx_extension` shows them on the site.
"""
