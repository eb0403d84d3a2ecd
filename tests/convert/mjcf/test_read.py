"""MJCF that is imported: the same robot as in MuJoCo, with every loss listed."""

from __future__ import annotations

import os
from pathlib import Path
from typing import Any

import mujoco
import numpy as np
import pytest

import eurdf
from eurdf.closures.distance import DistanceClosure
from eurdf.closures.point import PointClosure
from eurdf.mechanism.constraint import Coupling
from eurdf.mechanism.joint_types import JointType
from eurdf.mechanism.mechanism import ROOT_JOINT, Motor
from eurdf.pinocchio.robot import build_robot
from support.imported import Beside, model_without_meshes
from support.stl import TETRAHEDRON

VERTICES = "0 0 0 0.1 0 0 0 0.1 0 0 0 0.1"


FEATURES = """\
<mujoco model="features">
  <compiler angle="degree" eulerseq="XYZ" meshdir="files"/>
  <default>
    <joint damping="0.3" armature="0.02"/>
    <default class="stiff"><joint stiffness="7" springref="10" frictionloss="0.1" axis="1 2 2"/></default>
    <default class="seen"><geom contype="0" conaffinity="0" group="1"/></default>
  </default>
  <asset>
    <mesh name="tool" file="tool.stl" scale="1 -1 1"/>
    <mesh name="made" vertex="{tetrahedron}"/>
    <material name="red" rgba="0.9 0.1 0.2 1"/>
  </asset>
  <include file="parts/world.xml"/>
  <equality>
    <connect name="pin" body1="hand" body2="second" anchor="0.1 0.2 0.3"/>
    <joint name="gear" joint1="slide" joint2="turn" polycoef="0.01 -0.4 0 0 0"/>
    <tendon name="rod" tendon1="straight" polycoef="-0.001 0 0 0 0"/>
  </equality>
  <tendon>
    <spatial name="straight"><site site="on_arm"/><site site="on_tip"/></spatial>
  </tendon>
  <actuator>
    <motor name="drive" joint="turn" gear="25" ctrlrange="-4 5"/>
    <motor name="slide" joint="slide" ctrlrange="-4 4"/>
    <position joint="bend" kp="30" forcerange="-8 8"/>
  </actuator>
  <keyframe><key name="home" qpos="{home}"/></keyframe>
</mujoco>
"""

#: Other equalities, which contradict each other.
EQUALITIES = """\
  <equality>
    <weld name="glue" body1="ball" body2="tip" relpose="0.1 0 0 0.8 0.6 0 0" anchor="0 0.1 0"/>
    <weld name="glued sites" site1="on_arm" site2="tool_centre"/>
    <connect name="sites" site1="on_arm" site2="on_tip"/>
    <tendon name="sum" tendon1="three"/>
    <tendon name="both" tendon1="three" tendon2="two" polycoef="0.2 0.5 0 0 0"/>
  </equality>
  <tendon>
    <fixed name="three">
      <joint joint="turn" coef="2"/><joint joint="slide" coef="-3"/><joint joint="bend" coef="1"/>
    </fixed>
    <fixed name="two"><joint joint="turn" coef="1"/><joint joint="swing" coef="1"/></fixed>
  </tendon>
</mujoco>
"""

