"""The registry of losses: every kind of loss of every format does occur, and what has none is exact."""

from __future__ import annotations

import importlib.util
import json
import math
import struct
from collections.abc import Iterator
from dataclasses import replace
from itertools import islice
from pathlib import Path
from typing import Any
from xml.etree import ElementTree as ET

import numpy as np
import pytest

import eurdf
from eurdf.closures import REGISTRY
from eurdf.convert.export_format import export_format
from eurdf.convert.formats import EXPORTS
from eurdf.convert.hinges import with_hinges
from eurdf.mechanism.body import Frame, Inertia, Shape
from eurdf.mechanism.constraint import Compliance, Coupling
from eurdf.mechanism.joint import Joint, JointProperties
from eurdf.mechanism.joint_types import JointType
from eurdf.mechanism.mechanism import Mechanism, Motor
from eurdf.mechanism.pose import IDENTITY, Vector3
from eurdf.pinocchio.meshes import read_meshes
from eurdf.pinocchio.robot import Robot, build_robot
from support.exported import random_robot
from support.hostile_meshes import gltf

#: Kinds of loss that need what no robot here has: their tests are with their format.
_FILES = {"export-mesh-path", "export-mesh-refused", "export-file-outside"}
_COPIES = {*_FILES, "export-mesh-names"}
_CONVERTED = {"export-mesh-format", "export-mesh-converted", "export-mesh-not-referenced"}
ELSEWHERE = {
    "mjcf": _COPIES | _CONVERTED,
    "usd": {*_FILES, *_CONVERTED, "export-convex-hull"},
    "drake": _COPIES | _CONVERTED,
    "loop-joint": _COPIES,
    "sdf": _COPIES,
    "urdf": _COPIES,
}
#: Formats whose extra is not installed here.
MISSING = {"usd"} if importlib.util.find_spec("pxr") is None else set()
PERPENDICULAR = ((1.0, 0.0, 0.0), (0.0, 1.0, 0.0))
SKEW = ((1.0, 0.0, 0.0), (1.0, 2.0, 0.5))


def every_property(joint: Joint) -> Joint:
    """The joint with each property, of other values on each axis."""
    kind, n = joint.type, joint.type.nv
    if kind is JointType.FIXED or joint.mimic is not None:
        return joint
    some = tuple(float(value) for value in range(1, n + 1))
    properties = JointProperties(
        velocity=some,
        effort=some,
        damping=some,
        friction=some,
        armature=some,
        gear_ratio=(2.0,) * n,
        rotor_inertia=some,
        acceleration=some,
    )
    if joint.type.quaternion is None:
        properties = replace(properties, lower=(-9.0,) * n, upper=(9.0,) * n)
        if kind is not JointType.PLANAR:
            properties = replace(properties, stiffness=some, rest=(0.1,) * n)
    return replace(joint, properties=properties)


def with_limits(mechanism: Mechanism, lower: float, upper: float) -> Robot:
    """The robot with these limits of each coordinate that can have some."""

    def limited(joint: Joint) -> Joint:
        n = len(joint.type.coordinates)
        if joint.type.quaternion is not None:
            return joint
        return joint.with_properties(replace(joint.properties, lower=(lower,) * n, upper=(upper,) * n))

    return build_robot(replace(mechanism, joints=tuple(map(limited, mechanism.joints))), geometry=False)


def robots() -> Iterator[tuple[Mechanism, dict[str, Any]]]:
    """Robots with every element that a format may lose, and options of the export."""
    mechanism = random_robot(3, "floating")[0].mechanism
    yield mechanism, {}
    rich = replace(
        mechanism,
        joints=tuple(map(every_property, mechanism.joints)),
        closures=tuple(replace(each, compliance=Compliance(1e-6, 1e-6)) for each in mechanism.closures),
        couplings=(*mechanism.couplings, *_couplings(mechanism)),
        configurations={**mechanism.configurations, "other": {}},
        metadata={"license": "none"},
        actuators=tuple(joint.name for joint in mechanism.joints if joint.mimic is None and joint.type != "fixed"),
    )
    rich = replace(rich, motors={name: Motor(f"motor_{name}", (-3.0, 4.0)) for name in rich.actuators})
    yield rich, {}
    yield rich, {"actuators": "position"}
    yield rich, {"actuators": "none"}
    yield rich, {"joints": "hinge"}
    yield replace(rich, actuators=(), motors={}), {}
    yield replace(rich, motors={}), {}
    for name in ("four_bar", "digit_leg_3d"):
        yield eurdf.load(name, geometry=False).mechanism, {"closures": "hinge"}
    yield eurdf.load("talos_leg", geometry=False).mechanism, {"joints": "hinge"}
    yield _odd(mechanism, SKEW), {}
    yield replace(_odd(mechanism, PERPENDICULAR), root="fixed"), {}
    # No closed configuration: the ends of the closures are far away from each other.
    far = tuple(
        replace(each, a=replace(each.a, pose=replace(each.a.pose, xyz=(1e3, 1e3, 0.0)))) for each in mechanism.closures
    )
    yield replace(mechanism, closures=far, couplings=(), configurations={}), {}
    yield with_limits(mechanism, 0.0, 0.0).mechanism, {}
    four_bar = eurdf.load("four_bar", geometry=False).mechanism
    yield replace(with_limits(four_bar, 0.5, 0.6).mechanism, configurations={"other": {}}), {}


