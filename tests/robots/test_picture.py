"""Pictures of robots: three views side by side, in colour, on a transparent background."""

from __future__ import annotations

import sys
from xml.etree import ElementTree

import numpy as np
import pytest

import eurdf
from eurdf.commands.main import main
from eurdf.linking.robot_files import read_robot
from eurdf.viewing.graph import save_graph
from eurdf.viewing.opened import opened
from eurdf.viewing.picture import VIEWS, drawn, picture
from robots import picture as pictures
from robots import sheet
from support.places import ROBOTS, ROOT


def on_white(image):
    """The pixels (height, width, 3) of a picture on a white page."""
    alpha = image[..., 3:] / 255.0
    return alpha * image[..., :3] + 255.0 * (1.0 - alpha)


def test_missing_renderer_says_what_to_install(monkeypatch, capsys, tmp_path):
    monkeypatch.setitem(sys.modules, "pyvista", None)
    assert pictures.main(["four_bar"]) == 2
    assert sheet.main(["-o", str(tmp_path / "sheet.png")]) == 2
    assert main(["picture", "four_bar", "-o", str(tmp_path / "picture.png")]) == 2
    lines = capsys.readouterr().err.splitlines()
    assert len(lines) == 3
    assert all("pictures need pyvista; install it with: " in line and "[pictures]" in line for line in lines)


@pytest.mark.slow
def test_command_draws_a_configuration_with_its_loops(capsys, tmp_path):
    pytest.importorskip("pyvista", reason="pyvista is not installed: pip install -e '.[pictures]'")
    from PIL import Image

    folder = ROBOTS / "four_bar"
    yaml = (folder / "robot.yaml").read_text()
    (tmp_path / "robot.yaml").write_text(yaml.replace("assembled: {}", "assembled: {}\n  apart: {motor_crank: 0.7}"))
    (tmp_path / "robot.urdf").write_text((folder / "robot.urdf").read_text())
    found = {}
    for name, options in {
        "assembled": [],
        "loops": ["--loops"],
        "apart": ["--loops", "--configuration", "apart"],
        "neutral": ["--configuration", "neutral"],
        "cut": ["--open"],
    }.items():
        file = tmp_path / f"{name}.png"
        assert main(["picture", str(tmp_path), "-o", str(file), *options]) == 0
        found[name] = on_white(np.asarray(Image.open(file).convert("RGBA")))
    red = {name: ((pixels[..., 0] - pixels[..., 1:].max(axis=2)) > 120).sum() for name, pixels in found.items()}
    assert red["apart"] > 100  # the line across the open closure
    assert red["loops"] < 20
    violet = {name: ((pixels[..., 2] - pixels[..., 1]) > 100).sum() for name, pixels in found.items()}
    assert violet["assembled"] == 0
    assert violet["loops"] > 60  # a dot has a diameter of 12 pixels
    assert violet["cut"] > 1.8 * violet["loops"]  # two dots in the place of one, in each view
    assert red["cut"] < 20
    assert found["assembled"].shape == found["neutral"].shape  # the assembled configuration is the neutral one
    assert main(["picture", str(tmp_path), "-o", str(file), "--force", "--configuration", "aparr"]) == 2
    assert "there is no configuration 'aparr'; did you mean 'apart'?" in capsys.readouterr().err


@pytest.mark.parametrize("name", ["digit_leg", "doggo_leg", "bennett", "kangaroo_leg", "double_wishbone", "unitree_g1"])
def test_opened_closures_are_equally_far_apart(name):
    robot = eurdf.load(name, geometry=False)
    q = robot.configurations["assembled"]
    apart = opened(robot, q, 0.01)
    gaps = [each.position for each in eurdf.kinematics.closure_openings(robot, apart)[: len(robot.mechanism.closures)]]
    assert min(gaps) == pytest.approx(max(gaps), rel=1e-4)
    assert 0.0024 < min(gaps) < 0.0101  # a quarter at least
    assert apart[robot.actuation.idx_q] == pytest.approx(q[robot.actuation.idx_q], abs=1e-12)


def test_robot_without_closures_cannot_be_drawn_open():
    with pytest.raises(ValueError, match="no closure to show open"):
        drawn(eurdf.load(ROBOTS / "four_bar" / "robot.urdf"), None, True, True)


def test_robot_without_shapes_is_drawn_as_lines(tmp_path):
    pytest.importorskip("pyvista", reason="pyvista is not installed: pip install -e '.[pictures]'")
    image = picture(eurdf.load("four_bar", geometry=False))
    assert (image[..., 3] > 200).sum() > 200


