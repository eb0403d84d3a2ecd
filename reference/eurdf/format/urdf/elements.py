"""Reads the children and attributes of any URDF element, and reports what is wrong with them."""

from __future__ import annotations

import math
from collections.abc import Iterable, Mapping
from functools import partial
from typing import NamedTuple

from eurdf.diagnostics import Fix, renamings
from eurdf.diagnostics.wording import similar
from eurdf.format.conventions import HINT, LARGEST, too_large
from eurdf.format.wording import near
from eurdf.mechanism.joint_types import JointType
from eurdf.mechanism.pose import IDENTITY, ORIGIN, Pose
from eurdf.reading.xml_reader import Element, XmlReporter

#: The types a URDF may give a joint.
URDF_JOINT_TYPES = {kind.value: kind for kind in JointType if not kind.replaces}

#: Attributes of ``limit`` from URDF 1.2 on.
RATES = ("acceleration", "deceleration", "jerk")


class _Known(NamedTuple):
    """What an element may have; no known name is a near miss of another.

    Attributes:
        children: The optional child elements; ``limit`` is required for a joint that moves in a range.
        needed: The required ones.
        attributes: The optional attributes, before URDF 1.1 and 1.2.
        others: The required ones, and those of later versions of URDF.
    """

    children: tuple[str, ...] = ()
    needed: tuple[str, ...] = ()
    attributes: tuple[str, ...] = ()
    others: tuple[str, ...] = ()


#: By tag.
KNOWN = {
    "robot": _Known(("link", "joint", "material")),
    "link": _Known(("inertial", "visual", "collision")),
    "inertial": _Known(("origin",), ("mass", "inertia")),
    "visual": _Known(("origin", "material"), ("geometry",)),
    "collision": _Known(("origin",), ("geometry",)),
    "joint": _Known(("origin", "axis", "limit", "dynamics", "mimic"), ("parent", "child")),
    "material": _Known(("color", "texture")),
    "origin": _Known(attributes=("xyz", "rpy"), others=("quat_xyzw",)),
    "mesh": _Known(attributes=("scale",), others=("filename",)),
    "texture": _Known(attributes=("filename",)),
    "limit": _Known(attributes=("lower", "upper"), others=("effort", "velocity", *RATES)),
    "dynamics": _Known(attributes=("damping", "friction")),
    "mimic": _Known(attributes=("multiplier", "offset"), others=("joint",)),
}
_KNOWN_CHILDREN = {tag: frozenset((*known.children, *known.needed)) for tag, known in KNOWN.items()}
_KNOWN_ATTRIBUTES = {
    tag: frozenset((*known.attributes, *known.others)) for tag, known in KNOWN.items() if known.attributes
}

#: Attributes of limits, which may be beyond `LARGEST` on the side where they do not limit: the sign of that side.
_LIMITS = dict.fromkeys(_KNOWN_ATTRIBUTES["limit"], 1.0) | {"lower": -1.0}

#: Name of the world.
RESERVED = "universe"

#: White space of XML. A name can consist of other blanks, such as no-break spaces.
WHITE = " \t\r\n"

#: Size of the cache of unknown names and whether they are misspelt.
_MOST_STRANGE = 200


def named(element: Element) -> str:
    """How a message names an element: a link or joint by its name, any other by its tag and owner."""
    tag, name = str(element.tag), element.get("name")
    if tag in ("link", "joint") and name:
        return f"{tag} '{name}'"
    owner = next((above for above in element.iterancestors("link", "joint") if above.get("name")), None)
    return f"<{tag}>" + ("" if owner is None else f" of {owner.tag!s} '{owner.get('name')}'")


def _how_to_add(attribute: str) -> str | None:
    """The hint for a missing attribute: the version that requires it."""
    if attribute in ("lower", "upper"):
        return "from URDF 1.2, the limit of a revolute or prismatic joint states both 'lower' and 'upper'"
    return None


def _floats(text: str, pieces: Iterable[str]) -> tuple[float, ...] | None:
    """Finite decimal numbers in ASCII, of a text and its pieces.

    What else `float` accepts (nan, inf, 1_0, other digits) is not URDF.
    """
    if "_" in text or not text.isascii():
        return None
    try:
        values = tuple(map(float, pieces))
    except ValueError:
        return None
    # The sum is finite if all numbers are, unless it overflows.
    return values if math.isfinite(sum(values)) or all(map(math.isfinite, values)) else None


