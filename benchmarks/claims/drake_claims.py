"""Claims about Drake."""

from __future__ import annotations

from pydrake.multibody.parsing import Parser
from pydrake.multibody.plant import DiscreteContactApproximation, MultibodyPlant

from benchmarks.claims.captured import captured
from benchmarks.claims.expectation import expect
from benchmarks.claims.four_bar import BALL_JOINT, LOOPS, SDF_PIN, URDF, mjcf, sdf, with_elements, with_two_parents

_BALL = with_elements(LOOPS["`drake:ball_constraint`"])


def _plant(text: str, kind: str = "urdf", contact: DiscreteContactApproximation | None = None) -> MultibodyPlant:
    plant = MultibodyPlant(1e-3)
    if contact is not None:
        plant.set_discrete_contact_approximation(contact)
    Parser(plant).AddModelsFromString(text, kind)
    plant.Finalize()
    return plant


def _error(text: str, kind: str = "urdf", contact: DiscreteContactApproximation | None = None) -> str:
    """The error of the parser or of the plant; empty if there is none."""
    try:
        _plant(text, kind, contact)
    except RuntimeError as error:
        return str(error)
    return ""


def joint_types() -> str:
    """Ball, universal and screw joints of a URDF, and a mimic joint, which becomes a constraint."""
    pivot = '<joint name="rocker_pivot" type="continuous">'
    found = []
    for kind, velocities in (("ball", 3), ("universal", 2), ("screw", 1)):
        head, _, tail = with_elements("").partition(pivot)
        pitch = '<drake:screw_thread_pitch value="0.01"/>' if kind == "screw" else ""
        element = f'<drake:joint name="rocker_pivot" type="{kind}">{pitch}'
        joint = _plant(head + element + tail.replace("</joint>", "</drake:joint>", 1)).GetJointByName("rocker_pivot")
        expect(joint.num_velocities() == velocities, f"{kind}: {joint.num_velocities()} velocities")
        found.append(f"{kind}: {joint.type_name()}")
    head, _, tail = URDF.partition(pivot)
    mimic = head + pivot + '<mimic joint="motor_crank" multiplier="0.5"/>' + tail
    couplers = _plant(mimic, contact=DiscreteContactApproximation.kSap).num_constraints()
    return expect(couplers == 1, f"{', '.join(found)}; mimic: {couplers} constraint")


def actuators() -> str:
    """Which joints are actuated."""
    transmission = """<transmission name="t"><type>transmission_interface/SimpleTransmission</type>
<joint name="motor_crank"/><actuator name="motor"/></transmission>"""
    urdf = [_plant(URDF).num_actuators(), _plant(with_elements(transmission)).num_actuators()]
    found = [_plant(sdf(effort=effort), "sdf").num_actuators() for effort in (0.0, 3.0)]
    shown = f"URDF without and with a transmission: {urdf}; SDF without and with an effort limit: {found}"
    return expect(urdf == [0, 1] and found == [0, 1], shown)


def equalities_of_mjcf() -> str:
    """Which equalities of an MJCF become constraints, and whether the others give a warning."""
    found = {}
    for name in ("connect of bodies", "connect", "weld", "joint"):
        with captured() as printed:
            constraints = _plant(mjcf([name]), "xml", DiscreteContactApproximation.kSap).num_constraints()
        warnings = [line for line in printed.text.splitlines() if "warning" in line and "tag 'site'" not in line]
        found[name] = constraints, bool(warnings)
    right = {"connect of bodies": (1, False), "connect": (0, True), "weld": (0, True), "joint": (0, True)}
    shown = (f"{name}: {number}{', with a warning' if warned else ''}" for name, (number, warned) in found.items())
    return expect(found == right, f"constraints of {'; '.join(shown)}")


def weld_in_files() -> str:
    """A ball constraint and a weld in a file."""
    balls = _plant(_BALL).num_constraints()
    with captured() as printed:
        welds = _plant(with_elements(LOOPS["`drake:weld_constraint`"])).num_constraints()
    error = _error(sdf("<drake:weld_constraint/>"), "sdf")
    shown = (
        f"{balls} ball constraint; weld in a URDF: {welds}, printed {printed.text!r}; in an SDF: {error or 'accepted'}"
    )
    return expect(balls == 1 and welds == 0 and not printed.text and bool(error), shown)


def solvers() -> str:
    """Which solvers accept a ball constraint."""
    tamsi, default = _error(_BALL, contact=DiscreteContactApproximation.kTamsi), _error(_BALL)
    return expect(bool(tamsi) and not default, f"TAMSI: {tamsi[:75] or 'accepted'}; default: {default or 'accepted'}")


def loop_in_sdf() -> str:
    """A joint whose child already has a parent."""
    error = _error(sdf(SDF_PIN), "sdf")
    return expect("loop" in error, error[:75] or "accepted")


def loops_in_urdf() -> str:
    """The elements of each dialect in a URDF."""
    for dialect, elements in LOOPS.items():
        with captured() as printed:
            constraints = _plant(with_elements(elements), contact=DiscreteContactApproximation.kSap).num_constraints()
        closed = int("ball" in dialect)
        expect((constraints, printed.text) == (closed, ""), f"{dialect}: {constraints} constraints; {printed.text!r}")
    error = _error(BALL_JOINT)
    return expect(
        "<drake:joint>" in error, f"only the ball constraint closes; a ball joint: {error.rpartition(': ')[2]}"
    )


def two_parents() -> str:
    """The loop as a second joint to the rocker."""
    errors = [_error(text) for text in with_two_parents()]
    return expect(all(errors), f"{sum(map(bool, errors))} of {len(errors)} rejected: {errors[0][:75]}")
