"""Readers that keep a rule of elements and attributes but for some of them: the table of chapter The URDF."""

from __future__ import annotations

from collections.abc import Callable
from functools import partial
from typing import Any

from eurdf.format.urdf import _Reader
from eurdf_conformance.adapters.reference import Reference
from eurdf_conformance.mutants.deviation import Deviation, around, together
from eurdf_conformance.mutants.mutant import Mutant
from eurdf_conformance.mutants.of_the_reference import clause_of
from eurdf_conformance.protocol.message import Accepted, Rejected
from eurdf_conformance.protocol.reply import accepted

#: Of an element, and an attribute where one is at fault.
_Where = Callable[[Any, str], bool]


def _forgiving(code: str, where: _Where) -> Deviation:
    """What is told as a code of such elements is accepted, without a robot."""
    forgiven = 0

    def report(
        original: Any, self: Any, told: str, message: str, element: Any, attribute: Any = None, hint: Any = None
    ) -> None:
        nonlocal forgiven
        forgiven += told == code and where(element, attribute or "")
        original(self, told, message, element, attribute, hint)

    def load(original: Any, self: Reference, *files: Any) -> Accepted | Rejected:
        nonlocal forgiven
        forgiven = 0
        answer: Accepted | Rejected = original(self, *files)
        errors = sum(issue.severity == "error" for issue in answer.issues)
        return accepted() if errors and errors == forgiven else answer

    return together(around(_Reader, "report", report), around(Reference, "load", load))


def _tag(*tags: str) -> _Where:
    return lambda element, _: element.tag in tags


def _within(*tags: str) -> _Where:
    return lambda element, _: any(above.tag in tags for above in element.iterancestors())


def _of(tag: str, *parents: str) -> _Where:
    return lambda element, _: element.tag == tag and element.getparent().tag in parents


def _of_joint(tag: str, *types: str) -> _Where:
    return lambda element, _: element.tag == tag and element.getparent().get("type") in types


def _attribute(*names: str) -> _Where:
    return lambda _, attribute: attribute in names


_NUMBER, _LACKS, _TWICE, _CHILD, _EMPTY, _SHAPE, _NEGATIVE = (
    "urdf-bad-number",
    "urdf-missing-attribute",
    "urdf-repeated-element",
    "urdf-missing-element",
    "urdf-empty-name",
    "urdf-geometry",
    "urdf-negative-limit",
)