WORLD = """\
<mujoco>
  <worldbody>
    <light pos="0 0 3"/>
    <geom type="plane" size="1 1 1"/>
    <body name="base" pos="0 0 1" euler="10 20 30">
      <freejoint/>
      <inertial pos="0.1 0 0" mass="3" fullinertia="0.3 0.4 0.5 0.01 -0.02 0.03"/>
      <geom class="seen" type="box" size="0.1 0.2 0.3" material="red"/>
      <geom type="capsule" size="0.05 0.2" pos="0 0 0.1"/>
      <geom type="ellipsoid" size="0.1 0.2 0.3"/>
      <body name="arm" pos="0.1 0.2 0.3" quat="0.8 0 0.6 0">
        <joint name="turn" class="stiff" pos="0.1 0 0.2" ref="20" range="-100 150" actuatorfrcrange="-90 90"/>
        <joint name="slide" type="slide" axis="0 1 1" ref="0.1" range="-1 1"/>
        <joint name="bend" axis="0 0 1" pos="0 0.1 0"/>
        <geom type="sphere" size="0.1" mass="1" pos="0.05 0 0" rgba="0.1 0.2 0.3 1"/>
        <geom class="seen" type="mesh" mesh="tool" mass="0" pos="0.01 0.02 0.03" euler="5 6 7"/>
        <site name="on_arm" pos="0.1 0 0"/>
        <body name="hand" pos="0 0 0.5"><geom type="cylinder" size="0.1 0.2" mass="1.5"/></body>
        <body name="ball" pos="0.2 0 0.4" euler="0 40 0">
          <joint name="socket" type="ball" pos="0 0.05 0"/>
          <geom type="box" size="0.1 0.2 0.3" mass="2"/>
        </body>
      </body>
      <body name="second" pos="-0.3 0 0">
        <joint name="swing" axis="0 1 0"/>
        <geom type="mesh" mesh="made" mass="1"/>
        <body name="tip" pos="0 0 0.4" gravcomp="0.5">
          <joint name="yaw" axis="0 0 1" pos="0.02 0 0"/>
          <geom type="box" size="0.1 0.1 0.2" mass="0.7"/>
          <site name="on_tip" pos="0 0 0.1"/>
          <site name="tool_centre" pos="0 0 0.3" euler="0 0 90"/>
        </body>
      </body>
    </body>
  </worldbody>
</mujoco>
"""
HOME = "0 0 0.5 1 0 0 0 0.3 0.1 0.2 1 0 0 0 0.1 -0.1"


@pytest.fixture(scope="module")
def features(tmp_path_factory: pytest.TempPathFactory) -> Path:
    folder = tmp_path_factory.mktemp("features")
    for name in ("files", "parts"):
        (folder / name).mkdir()
    (folder / "files" / "tool.stl").write_bytes(TETRAHEDRON)
    (folder / "parts" / "world.xml").write_text(WORLD)
    main = folder / "robot.xml"
    main.write_text(FEATURES.format(tetrahedron=VERTICES, home=HOME))
    return main


@pytest.fixture(scope="module")
def imported(features: Path) -> eurdf.convert.Import:
    return eurdf.import_robot(features)


def codes(found: eurdf.convert.Import) -> set[str]:
    return {loss.code for loss in found.losses}


def test_poses_mass_matrix_and_openings_are_those_of_mujoco(features: Path, imported: eurdf.convert.Import) -> None:
    there = Beside(mujoco.MjModel.from_xml_path(str(features)), imported.mechanism)
    assert there.robot.model.nv == there.model.nv
    for seed in range(3):
        q = there.at(there.random(seed))
        there.assert_same_poses(q)
        there.assert_same_mass_matrix(q)
        there.assert_same_openings(q)


def test_equalities_of_all_kinds_are_as_open_as_in_mujoco(features: Path) -> None:
    head, _, _ = FEATURES.partition("  <equality>")
    main = features.with_name("equalities.xml")
    main.write_text(head.format(tetrahedron=VERTICES) + EQUALITIES)
    found = eurdf.import_robot(main)
    assert [each.type for each in found.mechanism.constraints] == ["6d", "6d", "3d", "coupling", "coupling"]
    assert not found.closes
    assert "import-not-assembled" in codes(found)
    there = Beside(mujoco.MjModel.from_xml_path(str(main)), found.mechanism)
    for seed in range(3):
        there.assert_same_openings(there.at(there.random(seed)))


def test_joints_keep_type_limits_and_springs(imported: eurdf.convert.Import) -> None:
    joints = {joint.name: joint for joint in imported.mechanism.joints}
    types = [joints[name].type for name in ("turn", "slide", "bend", "socket", "hand_fixed")]
    assert types == ["revolute", "prismatic", "continuous", "spherical", "fixed"]
    turn = joints["turn"].properties
    found = [*turn.lower, *turn.upper, *turn.rest, *turn.stiffness, *turn.friction, *turn.damping, *turn.armature]
    np.testing.assert_allclose(found, [*np.radians([-100, 150, 10]), 7, 0.1, 0.3, 0.02], rtol=1e-12)
    assert turn.effort == (90.0,)
    assert turn.gear_ratio == (25.0,)


