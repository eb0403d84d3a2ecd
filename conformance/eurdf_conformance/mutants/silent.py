"""Readers that build the robot all the same, as they may or must, and do not tell what is wrong with it."""

from __future__ import annotations

from functools import partial

from eurdf_conformance.mutants.deviation import Deviation
from eurdf_conformance.mutants.mutant import Mutant
from eurdf_conformance.mutants.of_the_reference import clause_of, issues

#: By the code that is not told.
_UNTOLD = {
    "near-miss-key": "A misspelt key of version 1 is the user's own, without a word.",
    "own-key-is-joint": "A joint whose name begins with x- is passed over, without a word.",
    "urdf-no-range": "That a joint cannot move is not told.",
    "urdf-unknown-element": "A misspelt element is passed over, without a word.",
    "urdf-closure-ignored": "A closure in another dialect is passed over, without a word.",
    "urdf-mimic-fixed": "The mimic of a fixed joint has no effect, without a word.",
    "urdf-mesh-missing": "Nobody looks whether meshes exist.",
    "urdf-texture-missing": "Nobody looks whether textures exist.",
    "urdf-unknown-material": "A material that is not defined is grey, without a word.",
    "urdf-planar-axis": "The axis of a planar joint is passed over, without a word.",
    "closure-type-unknown": "A closure of the user's own type is left out, without a word.",
    "negative-mass": "A mass may be negative.",
    "inertia-not-psd": "Whether an inertia is positive semidefinite is not looked at.",
    "inertia-triangle": "Whether an inertia obeys the triangle inequality is not looked at.",
    "leaf-without-inertia": "Whether what moves has inertia is not looked at.",
    "assembled-open": "Whether loops are closed at `assembled` is not looked at.",
    "closure-cannot-close": "Whether loops can close is not looked at.",
}


def _silence(code: str) -> Deviation:
    return issues(lambda found: [issue for issue in found if issue.code != code])


SILENT = tuple(
    Mutant(f"silent_of_{code.replace('-', '_')}", clause_of(code), breaks, partial(_silence, code))
    for code, breaks in _UNTOLD.items()
)
