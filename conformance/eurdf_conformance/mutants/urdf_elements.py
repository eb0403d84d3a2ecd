"""What stands in elements that have no effect, or in names, scales and axes that are unusual, read by other rules."""

from __future__ import annotations

import math
from typing import Any

from eurdf.format import urdf
from eurdf.format.urdf import _AXLESS, _RANGED, _Reader
from eurdf.mechanism.joint_type import JointType
from eurdf_conformance.mutants.deviation import Deviation, around, instead
from eurdf_conformance.mutants.mutant import mutant
from eurdf_conformance.mutants.of_the_reference import refused_by_urdf


@mutant("EU-URD-024")
def mirrored_mesh_refused() -> Deviation:
    """The scale of a mesh must be positive."""
    return refused_by_urdf(
        lambda read: any("-" in element.get("scale", "") for element in read.document.root.iter("mesh"))
    )


def _limits_unread(kinds: frozenset[JointType]) -> Deviation:
    """The limits of joints of some types are not read."""
    return around(
        _Reader,
        "limit",
        lambda original, self, name, kind, joint, element: (
            None if kind in kinds else original(self, name, kind, joint, element)
        ),
    )


@mutant("EU-URD-005")
def limits_of_fixed_joints_are_not_read() -> Deviation:
    """What a limit of a fixed joint lacks is passed over."""
    return _limits_unread(frozenset({JointType.FIXED}))


@mutant("EU-URD-005")
def limits_of_floating_joints_are_not_read() -> Deviation:
    """What a limit of a floating joint lacks is passed over."""
    return _limits_unread(frozenset({JointType.FLOATING}))


@mutant("EU-URD-005", versions=("2",))
def limits_of_planar_joints_are_not_read() -> Deviation:
    """What a limit of a planar joint lacks is passed over."""
    return _limits_unread(frozenset({JointType.PLANAR}))


@mutant("EU-URD-005", versions=("2",))
def limits_of_continuous_joints_are_not_read() -> Deviation:
    """What a limit of a continuous joint lacks is passed over."""
    return _limits_unread(frozenset({JointType.CONTINUOUS}))


@mutant("EU-URD-020")
def negative_limits_of_fixed_joints() -> Deviation:
    """A fixed joint may have a negative effort."""
    return _limits_unread(frozenset({JointType.FIXED}))


@mutant("EU-URD-005")
def axes_without_effect_are_not_read() -> Deviation:
    """What the axis of a fixed or floating joint lacks is passed over."""
    return around(
        _Reader,
        "axis",
        lambda original, self, name, kind, element: original(self, name, kind, None if kind in _AXLESS else element),
    )


@mutant("EU-URD-019")
def reversed_limits_of_any_joint() -> Deviation:
    """A lower limit may be above the upper one in no joint, be it continuous or fixed."""

    def reversed_anywhere(read: Any) -> bool:
        limits = [joint.limit for joint in read.joints.values() if joint.type not in _RANGED and joint.limit]
        return any(limit.lower > limit.upper for limit in limits)

    return refused_by_urdf(reversed_anywhere)


@mutant("EU-URD-013")
def zero_axis_of_a_fixed_joint_refused() -> Deviation:
    """The axis of a fixed joint may not be zero, which exporters write."""

    def zero(read: Any) -> bool:
        axes = [joint.element.find("axis") for joint in read.joints.values() if joint.type in _AXLESS]
        return any(axis is not None and axis.get("xyz") == "0 0 0" for axis in axes)

    return refused_by_urdf(zero)


@mutant("EU-URD-013")
def short_axis_is_zero() -> Deviation:
    """An axis whose square is too small for a double has no direction."""

    def underflow(read: Any) -> bool:
        axes = [joint.element.find("axis") for joint in read.joints.values() if joint.type not in _AXLESS]
        said = [[float(each) for each in axis.get("xyz").split()] for axis in axes if axis is not None]
        return any(sum(each * each for each in axis) == 0.0 for axis in said)

    return refused_by_urdf(underflow)


@mutant("EU-URD-035")
def long_axis_is_x() -> Deviation:
    """An axis whose square is too large for a double is read as if there were none."""

    def axis(original: Any, self: Any, name: Any, kind: Any, element: Any) -> Any:
        found = original(self, name, kind, element)
        return (1.0, 0.0, 0.0) if found and math.isinf(sum(each * each for each in found)) else found

    return around(_Reader, "axis", axis)


@mutant("EU-URD-030")
def planar_joint_needs_an_axis() -> Deviation:
    """A planar joint whose axis is left out is told of, as if x were written."""

    def axis(original: Any, self: Any, name: Any, kind: Any, element: Any) -> Any:
        if kind is JointType.PLANAR and element is None:
            self.report("urdf-planar-axis", "there is no axis", self.document.root)
        return original(self, name, kind, element)

    return around(_Reader, "axis", axis)


@mutant("EU-URD-030")
def planar_axis_is_exactly_z() -> Deviation:
    """The axis of a planar joint is 0 0 1, or it is told of."""

    def axis(original: Any, self: Any, name: Any, kind: Any, element: Any) -> Any:
        if kind is JointType.PLANAR and element is not None and element.get("xyz") != "0 0 1":
            self.report("urdf-planar-axis", "the axis is not z", element, "xyz")
        return original(self, name, kind, element)

    return around(_Reader, "axis", axis)


@mutant("EU-URD-008")
def names_of_any_white_space_refused() -> Deviation:
    """A name is blank that is of white space of any kind, a no-break space too."""
    return refused_by_urdf(lambda read: any(not name.strip() for name in (read.name, *read.links, *read.joints)))


@mutant("EU-URD-008")
def name_of_a_tab() -> Deviation:
    """A name is blank that is of spaces alone."""
    return instead(urdf, "_WHITE", " ")


@mutant("EU-URD-008")
def material_without_a_name_refused() -> Deviation:
    """A material must have a name wherever it stands."""
    return refused_by_urdf(
        lambda read: any(element.get("name") == "" for element in read.document.root.iter("material"))
    )


@mutant("EU-URD-029")
def anything_defines_a_material() -> Deviation:
    """A material is defined where it holds an element, whichever."""

    def material(original: Any, self: Any, element: Any) -> Any:
        return (None, "") if len(element) else original(self, element)

    return around(_Reader, "material", material)


@mutant("EU-URD-007")
def numbers_beyond_a_double() -> Deviation:
    """A number that is too large for a double is the largest one."""

    def floats(original: Any, text: str, separator: str | None = None) -> Any:
        return original(text.replace("1e400", "1e308"), separator)

    return around(urdf, "_floats", floats)


@mutant("EU-URD-003")
def namespace_counts() -> Deviation:
    """An element in a namespace, by whichever declaration, is none of URDF's."""
    return refused_by_urdf(lambda read: any(None in element.nsmap for element in read.document.root.iter("*")))
