"""Plain URDF: the spanning tree, with the joint types and properties that URDF has."""

from __future__ import annotations

from eurdf.convert.export_format import ExportInput, ExportOutput, Format
from eurdf.convert.losses import Losses
from eurdf.convert.urdf.facts import EXACT, ROWS
from eurdf.convert.urdf.tree import PlainTree
from eurdf.writing.xml_text import file_content


def write(given: ExportInput, losses: Losses) -> ExportOutput:
    """Write the plain URDF of a robot: ``robot.urdf``, and its meshes in ``meshes/``."""
    tree = PlainTree(given, losses)
    tree.write()
    return ExportOutput({"robot.urdf": file_content(tree.root), **tree.meshes.files}, tree.coordinates)


FORMAT = Format("urdf", "the plain URDF of the spanning tree", write, ROWS, EXACT)