def test_equalities_become_closures_and_couplings(imported: eurdf.convert.Import) -> None:
    kinds = {each.name: type(each) for each in imported.mechanism.constraints}
    assert kinds == {"pin": PointClosure, "rod": DistanceClosure, "gear": Coupling}


def test_actuators_keep_names_gears_and_ranges(imported: eurdf.convert.Import) -> None:
    mechanism = imported.mechanism
    assert mechanism.actuators == ("turn", "slide", "bend")
    assert mechanism.motors["turn"] == Motor("drive", (-100.0, 125.0))
    efforts = {joint.name: joint.properties.effort for joint in mechanism.joints}
    assert efforts["slide"] == (4.0,)
    assert efforts["bend"] == (8.0,)
    assert [loss.name for loss in imported.losses if loss.code == "import-actuator-gain"] == ["bend"]


def test_shapes_are_visual_or_collision(imported: eurdf.convert.Import) -> None:
    bodies = {body.name: body for body in imported.mechanism.bodies}
    (box, capsule) = bodies["base"].visuals
    assert (box.kind, box.size, box.color) == ("box", (0.2, 0.4, 0.6), (0.9, 0.1, 0.2, 1.0))
    assert (capsule.kind, capsule.size, capsule.color) == ("capsule", (0.05, 0.4), None)
    assert bodies["base"].collisions == (capsule,)
    (_, tool) = bodies["arm"].visuals
    assert (tool.kind, tool.size, tool.filename) == ("mesh", (1.0, -1.0, 1.0), "meshes/tool.stl")
    assert imported.files["meshes/tool.stl"] == TETRAHEDRON
    np.testing.assert_allclose(tool.pose.xyz, (0.01, 0.02, 0.03), atol=1e-7)
    (made,) = bodies["second"].collisions
    assert imported.files[made.filename].startswith(b"v ")


def test_every_loss_is_listed(imported: eurdf.convert.Import) -> None:
    words = "actuator-gain effort-limit gravity-compensation mesh-converted scenery shape simulation softness"
    assert codes(imported) == {f"import-{word}" for word in words.split()}


def small(body: str, more: str = "") -> str:
    return f"<mujoco><worldbody>{body}</worldbody>{more}</mujoco>"


def write(folder: Path, text: str, name: str = "robot.xml") -> Path:
    path = folder / name
    path.write_text(text)
    return path


LINK = '<geom type="sphere" size="0.1" mass="1"/>'
ARM = f'<body name="arm"><joint name="a" axis="0 0 1"/>{LINK}</body>'


def test_body_of_the_world_that_does_not_move_is_the_root(tmp_path: Path) -> None:
    found = eurdf.import_robot(write(tmp_path, small(f'<body name="base">{LINK}{ARM}</body>')))
    assert [body.name for body in found.mechanism.bodies] == ["base", "arm"]
    assert found.mechanism.root == "fixed"


def test_world_is_the_root_of_several_bodies(tmp_path: Path) -> None:
    free = f'<body name="cube" pos="1 0 0"><freejoint name="cube"/>{LINK}</body>'
    found = eurdf.import_robot(write(tmp_path, small(ARM + free)))
    assert found.mechanism.bodies[0].name == "world"
    assert {joint.type for joint in found.mechanism.joints} == {JointType.CONTINUOUS, JointType.FLOATING}
    there = Beside(model_without_meshes(tmp_path / "robot.xml"), found.mechanism)
    there.assert_same_poses(there.at(there.random(3)))


def test_elements_without_names_get_names(tmp_path: Path) -> None:
    found = eurdf.import_robot(write(tmp_path, small(f'<body><joint axis="0 0 1"/>{LINK}<body>{LINK}</body></body>')))
    assert [body.name for body in found.mechanism.bodies] == ["world", "body_1", "body_2"]
    assert [joint.name for joint in found.mechanism.joints] == ["body_1_joint", "body_2_fixed"]
    assert "import-name" in codes(found)


