"""What a call returns belongs to the caller: no later call changes it, and writing into it changes nothing else.

Public functions, methods, properties and results are found by walking the package. Arguments are chosen by the names of
parameters, so that a new function with a parameter that `Case` does not have fails.
"""

from __future__ import annotations

import copy
import inspect
import multiprocessing
import pickle
import re
from collections.abc import Callable, Iterator, Mapping
from concurrent.futures import ProcessPoolExecutor
from pathlib import Path
from types import MappingProxyType
from typing import Any

import numpy as np
import pytest

import eurdf
from eurdf.collection import collection_folder
from eurdf.errors import EurdfError, Portable
from support.public import own_names, public_functions, public_names

#: Name; root; joints of the serial side; actuator.
ROBOTS = [
    ("digit_leg", "fixed", ("free_foot1", "free_foot2"), "motor_hip_z"),
    ("unitree_g1_ankle", "fixed", ("free_pitch", "free_roll"), "motor_a"),
    ("double_wishbone", "fixed", (), "motor_rack"),
    ("four_bar", "floating", ("motor_crank",), "motor_crank"),
]

#: Public functions that return no data: a server, and a file.
WITHOUT_DATA = {"view", "plot_workspace"}

#: Methods that change the object, write files, or return texts; and what is shared by design: the memory of a robot.
NOT_CALLED = {"reset", "write", "start_at_joints", "start_at_motors", "c_source", "passes", "followed_by", "to_json"}
NOT_CALLED |= {"on_grid", "nearest", "cached", "derived", "data", "tree", "diagnose", "no_geometry", "of"}
NOT_CALLED |= {"python_source", "array_map", "ros2_package"}  # as `c_source`; functions in a namespace that is given
NOT_CALLED |= {"times"}  # of calls, measured

#: Objects of other libraries, and what a result refers to and does not own.
NOT_OWNED = ("pinocchio", "coal", "lxml")
NOT_OWNED += ("eurdf.pinocchio.tree", "eurdf.closures", "eurdf.mechanism", "eurdf.diagnostics")

#: Functions of motions that the motors produce.
OF_MOTIONS = ("inverse_dynamics", "inverse_dynamics_derivatives", "inertial_regressor")


