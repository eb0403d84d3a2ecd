"""Random mechanisms: trees, and closed ones."""

from __future__ import annotations

from hypothesis import assume
from hypothesis import strategies as st
from hypothesis.strategies import DrawFn

from eurdf_conformance.level import Version
from eurdf_conformance.properties.conditioning import is_well_conditioned
from eurdf_conformance.properties.mechanism import Mechanism
from eurdf_conformance.properties.strategies.couplings import with_couplings
from eurdf_conformance.properties.strategies.loops import with_closures
from eurdf_conformance.properties.strategies.trees import trees


@st.composite
def mechanisms(draw: DrawFn, version: Version = "2", closures: int = 0, most: int = 6) -> Mechanism:
    """A mechanism that a version can express.

    Args:
        draw: Of Hypothesis.
        version: Of its description; 1 where both versions are to say it.
        closures: So many closures at least.
        most: So many joints at most, those that are merged into one counted as one.
    """
    tree = draw(trees(version, most))
    mechanism = draw(with_closures(tree, version, closures))
    if version == "2.1":
        mechanism = draw(with_couplings(mechanism))
    assume(len(mechanism.closures) >= closures)
    assume(is_well_conditioned(mechanism, version))
    return mechanism
