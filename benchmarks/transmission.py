"""A call of a prepared transmission, in Python and in C, against one `eurdf.residual_and_jacobian`.

The joints move to and fro about the assembled pose by a step at each call. The time in C is that of a loop of calls,
compiled by ``cc -O2``.
"""

from __future__ import annotations

import itertools
import math
import subprocess
import tempfile
from collections.abc import Callable
from pathlib import Path

import numpy as np

import eurdf
from benchmarks.interleaved import least_times

_ROBOTS = {
    "unitree_g1_ankle": ("free_pitch", "free_roll"),
    "tesla_optimus_ankle": ("free_pitch", "free_roll"),
    "digit_leg": ("free_foot1", "free_foot2"),
    "kangaroo_leg": ("free_knee", "free_ankle_y", "free_ankle_x"),
}
_STEPS = (1e-4, 1e-3, 1e-2)  # rad
_CALLS = 100_000

_MAIN = """
#include "t.h"
#include <math.h>
#include <stdio.h>
#include <time.h>
int main(void) {{
    const double start[] = {{{start}}};
    double joints[{n}], motors[{m}], G[{m} * {n}], least = 1e9;
    t_pose pose;
    int status = 0;
    t_start(&pose);
    for (int part = 0; part < 20; ++part) {{
        const clock_t begin = clock();
        for (int k = 0; k < {calls} / 20; ++k) {{
            for (int j = 0; j < {n}; ++j) joints[j] = start[j] + {step} * sin(k + j);
            status |= t_at_joints(&pose, joints, motors, G);
        }}
        const double time = (double)(clock() - begin) / CLOCKS_PER_SEC / ({calls} / 20);
        if (time < least) least = time;
    }}
    printf("%d %.9g\\n", status, least);
    return 0;
}}
"""


def main() -> None:
    """Print a table of the least processor times."""
    print(f"{'robot':20} {'step':>6} {'r and K':>9} {'Python':>9} {'ratio':>6} {'C':>9}")
    for name, joints in _ROBOTS.items():
        robot = eurdf.load(name, geometry=False)
        prepared = eurdf.transmissions.prepare_transmission(robot, joints)
        start = np.concatenate([robot.joint_positions(prepared.q)[joint] for joint in joints])
        for step in _STEPS:
            calls = (_evaluated(robot, prepared.q), _moving(prepared, start, step))
            K, called = (1e6 * time for time in least_times(calls, 200))
            in_c = 1e6 * _c_time(prepared, start, step)
            print(f"{name:20} {step:6g} {K:6.1f} µs {called:6.1f} µs {called / K:6.2f} {in_c:6.2f} µs")


def _evaluated(robot: eurdf.Robot, q: np.ndarray) -> Callable[[], object]:
    return lambda: eurdf.residual_and_jacobian(robot, q)


def _moving(prepared: eurdf.transmissions.PreparedTransmission, start: np.ndarray, step: float) -> Callable[[], object]:
    count = itertools.count()
    phases = np.arange(len(start))
    return lambda: prepared.at_joints(start + step * np.sin(next(count) + phases))


def _c_time(prepared: eurdf.transmissions.PreparedTransmission, start: np.ndarray, step: float) -> float:
    """Seconds a call."""
    with tempfile.TemporaryDirectory() as folder:
        prepared.c_source("t").write(folder)
        numbers = {"n": len(prepared.joints), "m": len(prepared.motors), "step": step, "calls": _CALLS}
        text = _MAIN.format(start=", ".join(map(repr, start.tolist())), **numbers)
        main_file, program = Path(folder, "main.c"), Path(folder, "main")
        main_file.write_text(text, encoding="utf-8")
        compiled = ["cc", "-std=c99", "-O2", "-o", str(program), str(main_file), str(Path(folder, "t.c")), "-lm"]
        subprocess.run(compiled, check=True)
        status, time = subprocess.run([program], check=True, capture_output=True, text=True).stdout.split()
    return float(time) if status == "0" else math.nan
