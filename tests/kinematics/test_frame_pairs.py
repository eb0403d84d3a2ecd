"""Pairs of frames are evaluated together with those that share joints with them."""

from __future__ import annotations

import pinocchio as pin
from hypothesis import given, settings
from hypothesis import strategies as st

from eurdf.pinocchio.frame_pairs import FramePairs, Site


def pairs_of(parents: list[int], ends: list[tuple[int, int]]) -> FramePairs:
    still = pin.SE3.Identity()
    pairs = [(Site(a, still), Site(b, still)) for a, b in ends]
    return FramePairs(pin.Model(), parents, pairs, None)


@st.composite
def trees_with_pairs(draw: st.DrawFn) -> FramePairs:
    count = draw(st.integers(2, 14))
    near = draw(st.integers(1, 14))  # small for chains, large for stars
    parents = [0, *(draw(st.integers(max(0, joint - near), joint - 1)) for joint in range(1, count))]
    index = st.integers(0, count - 1)
    return pairs_of(parents, draw(st.lists(st.tuples(index, index), max_size=8)))


@settings(deadline=None, max_examples=500)
@given(trees_with_pairs())
def test_clusters_are_pairs_that_share_joints(pairs: FramePairs) -> None:
    expected: list[tuple[set[int], set[int]]] = []
    for index, signs in enumerate(pairs._signs):
        sharing = [cluster for cluster in expected if cluster[1] & signs.keys()]
        expected = [cluster for cluster in expected if cluster not in sharing]
        expected.append(({index}.union(*(c[0] for c in sharing)), set(signs).union(*(c[1] for c in sharing))))
    found = [(set(which), joints) for which, joints in pairs._clusters]
    assert sorted(found, key=lambda cluster: min(cluster[0])) == sorted(expected, key=lambda cluster: min(cluster[0]))


def test_clusters_need_no_list_of_joints_for_each_pair() -> None:
    count = 2_000
    pairs = pairs_of([0, *range(count)], [(index, count) for index in range(count)])
    [(which, joints)] = pairs._clusters
    assert (len(which), len(joints)) == (count, count)
    assert "_signs" not in vars(pairs)
