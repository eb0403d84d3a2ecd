"""Reads the cases: ``cases/<topic>/<name>.yaml`` describes a case and how its files are made."""

from __future__ import annotations

import shutil
import tempfile
import weakref
from collections.abc import Iterator, Mapping
from dataclasses import dataclass, field
from functools import cache, cached_property
from pathlib import Path

import yaml
from pydantic import ValidationError

from eurdf_conformance.corpus.case import CASE, TOPICS, Case, ExpectedWarning, InvalidCase, ValidCase
from eurdf_conformance.corpus.content import content_bytes, edited
from eurdf_conformance.corpus.expected import Expected, read_expected
from eurdf_conformance.corpus.features import features_of_files, features_of_robot
from eurdf_conformance.feature import Feature
from eurdf_conformance.level import Level
from eurdf_conformance.level_spec import Compared, levels_comparing
from eurdf_conformance.strict_yaml import load_strictly

CASES = Path(__file__).with_name("cases")


class NotACase(Exception):  # noqa: N818 - it says what the file is
    """A file that does not describe a case.

    Attributes:
        path: The file.
        why: What is wrong with it, one error a line.
    """

    def __init__(self, path: Path, why: str) -> None:
        super().__init__(f"{path}: {why}")
        self.path = path
        self.why = why


class Cases(dict[str, "CorpusCase"]):
    """The cases of a folder by topic and name; each is read when requested.

    Attributes:
        made: Where their files are written; where nothing is said, a folder that is removed with the cases.
    """

    def __init__(self, root: Path) -> None:
        super().__init__()
        self._root = root
        self.made: Path | None = None

    def __missing__(self, name: str) -> CorpusCase:
        self[name] = case = _read(self._root / f"{name}.yaml", name, self)
        return case

    def folder(self, name: str) -> Path:
        """The folder for the files of a case."""
        if self.made is None:
            self.made = Path(tempfile.mkdtemp(prefix="eurdf-cases-"))
            weakref.finalize(self, shutil.rmtree, self.made, ignore_errors=True)
        return self.made / name


@dataclass(frozen=True)
class CorpusCase:
    """A case and its files.

    Attributes:
        case: What its file says.
        name: Topic and name: ``urdf/damping-fortran-exponent``.
        path: Its file.
    """

    case: Case
    name: str
    path: Path
    _others: Cases = field(repr=False, compare=False)

    @property
    def id(self) -> str:
        """Its permanent id."""
        return self.case.id

    @property
    def topic(self) -> str:
        """Name of the folder that contains it."""
        return self.path.parent.name

    @property
    def origin(self) -> CorpusCase | None:
        """The case that its files are made from: the twin of an invalid case, the base of a valid one.

        Raises:
            NotACase: There is no such case.
        """
        name = self.case.twin if isinstance(self.case, InvalidCase) else self.case.base
        if name is None:
            return None
        try:
            found = self._others[name]
        except NotACase as error:
            raise NotACase(self.path, f"there is no case {name}" if not error.path.exists() else str(error)) from None
        if isinstance(found.case, InvalidCase):
            raise NotACase(self.path, f"{name} is not valid")
        if isinstance(self.case, ValidCase) and found.case.base is not None:
            raise NotACase(self.path, f"{name} has a base itself")
        return found

    @cached_property
    def files(self) -> Mapping[str, bytes]:
        """The contents of its files, by path relative to its folder.

        Raises:
            NotACase: The file of the case does not say what they are.
        """
        files = {} if (origin := self.origin) is None else dict(origin.files)
        try:
            for edit in [self.case.edit] if isinstance(self.case, InvalidCase) else self.case.edits:
                files = edited(files, edit)
        except ValueError as error:
            raise NotACase(self.path, str(error)) from None
        if isinstance(self.case, ValidCase):
            files |= {name: content_bytes(content) for name, content in self.case.files.items()}
        return files

    @cached_property
    def folder(self) -> Path:
        """A folder with its files, which are written at the first request."""
        folder = self._others.folder(self.name)
        self.write(folder)
        return folder

    def write(self, folder: Path) -> None:
        """Write its files into a folder, which is created if necessary."""
        for name, content in self.files.items():
            path = folder / name
            path.parent.mkdir(parents=True, exist_ok=True)
            path.write_bytes(content)

    @property
    def description(self) -> Path:
        """Path of the YAML file."""
        return self.folder / self.case.description

    @property
    def urdf(self) -> Path:
        """Path of the URDF that the description names, whether it exists or not."""
        return self.folder / self.case.urdf

    @property
    def expectation(self) -> Path:
        """The file with the expectation of a valid case."""
        return self.path.with_suffix(".expected.json")

    @cached_property
    def expected(self) -> Expected:
        """The expectation of a valid case."""
        return read_expected(self.expectation)

    @cached_property
    def features(self) -> frozenset[Feature]:
        """The features that its files use; those of an invalid case use them with its error or without it."""
        stated = features_of_files(self.files.get(self.case.description, b""), self.files.get(self.case.urdf, b""))
        if isinstance(self.case, ValidCase):
            return stated | features_of_robot(self.expected.robot)
        return stated if self.origin is None else stated | self.origin.features

    @property
    def warnings(self) -> tuple[ExpectedWarning, ...]:
        """The warnings that a parser reports on a valid case, and may report beside the error of an invalid one."""
        if isinstance(self.case, ValidCase):
            return tuple(self.case.warnings)
        origin = self.origin
        return () if origin is None else origin.warnings

    @property
    def levels(self) -> tuple[Level, ...]:
        """The levels at which it is tested."""
        if not isinstance(self.case, ValidCase):
            return levels_comparing(Compared.OUTCOME, Compared.ISSUES)
        evaluated = (Compared.VALUES,) if self.case.configurations else ()
        return levels_comparing(Compared.OUTCOME, Compared.ROBOT, *evaluated, Compared.ISSUES)


def _read(path: Path, name: str, others: Cases) -> CorpusCase:
    try:
        case = CASE.validate_python(load_strictly(path.read_text(encoding="utf-8")))
    except (OSError, UnicodeDecodeError, yaml.YAMLError) as error:
        raise NotACase(path, str(error)) from None
    except ValidationError as error:
        why = "\n".join(f"{'/'.join(map(str, each['loc'][1:])) or '-'}: {each['msg']}" for each in error.errors())
        raise NotACase(path, why) from None
    return CorpusCase(case, name, path, others)


def read_case(path: Path) -> CorpusCase:
    """The case in a file ``<topic>/<name>.yaml``; the cases it is made from are beside it.

    Raises:
        NotACase: The file does not describe a case.
    """
    return Cases(path.parents[1])[f"{path.parent.name}/{path.stem}"]


def read_cases(root: Path = CASES) -> list[CorpusCase]:
    """All cases, in the order of topics and then of names.

    Raises:
        NotACase: One of the files does not describe a case.
    """
    cases = Cases(root)
    return [cases[name] for name in case_names(root)]


@cache
def suite_cases() -> Cases:
    """The cases of the suite by name, each read when it is asked for."""
    return Cases(CASES)


@cache
def all_cases() -> tuple[CorpusCase, ...]:
    """The cases of the suite, read once per process."""
    return tuple(suite_cases()[name] for name in case_names())


def keep_files_in(folder: Path) -> None:
    """Write the files of the cases of the suite into a folder, where they stay when the process ends."""
    suite_cases().made = folder


def case_names(root: Path = CASES) -> Iterator[str]:
    """The topics and names of cases, in the order of topics and then of names."""
    for topic in TOPICS:
        yield from (f"{topic}/{path.stem}" for path in sorted((root / topic).glob("*.yaml")))
