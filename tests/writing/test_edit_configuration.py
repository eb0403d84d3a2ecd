"""A configuration written into the text of a description: the rest stays character by character."""

from __future__ import annotations

from typing import Any

import pytest
import yaml
from hypothesis import given, settings
from hypothesis import strategies as st

from eurdf.reading.source import Source
from eurdf.reading.yaml_reader import read_yaml
from eurdf.writing.edit_configuration import with_configuration
from eurdf.writing.yaml_edits import NotEditable

HEAD = 'extended_urdf: "2.0"\n'
NEW = {"a": (0.5,), "b": (0.0, 0.0, 0.0, 1.0)}


def edited(text: str, coordinates: Any = None) -> str:
    return with_configuration(read_yaml(Source("", text, text.encode())), "assembled", coordinates or NEW)


ENTRY = "assembled: {a: 0.5, b: [0, 0, 0, 1]}"
BLOCK = f"configurations:\n  {ENTRY}\n"

#: Title, text, the text after.
LAYOUTS = [
    ("nothing else", HEAD, HEAD + BLOCK),
    ("no line break at the end", HEAD.rstrip(), HEAD + BLOCK),
    ("comment at the end", HEAD + "# end\n", HEAD + BLOCK + "# end\n"),
    ("comment beside", HEAD.rstrip() + "  # 2\nx-a: 1\n", HEAD.rstrip() + "  # 2\n" + BLOCK + "x-a: 1\n"),
    ("before what is for people", HEAD + "metadata: {license: MIT}\n", HEAD + BLOCK + "metadata: {license: MIT}\n"),
    ("after the actuators", HEAD + "actuators:\n- m # c\n\n# x\nx-a: 1\n",
     HEAD + "actuators:\n- m # c\n" + BLOCK + "\n# x\nx-a: 1\n"),
    ("keys in another order", "actuators: [m]\n" + HEAD, "actuators: [m]\n" + HEAD + BLOCK),
    ("text that keeps its end", HEAD + "x-a: |+\n  b\n\n", HEAD + BLOCK + "x-a: |+\n  b\n\n"),
    ("several lines", 'extended_urdf:\n  "2.0"\n# c\n', 'extended_urdf:\n  "2.0"\n' + BLOCK + "# c\n"),
    ("markers of a document", f"---\n{HEAD}...\n", f"---\n{HEAD}{BLOCK}...\n"),
    ("line breaks of Windows", "extended_urdf: '2.0'\r\nx-a: 1\r\n",
     f"extended_urdf: '2.0'\r\nconfigurations:\r\n  {ENTRY}\r\nx-a: 1\r\n"),
    ("line breaks of old", "extended_urdf: '2.0'\rx-a: 1\r",
     f"extended_urdf: '2.0'\rconfigurations:\r  {ENTRY}\rx-a: 1\r"),
    ("other breaks in a text", HEAD + "x-a: '\u2028\x85'\n", HEAD + BLOCK + "x-a: '\u2028\x85'\n"),
    ("characters beyond 16 bits", f"x-a: \U0001f916\n{HEAD}", f"x-a: \U0001f916\n{HEAD}{BLOCK}"),
    ("empty configurations", HEAD + "configurations: {}  # none\nx-a: 1\n",
     HEAD + f"configurations:\n  {ENTRY}  # none\nx-a: 1\n"),
    ("another configuration", HEAD + "configurations:\n    # c\n    r: {a: 1}  # d\n    # e\nx-a: 1\n",
     HEAD + f"configurations:\n    # c\n    r: {{a: 1}}  # d\n    {ENTRY}\n    # e\nx-a: 1\n"),
    ("another one in a block", HEAD + "configurations:\n  r:\n    b:\n    - 1\n    - 0\n\nx-a: 1\n",
     HEAD + f"configurations:\n  r:\n    b:\n    - 1\n    - 0\n  {ENTRY}\n\nx-a: 1\n"),
    ("another one in braces", HEAD + "configurations: {r: {a: 1} , }  # c\n",
     HEAD + f"configurations: {{r: {{a: 1}}, {ENTRY} , }}  # c\n"),
    ("another one in braces and lines", HEAD + "configurations: {\n  r: {a: 1},  # c\n}\n",
     HEAD + f"configurations: {{\n  r: {{a: 1}},\n  {ENTRY},  # c\n}}\n"),
    ("JSON", '{"extended_urdf": "2.0", "x-a": 1}',
     '{"extended_urdf": "2.0", "configurations": {"assembled": {"a": 0.5, "b": [0, 0, 0, 1]}}, "x-a": 1}'),
    ("JSON with another one", '{"extended_urdf": "2.0",\n "configurations": {\n  "r": {}\n }}\n',
     '{"extended_urdf": "2.0",\n "configurations": {\n  "r": {},\n  "assembled": {"a": 0.5, "b": [0, 0, 0, 1]}\n }}\n'),
    ("empty", HEAD + "configurations:\n  assembled: {}  # c\n", HEAD + f"configurations:\n  {ENTRY}  # c\n"),
    ("empty in JSON", '{"extended_urdf": "2.0", "configurations": {"assembled": {}}}',
     '{"extended_urdf": "2.0", "configurations": {"assembled": {"a": 0.5, "b": [0, 0, 0, 1]}}}'),
    ("comments within", HEAD + "configurations:\n  assembled:\n    # c\n    a: 0.1  # rad\n    # d\n  # e\n  r: {}\n",
     HEAD + "configurations:\n  assembled:\n    # c\n    a: 0.5  # rad\n"
     "    b: [0, 0, 0, 1]\n    # d\n  # e\n  r: {}\n"),
    ("the same numbers, written otherwise", HEAD + "configurations: {assembled: {b: [0.0, 0e0, 0, 1.], a: +.5}}\n",
     HEAD + "configurations: {assembled: {b: [0.0, 0e0, 0, 1.], a: +.5}}\n"),
    ("a list in lines", HEAD + "configurations:\n  assembled:\n    b:\n    - 1\n    - 0\n    - 0\n    - 0 # w\n",
     HEAD + "configurations:\n  assembled:\n    b:\n      [0, 0, 0, 1] # w\n    a: 0.5\n"),
    ("an alias", HEAD + "configurations:\n  r: &r {a: 1}\n  assembled: *r # c\n",
     HEAD + "configurations:\n  r: &r {a: 1}\n  assembled: {a: 0.5, b: [0, 0, 0, 1]} # c\n"),
    ("an alias of a number", HEAD + "x-a: &a 1\nconfigurations: {assembled: {a: *a , b: [0, 0, 0, 1]}}\n",
     HEAD + "x-a: &a 1\nconfigurations: {assembled: {a: 0.5 , b: [0, 0, 0, 1]}}\n"),
]  # fmt: skip


