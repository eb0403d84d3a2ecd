"""``eurdf info``: the dimensions of a robot, and how it can move."""

from __future__ import annotations

import argparse
import sys
from collections import Counter
from typing import TYPE_CHECKING

from eurdf.commands.output import cell, new_table, write_json, write_lines, write_rendered
from eurdf.commands.robot_options import add_robot_options, add_robot_path, ending, robot_options
from eurdf.commands.selection import select_one
from eurdf.reading.given import shown

if TYPE_CHECKING:
    from rich.table import Table
    from rich.text import Text

    from eurdf.commands.robot_info import CouplingInfo, RobotInfo

# Maximum number of motions that are named.
_MOST_MOTIONS = 12


def register(subparsers: argparse._SubParsersAction[argparse.ArgumentParser]) -> None:
    """Add the command to the parser."""
    parser = subparsers.add_parser(
        "info",
        help="show a robot's dimensions, its closures, and how it can move",
        description="Show what a robot is made of, whether its loops close, and what motions that leaves.",
        epilog=ending(
            "0 shown, 1 the robot has errors that keep it from being built, 2 the command cannot run.",
            "eurdf info digit_leg --root floating",
        ),
        formatter_class=argparse.RawDescriptionHelpFormatter,
    )
    add_robot_path(parser)
    add_robot_options(parser)
    parser.add_argument("--root", choices=("fixed", "floating"), help="default: as the description says")
    parser.add_argument("--json", action="store_true", help="write one JSON object")
    parser.set_defaults(run=run)


def run(args: argparse.Namespace) -> int:
    """Load, analyse and show a robot, and return the exit code."""
    path = select_one(args.path)
    options = robot_options(args)

    import eurdf

    try:
        robot = eurdf.load(path, root=args.root, geometry=False, check_loops=not args.json, **options)
    except eurdf.InvalidRobot as refusal:
        from eurdf.commands.check import write_reports
        from eurdf.diagnostics.report import Report, reports_to_json

        report = Report(refusal.path, tuple(refusal.diagnostics))
        if args.json:
            write_json(reports_to_json([report]))
        else:
            write_reports([report])
        return 1

    from eurdf.commands.robot_info import robot_info

    info = robot_info(robot, eurdf.analyze(robot))
    if args.json:
        write_json(info.model_dump(mode="json"))
        return 0
    _show(info)
    if robot.diagnostics:
        from eurdf.commands.check import write_reports
        from eurdf.diagnostics.report import Report

        write_lines([[]], sys.stdout)
        write_reports([Report(shown(path), robot.diagnostics)])
    return 0


def _show(info: RobotInfo) -> None:
    shown: list[Text | Table] = [_heading(info), _dimensions(info)]
    if info.left_out is not None:
        shown.append(cell(info.left_out, "yellow"))
    if info.closure_list:
        shown.append(_closures(info))
    if info.coupling_list:
        shown.append(_couplings(info))
    if len(info.loop_list) > 1:
        shown.append(_loops(info))
    if info.motion_list and info.actuated:  # without actuators, all motions are uncontrolled
        shown.append(_motions(info))
    if info.dependent_list:
        shown.append(_dependent(info))
    if info.joint_list:
        shown.append(_joints(info))
    if info.frame_list:
        shown.append(_frames(info))
    if info.configuration_list:
        shown.append(_configurations(info))
    write_rendered(*shown)


def _heading(info: RobotInfo) -> Text:
    from rich.text import Text

    from eurdf.diagnostics.visible import visible

    format_name = f"Extended URDF {info.version}" if info.version else "URDF"
    mass = "" if info.mass is None else f", {info.mass:.6g} kg"
    return Text.assemble((visible(info.name), "bold"), f"  {format_name}, {info.root} root{mass}")


def _dimensions(info: RobotInfo) -> Table:
    table = new_table("", "", "")
    table.show_header = False
    table.columns[1].justify = "right"
    if not (info.closures or info.couplings):
        verdict = ("loops", "none", "a tree")
    elif info.closes:
        stated = any(configuration.name == "assembled" for configuration in info.configuration_list)
        more = "" if stated else "; `eurdf assemble` shows a configuration"
        verdict = ("loops", "close", f"residual {info.residual:.1e}{more}")
    elif info.left_out is not None:
        verdict = ("loops", "-", "")
    else:
        smallest = "" if info.residual is None else f"smallest residual found {info.residual:.1e}; "
        verdict = ("loops", "open", f"{smallest}`eurdf assemble` shows how far each closure is")
    types = [closure.type for closure in info.closure_list]
    kinds = ", ".join(f"{types.count(kind)} of {kind}" for kind in sorted(set(types)))
    rows: list[tuple[str, int | str | None, str]] = [
        ("joints", info.joints, "moving joints of the spanning tree"),
        ("nq", info.nq, "coordinates"),
        ("nv", info.nv, "velocities of the spanning tree"),
        ("closures", info.closures, kinds),
        *([("couplings", info.couplings, "linear relations of joint coordinates")] if info.couplings else []),
        verdict,
        ("nc", info.nc, "constraint rows"),
        ("rank", info.rank, "of the constraint Jacobian"),
        ("redundant", info.redundant, "redundant constraint rows, nc - rank"),
        ("mobility", info.mobility, "degrees of freedom of the closed mechanism, nv - rank"),
        ("actuated", info.actuated, "velocities"),
        ("uncontrolled", info.uncontrolled, "degrees of freedom left with every actuator held"),
        ("dependent", info.dependent, "actuated velocities that depend on the others"),
    ]
    if info.singularity is not None:
        rows.append(("singularity", f"{info.singularity:.2g}", "distance to singularity; 0 if the closures lose rank"))
    if info.actuation_singularity is not None:
        rows.append(("", f"{info.actuation_singularity:.2g}", "the same with every actuator held"))
    after = next(index for index, row in enumerate(rows) if row[0] == "mobility") + 1
    rows[after:after] = _mobilities(info)
    for name, value, meaning in rows:
        shaky = name == "finite" and value != info.mobility
        style = "red" if value == "open" else "green" if value == "close" else "yellow" if shaky else "bold"
        table.add_row(name, cell("-" if value is None else str(value), style), cell(meaning, "dim"))
    return table


