"""A call of a prepared transmission, in Python and in C, beside `eurdf.residual_and_jacobian` and `sin` of ``math.h``.

Each call goes to another pose, anywhere in the workspace, and returns positions, G and its inverse. The time in C is
that of a loop of calls, compiled by ``cc -O2``.
"""

from __future__ import annotations

import itertools
import subprocess
import tempfile
from collections.abc import Callable
from pathlib import Path
from typing import Literal

import numpy as np

import eurdf
from benchmarks.interleaved import least_times

_ROBOTS = {
    "unitree_g1_ankle": ("free_pitch", "free_roll"),
    "tesla_optimus_ankle": ("free_pitch", "free_roll"),
    "digit_leg": ("free_foot1", "free_foot2"),
    "kangaroo_leg": ("free_knee", "free_ankle_y", "free_ankle_x"),
}
_ROUNDS = 200

_MAIN = """
#include "t.h"
#include <math.h>
#include <stdio.h>
#include <time.h>
static const {real} joints[][{n}] = {{{joints}}};
static double least(double least, clock_t begin, int calls) {{
    const double time = (double)(clock() - begin) / CLOCKS_PER_SEC / calls;
    return time < least ? time : least;
}}
int main(void) {{
    const int count = sizeof joints / sizeof joints[0];
    {real} motors[{m}], G[{m} * {n}], B[{m} * {n}];
    double call = 1e9, sine = 1e9;
    volatile double sum = 0.0;
    t_pose pose;
    int status = 0;
    t_start(&pose);
    for (int part = 0; part < {rounds}; ++part) {{
        clock_t begin = clock();
        for (int k = 0; k < count; ++k) status |= t_at_joints(&pose, joints[k], motors, G, B);
        call = least(call, begin, count);
        begin = clock();
        for (int k = 0; k < 100 * count; ++k) sum += sin(0.01 * k);
        sine = least(sine, begin, 100 * count);
    }}
    printf("%d %.9g %.9g\\n", status, call, sine);
    return 0;
}}
"""


def main() -> None:
    """Print a table of the least processor times."""
    print(f"{'robot':20} {'r and K':>9} {'Python':>9} {'C':>9} {'C, float':>9} {'sin':>9}")
    for name, joints in _ROBOTS.items():
        robot = eurdf.load(name, geometry=False)
        prepared = eurdf.transmissions.prepare_transmission(robot, joints)
        found = eurdf.transmissions.workspace(robot, joints, grid=13 if len(joints) < 3 else 7)
        positions = np.random.default_rng(0).permutation(found.positions)
        K, called = least_times((_evaluated(robot, prepared.q), _moving(prepared, positions)), 200)
        in_c, sine = c_time(prepared, positions, "double")
        in_float, _ = c_time(prepared, positions, "float")
        times = " ".join(f"{1e6 * time:6.2f} µs" for time in (K, called, in_c, in_float))
        print(f"{name:20} {times} {1e9 * sine:6.1f} ns")


def _evaluated(robot: eurdf.Robot, q: np.ndarray) -> Callable[[], object]:
    return lambda: eurdf.residual_and_jacobian(robot, q)


def _moving(prepared: eurdf.transmissions.PreparedTransmission, positions: np.ndarray) -> Callable[[], object]:
    each = itertools.cycle(positions)
    return lambda: prepared.at_joints(next(each))


def c_time(
    prepared: eurdf.transmissions.PreparedTransmission, positions: np.ndarray, real: Literal["double", "float"]
) -> tuple[float, float]:
    """Seconds of a call, and of one of `sin`."""
    with tempfile.TemporaryDirectory() as folder:
        prepared.c_source("t", real=real).write(folder)
        table = ", ".join("{" + ", ".join(map(repr, row)) + "}" for row in positions.tolist())
        numbers = {"n": len(prepared.joints), "m": len(prepared.motors), "real": real, "rounds": _ROUNDS}
        main_file, program = Path(folder, "main.c"), Path(folder, "main")
        main_file.write_text(_MAIN.format(joints=table, **numbers), encoding="utf-8")
        compiled = ["cc", "-std=c99", "-O2", "-o", str(program), str(main_file), str(Path(folder, "t.c")), "-lm"]
        subprocess.run(compiled, check=True)
        status, time, sine = subprocess.run([program], check=True, capture_output=True, text=True).stdout.split()
    if status != "0":
        raise SystemExit(f"a call returned the status {status}")
    return float(time), float(sine)
