"""``eurdf info``: the dimensions of a robot, and how it can move."""

from __future__ import annotations

import math
import sys
from collections import Counter
from collections.abc import Sequence
from typing import TYPE_CHECKING, Any

from eurdf.commands.command import JSON, ROBOT, ROOT, command
from eurdf.commands.output import write_result
from eurdf.commands.terminal import Cell, Table, progress_bar, write_lines, write_reports, write_shown
from eurdf.reading.robot_source import display_name

if TYPE_CHECKING:
    from eurdf.commands.robot_info import CouplingInfo, RobotInfo
    from eurdf.diagnostics.report import Report
    from eurdf.mechanism.mechanism import Root

Row = tuple[str, "int | str | None", str]

# Maximum number of motions that are named.
_MOST_MOTIONS = 12


@command(
    summary="show a robot's dimensions, its closures, and how it can move",
    description="Show what a robot is made of, whether its loops close, and what motions that leaves.",
    exit_codes="0 shown, 1 the robot has errors that keep it from being built, 2 the command cannot run.",
    examples=("eurdf info digit_leg --root floating",),
    has_output=False,
)
def info(options: dict[str, Any], path: str = ROBOT, root: Root | None = ROOT, json: bool = JSON) -> int:
    """Load, analyse and show a robot."""
    import eurdf
    from eurdf.commands.robot_info import robot_info
    from eurdf.diagnostics.report import Report

    with progress_bar("analysing the loops"):
        robot = eurdf.load(path, root=root, geometry=False, check_loops=not json, **options)
        found = robot_info(robot, eurdf.analyze(robot))
    if json:
        write_result(found)
        return 0
    report = Report(display_name(path), robot.diagnostics)
    write_shown(_heading(found, report))
    if robot.diagnostics:
        write_reports([report], verdict=False)
    write_lines([[]], sys.stdout)
    _show(found)
    return 0


def _show(info: RobotInfo) -> None:
    shown: list[Table | Sequence[Cell]] = [_dimensions(info)]
    if info.left_out is not None:
        shown.append([(info.left_out, "yellow")])
    for applies, table in (
        (info.closure_list, _closures),
        (info.coupling_list, _couplings),
        (len(info.loop_list) > 1, _loops),
        (info.motion_list and info.actuated, _motions),  # without actuators, all motions are uncontrolled
        (info.dependent_list, _dependent),
        (info.joint_list, _joints),
        (info.frame_list, _frames),
        (info.configuration_list, _configurations),
    ):
        if applies:
            shown.append(table(info))
    write_shown(*shown)


def _heading(info: RobotInfo, report: Report) -> Sequence[Cell]:
    from eurdf.diagnostics.text import counts

    format_name = f"Extended URDF {info.version}" if info.version else "URDF"
    mass = f", {info.mass:.6g} kg" if math.isfinite(info.mass) else ""
    number = counts(report)
    style = "bold red" if report.errors else "yellow"
    return (info.name, "bold"), f"  {format_name}, {info.root} root{mass}", (f", {number}" if number else "", style)


def _dimensions(info: RobotInfo) -> Table:
    from eurdf.kinematics.analysis import FIGURES

    types = [closure.type for closure in info.closure_list]
    kinds = ", ".join(f"{types.count(kind)} of {kind}" for kind in sorted(set(types)))
    figures: dict[str, Row] = {name: (name, getattr(info, name), meaning) for name, meaning in FIGURES.items()}
    rows: list[Row] = [
        ("joints", info.joints, "moving joints of the spanning tree"),
        figures.pop("nq"),
        figures.pop("nv"),
        ("closures", info.closures, kinds),
        *([("couplings", info.couplings, "linear relations of joint coordinates")] if info.couplings else []),
        _verdict(info),
    ]
    for row in figures.values():
        rows += [row, *(_mobilities(info) if row[0] == "mobility" else [])]
    for name, value, meaning in (
        ("singularity", info.singularity, "distance to singularity; 0 if the closures lose rank"),
        ("", info.actuation_singularity, "the same with every actuator held"),
    ):
        if value is not None and math.isfinite(value):
            rows.append((name, _digits(value), meaning))
    styles = {"open": "red", "close": "green"}
    cells = []
    for name, figure, meaning in rows:
        shaky = name == "finite" and figure != info.mobility
        style = styles.get(str(figure), "yellow" if shaky else "bold")
        cells.append((name, ("-" if figure is None else str(figure), style), (meaning, "dim")))
    return Table("", "", "", rows=cells, right=[1])


def _verdict(info: RobotInfo) -> Row:
    """Whether the loops close."""
    if not (info.closures or info.couplings):
        return "loops", "none", "a tree"
    if info.closes:
        stated = any(configuration.name == "assembled" for configuration in info.configuration_list)
        more = "" if stated else "; `eurdf assemble` shows a configuration"
        return "loops", "close", f"residual {info.residual:.1e}{more}"
    if info.left_out is not None:
        return "loops", "-", ""
    smallest = f"smallest residual found {info.residual:.1e}; " if math.isfinite(info.residual) else ""
    return "loops", "open", f"{smallest}`eurdf assemble` shows how far each closure is"