class Case:
    """A robot, and an argument for each parameter of the public functions and methods, by its name."""

    def __init__(self, name: str, root: Any, joints: tuple[str, ...], actuator: str, folder: Path) -> None:
        robot = eurdf.load(name, root=root, geometry=False)
        q = robot.configurations["assembled"]
        v = eurdf.project_velocity(robot, q, np.full(robot.model.nv, 0.1))
        u = np.full(len(robot.actuation.idx_v), 0.1)
        coordinates = robot.joint_positions(q)
        frame = robot.mechanism.bodies[-1].name
        self.arguments: dict[str, Any] = {
            "robot": robot,
            "q": q,
            "q0": np.array(q),
            "v": v,
            "u": u,
            "a": eurdf.forward_dynamics(robot, q, v, u).a,
            "tau": np.full(robot.model.nv, 0.01),
            "weights": np.full(robot.model.nv, 2.0),
            "actuated": q[robot.actuation.idx_q],
            "values": np.tile(q[robot.actuation.idx_q], (3, 1)),
            "frame": frame,
            "contacts": {actuator: "3d"},
            "targets": {frame: np.zeros(3)},
            "twist": np.zeros(6),
            "samples": {actuator: coordinates[actuator]},
            "unknown": actuator,
            "joints": joints,
            "actuator": actuator,
            "stiffness": np.full(len(joints), 10.0),
            "duration": 0.01,
            "grid": 3,
            "ranges": {name: tuple(coordinates[name][0] + np.array((-0.02, 0.02))) for name in joints},
            "path": name,
            "to": "mjcf",
            "urdf": collection_folder() / name / "robot.urdf",
            "coordinates": coordinates,
        }
        self.arguments["q_actuated"], self.arguments["q_free"] = eurdf.split_configuration(robot, q)
        self.arguments["v_actuated"], self.arguments["v_free"] = eurdf.kinematics.split_velocity(robot, v)
        written = eurdf.export(robot, "mjcf").coordinates
        self.arguments |= {"files": coordinates, "configuration": written.to_q(q), "velocity": written.to_v(q, v)}
        motors = {name: float(q[robot.slots[name].idx_q]) for name in robot.actuation.joints[:1]}
        eurdf.export(robot, "sdf").write(folder)
        self.of: dict[str, dict[str, Any]] = {
            "lock": {"joints": actuator},
            **{name: {"weights": np.full(len(u), 2.0)} for name in OF_MOTIONS},
            "actuator_values": {"joints": dict.fromkeys(joints, 0.0)},
            "joint_values": {"motors": motors},
            "configuration": {"positions": coordinates},
            "import_robot": {"path": folder / "robot.sdf"},
        }
        if joints:
            at = np.array([coordinates[name][0] for name in joints])
            of_motors = eurdf.transmissions.prepare_transmission(robot, joints, q).at_joints(at).positions
            self.arguments |= {"positions": at, "x": np.zeros(len(joints))}
            self.arguments |= dict.fromkeys(("v_J", "tau_J"), np.zeros(len(joints)))
            self.arguments |= dict.fromkeys(("v_m", "tau_m"), np.zeros(len(of_motors)))
            self.of |= {
                "transmissions_at": {"q": np.tile(q, (3, 1))},
                "moved": {"q": np.tile(q, (3, 1)), "positions": np.tile(at, (3, 1))},
                "at_motors": {"positions": of_motors},
            }
        self.batch = {name: np.tile(each, (3, 1)) for name, each in (("q", q), ("q0", q), ("v", v))}
        self.batch["targets"] = {frame: np.zeros((3, 3))}

    def call(self, function: Callable[..., Any], name: str, more: Mapping[str, Any] = MappingProxyType({})) -> Any:
        """The result with the arguments that must be given, and the optional arrays."""
        given = {**self.arguments, **self.of.get(name, {}), **more}
        parameters = inspect.signature(function).parameters.values()
        needed = {each.name for each in parameters if each.default is each.empty}
        if "joints" in needed and not given["joints"]:
            return None  # nothing is driven through rods here
        optional = {each.name for each in parameters} & {"q", "q0", "grid", "ranges", "weights", *more}
        return function(**{name: given[name] for name in needed | (optional & given.keys())})

    def results(self) -> dict[str, Any]:
        """What each public function returns."""
        functions = {name: each for name, each in public_functions().items() if name not in WITHOUT_DATA}
        return {
            name: self.call(each, each.__name__, self.batch if name.startswith("batch.") else {})
            for name, each in functions.items()
        }


def parts(value: Any, path: str, case: Case, seen: dict[int, Any] | None = None) -> Iterator[tuple[str, Any]]:
    """The arrays, containers, numbers and texts of a result, also those that its members return, each with its path."""
    seen = {} if seen is None else seen
    if isinstance(value, np.ndarray | str | bytes | int | float):
        yield path, value
        return
    if id(value) in seen:
        return
    seen[id(value)] = value
    module = type(value).__module__
    if isinstance(value, Mapping):
        yield path, value
        for key, item in value.items():
            yield from parts(item, f"{path}[{key!r}]", case, seen)
    elif isinstance(value, tuple | list):
        yield path, value
        for number, item in enumerate(value):
            yield from parts(item, f"{path}[{number}]", case, seen)
    elif module.startswith("eurdf") and not module.startswith(NOT_OWNED) and not isinstance(value, eurdf.Robot):
        yield from members(value, path, case, seen)


