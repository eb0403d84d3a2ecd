"""Mutators: what makes a damaged file of a sound one, at the level of bytes, tokens, trees and numbers."""

from __future__ import annotations

import json
import random
import re
from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from typing import Any

import yaml
from lxml import etree

NAN_FREE_NUMBERS = ("0", "-0.0", "1", "-1", "3", "1e-320", "1e-200", "1e-9", "1e-5", "1e5", "1e20", "1e155", "1e200")
NUMBERS = (
    *NAN_FREE_NUMBERS,
    "1e15",
    "-1.1e15",
    "1e-15",
    "9e-16",
    "1e308",
    "-1e308",
    "1.7976931348623157e308",
    "-1e-308",
    "3.141592653589793",
    "0.5",
)
NOT_NUMBERS = ("nan", "inf", "-inf", ".nan", ".inf", "1e400", "0x10", "1_000", "1,5", "", " ", "--1", "1e", "٣", "1 2")
NAMES = (
    "", " ", "\t", "universe", "root_joint", "x-own", "é", "日本", "🤖", "a/b", "a b", "null", "~", "../robot.urdf",
    "/dev/zero", ".", "..", "'", '"', "\u2028", "\x85", "\ufeff", "<", "&amp;", "%s", "{0}", "[link]", "n" * 300,
    "n" * 5000, "a" * 70_000,
)  # fmt: skip
YAML_VALUES = (
    "null", "true", "no", "[]", "{}", "[[]]", "{x: {}}", "0x10", "0o17", "1_000", "12:30", "1e3", "-1", "1e308",
    "1e-320", "9999999999999999999999999", ".inf", ".nan", "!!str 1", "!!int x", "!!binary aGk=", "!own x",
    "*nowhere", "&here x", "<<", "'3d'", "6D", "x-belt", "spherical", "universal", "helical", "cylindrical", "fixed",
    "floating", "hinge", "distance", '"2.0"', '"2.1"', "2.0", "1", "[0, 0, 0]", "[0, 0, 0, 1]", "[1e200, 0, 0]",
    "[1, 2]", "[0, 0, 0, 0]", '"\\0"',
    '"\\ud800"', "'2001-01-01'", "2001-01-01", "{type: universal, axes: xy}",
    "{type: universal, axes: [[1e200, 0, 0], [0, 1e-9, 0]]}", "{type: helical, pitch: 1e-320}",
    "{type: helical, pitch: 1e308}", "{type: spherical}", "{type: cylindrical}",
    "{limits: {lower: -1e308, upper: 1e308}}", "{armature: 1e308}", "{mimic: false}",
    "{stiffness: 1e308, rest: 1e308}", "{linear: 0}", "{motor: 1e308, grip: 1e-320}",
    "{link: base, xyz: [1e308, -1e308, 1e308]}", "{link: base, rpy: [1e308, 0, 1e308]}",
)  # fmt: skip
YAML_KEYS = """
    extended_urdf urdf root closures joints actuators frames configurations metadata name type link joint xyz
    rpy axes merges pitch limits lower upper velocity effort damping friction armature gear_ratio rotor_inertia
    assembled axis length compliance linear angular couplings offset stiffness rest mimic control closed_loop
    name_mot joint_name joint_type
""".split()  # noqa: SIM905
TAGS = """
    robot link joint inertial origin mass inertia visual collision geometry box sphere cylinder capsule mesh
    material color texture parent child axis limit dynamics mimic calibration safety_controller loop
    transmission gazebo jont lnik
""".split()  # noqa: SIM905
ATTRIBUTES = """
    name type link xyz rpy value ixx iyy izz ixy size radius length scale filename rgba lower upper effort
    velocity damping friction joint multiplier offset
""".split()  # noqa: SIM905
JOINT_TYPES = ("revolute", "continuous", "prismatic", "planar", "floating", "fixed", "spherical", "Revolute")
YAML_BYTES = (
    b"[", b"]", b"{", b"}", b": ", b"- ", b"\n", b"\t", b"\r", b"#", b"'", b'"', b"&a ", b"*a", b"!!str ", b"---\n",
    b"...\n", b"|\n", b">\n", b"? ", b"%YAML 1.1\n", b"%TAG ! x\n", b"\0", b"\xff", b"\xfe\xff", b"\xef\xbb\xbf",
    b"\xe2\x80\xa8", b"<<: ", b"  ", b"1e308",
)  # fmt: skip
XML_BYTES = (
    b"<", b">", b"/>", b"</", b"<!--", b"-->", b"<![CDATA[", b"]]>", b"<?xml?>", b"<!DOCTYPE robot>", b"&amp;",
    b"&x;", b"&#0;", b"&#x10FFFF;", b'"', b"'", b"=", b" ", b"\0", b"\xff", b"xmlns='u'", b" xmlns:x='u'", b"x:",
    b":", b"xmlns:", b"nan", b"1e308", b"-", b"0", b"<link name='l'/>", b"<joint>", b"${x}",
)  # fmt: skip