def _couplings(mechanism: Mechanism) -> Iterator[Coupling]:
    """One of three joints, and one of a rotation and a translation."""
    named = {joint.type: joint.name for joint in mechanism.joints if joint.mimic is None}
    names = [named[kind] for kind in (JointType.REVOLUTE, JointType.PRISMATIC, JointType.HELICAL)]
    yield Coupling("three", tuple((name, 1.0) for name in names))
    yield Coupling("two", tuple((name, 1.0) for name in names[:2]))
    yield Coupling("turns", ((named[JointType.REVOLUTE], 1.0), (named[JointType.CONTINUOUS], 1.0)))


def _odd(mechanism: Mechanism, axes: tuple[Vector3, Vector3]) -> Mechanism:
    """Links without mass and with inertias that no body has, equal limits, odd names, a texture, a missing mesh."""
    base, first, second, third, *others = mechanism.bodies
    shapes = (Shape("mesh", (1.0, 1.0, 1.0), filename="missing.stl"), Shape("sphere", (0.1,), texture="wood.png"))
    bodies = [
        replace(base, inertia=None, visuals=shapes),
        replace(first, inertia=Inertia(1.0, IDENTITY, (1.0, 0.0, 0.0, 1.0, 0.0, 3.0))),
        replace(second, inertia=Inertia(0.0, IDENTITY, (1.0, 0.0, 0.0, 1.0, 0.0, 1.0))),
        replace(third, inertia=None),
        *others,
    ]
    equal = JointProperties(lower=(0.5,), upper=(0.5,), effort=(0.0,))
    renamed = {base.name: "world", first.name: "a::b"}
    # Some formats call one of the joints that a spherical one becomes so.
    (ball,) = (joint.name for joint in mechanism.joints if joint.type is JointType.SPHERICAL)
    frames = (Frame(f"{ball}_x", "a::b"), Frame("__x__", "world"))
    return replace(
        mechanism,
        bodies=tuple(replace(body, name=renamed.get(body.name, body.name)) for body in bodies),
        joints=tuple(
            replace(
                joint,
                parent=renamed.get(joint.parent, joint.parent),
                child=renamed.get(joint.child, joint.child),
                properties=equal if joint.type is JointType.PRISMATIC else joint.properties,
                axes=axes if joint.type is JointType.UNIVERSAL else joint.axes,
            )
            for joint in mechanism.joints
        ),
        closures=(),
        couplings=(),
        configurations={},
        actuators=tuple(joint.name for joint in mechanism.joints if joint.type is JointType.PRISMATIC),
        frames=frames,
    )


@pytest.mark.slow
def test_every_kind_of_loss_occurs() -> None:
    found: dict[str, set[str]] = {name: set() for name in EXPORTS}
    held = eurdf.load("four_bar", geometry=False).with_contacts({"coupler": "3d"})
    for robot, options in [*((build_robot(each, geometry=False), options) for each, options in robots()), (held, {})]:
        mechanism = robot.mechanism
        for name in EXPORTS:
            if (
                name in MISSING
                or ("joints" in options and name != "mjcf")
                or (name == "sdf" and mechanism.closures and not mechanism.configurations)
            ):
                continue
            found[name] |= {loss.code for loss in eurdf.export(robot, name, **options).losses}
    missing = {
        name: {kind.code for kind in each.rows} - found[name] - ELSEWHERE[name]
        for name, each in ((name, export_format(name)) for name in EXPORTS)
        if name not in MISSING
    }
    assert not any(missing.values()), missing