def members(value: Any, path: str, case: Case, seen: dict[int, Any]) -> Iterator[tuple[str, Any]]:
    """The same of the public attributes, properties and methods of an object."""
    names = {name for name in (*dir(type(value)), *getattr(value, "__dict__", ())) if not name.startswith("_")}
    for name in sorted(names - NOT_CALLED):
        try:
            member = getattr(value, name)
        except (EurdfError, ValueError):  # there is no such thing here
            continue
        if callable(member):
            if isinstance(inspect.getattr_static(value, name), staticmethod | classmethod):
                continue  # a function of its class
            needed = {each.name for each in inspect.signature(member).parameters.values() if each.default is each.empty}
            assert needed <= {*case.arguments, *case.of.get(name, ())}, f"{path}.{name} needs {needed}"
            member = case.call(member, name)
        yield from parts(member, f"{path}.{name}", case, seen)


def poison(value: Any) -> None:
    """Write into an array or a container, if it can be written to."""
    if isinstance(value, np.ndarray) and value.flags.writeable and value.dtype != object:
        value[...] = 1 if value.dtype == bool else 7
    elif isinstance(value, dict | list):
        value.clear()


def numbers(results: Mapping[str, Any], case: Case) -> dict[str, Any]:
    """Copies of all numbers, texts and arrays in results, and lengths of containers, by their paths."""
    found = (part for name, result in results.items() for part in parts(result, name, case))
    return {
        path: len(value) if isinstance(value, Mapping | tuple | list) else copy.copy(value) for path, value in found
    }


def assert_equal(one: Mapping[str, Any], other: Mapping[str, Any]) -> None:
    assert one.keys() == other.keys()
    for path, value in one.items():
        if isinstance(value, str | bytes):
            assert value == other[path], path
        else:
            np.testing.assert_allclose(value, other[path], rtol=1e-6, atol=1e-9, err_msg=path)


@pytest.mark.parametrize("robot", ROBOTS, ids=[name for name, *_ in ROBOTS])
def test_results_belong_to_the_caller(robot: tuple[str, Any, tuple[str, ...], str], tmp_path: Path) -> None:
    case = Case(*robot, tmp_path)
    given = {name: copy.deepcopy(value) for name, value in case.arguments.items() if name not in ("robot", "files")}
    first = {**case.results(), "robot": dict(members(case.arguments["robot"], "", case, {}))}
    before = numbers(first, case)
    second = case.results()
    assert_equal(before, numbers(first, case))  # no later call has changed it
    for results in (first, second):
        for name, result in results.items():
            for _, value in list(parts(result, name, case)):
                poison(value)
    for name, value in given.items():  # nothing that was given is part of a result
        np.testing.assert_equal(case.arguments[name], value, err_msg=name)
    after = {**case.results(), "robot": dict(members(case.arguments["robot"], "", case, {}))}
    assert_equal(before, numbers(after, case))


#: Optional vectors of a number for each serial joint.
OF_SERIAL_JOINTS = ("stiffness", "damping", "torque_ratio", "velocity_ratio")


def by_name(case: Case, name: str, value: Any, joints: tuple[str, ...], motors: tuple[str, ...]) -> Any:
    """The same argument by the names of joints, as files have their coordinates; None if it is no such vector."""
    robot, rows = case.arguments["robot"], np.ndim(value) == 2
    if value is None:
        return None
    if name in ("q", "q0", "values", "actuated", "q_actuated", "q_free"):
        whole = np.array(np.broadcast_to(case.arguments["q"], (3, robot.tree.nq)) if rows else case.arguments["q"])
        actuated, free = robot.actuation.idx_q, np.delete(np.arange(robot.tree.nq), robot.actuation.idx_q)
        whole[..., {"q": slice(None), "q0": slice(None), "q_free": free}.get(name, actuated)] = value
        each = [robot.joint_positions(one) for one in whole] if rows else robot.joint_positions(whole)
        named = {joint: np.squeeze([one[joint] for one in each]) for joint in each[0]} if rows else each
        mine = {"q": None, "q0": None, "q_free": False}.get(name, True)
        return {key: one for key, one in named.items() if mine is None or (key in robot.actuation.joints) is mine}
    if name in ("v", "a", "weights", "u", "v_actuated", "v_free") or (name == "tau" and len(value) == robot.tree.nv):
        at = {key: slice(slot.idx_v, slot.idx_v + slot.nv) for key, slot in robot.slots.items()}
        if robot.mechanism.root == "floating":
            at["root_joint"] = slice(0, 6)
        indices = np.arange(robot.tree.nv)
        if name == "v_free":
            indices = np.delete(indices, robot.actuation.idx_v)
        elif len(value) != robot.tree.nv or name in ("u", "v_actuated"):
            indices = robot.actuation.idx_v
        whole = np.full(robot.tree.nv, np.nan)
        whole[indices] = value
        return {key: whole[own] for key, own in at.items() if not np.isnan(whole[own]).any()}
    if name in (*OF_SERIAL_JOINTS, "positions", "tau", "v_J", "tau_J", "v_m", "tau_m"):
        return dict(zip(motors if name in ("v_m", "tau_m") else joints, value, strict=True))
    return None