MESH_COUNTS = ("0", "-1", "1000000", "2147483647", "2147483648", "4294967295", "4294967296", "9223372036854775807")
MESH_BYTES = (
    b"solid ", b"endsolid", b"facet normal 0 0 1\n", b"outer loop\n", b"vertex ", b"endloop\n", b"v 0 0 0\n",
    b"f 1 2 3\n",
    b"f 1//1 2//2 3//3\n", b"mtllib x.mtl\n", b"usemtl x\n", b"<node id='n'>", b"</node>", b"<instance_node url='#n'/>",
    b"<float_array count='3'>", b"OFF\n", b"ply\n", b"end_header\n", b"\n", b" ", b"/", b"nan", b"1e400",
)  # fmt: skip

# -- bytes ----------------------------------------------------------------------------------------------------------


def mutate_bytes(data: bytes, chance: random.Random, tokens: Sequence[bytes]) -> bytes:
    """The bytes with one to four places changed."""
    for _ in range(chance.choice((1, 1, 1, 2, 4))):
        at = chance.randrange(len(data) + 1)
        size = chance.choice((1, 1, 2, 8, 40, 400))
        match chance.randrange(7):
            case 0 if at < len(data):
                data = data[:at] + bytes([data[at] ^ (1 << chance.randrange(8))]) + data[at + 1 :]
            case 1:
                data = data[:at] + data[at + size :]
            case 2:
                to = chance.randrange(len(data) + 1)
                data = data[:to] + data[at : at + size] + data[to:]
            case 3:
                data = data[:at] + data[at : at + size] * chance.choice((2, 3, 50)) + data[at + size :]
            case 4:
                data = data[:at] + chance.randbytes(chance.choice((1, 2, 8))) + data[at:]
            case 5:
                data = data[:at]
            case _:
                data = data[:at] + chance.choice(tokens) + data[at + chance.choice((0, 1)) :]
    return data


# -- YAML trees -----------------------------------------------------------------------------------------------------


@dataclass(slots=True)
class Raw:
    """A piece of YAML as it is written."""

    text: str


class Mapping(list[list[Any]]):
    """The pairs of a mapping: keys may be moved, and occur twice."""


def _pairs(value: Any) -> Any:
    if isinstance(value, dict):
        return Mapping([key, _pairs(item)] for key, item in value.items())
    return [_pairs(item) for item in value] if isinstance(value, list) else value


def _written(value: Any, indent: str = "\n") -> str:
    if isinstance(value, Raw):
        return value.text
    inner = indent + " "
    if isinstance(value, Mapping):
        return "{" + ",".join(f"{inner}{_written(key)}: {_written(item, inner)}" for key, item in value) + "}"
    if isinstance(value, list):
        return "[" + ", ".join(_written(item, inner) for item in value) + "]"
    return json.dumps(value, ensure_ascii=False)


