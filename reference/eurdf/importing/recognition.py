"""The format of a file, by its content."""

from __future__ import annotations

from pathlib import Path

from lxml import etree

from eurdf.diagnostics import FileError
from eurdf.format.version import VERSION_KEY
from eurdf.importing.exceptions import CannotImport
from eurdf.importing.xml_files import read_root, unreadable
from eurdf.reading.other_formats import ROOTS, OtherFormat, of_element, of_mapping, of_root
from eurdf.reading.robot_source import is_xml
from eurdf.reading.source import read_source
from eurdf.reading.yaml_reader import read_yaml


def recognized(path: Path) -> str:
    """The name of the format of a file.

    Raises:
        CannotImport: It is of no format that can be imported.
    """
    _refuse_yaml(path)
    root = read_root(path)
    found = _dialect(path, root) if root.tag == "robot" else of_root(str(root.tag))
    if found is None:
        expected = ", ".join(f"<{tag}>" for tag in ROOTS)
        raise CannotImport(path, f"its root element is <{root.tag}>; it must be one of {expected}")
    return found.importer


def _refuse_yaml(path: Path) -> None:
    """Refuse a file that describes loops in YAML, or is a description."""
    try:
        source = read_source(path)
    except FileError as error:
        raise unreadable(path, error.diagnostic) from None
    if is_xml(source):
        return
    try:
        data = read_yaml(source).data
    except FileError:
        return  # what is wrong with it as XML is reported
    if found := of_mapping(data):
        raise CannotImport(path, found.hint)
    if VERSION_KEY in data:
        raise CannotImport(path, "it is a description; use it as it is: `eurdf check`")


def _dialect(path: Path, root: etree._Element) -> OtherFormat:
    found = [(element, dialect) for element in root if (dialect := of_element(element))]
    if not found:
        raise CannotImport(
            path, "it is a URDF without loops of another dialect; use it as it is: `eurdf check`, `eurdf generate`"
        )
    element, dialect = next((each for each in found if each[1].importer), found[0])
    if not dialect.importer:
        raise CannotImport(path, f"{path.name}:{element.sourceline}: {dialect.hint}")
    return dialect