@pytest.mark.parametrize("robot", ROBOTS, ids=[name for name, *_ in ROBOTS])
def test_vectors_can_be_given_by_name(robot: tuple[str, Any, tuple[str, ...], str], tmp_path: Path) -> None:
    case, walked = Case(*robot, tmp_path), set()
    whole, joints, q = (case.arguments[name] for name in ("robot", "joints", "q"))
    functions = {name: each for name, each in public_functions().items() if name not in WITHOUT_DATA}
    motors: tuple[str, ...] = ()
    v, u, tau = (case.arguments[name] for name in ("v", "u", "tau"))
    for name in OF_MOTIONS:
        case.of[name] |= {"tau": tau, "a": eurdf.forward_dynamics(whole, q, v, u, tau=tau).a}
    if joints:
        at, prepared = eurdf.transmission(whole, joints, q), eurdf.transmissions.prepare_transmission(whole, joints, q)
        motors = at.motors
        case.arguments |= dict.fromkeys(OF_SERIAL_JOINTS, np.arange(1.0, len(joints) + 1.0))
        case.of["impedance_map"] = {"tau": np.full(len(joints), 0.1)}
        case.arguments |= {name: case.arguments[name] + 0.1 for name in ("v_J", "tau_J", "v_m", "tau_m")}
        functions |= {name: getattr(at, name) for name in ("motor_velocity", "joint_torque", "motor_torque", "rate")}
        functions |= {name: getattr(prepared, name) for name in ("at_joints", "at_motors")}
        twin = eurdf.transmissions.serial_twin(whole, joints, q, ranges=case.arguments["ranges"], grid=5)
        functions |= {"motor_positions": twin.map.motor_positions, "G": twin.map.G} if twin.map else {}
    for path, function in functions.items():
        name = path.removeprefix("batch.")
        more = {**(case.batch if path != name else {}), **case.of.get(name, {})}
        for each in inspect.signature(function).parameters.values():
            if path != name and each.name in ("v", "u", "tau"):  # rows of velocities and forces are arrays
                continue
            vector = (case.arguments | more).get(each.name)
            named = by_name(case, each.name, vector, motors if name == "at_motors" else joints, motors)
            if named is None or ("joints" in inspect.signature(function).parameters and not joints):
                continue
            assert re.search("Named|Mapping", str(each.annotation)), f"{path}({each.name})"
            walked.add(each.name)
            results = [{"": case.call(function, name, {**more, each.name: one})} for one in (vector, named)]
            assert_equal(numbers(results[0], case), numbers(results[1], case))
    assert {"q", "q0", "v", "a", "values", "actuated", "q_free", "v_free", "weights"} <= walked


