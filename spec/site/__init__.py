"""What reads, checks and publishes the specification.

`blocks` cuts the Markdown into directives, code and prose; `clause` and `example` read what stands in them; `lint`
judges the text, `registry` draws the clauses from it, and `sphinx_extension` shows them on the site.
"""