@pytest.mark.parametrize("name", EXPORTS)
def test_every_type_of_joint_and_closure_is_stated_or_lost(name: str) -> None:
    format_ = export_format(name)
    known = {*format_.exact, *(kind.concept for kind in format_.rows)}
    assert {f"{kind} joint" for kind in JointType} | {f"{kind} closure" for kind in REGISTRY} <= known


@pytest.mark.parametrize(
    ("name", "kinds"),
    [
        ("urdf", {"3d", "6d", "hinge", "distance", "coupling"}),
        ("loop-joint", {"distance", "coupling"}),
        ("sdf", {"distance"}),
        ("drake", {"distance"}),
    ],
)
def test_constraint_that_is_left_out_is_a_loss(name: str, kinds: set[str]) -> None:
    robot, _ = random_robot(3)
    lost = {loss.name for loss in eurdf.export(robot, name).losses if loss.effect == "dropped"}
    constraints = robot.mechanism.constraints
    assert lost & {each.name for each in constraints} == {each.name for each in constraints if each.type in kinds}


@pytest.mark.parametrize("name", sorted(set(EXPORTS) - MISSING))
def test_limits_of_zero_are_written_as_none(name: str) -> None:
    mechanism = random_robot(3, "floating")[0].mechanism
    none = eurdf.export(with_limits(mechanism, -math.inf, math.inf), name)
    zero = eurdf.export(with_limits(mechanism, 0.0, 0.0), name)
    assert zero.files == none.files
    losses = {loss.name for loss in zero.losses if loss.code == "export-no-range"}
    kinds = {joint.name: joint.type for joint in mechanism.joints}
    assert losses == {name for name, kind in kinds.items() if kind.coordinates and kind.quaternion is None}
    assert {loss for loss in zero.losses if loss.code != "export-no-range"} == set(none.losses)


@pytest.mark.parametrize("name", [name for name in EXPORTS if name not in MISSING])
def test_actuators_are_named_as_the_description_names_them(name: str) -> None:
    _, rich = (mechanism for mechanism, _ in islice(robots(), 2))
    losses = eurdf.export(build_robot(rich, geometry=False), name).losses
    named = {loss.name for loss in losses if loss.concept in ("actuator", "control range", "gear ratio")}
    assert named
    assert named <= {motor.name for motor in rich.motors.values()}


@pytest.mark.parametrize(("name", "code", "kind"), [("four_bar", "hinge", "revolute"), ("delta", "ball", "spherical")])
def test_balls_that_move_as_hinges_become_hinges(name: str, code: str, kind: str) -> None:
    export = eurdf.export(name, "loop-joint", closures="hinge")
    assert {loss.code for loss in export.losses if loss.concept == "3d closure"} == {f"export-{code}"}
    assert {loop.get("type") for loop in ET.fromstring(export.main).findall("loop_joint")} == {kind}


def test_hinges_leave_the_motion_of_the_balls() -> None:
    for name in ("four_bar", "five_bar_3d", "slider_crank", "planar_3rrr"):
        robot = eurdf.load(name, geometry=False)
        q = robot.configurations["assembled"]
        hinged, losses = with_hinges(robot, q)
        kinds = {closure.type for closure in hinged.mechanism.closures}
        assert "3d" not in kinds, losses
        before, after = eurdf.analyze(robot, q), eurdf.analyze(hinged, q)
        assert after.mobility == before.mobility
        moved = eurdf.assemble(robot, q + 0.1).q
        assert abs(eurdf.residual(hinged, moved)).max() < 1e-9


