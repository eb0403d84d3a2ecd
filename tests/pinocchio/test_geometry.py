"""The geometry is the one Pinocchio's own URDF parser builds, object by object, and moves with its body."""

from __future__ import annotations

import warnings
from pathlib import Path

import numpy as np
import pinocchio as pin
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from eurdf.mechanism.body import Body, Shape
from eurdf.mechanism.joint import Joint
from eurdf.mechanism.joint_types import JointType
from eurdf.mechanism.mechanism import Mechanism
from eurdf.mechanism.pose import Pose
from eurdf.pinocchio.configuration import configuration_vector
from eurdf.pinocchio.geometry import UnreadableMesh, build_geometry
from eurdf.pinocchio.meshes import Mesh, read_meshes
from eurdf.pinocchio.model import build_model
from eurdf.pinocchio.robot import build_robot
from support import by_hand
from support.plain_urdf import (
    POSITIVE,
    VERSIONS,
    Root,
    joint_element,
    link_element,
    mechanism_of,
    origins,
    robot,
    vector,
)

TETRAHEDRON = """solid tetrahedron
{}endsolid tetrahedron
""".format(
    "".join(
        f"facet normal 0 0 0\nouter loop\n{''.join(f'vertex {corner}' + chr(10) for corner in face)}endloop\nendfacet\n"
        for face in (
            ("0 0 0", "0 1 0", "1 0 0"),
            ("0 0 0", "1 0 0", "0 0 1"),
            ("0 0 0", "0 0 1", "0 1 0"),
            ("1 0 0", "0 1 0", "0 0 1"),
        )
    )
)

MATERIALS = [
    "",
    '<material name="red"/>',
    '<material name="own"><color rgba="0.1 0.2 0.3 0.4"/></material>',
    '<material name="wood"><texture filename="package://parts/wood.png"/></material>',
    '<material name="lost"><texture filename="package://parts/lost.png"/></material>',
    '<material name="both"><color rgba="1 0.5 0 1"/><texture filename="package://parts/wood.png"/></material>',
]
RED = '<material name="red"><color rgba="0.7 0.1 0 1"/></material>'
KINDS = {"visual": pin.GeometryType.VISUAL, "collision": pin.GeometryType.COLLISION}


@pytest.fixture(scope="module")
def parts(tmp_path_factory: pytest.TempPathFactory) -> Path:
    folder = tmp_path_factory.mktemp("packages")
    (folder / "parts").mkdir()
    (folder / "parts" / "tetrahedron.stl").write_text(TETRAHEDRON)
    (folder / "parts" / "wood.png").write_bytes(b"")
    return folder


@pytest.fixture(scope="module")
def tetrahedron(parts: Path) -> dict[str, Mesh]:
    """The mesh by path, read once for many robots."""
    path = str(parts / "parts" / "tetrahedron.stl")
    meshes, reasons = read_meshes([(path, (1.0, 1.0, 1.0))], {path: path})
    assert not reasons
    return meshes


class Finder:
    """Finds ``package://`` in a folder."""

    def __init__(self, folder: Path) -> None:
        self.folder = folder

    def __call__(self, uri: str) -> str | None:
        path = self.folder / uri.removeprefix("package://")
        return str(path) if path.is_file() else None


def pinocchios_own_geometry(text: str, model: pin.Model, kind: str, folder: Path) -> pin.GeometryModel:
    path = folder / "robot.urdf"
    path.write_text(text)
    with warnings.catch_warnings():
        warnings.simplefilter("ignore")  # about the order of the arguments of its own binding
        return pin.buildGeomFromUrdf(model, str(path), KINDS[kind], None, [str(folder)])


def assert_same_geometry(mine: pin.GeometryModel, expected: pin.GeometryModel) -> None:
    assert mine.ngeoms == expected.ngeoms
    assert len(mine.collisionPairs) == len(expected.collisionPairs) == 0
    for a, b in zip(mine.geometryObjects, expected.geometryObjects, strict=True):
        for name in (
            "name",
            "parentJoint",
            "parentFrame",
            "placement",
            "meshPath",
            "meshTexturePath",
            "overrideMaterial",
            "disableCollision",
        ):
            assert getattr(a, name) == getattr(b, name), (a.name, name)
        np.testing.assert_array_equal(a.meshScale, b.meshScale)
        np.testing.assert_array_equal(a.meshColor, b.meshColor)
        assert type(a.geometry) is type(b.geometry)
        assert a.geometry == b.geometry
    assert mine == expected


@st.composite
def shapes(draw: st.DrawFn, version: str) -> str:
    size = draw(POSITIVE)
    solid = draw(
        st.sampled_from(
            [
                f'<box size="{vector((size, 1, 2))}"/>',
                f'<cylinder radius="{size}" length="3"/>',
                f'<sphere radius="{size}"/>',
                f'<mesh filename="package://parts/tetrahedron.stl" scale="{vector((size, 1, 2))}"/>',
                *([f'<capsule radius="{size}" length="3"/>'] if version >= "1.1" else []),
            ]
        )
    )
    return f"{draw(origins(version))}<geometry>{solid}</geometry>"


