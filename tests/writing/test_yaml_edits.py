"""Entries and items that are added to the text of a description."""

from __future__ import annotations

import pytest

from eurdf.reading.source import Source
from eurdf.reading.yaml_reader import plain_data, read_yaml
from eurdf.writing.yaml_edits import NotEditable, YamlEdits

HEAD = 'extended_urdf: "2.0"\n'


@pytest.mark.parametrize(
    "actuators",
    [
        "",
        "actuators: []\n",
        "actuators: [a, b]  # all\n",
        "actuators:\n  - a\n  - {joint: b}  # the last\n",
        "actuators:\n- a",
    ],
)
def test_items_are_added_to_a_list_in_any_form(actuators: str) -> None:
    text = HEAD + actuators
    before = plain_data(text)
    edits = YamlEdits(read_yaml(Source("", text, text.encode())))
    edits.add_items("actuators", ["c", {"joint": "d", "gear_ratio": 2}])
    after = plain_data(edits.text())
    assert before is not None
    assert after == {**before, "actuators": [*before.get("actuators", []), "c", {"joint": "d", "gear_ratio": 2}]}
    assert all(comment in edits.text() for comment in ("# all", "# the last") if comment in text)


def test_closure_is_written_as_those_above_it() -> None:
    text = HEAD + "closures:\n  - name: a\n    type: 3d\n    frames: [p, q]\nactuators: [m]\n"
    edits = YamlEdits(read_yaml(Source("", text, text.encode())))
    edits.add_items("closures", [{"name": "b", "type": "3d", "frames": ["r", "s"]}])
    assert "  - name: b\n    type: 3d\n    frames: [r, s]\nactuators" in edits.text()


def test_alias_is_not_edited() -> None:
    text = HEAD + "x-all: &all [a]\nactuators: *all\n"
    with pytest.raises(NotEditable):
        YamlEdits(read_yaml(Source("", text, text.encode()))).add_items("actuators", ["b"])
