"""`eurdf.load` and `eurdf.check`: which files they take, what they give back, what they refuse."""

from __future__ import annotations

import dataclasses
import shutil
import struct
import subprocess
import sys
from pathlib import Path
from typing import Any
from xml.etree import ElementTree

import numpy as np
import pinocchio as pin
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

import eurdf
from support.described import body
from support.places import DATA, ROBOTS
from support.plain_urdf import Root, inertial, joint_element, link_element, pinocchios_own, robot, trees

WORKBENCH = DATA / "workbench.yaml"


def _write(folder: Path, urdf: str, yaml: str | None = None, name: str = "robot") -> Path:
    folder.mkdir(exist_ok=True)
    (folder / "robot.urdf").write_text(urdf, encoding="utf-8")
    if yaml is not None:
        (folder / f"{name}.yaml").write_text(yaml, encoding="utf-8")
    return folder


# -- a bare URDF ------------------------------------------------------------------------------------------------------


@settings(max_examples=30, deadline=None)
@given(trees(), st.sampled_from(["fixed", "floating"]), st.booleans())
def test_plain_urdf_matches_pinocchio_with_or_without_description(
    tmp_path_factory: pytest.TempPathFactory, urdf: str, root: Root, mimic: bool
) -> None:
    folder = _write(tmp_path_factory.mktemp("robot"), urdf, 'extended_urdf: "2.0"\n')
    expected = pinocchios_own(urdf, root, mimic)
    assert eurdf.load(folder / "robot.urdf", root=root, mimic=mimic).model == expected
    described = eurdf.load(folder, root=root, mimic=mimic).model
    if mimic:
        fold_mimic_joints(expected, urdf)
        # Sums of several numbers, in an order of its own.
        for name in ("damping", "upperDryFrictionLimit", "lowerDryFrictionLimit"):
            np.testing.assert_allclose(getattr(described, name), getattr(expected, name), rtol=1e-14)
            setattr(expected, name, getattr(described, name))
    assert described == expected


def fold_mimic_joints(model: pin.Model, urdf: str) -> None:
    """EU-JNT-032: the damping and friction of a mimic joint count at its leader, unlike in a bare URDF."""
    for joint in ElementTree.fromstring(urdf).iter("joint"):
        mimic, dynamics = joint.find("mimic"), joint.find("dynamics")
        if mimic is None or dynamics is None:
            continue
        v, multiplier = model.joints[model.getJointId(mimic.attrib["joint"])].idx_v, float(mimic.attrib["multiplier"])
        model.damping[v] += multiplier**2 * float(dynamics.attrib["damping"])
        friction = abs(multiplier) * float(dynamics.attrib["friction"])
        model.upperDryFrictionLimit[v] += friction
        model.lowerDryFrictionLimit[v] -= friction


# -- which files ------------------------------------------------------------------------------------------------------

URDF = robot(link_element("base"), body("arm"), joint_element("j", "continuous", "base", "arm", ""))
YAML = 'extended_urdf: "2.0"\nactuators: [j]\n'


def test_folder_gives_its_description(tmp_path: Path) -> None:
    folder = _write(tmp_path / "a", URDF, YAML)
    for path in (folder, str(folder), folder / "robot.yaml", str(folder / "robot.yaml")):
        assert eurdf.load(path).actuation.joints == ("j",)
    assert eurdf.load(_write(tmp_path / "b", URDF, YAML, name="only")).actuation.joints == ("j",)
    assert eurdf.load(_write(tmp_path / "c", URDF)).actuation.joints == ()


@pytest.mark.parametrize("name", ["leg.eurdf.yaml", "leg.eurdf.yml", "LEG.EURDF.YAML"])
def test_eurdf_yaml_is_preferred_among_several(tmp_path: Path, name: str) -> None:
    (tmp_path / "robot.urdf").write_bytes((ROBOTS / "four_bar" / "robot.urdf").read_bytes())
    (tmp_path / name).write_bytes((ROBOTS / "four_bar" / "robot.yaml").read_bytes())
    (tmp_path / "config.yaml").write_text("rate: 100\n", encoding="utf-8")
    assert len(eurdf.load(tmp_path).constraint_models) == 1
    (tmp_path / "arm.eurdf.yaml").write_text("closed_loop: []\n", encoding="utf-8")
    with pytest.raises(eurdf.errors.RobotNotFound, match="name one of them"):
        eurdf.load(tmp_path)


def test_empty_or_ambiguous_folder_is_not_guessed(tmp_path: Path) -> None:
    empty = tmp_path / "empty"
    empty.mkdir()
    several = _write(_write(tmp_path / "several", URDF, YAML, name="one"), URDF, YAML, name="two")
    for folder, said in ((empty, "no URDF"), (several, "one.yaml, two.yaml")):
        for function in (eurdf.load, eurdf.check):
            with pytest.raises(eurdf.errors.RobotNotFound, match=said):
                function(folder)


