"""Three joints that are merged otherwise."""

from __future__ import annotations

import math
from dataclasses import replace
from typing import Any

from eurdf.linking import merging, replacement
from eurdf.linking.merging import Chain
from eurdf.mechanism.joint import Joint
from eurdf.mechanism.pose import Pose
from eurdf_conformance.mutants.deviation import Deviation, around, instead
from eurdf_conformance.mutants.mutant import mutant


def _chain(change: Any) -> Deviation:
    """What is known of the three joints is changed before they are merged."""
    return around(replacement, "merge", lambda original, chain, name: original(change(chain), name))


def _merged(change: Any) -> Deviation:
    """The three joints that merging leaves are changed."""
    return around(replacement, "merge", lambda original, chain, name: change(*original(chain, name)))


@mutant("EU-JNT-022")
def ball_at_the_last_origin() -> Deviation:
    """Merged joints turn about the origin of the last one, wherever their axes meet."""
    return _chain(lambda chain: replace(chain, point=chain.zero.xyz))


@mutant("EU-JNT-022")
def ball_at_the_first_origin() -> Deviation:
    """Merged joints turn about the origin of the first one, wherever their axes meet."""
    return _chain(lambda chain: replace(chain, point=chain.joints[0].placement.xyz))


@mutant("EU-JNT-022")
def ball_turned_as_the_first() -> Deviation:
    """The frame of merged joints has the orientation of the first one's."""

    def turned(first: Joint, second: Joint, ball: Joint) -> tuple[Joint, Joint, Joint]:
        return first, second, replace(ball, placement=Pose(ball.placement.xyz, first.placement.quaternion))

    return _merged(turned)


@mutant("EU-JNT-023")
def links_between_move_with_the_ball() -> Deviation:
    """The links between merged joints are fixed to the body behind them."""

    def moved(first: Joint, second: Joint, ball: Joint) -> tuple[Joint, Joint, Joint]:
        at = (ball.placement * ball.offset).inverse() * first.placement
        return replace(first, parent=ball.child, placement=at), second, ball

    return _merged(moved)


@mutant("EU-JNT-023")
def links_between_at_the_first_origin() -> Deviation:
    """The links between merged joints are all where the first one's origin is."""
    return _merged(lambda first, second, ball: (first, replace(second, placement=Pose()), ball))


@mutant("EU-JNT-024")
def properties_in_the_order_of_the_chain() -> Deviation:
    """The properties of merged joints are those of the first for x, of the second for y, of the third for z."""
    return instead(merging, "_nearest_axes", lambda chain: chain.joints)


@mutant("EU-JNT-024")
def properties_of_the_last() -> Deviation:
    """The properties of merged joints are those of the last one, for each axis."""
    return instead(merging, "_nearest_axes", lambda chain: chain.joints[2:] * 3)


@mutant("EU-JNT-024")
def properties_of_the_nearest_more_than_once() -> Deviation:
    """Each axis takes the properties of the joint nearest to it, though that one serve twice."""

    def nearest(chain: Chain) -> tuple[Joint, ...]:
        back = replace(chain.zero, xyz=(0.0, 0.0, 0.0)).inverse()
        near = [tuple(map(abs, back.rotate(direction))) for direction in chain.directions]
        return tuple(chain.joints[max(range(3), key=lambda joint: near[joint][axis])] for axis in range(3))

    return instead(merging, "_nearest_axes", nearest)


@mutant("EU-JNT-028")
def properties_by_rounding() -> Deviation:
    """Of two ways to give axes their joints that differ by rounding, the one with the larger sum is taken."""
    return instead(merging, "_AS_LARGE", 0.0)


@mutant("EU-JNT-024")
def properties_lost_by_merging() -> Deviation:
    """Merged joints have neither limits nor damping nor friction, as in the published loader."""

    def plain(first: Joint, second: Joint, ball: Joint) -> tuple[Joint, Joint, Joint]:
        lost = replace(ball, velocity=(math.inf,) * 3, effort=(math.inf,) * 3, damping=(0.0,) * 3, friction=(0.0,) * 3)
        return first, second, lost

    return _merged(plain)
