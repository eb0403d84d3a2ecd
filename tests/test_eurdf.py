"""The names of the package: each is there, and looking at the package loads no simulator."""

from __future__ import annotations

import inspect
import re
import subprocess
import sys

import numpy as np
import pytest

import eurdf
from support.places import ROBOTS
from support.public import MODULES, public_functions, public_names


def test_every_public_name_loads() -> None:
    assert len(public_names()) > 100
    assert dir(eurdf) == sorted(eurdf.__all__)


#: Public functions that take several names or folders, each called with one alone and with a list of it.
TAKE_NAMES = {
    "assemble": lambda given: eurdf.assemble(four_bar(), np.array([0.0, 1.0, 0.0, 0.0, 1.0]), hold=given).q,
    "lock": lambda given: eurdf.lock(four_bar(), given).locked_joints,
    "check": lambda given: len(eurdf.check("four_bar", package_dirs=given).diagnostics),
    "explain": lambda given: len(eurdf.explain("four_bar", package_dirs=given).topics),
    "migrate": lambda given: len(eurdf.migrate("four_bar", package_dirs=given).text),
    "load": lambda given: eurdf.load("four_bar", package_dirs=given).model.nq,
    "export": lambda given: eurdf.export("four_bar", "mjcf", package_dirs=given).coordinates.nq,
    "simplify": lambda given: eurdf.simplify("four_bar", package_dirs=given).before.nv,
    "joint_values": lambda given: len(
        eurdf.transmissions.joint_values(four_bar(), {"motor_crank": 1.0}, joints=given).values
    ),
    "generate": lambda given: eurdf.generate(str(ROBOTS / "four_bar" / "robot.urdf"), motors=given).found.motors,
    "inverse_kinematics": lambda given: (
        eurdf.inverse_kinematics(four_bar(), {"coupler": [0.1, 0.1, 0.0]}, hold=given, restarts=0).q
    ),
    "impedance_map": lambda given: eurdf.transmissions.impedance_map(four_bar(), given, None, [1.0]).motor_stiffness[
        0, 0
    ],
    "calibrate": lambda given: eurdf.kinematics.calibrate(four_bar(), {"motor_crank": [0.1]}, given).offsets[
        "motor_crank"
    ],
    "reflected_inertia": lambda given: eurdf.transmissions.reflected_inertia(four_bar(), given).total[0, 0],
    "serial_limits": lambda given: eurdf.transmissions.serial_limits(four_bar(), given).torque_box[0],
    "transmission": lambda given: eurdf.transmission(four_bar(), given).joints == ("motor_crank",),
    "workspace": lambda given: (
        eurdf.transmissions.workspace(four_bar(), given, grid=3, ranges={"motor_crank": (-0.1, 0.1)}).joints
        == ("motor_crank",)
    ),
    "serial_twin": lambda given: (
        eurdf.transmissions.serial_twin(four_bar(), given, grid=5, ranges={"motor_crank": (-0.1, 0.1)}).joints
        == ("motor_crank",)
    ),
    "prepare_transmission": lambda given: (
        eurdf.transmissions.prepare_transmission(four_bar(), given).joints == ("motor_crank",)
    ),
}


def four_bar() -> eurdf.Robot:
    return eurdf.load("four_bar", geometry=False)


@pytest.mark.parametrize("name", TAKE_NAMES)
def test_single_name_is_accepted(name: str) -> None:
    one, listed = TAKE_NAMES[name]("motor_crank"), TAKE_NAMES[name](["motor_crank"])
    assert one == pytest.approx(listed, abs=1e-9)


def test_no_other_public_function_takes_several_names() -> None:
    takes = set()
    for name, function in public_functions().items():
        annotations = [str(each.annotation) for each in inspect.signature(function).parameters.values()]
        if any(re.search(r"(Iterable|Sequence|Collection|list|set|tuple)\[str\b", each) for each in annotations):
            takes.add(name)
    assert takes == set(TAKE_NAMES)


def test_unknown_name_raises_attribute_error() -> None:
    assert not hasattr(eurdf, "lood")


def test_import_loads_no_simulator() -> None:
    modules = ", ".join(f"eurdf.{name}" for name in MODULES if name not in ("batch", "springs"))
    code = f"import sys, eurdf, {modules}; eurdf.Mechanism, dir(eurdf); assert 'pinocchio' not in sys.modules"
    subprocess.run([sys.executable, "-c", code], check=True)