def _slots(tree: Any) -> Iterator[tuple[Any, int]]:
    """Every place of the tree that holds a value: a pair and 1, or a list and an index."""
    if isinstance(tree, Mapping):
        for pair in tree:
            yield pair, 1
            yield from _slots(pair[1])
    elif isinstance(tree, list):
        for index, item in enumerate(tree):
            yield tree, index
            yield from _slots(item)


def _collections(tree: Any, kind: type) -> list[Any]:
    found = [tree] if type(tree) is kind and tree else []
    return found + [holder[at] for holder, at in _slots(tree) if type(holder[at]) is kind and holder[at]]


def mutate_yaml(data: bytes, chance: random.Random, names: Sequence[str]) -> bytes:
    """The description with one to three places of its tree changed."""
    tree = _pairs(yaml.safe_load(data))
    for _ in range(chance.choice((1, 1, 2, 3))):
        places = list(_slots(tree))
        if not places:
            break
        holder, at = chance.choice(places)
        other, there = chance.choice(places)
        mappings, lists = _collections(tree, Mapping), _collections(tree, list)
        match chance.randrange(11):
            case 0:
                holder[at] = Raw(chance.choice(YAML_VALUES))
            case 1:
                numbers = [(of, index) for of, index in places if type(of[index]) in (int, float)]
                holder, at = chance.choice(numbers or places)
                holder[at] = Raw(chance.choice(NUMBERS if chance.random() < 0.8 else NOT_NUMBERS) or "''")
            case 2:
                holder[at] = chance.choice(NAMES)
            case 3:
                texts = [(of, index) for of, index in places if type(of[index]) is str]
                holder, at = chance.choice(texts or places)
                holder[at] = chance.choice(names)
            case 4:
                holder[at], other[there] = other[there], holder[at]
            case 5 if mappings:
                chance.choice(chance.choice(mappings))[0] = chance.choice(
                    (*YAML_KEYS, *NAMES, *names, Raw("1"), Raw("null"))
                )
            case 6 if mappings:
                of = chance.choice(mappings)
                of.pop(chance.randrange(len(of)))
            case 7 if mappings:
                of = chance.choice(mappings)
                pair = chance.choice(of)
                of.append([pair[0] if chance.random() < 0.3 else chance.choice(names), pair[1]])
            case 8 if mappings:
                of, to = chance.choice(mappings), chance.choice(mappings)
                to.append(of.pop(chance.randrange(len(of))))
            case 9 if lists:
                of = chance.choice(lists)
                if chance.random() < 0.5:
                    of.pop(chance.randrange(len(of)))
                else:
                    of.extend([chance.choice(of)] * chance.choice((1, 1, 5, 300)))
            case _:
                if mappings:
                    value = Raw(chance.choice(YAML_VALUES))
                    chance.choice(mappings).append([chance.choice((*YAML_KEYS, *names)), value])
        if any(_holds_itself(item, []) for item in [tree]):
            return data
    return _written(tree).encode("utf-8", "surrogatepass")


def _holds_itself(tree: Any, around: list[int]) -> bool:
    if not isinstance(tree, list):
        return False
    if id(tree) in around or len(around) > 50:
        return True
    items = (pair[1] for pair in tree) if isinstance(tree, Mapping) else tree
    return any(_holds_itself(item, [*around, id(tree)]) for item in items)


# -- XML trees ------------------------------------------------------------------------------------------------------


def _settable(text: str) -> str:
    """The text without what XML cannot have."""
    return "".join(c for c in text if c in "\t\n\r" or c >= " ")