def test_joint_that_an_equality_holds_is_fixed(tmp_path: Path) -> None:
    lock = '<equality><joint joint1="a" polycoef="0.5 0 0 0 0"/></equality>'
    found = eurdf.import_robot(write(tmp_path, small(f'<body name="base">{LINK}{ARM}</body>', lock)))
    (joint,) = found.mechanism.joints
    assert joint.type is JointType.FIXED
    np.testing.assert_allclose(joint.placement.quaternion, (0, 0, np.sin(0.25), np.cos(0.25)), atol=1e-12)
    assert "import-locked-joint" in codes(found)


@pytest.mark.parametrize(
    ("more", "code"),
    [
        ('<equality><joint joint1="a" joint2="b" polycoef="0 1 2 0 0"/></equality>', "import-equality"),
        ('<equality><joint joint1="a" joint2="b" active="false"/></equality>', "import-inactive-equality"),
        (
            '<equality><joint joint1="a" joint2="b"/><joint joint1="b" joint2="a"/></equality>',
            "import-redundant-equality",
        ),
        ('<tendon><fixed name="t" stiffness="3"><joint joint="a" coef="1"/></fixed></tendon>', "import-tendon"),
        ('<actuator><motor joint="a"/><motor joint="a"/></actuator>', "import-second-actuator"),
        ('<actuator><motor site="s" refsite="s" gear="1 0 0 0 0 0"/></actuator>', "import-actuator"),
        ('<sensor><jointpos joint="a"/></sensor>', "import-simulation"),
        ('<keyframe><key qpos="9 0"/></keyframe>', "import-configuration"),
    ],
)
def test_what_cannot_be_said_is_a_loss(tmp_path: Path, more: str, code: str) -> None:
    text = small(
        f'<body name="base">{LINK}<body name="one"><joint name="a" range="-1 1"/>{LINK}<site name="s"/></body>'
        f'<body name="two"><joint name="b"/>{LINK}</body></body>',
        '<compiler angle="radian"/>' + more,
    )
    found = eurdf.import_robot(write(tmp_path, text))
    assert code in codes(found)
    found.write(tmp_path / "out")
    assert eurdf.check(tmp_path / "out").ok


def test_mesh_without_file_is_a_loss(tmp_path: Path) -> None:
    text = (
        '<mujoco><asset><mesh name="gone" file="gone.stl"/><mesh name="lfs" file="lfs.stl"/></asset><worldbody>'
        f'<body name="base">{LINK}<inertial pos="0 0 0" mass="1" diaginertia="1 1 1"/><geom type="mesh" mesh="gone"/>'
        '<geom type="mesh" mesh="lfs"/></body></worldbody></mujoco>'
    )
    (tmp_path / "lfs.stl").write_text("version https://git-lfs.github.com/spec/v1\n")
    found = eurdf.import_robot(write(tmp_path, text))
    messages = {loss.name: loss.message for loss in found.losses if loss.code == "import-mesh"}
    assert messages["gone"] == "is left out: its file 'gone.stl' was not found"
    assert "git lfs pull" in messages["lfs"]


def test_inertia_from_a_mesh_without_file_is_refused(tmp_path: Path) -> None:
    text = (
        '<mujoco><asset><mesh name="gone" file="gone.stl"/></asset><worldbody><body name="base"><joint/>'
        '<geom type="mesh" mesh="gone"/></body></worldbody></mujoco>'
    )
    with pytest.raises(eurdf.errors.CannotImport, match="mesh 'gone', of which body 'base' gets its inertia: its file"):
        eurdf.import_robot(write(tmp_path, text))


MODEL = (
    '<asset><model name="m" file="sub/a.xml"/></asset><worldbody><attach model="m" body="arm" prefix="p"/></worldbody>'
)


# -- bad input --------------------------------------------------------------------------------------------------------