def test_each_robot_has_small_transparent_pictures_and_its_graph(tmp_path):
    images = pytest.importorskip("PIL.Image", reason="Pillow is not installed: pip install -e '.[pictures]'")
    for name in eurdf.collection_names():
        folder = ROOT / "robots" / name
        for file in (folder / "picture.png", folder / "loops.png"):
            assert file.stat().st_size <= 60_000, file
            seen = np.asarray(images.open(file).convert("RGBA"))
            assert not seen[[0, 0, -1, -1], [0, -1, 0, -1], 3].any(), file
            # It is seen on white and on black: few pixels are near one of the two.
            near = seen[seen[..., 3] > 250][:, :3].astype(int) - 128
            assert (np.abs(near).min(axis=1) < 115).mean() > 0.98, file
        save_graph(read_robot(folder / "robot.yaml", geometry=False).mechanism, tmp_path / "graph.svg")
        drawn = (folder / "graph.svg").read_text()
        assert drawn == (tmp_path / "graph.svg").read_text(), f"python -m robots.picture {name}"


def test_graph_names_joints_closures_and_couplings(capsys, tmp_path):
    file = tmp_path / "graph.svg"
    assert main(["picture", "tello", "--graph", "-o", str(file)]) == 0
    mechanism = eurdf.load("tello", geometry=False).mechanism
    shown = {element.text for element in ElementTree.parse(file).iter("{http://www.w3.org/2000/svg}text")}
    assert {f"{each.name} ({each.type})" for each in (*mechanism.joints, *mechanism.constraints)} <= shown
    assert {body.name for body in mechanism.bodies} <= shown
    assert main(["picture", "tello", "--graph", "--loops", "-o", str(tmp_path / "other.svg")]) == 2
    assert "leave out --loops, --open and --configuration" in capsys.readouterr().err


def test_distance_is_no_open_closure():
    pytest.importorskip("pyvista", reason="pyvista is not installed: pip install -e '.[pictures]'")
    pixels = on_white(picture(eurdf.load("tello"), VIEWS[1:2], loops=True))
    assert ((pixels[..., 0] - pixels[..., 1:].max(axis=2)) > 120).sum() < 20


def test_palette_keeps_colours_and_transparency():
    pytest.importorskip("PIL", reason="Pillow is not installed: pip install -e '.[pictures]'")
    from eurdf.viewing.picture import with_palette

    rng = np.random.default_rng(0)
    few = np.r_[rng.integers(0, 256, (200, 4)), [[0, 0, 0, 0]]].astype(np.uint8)
    few[:100, 3] = 255
    image = few[rng.integers(0, len(few), (40, 50))]
    colors, indices = with_palette(image)
    back, alpha = colors[indices].astype(float), image[..., 3:] / 255.0
    assert np.abs(back[..., 3] - image[..., 3]).mean() < 4
    assert np.abs(back[..., :3] * back[..., 3:] / 255.0 - image[..., :3] * alpha).mean() < 4
    assert (back[image[..., 3] == 255][:, 3] == 255).mean() > 0.9
    assert with_palette(image, 16)[0].shape == (16, 4)


def test_sheet_shows_each_robot_with_name():
    pytest.importorskip("pyvista", reason="pyvista is not installed: pip install -e '.[pictures]'")
    one, two = sheet.sheet(["four_bar"]), sheet.sheet(["four_bar", "bennett"])
    width, height = 170, 190
    assert one.shape == two.shape
    assert (one[:, width:, 3] == 0).all()
    assert (two[:, :width] == one[:, :width]).all()
    for part in (two[: height - 22, width : 2 * width], two[height - 22 :, width : 2 * width]):
        assert (part[..., 3] > 200).any()


def test_undrawable_robot_is_reported(capsys, tmp_path):
    pytest.importorskip("pyvista", reason="pyvista is not installed: pip install -e '.[pictures]'")
    assert pictures.main(["no_such_robot"]) == 1
    (tmp_path / "robot.urdf").write_text('<robot name="bare"><link name="base"/></robot>')
    assert main(["picture", str(tmp_path), "-o", str(tmp_path / "picture.png")]) == 2
    no_such, bare = capsys.readouterr().err.splitlines()
    assert no_such.startswith("no_such_robot: it is not in the collection")
    assert bare.startswith(f"eurdf: '{tmp_path}': there is nothing to draw")


def test_views_fill_picture_within_margin():
    pytest.importorskip("pyvista", reason="pyvista is not installed: pip install -e '.[pictures]'")
    image = picture(eurdf.load("four_bar"))
    height, width, _ = image.shape
    assert (image[[0, 0, -1, -1], [0, -1, 0, -1], 3] == 0).all()
    assert abs(width - 780) <= 3
    assert height <= 860
    seen = image[..., 3] > 10
    rows, columns = np.flatnonzero(seen.any(axis=1)), np.flatnonzero(seen.any(axis=0))
    assert (columns[0], width - 1 - columns[-1]) == pytest.approx((12, 12), abs=2)
    assert (rows[0], height - 1 - rows[-1]) == pytest.approx((12, 12), abs=2)
