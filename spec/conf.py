"""How Sphinx builds the site: ``python -m spec.site``."""

import sys
from pathlib import Path

sys.path.insert(0, str(Path(__file__).resolve().parents[1]))

from spec.site.pages import address

project = "Extended URDF"
author = "the Extended URDF authors"
html_title = "Extended URDF 2.0"
language = "en"

extensions = ["myst_parser", "spec.site.sphinx_extension"]

nitpicky = True
smartquotes = False  # what stands in the text is what one types
highlight_language = "none"

myst_enable_extensions = ["attrs_inline", "colon_fence", "deflist", "dollarmath"]
myst_heading_anchors = 4

html_theme = "furo"
html_baseurl = address("Documentation") + "/"
html_math_renderer = "mathml"
html_static_path = ["site/static"]
html_css_files = ["specification.css"]
html_extra_path = ["../schema", "clauses.json", "clauses.schema.json"]
html_copy_source = False
html_show_sourcelink = False
html_use_index = False
html_show_copyright = False
html_theme_options = {"top_of_page_buttons": []}

linkcheck_timeout = 20
linkcheck_anchors = False  # pages that make their anchors by a script would seem to lack them