def _mobilities(info: RobotInfo) -> list[Row]:
    """The other mobilities, where the rank alone does not decide them."""
    rows: list[Row] = []
    if info.rounded_mobility is not None:
        meaning = f"degrees of freedom if the loops may be open by {info.rounded_tolerance:.0e}, by rounded numbers"
        rows.append(("rounded", info.rounded_mobility, meaning))
    if any(loops.evidence != "constant rank" for loops in info.loop_list):
        if info.infinitesimal_mobility != info.mobility:
            meaning = "degrees of freedom to first order here: singular"
            rows.append(("first order", info.infinitesimal_mobility, meaning))
        meaning = "degrees of freedom of motions that continue from here"
        orders = [loops.rigid_order for loops in info.loop_list if loops.rigid_order]
        if max(orders, default=1) > 1:
            meaning += f"; shaky: rigid to order {max(orders)} only"
        rows.append(("finite", info.finite_mobility, meaning))
    return rows


def _closures(info: RobotInfo) -> Table:
    rows = []
    for closure in info.closure_list:
        frames = [
            frame if frame is not None else (f"on {body}", "dim")
            for frame, body in zip(closure.frames, closure.bodies, strict=True)
        ]
        linear, angular = closure.compliance
        compliances = [f"{linear:g} m/N"] * bool(linear) + [f"{angular:g} rad/(N·m)"] * bool(angular)
        note = (f"compliance {', '.join(compliances)}" if compliances else "", "dim")
        rows.append(((closure.name, "bold"), closure.type, *frames, _number(closure.residual), note))
    return Table("closure", "type", "frame A", "frame B", "residual", "", rows=rows, right=[4], spare=(4, 1))


def _couplings(info: RobotInfo) -> Table:
    rows = (((each.name, "bold"), _relation(each), _number(each.residual)) for each in info.coupling_list)
    return Table("coupling", "relation", "residual", rows=rows, right=[2])


def _relation(coupling: CouplingInfo) -> str:
    """As an equation: 0.5 motor_1 + 0.5 motor_2 - knee = 0."""
    terms = []
    for name, coefficient in coupling.joints.items():
        sign = "-" if coefficient < 0.0 else "+"
        size = "" if abs(coefficient) == 1.0 else f"{abs(coefficient):g} "
        terms.append(f"{sign} {size}{name}")
    return f"{' '.join(terms).removeprefix('+ ')} = {coupling.offset:g}"


def _loops(info: RobotInfo) -> Table:
    counts = ("nv", "nc", "rank", "mobility", "redundant", "uncontrolled")
    rows = (
        (
            (", ".join(loops.closures), "bold"),
            *(str(getattr(loops, count)) for count in counts),
            _digits(loops.singularity),
        )
        for loops in info.loop_list
    )
    return Table("loops of", *counts, "singularity", rows=rows, right=range(1, 8), spare=(5, 2, 3, 1, 7))


def _motions(info: RobotInfo) -> Table:
    counts = Counter(motion.joints for motion in info.motion_list)
    rows: list[Cell] = [
        ", ".join(joints) + (f"  ({count} motions)" if count > 1 else "")
        for joints, count in counts.most_common(_MOST_MOTIONS)
    ]
    if len(counts) > _MOST_MOTIONS:
        rows.append((f"and {len(counts) - _MOST_MOTIONS} more", "dim"))
    return Table("uncontrolled motion of", rows=((row,) for row in rows))


def _dependent(info: RobotInfo) -> Table:
    rows = (((", ".join(joints), "yellow"),) for joints in info.dependent_list)
    return Table("actuators that depend on one another through the closures", rows=rows)


def _joints(info: RobotInfo) -> Table:
    motors = {motor.joint: motor for motor in info.actuator_list}
    rows = []
    for joint in info.joint_list:
        notes = [f"mimics {joint.mimics}"] if joint.mimics else []
        if any(joint.stiffness):
            stiffness = ", ".join(f"{each:g}" for each in joint.stiffness)
            notes.append(f"spring {stiffness}, rest {', '.join(f'{each:g}' for each in joint.rest)}")
        motor = motors.get(joint.name)
        if motor is not None:
            name = "" if motor.name == joint.name else f" as {motor.name}"
            control = "" if motor.control is None else f", {motor.control[0]:g} to {motor.control[1]:g}"
            notes.insert(0, f"actuated{name}{control}")
        note = ("; ".join(notes), "dim" if motor is None else "cyan")
        links = joint.parent, joint.child
        rows.append(((joint.name, "bold"), joint.type.value, *links, str(joint.nv), note))
    return Table("joint", "type", "parent", "child", "nv", "", rows=rows, right=[4], spare=(4, 2, 3))


def _frames(info: RobotInfo) -> Table:
    return Table("frame", "on", rows=(((each.name, "bold"), each.body) for each in info.frame_list))


def _configurations(info: RobotInfo) -> Table:
    rows = (((each.name, "bold"), _number(each.residual)) for each in info.configuration_list)
    return Table("configuration", "residual", rows=rows, right=[1])


def _number(value: float) -> str:
    return f"{value:.1e}" if math.isfinite(value) else "-"


def _digits(value: float) -> str:
    return f"{value:.2g}" if math.isfinite(value) else "-"
