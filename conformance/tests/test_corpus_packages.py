"""The data packages of the corpus, and what their README says."""

from __future__ import annotations

import json
import re
import shutil
import subprocess
from pathlib import Path

import pytest
from jsonschema import Draft202012Validator

from eurdf_conformance.corpus import archive, packages
from eurdf_conformance.corpus.read import suite_cases
from eurdf_conformance.corpus.release import corpus_hash, suite_version

NODE, NPM = shutil.which("node"), shutil.which("npm")
VALID = ("urdf/smallest", "robots/four-bar-v1")
INVALID = ("frames/closure-at-unknown-frame", "urdf/damping-fortran-exponent")
EITHER = "inertia/massless-leaf"


@pytest.fixture(scope="module")
def made(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """The folders of the packages of a few cases."""
    folder = tmp_path_factory.mktemp("corpus")
    archive.write_archive(folder, [suite_cases()[name] for name in (*VALID, *INVALID, EITHER)])
    assert packages.main([str(folder / f"{archive.NAME}.zip"), str(folder / "out")]) == 0
    return folder / "out"


def files(folder: Path) -> dict[str, bytes]:
    return {path.relative_to(folder).as_posix(): path.read_bytes() for path in folder.rglob("*") if path.is_file()}


def block(readme: Path, language: str) -> str:
    """The example of a README in a language."""
    (found,) = re.findall(rf"^```{language}\n(.*?)^```$", readme.read_text(encoding="utf-8"), re.MULTILINE | re.DOTALL)
    return str(found)


def test_packages_contain_the_archive_in_its_version(made: Path) -> None:
    archived = packages.read_archive(made.parent / f"{archive.NAME}.zip")
    npm, python = files(made / "npm"), files(made / "python")
    package = json.loads(npm.pop("package.json"))
    assert npm == archived
    assert archived.items() == {
        (name.removeprefix("eurdf_corpus/"), content)
        for name, content in python.items()
        if name.startswith("eurdf_corpus/") and name != "eurdf_corpus/__init__.py"
    }
    (pattern,) = re.findall(r"^pattern = '(.*)'$", python["pyproject.toml"].decode(), re.MULTILINE)
    found = re.search(pattern, python["eurdf_corpus/index.json"].decode())
    assert found is not None
    assert package["version"] == found["version"] == suite_version()
    assert f'name = "{package["name"]}"' in python["pyproject.toml"].decode()
    assert package["name"] == archive.NAME


def test_schemas_describe_the_json_files_and_nothing_else(made: Path) -> None:
    index, expected = (
        Draft202012Validator(json.loads((made / "npm" / f"{name}.schema.json").read_bytes()))
        for name in ("index", "expected")
    )
    listed = json.loads((made / "npm" / "index.json").read_bytes())
    index.validate(listed)
    values = [json.loads((made / "npm" / "cases" / f"{name}.expected.json").read_bytes()) for name in VALID]
    for value in values:
        expected.validate(value)
    for entry in listed["cases"]:
        wrong = {**entry, "case": {key: each for key, each in entry["case"].items() if key != "clauses"}}
        assert not index.is_valid({**listed, "cases": [wrong]})
        wrong = {**entry, "case": {**entry["case"], "edits": []}}
        assert not index.is_valid({**listed, "cases": [wrong]})
    assert not expected.is_valid({key: each for key, each in values[0].items() if key != "robot"})


def test_command_of_the_readme_computes_the_hash_of_certificates(made: Path) -> None:
    index = json.loads((made / "npm" / "index.json").read_bytes())
    assert index["corpus"] == corpus_hash([suite_cases()[entry["name"]] for entry in index["cases"]])
    command = block(made / "npm" / "README.md", "sh")
    done = subprocess.run(["sh", "-c", command], cwd=made / "npm", capture_output=True, text=True, check=True)
    assert f"sha256:{done.stdout.split()[0]}" == index["corpus"]


@pytest.mark.skipif(NODE is None, reason="Node.js is not installed")
def test_runner_of_the_readme_finds_wrong_answers(made: Path, tmp_path: Path) -> None:
    source = block(made / "npm" / "README.md", "js")
    assert source.count("\n") <= 30
    (tmp_path / "accept.mjs").write_text(source, encoding="utf-8")
    (tmp_path / "node_modules").mkdir()
    (tmp_path / "node_modules" / archive.NAME).symlink_to(made / "npm")

    def wrong(program: str) -> set[str]:
        command = [str(NODE), "accept.mjs", "sh", "-c", program, "parser"]
        done = subprocess.run(command, cwd=tmp_path, capture_output=True, text=True, check=False)
        *lines, summary = done.stdout.splitlines()
        assert done.stderr == ""
        assert summary == f"corpus {suite_version()}: {5 - len(lines)} of 5 right"
        assert done.returncode == bool(lines)
        return {line.partition(":")[0] for line in lines}

    assert wrong("true") == set(INVALID)
    assert wrong("false") == set(VALID)
    # A parser that sees the files and the version: of the valid cases it accepts the one of version 1.
    assert wrong('test -f "$1" && test -f "$2" && test "$3" = 1') == {VALID[0]}


@pytest.mark.slow
@pytest.mark.skipif(NPM is None, reason="npm is not installed")
def test_npm_packs_every_file(made: Path) -> None:
    done = subprocess.run([str(NPM), "pack", "--dry-run", "--json"], cwd=made / "npm", capture_output=True, check=True)
    (packed,) = json.loads(done.stdout)
    assert {each["path"] for each in packed["files"]} == set(files(made / "npm"))


def test_packages_are_made_of_an_archive_in_an_empty_folder(
    made: Path, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    zipped, text = made.parent / f"{archive.NAME}.zip", tmp_path / "text"
    text.write_text("no zip", encoding="utf-8")
    before = files(made)
    for source, out, why in (
        (zipped, made, "it is not empty"),
        (text, tmp_path / "out", "is not a zip file"),
        (tmp_path / "none", tmp_path / "out", "No such file"),
        (zipped, text, "Not a directory"),
    ):
        assert packages.main([str(source), str(out)]) == 2
        written = capsys.readouterr()
        assert why in written.err
        assert (written.out, written.err.count("\n")) == ("", 1)
    assert files(made) == before
    assert not (tmp_path / "out").exists()
