"""A release of the corpus: its files, and the version and the hash that a certificate names."""

from __future__ import annotations

import hashlib
from collections.abc import Iterable, Iterator, Mapping
from contextlib import suppress
from importlib.metadata import PackageNotFoundError, version
from itertools import chain

from eurdf_conformance.corpus.case import ValidCase
from eurdf_conformance.corpus.read import CorpusCase, all_cases

#: Folder of the cases in a release: as deep as here, so that the path of its schema in a case leads there.
CASES_FOLDER = "cases"

#: The distributions that the suite is installed with: its own, and in a checkout that of the reference, of one version.
_DISTRIBUTIONS = ("eurdf-conformance", "eurdf")


def suite_version() -> str:
    """The version of the installed suite, which is that of its corpus."""
    for name in _DISTRIBUTIONS[:-1]:
        with suppress(PackageNotFoundError):
            return version(name)
    return version(_DISTRIBUTIONS[-1])


def case_files(case: CorpusCase) -> Iterator[tuple[str, bytes]]:
    """Every file of a case, by its name in a release."""
    home = f"{CASES_FOLDER}/{case.name}"
    yield f"{home}.yaml", case.path.read_bytes()
    if isinstance(case.case, ValidCase):
        yield f"{home}.expected.json", case.expectation.read_bytes()
    for name, content in case.files.items():
        yield f"{home}/{name}", content


def corpus_hash(cases: Iterable[CorpusCase] | None = None) -> str:
    """Hash of the files of cases, in any order; of all cases by default."""
    return files_hash(dict(chain.from_iterable(map(case_files, all_cases() if cases is None else cases))))


def files_hash(files: Mapping[str, bytes]) -> str:
    """Hash of files by name: the hash of the sorted lines with the hash and the name of each file."""
    lines = sorted(f"{_sha256(content)}  {name}\n" for name, content in files.items())
    return f"sha256:{_sha256(''.join(lines).encode())}"


def _sha256(content: bytes) -> str:
    return hashlib.sha256(content).hexdigest()
