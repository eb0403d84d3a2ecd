"""Mesh files: those that Pinocchio reads give the same geometry, and no file crashes or stalls a caller."""

from __future__ import annotations

import os
import struct
from collections.abc import Callable
from pathlib import Path

import coal
import numpy as np
import pytest

import eurdf
from eurdf.mechanism.body import Body, Shape
from eurdf.mechanism.mechanism import Mechanism
from eurdf.mesh_files.reader import BYTES_LIMIT
from eurdf.pinocchio import meshes
from eurdf.pinocchio.robot import build_robot

FULL_SIZE = (1.0, 1.0, 1.0)
MIRRORED = (0.5, -2.0, 1e-3)


def binary_stl(*vertices: float, count: int | None = None) -> bytes:
    """Triangles, nine numbers each; the count of the header where it is not theirs."""
    rows = np.array(vertices).reshape(-1, 9)
    triangles = b"".join(struct.pack("<12fH", 0, 0, 1, *row, 0) for row in rows)
    return bytes(80) + struct.pack("<I", len(rows) if count is None else count) + triangles


def collada(nodes: str, library: str = "") -> bytes:
    """One triangle as geometry ``g``, in centimetres, y up."""
    return f"""<?xml version="1.0"?>
<COLLADA xmlns="http://www.collada.org/2005/11/COLLADASchema" version="1.4.1">
<asset><unit name="centimeter" meter="0.01"/><up_axis>Y_UP</up_axis></asset>
<library_geometries><geometry id="g"><mesh>
<source id="s"><float_array id="a" count="9">0 0 0 1 0 0 0 2 3</float_array><technique_common>
<accessor source="#a" count="3" stride="3"><param name="X" type="float"/><param name="Y" type="float"/>
<param name="Z" type="float"/></accessor></technique_common></source>
<vertices id="v"><input semantic="POSITION" source="#s"/></vertices>
<triangles count="1"><input semantic="VERTEX" source="#v" offset="0"/><p>0 1 2</p></triangles>
</mesh></geometry></library_geometries>{library}
<library_visual_scenes><visual_scene id="scene">{nodes}</visual_scene></library_visual_scenes>
<scene><instance_visual_scene url="#scene"/></scene></COLLADA>""".encode()


PLACED = '<instance_geometry url="#g"/>'
OBJ = b"v 0 0 0\nv 1 0 0\nv 1 1 0.1\nv 0 1 0\nf 1 2 3 4\nf 1 3 4\n"
OFF = b"OFF\n4 2 0\n0 0 0\n1 0 0\n0 1 0\n0 0 1\n3 0 1 2\n3 0 2 3\n"
PLY = """ply
format ascii 1.0
element vertex {}
property float x
property float y
property float z
element face 1
property list uchar int vertex_indices
end_header
0 0 0
1 0 0
0 1 0
3 0 1 2
"""
SOUND = {
    "binary.stl": binary_stl(0, 0, 0, 1, 0, 0, 0, 1, 0, 0, 0, 0, 0, 1, 0, 0, 0, 1.1),
    "text.stl": b"solid t\nfacet normal 0 0 1\nouter loop\nvertex 0 0 0\nvertex 1 0 0\nvertex 0 1 1e-1\nendloop\n"
    b"endfacet\nendsolid t\n",
    "quad.obj": OBJ,
    "upper-case.STL": binary_stl(0, 0, 0, 1, 0, 0, 0, 1, 0),
    "one.dae": collada(f'<node id="n">{PLACED}</node>'),
    "two.dae": collada(
        f'<node id="n"><translate>1 2 3</translate><node id="m"><rotate>0 0 1 30</rotate>{PLACED}</node></node>'
        f'<node id="o"><scale>2 1 1</scale>{PLACED}</node>'
    ),
    "shape.off": OFF,
    "shape.ply": PLY.format(3).encode(),
}
CRASHES = {
    "self.dae": collada('<node id="n"><instance_node url="#n"/></node>'),
    "deep.dae": collada("<node>" * 30_000 + PLACED + "</node>" * 30_000),
}
#: Files that are no mesh, and a part of the reason that is given.
UNSOUND = {
    **dict.fromkeys(CRASHES, "crashed"),
    "huge.off": "MiB of memory",
    "huge.ply": "MiB of memory",
    "rubbish.stl": "STL",
    "cut.stl": "STL",
    "empty.stl": "STL",
    "nan.stl": "not finite",
    "points.obj": "mesh",
    "pointer.stl": "git lfs pull",
}
FILES = {
    **SOUND,
    **CRASHES,
    "huge.off": b"OFF\n1000000000 1000000000 0\n0 0 0\n",
    "huge.ply": PLY.format(100_000_000).encode(),
    "rubbish.stl": b"rubbish\n" * 5,
    "cut.stl": binary_stl(0, 0, 0, 1, 0, 0, 0, 1, 0, count=70_000_000),
    "empty.stl": binary_stl(),
    "nan.stl": binary_stl(0, 0, 0, 1, 0, float("nan"), 0, 1, 0),
    "points.obj": b"v 0 0 0\nv 1 0 0\nv 0 1 0\n",
    "pointer.stl": b"version https://git-lfs.github.com/spec/v1\noid sha256:4d7a\nsize 12345\n",
}


