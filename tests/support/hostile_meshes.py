"""Robots that name files outside their folder in every way that mesh files can, and what shows that one was read."""

from __future__ import annotations

import base64
import json
import os
import re
import struct
from collections.abc import Iterable, Iterator, Mapping
from pathlib import Path
from urllib.parse import quote
from xml.sax.saxutils import quoteattr

import numpy as np
import numpy.typing as npt

#: Names of the secret files; each has the marker in it, as text or as the coordinates of vertices.
SECRETS = ("secret.stl", "secret.obj", "secret.dae", "secret.bin", "secret.mtl", "secret.png", "secret", "secret.xml")

#: How a mesh of the robot's folder names another file; the direct one is the URDF itself.
CARRIERS = ("direct", "gltf", "glb", "gltf image", "gltf twice", "obj", "obj cut", "mtl", "dae", "ply", "3ds")

#: How a secret file is named.
FORMS = (
    "absolute",
    "parent",
    "roundabout",
    "file",
    "file percent",
    "percent",
    "package parent",
    "package robot",
    "package beside",
    "package no name",
    "package root",
    "model",
    "link",
    "link of link",
    "link of folder",
    "data",
)

#: Files that have no end, or would make a reader wait.
ENDLESS = ("/dev/zero", "/dev/stdin", "/dev/random", "/proc/self/environ", "/proc/self/mem")


class Place:
    """A robot's folder beside a folder with secrets.

    Attributes:
        robot: The robot's folder, named ``robot``.
        marker: Twelve letters, which are in each secret file.
    """

    def __init__(self, folder: Path, marker: bytes) -> None:
        self.robot, self._secrets, self.marker = folder / "robot", folder / "secrets", marker
        for each in (self.robot / "sub", self._secrets):
            each.mkdir(parents=True)
        for name in SECRETS:
            (self._secrets / name).write_bytes(_secret(Path(name).suffix, marker))
        os.mkfifo(self.robot / "pipe.mtl")
        os.mkfifo(self.robot / "pipe.stl")
        (self.robot / "LICENSE").symlink_to(self._secrets / "secret")
        self._count = 0

    def uri(self, secret: str, form: str, carrier: str) -> str:
        """What the URDF names, so that a careless reader opens a secret; makes the files that it takes."""
        name = self._named(secret, form)
        if carrier == "direct":
            return name
        self._count += 1
        file = self.robot / f"carrier{self._count}{_ENDINGS[carrier]}"
        for path, content in _carried(carrier, name, file).items():
            path.write_bytes(content)
        return file.name

    def endless(self, device: str) -> str:
        """The name of a mesh that is a link to a device."""
        self._count += 1
        link = self.robot / f"endless{self._count}.stl"
        link.symlink_to(device)
        return link.name

    def _named(self, secret: str, form: str) -> str:
        path, relative = self._secrets / secret, f"secrets/{secret}"
        named = {
            "absolute": str(path),
            "parent": f"../{relative}",
            "roundabout": f"sub/../../{relative}",
            "file": f"file://{path}",
            "file percent": f"file://{quote(str(self.robot))}/%2e%2e/{relative}",
            "percent": f"%2e%2e/{relative}",
            "package parent": f"package://../{relative}",
            "package robot": f"package://robot/../{relative}",
            "package beside": f"package://{relative}",
            "package no name": f"package:///../{relative}",
            "package root": f"package://{path}",
            "model": f"model://robot/../{relative}",
            "data": f"data:/../../{path}",
        }
        if form in named:
            return named[form]
        self._count += 1
        if form == "link of folder":
            (self.robot / f"folder{self._count}").symlink_to(self._secrets)
            return f"folder{self._count}/{secret}"
        link = self.robot / f"link{self._count}{path.suffix or '.stl'}"
        link.symlink_to(path)
        if form == "link of link":
            second = self.robot / "sub" / link.name
            second.symlink_to(link)
            return f"sub/{link.name}"
        return link.name

    def urdf(self, uris: Iterable[str]) -> str:
        """A URDF with a mesh for each URI, alternately visual and collision, and a loop of another dialect."""
        shapes = "".join(
            f"<{use}><geometry><mesh filename={quoteattr(uri)}/></geometry></{use}>"
            for use, uri in zip(_alternately("visual", "collision"), uris, strict=False)
        )
        links = f'<link name="a">{_INERTIAL}{shapes}</link><link name="b">{_INERTIAL}</link>'
        joint = '<joint name="j" type="continuous"><parent link="a"/><child link="b"/></joint>'
        return f'<robot name="r">{links}{joint}</robot>'

    def sdf(self, uris: Iterable[str]) -> str:
        """The same for Gazebo."""
        shapes = "".join(
            f'<visual name="v{number}"><geometry><mesh><uri>{quoteattr(uri)[1:-1]}</uri></mesh></geometry></visual>'
            for number, uri in enumerate(uris)
        )
        return f'<sdf version="1.9"><model name="r"><link name="a">{shapes}</link></model></sdf>'

    def mjcf(self, uris: Iterable[str]) -> str:
        """The same for MuJoCo: as meshes, and as other assets."""
        meshes, geoms = [], []
        for number, uri in enumerate(uris):
            file = quoteattr(uri)
            meshes.append(f'<mesh name="m{number}" file={file}/>')
            meshes.append(f'<texture name="t{number}" type="2d" file={file}/>')
            meshes.append(f'<hfield name="h{number}" file={file} size="1 1 1 1"/>')
            geoms.append(f'<geom type="mesh" mesh="m{number}"/>')
        body = f'<body><inertial pos="0 0 0" mass="1" diaginertia="1 1 1"/><joint/>{"".join(geoms)}</body>'
        return f"<mujoco><asset>{''.join(meshes)}</asset><worldbody>{body}</worldbody></mujoco>"

    def opened_at_once(self, uri: str) -> Iterator[str]:
        """MJCF files of which MuJoCo opens another one while it reads them."""
        file = quoteattr(uri)
        yield f"<mujoco><include file={file}/></mujoco>"
        yield f'<mujoco><asset><model name="m" file={file}/></asset></mujoco>'
        flexible = f'<flexcomp name="f" type="mesh" dim="2" file={file}/>'
        yield f'<mujoco><worldbody><body name="b">{flexible}</body></worldbody></mujoco>'
        up = f'<compiler meshdir="sub/.."/><worldbody><body name="b">{flexible}</body></worldbody>'
        yield f"<mujoco>{up}</mujoco>"

    def leaks(self, files: Mapping[str, bytes]) -> list[str]:
        """The files that have something of a secret in them, as bytes or as numbers."""
        return [
            name for name, content in files.items() if self.marker in content or self.is_in(_numbers(name, content))
        ]

    def is_in(self, numbers: npt.NDArray[np.float64]) -> bool:
        """Whether a coordinate is one that the marker makes, up to the precision of its format."""
        words = np.array(_words(self.marker))
        return bool(np.isclose(numbers.reshape(-1, 1), words, rtol=1e-6, atol=0.0).any())


