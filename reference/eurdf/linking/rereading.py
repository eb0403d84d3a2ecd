"""The mechanism that a text describes, before the text is written to a file."""

from __future__ import annotations

from eurdf.diagnostics import Diagnostics, FileError
from eurdf.format.read import read_description
from eurdf.format.urdf.data import Urdf
from eurdf.linking.link import link
from eurdf.mechanism.mechanism import Mechanism
from eurdf.reading.source import Source
from eurdf.reading.yaml_reader import read_yaml


def reread(text: str, urdf: Urdf, file: str) -> tuple[Mechanism | None, Diagnostics]:
    """Read and link the text of a description.

    Args:
        text: The description.
        urdf: The URDF it extends, whichever it names.
        file: What the findings call it.

    Returns:
        The mechanism, or None where an error was found; and what was found.
    """
    diagnostics = Diagnostics()
    try:
        document = read_yaml(Source(file, text, text.encode()))
    except FileError as error:
        diagnostics.add(error.diagnostic)
        return None, diagnostics
    description = read_description(document, diagnostics)
    if description is None:
        return None, diagnostics
    return link(urdf, description, diagnostics), diagnostics