@pytest.mark.parametrize("name", ["drake", "loop-joint", "mjcf", "sdf", "urdf"])
def test_meshes_are_copied_converted_or_reported(tmp_path: Path, name: str) -> None:
    facet = "facet normal 0 0 1 outer loop vertex 0 0 0 vertex 1 0 0 vertex 0 1 0 endloop endfacet"
    (tmp_path / "pkg").mkdir()
    (tmp_path / "pkg" / "a.stl").write_text(f"solid a {facet} endsolid a")
    (tmp_path / "b.dae").write_text("<COLLADA/>")
    meshes = [
        f'<visual><geometry><mesh filename="{uri}"/></geometry></visual>' for uri in ("package://pkg/a.stl", "b.dae")
    ]
    (tmp_path / "robot.urdf").write_text(f'<robot name="r"><link name="base">{"".join(meshes)}</link></robot>')
    export = eurdf.export(tmp_path / "robot.urdf", name, package_dirs=[tmp_path])
    codes = {(loss.code, loss.name) for loss in export.losses if loss.concept == "mesh"}
    expected = {("export-mesh-path", "package://pkg/a.stl")}
    copied = ["meshes/a.stl", "meshes/b.dae"]
    if name in ("drake", "mjcf"):
        expected |= {("export-mesh-converted", "package://pkg/a.stl"), ("export-mesh-format", "b.dae")}
        copied = ["meshes/a.stl.obj"]
    assert codes == expected
    assert list(export.files)[1:] == copied
    folder = "" if name == "mjcf" else "meshes/"  # MJCF names the folder elsewhere
    assert [each for each in copied if each.replace("meshes/", folder).encode() not in export.main] == []
    assert b"package://" not in export.main


def _package(folder: Path) -> Path:
    """A package with a mesh of each kind that names other files, beside a folder with one more mesh."""
    for name in ("meshes", "textures", "urdf"):
        (folder / "arm" / name).mkdir(parents=True)
    meshes, faces = folder / "arm" / "meshes", b"v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n"
    (folder / "arm" / "package.xml").write_text("<package><name>arm</name></package>")
    (folder / "arm" / "textures" / "red.png").write_bytes(b"red")
    (meshes / "a.obj").write_bytes(b"mtllib a b.mtl\n" + faces)
    (meshes / "a b.mtl").write_bytes(
        b"newmtl a\nmap_Kd -s 1 1 1 ../textures/red.png\nbump lost.png\nrefl ../../out.png\n"
    )
    (meshes / "c.gltf").write_text(json.dumps(gltf("c%20.bin", "../textures/red.png")))
    (meshes / "c .bin").write_bytes(struct.pack("<9f", 0, 0, 0, 2, 0, 0, 0, 3, 0))
    (folder / "out.png").write_bytes(b"out")
    (folder / "out.obj").write_bytes(faces)
    uris = ("package://arm/meshes/a.obj", "../meshes/c.gltf", "../../out.obj")
    shapes = "".join(f'<visual><geometry><mesh filename="{uri}"/></geometry></visual>' for uri in uris)
    urdf = folder / "arm" / "urdf" / "robot.urdf"
    urdf.write_text(f'<robot name="r"><link name="base">{shapes}</link></robot>')
    return urdf


def _losses(export: eurdf.convert.Export) -> set[tuple[str, str]]:
    return {(loss.code, Path(loss.name).name) for loss in export.losses if loss.concept == "mesh"}


def test_files_that_meshes_name_are_copied_or_reported(tmp_path: Path) -> None:
    urdf = _package(tmp_path)
    export = eurdf.export(urdf, "urdf")
    copied = {"meshes/a.obj", "meshes/a b.mtl", "textures/red.png", "meshes/c.gltf", "meshes/c .bin"}
    assert set(export.files) == {"robot.urdf", *copied}
    assert _losses(export) == {
        ("export-mesh-path", "a.obj"),
        ("export-mesh-refused", "out.obj"),
        ("export-mesh-names", "a.obj: lost.png"),
        ("export-mesh-names", "out.png"),
    }
    [written, *_] = export.write(tmp_path / "written")
    copy = written.parent / "meshes"
    for name in ("a.obj", "c.gltf"):
        [old], [new] = (
            read_meshes([("", (1.0, 1.0, 1.0))], {"": str(folder / name)})[0].values()
            for folder in (urdf.parent.parent / "meshes", copy)
        )
        assert np.array_equal(old.vertices, new.vertices)


def test_files_outside_are_exported_if_allowed(tmp_path: Path) -> None:
    export = eurdf.export(_package(tmp_path), "sdf", allow_outside=True)
    assert "meshes/out.obj" in export.files
    assert ("export-file-outside", "out.obj") in _losses(export)
    assert ("export-file-outside", "out.png") in _losses(export)
    assert not any(code == "export-mesh-refused" for code, _ in _losses(export))
    # Of a robot that was loaded, only what its meshes name can be outside.
    robot = eurdf.load(_package(tmp_path / "again"), allow_outside=True)
    assert "meshes/out.obj" in eurdf.export(robot, "sdf").files
