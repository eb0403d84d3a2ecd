"""A robot in the viewer, as a program and a page see it."""

from __future__ import annotations

from collections.abc import Iterator
from pathlib import Path

import numpy as np
import pytest

import eurdf
from eurdf.transmissions.passive_limits import passive_limits
from support.places import ROBOTS
from support.viewer_client import ViewerClient, wait_for

pytest.importorskip("websockets", reason="websockets is not installed: pip install -e '.[view]'")


@pytest.fixture
def viewer() -> Iterator[eurdf.viewing.Viewer]:
    with eurdf.view("four_bar", port=0) as viewer:
        yield viewer


def test_shown_configurations_are_those_given(viewer: eurdf.viewing.Viewer) -> None:
    robot = viewer.robot
    q = robot.tree.integrate(viewer.q, np.full(robot.tree.nv, 0.1))
    viewer.show(q)
    assert (viewer.q == q).all()
    viewer.animate([q, robot.configurations["assembled"]], 0.01)
    assert (viewer.q == robot.configurations["assembled"]).all()
    with pytest.raises(ValueError, match="q"):
        viewer.show(q[:2])
    with pytest.raises(ValueError, match="dt"):
        viewer.animate([q], 0.0)
    with pytest.raises(ValueError, match="xyz"):
        viewer.add(robot, xyz=(0.0, 1.0))
    assert (viewer.q == robot.configurations["assembled"]).all()


def test_pages_are_told_where_the_robot_is(viewer: eurdf.viewing.Viewer) -> None:
    """By the program, and by another page; not the page that moved it, which knows."""
    robot = viewer.robot

    def is_at(page: ViewerClient, q: np.ndarray) -> bool:
        found = page.last("show", 0) or page.last("model", 0)
        return found is not None and bool(np.allclose(robot.configuration(found["q"]), q, atol=1e-12))

    with ViewerClient(viewer.url) as one, ViewerClient(viewer.url) as two:
        q = robot.tree.integrate(viewer.q, np.full(robot.tree.nv, 0.1))
        viewer.show(q)
        wait_for(lambda: is_at(one, q) and is_at(two, q))
        closed = eurdf.forward_kinematics(robot, {"motor_crank": 0.4})
        one.send("moved", version=0, q=robot.joint_positions(closed))
        wait_for(lambda: is_at(two, closed))
        assert is_at(one, q)
        assert viewer.q == pytest.approx(closed, abs=1e-12)
        with ViewerClient(viewer.url) as late:
            wait_for(lambda: is_at(late, closed))


def test_limits_are_those_at_the_configuration_shown(viewer: eurdf.viewing.Viewer) -> None:
    robot = viewer.robot
    with ViewerClient(viewer.url) as page:
        for angle in (0.3, 0.9):
            page.wait_for(lambda: page.last("analyzed"))
            page.said.clear()
            viewer.show(eurdf.forward_kinematics(robot, {"motor_crank": angle}))
            found = page.wait_for(lambda: page.last("analyzed"))
            expected = {limit.name: limit for limit in passive_limits(robot, viewer.q)}
            for limit in found["limits"]:
                assert limit["velocity"] == pytest.approx(expected.pop(limit["name"]).velocity)
            assert expected == {}
            assert found["singularity"] == pytest.approx(eurdf.analyze(robot, viewer.q).singularity)
        page.said.clear()
        viewer.show(robot.tree.integrate(viewer.q, np.full(robot.tree.nv, 0.1)))
        assert "open" in page.wait_for(lambda: page.last("analyzed"))["reason"]


def test_saved_page_needs_no_server(viewer: eurdf.viewing.Viewer, tmp_path: Path) -> None:
    page = viewer.save(tmp_path / "scene.html").read_text()
    assert "<robot" in page.replace("\\u003c", "<")
    assert viewer.url not in page


def test_files_that_change_are_loaded_and_the_pose_stays(tmp_path: Path) -> None:
    for name in ("robot.urdf", "robot.yaml"):
        (tmp_path / name).write_text((ROBOTS / "four_bar" / name).read_text())
    urdf, yaml = tmp_path / "robot.urdf", tmp_path / "robot.yaml"
    with eurdf.view(tmp_path, port=0) as viewer, ViewerClient(viewer.url) as page:
        page.send(
            "moved",
            version=0,
            q=viewer.robot.joint_positions(eurdf.forward_kinematics(viewer.robot, {"motor_crank": 0.4})),
        )
        page.send("save", name="mine", replace=False)
        page.wait_for(lambda: page.last("saved"))
        urdf.write_text(urdf.read_text().replace('mass value="', 'mass value="1'))
        model = page.wait_for(lambda: next((each for each in page.said if each.get("version") == 1), None))
        assert model["q"]["motor_crank"] == pytest.approx([0.4])
        assert set(model["configurations"]) == {"assembled", "mine"}
        yaml.write_text(yaml.read_text() + "unknown: 1\n")
        report = page.wait_for(lambda: page.last("badfiles"))
        assert report["diagnostics"][0]["place"].startswith(f"{yaml}:")
        assert viewer.q == pytest.approx(viewer.robot.configuration(model["q"]))
