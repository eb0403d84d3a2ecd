"""Plain URDF: the spanning tree, with the joint types and properties that URDF has."""

from __future__ import annotations

from eurdf.convert.export_format import ExportInput, ExportOutput, Format
from eurdf.convert.losses import Effect, Losses, LossKind
from eurdf.convert.urdf.tree import PLAIN_LOSSES, PlainTree
from eurdf.writing.xml_text import file_content


def _closure(kind: str) -> LossKind:
    return LossKind(
        f"export-{kind}-dropped",
        f"{kind} closure",
        Effect.DROPPED,
        "is left out: URDF has no loops",
        "keep the description beside the URDF, or export to a format with loops",
    )


LOSSES = (
    *(_closure(kind) for kind in ("3d", "6d", "hinge", "distance")),
    *PLAIN_LOSSES,
)


def write(given: ExportInput) -> ExportOutput:
    """Write the plain URDF of a robot: ``robot.urdf``, and its meshes in ``meshes/``."""
    mechanism, losses = given.mechanism, Losses(LOSSES)
    tree = PlainTree(given, losses)
    tree.write()
    for closure in mechanism.closures:
        losses.add(f"export-{closure.type}-dropped", closure.name)
    for coupling in mechanism.couplings:
        losses.add("export-coupling-dropped", coupling.name)
    return ExportOutput({"robot.urdf": file_content(tree.root), **tree.meshes.files}, losses.found, tree.coordinates)


FORMAT = Format("urdf", "the plain URDF of the spanning tree", write, LOSSES)