@pytest.mark.parametrize(
    ("text", "message"),
    [
        ("<mujoco><worldbody>", "robot.xml:1"),
        ('<!DOCTYPE m [<!ENTITY e "x">]><mujoco model="&e;"/>', "robot.xml:1"),
        ('<!DOCTYPE m [<!ENTITY e SYSTEM "file:///etc/passwd">]><mujoco>&e;</mujoco>', "robot.xml:1"),
        ("<gazebo/>", "its root element is <gazebo>"),
        ("<mujoco><worldbody><body><joint/></body></worldbody></mujoco>", "MuJoCo says: "),
        ('<mujoco><include file="/etc/passwd"/></mujoco>', "is outside the folder"),
        ('<mujoco><include file="../secret.xml"/></mujoco>', "is outside the folder"),
        ('<mujoco><asset><model name="m" file="../secret.xml"/></asset></mujoco>', "is outside the folder"),
        ('<mujoco><include file="link.xml"/></mujoco>', "is outside the folder"),
        ('<mujoco><include file="robot.xml"/></mujoco>', "a file includes itself: 'robot.xml' -> 'robot.xml'"),
        ('<mujoco><include file="$(touch pwned).xml"/></mujoco>', "no such file or directory"),
    ],
)
def test_bad_file_is_refused_with_one_error(
    tmp_path: Path, text: str, message: str, monkeypatch: pytest.MonkeyPatch
) -> None:
    home = tmp_path / "home"
    home.mkdir()
    monkeypatch.chdir(home)
    write(tmp_path, small(ARM), "secret.xml")
    (home / "link.xml").symlink_to(tmp_path / "secret.xml")
    path = write(home, text)
    with pytest.raises(eurdf.errors.CannotImport) as refused:
        eurdf.import_robot(path)
    assert message in str(refused.value)
    assert "\n" not in str(refused.value)
    assert sorted(os.listdir(home)) == ["link.xml", "robot.xml"]


def test_fragment_names_the_scene_that_includes_it(tmp_path: Path) -> None:
    fragment = '<mujoco><worldbody><body><joint class="leg"/><geom size="1"/></body></worldbody></mujoco>'
    path = write(tmp_path, fragment)
    write(tmp_path, '<mujoco><include file="other.xml"/></mujoco>', "another.xml")
    with pytest.raises(eurdf.errors.CannotImport, match=r"line 1$"):
        eurdf.import_robot(path)
    defaults = '<default><default class="leg"/></default>'
    scene = write(tmp_path, f'<mujoco>{defaults}<include file="./robot.xml"/></mujoco>', "scene.xml")
    with pytest.raises(eurdf.errors.CannotImport, match=r"it is included by 'scene\.xml': import that file instead"):
        eurdf.import_robot(path)
    assert eurdf.import_robot(scene).mechanism.joints


