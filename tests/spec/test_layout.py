"""A test file has the path of what it tests."""

from __future__ import annotations

from support.places import ROOT

#: Folders of tests that are about the repository, whole robots, what a contributor adds, and mistakes.
ELSEWHERE = {"mistakes", "recipes", "robots", "spec"}


def test_each_file_has_the_path_of_a_module_or_package() -> None:
    for file in (ROOT / "tests").rglob("test_*.py"):
        path = file.relative_to(ROOT / "tests")
        if path.parts[0] in ELSEWHERE:
            continue
        name = path.stem.removeprefix("test_")
        places = [folder / path.parent / name for folder in (ROOT, ROOT / "reference", ROOT / "reference" / "eurdf")]
        main = [place.parent / "__main__" for place in places if name == "main"]
        modules = [place.with_suffix(suffix) for place in places + main for suffix in (".py", ".js")]
        assert any(place.is_dir() for place in places) or any(module.is_file() for module in modules), file
