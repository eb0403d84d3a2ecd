"""Parsers that read another URDF: mostly what today's URDF parsers do."""

from __future__ import annotations

import contextlib
import math
import re
import unicodedata
from collections.abc import Callable
from functools import partial
from typing import Any

from eurdf_conformance.level import Level

# -- XML --------------------------------------------------------------------------------------------------------------


def _with_declared_prefixes(text: str) -> str:
    prefixes = sorted({*re.findall(r"[<\s]([a-z]+):[a-z]", text)} - {"xml", "xmlns"})
    return text.replace("<robot", "<robot" + "".join(f' xmlns:{each}="urn:of-{each}"' for each in prefixes), 1)


_without_document_types = partial(re.sub, r"<!DOCTYPE[^\[>]*(\[[^\]]*\])?\s*>", "")

READS_XML = {
    "EU-URD-001": {
        "An ampersand that begins no reference is text, as in tinyxml2 and in browsers.": partial(
            re.sub, r"&(?![A-Za-z#])", "&amp;"
        ),
        "A file is read to the end of its root element.": partial(re.sub, r"(?s)</robot>.*", "</robot>"),
        "An attribute may have its value without quotes, as in HTML.": partial(
            re.sub, r"(<[^<>]*\s\w+=)([^\s\"'<>/]+)", r'\1"\2"'
        ),
        "The version in the XML declaration has no effect, as in expat.": partial(
            re.sub, r"(<\?xml\s+version=)(['\"]).*?\2", r'\1"1.0"', count=1
        ),
        "A character reference of a surrogate is dropped.": partial(re.sub, r"&#x[Dd][89A-Fa-f][0-9A-Fa-f]{2};", ""),
        "A prefix is a part of the name, whether it has a namespace or not.": _with_declared_prefixes,
        "Two attributes of one name in one namespace may have two prefixes.": partial(
            re.sub, r'xmlns:b="[^"]*"', 'xmlns:b="urn:only-b"'
        ),
        "A name may have any number of colons, as in XML without namespaces.": partial(
            re.sub, r"(?<=[<\s?])([a-z]*):([a-z0-9]*)(?:(:)[a-z]+)?(?=[\s=/>])", r"\1\2"
        ),
        "A value in single quotes is a syntax error.": partial(re.sub, r"=\s*'", "='<"),
        "A file that declares XML 1.1 is refused.": partial(re.sub, r"(<\?xml\s+version=.)1\.[1-9]", r"\g<1>2.0"),
    },
    ("EU-URD-001", "2"): {
        "A namespace may be empty, as in XML 1.1.": partial(re.sub, r'xmlns:([a-z]+)=""', r'xmlns:\1="urn:\1"'),
        "The name of a namespace must be a URI, which has no spaces.": partial(
            re.sub, r'(xmlns:[a-z]+=)"[^"]* [^"]*"', r'\1""'
        ),
    },
    "EU-URD-002": {"A document type declaration has no effect.": _without_document_types},
    "EU-URD-007": {
        "A number may have a comma for its point, as C programs read it in some locales.": partial(
            re.sub, r"(?<=[0-9]),(?=[0-9])", "."
        ),
    },
    "EU-SEC-002": {
        "A document type declaration has no effect, and its entities are text.": lambda text: re.sub(
            r"&(?!amp|lt|gt|quot|apos|#)", "&amp;", _without_document_types(text)
        ),
    },
    "EU-FIL-003": {
        "A file of ASCII may declare US-ASCII, of which UTF-8 is a superset.": lambda text: (
            re.sub(r"(?i)^(<\?xml[^>]*encoding=['\"])us-ascii", r"\1UTF-8", text) if text.isascii() else text
        ),
        "The declared encoding is `UTF-8` or `utf-8`, not `Utf-8`.": partial(
            re.sub, r"(<\?xml[^>]*encoding=.)(?!UTF-8|utf-8)[Uu][Tt][Ff]-8", r"\1UTF-7"
        ),
        "The declared encoding may be `UTF8`.": partial(re.sub, r"(<\?xml[^>]*encoding=.)UTF8", r"\1UTF-8"),
    },
}


# -- Elements and attributes ------------------------------------------------------------------------------------------

Change = Callable[[Any], None]


def _each(path: str, change: Callable[[Any], Any]) -> Change:
    """Elements are changed, in place, where a path leads."""

    def changed(robot: Any) -> None:
        for element in robot.xpath(path):
            change(element)

    return changed


def _attributes(change: Callable[[str], str], path: str) -> Change:
    """Attributes have other values."""
    return _each(path, lambda value: value.getparent().set(value.attrname, change(value)))


def _drop(path: str) -> Change:
    return _each(path, lambda element: element.getparent().remove(element))


def _default(value: str, *names: str) -> Callable[[Any], None]:
    """Attributes that are left out have a value."""
    return lambda element: [element.set(name, element.get(name, value)) for name in names]  # type: ignore[return-value]


def _last_of_two_parents(robot: Any) -> None:
    carrying: dict[str, Any] = {}
    for joint in robot.xpath("joint[child/@link != '']"):
        child = joint.find("child").get("link")
        if child in carrying:
            robot.remove(carrying[child])
        carrying[child] = joint


