"""The address of the documentation of a diagnostic."""

from __future__ import annotations

from functools import cache
from importlib.metadata import PackageNotFoundError, metadata

# The page of the specification's site that has every code, each at the anchor of its name.
_PAGE = "diagnostics.html"


def help_uri(code: str) -> str:
    """The page of a code on the site that the package names as its documentation, or else the code's URN.

    The site is the URL ``Documentation`` of the package's metadata (``[project.urls]`` in pyproject.toml). A package
    without one names its codes as it names its schemas, ``urn:extended-urdf:…``.
    """
    site = _site()
    return f"{site}/{_PAGE}#{code}" if site else f"urn:extended-urdf:diagnostic:{code}"


@cache
def _site() -> str | None:
    try:
        urls: list[str] = metadata("eurdf").get_all("Project-URL") or []
    except PackageNotFoundError:
        return None
    for url in urls:
        label, _, address = url.partition(",")
        if label.strip().lower() == "documentation":
            return address.strip().rstrip("/")
    return None
