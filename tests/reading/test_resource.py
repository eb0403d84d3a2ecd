"""Where a mesh lies that a URDF names."""

from __future__ import annotations

import os
from pathlib import Path
from typing import Any

import pytest

from eurdf.reading.resource import FileFinder


@pytest.fixture(autouse=True)
def _no_packages(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.delenv("ROS_PACKAGE_PATH", raising=False)
    monkeypatch.delenv("AMENT_PREFIX_PATH", raising=False)


def _file(path: Path) -> Path:
    path.parent.mkdir(parents=True, exist_ok=True)
    path.write_text("", encoding="utf-8")
    return path


def _found(uri: str, folder: Path, package_dirs: tuple[Path, ...] = ()) -> Path | None:
    found = FileFinder(folder, package_dirs).find(uri)
    return None if found is None else Path(found).resolve()


def test_path_is_absolute_or_relative_to_urdf(tmp_path: Path) -> None:
    mesh = _file(tmp_path / "meshes" / "a.stl")
    folder = tmp_path / "urdf"
    folder.mkdir()
    assert _found("../meshes/a.stl", folder) == mesh
    assert _found("meshes/a.stl", tmp_path) == mesh
    assert _found(str(mesh), folder) == mesh
    assert _found("meshes/a.stl", folder) is None


def test_escapes_in_file_uri_are_decoded(tmp_path: Path) -> None:
    mesh = _file(tmp_path / "my mesh.stl")
    assert _found(f"file://{tmp_path}/my%20mesh.stl", Path("/")) == mesh
    assert _found("file://my%20mesh.stl", tmp_path) == mesh


@pytest.mark.parametrize("scheme", ["package", "model"])
def test_package_is_searched_from_urdf_up_to_manifest(tmp_path: Path, scheme: str) -> None:
    mesh = _file(tmp_path / "arm_description" / "meshes" / "a.stl")
    urdf = tmp_path / "arm_description" / "urdf"
    urdf.mkdir()
    uri = f"{scheme}://arm_description/meshes/a.stl"
    assert _found(uri, urdf) is None
    assert [_found(uri, folder) for folder in (urdf.parent, tmp_path)] == [mesh, mesh]
    (urdf.parent / "package.xml").write_text("<package><name> arm </name></package>", encoding="utf-8")
    for name in ("arm_description", "arm", ""):
        assert _found(f"{scheme}://{name}/meshes/a.stl", urdf) == mesh
    for name in ("other_description", "..", "."):
        assert _found(f"{scheme}://{name}/meshes/a.stl", urdf) is None


def test_files_may_be_in_package_of_urdf_or_given_ones(tmp_path: Path) -> None:
    inside = _file(tmp_path / "arm" / "meshes" / "a.stl")
    outside = _file(tmp_path / "other" / "a.stl")
    urdf = tmp_path / "arm" / "urdf"
    urdf.mkdir()
    (urdf / "linked.stl").symlink_to(outside)
    assert not FileFinder(urdf).folders.contains(inside)
    (tmp_path / "arm" / "package.xml").touch()
    folders = FileFinder(urdf).folders
    assert folders.contains(inside)
    assert [folders.contains(path) for path in (outside, urdf / "linked.stl", urdf / "../../other/a.stl")] == [
        False
    ] * 3
    assert FileFinder(urdf, [outside.parent]).folders.contains(urdf / "linked.stl")


def test_installed_package_may_be_links_to_its_source(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    mesh = _file(tmp_path / "src" / "arm" / "a.stl")
    _file(tmp_path / "src" / "arm" / "package.xml")
    installed = tmp_path / "install" / "share" / "arm"
    installed.mkdir(parents=True)
    for name in ("a.stl", "package.xml"):
        (installed / name).symlink_to(tmp_path / "src" / "arm" / name)
    monkeypatch.setenv("AMENT_PREFIX_PATH", str(tmp_path / "install"))
    finder = FileFinder(installed.parent.parent)
    found = finder.find("package://arm/a.stl")
    assert found is not None
    assert Path(found).resolve() == mesh
    assert finder.folders.contains(found)


@pytest.mark.parametrize("name", ["a#1.stl", "a?b.stl", "a b.stl", "é.stl", "[x].stl", "100%.stl"])
def test_name_is_used_literally(tmp_path: Path, name: str) -> None:
    mesh = _file(tmp_path / "arm" / name)
    assert _found(name, tmp_path / "arm") == mesh
    assert _found(f"package://arm/{name}", tmp_path) == mesh


def test_search_order_is_option_environment_urdf(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    uri = "package://arm/a.stl"
    beside = _file(tmp_path / "here" / "arm" / "a.stl")
    folder = tmp_path / "here"
    assert _found(uri, folder) == beside
    ament = _file(tmp_path / "ament" / "share" / "arm" / "a.stl")
    monkeypatch.setenv("AMENT_PREFIX_PATH", str(tmp_path / "ament"))
    assert _found(uri, folder) == ament
    second = _file(tmp_path / "second" / "arm" / "a.stl")
    monkeypatch.setenv("ROS_PACKAGE_PATH", f"{tmp_path / 'first'}:{tmp_path / 'second'}:")
    assert _found(uri, folder) == second
    first = _file(tmp_path / "first" / "arm" / "a.stl")
    assert _found(uri, folder) == first
    given = _file(tmp_path / "given" / "arm" / "a.stl")
    assert _found(uri, folder, (tmp_path / "none", tmp_path / "given")) == given


def test_given_folder_can_be_the_package(tmp_path: Path) -> None:
    mesh = _file(tmp_path / "ws" / "arm" / "a.stl")
    elsewhere = tmp_path / "elsewhere"
    elsewhere.mkdir()
    assert _found("package://arm/a.stl", elsewhere, (tmp_path / "ws" / "arm",)) == mesh


@pytest.mark.parametrize(
    "uri",
    [
        "",
        ".",
        "http://example.org/a.stl",
        "https://[::1/a.stl",
        "package://",
        "package://arm",
        "package:///a.stl",
        "package://[arm/a.stl",
        "file://",
        "://",
        "a" * 5000,
        "package://arm/" + "b/" * 3000,
        "a\0b.stl",
        "file://a%00b.stl",
        "file://%ff",
    ],
)
def test_non_file_is_not_found(tmp_path: Path, uri: str) -> None:
    assert FileFinder(tmp_path).find(uri) is None


def test_folder_is_not_a_mesh(tmp_path: Path) -> None:
    (tmp_path / "arm" / "meshes").mkdir(parents=True)
    assert FileFinder(tmp_path).find("arm") is None
    assert FileFinder(tmp_path).find("package://arm/meshes") is None


def test_package_that_is_not_there_is_looked_for_once(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    looked: list[object] = []
    stat = os.stat

    def counted(path: str, **options: Any) -> os.stat_result:
        looked.append(path)
        return stat(path, **options)

    finder = FileFinder(tmp_path)
    monkeypatch.setattr(os, "stat", counted)
    assert [finder.find(f"package://lost/{index}.stl") for index in range(1_000)] == [None] * 1_000
    assert len(looked) <= 2 * len(tmp_path.parts)