_INERTIAL = (
    '<inertial><mass value="1"/><inertia ixx="1" iyy="1" izz="1" ixy="0" ixz="0" iyz="0"/></inertial>'  # a cube's
)
_ENDINGS = {
    "gltf": ".gltf",
    "glb": ".glb",
    "gltf image": ".gltf",
    "gltf twice": ".gltf",
    "obj": ".obj",
    "obj cut": ".obj",
    "mtl": ".obj",
    "dae": ".dae",
    "ply": ".ply",
    "3ds": ".3ds",
}
_FACES = b"v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n"


def _alternately(*values: str) -> Iterator[str]:
    while True:
        yield from values


def _words(marker: bytes) -> tuple[float, ...]:
    """The marker as the coordinates of a vertex."""
    return struct.unpack("<3f", marker)


def _secret(suffix: str, marker: bytes) -> bytes:
    x, y, z = _words(marker)
    triangle = f"{x!r} {y!r} {z!r} 1 0 0 0 1 0"
    if suffix == ".stl":
        rows = struct.pack("<12fH", 0, 0, 1, x, y, z, 1, 0, 0, 0, 1, 0, 0)
        return marker.ljust(80) + struct.pack("<I", 4) + rows * 4
    if suffix == ".obj":
        return f"# {marker.decode()}\nv {x!r} {y!r} {z!r}\n".encode() + _FACES.replace(b"f 1 2 3", b"f 1 2 3\nf 2 3 4")
    if suffix == ".dae":
        return collada(triangle, f"<extra>{marker.decode()}</extra>")
    if suffix == ".mtl":
        return b"newmtl red\nKd 1 0 0\n# " + marker
    if suffix == ".xml":
        return f'<mujoco><worldbody><body name="{marker.decode()}"/></worldbody></mujoco>'.encode()
    return marker + struct.pack("<6f", 1, 0, 0, 0, 1, 0)