def mutate_xml(
    data: bytes,
    chance: random.Random,
    names: Sequence[str],
    tags: Sequence[str] = TAGS,
    attributes: Sequence[str] = ATTRIBUTES,
) -> bytes:
    """The file with one to three places of its tree changed.

    Args:
        data: A URDF, or a file of another format.
        chance: Where it draws from.
        names: Names of elements.
        tags: Tags of the format.
        attributes: Attributes of the format.
    """
    root: Any = etree.fromstring(data)
    for _ in range(chance.choice((1, 1, 2, 3))):
        elements: list[Any] = list(root.iter("*"))
        element, other = chance.choice(elements), chance.choice(elements)
        numeric = [found for found in elements if _numeric(found)]
        match chance.randrange(13):
            case 0 if element is not root:
                element.getparent().remove(element)
            case 1 if element is not root:
                element.getparent().insert(chance.randrange(9), _copy(element))
            case 2 if element is not root and element not in other.iterancestors() and other is not element:
                other.append(element)
            case 3:
                element.tag = chance.choice(tags)
            case 4 if element.attrib:
                del element.attrib[chance.choice(list(element.attrib))]
            case 5:
                element.set(
                    chance.choice(attributes), _settable(chance.choice((*NUMBERS, *NOT_NUMBERS, *NAMES, *names)))
                )
            case 6 | 7 | 8 if numeric:
                element = chance.choice(numeric)
                key = chance.choice(_numeric(element))
                values = (element.text or "" if key is None else element.get(key, "")).split()
                values[chance.randrange(len(values))] = chance.choice(NUMBERS if chance.random() < 0.8 else NOT_NUMBERS)
                if key is None:
                    element.text = " ".join(values)
                else:
                    element.set(key, " ".join(values))
            case 9:
                named = [found for found in elements if found.get("link") or found.get("name") or found.get("joint")]
                element = chance.choice(named or elements)
                key = next((key for key in ("link", "joint", "name") if element.get(key)), "name")
                element.set(key, _settable(chance.choice((*NAMES, *names, *names, *names, *names))))
            case 10:  # joints hung elsewhere: cycles, second roots, second parents
                sides = [found for found in elements if found.tag in ("parent", "child")]
                if sides:
                    chance.choice(sides).set("link", chance.choice(names))
            case 11:
                joints = [found for found in elements if found.tag == "joint"]
                if joints:
                    joint = chance.choice(joints)
                    joint.set("type", chance.choice(JOINT_TYPES))
                    if chance.random() < 0.3:
                        law = etree.SubElement(joint, "mimic", joint=chance.choice(names))
                        law.set("multiplier", chance.choice(NUMBERS))
            case _:
                element.text = chance.choice(("text", "&", "]]>", "1e308"))
    return etree.tostring(root, encoding="utf-8")


def _copy(element: Any) -> Any:
    return etree.fromstring(etree.tostring(element, with_tail=False))


def _numeric(element: Any) -> list[str | None]:
    """The attributes of an element that are numbers, and None if its text is."""
    found: list[str | None] = [key for key, value in element.attrib.items() if _is_numbers(value)]
    return [*found, None] if _is_numbers(element.text or "") else found


def _is_numbers(text: str) -> bool:
    try:
        return bool([float(part) for part in text.split()])
    except ValueError:
        return False


# -- meshes ---------------------------------------------------------------------------------------------------------

_NUMBER = re.compile(rb"-?\d+(?:\.\d+)?(?:[eE][-+]?\d+)?")


def mutate_mesh(data: bytes, chance: random.Random) -> bytes:
    """The mesh with one to three numbers, counts or places changed."""
    for _ in range(chance.choice((1, 1, 2, 3))):
        numbers = list(_NUMBER.finditer(data))
        match chance.randrange(4):
            case 0 | 1 if numbers:
                found = chance.choice(numbers)
                number = chance.choice((*NUMBERS, *NOT_NUMBERS, *MESH_COUNTS)).encode()
                data = data[: found.start()] + number + data[found.end() :]
            case 2:
                at, size = chance.randrange(len(data) + 1), chance.choice((2, 4, 8))
                data = data[:at] + chance.choice((b"\0", b"\xff", b"\x7f", b"\x80")) * size + data[at + size :]
            case _:
                data = mutate_bytes(data, chance, MESH_BYTES)
    return data