def objects(value: Any, seen: dict[int, Any]) -> Iterator[Any]:
    """The objects of the package in a result."""
    if id(value) in seen or isinstance(value, np.ndarray | str):
        return
    seen[id(value)] = value
    if isinstance(value, eurdf.Robot):
        yield value
        return
    if isinstance(value, Mapping | tuple | list) and type(value).__module__ == "builtins":
        inner: Any = value.values() if isinstance(value, Mapping) else value
    else:
        yield value
        inner = getattr(value, "__dict__", {}).values()
        if hasattr(value, "__dataclass_fields__"):
            inner = [getattr(value, name) for name in value.__dataclass_fields__]
        elif isinstance(value, tuple):
            inner = value
    for each in inner if type(value).__module__.startswith(("eurdf", "builtins")) else ():
        yield from objects(each, seen)


def test_results_print_in_few_lines_with_units(tmp_path: Path) -> None:
    kinds = {kind for kind in public_names().values() if inspect.isclass(kind) and not issubclass(kind, BaseException)}
    seen: set[type] = {eurdf.viewing.Viewer, eurdf.viewing.ShownRobot}  # they need a server
    ankle = eurdf.transmissions.prepare_transmission("unitree_g1_ankle", ["free_pitch", "free_roll"])
    for number, robot in enumerate(ROBOTS):
        case = Case(*robot, tmp_path / str(number))
        results = {**case.results(), "robot": case.arguments["robot"], "diagnostics": OF_EXCEPTIONS["diagnostics"]}
        if joints := case.arguments["joints"]:
            several = case.arguments["robot"], joints, np.tile(case.arguments["q"], (2, 1))
            results |= {"transmissions": eurdf.transmission(*several), "boundary": results["workspace"].boundary}
            results["common"] = eurdf.transmissions.serial_limits(*several)
        for each in (*objects(results, {}), ankle.array_map(np)):  # which refers to a whole library
            seen.update(type(each).__mro__)
            if type(each) in kinds:
                text = repr(each)
                assert text.startswith("<"), text
                assert text.count("\n") < 3, text
                assert len(text) < 400, text
                assert not re.search(r"array\(| object at 0x", text), text
    assert kinds - seen == set()


@pytest.mark.parametrize("robot", ROBOTS, ids=[name for name, *_ in ROBOTS])
def test_results_survive_pickle_and_copy(robot: tuple[str, Any, tuple[str, ...], str], tmp_path: Path) -> None:
    case = Case(*robot, tmp_path)
    whole = case.arguments["robot"]
    results = {**case.results(), "actuation": whole.actuation, "constraints": whole.constraints}
    before = numbers(results, case)
    assert_equal(before, numbers(pickle.loads(pickle.dumps(results)), case))
    assert_equal(before, numbers(copy.deepcopy(results), case))
    assert_equal(before, numbers({name: copy.copy(result) for name, result in results.items()}, case))


@pytest.mark.parametrize("remade", [lambda whole: pickle.loads(pickle.dumps(whole)), copy.deepcopy, copy.copy])
@pytest.mark.parametrize("name", ["digit_leg", "double_wishbone", "reachy_mini"])
def test_robot_survives_pickle_and_copy(name: str, remade: Callable[[Any], Any]) -> None:
    first = eurdf.load(name)
    for robot in (first, eurdf.lock(first, first.mechanism.actuators[0], first.configurations["assembled"])):
        same = remade(robot)
        assert type(same) is type(robot)
        assert same.mechanism == robot.mechanism
        assert same.model == robot.model
        assert (same.visual_model, same.collision_model) == (robot.visual_model, robot.collision_model)
        assert same.diagnostics == robot.diagnostics
        np.testing.assert_array_equal(same.actuation.idx_v, robot.actuation.idx_v)
        q, v = robot.configurations["assembled"], np.full(robot.model.nv, 0.01)
        np.testing.assert_allclose(eurdf.mass_matrix(same, q) @ v, eurdf.mass_matrix(robot, q) @ v, atol=1e-12)
        same.model.armature[:] = 7.0
        assert not (robot.model.armature == 7.0).any()