def test_compiler_that_takes_too_long_is_stopped(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    from eurdf.convert.mjcf import compiled as mjcf_model

    monkeypatch.setattr(mjcf_model, "SECONDS", 1)
    many = small(f'<replicate count="30000000" offset="0 0 1"><body><joint/>{LINK}</body></replicate>')
    with pytest.raises(eurdf.errors.CannotImport, match="MuJoCo does not compile it within 1 s"):
        eurdf.import_robot(write(tmp_path, many))


def test_meshes_elsewhere_are_left_out_or_allowed(tmp_path: Path) -> None:
    home = tmp_path / "home"
    home.mkdir()
    (tmp_path / "a.stl").write_bytes(TETRAHEDRON)
    (home / "linked.stl").symlink_to("../a.stl")
    os.mkfifo(home / "pipe.stl")
    with (home / "sparse.stl").open("wb") as file:
        file.write(bytes(80) + (800_000_000).to_bytes(4, "little"))
        file.truncate(84 + 50 * 800_000_000)
    names = ("../a.stl", "linked.stl", str(tmp_path / "a.stl"), "pipe.stl", "sparse.stl")
    assets = "".join(f'<mesh name="m{number}" file="{name}"/>' for number, name in enumerate(names))
    geoms = "".join(f'<geom type="mesh" mesh="m{number}" mass="0"/>' for number in range(len(names)))
    body = f'<body name="base">{LINK}{geoms}</body>'
    main = write(home, f"<mujoco><asset>{assets}</asset><worldbody>{body}</worldbody></mujoco>")
    found = eurdf.import_robot(main)
    reasons = [loss.message for loss in found.losses if loss.code == "import-mesh"]
    assert ["outside the folder" in reason for reason in reasons] == [True, True, True, False, False]
    assert "40,000,000,084 bytes" in reasons[4]
    assert not any(name.startswith("meshes/") for name in found.files)
    shapes = eurdf.import_robot(main, within=tmp_path).mechanism.bodies[0].visuals
    assert sorted(shape.filename for shape in shapes) == ["", *["meshes/a.stl"] * 2, "meshes/linked.stl"]
    found = eurdf.import_robot(main, allow_outside=True)
    assert [loss.name for loss in found.losses if loss.code == "import-file-outside"] == [
        str(home.parent / "a.stl"),
        str(home / "linked.stl"),
    ]


@pytest.mark.parametrize(
    ("files", "read"),
    [
        # MuJoCo looks beside the main file, then beside the one that includes; for a model, beside the model.
        ({"robot.xml": '<include file="sub/a.xml"/>', "sub/a.xml": '<include file="b.xml"/>'}, "sub/b.xml"),
        ({"robot.xml": MODEL, "sub/a.xml": '<include file="b.xml"/>'}, "sub/b.xml"),
    ],
)
def test_what_included_files_include_is_confined(tmp_path: Path, files: dict[str, str], read: str) -> None:
    (tmp_path / "home" / "sub").mkdir(parents=True)
    write(tmp_path, small(ARM), "secret.xml")
    for name, text in files.items():
        write(tmp_path / "home", f"<mujoco>{text}</mujoco>", name)
    (tmp_path / "home" / read).symlink_to(tmp_path / "secret.xml")
    with pytest.raises(eurdf.errors.CannotImport, match="is outside the folder"):
        eurdf.import_robot(tmp_path / "home" / "robot.xml")
    assert eurdf.import_robot(tmp_path / "home" / "robot.xml", within=tmp_path).sources[1:]


@pytest.mark.parametrize(
    "compiler",
    ["", '<compiler meshdir=".."/>', '<compiler assetdir="/"/>', '<compiler meshdir=".." strippath="true"/>'],
)
def test_flexible_body_elsewhere_is_refused(tmp_path: Path, compiler: str) -> None:
    name = "../a.stl" if not compiler else "etc/a.stl"
    body = f'<body name="b">{LINK}<flexcomp name="f" type="mesh" dim="2" file="{name}"/></body>'
    with pytest.raises(eurdf.errors.CannotImport, match="is outside the folder"):
        eurdf.import_robot(write(tmp_path, f"<mujoco>{compiler}<worldbody>{body}</worldbody></mujoco>"))


def test_name_of_a_mesh_leads_to_no_other_folder(tmp_path: Path) -> None:
    (tmp_path / "$(x) ..;a.stl").write_bytes(TETRAHEDRON)
    text = (
        '<mujoco><asset><mesh name="../../m" file="$(x) ..;a.stl"/></asset><worldbody><body name="base">'
        f'{LINK}<geom type="mesh" mesh="../../m" mass="0"/></body></worldbody></mujoco>'
    )
    found = eurdf.import_robot(write(tmp_path, text))
    assert [name for name in found.files if name.startswith("meshes")] == ["meshes/__x__.._a.stl"]
    assert all(path.is_relative_to(tmp_path / "out") for path in found.write(tmp_path / "out"))


def test_compiler_that_crashes_ends_no_caller(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    from eurdf.convert.mjcf import compiled as mjcf_model

    program = write(tmp_path, "import os, signal; os.kill(os.getpid(), signal.SIGSEGV)", "program.py")
    monkeypatch.setattr(mjcf_model, "_PROGRAM", program)
    with pytest.raises(eurdf.errors.CannotImport, match="MuJoCo crashes on it"):
        eurdf.import_robot(write(tmp_path, small(ARM)))


# -- public models ----------------------------------------------------------------------------------------------------

#: Files below the folder that EURDF_IMPORT_MODELS names, and the largest opening (m, rad) that was seen before
#: assembling, rounded up.
PUBLIC = {
    "agility_cassie/cassie.xml": 2e-3,
    "robotiq_2f85/2f85.xml": 1e-12,
    "digit-v3.xml": 1e-12,
    "pal_kangaroo/xmls/kangaroo.xml": 1e-12,
    "AH_Right/mjcf/robot.xml": 1e-6,
    "toddlerbot/toddlerbot_scene.xml": 2e-6,
    "reachy_mini/mjcf/reachy_mini.xml": 1e-6,
    "spm/robot.xml": 1e-5,
}

#: Of models of onshape-to-robot: the closures that are hinges, each two <connect> in the file, and the mobility.
HINGES = {"AH_Right/mjcf/robot.xml": (8, 16), "spm/robot.xml": (2, 3)}


@pytest.mark.slow
@pytest.mark.skipif("EURDF_IMPORT_MODELS" not in os.environ, reason="EURDF_IMPORT_MODELS names no folder of models")
@pytest.mark.parametrize("name", PUBLIC)
def test_public_model_is_the_same(name: str, tmp_path: Path) -> None:
    found = [path for path in Path(os.environ["EURDF_IMPORT_MODELS"]).rglob(Path(name).name) if path.match(name)]
    if not found:
        pytest.skip(f"{name} is not in the folder")
    imported = eurdf.import_robot(found[0])
    assert imported.closes
    hinges = sum(closure.type == "hinge" for closure in imported.mechanism.closures)
    if name in HINGES:
        analysis = eurdf.analyze(build_robot(imported.mechanism, geometry=False))
        assert (hinges, analysis.mobility) == HINGES[name]
    assert max(max(each.position, each.angle) for each in imported.opened) <= PUBLIC[name]
    imported.write(tmp_path / "out")
    assert eurdf.check(tmp_path / "out").ok
    robot: Any = eurdf.load(tmp_path / "out", geometry=False)
    there = Beside(model_without_meshes(found[0]), robot.mechanism)
    for seed in range(2):
        q = there.at(there.random(seed))
        there.assert_same_poses(q)
        there.assert_same_mass_matrix(q)


def test_written_robot_is_that_of_mujoco(features: Path, imported: eurdf.convert.Import, tmp_path: Path) -> None:
    imported.write(tmp_path / "out")
    assert [str(found) for found in eurdf.check(tmp_path / "out").diagnostics if found.severity == "error"] == []
    robot = eurdf.load(tmp_path / "out", geometry=False)
    there = Beside(mujoco.MjModel.from_xml_path(str(features)), robot.mechanism)
    q = there.at(there.random(0))
    there.assert_same_poses(q)
    there.assert_same_mass_matrix(q)
    there.assert_same_openings(q)
    closed = robot.configurations["assembled"]
    assert max(max(each.position, each.angle) for each in eurdf.kinematics.closure_openings(robot, closed)) < 1e-6


def test_loops_are_assembled_from_the_keyframe(imported: eurdf.convert.Import) -> None:
    assert imported.start == "keyframe 'home'"
    assert imported.closes
    assert max(each.position for each in imported.opened) > 0.01
    assert imported.mechanism.configurations["home"]["turn"] == (0.3,)
    assert imported.mechanism.configurations["home"][ROOT_JOINT] == (0, 0, 0.5, 0, 0, 0, 1)


def test_long_chain_of_includes_is_refused(tmp_path: Path) -> None:
    for index in range(60):
        write(tmp_path, f'<mujoco><include file="f{index + 1}.xml"/></mujoco>', f"f{index}.xml")
    with pytest.raises(eurdf.errors.CannotImport, match="files include each other more than 50 deep"):
        eurdf.import_robot(tmp_path / "f0.xml")
