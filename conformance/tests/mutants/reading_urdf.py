"""Parsers that read another URDF: mostly what today's URDF parsers do."""

from __future__ import annotations

import contextlib
import math
import re
import unicodedata
from collections.abc import Callable
from typing import Any

from eurdf_conformance.level import Level
from mutants.mutant import reads_urdf, reads_xml, refuses

# -- XML --------------------------------------------------------------------------------------------------------------


wrong = reads_xml("EU-URD-001")
wrong(
    "An ampersand that begins no reference is text, as in tinyxml2 and in browsers.",
    lambda text: re.sub(r"&(?![A-Za-z#])", "&amp;", text),
)


@reads_xml("EU-URD-001")
def text_after_the_root_is_ignored(text: str) -> str:
    """A file is read to the end of its root element."""
    head, end, _ = text.partition("</robot>")
    return head + end


wrong = reads_xml("EU-URD-001")
wrong(
    "An attribute may have its value without quotes, as in HTML.",
    lambda text: re.sub(r"(<[^<>]*\s\w+=)([^\s\"'<>/]+)", r'\1"\2"', text),
)
wrong(
    "The version in the XML declaration has no effect, as in expat.",
    lambda text: re.sub(r"(<\?xml\s+version=)(['\"]).*?\2", r'\1"1.0"', text, count=1),
)
wrong(
    "A character reference of a surrogate is dropped.",
    lambda text: re.sub(r"&#x[Dd][89A-Fa-f][0-9A-Fa-f]{2};", "", text),
)


@reads_xml("EU-URD-001")
def prefixes_need_no_declaration(text: str) -> str:
    """A prefix is a part of the name, whether it has a namespace or not."""
    prefixes = sorted({*re.findall(r"[<\s]([a-z]+):[a-z]", text)} - {"xml", "xmlns"})
    return text.replace("<robot", "<robot" + "".join(f' xmlns:{each}="urn:of-{each}"' for each in prefixes), 1)


wrong = reads_xml("EU-URD-001")
wrong(
    "Two attributes of one name in one namespace may have two prefixes.",
    lambda text: re.sub(r'xmlns:b="[^"]*"', 'xmlns:b="urn:only-b"', text),
)
wrong(
    "A name may have any number of colons, as in XML without namespaces.",
    lambda text: re.sub(r"(?<=[<\s?])([a-z]*):([a-z0-9]*)(?:(:)[a-z]+)?(?=[\s=/>])", r"\1\2", text),
)

wrong = reads_xml("EU-URD-001", versions=("2",))
wrong("A namespace may be empty, as in XML 1.1.", lambda text: re.sub(r'xmlns:([a-z]+)=""', r'xmlns:\1="urn:\1"', text))
wrong(
    "The name of a namespace must be a URI, which has no spaces.",
    lambda text: re.sub(r'(xmlns:[a-z]+=)"[^"]* [^"]*"', r'\1""', text),
)

wrong = reads_xml("EU-FIL-003")
wrong(
    "A file of ASCII may declare US-ASCII, of which UTF-8 is a superset.",
    lambda text: re.sub(r"(?i)^(<\?xml[^>]*encoding=['\"])us-ascii", r"\1UTF-8", text) if text.isascii() else text,
)


@reads_xml("EU-URD-002")
def document_types_are_ignored(text: str) -> str:
    """A document type declaration has no effect."""
    return re.sub(r"<!DOCTYPE[^\[>]*(\[[^\]]*\])?\s*>", "", text)


wrong = reads_xml("EU-SEC-002")
wrong(
    "A document type declaration has no effect, and its entities are text.",
    lambda text: re.sub(r"&(?!amp|lt|gt|quot|apos|#)", "&amp;", document_types_are_ignored(text)),
)

wrong = reads_xml("EU-URD-001")
wrong("A value in single quotes is a syntax error.", lambda text: re.sub(r"=\s*'", "='<", text))

wrong = reads_xml("EU-URD-007")
wrong(
    "A number may have a comma for its point, as C programs read it in some locales.",
    lambda text: re.sub(r"(?<=[0-9]),(?=[0-9])", ".", text),
)


# -- Elements and attributes ------------------------------------------------------------------------------------------


def _attributes(robot: Any, change: Callable[[str], str], *names: str) -> None:
    for element in robot.iter("*"):
        for name in names:
            if name in element.attrib:
                element.set(name, change(element.get(name)))


NAMES = ("name", "link", "joint")


@reads_urdf("EU-FRM-001")
def names_are_trimmed(robot: Any) -> None:
    """Names in the URDF are read without the white space around them."""
    _attributes(robot, str.strip, *NAMES)


@reads_urdf("EU-FRM-001")
def names_are_normalised(robot: Any) -> None:
    """Names in the URDF are brought to Unicode's composed form."""
    _attributes(robot, lambda name: unicodedata.normalize("NFC", name), *NAMES)


