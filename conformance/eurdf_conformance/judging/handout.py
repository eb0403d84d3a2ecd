"""The files of a case as a parser receives them: alone in a fresh folder whose name has no meaning."""

from __future__ import annotations

import shutil
import tempfile
import weakref
from pathlib import Path

from eurdf_conformance.corpus.read import CorpusCase


class Handout:
    """Writes the files of one case at a time; those of the case before are removed.

    Neither the path nor a neighbouring file says which case it is or what is expected.

    Attributes:
        folder: The folder of the current case, or None if there is none.
    """

    def __init__(self) -> None:
        self.folder: Path | None = None
        self._removal: weakref.finalize[..., Handout] | None = None

    def files(self, case: CorpusCase) -> tuple[Path, Path]:
        """Write the files of a case into a fresh folder; the paths of its description and its URDF."""
        if self._removal is not None:
            self._removal()
        self.folder = Path(tempfile.mkdtemp(prefix="")).resolve()
        self._removal = weakref.finalize(self, shutil.rmtree, self.folder, ignore_errors=True)
        case.write(self.folder)
        return self.folder / case.case.description, self.folder / case.case.urdf
