"""Couplings that are closed by construction: at `assembled`, the sum of the products is the offset."""

from __future__ import annotations

from hypothesis import strategies as st
from hypothesis.strategies import DrawFn

from eurdf_conformance.oracle.coupling import COUPLED
from eurdf_conformance.properties.mechanism import Coupling, Mechanism
from eurdf_conformance.properties.strategies.numbers import decimals


@st.composite
def with_couplings(draw: DrawFn, mechanism: Mechanism) -> Mechanism:
    """A mechanism with at most two couplings, of other joints each."""
    joints = [
        joint.name for joint in mechanism.joints if mechanism.type_of(joint) in COUPLED and not mechanism.mimics(joint)
    ]
    if len(joints) < 2:
        return mechanism
    several = st.lists(st.sampled_from(joints), unique=True, min_size=2, max_size=3)
    at = mechanism.configurations["assembled"]
    couplings: list[Coupling] = []
    least = draw(st.sampled_from([0, 1, 1]))
    for names in draw(st.lists(several, unique_by=frozenset, min_size=least, max_size=2)):
        joined = {name: draw(decimals(-3, 3, 1).filter(bool)) for name in names}
        offset = sum(c * at[name][0] for name, c in joined.items())
        couplings.append(Coupling(name=f"coupling_{len(couplings) + 1}", joints=joined, offset=offset))
    return mechanism.replace(couplings=tuple(couplings))