@reads_urdf("EU-FRM-001")
def names_in_lower_case(robot: Any) -> None:
    """Names in the URDF are read in lower case."""
    _attributes(robot, str.lower, *NAMES)


@reads_urdf("EU-URD-012")
def joint_types_in_any_case(robot: Any) -> None:
    """A joint's type may be in upper case."""
    _attributes(robot, str.lower, "type")


@reads_urdf("EU-URD-016")
def last_of_two_parents_counts(robot: Any) -> None:
    """Of two joints that carry one link, the last in the file counts."""
    carrying: dict[str, Any] = {}
    for joint in robot.findall("joint"):
        if (child := joint.find("child")) is not None and child.get("link"):
            if (other := carrying.get(child.get("link"))) is not None:
                robot.remove(other)
            carrying[child.get("link")] = joint


def _drop(robot: Any, path: str) -> None:
    for element in robot.findall(path):
        element.getparent().remove(element)


@reads_urdf("EU-URD-032", versions=("2",))
def mimics_are_ignored(robot: Any) -> None:
    """A joint that mimics moves by itself, as in Pinocchio by default."""
    _drop(robot, "joint/mimic")


@reads_urdf("EU-URD-006")
def first_of_repeated_elements_counts(robot: Any) -> None:
    """Of two elements where one is allowed, the first counts."""
    for parent in robot.iter("joint", "link", "inertial"):
        for tag in ("parent", "child", "axis", "limit", "dynamics", "mimic", "origin", "inertial", "mass", "inertia"):
            for element in parent.findall(tag)[1:]:
                parent.remove(element)


@reads_urdf("EU-URD-005")
def missing_limits_are_0(robot: Any) -> None:
    """An effort or a velocity that is left out is 0, as in urdfdom of long ago."""
    for limit in robot.findall("joint/limit"):
        for name in ("effort", "velocity"):
            limit.set(name, limit.get(name, "0"))


@reads_urdf("EU-URD-019")
def reversed_limits_are_swapped(robot: Any) -> None:
    """Of two limits the smaller is the lower one."""
    for limit in robot.findall("joint/limit"):
        lower, upper = limit.get("lower", "0"), limit.get("upper", "0")
        try:
            if float(lower) > float(upper):
                limit.set("lower", upper)
                limit.set("upper", lower)
        except ValueError:
            pass


@reads_urdf("EU-URD-013")
def axes_of_zero_are_x(robot: Any) -> None:
    """An axis of zero is x."""
    for axis in robot.findall("joint/axis"):
        if set(re.findall("[^ .+-]", axis.get("xyz", "1"))) == {"0"}:
            axis.set("xyz", "1 0 0")


@reads_urdf("EU-CAN-001")
def safety_controllers_limit(robot: Any) -> None:
    """The soft limits of a safety controller replace those of the joint."""
    for joint in robot.findall("joint"):
        limit, soft = joint.find("limit"), joint.find("safety_controller")
        if limit is not None and soft is not None:
            for side in ("lower", "upper"):
                limit.set(side, soft.get(f"soft_{side}_limit", limit.get(side, "0")))


# -- Rules too many ---------------------------------------------------------------------------------------------------


wrong = refuses("EU-URD-004")
wrong(
    "A continuous joint must have a limit.",
    lambda data, robot: any(
        joint.get("type") == "continuous" and joint.find("limit") is None for joint in robot.findall("joint")
    ),
)
wrong(
    "A link must have an inertial element.",
    lambda data, robot: any(link.find("inertial") is None for link in robot.findall("link")),
)


@refuses("EU-URD-014")
def links_must_come_first(data: Any, robot: Any) -> bool:
    """A joint must come after the links that it names."""
    known = set()
    for element in robot:
        if element.tag == "link":
            known.add(element.get("name"))
        elif element.tag == "joint" and not {element.find(side).get("link") for side in ("parent", "child")} <= known:
            return True
    return False


wrong = refuses("EU-URD-018")
wrong(
    "The first link of the file must be the root.",
    lambda data, robot: robot.find("link").get("name") in {child.get("link") for child in robot.findall("joint/child")},
)

wrong = refuses("EU-URD-015")
wrong("A robot must have a joint.", lambda data, robot: robot.find("joint") is None)


@refuses("EU-URD-019")
def equal_limits_are_refused(data: Any, robot: Any) -> bool:
    """A lower limit must be below the upper one."""
    limits = robot.findall("joint/limit")
    return any(limit.get("lower") and limit.get("lower") == limit.get("upper") for limit in limits)


wrong = refuses("EU-URD-020")
wrong(
    "Limits of effort and velocity must be greater than 0.",
    lambda data, robot: any(
        float(limit.get(of, "1")) == 0 for limit in robot.findall("joint/limit") for of in ("effort", "velocity")
    ),
)


