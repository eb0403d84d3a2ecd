"""The cases as they are on disk."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass
from functools import cache, cached_property
from importlib.util import find_spec
from pathlib import Path

import yaml
from pydantic import ValidationError

from eurdf_conformance.corpus.case import CASE, TOPICS, Case, ValidCase
from eurdf_conformance.corpus.expected import EXPECTED_FILE, Expected, read_expected
from eurdf_conformance.level import Level
from eurdf_conformance.level_spec import Compared, levels_comparing
from eurdf_conformance.strict_yaml import load_strictly

CASES = Path(__file__).with_name("cases")
CASE_FILE = "case.yaml"


class NotACase(Exception):  # noqa: N818 - it says what the file is
    """A `case.yaml` that says no case.

    Attributes:
        path: The file.
        why: What is wrong with it, one line a fault.
    """

    def __init__(self, path: Path, why: str) -> None:
        super().__init__(f"{path}: {why}")
        self.path = path
        self.why = why


@dataclass(frozen=True)
class CorpusCase:
    """A case and its files.

    Attributes:
        case: What `case.yaml` says.
        topic: Name of the folder of its topic.
        folder: Where `case.yaml` and `expected.json` are.
        files: Where the robot's two files are.
    """

    case: Case
    topic: str
    folder: Path
    files: Path

    @property
    def id(self) -> str:
        """Its permanent id."""
        return self.case.id

    @property
    def path(self) -> str:
        """Topic and id, which name it among the cases."""
        return f"{self.topic}/{self.id}"

    @cached_property
    def description(self) -> Path:
        """Path of the YAML file."""
        return self.files / self.case.description

    @cached_property
    def urdf(self) -> Path:
        """Path of the URDF that the description names, whether it exists or not."""
        return self.files / self.case.urdf

    @cached_property
    def expected(self) -> Expected:
        """What is expected of a valid case."""
        return read_expected(self.folder / EXPECTED_FILE)

    @property
    def levels(self) -> tuple[Level, ...]:
        """The levels at which it is tested."""
        if not isinstance(self.case, ValidCase):
            return levels_comparing(Compared.OUTCOME, Compared.ISSUES)
        evaluated = (Compared.VALUES,) if self.case.configurations else ()
        return levels_comparing(Compared.OUTCOME, Compared.ROBOT, *evaluated, Compared.ISSUES)


def read_case(folder: Path) -> CorpusCase:
    """The case of a folder.

    Raises:
        NotACase: Its `case.yaml` says none.
    """
    path = folder / CASE_FILE
    try:
        case = CASE.validate_python(load_strictly(path.read_text(encoding="utf-8")))
    except (OSError, UnicodeDecodeError, yaml.YAMLError) as error:
        raise NotACase(path, str(error)) from None
    except ValidationError as error:
        why = "\n".join(f"{'/'.join(map(str, each['loc'][1:])) or '-'}: {each['msg']}" for each in error.errors())
        raise NotACase(path, why) from None
    return CorpusCase(case, folder.parent.name, folder, _files(case, path))


def read_cases(root: Path = CASES) -> list[CorpusCase]:
    """All cases, in the order of topics and then of ids.

    Raises:
        NotACase: One of them is none.
    """
    return [read_case(folder) for folder in case_folders(root)]


@cache
def all_cases() -> tuple[CorpusCase, ...]:
    """The cases of the suite, read once a process."""
    return tuple(read_cases())


def case_folders(root: Path = CASES) -> Iterator[Path]:
    """The folders of cases, in the order of topics and then of ids."""
    for topic in TOPICS:
        yield from sorted(path.parent for path in (root / topic).glob(f"*/{CASE_FILE}"))


def collection_folder() -> Path | None:
    """The robots of the collection: at the root of a checkout, or in the installed package `eurdf`, not imported."""
    beside = Path(__file__).parents[2]
    if beside.name == "conformance" and (beside.parent / "robots").is_dir():
        return beside.parent / "robots"
    spec = find_spec("eurdf")
    for place in (spec.submodule_search_locations or ()) if spec else ():
        if (installed := Path(place) / "collection" / "robots").is_dir():
            return installed
    return None


def _files(case: Case, path: Path) -> Path:
    if case.robot is None:
        return path.parent
    home = collection_folder()
    if home is None or not (home / case.robot).is_dir():
        raise NotACase(path, f"robot: the collection has no '{case.robot}'")
    return home / case.robot