def _drop_repeated(robot: Any) -> None:
    for parent in robot.iter("joint", "link", "inertial"):
        for tag in ("parent", "child", "axis", "limit", "dynamics", "mimic", "origin", "inertial", "mass", "inertia"):
            for element in parent.findall(tag)[1:]:
                parent.remove(element)


def _swap(limit: Any) -> None:
    lower, upper = limit.get("lower", "0"), limit.get("upper", "0")
    with contextlib.suppress(ValueError):
        if float(lower) > float(upper):
            limit.set("lower", upper)
            limit.set("upper", lower)


def _x_for_zero(axis: Any) -> None:
    if set(re.findall("[^ .+-]", axis.get("xyz", "1"))) == {"0"}:
        axis.set("xyz", "1 0 0")


def _soft_limits(joint: Any) -> None:
    limit, soft = joint.find("limit"), joint.find("safety_controller")
    for side in ("lower", "upper"):
        limit.set(side, soft.get(f"soft_{side}_limit", limit.get(side, "0")))


def _pad(axis: Any) -> None:
    if len(axis.get("xyz", "").split()) == 2:
        axis.set("xyz", axis.get("xyz") + " 0")


def _default_namespaces_count(robot: Any) -> None:
    if None not in robot.nsmap:
        for element in robot.iter("{*}*"):
            if element.prefix is None and None in element.nsmap:
                element.tag = "foreign"


def _snap(axis: Any) -> None:
    with contextlib.suppress(ValueError):
        numbers = [float(text) for text in axis.get("xyz").split()]
        least = 1e-5 * max(map(abs, numbers), default=0.0)
        if any(0.0 < abs(number) < least for number in numbers):
            axis.set("xyz", " ".join(str(number if abs(number) >= least else 0.0) for number in numbers))


def _version_as_number(robot: Any) -> None:
    with contextlib.suppress(ValueError):
        robot.set("version", str(float(robot.get("version", ""))))


def _w_first(text: str) -> str:
    numbers = text.split()
    return " ".join(numbers[1:] + numbers[:1])


def _quaternions_always(robot: Any) -> None:
    if robot.get("version", "1.0") == "1.0" and robot.xpath(".//origin/@quat_xyzw"):
        robot.set("version", "1.1")


READS_URDF = {
    "EU-FRM-001": {
        "Names in the URDF are read without the white space around them.": _attributes(
            str.strip, "//@name|//@link|//@joint"
        ),
        "Names in the URDF are brought to Unicode's composed form.": _attributes(
            partial(unicodedata.normalize, "NFC"), "//@name|//@link|//@joint"
        ),
        "Names in the URDF are read in lower case.": _attributes(str.lower, "//@name|//@link|//@joint"),
    },
    "EU-URD-004": {
        "An element in a default namespace of its own belongs to another program.": _default_namespaces_count,
    },
    "EU-URD-005": {
        "An effort or a velocity that is left out is 0, as in urdfdom of long ago.": _each(
            "joint/limit", _default("0", "effort", "velocity")
        ),
        "A position limit that is left out is 0 in version 1.2 too.": _each(
            "/robot[@version='1.2']/joint/limit", _default("0", "lower", "upper")
        ),
    },
    "EU-URD-006": {"Of two elements where one is allowed, the first counts.": _drop_repeated},
    ("EU-URD-006", Level.ACCEPT): {
        "A geometry that contains any other element has no shape.": _each(
            "//geometry[count(*) > 1]", lambda geometry: geometry.clear()
        ),
    },
    "EU-URD-007": {
        "The axis of a planar joint may have two numbers; the third one is then 0.": _each(
            "//joint[@type='planar']/axis", _pad
        ),
    },
    "EU-URD-012": {"A joint's type may be in upper case.": _attributes(str.lower, "//@type")},
    "EU-URD-013": {"An axis of zero is x.": _each("joint/axis", _x_for_zero)},
    "EU-URD-016": {"Of two joints that carry one link, the last in the file counts.": _last_of_two_parents},
    "EU-URD-019": {
        "Of two limits the smaller is the lower one.": _each("joint/limit", _swap),
        "The position limits of a continuous joint are not compared.": _each(
            "joint[@type='continuous']/limit", lambda limit: limit.attrib.pop("lower", None)
        ),
    },
    "EU-URD-020": {
        "`dynamics` of a planar or fixed joint is not read, since it has no effect.": _drop(
            "//joint[@type='planar' or @type='fixed']/dynamics"
        ),
        "The velocity limit of a continuous joint may be negative.": _attributes(
            lambda velocity: velocity.lstrip("-"), "joint[@type='continuous']/limit/@velocity"
        ),
    },
    "EU-URD-024": {"A sphere of radius 0 is a point.": _attributes(lambda radius: "1e-9", "//sphere/@radius[.='0']")},
    ("EU-URD-032", "2"): {"A joint that mimics moves by itself, as in Pinocchio by default.": _drop("joint/mimic")},
    "EU-URD-035": {"An axis within 1e-5 of x, y or z is that axis.": _each("joint/axis[@xyz]", _snap)},
    "EU-URD-037": {"A version may be written as any text of the same number, such as `1.10`.": _version_as_number},
    "EU-URD-039": {
        "The first number of a quaternion is w, as in MJCF.": _attributes(_w_first, ".//origin/@quat_xyzw"),
        "A quaternion is read before version 1.1 too.": _quaternions_always,
    },
    ("EU-URD-039", Level.STRUCTURE): {
        "The quaternions of shapes and inertias have no effect.": _each(
            ".//*[name() != 'joint']/origin", lambda origin: origin.attrib.pop("quat_xyzw", None)
        ),
    },
    "EU-CAN-001": {
        "The soft limits of a safety controller replace those of the joint.": _each(
            "joint[limit and safety_controller]", _soft_limits
        ),
    },
}