@pytest.mark.parametrize("path", ["no/such/robot.yaml", "a" * 5000, "a\0b", "four_bar\n"])
def test_unknown_name_is_not_found(path: str, tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.chdir(tmp_path)
    for function in (eurdf.load, eurdf.check):
        with pytest.raises(eurdf.errors.RobotNotFound) as caught:
            function(path)
        assert isinstance(caught.value, FileNotFoundError)
        assert caught.value.path == path


def test_collection_name_loads_from_anywhere(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.chdir(tmp_path)
    names = eurdf.collection_names()
    assert "four_bar" in names
    assert eurdf.load("four_bar").mechanism.nc > 0
    assert eurdf.check("four_bar").ok


def test_folder_precedes_collection_name(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    _write(tmp_path / "four_bar", URDF, YAML)
    monkeypatch.chdir(tmp_path)
    assert eurdf.load("four_bar").actuation.joints == ("j",)


def test_other_urdf_can_be_given(tmp_path: Path) -> None:
    folder = _write(tmp_path, "<robot/>", YAML)
    other = folder / "elsewhere.urdf"
    other.write_text(URDF, encoding="utf-8")
    assert not eurdf.check(folder).ok
    assert eurdf.check(folder, urdf=other).ok
    assert eurdf.load(folder, urdf=str(other)).actuation.joints == ("j",)
    with pytest.raises(eurdf.errors.RobotNotFound, match="is a URDF itself"):
        eurdf.load(other, urdf=other)


@pytest.mark.parametrize("name", ["missing.urdf", "a" * 5000, "no/such/folder/robot.urdf"])
def test_missing_urdf_is_reported_where_named(tmp_path: Path, name: str) -> None:
    folder = _write(tmp_path, URDF, f'extended_urdf: "2.0"\nurdf: {name}\n')
    report = eurdf.check(folder)
    assert [(found.code, found.line, found.column) for found in report.diagnostics] == [("urdf-not-found", 2, 7)]
    with pytest.raises(eurdf.InvalidRobot):
        eurdf.load(folder)


# -- what it gives back -----------------------------------------------------------------------------------------------


def test_robot_unpacks_as_from_published_loader() -> None:
    loaded = eurdf.load(WORKBENCH)
    model, constraint_models, actuation, visual_model, collision_model = loaded
    assert model is loaded.model
    assert [found.name for found in constraint_models] == ["pin"]
    assert actuation.joints == ("motor", "grip", "hand_ball", "stage")
    assert (visual_model.ngeoms, collision_model.ngeoms) == (1, 1)
    assert loaded.data.M.shape == (model.nv, model.nv)
    bare = eurdf.load(WORKBENCH, geometry=False)
    assert (bare.model, bare.visual_model, bare.collision_model) == (model, None, None)


def test_root_is_fixed_or_floating() -> None:
    assert eurdf.load(WORKBENCH, root="floating").model.nv == eurdf.load(WORKBENCH).model.nv + 6
    wrong: Any = "free"
    with pytest.raises(ValueError, match="'fixed' or 'floating'"):
        eurdf.load(WORKBENCH, root=wrong)


# -- what it refuses --------------------------------------------------------------------------------------------------


def test_invalid_robot_carries_all_diagnostics(tmp_path: Path) -> None:
    folder = _write(tmp_path, URDF, YAML + "closures: [{name: c, type: 3d, frames: [base, amr]}]\nurfd: x\n")
    with pytest.raises(eurdf.InvalidRobot) as caught:
        eurdf.load(folder)
    assert [found.message for found in eurdf.check(folder).diagnostics] == [caught.value.diagnostics[0].message]
    assert [found.code for found in caught.value.diagnostics] == ["unknown-key"]
    assert caught.value.path == str(folder)
    assert "did you mean 'urdf'?" in str(caught.value)
    assert isinstance(caught.value, ValueError)
    assert isinstance(caught.value, eurdf.EurdfError)


LOOSE = robot(
    link_element("base", inertial()),
    body("arm"),
    link_element("tip"),
    joint_element("j", "revolute", "base", "arm", '<limit lower="-1" upper="1" effort="1" velocity="1"/>'),
    joint_element("k", "continuous", "arm", "tip", ""),
)


def test_massless_leaf_is_diagnosed_and_refused_if_strict(tmp_path: Path) -> None:
    folder = _write(tmp_path, LOOSE, 'extended_urdf: "2.0"\nactuators: [j]\n')
    loaded = eurdf.load(folder)
    assert [found.code for found in loaded.diagnostics] == ["leaf-without-inertia"]
    assert loaded.model.nv == 2
    with pytest.raises(eurdf.InvalidRobot) as caught:
        eurdf.load(folder, strict=True)
    assert [found.code for found in caught.value.diagnostics] == ["leaf-without-inertia"]


def test_diagnostics_are_of_files_as_loaded(tmp_path: Path) -> None:
    folder = _write(tmp_path, LOOSE, APART + "configurations: {assembled: {}}\n")
    loaded = eurdf.load(folder)
    expected = [(found.code, found.line) for found in eurdf.check(folder).diagnostics if found.clause]
    for name in ("robot.urdf", "robot.yaml"):
        (folder / name).write_text("", encoding="utf-8")
    assert [(found.code, found.line) for found in loaded.diagnostics] == expected
    assert {"leaf-without-inertia", "assembled-open"} == {code for code, _ in expected}


def test_warnings_are_not_refused_if_strict(tmp_path: Path) -> None:
    folder = _write(tmp_path, URDF.replace("</robot>", "<loop/></robot>"), YAML)
    loaded = eurdf.load(folder, strict=True)
    assert [found.code for found in loaded.diagnostics] == ["urdf-closure-ignored"]


APART = 'extended_urdf: "2.0"\nclosures: [{name: c, type: 3d, frames: [{link: base, xyz: [0, 0, 9]}, arm]}]\n'


def test_loops_are_checked_on_request_and_if_strict(tmp_path: Path) -> None:
    folder = _write(tmp_path, URDF, APART)
    loaded = eurdf.load(folder, check_loops=True)
    assert len(loaded.constraint_models) == 1
    assert [found.code for found in loaded.diagnostics] == ["closure-cannot-close"]
    assert [found.code for found in eurdf.check(folder).diagnostics] == ["closure-cannot-close"]
    with pytest.raises(eurdf.InvalidRobot, match="'c' by"):
        eurdf.load(folder, strict=True)


def test_loading_starts_no_solver(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    def refuse(*given: Any, **named: Any) -> None:
        raise AssertionError("a solver was started")

    monkeypatch.setattr("eurdf.kinematics.assembly.assemble", refuse)
    folder = _write(tmp_path, URDF, APART)
    loaded = eurdf.load(folder)
    for name in dir(loaded):
        getattr(loaded, name)
    assert loaded.diagnostics == ()
    with pytest.raises(AssertionError, match="solver"):
        eurdf.load(folder, check_loops=True)


def test_robot_is_immutable(tmp_path: Path) -> None:
    loaded = eurdf.load(_write(tmp_path, URDF, APART))
    for field in dataclasses.fields(loaded):
        with pytest.raises(dataclasses.FrozenInstanceError):
            setattr(loaded, field.name, None)
    for name in ("data", "visual_model", "collision_model"):
        with pytest.raises(AttributeError):
            setattr(loaded, name, None)


def test_open_assembled_configuration_is_found_immediately(tmp_path: Path) -> None:
    yaml = APART.replace("[0, 0, 9]", "[0, 0, 2.0e-6]") + "configurations: {assembled: {}}\n"
    loaded = eurdf.load(_write(tmp_path, URDF, yaml))
    assert [found.code for found in loaded.diagnostics] == ["assembled-open"]
    closed = yaml.replace("2.0e-6", "0.9e-6")
    assert eurdf.load(_write(tmp_path, URDF, closed)).diagnostics == ()


# -- meshes -----------------------------------------------------------------------------------------------------------


def _stl(path: Path) -> None:
    """One triangle, as binary STL."""
    path.parent.mkdir(parents=True, exist_ok=True)
    triangle = struct.pack("<12fH", 0, 0, 1, 0, 0, 0, 1, 0, 0, 0, 1, 0, 0)
    path.write_bytes(bytes(80) + struct.pack("<I", 1) + triangle)


MESHED = robot(
    link_element("base"),
    body("arm", '<visual><geometry><mesh filename="package://parts/arm.stl" scale="2 2 2"/></geometry></visual>'),
    joint_element("j", "continuous", "base", "arm", ""),
)


def test_meshes_are_found_in_folders_and_environment(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.delenv("ROS_PACKAGE_PATH", raising=False)
    folder = _write(tmp_path / "robot", MESHED, YAML)
    _stl(tmp_path / "packages" / "parts" / "arm.stl")
    found = eurdf.load(folder, package_dirs=[tmp_path / "packages"])
    assert found.visual_model.geometryObjects[0].meshPath == str(tmp_path / "packages" / "parts" / "arm.stl")
    np.testing.assert_array_equal(found.visual_model.geometryObjects[0].meshScale, [2, 2, 2])
    assert eurdf.check(folder, package_dirs=[tmp_path / "packages"]).diagnostics == ()
    assert eurdf.check(folder, package_dirs=str(tmp_path / "packages")).diagnostics == ()
    monkeypatch.setenv("ROS_PACKAGE_PATH", str(tmp_path / "packages"))
    assert eurdf.load(folder).visual_model.ngeoms == 1
    assert eurdf.check(folder).diagnostics == ()
    monkeypatch.delenv("ROS_PACKAGE_PATH")
    _stl(tmp_path / "install" / "share" / "parts" / "arm.stl")
    monkeypatch.setenv("AMENT_PREFIX_PATH", str(tmp_path / "install"))
    assert eurdf.check(folder).diagnostics == ()


def test_check_and_load_agree_on_missing_mesh(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.delenv("ROS_PACKAGE_PATH", raising=False)
    folder = _write(tmp_path / "robot", MESHED, YAML)
    loaded = eurdf.load(folder)
    assert loaded.diagnostics == eurdf.check(folder).diagnostics
    (found,) = loaded.diagnostics
    assert (found.code, found.severity) == ("urdf-mesh-missing", "warning")
    assert all(word in str(found.hint) for word in ("package_dirs", "ROS_PACKAGE_PATH", "AMENT_PREFIX_PATH"))
    assert loaded.model.nv == 1
    assert eurdf.load(folder, geometry=False).diagnostics == ()


def test_missing_mesh_is_refused_only_on_use(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.delenv("ROS_PACKAGE_PATH", raising=False)
    loaded = eurdf.load(_write(tmp_path / "robot", MESHED, YAML))
    for ask in (
        lambda: loaded.visual_model,
        lambda: loaded.collision_model,
        lambda: [*loaded],
        lambda: eurdf.lock(loaded, ["j"]).visual_model,
    ):
        with pytest.raises(eurdf.InvalidRobot, match="geometry=False") as caught:
            ask()
        assert [found.code for found in caught.value.diagnostics] == ["urdf-mesh-missing"]


def test_mesh_moves_with_body_of_replaced_joint(tmp_path: Path) -> None:
    folder = _write(tmp_path / "robot", MESHED, YAML + "joints: {j: spherical}\n")
    _stl(folder / "parts" / "arm.stl")
    loaded = eurdf.load(folder)
    data = loaded.visual_model.createData()
    q = np.array([0.0, 0.6, 0.0, 0.8])
    pin.updateGeometryPlacements(loaded.model, loaded.data, loaded.visual_model, data, q)
    np.testing.assert_allclose(data.oMg[0].rotation, pin.Quaternion(q).matrix(), atol=1e-12)


# -- without a simulator ----------------------------------------------------------------------------------------------


def _modules_after(code: str) -> set[str]:
    program = f"import eurdf\n{code}\nimport sys\nprint(*sys.modules)"
    done = subprocess.run([sys.executable, "-c", program], capture_output=True, text=True, check=True)
    return {name.split(".")[0] for name in done.stdout.split()}


def test_checking_a_tree_loads_no_simulator(tmp_path: Path) -> None:
    folder = _write(tmp_path, URDF, YAML)
    found = _modules_after(f"assert eurdf.check({str(folder)!r}).ok")
    assert "eurdf" in found
    assert not found & {"pinocchio", "coal", "scipy"}


def test_checking_invalid_description_loads_no_simulator(tmp_path: Path) -> None:
    shutil.copytree(DATA, tmp_path / "data")
    yaml = tmp_path / "data" / "workbench.yaml"
    yaml.write_text(yaml.read_text(encoding="utf-8").replace("rocker_top]", "missing]"), encoding="utf-8")
    found = _modules_after(f"assert not eurdf.check({str(yaml)!r}).ok")
    assert not found & {"pinocchio", "coal", "scipy"}


@pytest.mark.parametrize("name", ["missing.urdf", "a" * 5000])
def test_unreadable_given_urdf_is_reported(tmp_path: Path, name: str) -> None:
    report = eurdf.check(_write(tmp_path, URDF, YAML), urdf=name)
    assert [found.code for found in report.diagnostics] == ["file-unreadable"]


def test_invalid_robot_text_has_errors_first(tmp_path: Path) -> None:
    stuck = joint_element("j", "revolute", "base", "arm", '<limit effort="1" velocity="1"/>')
    urdf = robot(link_element("base"), body("arm"), stuck)
    folder = _write(tmp_path, urdf, YAML + "closures: [{name: c, type: 3d, frames: [base, amr]}]\n")
    with pytest.raises(eurdf.InvalidRobot) as caught:
        eurdf.load(folder)
    assert [found.severity for found in caught.value.diagnostics] == ["warning", "error"]
    first, second = str(caught.value).splitlines()[1:]
    assert "error: " in first
    assert "warning: " in second