@given(data=st.data(), root=st.sampled_from(["fixed", "floating"]))
@settings(deadline=None)
def test_tree_geometry_matches_pinocchio(
    parts: Path, tetrahedron: dict[str, Mesh], data: st.DataObject, root: Root
) -> None:
    count, version = data.draw(st.integers(1, 6)), data.draw(VERSIONS)
    names = data.draw(st.permutations([f"j{index}" for index in range(1, count)]))
    links = [
        link_element(
            f"l{index}",
            "".join(
                f"<visual>{shape}{data.draw(st.sampled_from(MATERIALS))}</visual>"
                for shape in data.draw(st.lists(shapes(version), max_size=3))
            )
            + "".join(f"<collision>{shape}</collision>" for shape in data.draw(st.lists(shapes(version), max_size=2))),
        )
        for index in range(count)
    ]
    joints = [
        joint_element(
            name,
            data.draw(st.sampled_from(["revolute", "fixed", "planar"])),
            f"l{data.draw(st.integers(0, index))}",
            f"l{index + 1}",
            '<limit lower="0" upper="1"/>' if version == "1.2" else '<limit effort="1" velocity="1"/>',
            origin=data.draw(origins(version)),
        )
        for index, name in enumerate(names)
    ]
    text = robot(RED, *links, *joints, version=version)
    mechanism = mechanism_of(text, root)
    built = build_robot(mechanism, geometry=True, resolve=Finder(parts), meshes=tetrahedron)
    assert_same_geometry(built.visual_model, pinocchios_own_geometry(text, built.model, "visual", parts))
    assert_same_geometry(built.collision_model, pinocchios_own_geometry(text, built.model, "collision", parts))


def test_capsule_is_along_z() -> None:
    mechanism = Mechanism("m", "", "fixed", (Body("base", collisions=(Shape("capsule", (0.1, 0.6)),)),), ())
    [capsule] = build_geometry(mechanism, build_model(mechanism), Finder(Path())).collision.geometryObjects
    assert (capsule.name, capsule.meshPath) == ("base_0", "CAPSULE")
    capsule.geometry.computeLocalAABB()
    box = capsule.geometry.aabb_local
    np.testing.assert_allclose((box.width(), box.height(), box.depth()), (0.2, 0.2, 0.8))


@pytest.mark.parametrize("kind", by_hand.MOVING)
def test_shape_moves_with_body(kind: JointType) -> None:
    random = np.random.default_rng(11)
    joint = by_hand.some_joint(kind, random)
    shape = Shape("sphere", (0.1,), by_hand.some_pose(random))
    inner = Joint("weld", JointType.FIXED, "tip", "end", by_hand.some_pose(random))
    bodies = (Body("base"), Body("tip", visuals=(shape,)), Body("end", visuals=(shape,)))
    joints = (Joint(**{**_fields(joint), "offset": by_hand.some_pose(random)}), inner)
    mechanism = Mechanism("m", "", "fixed", bodies, joints)
    built = build_robot(mechanism, geometry=True)
    coordinates = {joint.name: by_hand.some_coordinates(kind, random)}
    data = built.visual_model.createData()
    q = configuration_vector(mechanism, built.model, coordinates)
    pin.updateGeometryPlacements(built.model, built.data, built.visual_model, data, q)
    poses = by_hand.poses(mechanism, coordinates)
    for name, oMg in zip(("tip", "end"), data.oMg, strict=True):
        np.testing.assert_allclose(oMg.homogeneous, poses[name] @ by_hand.pose_matrix(shape.pose), atol=1e-12)


def _fields(joint: Joint) -> dict[str, object]:
    return {name: getattr(joint, name) for name in Joint.__dataclass_fields__}


def test_repeated_mesh_is_read_once(parts: Path) -> None:
    shape = Shape("mesh", (1.0, 1.0, 1.0), Pose(), "package://parts/tetrahedron.stl")
    larger = Shape("mesh", (2.0, 2.0, 2.0), Pose(), "package://parts/tetrahedron.stl")
    mechanism = Mechanism("m", "", "fixed", (Body("base", None, (shape, larger), (shape,)),), ())
    built = build_robot(mechanism, geometry=True, resolve=Finder(parts))
    small, large = (found.geometry for found in built.visual_model.geometryObjects)
    [collision] = (found.geometry for found in built.collision_model.geometryObjects)
    small.vertices()[0, 0] = 7.0
    assert collision.vertices()[0, 0] == 7.0
    assert large.vertices()[0, 0] == 0.0


@pytest.mark.parametrize(
    ("name", "content", "reason"),
    [
        ("rubbish.stl", b"rubbish\n" * 5, "STL"),
        ("cut.dae", b"<COLLADA", "XML"),
        ("empty.obj", b"", "empty"),
    ],
)
def test_invalid_mesh_is_named_with_reason(
    tmp_path: Path, capfd: pytest.CaptureFixture[str], name: str, content: bytes, reason: str
) -> None:
    (tmp_path / name).write_bytes(content)
    shape = Shape("mesh", (1.0, 1.0, 1.0), filename=f"package://{name}")
    mechanism = Mechanism("m", "", "fixed", (Body("base", None, (shape,)),), ())
    with pytest.raises(UnreadableMesh, match=f"mesh 'package://{name}' cannot be read") as caught:
        build_robot(mechanism, geometry=True, resolve=Finder(tmp_path))
    assert (caught.value.uri, caught.value.path) == (f"package://{name}", str(tmp_path / name))
    assert reason in caught.value.reason
    assert "\n" not in str(caught.value)
    assert capfd.readouterr() == ("", "")


def test_missing_mesh_is_an_error(tmp_path: Path) -> None:
    shape = Shape("mesh", (1.0, 1.0, 1.0), filename="package://lost.stl")
    mechanism = Mechanism("m", "", "fixed", (Body("base", None, (shape,)),), ())
    for resolve in (Finder(tmp_path), None):
        with pytest.raises(FileNotFoundError, match=r"mesh 'package://lost\.stl' does not exist"):
            build_robot(mechanism, geometry=True, resolve=resolve)