@pytest.mark.parametrize(("before", "after"), [layout[1:] for layout in LAYOUTS], ids=[title for title, *_ in LAYOUTS])
def test_changed_configuration_keeps_everything_else(before: str, after: str) -> None:
    assert edited(before) == after
    found = read_yaml(Source("", after, after.encode())).data["configurations"]["assembled"]
    assert found == {"a": 0.5, "b": [0, 0, 0, 1]}


@pytest.mark.parametrize(
    "text",
    [
        HEAD + "x-c: &c {r: {}}\nconfigurations: *c\n",
        HEAD + "configurations:\n  assembled: &c {a: 1}\n  r: *c\n",
        HEAD + "configurations: {assembled: {a: &a 1}, r: {a: *a}}\n",
        HEAD + "configurations:\n  ? r\n  : {}\n",
        HEAD + "configurations: {assembled: {a: 0, c: 1}}\n",
    ],
    ids=["an alias", "an anchor", "an anchor of a number", "marks of keys", "a joint that is not stated"],
)
def test_uneditable_configuration_is_refused(text: str) -> None:
    with pytest.raises(NotEditable):
        edited(text)


def test_many_joints_get_one_line_each() -> None:
    joints = {f"joint_of_the_leg_{index}": (float(index) / 7,) for index in range(8)}
    lines = [
        f"    {name}: {value!r}\n".replace(": 0.0", ": 0").replace("1.0\n", "1\n") for name, (value,) in joints.items()
    ]
    expected = HEAD + "configurations:\n  assembled:\n" + "".join(lines)
    assert edited(HEAD, joints) == expected
    assert edited(HEAD + "configurations:\n  assembled: {}\n", joints) == expected


numbers = st.floats(allow_nan=False, allow_infinity=False)
names = st.text(st.characters(exclude_categories=["Cs"]), min_size=1)


@pytest.mark.slow
@settings(max_examples=200, deadline=None)
@given(
    coordinates=st.dictionaries(names, st.lists(numbers, min_size=1, max_size=7), min_size=1),
    before=st.sampled_from([layout[1] for layout in LAYOUTS if "assembled" not in layout[1]]),
)
def test_numbers_and_names_survive_round_trip(coordinates: dict[str, list[float]], before: str) -> None:
    after = edited(before, coordinates)
    expected = {name: values[0] if len(values) == 1 else values for name, values in coordinates.items()}
    assert read_yaml(Source("", after, after.encode())).data["configurations"]["assembled"] == expected
    if before.isascii() and not before.startswith("{"):
        assert yaml.safe_load(after)["configurations"]["assembled"] == expected  # to parsers of YAML 1.1 too