# -- Rules too many ---------------------------------------------------------------------------------------------------


def _any(path: str, wrong: Callable[[Any], Any] = lambda found: True) -> Callable[..., bool]:
    """Whether something is so of anything where a path leads."""
    return lambda data, robot: any(map(wrong, robot.xpath(path)))


def _numbers(text: str) -> list[float]:
    return [*map(float, text.split())]


def _is_zero(text: str) -> bool:
    return not any(_numbers(text))


def _is_not_of_unit_length(text: str) -> bool:
    return abs(math.hypot(*_numbers(text)) - 1) > 1e-3


def _joint_before_its_links(data: Any, robot: Any) -> bool:
    known = set()
    for element in robot.xpath("link|joint"):
        if element.tag == "link":
            known.add(element.get("name"))
        elif not known.issuperset(element.xpath("parent/@link|child/@link")):
            return True
    return False


def _repeats(element: Any) -> bool:
    return len(element) > len({child.tag for child in element.iterchildren("*")})


def _has_equal_materials(data: Any, robot: Any) -> bool:
    names = robot.xpath("material/@name")
    return len(names) > len(set(names))


REFUSES = {
    "EU-URD-004": {
        "A continuous joint must have a limit.": _any("joint[@type='continuous' and not(limit)]"),
        "A link must have an inertial element.": _any("link[not(inertial)]"),
    },
    "EU-URD-005": {"A limit must have an effort in version 1.2 too.": _any("joint/limit[not(@effort)]")},
    "EU-URD-006": {
        "An element of another program must not occur twice in a joint or an inertial either.": _any(
            "//joint|//inertial", _repeats
        ),
    },
    "EU-URD-007": {
        "A number does not end with its point.": _any("//axis/@*|//origin/@*", re.compile(r"[0-9]\.( |$)").search),
    },
    "EU-URD-011": {"`Universe` is reserved too.": _any("(link|joint)/@name", lambda name: name.lower() == "universe")},
    "EU-URD-013": {
        "An axis must have unit length, within a thousandth.": _any("joint/axis/@xyz", _is_not_of_unit_length),
        "The axis of a fixed joint may not be zero, which exporters write.": _any(
            "joint[@type='fixed']/axis/@xyz", _is_zero
        ),
        "A zero axis of a planar joint is refused, as if the joint turned about it.": _any(
            "joint[@type='planar']/axis/@xyz", _is_zero
        ),
    },
    "EU-URD-014": {"A joint must come after the links that it names.": _joint_before_its_links},
    "EU-URD-015": {"A robot must have a joint.": _any("/robot[not(joint)]")},
    "EU-URD-018": {"The first link of the file must be the root.": _any("link[1][@name = ../joint/child/@link]")},
    "EU-URD-019": {"A lower limit must be below the upper one.": _any("joint/limit[@lower = @upper]")},
    "EU-URD-020": {
        "Limits of effort and velocity must be greater than 0.": _any(
            "joint/limit/@effort|joint/limit/@velocity", lambda limit: float(limit) == 0
        ),
    },
    ("EU-URD-022", "2"): {
        "A joint may not mimic one that mimics.": _any("joint[mimic]/@name[. = //joint/mimic/@joint]"),
    },
    "EU-URD-024": {
        "A capsule is not a shape, as in urdfdom.": _any("//capsule"),
        "The scale of a mesh must be positive.": _any("//mesh/@scale[contains(., '-')]"),
    },
    "EU-URD-029": {"Two materials of the robot must not have one name.": _has_equal_materials},
    "EU-URD-039": {
        "A quaternion whose norm differs from 1 by more than 1e-3 is refused.": _any(
            "/robot[@version >= 1.1]//origin/@quat_xyzw", _is_not_of_unit_length
        ),
    },
    "EU-CNF-002": {
        "An element that URDF does not have is refused, and those of other programs with it.": _any(
            "*[not(self::link or self::joint or self::material)]"
        ),
        "A name must be ASCII.": _any("(//link|//joint)/@name", lambda name: not name.isascii()),
        "A name may not have slashes, which are for namespaces of ROS.": _any(
            "(//link|//joint)/@name[contains(., '/')]"
        ),
    },
    "EU-FIL-002": {"A robot of more than 1000 links is refused.": _any("link[1001]")},
}