@refuses("EU-URD-022", versions=("2",))
def chains_of_mimics_are_refused(data: Any, robot: Any) -> bool:
    """A joint may not mimic one that mimics."""
    leaders = {mimic.getparent().get("name"): mimic.get("joint") for mimic in robot.findall("joint/mimic")}
    return any(leader in leaders for leader in leaders.values())


wrong = refuses("EU-URD-024")
wrong("A capsule is not a shape, as in urdfdom.", lambda data, robot: next(robot.iter("capsule"), None) is not None)
wrong(
    "The scale of a mesh must be positive.",
    lambda data, robot: any("-" in mesh.get("scale", "") for mesh in robot.iter("mesh")),
)


@refuses("EU-URD-013")
def short_axes_are_refused(data: Any, robot: Any) -> bool:
    """An axis must have unit length, within a thousandth."""
    axes = [axis.get("xyz").split() for axis in robot.findall("joint/axis")]
    return any(abs(math.hypot(*map(float, axis)) - 1) > 1e-3 for axis in axes)


wrong = refuses("EU-URD-013")
wrong(
    "The axis of a fixed joint may not be zero, which exporters write.",
    lambda data, robot: any(
        not any(map(float, axis.get("xyz").split())) for axis in robot.findall("joint[@type='fixed']/axis")
    ),
)

wrong = refuses("EU-CNF-002")
wrong(
    "An element that URDF does not have is refused, and those of other programs with it.",
    lambda data, robot: any(element.tag not in ("link", "joint", "material") for element in robot.iterchildren("*")),
)
wrong(
    "A name must be ASCII.",
    lambda data, robot: any(not element.get("name", "").isascii() for element in robot.iter("link", "joint")),
)
wrong(
    "A name may not have slashes, which are for namespaces of ROS.",
    lambda data, robot: any("/" in element.get("name", "") for element in robot.iter("link", "joint")),
)

wrong = refuses("EU-FIL-002")
wrong("A robot of more than 1000 links is refused.", lambda data, robot: len(robot.findall("link")) > 1000)


@reads_urdf("EU-URD-020")
def dynamics_without_effect_are_not_read(robot: Any) -> None:
    """`dynamics` of a planar or fixed joint is not read, since it has no effect."""
    for joint in robot.iter("joint"):
        if joint.get("type") in ("planar", "fixed"):
            for dynamics in joint.findall("dynamics"):
                joint.remove(dynamics)


@reads_urdf("EU-URD-007")
def axis_of_planar_joint_is_padded(robot: Any) -> None:
    """The axis of a planar joint may have two numbers; the third one is then 0."""
    for joint in robot.iter("joint"):
        for axis in joint.findall("axis") if joint.get("type") == "planar" else ():
            if len(axis.get("xyz", "").split()) == 2:
                axis.set("xyz", axis.get("xyz") + " 0")


@reads_urdf("EU-URD-024")
def spheres_without_radius_are_points(robot: Any) -> None:
    """A sphere of radius 0 is a point."""
    for sphere in robot.iter("sphere"):
        if sphere.get("radius") == "0":
            sphere.set("radius", "1e-9")


@reads_urdf("EU-URD-006", level=Level.ACCEPT)
def only_shapes_in_geometry(robot: Any) -> None:
    """A geometry that contains any other element has no shape."""
    for geometry in robot.iter("geometry"):
        if len(geometry) > 1:
            geometry.clear()


# -- One form of several ----------------------------------------------------------------------------------------------


wrong = reads_xml("EU-FIL-003")
wrong(
    "The declared encoding is `UTF-8` or `utf-8`, not `Utf-8`.",
    lambda text: re.sub(r"(<\?xml[^>]*encoding=.)(?!UTF-8|utf-8)[Uu][Tt][Ff]-8", r"\1UTF-7", text),
)
wrong("The declared encoding may be `UTF8`.", lambda text: re.sub(r"(<\?xml[^>]*encoding=.)UTF8", r"\1UTF-8", text))

wrong = reads_xml("EU-URD-001")
wrong(
    "A file that declares XML 1.1 is refused.", lambda text: re.sub(r"(<\?xml\s+version=.)1\.[1-9]", r"\g<1>2.0", text)
)


@reads_urdf("EU-URD-004")
def default_namespaces_count(robot: Any) -> None:
    """An element in a default namespace of its own belongs to another program."""
    if None not in robot.nsmap:
        for element in robot.iter("{*}*"):
            if element.prefix is None and None in element.nsmap:
                element.tag = "foreign"


@refuses("EU-URD-006")
def no_element_may_repeat(data: Any, robot: Any) -> bool:
    """An element of another program must not occur twice in a joint or an inertial either."""
    parents = (parent for tag in ("joint", "inertial") for parent in robot.iter(tag))
    return any(len(parent) > len({child.tag for child in parent.iterchildren("*")}) for parent in parents)