def _mobilities(info: RobotInfo) -> list[tuple[str, int | str | None, str]]:
    """The other mobilities, where the rank alone does not decide them."""
    rows: list[tuple[str, int | str | None, str]] = []
    if info.rounded_mobility is not None:
        meaning = f"degrees of freedom if the loops may be open by {info.rounded_tolerance:.0e}, by rounded numbers"
        rows.append(("rounded", info.rounded_mobility, meaning))
    if any(loops.evidence != "constant rank" for loops in info.loop_list):
        if info.infinitesimal_mobility != info.mobility:
            rows.append(
                ("first order", info.infinitesimal_mobility, "degrees of freedom to first order here: singular")
            )
        meaning = "degrees of freedom of motions that continue from here"
        orders = [loops.rigid_order for loops in info.loop_list if loops.rigid_order]
        if max(orders, default=1) > 1:
            meaning += f"; shaky: rigid to order {max(orders)} only"
        rows.append(("finite", info.finite_mobility, meaning))
    return rows


def _closures(info: RobotInfo) -> Table:
    table = new_table("closure", "type", "frame A", "frame B", "residual", "")
    table.columns[4].justify = "right"
    for closure in info.closure_list:
        frames = [
            cell(frame) if frame is not None else cell(f"on {body}", "dim")
            for frame, body in zip(closure.frames, closure.bodies, strict=True)
        ]
        linear, angular = closure.compliance
        compliances = [f"{linear:g} m/N"] * bool(linear) + [f"{angular:g} rad/(N·m)"] * bool(angular)
        note = cell(f"compliance {', '.join(compliances)}" if compliances else "", "dim")
        table.add_row(cell(closure.name, "bold"), closure.type, *frames, _number(closure.residual), note)
    return table


def _couplings(info: RobotInfo) -> Table:
    table = new_table("coupling", "relation", "residual")
    table.columns[2].justify = "right"
    for coupling in info.coupling_list:
        table.add_row(cell(coupling.name, "bold"), cell(_relation(coupling)), _number(coupling.residual))
    return table


def _relation(coupling: CouplingInfo) -> str:
    """As an equation: 0.5 motor_1 + 0.5 motor_2 - knee = 0."""
    terms = []
    for name, coefficient in coupling.joints.items():
        sign = "-" if coefficient < 0.0 else "+"
        size = "" if abs(coefficient) == 1.0 else f"{abs(coefficient):g} "
        terms.append(f"{sign} {size}{name}")
    return f"{' '.join(terms).removeprefix('+ ')} = {coupling.offset:g}"


def _loops(info: RobotInfo) -> Table:
    table = new_table("loops of", "nv", "nc", "rank", "mobility", "redundant", "uncontrolled", "singularity")
    for column in table.columns[1:]:
        column.justify = "right"
    for loops in info.loop_list:
        counts = (loops.nv, loops.nc, loops.rank, loops.mobility, loops.redundant, loops.uncontrolled)
        table.add_row(
            cell(", ".join(loops.closures), "bold"),
            *(str(count) for count in counts),
            "-" if loops.singularity is None else f"{loops.singularity:.2g}",
        )
    return table


def _motions(info: RobotInfo) -> Table:
    table = new_table("uncontrolled motion of")
    counts = Counter(motion.joints for motion in info.motion_list)
    for joints, count in counts.most_common(_MOST_MOTIONS):
        table.add_row(cell(", ".join(joints) + (f"  ({count} motions)" if count > 1 else "")))
    if len(counts) > _MOST_MOTIONS:
        table.add_row(cell(f"and {len(counts) - _MOST_MOTIONS} more", "dim"))
    return table


def _dependent(info: RobotInfo) -> Table:
    table = new_table("actuators that depend on one another through the closures")
    for joints in info.dependent_list:
        table.add_row(cell(", ".join(joints), "yellow"))
    return table


def _joints(info: RobotInfo) -> Table:
    table = new_table("joint", "type", "parent", "child", "nv", "")
    table.columns[4].justify = "right"
    motors = {motor.joint: motor for motor in info.actuator_list}
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
        note = cell("; ".join(notes), "dim" if motor is None else "cyan")
        table.add_row(
            cell(joint.name, "bold"), joint.type.value, cell(joint.parent), cell(joint.child), str(joint.nv), note
        )
    return table


def _frames(info: RobotInfo) -> Table:
    table = new_table("frame", "on")
    for frame in info.frame_list:
        table.add_row(cell(frame.name, "bold"), cell(frame.body))
    return table


def _configurations(info: RobotInfo) -> Table:
    table = new_table("configuration", "residual")
    table.columns[1].justify = "right"
    for configuration in info.configuration_list:
        table.add_row(cell(configuration.name, "bold"), _number(configuration.residual))
    return table


def _number(value: float | None) -> str:
    return "-" if value is None else f"{value:.1e}"
