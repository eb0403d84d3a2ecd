"""Claims about MuJoCo."""

from __future__ import annotations

import mujoco
import numpy as np

from benchmarks.claims.captured import captured
from benchmarks.claims.expectation import expect
from benchmarks.claims.four_bar import BALL_JOINT, LOOPS, mjcf, with_elements, with_two_parents


def _error(text: str) -> str:
    """The error that the compiler raises; empty if it raises none."""
    try:
        mujoco.MjModel.from_xml_string(text)
    except ValueError as error:
        return str(error).splitlines()[0]
    return ""


def compiler_checks() -> str:
    """Unknown elements and impossible inertias."""
    unknown = _error(mjcf().replace("<worldbody>", "<no_such_element/><worldbody>"))
    impossible = _error(mjcf().replace('diaginertia="1e-5', 'diaginertia="1'))
    return expect(bool(unknown and impossible), f"{unknown or 'accepted'}; {impossible or 'accepted'}")


def pin_opens() -> str:
    """How far the pin opens in two seconds, with the default settings, under gravity in the plane of the linkage."""
    model = mujoco.MjModel.from_xml_string(mjcf(tail='<option gravity="0 -9.81 0"/>'))
    data = mujoco.MjData(model)
    sites = [mujoco.mj_name2id(model, mujoco.mjtObj.mjOBJ_SITE, name) for name in ("pin_on_coupler", "pin_on_rocker")]
    largest = 0.0
    for _ in range(round(2.0 / model.opt.timestep)):
        mujoco.mj_step(model, data)
        mujoco.mj_kinematics(model, data)
        largest = max(largest, float(np.linalg.norm(data.site_xpos[sites[0]] - data.site_xpos[sites[1]])))
    return expect(1.5e-3 < largest < 1.8e-3, f"{1e3 * largest:.2f} mm, with steps of {1e3 * model.opt.timestep:g} ms")


def loops_in_urdf() -> str:
    """The elements of each dialect in a URDF."""
    for dialect, elements in LOOPS.items():
        with captured() as printed:
            model = mujoco.MjModel.from_xml_string(with_elements(elements))
        expect(
            (model.nv, model.neq, printed.text) == (3, 0, ""), f"{dialect}: {model.neq} equalities; {printed.text!r}"
        )
    return expect(bool(_error(BALL_JOINT)), f"three open bars, nothing printed; a ball joint: {_error(BALL_JOINT)}")


def two_parents() -> str:
    """The loop as a second joint to the rocker."""
    errors = [_error(text) for text in with_two_parents()]
    return expect(all(errors), f"{sum(map(bool, errors))} of {len(errors)} rejected: {errors[0]}")