@refuses("EU-URD-029")
def names_of_materials_are_unique(data: Any, robot: Any) -> bool:
    """Two materials of the robot must not have one name."""
    names = [material.get("name") for material in robot.findall("material")]
    return len(names) > len(set(names))


wrong = refuses("EU-URD-007")
wrong(
    "A number does not end with its point.",
    lambda data, robot: any(
        re.search(r"[0-9]\.( |$)", text) for axis in robot.iter("axis", "origin") for text in axis.values()
    ),
)


@reads_urdf("EU-URD-020")
def continuous_joints_have_any_velocity(robot: Any) -> None:
    """The velocity limit of a continuous joint may be negative."""
    for limit in robot.iterfind("joint[@type='continuous']/limit[@velocity]"):
        limit.set("velocity", limit.get("velocity").lstrip("-"))


@refuses("EU-URD-013")
def zero_axes_of_planar_joints_are_refused(data: Any, robot: Any) -> bool:
    """A zero axis of a planar joint is refused, as if the joint turned about it."""
    axes = robot.iterfind("joint[@type='planar']/axis[@xyz]")
    return any(not any(map(float, axis.get("xyz").split())) for axis in axes)


@reads_urdf("EU-URD-035")
def axes_are_snapped(robot: Any) -> None:
    """An axis within 1e-5 of x, y or z is that axis."""
    for axis in robot.iterfind("joint/axis[@xyz]"):
        try:
            numbers = [float(text) for text in axis.get("xyz").split()]
        except ValueError:
            continue
        least = 1e-5 * max(map(abs, numbers), default=0.0)
        if any(0.0 < abs(number) < least for number in numbers):
            axis.set("xyz", " ".join(str(number if abs(number) >= least else 0.0) for number in numbers))


wrong = refuses("EU-URD-011")
wrong(
    "`Universe` is reserved too.",
    lambda data, robot: any(name.lower() == "universe" for name in robot.xpath("(link|joint)/@name")),
)


# -- Versions of URDF -------------------------------------------------------------------------------------------------


@reads_urdf("EU-URD-037")
def versions_are_compared_as_numbers(robot: Any) -> None:
    """A version may be written as any text of the same number, such as `1.10`."""
    with contextlib.suppress(ValueError):
        robot.set("version", str(float(robot.get("version", ""))))


def _quaternions(robot: Any) -> list[tuple[Any, list[str]]]:
    return [(origin, origin.get("quat_xyzw").split()) for origin in robot.iterfind(".//origin[@quat_xyzw]")]


@reads_urdf("EU-URD-039")
def quaternions_begin_with_w(robot: Any) -> None:
    """The first number of a quaternion is w, as in MJCF."""
    for origin, numbers in _quaternions(robot):
        origin.set("quat_xyzw", " ".join(numbers[1:] + numbers[:1]))


@reads_urdf("EU-URD-039", level=Level.STRUCTURE)
def quaternions_of_joints_alone_are_read(robot: Any) -> None:
    """The quaternions of shapes and inertias have no effect."""
    for origin, _ in _quaternions(robot):
        if origin.getparent().tag != "joint":
            del origin.attrib["quat_xyzw"]


@refuses("EU-URD-039")
def quaternions_are_of_unit_length(data: Any, robot: Any) -> bool:
    """A quaternion whose norm differs from 1 by more than 1e-3 is refused."""
    quaternions = robot.xpath("/robot[@version >= 1.1]//origin/@quat_xyzw")
    return any(abs(math.hypot(*map(float, text.split())) - 1.0) > 1e-3 for text in quaternions)


@reads_urdf("EU-URD-039")
def quaternions_have_an_effect_in_every_version(robot: Any) -> None:
    """A quaternion is read before version 1.1 too."""
    if robot.get("version", "1.0") == "1.0" and _quaternions(robot):
        robot.set("version", "1.1")


wrong = refuses("EU-URD-005")
wrong(
    "A limit must have an effort in version 1.2 too.",
    lambda data, robot: any("effort" not in limit.attrib for limit in robot.iterfind("joint/limit")),
)


@reads_urdf("EU-URD-005")
def ranges_of_every_version_are_0(robot: Any) -> None:
    """A position limit that is left out is 0 in version 1.2 too."""
    for limit in robot.iterfind("joint/limit") if robot.get("version") == "1.2" else ():
        for side in ("lower", "upper"):
            limit.set(side, limit.get(side, "0"))


@reads_urdf("EU-URD-019")
def limits_of_continuous_joints_may_be_reversed(robot: Any) -> None:
    """The position limits of a continuous joint are not compared."""
    for limit in robot.iterfind("joint[@type='continuous']/limit"):
        limit.attrib.pop("lower", None)