class UrdfReader:
    """Reads attributes and child elements, and reports what is wrong with them.

    It caches texts that occur often in a file: numbers, poses, and names that URDF does not have.

    Attributes:
        reporter: Gets what is found, by its `report`.
        mimic_reporter: Gets what is wrong with mimic joints.
        version: The version of URDF that the robot states, empty if it states none. Versions compare as texts.
    """

    def __init__(self, reporter: XmlReporter, mimic_reporter: XmlReporter) -> None:
        self.reporter, self.report = reporter, reporter.report
        self.mimic_reporter = mimic_reporter
        self.version = ""
        self._later: dict[tuple[str, str], list[tuple[Element, str | None]]] = {}
        self._floats: dict[str, tuple[float, ...] | None] = {}
        self._joined: dict[str, tuple[float, ...] | None] = {}
        self._poses: dict[tuple[str | None, ...], Pose] = {}
        self._strange: dict[tuple[str, tuple[str, ...]], str | None] = {}

    def numbers(self, element: Element, attribute: str, text: str, count: int) -> tuple[float, ...] | None:
        """EU-URD-007, EU-FIL-005: an attribute of numbers has the right number of decimal numbers within bounds."""
        values = self._floats.get(text)
        if values is None:
            values = _floats(text, text.split())
            if values is None or math.hypot(*values) <= LARGEST:
                # Zeros, units and limits occur often in a file. Larger numbers are an error in some attributes only.
                self._floats[text] = values
            elif len(values) == count and not self._are_bounded(element, attribute, values):
                return None
        if values is not None and len(values) == count:
            return values
        if values is None:
            self._bad_number(element, attribute, text, count)
            return None
        wanted = "one number" if count == 1 else f"{count} numbers separated by spaces"
        self.report(
            "urdf-bad-number",
            f"'{attribute}' of {named(element)} has {len(values)} numbers; it must have {wanted}",
            element,
            attribute,
        )
        return None

    def _are_bounded(self, element: Element, attribute: str, values: tuple[float, ...]) -> bool:
        """EU-FIL-005: report the first number that is too large."""
        free = _LIMITS.get(attribute, 0.0)
        large = next((value for value in values if abs(value) > LARGEST and value * free <= 0.0), None)
        if large is not None:
            self.out_of_bounds(element, attribute, too_large(large))
        return large is None

    def out_of_bounds(self, element: Element, attribute: str, what: str) -> None:
        """EU-FIL-005: report a number by the end of the message about it."""
        self.report("number-out-of-bounds", f"'{attribute}' of {named(element)} has {what}", element, attribute, HINT)

    def _bad_number(self, element: Element, attribute: str, text: str, count: int) -> None:
        wanted = "a finite decimal number" if count == 1 else f"{count} finite decimal numbers separated by spaces"
        hint = None
        if "," in text:
            hint = "write a point, not a comma, and separate numbers by spaces"
        elif "${" in text or "$(" in text:
            hint = "this looks like xacro: expand it first, or give the file a name that ends with .xacro"
        shown = text if len(text) <= 40 else text[:37] + "..."
        self.report(
            "urdf-bad-number",
            f"'{attribute}' of {named(element)} is '{shown}'; it must be {wanted}",
            element,
            attribute,
            hint,
        )

    def required(self, element: Element, attribute: str, count: int) -> tuple[float, ...] | None:
        """EU-URD-005: a required attribute of numbers."""
        text = element.get(attribute)
        if text is None:
            self.missing_attribute(element, attribute)
            return None
        return self.numbers(element, attribute, text, count)

    def single_numbers(
        self, element: Element, attributes: Mapping[str, str | None], optional: tuple[str, ...] | None = None
    ) -> tuple[float, ...] | None:
        """Attributes of one number each; EU-URD-026: warns of other attributes whose names are near.

        Args:
            element: The element.
            attributes: The default of each; None if it is required. In the order in which most files have them.
            optional: The optional attributes of the element, if its tag alone does not say.
        """
        texts: list[str | None]
        if element.keys() == [*attributes]:  # no other, and all at once, which takes half the time
            texts = element.values()  # type: ignore[assignment]
        else:
            if element.tag in _KNOWN_ATTRIBUTES:
                self.attributes(element, optional)
            get = element.get
            texts = [get(attribute, default) for attribute, default in attributes.items()]
        if None not in texts:
            joined = ",".join(texts)  # type: ignore[arg-type]
            values = self._joined.get(joined)
            if values is None:
                values = _floats(joined, texts)  # type: ignore[arg-type]
                if values is not None and math.hypot(*values) > LARGEST:
                    values = None
                self._joined[joined] = values
            # A comma in an attribute, which is an error, makes one number more in another element's text.
            if values is not None and len(values) == len(texts):
                return values
        found: list[float] = []
        for attribute, text in zip(attributes, texts, strict=True):
            if text is None:
                self.missing_attribute(element, attribute)
            elif (value := self.numbers(element, attribute, text, 1)) is not None:
                found += value
        return tuple(found) if len(found) == len(texts) else None

    def missing_attribute(self, element: Element, attribute: str) -> None:
        """EU-URD-005: report that an element lacks a required attribute."""
        message = f"{named(element)} has no attribute '{attribute}'"
        proposals = partial(self.renamings_to, element, attribute)
        self.report("urdf-missing-attribute", message, element, None, _how_to_add(attribute), proposals)

    def renamings_to(self, element: Element, attribute: str) -> list[Fix]:
        """Proposals to give similar attributes of an element another name."""
        write = self.reporter.document.renamed
        return [
            Fix(f"rename '{name}' to '{attribute}'", write(element, name, attribute), f"is '{name}' '{attribute}'?")
            for name in similar(attribute, map(str, element.keys()))
        ]

    def name(self, element: Element, attribute: str = "name") -> str | None:
        """EU-URD-005, EU-URD-008: the name of an element that requires one; it is not empty."""
        name = element.get(attribute)
        if name and name[0] not in WHITE:
            return name
        if name is None:
            self.missing_attribute(element, attribute)
            return None
        if not name.strip(WHITE):
            self.report("urdf-empty-name", f"'{attribute}' of <{element.tag}> is empty", element, attribute)
            return None
        return name

    def refuse_reserved(self, element: Element) -> None:
        """EU-URD-011: no link and no joint has a name reserved for the world."""
        message = f"'{RESERVED}' is the name of the world and cannot be the name of a {element.tag}"
        self.report("urdf-reserved-name", message, element, "name")

    def children(self, parent: Element) -> dict[str, Element]:
        """EU-URD-006: the child elements that may occur once, by tag. Unknown ones are checked for near misses."""
        found: dict[str, Element] = {}
        known = _KNOWN_CHILDREN[parent.tag]
        for child in parent[:]:  # type: ignore[index]  # a list, which lxml makes in half the time
            tag = child.tag
            if tag in found:
                self.report("urdf-repeated-element", f"<{parent.tag}> has a second <{tag}>", child)
            elif tag in known:
                found[tag] = child
            else:
                self.unknown(parent, child)
        return found

    def unknown(self, parent: Element, child: Element) -> None:
        """EU-URD-026: an unknown element is ignored, with a warning if its name is near that of an optional one."""
        tag = child.tag
        if not isinstance(tag, str):
            return
        optional = KNOWN[str(parent.tag)].children
        kind = URDF_JOINT_TYPES.get(parent.get("type", "")) if parent.tag == "joint" else None
        if kind is not None and kind.is_ranged:
            optional = tuple(other for other in optional if other != "limit")
        if meant := self.near_miss(tag, optional):
            write = partial(self.reporter.document.retagged, child)
            message = f"<{parent.tag}> has an unknown element <{tag}>"
            self.report("urdf-unknown-element", message, child, proposals=partial(renamings, [meant], write))

    def attributes(self, element: Element, optional: tuple[str, ...] | None = None) -> bool:
        """EU-URD-026: whether an unknown attribute has a name near that of an optional one, which is warned of."""
        tag = str(element.tag)
        known, optional = _KNOWN_ATTRIBUTES[tag], optional or KNOWN[tag].attributes
        is_misspelt = False
        for attribute in map(str, element.keys()):
            if attribute not in known and (meant := self.near_miss(attribute, optional)):
                write = partial(self.reporter.document.renamed, element, attribute)
                message = f"{named(element)} has an unknown attribute '{attribute}'"
                self.report("urdf-unknown-element", message, element, proposals=partial(renamings, [meant], write))
                is_misspelt = True
        return is_misspelt

    def near_miss(self, name: str, optional: tuple[str, ...]) -> str | None:
        """The name that is near an unknown one without a prefix. Cached: the same few are in every joint of a file."""
        if (name, optional) in self._strange:
            return self._strange[name, optional]
        meant = None if "}" in name else near(name, optional)
        if len(self._strange) < _MOST_STRANGE:
            self._strange[name, optional] = meant
        return meant

    def need(self, parent: Element, found: Mapping[str, Element], tag: str) -> Element | None:
        """EU-URD-004: an element has its required child elements."""
        element = found.get(tag)
        if element is None:
            message, proposals = f"{named(parent)} has no <{tag}>", partial(self.retaggings_to, parent, tag)
            self.report("urdf-missing-element", message, parent, proposals=proposals)
        return element

    def retaggings_to(self, parent: Element, tag: str) -> list[Fix]:
        """Proposals to give a child another tag that has one like it."""
        document, children = self.reporter.document, {str(child.tag): child for child in parent}
        alike = similar(tag, children.keys() - _KNOWN_CHILDREN[str(parent.tag)])
        question = "did you mean <{}> where there is <{}>?"
        return [
            Fix(f"write <{tag}>", document.retagged(children[each], tag), question.format(tag, each)) for each in alike
        ]

    def origin(self, element: Element | None) -> Pose:
        """The pose of an ``origin``; the identity if there is none or it has an error (EU-FRM-006)."""
        if element is None:
            return IDENTITY
        xyz_text, rpy_text = element.get("xyz"), element.get("rpy")
        quaternion_text: str | None = None
        if len(element.attrib) > (xyz_text is not None) + (rpy_text is not None):
            if self.version < "1.1":
                self.attributes(element)
                self.later(element, "quat_xyzw", "1.1")
            else:
                self.attributes(element, (*KNOWN["origin"].attributes, "quat_xyzw"))
                quaternion_text = element.get("quat_xyzw")
        text = (xyz_text, rpy_text, quaternion_text)
        pose = self._poses.get(text)
        if pose is None:
            xyz = ORIGIN if xyz_text is None else self.numbers(element, "xyz", xyz_text, 3)
            rpy = ORIGIN if rpy_text is None else self.numbers(element, "rpy", rpy_text, 3)
            if xyz is None or rpy is None:
                return IDENTITY
            if quaternion_text is None:
                pose = Pose.from_xyz_rpy(xyz, rpy)  # type: ignore[arg-type]
            else:
                quaternion = self._quaternion(element, quaternion_text)
                if quaternion is None:
                    return IDENTITY
                pose = Pose.from_xyz_quaternion(xyz, quaternion)  # type: ignore[arg-type]
            # The visual and the collision of a link often have the same pose.
            self._poses[text] = pose
        return pose

    def _quaternion(self, element: Element, text: str) -> tuple[float, ...] | None:
        """EU-URD-040, EU-URD-041: a quaternion is not zero, and the only orientation of its ``origin``."""
        values = self.numbers(element, "quat_xyzw", text, 4)
        if values is None:
            return None
        if "rpy" in element.attrib:
            self.report(
                "urdf-two-orientations",
                f"{named(element)} has two orientations, 'rpy' and 'quat_xyzw'",
                element,
                "quat_xyzw",
                "remove one of them",
            )
            return None
        if not any(values):
            self.report(
                "urdf-zero-quaternion",
                f"'quat_xyzw' of {named(element)} is zero, which is no orientation",
                element,
                "quat_xyzw",
                "write 0 0 0 1 for no rotation",
            )
            return None
        return values

    def later(self, element: Element, attribute: str | None, version: str) -> None:
        """EU-URD-038: note what a later version of URDF has: an attribute, if the element has it, or the element."""
        if attribute is None:
            self._later.setdefault((f"<{element.tag}>", version), []).append((element, None))
        elif attribute in element.attrib:
            self._later.setdefault((f"'{attribute}'", version), []).append((element, attribute))

    def report_later(self) -> None:
        """EU-URD-038: warn once of each attribute or shape of a later version of URDF."""
        stated = f"version {self.version}" if self.version else "no version"
        for (what, version), found in self._later.items():
            element, attribute = found[0]
            effect = "has no effect" if attribute else "is ignored by ROS and Pinocchio"
            times = f" ({len(found)} times in the file)" if len(found) > 1 else ""
            self.report(
                "urdf-later-version",
                f"{what} {effect} before URDF {version}, and <robot> has {stated}{times}",
                element,
                attribute,
                f'write version="{version}" in <robot>'
                + (", or state the orientation as 'rpy'" if attribute == "quat_xyzw" else ""),
            )