@pytest.fixture(scope="module")
def folder(tmp_path_factory: pytest.TempPathFactory) -> Path:
    folder = tmp_path_factory.mktemp("meshes")
    for name, content in FILES.items():
        (folder / name).write_bytes(content)
    return folder


def read(*paths: Path, scale: tuple[float, ...] = FULL_SIZE) -> tuple[dict[str, meshes.Mesh], dict[str, str]]:
    """The meshes and the reasons, by file name."""
    found, reasons = meshes.read_meshes([(path.name, scale) for path in paths], {p.name: str(p) for p in paths})
    return {Path(path).name: mesh for path, mesh in found.items()}, reasons


def urdf_with(*names: str, scale: str = "1 1 1") -> str:
    visuals = (f'<visual><geometry><mesh filename="{name}" scale="{scale}"/></geometry></visual>' for name in names)
    return f'<robot name="r"><link name="a">{"".join(visuals)}</link></robot>'


@pytest.fixture
def runs(monkeypatch: pytest.MonkeyPatch) -> list[list[str]]:
    """The names of the files that each process is given."""
    given: list[list[str]] = []
    run = meshes._run

    def recorded(files: list[meshes._File]) -> object:
        given.append([Path(file.path).name for file in files])
        return run(files)

    monkeypatch.setattr(meshes, "_run", recorded)
    return given


def test_geometry_equals_that_of_coal(folder: Path) -> None:
    shapes = [Shape("mesh", scale, filename=name) for name in SOUND for scale in (FULL_SIZE, MIRRORED)]
    mechanism = Mechanism("m", "", "fixed", (Body("base", None, tuple(shapes)),), ())
    built = build_robot(mechanism, geometry=True, resolve=lambda uri: str(folder / uri))
    for shape, mine in zip(shapes, built.visual_model.geometryObjects, strict=True):
        expected = coal.MeshLoader().load(str(folder / shape.filename), np.array(shape.size))
        assert expected.num_tris > 0
        assert mine.geometry == expected, shape


def test_unreadable_mesh_is_reported_by_check_and_load(folder: Path, capfd: pytest.CaptureFixture[str]) -> None:
    urdf = folder / "unreadable.urdf"
    urdf.write_text(urdf_with(*UNSOUND, *SOUND), encoding="utf-8")
    report = eurdf.check(urdf)
    with pytest.raises(eurdf.InvalidRobot) as caught:
        eurdf.load(urdf)
    assert caught.value.diagnostics == report.diagnostics
    assert {found.code for found in report.diagnostics} == {"urdf-mesh-unreadable"}
    for (name, reason), found in zip(UNSOUND.items(), report.diagnostics, strict=True):
        assert found.message.startswith(f"mesh '{name}' cannot be read: "), found
        assert reason in found.message, found
        assert urdf.read_text(encoding="utf-8")[found.column - 1 :].startswith(name), found
    assert eurdf.load(urdf, geometry=False).model.nv == 0
    assert capfd.readouterr() == ("", "")


def test_mesh_that_crashes_hides_no_other(folder: Path, runs: list[list[str]]) -> None:
    found, reasons = read(*(folder / name for name in ("quad.obj", "self.dae", "text.stl", "rubbish.stl", "shape.off")))
    assert list(found) == ["quad.obj", "text.stl", "shape.off"]
    assert list(reasons) == ["self.dae", "rubbish.stl"]
    assert len(runs) == 2


def test_few_processes_are_spent_on_meshes_that_crash(tmp_path: Path, runs: list[list[str]]) -> None:
    paths = [tmp_path / f"{index}.dae" for index in range(10)]
    for path in paths:
        path.write_bytes(CRASHES["self.dae"])
    _, reasons = read(*paths)
    assert len(runs) == meshes.DEATHS_LIMIT
    assert len(reasons) == 10
    assert "was not read" in reasons["9.dae"]