def collada(numbers: str, extra: str) -> bytes:
    """A COLLADA file with one triangle, and another element before it."""
    return f"""<?xml version="1.0"?>
<COLLADA xmlns="http://www.collada.org/2005/11/COLLADASchema" version="1.4.1">{extra}
<library_geometries><geometry id="g"><mesh>
<source id="s"><float_array id="a" count="9">{numbers}</float_array><technique_common>
<accessor source="#a" count="3" stride="3"><param name="X" type="float"/><param name="Y" type="float"/>
<param name="Z" type="float"/></accessor></technique_common></source>
<vertices id="v"><input semantic="POSITION" source="#s"/></vertices>
<triangles count="1"><input semantic="VERTEX" source="#v" offset="0"/><p>0 1 2</p></triangles>
</mesh></geometry></library_geometries>
<library_visual_scenes><visual_scene id="scene"><node><instance_geometry url="#g"/></node></visual_scene>
</library_visual_scenes><scene><instance_visual_scene url="#scene"/></scene></COLLADA>""".encode()


def _carried(carrier: str, name: str, file: Path) -> dict[Path, bytes]:
    """The content of a mesh that names another file, and of its materials."""
    if carrier.startswith("gl"):
        inside = "data:application/octet-stream;base64," + base64.b64encode(struct.pack("<9f", *range(9))).decode()
        uri, image = (inside, name) if carrier == "gltf image" else (name, inside)
        text = json.dumps(gltf(uri, image))
        if carrier == "gltf twice":  # readers differ in which of two values of a key counts
            text = text.replace(f'"uri": {json.dumps(name)}', f'"uri": {json.dumps(name)}, "uri": {json.dumps(inside)}')
        if carrier != "glb":
            return {file: text.encode()}
        text += " " * (-len(text) % 4)
        chunk = struct.pack("<I4s", len(text), b"JSON") + text.encode()
        return {file: struct.pack("<4sII", b"glTF", 2, 12 + len(chunk)) + chunk}
    data = name.encode()
    if carrier == "mtl":
        materials = file.with_suffix(".mtl")
        return {file: f"mtllib {materials.name}\n".encode() + _FACES, materials: b"newmtl a\nmap_Kd " + data + b"\n"}
    if carrier == "ply":
        head = b"ply\nformat ascii 1.0\ncomment TextureFile " + data + b"\nelement vertex 3\nproperty float x\n"
        head += b"property float y\nproperty float z\nelement face 1\nproperty list uchar int vertex_indices\n"
        return {file: head + b"end_header\n0 0 0\n1 0 0\n0 1 0\n3 0 1 2\n"}
    if carrier == "dae":
        image = f'<library_images><image id="i"><init_from>{quoteattr(name)[1:-1]}</init_from></image></library_images>'
        return {file: collada("0 0 0 1 0 0 0 1 0", image)}
    if carrier == "3ds":
        return {file: b"MM" + b"\x00\xa3" + struct.pack("<I", 7 + len(data)) + data + b"\0"}
    return {file: (b"mtllib " if carrier == "obj" else b"mt\\\nl\\lib ") + data + b"\n" + _FACES}


def gltf(uri: str, image: str) -> dict[str, object]:
    """A glTF file with one triangle: the addresses of its buffer and of a picture."""
    return {
        "asset": {"version": "2.0"},
        "buffers": [{"uri": uri, "byteLength": 36}],
        "images": [{"uri": image}],
        "textures": [{"source": 0}],
        "materials": [{"pbrMetallicRoughness": {"baseColorTexture": {"index": 0}}}],
        "bufferViews": [{"buffer": 0, "byteOffset": 0, "byteLength": 36}],
        "accessors": [{"bufferView": 0, "componentType": 5126, "count": 3, "type": "VEC3"}],
        "meshes": [{"primitives": [{"attributes": {"POSITION": 0}, "mode": 4, "material": 0}]}],
        "nodes": [{"mesh": 0}],
        "scenes": [{"nodes": [0]}],
        "scene": 0,
    }


def _numbers(name: str, content: bytes) -> npt.NDArray[np.float64]:
    """The coordinates of vertices in a file that was written."""
    if name.endswith(".usdc"):
        return _numbers_in_usd(content)
    if name.endswith(".obj"):
        found = re.findall(rb"^v (.*)$", content, re.MULTILINE)
        return np.array([float(word) for line in found for word in line.split()])
    return np.empty(0)


def _numbers_in_usd(content: bytes) -> npt.NDArray[np.float64]:
    import tempfile

    from pxr import Usd, UsdGeom

    with tempfile.NamedTemporaryFile(suffix=".usdc") as file:
        file.write(content)
        file.flush()
        stage = Usd.Stage.Open(file.name)
        points = [UsdGeom.Mesh(each).GetPointsAttr().Get() for each in stage.Traverse() if each.IsA(UsdGeom.Mesh)]
        return np.concatenate([np.empty(0), *(np.array(each, np.float64).reshape(-1) for each in points)])
