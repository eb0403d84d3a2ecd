"""Call functions of the published code, in a process of its own: it may crash, print, and wait for a key.

The process reads a `request` as JSON from its standard input and answers each call with a line of JSON: its value, or
the error that it raised. It imports nothing of this project but the stand-in for Pinocchio's bindings of CasADi, so
that its Python may be that of an environment for the published code.

A call is an expression. It sees the functions of `toolbox_parallel_robots` and of the modules of
`example_parallel_robots`, `np`, `pin`, the arrays of the request, the loaded robot (`model`, `data`, `cms`, `cds`,
`am`, `visual`, `collision`), and the functions of this module.
"""

from __future__ import annotations

import builtins
import contextlib
import importlib
import io
import json
import os
import resource
import sys
import warnings
from types import ModuleType, SimpleNamespace
from typing import Any

import numpy as np
import pinocchio as pin
import yaml

#: Modules whose functions a call sees.
MODULES = (
    "toolbox_parallel_robots",
    "toolbox_parallel_robots.sliders.util_frames",
    "example_parallel_robots.loader_tools",
    "example_parallel_robots.vizutils",
)

#: Imported by these, but not used by what is called.
UNUSED = ("meshcat",)

#: Bound of its memory, bytes: what reads beyond an array may reserve any amount.
_MEMORY = 8 << 30


def with_calc(names: dict[str, Any]) -> str:
    """Fill the data of the closures, which Pinocchio 4 no longer does by itself."""
    for constraint, data in zip(names["cms"], names["cds"], strict=True):
        if hasattr(constraint, "calc"):
            constraint.calc(names["model"], names["data"], data)
    return ""


def jacobians(names: dict[str, Any], calc: bool = True) -> list[Any]:
    """The rows of K of each closure at `q`, by ``pin.getConstraintJacobian``."""
    model, data = names["model"], names["data"]
    pin.computeJointJacobians(model, data, names["q"])
    if calc:
        with_calc(names)
    pairs = zip(names["cms"], names["cds"], strict=True)
    return [pin.getConstraintJacobian(model, data, constraint, of) for constraint, of in pairs]


def completed(names: dict[str, Any]) -> Any:
    """Actuation model and data with the attributes that their code uses and does not set."""
    motors = names["am"]
    motors.nv_mot, motors.nv_free = len(motors.mot_ids_v), len(motors.free_ids_v)
    data = names["ActuationData"](names["model"], names["cms"], motors)
    motors.dq, motors.dq_no = data.dq, data.dq_no
    return data


def size_of(loaded: Any) -> list[int]:
    """Of what their loader returns: nv, rows of the closures, actuated velocities."""
    model, closures, actuation = loaded[:3]
    rows = sum(6 if closure.type == pin.ContactType.CONTACT_6D else 3 for closure in closures)
    return [model.nv, rows, len(actuation.mot_ids_v)]


def frozen(names: dict[str, Any]) -> Any:
    """The model that `freeze` makes where the first motor is locked at the neutral configuration."""
    keys = {"model": "model", "visual": "visual_model", "collision": "collision_model", "cms": "constraint_models"}
    robot = SimpleNamespace(**{name: names[key] for key, name in keys.items()}, q0=pin.neutral(names["model"]))
    names["freeze"](robot, [int(names["am"].mot_joints_ids[0])], rebuildData=False)
    return robot.model


def with_frames(names: str) -> Any:
    """A model of frames alone."""
    model = pin.Model()
    for name in names.split():
        model.addFrame(pin.Frame(name, 0, pin.SE3.Identity(), pin.FrameType.OP_FRAME))
    return model


def generated(folder: str) -> Any:
    """What `generateYAML` writes of a robot."""
    text = io.StringIO()
    importlib.import_module("example_parallel_robots.loader_tools").generateYAML(folder, file=text)
    return yaml.safe_load(text.getvalue())


def neutral_mass_matrix(model: Any) -> Any:
    """M at the neutral configuration."""
    M = pin.crba(model, model.createData(), pin.neutral(model))
    return np.triu(M) + np.triu(M, 1).T


def _replace_missing() -> None:
    try:
        importlib.import_module("pinocchio.casadi")
    except ImportError:
        sys.modules["pinocchio.casadi"] = pin.casadi = importlib.import_module("bindings")
    for name in UNUSED:
        try:
            importlib.import_module(name)
        except ImportError:
            sys.modules[name] = ModuleType(name)


def _functions() -> dict[str, Any]:
    _replace_missing()
    found: dict[str, Any] = {}
    for name in MODULES:
        found |= {key: value for key, value in vars(importlib.import_module(name)).items() if not key.startswith("_")}
    return found | {key: value for key, value in globals().items() if not key.startswith("_")}


def _robot(functions: dict[str, Any], request: dict[str, Any]) -> dict[str, Any]:
    """The robot, with the model of this project where it is installed, otherwise by their loader."""
    if request["loader"] == "eurdf":
        import eurdf

        robot = eurdf.load(request["folder"])
        model, cms, actuation, visual, collision = robot
        am = functions["ActuationModel"](model, list(actuation.joints))
    else:
        loaded = functions["completeRobotLoader"](request["folder"], name_yaml="robot.v1.yaml")
        model, cms, am, visual, collision = loaded
    names = {"model": model, "cms": list(cms), "am": am, "visual": visual, "collision": collision}
    names |= {"data": model.createData(), "cds": [constraint.createData() for constraint in cms]}
    names |= {"frame": model.getFrameId(request["frame"]), "frame_name": request["frame"]}
    names |= {"folder": request["folder"]}
    return names | {name: np.array(value) for name, value in request["arrays"].items()}


def _no_key(*_: object) -> str:
    raise EOFError("waits for a key")


def main() -> None:
    """Answer the request."""
    request = json.load(sys.stdin)
    resource.setrlimit(resource.RLIMIT_AS, (_MEMORY, _MEMORY))
    sys.path += [os.path.dirname(os.path.abspath(__file__)), *request["folders"]]
    warnings.simplefilter("ignore")
    builtins.input = _no_key
    answers = os.fdopen(os.dup(1), "w")
    os.dup2(os.open(os.devnull, os.O_WRONLY), 1)  # what C++ prints, too
    functions = _functions()
    for call in request["calls"]:
        try:
            with contextlib.redirect_stdout(io.StringIO()):
                names = functions | (_robot(functions, request) if request["folder"] else {})
                names["names"] = names
                value = eval(call, names)
            answer = {"value": np.asarray(value).tolist()}
        except Exception as error:  # whatever their code raises is the answer
            answer = {"error": f"{type(error).__name__}: {error}"}
        print(json.dumps(answer), file=answers, flush=True)


if __name__ == "__main__":
    main()
