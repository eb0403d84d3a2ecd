"""Generated C, compiled and called."""

from __future__ import annotations

import ctypes
import shutil
import subprocess
from pathlib import Path
from typing import Any

import numpy as np
import numpy.typing as npt
import pytest

from eurdf.transmissions.prepared import PreparedTransmission

Vector = npt.NDArray[np.float64]

OK, NOT_CLOSED, TOO_FAR, SINGULAR, NOT_FINITE = range(5)


class Compiled:
    """The C of a prepared transmission, at the pose that it was generated at; options are those of `c_source`.

    In single precision, no number may become one of double precision on the way.
    """

    def __init__(self, prepared: PreparedTransmission, folder: Path, **options: Any) -> None:
        compiler = shutil.which("cc")
        if compiler is None:
            pytest.skip("no C compiler: install one as `cc`")
        prepared.c_source("t", **options).write(folder, force=True)
        strict = ["-std=c99", "-O2", "-Wall", "-Wextra", "-pedantic", "-Werror", "-Wdouble-promotion"]
        strict.append("-Wfloat-conversion")
        self._real = np.float32 if options.get("real") == "float" else np.float64
        library = folder / f"{len(list(folder.glob('*.so')))}.so"  # a library that is loaded is not replaced
        subprocess.run(
            [compiler, *strict, "-shared", "-fPIC", "-o", str(library), str(folder / "t.c"), "-lm"], check=True
        )
        self._library = ctypes.CDLL(str(library))
        self._joints, self._motors = len(prepared.joints), len(prepared.motors)
        self.pose = np.zeros(200, self._real)
        self.start()

    def start(self) -> None:
        """Go to the pose that it was generated at."""
        self._library.t_start(_pointer(self.pose))

    def start_at_joints(self, positions: Vector) -> int:
        """Start at positions of the joints; the status."""
        return self._start(self._library.t_start_at_joints, positions)

    def start_at_motors(self, positions: Vector) -> int:
        """Start at positions of the motors; the status."""
        return self._start(self._library.t_start_at_motors, positions)

    def at_joints(self, positions: Vector) -> tuple[int, Vector, Vector]:
        """Status, positions of the motors and G."""
        return self._call(self._library.t_at_joints, positions, self._motors)[:3]

    def at_motors(self, positions: Vector) -> tuple[int, Vector, Vector]:
        """Status, positions of the joints and B."""
        return self._call(self._library.t_at_motors, positions, self._joints)[:3]

    def all_at_joints(self, positions: Vector) -> tuple[int, Vector, Vector, Vector]:
        """As `at_joints`, and B."""
        return self._call(self._library.t_at_joints, positions, self._motors, inverse=True)

    def all_at_motors(self, positions: Vector) -> tuple[int, Vector, Vector, Vector]:
        """As `at_motors`, and G."""
        return self._call(self._library.t_at_motors, positions, self._joints, inverse=True)

    def _start(self, function: ctypes._CFuncPtr, positions: Vector) -> int:
        return int(function(_pointer(self.pose), _pointer(np.array(positions, self._real))))

    def _call(
        self, function: ctypes._CFuncPtr, positions: Vector, count: int, inverse: bool = False
    ) -> tuple[int, Vector, Vector, Vector]:
        given = np.array(positions, self._real)
        found, derivative = np.full(count, np.nan, self._real), np.full((count, len(given)), np.nan, self._real)
        other = np.full((len(given), count), np.nan, self._real)
        pointers = map(_pointer, (self.pose, given, found, derivative))
        status = function(*pointers, _pointer(other) if inverse else None)
        return status, found, derivative, other


def _pointer(array: npt.NDArray[Any]) -> ctypes.c_void_p:
    return array.ctypes.data_as(ctypes.c_void_p)
