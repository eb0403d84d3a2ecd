"""The address of the documentation of a diagnostic."""

from __future__ import annotations

from functools import cache
from importlib.metadata import PackageNotFoundError, metadata


def help_uri(code: str) -> str:
    """The page of a code on the documentation site of the package, or else the code's URN.

    The site is the URL ``Documentation`` of the package's metadata (``[project.urls]`` in pyproject.toml). Without it,
    the result is ``urn:extended-urdf:…``, as for schemas.
    """
    site = _site()
    return f"{site}/diagnostics/{code}.html" if site else f"urn:extended-urdf:diagnostic:{code}"


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
