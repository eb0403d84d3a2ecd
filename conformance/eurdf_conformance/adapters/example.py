"""A complete adapter, of a toy parser of version 1: ``--parser=eurdf_conformance.adapters.example:Example``."""

from math import cos, sin
from pathlib import Path
from typing import Any, ClassVar
from xml.etree import ElementTree

import yaml

from eurdf_conformance.level import Level
from eurdf_conformance.protocol.message import Accepted, Rejected, Unsupported
from eurdf_conformance.protocol.reply import accepted, rejected, unsupported

WRONG = (OSError, yaml.YAMLError, ElementTree.ParseError, KeyError, ValueError)  # raised for wrong files

ROUND = ("radius", "length")
SIZES = {"box": ("size",), "cylinder": ROUND, "capsule": ROUND, "sphere": ("radius",), "mesh": ("scale",)}


class Example:
    """The adapter: name and claims of the parser, and its answer on two files."""

    name, version, language = "example", "0.1", "Python"
    claims: ClassVar = {"1": [Level.ACCEPT, Level.STRUCTURE]}
    lacks: ClassVar = ["planar", "floating", "spherical", "universal"]

    def load(self, description: Path, urdf: Path) -> Accepted | Rejected | Unsupported:
        """Let the parser read the files, and answer with the result."""
        try:
            robot = read(yaml.safe_load(description.read_bytes()), ElementTree.parse(urdf).getroot())
        except NotImplementedError as feature:
            return unsupported(str(feature))
        except WRONG as why:
            return rejected(f"{type(why).__name__}: {why}")
        return accepted(robot)


def read(said: Any, robot: ElementTree.Element) -> dict[str, Any]:
    """The parser: the robot as a canonical description."""
    if not isinstance(said, dict):
        raise ValueError("the description is not a mapping")
    if "extended_urdf" in said:
        raise NotImplementedError("version 2")
    if "joint_name" in said:
        raise NotImplementedError("universal" if "UJOINT" in str(said) else "spherical")
    closed, motors = said.pop("closed_loop", []), said.pop("name_mot", [])
    types = [str(kind).lower() for kind in said.pop("type", ["6d"] * len(closed))]
    if not {"3d", "6d"}.issuperset(types):
        raise ValueError("a closure is 3d or 6d")
    canonical: dict[str, Any] = {"version": "1", "root": "fixed", "frames": [], "configurations": {}}
    canonical["name"], canonical["own"] = robot.attrib["name"], {f"/{key}": value for key, value in said.items()}
    canonical["links"] = [link.attrib["name"] for link in robot.findall("link")]
    canonical["shapes"] = [
        shape_of(link.attrib["name"], use, element)
        for link in robot.findall("link")
        for use in ("visual", "collision")
        for element in link.findall(use)
    ]
    joints = [joint_of(element) for element in robot.findall("joint")]
    canonical["joints"] = [joint for joint in joints if joint["type"] != "fixed"]
    canonical["actuators"] = [{"joint": name} for name in motors]
    body = {link: link for link in canonical["links"]} | {joint["name"]: joint["child"] for joint in joints}
    closures = [{"type": kind, "a": body[a], "b": body[b]} for (a, b), kind in zip(closed, types, strict=True)]
    canonical["closures"] = [{"name": f"closure_{1 + i}"} | closure for i, closure in enumerate(closures)]
    return canonical


def joint_of(joint: ElementTree.Element) -> dict[str, Any]:
    """One joint of the URDF, with its limits."""
    kind, (parent,), (child,) = joint.attrib["type"], joint.findall("parent"), joint.findall("child")
    if kind in ("planar", "floating"):
        raise NotImplementedError(kind)
    limit, dynamics = ({} if (found := joint.find(tag)) is None else found.attrib for tag in ("limit", "dynamics"))
    read: dict[str, Any] = {"name": joint.attrib["name"], "type": kind, "armature": [0.0]}
    read |= {"parent": parent.attrib["link"], "child": child.attrib["link"]}
    read |= {key: [None if kind == "continuous" else float(limit.get(key, 0))] for key in ("lower", "upper")}
    read |= {key: [float(limit[key]) if limit else None] for key in ("velocity", "effort")}
    return read | {key: [float(dynamics.get(key, 0))] for key in ("damping", "friction")}


def shape_of(link: str, use: str, element: ElementTree.Element) -> dict[str, Any]:
    """One shape, with its pose in the frame of its link."""
    (geometry,) = element.findall("geometry")
    (shape,) = [child for child in geometry if child.tag in SIZES]
    sizes = {key: shape.get(key, "1 1 1") if key == "scale" else shape.attrib[key] for key in SIZES[shape.tag]}
    origin = {} if (found := element.find("origin")) is None else found.attrib
    r, p, y = map(float, origin.get("rpy", "0 0 0").split())
    rotation = [
        [cos(y) * cos(p), cos(y) * sin(p) * sin(r) - sin(y) * cos(r), cos(y) * sin(p) * cos(r) + sin(y) * sin(r)],
        [sin(y) * cos(p), sin(y) * sin(p) * sin(r) + cos(y) * cos(r), sin(y) * sin(p) * cos(r) - cos(y) * sin(r)],
        [-sin(p), cos(p) * sin(r), cos(p) * cos(r)],
    ]
    return {
        "link": link,
        "use": use,
        "type": shape.tag,
        "size": [float(number) for size in sizes.values() for number in size.split()],
        "file": shape.get("filename"),
        "pose": {"rotation": rotation, "translation": [float(x) for x in origin.get("xyz", "0 0 0").split()]},
    }