def test_file_with_several_names_is_read_once(tmp_path: Path, runs: list[list[str]]) -> None:
    (tmp_path / "a.obj").write_bytes(OBJ)
    os.link(tmp_path / "a.obj", tmp_path / "b.obj")
    (tmp_path / "c.obj").symlink_to("a.obj")
    paths = {uri: str(tmp_path / uri) for uri in ("a.obj", "./a.obj", "b.obj", "c.obj")}
    found, reasons = meshes.read_meshes([(uri, scale) for uri in paths for scale in (FULL_SIZE, MIRRORED)], paths)
    assert runs == [["a.obj"]]
    assert not reasons
    assert set(found) == set(paths.values())


def test_bytes_of_all_meshes_are_bounded(tmp_path: Path, runs: list[list[str]]) -> None:
    (tmp_path / "a.obj").write_bytes(OBJ)
    with (tmp_path / "sparse.stl").open("wb") as file:
        file.truncate(BYTES_LIMIT)
    found, reasons = read(tmp_path / "a.obj", tmp_path / "sparse.stl")
    assert list(found) == ["a.obj"]
    assert "1,073,741,824 bytes" in reasons["sparse.stl"]
    assert runs == [["a.obj"]]


def test_triangles_of_all_scales_are_bounded(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(meshes, "TRIANGLES_LIMIT", 8)
    (tmp_path / "a.obj").write_bytes(OBJ)
    paths = {"a.obj": str(tmp_path / "a.obj")}
    few = [("a.obj", (1.0, 1.0, float(scale))) for scale in (1, 2)]
    assert meshes.read_meshes(few * 5, paths)[1] == {}
    _, reasons = meshes.read_meshes([*few, ("a.obj", (1.0, 1.0, 3.0))], paths)
    assert "more than 8 triangles" in reasons["a.obj"]


@pytest.mark.parametrize("scale", [(1.0, 1.0, 1e101), (-1e300, 1.0, 1.0)])
def test_scaled_mesh_must_be_finite(folder: Path, scale: tuple[float, float, float]) -> None:
    _, reasons = meshes.read_meshes([("quad.obj", scale)], {"quad.obj": str(folder / "quad.obj")})
    assert "beyond 1e+100 m" in reasons["quad.obj"]


@pytest.mark.parametrize("make", [os.mkfifo, os.mkdir])
def test_mesh_must_be_a_regular_file(tmp_path: Path, make: Callable[[Path], None], runs: list[list[str]]) -> None:
    make(tmp_path / "a.stl")
    assert read(tmp_path / "a.stl") == ({}, {"a.stl": "it is not a file"})
    assert runs == []


def test_materials_of_a_mesh_are_not_opened(tmp_path: Path) -> None:
    os.mkfifo(tmp_path / "pipe.mtl")
    whole = read_one(tmp_path / "whole.obj", OBJ)
    # In an OBJ file, a line goes on after a backslash, and a backslash in it is ignored.
    for name in (b"mtllib pipe.mtl", b"mtl\\\nlib pipe.mtl", b"m\\tllib pipe.mtl", b"mtl\\ \r\nlib pipe.mtl"):
        mesh = read_one(tmp_path / "a.obj", name + b"\nusemtl red\n" + OBJ)
        assert np.array_equal(mesh.vertices, whole.vertices), name
        assert np.array_equal(mesh.triangles, whole.triangles), name


def read_one(path: Path, content: bytes) -> meshes.Mesh:
    path.write_bytes(content)
    found, reasons = read(path)
    assert not reasons
    return found[path.name]


def test_processor_time_of_a_mesh_is_bounded(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(meshes, "SECONDS", 0)
    monkeypatch.setattr(meshes, "MEMORY", meshes.MOST_MEMORY)  # it is not what ends first
    (tmp_path / "a.ply").write_text(PLY.format(80_000_000), encoding="ascii")
    _, reasons = read(tmp_path / "a.ply")
    assert reasons == {"a.ply": "reading it takes longer than 0 s, and it has 187 bytes"}


def test_file_that_becomes_a_pipe_is_an_error(tmp_path: Path) -> None:
    os.mkfifo(tmp_path / "a.stl")
    path = str(tmp_path / "a.stl")
    assert isinstance(meshes._read([meshes._File(path, path, 84)])[path], str)
