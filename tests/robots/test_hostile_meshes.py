"""Nothing outside a robot's folder gets into what is read, shown or written, however its meshes name it."""

from __future__ import annotations

import tempfile
from contextlib import nullcontext
from importlib.util import find_spec
from pathlib import Path

import numpy as np
import pytest
from hypothesis import HealthCheck, given, settings
from hypothesis import strategies as st

import eurdf
from eurdf.commands.main import main
from eurdf.convert.formats import EXPORTS
from support.hostile_meshes import CARRIERS, ENDLESS, FORMS, SECRETS, Place
from support.processes import watchdog

#: References in a robot: one process reads all of its meshes.
AT_ONCE = 20

MARKERS = st.text("abcdefghijklmnopqrstuvwxyz", min_size=12, max_size=12).map(str.encode)
REFERENCES = st.tuples(st.sampled_from(SECRETS), st.sampled_from(FORMS), st.sampled_from(CARRIERS))
ROBOTS = st.lists(REFERENCES, min_size=AT_ONCE, max_size=AT_ONCE, unique=True)
PRESENT = [name for name in EXPORTS if name != "usd" or find_spec("pxr") is not None]


@pytest.fixture(autouse=True)
def _no_packages(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.delenv("ROS_PACKAGE_PATH", raising=False)
    monkeypatch.delenv("AMENT_PREFIX_PATH", raising=False)


@pytest.mark.slow
@settings(max_examples=10, suppress_health_check=list(HealthCheck))
@given(marker=MARKERS, references=ROBOTS, device=st.sampled_from(ENDLESS))
def test_no_reference_leaks_a_secret(
    marker: bytes, references: list[tuple[str, str, str]], device: str, capfd: pytest.CaptureFixture[str]
) -> None:
    with tempfile.TemporaryDirectory() as folder, watchdog():
        place = Place(Path(folder), marker)
        uris = [place.uri(*reference) for reference in references]
        uris += [place.endless(device), "pipe.stl", "package://../../../dev/zero"]
        _check_all(place, uris, capfd)


def test_each_way_to_name_a_secret_is_closed(tmp_path: Path, capfd: pytest.CaptureFixture[str]) -> None:
    place = Place(tmp_path, b"squeamishoss")
    ways = [(secret, form, "direct") for secret in ("secret.stl", "secret") for form in FORMS]
    ways += [("secret.bin", form, "gltf") for form in FORMS] + [("secret.mtl", form, "obj cut") for form in FORMS]
    ways += [("secret.png", "parent", carrier) for carrier in CARRIERS]
    _check_all(place, [*(place.uri(*way) for way in ways), *map(place.endless, ENDLESS), "pipe.stl"], capfd)


def _check_all(place: Place, uris: list[str], capfd: pytest.CaptureFixture[str]) -> None:
    """Check, load, export and import robots with these meshes, and look for the secret in all that comes out."""
    urdf = place.robot / "robot.urdf"
    urdf.write_text(place.urdf(uris), encoding="utf-8")
    files: dict[str, bytes] = {}
    capfd.readouterr()
    main(["check", str(urdf)])
    report = eurdf.check(urdf)
    assert {found.code for found in report.diagnostics} <= {
        "urdf-mesh-missing",
        "urdf-mesh-unreadable",
        "x-file-outside-folder",
    }
    unreadable = {found.message.split("'")[1] for found in report.diagnostics if found.code == "urdf-mesh-unreadable"}
    files |= _loaded(place, [uri for uri in uris if uri not in unreadable])
    urdf.write_text(place.urdf(uris), encoding="utf-8")
    for name in PRESENT:
        for mesh_files in ("copy", "reference"):
            export = eurdf.export(urdf, name, mesh_files=mesh_files)
            files |= {f"{name}/{mesh_files}/{path}": content for path, content in export.files.items()}
    (place.robot / "robot.sdf").write_text(place.sdf(uris), encoding="utf-8")
    (place.robot / "robot.xml").write_text(place.mjcf(uris), encoding="utf-8")
    for file, format_ in (
        ("robot.urdf", "loop-joint"),
        ("robot.urdf", "drake"),
        ("robot.urdf", "urdf-plus"),
        ("robot.sdf", "sdf"),
        ("robot.xml", "mjcf"),
    ):
        files |= _imported(place.robot / file, format_)
    for number, text in enumerate(each for uri in uris[::5] for each in place.opened_at_once(uri)):
        file = place.robot / f"opened{number}.xml"
        file.write_text(text, encoding="utf-8")
        files |= _imported(file, "mjcf")
    files |= {"stdout and stderr": "".join(capfd.readouterr()).encode()}
    assert place.leaks(files) == []


def _loaded(place: Place, uris: list[str]) -> dict[str, bytes]:
    """The vertices of the meshes that are files of the robot, as text; with any other, there is no geometry."""
    urdf = place.robot / "robot.urdf"
    real = place.robot.resolve()
    own = [uri for uri in uris if (place.robot / uri).resolve().is_relative_to(real) and (place.robot / uri).is_file()]
    others = [uri for uri in uris if uri not in own]
    urdf.write_text(place.urdf(others), encoding="utf-8")
    robot = eurdf.load(urdf)
    with pytest.raises(eurdf.InvalidRobot) if others else nullcontext():
        assert robot.visual_model.ngeoms == 0
    urdf.write_text(place.urdf(own), encoding="utf-8")
    shapes = [shape for model in eurdf.load(urdf).geometry for shape in model.geometryObjects]
    assert len(shapes) == len(own)
    vertices = np.concatenate([np.empty((0, 3)), *(np.array(shape.geometry.vertices()) for shape in shapes)])
    return {"loaded.obj": b"".join(b"v %r %r %r\n" % tuple(vertex) for vertex in vertices.tolist())}


def _imported(file: Path, format_: str) -> dict[str, bytes]:
    try:
        found = eurdf.import_robot(file, format=format_)
    except eurdf.errors.CannotImport as reason:
        return {f"{file.name}: refused": str(reason).encode()}
    return {f"{format_}/{path}": content for path, content in found.files.items()}