#: By name: the code that is forgiven, of which elements, and how that is said.
_RULES: dict[str, tuple[str, _Where, str]] = {
    "rpy_is_not_looked_at": (_NUMBER, _attribute("rpy"), "An rpy may be anything."),
    "axes_are_not_looked_at": (_NUMBER, _tag("axis"), "An axis may be anything."),
    "axes_of_fixed_joints_are_not_looked_at": (
        _NUMBER,
        _of_joint("axis", "fixed", "floating"),
        "The axis of a joint that has no use for one may be anything.",
    ),
    "limits_are_not_looked_at": (_NUMBER, _tag("limit"), "A limit may be anything."),
    "limits_of_fixed_joints_are_not_looked_at": (
        _NUMBER,
        _of_joint("limit", "fixed", "continuous"),
        "A limit of a joint that has no use for it may be anything.",
    ),
    "dynamics_are_not_looked_at": (_NUMBER, _tag("dynamics"), "A damping or friction may be anything."),
    "mimics_are_not_looked_at": (_NUMBER, _tag("mimic"), "A multiplier or an offset may be anything."),
    "inertials_are_not_looked_at": (_NUMBER, _within("inertial"), "Numbers of an inertial may be anything."),
    "what_is_seen_is_not_looked_at": (_NUMBER, _within("visual"), "Numbers of what is seen may be anything."),
    "what_collides_is_not_looked_at": (_NUMBER, _within("collision"), "Numbers of what collides may be anything."),
    "capsules_are_not_looked_at": (_NUMBER, _tag("capsule"), "Numbers of a capsule may be anything."),
    "colours_are_not_looked_at": (_NUMBER, _tag("color"), "A colour may be anything."),
    "scales_are_not_looked_at": (_NUMBER, _attribute("scale"), "A scale may be anything."),
    "robot_may_lack_a_name": (_LACKS, _tag("robot"), "A robot need not have a name."),
    "joint_may_lack_a_name": (_LACKS, _tag("joint"), "A joint need not have a name or a type."),
    "link_may_lack_a_name": (_LACKS, _tag("link"), "A link need not have a name."),
    "mass_may_lack_its_value": (_LACKS, _tag("mass"), "A mass without a value is 0."),
    "axis_may_lack_its_numbers": (_LACKS, _tag("axis"), "An axis without numbers is x."),
    "parent_may_lack_its_link": (_LACKS, _tag("parent"), "A parent need not name a link."),
    "child_may_lack_its_link": (_LACKS, _tag("child"), "A child need not name a link."),
    "mimic_may_lack_its_joint": (_LACKS, _tag("mimic"), "A mimic that names no joint has no effect."),
    "material_may_lack_its_name": (_LACKS, _tag("material"), "A material of the robot need not have a name."),
    "texture_may_lack_its_file": (_LACKS, _tag("texture"), "A texture need not name a file."),
    "mesh_may_lack_its_file": (_LACKS, _tag("mesh"), "A mesh need not name a file."),
    "colour_may_lack_its_numbers": (_LACKS, _tag("color"), "A colour need not have numbers."),
    "shapes_may_lack_their_sizes": (_LACKS, _tag("box", "sphere", "cylinder"), "A shape need not have a size."),
    "capsule_may_lack_its_sizes": (_LACKS, _tag("capsule"), "A capsule need not have a size."),
    "two_inertias": (_TWICE, _of("inertia", "inertial"), "Of two inertias one counts."),
    "two_masses": (_TWICE, _of("mass", "inertial"), "Of two masses one counts."),
    "two_origins_of_an_inertial": (_TWICE, _of("origin", "inertial"), "Of two origins of an inertial one counts."),
    "two_of_what_is_seen": (_TWICE, _of("origin", "visual"), "Of two origins of what is seen one counts."),
    "two_of_what_collides": (_TWICE, _of("origin", "collision"), "Of two origins of what collides one counts."),
    "two_geometries": (_TWICE, _tag("geometry"), "Of two geometries one counts."),
    "two_materials": (_TWICE, _tag("material"), "Of two materials one counts."),
    "two_colours": (_TWICE, _tag("color", "texture"), "Of two colours or textures one counts."),
    "two_parents_of_a_joint": (_TWICE, _tag("parent"), "Of two parents one counts."),
    "two_children_of_a_joint": (_TWICE, _tag("child"), "Of two children one counts."),
    "two_axes": (_TWICE, _tag("axis"), "Of two axes one counts."),
    "two_limits": (_TWICE, _tag("limit"), "Of two limits one counts."),
    "two_dynamics": (_TWICE, _tag("dynamics"), "Of two elements of dynamics one counts."),
    "two_mimics": (_TWICE, _tag("mimic"), "Of two mimics one counts."),
    "follower_may_lack_its_limit": (
        _CHILD,
        lambda element, _: element.find("mimic") is not None,
        "A joint that mimics need not have a limit.",
    ),
    "slide_may_lack_its_limit": (
        _CHILD,
        lambda element, _: element.get("type") == "prismatic",
        "A prismatic joint need not have a limit.",
    ),
    "what_is_seen_may_lack_its_geometry": (_CHILD, _tag("visual"), "What is seen need not have a geometry."),
    "what_collides_may_lack_its_geometry": (_CHILD, _tag("collision"), "What collides need not have a geometry."),
    "joint_may_lack_its_parent": (
        _CHILD,
        lambda element, _: element.tag == "joint" and None in (element.find("parent"), element.find("child")),
        "A joint without parent or child is left out.",
    ),
    "names_may_be_blank": (
        _EMPTY,
        lambda element, attribute: bool(element.get(attribute)),
        "A name may be of white space.",
    ),
    "names_of_links_may_be_empty": (_EMPTY, _tag("parent", "child"), "A joint may name an empty link."),
    "mimics_of_nobody": (_EMPTY, _tag("mimic"), "A mimic of an empty name has no effect."),
    "names_of_materials_may_be_empty": (_EMPTY, _tag("material"), "A material of the robot may have an empty name."),
    "names_of_files_may_be_empty": (_EMPTY, _attribute("filename"), "The name of a file may be empty."),
    "cylinders_and_capsules_of_any_size": (_SHAPE, _tag("cylinder", "capsule"), "A cylinder may have any size."),
    "shapes_of_negative_size": (
        _SHAPE,
        lambda element, _: "-" in str(element.get("radius")),
        "A radius may be negative.",
    ),
    "geometry_may_be_empty": (
        _SHAPE,
        lambda element, _: element.tag == "geometry" and len(element) == 0,
        "A geometry may be empty.",
    ),
    "fixed_joints_may_have_negative_limits": (
        _NEGATIVE,
        lambda element, _: element.getparent().get("type") in ("fixed", "planar", "floating"),
        "Limits and dampings of a joint that has no use for them may be negative.",
    ),
    "negative_friction": (_NEGATIVE, _attribute("friction"), "A friction may be negative."),
    "negative_velocity": (_NEGATIVE, _attribute("velocity"), "A limit of velocity may be negative."),
    "upper_limit_left_out_is_none": (
        "urdf-reversed-limits",
        lambda element, _: element.get("upper") is None,
        "A lower limit may be above 0 where the upper one is left out.",
    ),
    "planar_and_floating_joints_may_mimic": (
        "urdf-mimic-kind",
        lambda element, _: element.getparent().get("type") in ("planar", "floating"),
        "A joint of several coordinates may mimic.",
    ),
    "type_may_be_empty": (
        "urdf-joint-type",
        lambda element, _: not element.get("type"),
        "A joint of an empty type is fixed.",
    ),
    "type_is_trimmed": (
        "urdf-joint-type",
        lambda element, _: element.get("type") != element.get("type").strip(),
        "The type of a joint is read without the white space around it.",
    ),
}

BUT_FOR_SOME = tuple(
    Mutant(name, clause_of(code), breaks, partial(_forgiving, code, where))
    for name, (code, where, breaks) in _RULES.items()
)
