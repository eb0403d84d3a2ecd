"""The gallery of the collection, and the features of the format that its robots show."""

from __future__ import annotations

import eurdf
from robots.features import FEATURES, features_of
from robots.gallery import DIMENSIONS, FILE, dimensions, gallery
from support.places import ROOT


def test_gallery_is_current():
    assert FILE.read_text(encoding="utf-8") == gallery(), "run python -m robots.gallery"


def test_dimensions_are_current():
    assert DIMENSIONS.read_text(encoding="utf-8") == dimensions(), "run python -m robots.gallery"


def test_each_feature_is_shown_by_a_robot():
    shown = {feature for name in eurdf.collection_names() for feature in features_of(ROOT / "robots" / name)}
    assert shown == set(FEATURES)


def test_features_are_read_from_the_files(tmp_path):
    (tmp_path / "robot.urdf").write_text("<robot/>")
    description = (
        "closures: [{name: a, type: hinge, frames: [b, c]}]\njoints: {d: {mimic: true, armature: 1}, e: fixed}\n"
    )
    (tmp_path / "robot.yaml").write_text(
        description + "actuators: [d, {joint: e, name: f}]\nconfigurations: {assembled: {}}"
    )
    assert features_of(tmp_path) == ["hinge", "fixed", "armature", "name of actuator"]
