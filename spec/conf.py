"""How Sphinx builds the site: ``python -m spec.site``."""

import sys
from pathlib import Path

sys.path.insert(0, str(Path(__file__).resolve().parents[1]))

from spec.site.pages import address

project = "Extended URDF"
author = "the Extended URDF authors"
html_title = "Extended URDF"
language = "en"

extensions = ["myst_parser", "sphinx_copybutton", "spec.site.sphinx_extension"]

nitpicky = True
smartquotes = False  # what stands in the text is what one types
highlight_language = "none"

# The Python reference: docstrings are in the style of Google; an attribute is documented in that of its class.
default_role = "docstring-name"
autodoc_type_aliases = {name: name for name in ("Indices", "Mask", "Matrix", "Vector")}
autodoc_default_options = {"members": True}
autodoc_member_order = "bysource"
autodoc_preserve_defaults = True
napoleon_numpy_docstring = False
napoleon_attr_annotations = False

myst_enable_extensions = ["attrs_inline", "colon_fence", "deflist", "dollarmath"]
myst_heading_anchors = 4
# "page" leads to a page that Sphinx does not make.
myst_url_schemes = {**dict.fromkeys(("http", "https", "mailto")), "page": "{{path}}"}

html_theme = "furo"
html_baseurl = address("Documentation") + "/"
html_math_renderer = "mathml"
html_favicon = "site/static/favicon.svg"
html_static_path = ["site/static"]
html_css_files = ["specification.css"]
html_js_files = ["specification.js"]
html_search_scorer = str(Path(__file__).parent / "site" / "static" / "scorer.js")
html_extra_path = ["../schema", "clauses.json", "clauses.schema.json"]
html_copy_source = False
html_show_sourcelink = False
html_use_index = False
html_show_copyright = False
html_theme_options = {"top_of_page_buttons": []}

copybutton_prompt_text = "$ "  # what a transcript prints is not copied
copybutton_exclude = ".linenos, .gp, .go"

toc_object_entries_show_parents = "hide"

linkcheck_timeout = 20
linkcheck_anchors = False  # pages that make their anchors by a script would seem to lack them
