"""Chains of mimic joints: how the last depends on the joint that leads them all."""

from __future__ import annotations

from eurdf.diagnostics import Diagnostics
from eurdf.format.conventions import HINT, LARGEST, is_too_small, too_large, too_small
from eurdf.format.urdf.data import Urdf
from eurdf.mechanism.joint import drivers
from eurdf.mechanism.mechanism import Mechanism


def check_chains(mechanism: Mechanism, urdf: Urdf, diagnostics: Diagnostics) -> None:
    """EU-FIL-005: multiplier and offset of a mimic joint with respect to the leader of its chain are within bounds.

    One error for a robot: what mimics such a joint is beyond them too.

    Args:
        mechanism: A mechanism without errors.
        urdf: To point into.
        diagnostics: Gets what is found.
    """
    mimics = {joint.name: joint.mimic for joint in mechanism.joints if joint.mimic is not None}
    if all(mimic.joint not in mimics for mimic in mimics.values()):
        return
    for name, mimic in drivers(mimics).items():
        for attribute, value in (("multiplier", mimic.multiplier), ("offset", mimic.offset)):
            if abs(value) > LARGEST:
                what = too_large(value)
            elif attribute == "multiplier" and is_too_small(value):
                what = too_small(value)
            else:
                continue
            element = next(urdf.joints[name].element.iterchildren("mimic"))
            message = (
                f"'{attribute}' of joint '{name}' with respect to joint '{mimic.joint}' at the end of its chain is"
            )
            diagnostics.report(
                "number-out-of-bounds", f"{message} {what}", urdf.document.place(element, attribute), HINT
            )
            return
