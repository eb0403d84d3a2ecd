"""The pages of the diagnostics: an index, and one page for each code.

The text states all of them in one file, ``diagnostics.md``. When the site is built, each ``{diagnostic}`` of that file
becomes a page, and those that follow each other become a table whose rows lead to their pages.
"""

from __future__ import annotations

import re
from pathlib import Path

#: The page of the index, and the folder of the pages of the codes.
PAGE, FOLDER = "diagnostics.md", "diagnostics"

_HEADING = r"^#+ +(?P<heading>.+)$"
_ENTRIES = r"(?P<entries>(?:^:::\{diagnostic\} .*\n(?:(?!:::).*\n)*:::\n\n*)+)"
_SECTION = re.compile(f"{_HEADING}|{_ENTRIES}", re.M)
_ENTRY = re.compile(r"^:::\{diagnostic\} (?P<code>\S+)\n.*?^:::$", re.M | re.S)

# A link to another page, which is in the folder above that of the codes.
_LINK = re.compile(r"(?<=\]\()(?=[\w.]+\.md\b)")


def write_diagnostic_pages(folder: Path) -> None:
    """Write the source of the page of each code, and the index in place of the entries.

    Args:
        folder: The folder that Sphinx reads pages from; without a file of diagnostics, nothing is done.
    """
    page = folder / PAGE
    if not page.exists():
        return
    pages = folder / FOLDER
    pages.mkdir()
    heading = ""

    def without_entries(found: re.Match[str]) -> str:
        nonlocal heading
        if found["heading"]:
            heading = found["heading"]
            return found[0]
        for entry in _ENTRY.finditer(found["entries"]):
            (pages / f"{entry['code']}.md").write_text(_page(entry["code"], heading, entry[0]), encoding="utf-8")
        codes = "\n".join(entry["code"] for entry in _ENTRY.finditer(found["entries"]))
        return f":::{{diagnostics}}\n{codes}\n:::\n\n"

    page.write_text(_SECTION.sub(without_entries, page.read_text(encoding="utf-8")), encoding="utf-8")


def _page(code: str, section: str, entry: str) -> str:
    """The source of the page of a code; it is in no table of contents, which every page repeats."""
    anchor = section.lower().replace(" ", "-")
    above = f"[Diagnostics](/{PAGE}): [{section}](/{PAGE}#{anchor})"
    return f"---\norphan: true\n---\n\n# {code}\n\n{above}\n\n{_LINK.sub('/', entry)}\n"