def test_gains_of_constraint_models_survive_pickle() -> None:
    robot = eurdf.load("digit_leg", geometry=False)
    robot.constraint_models[1].m_baumgarte_parameters.Kp = 123.0
    assert pickle.loads(pickle.dumps(robot)).constraint_models[1].m_baumgarte_parameters.Kp == 123.0


#: An argument for each parameter of the constructors of exceptions, by its name.
OF_EXCEPTIONS: dict[str, Any] = {
    "path": "robot.yaml",
    "diagnostics": eurdf.check(b"extended_urdf: '2.0'", b"<robot/>").diagnostics,
    "message": "a message",
    "reason": "a reason",
    "extra": "view",
    "losses": (),
    "joint": "knee",
    "joints": ("knee", "hip"),
    "names": ("knee", "hip"),
    "openings": (eurdf.results.Opening("rod", 0.1, 0.2),),
    "tolerance": 1e-9,
    "q": np.zeros(3),
    "given": np.zeros(2),
    "nearest": np.ones(2),
    "actuated": 2,
    "rank": 1,
    "order": "velocity",
    "opening": {"rod": (0.1, 0.2)},
    "missing": {"knee": (0.1,)},
    "deviation": 0.5,
    "error": 0.1,
    "exchanged": 1.0,
    "step": 1e-3,
    "suggested": 1e-4,
    "t": 0.2,
    "result": "the energy",
    "of": "G",
    "type_": "hinge",
    "uri": "package://leg/knee.stl",
    "part": 0.5,
    "wanted": {"knee": 1.0},
    "reached": {"knee": 0.5},
    "constraint": eurdf.load("digit_leg", geometry=False).constraints[0],
}


def exceptions() -> set[type[Portable]]:
    found: set[type[Portable]] = set()
    new = {Portable}
    while new:
        found |= new
        new = {each for kind in new for each in kind.__subclasses__()} - found
    return found - {Portable, EurdfError}


@pytest.mark.parametrize("kind", sorted(exceptions(), key=lambda kind: kind.__name__))
def test_exception_survives_pickle_and_copy(kind: type[Exception]) -> None:
    own = any("__init__" in each.__dict__ for each in kind.__mro__ if issubclass(each, Portable))
    parameters = inspect.signature(kind).parameters.values() if own else ()
    needed = [OF_EXCEPTIONS[each.name] for each in parameters if each.default is each.empty]
    error = kind(*needed) if own else kind("a message")
    error.add_note("a note") if hasattr(error, "add_note") else None
    for same in (
        copy.deepcopy(error),
        copy.copy(error),
        *(pickle.loads(pickle.dumps(error, of)) for of in range(2, 6)),
    ):
        assert type(same) is kind
        assert (str(same), same.args) == (str(error), error.args)
        assert repr(same.__dict__) == repr(error.__dict__)


def test_every_public_exception_is_portable() -> None:
    kinds = {name: kind for name, kind in vars(eurdf.errors).items() if inspect.isclass(kind)}
    own = {name for name, kind in kinds.items() if kind.__module__ == "eurdf.errors"}
    assert own - {"CannotRun"} == own_names(eurdf.errors).keys()


def velocities(robot: str | eurdf.Robot) -> int:
    return (eurdf.load(robot, geometry=False) if isinstance(robot, str) else robot).model.nv


def test_robots_and_exceptions_pass_between_processes(tmp_path: Path) -> None:
    broken = tmp_path / "robot.urdf"
    broken.write_text("<robot name='r'/>")
    with ProcessPoolExecutor(1, multiprocessing.get_context("spawn")) as pool:
        assert pool.submit(velocities, eurdf.load("four_bar", geometry=False)).result(60) == 3
        for path, error in (("no_such_robot", eurdf.errors.RobotNotFound), (str(broken), eurdf.InvalidRobot)):
            with pytest.raises(error) as here:
                velocities(path)
            with pytest.raises(error) as there:
                pool.submit(velocities, path).result(60)
            assert str(there.value) == str(here.value)
