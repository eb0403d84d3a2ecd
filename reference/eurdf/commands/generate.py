"""``eurdf generate``: write a description from the names in a URDF."""

from __future__ import annotations

import argparse
import os
from collections.abc import Collection, Sequence
from dataclasses import replace
from functools import cache
from typing import TYPE_CHECKING, Any

from eurdf.commands.cannot_run import CannotRun
from eurdf.commands.editor_schema import NOT_BESIDE, EditorSchema, add_schema_option, schema_beside, write_described
from eurdf.commands.migrate import print_notes, report_schema, show_report, urdf_named, urdf_notes, write_yaml
from eurdf.commands.output import write_json
from eurdf.commands.output_file import add_output_option, refuse_to_replace
from eurdf.commands.robot_options import add_urdf_options, add_urdf_path, ending, require_urdf, urdf_options
from eurdf.reading.given import shown

if TYPE_CHECKING:
    from eurdf.writing.generation import Generation
    from eurdf.writing.naming_conventions import GeneratedVersion

_DESCRIPTION = """\
Write a description from the names in a URDF.

  closures    closedloop1_A with closedloop1_B, or closing_knee_1 with closing_knee_2: names of links or joints.
              3d or 6d in the name is the type: closedloop3D_1A, closedloop1_A_3D. closing_knee_1_z and
              closing_knee_2_z, which onshape-to-robot adds on the axis of a revolute mate, are a second point. Closures
              of type 3d that join the same two parts at points that are as far apart in both are one hinge.
  motors      joints whose name begins or ends with the word mot or motor: motor_knee, mot1, left_motor_hip, hip_motor.
  sphericals  joints with spherical in their name.

A closure whose name does not state its type is 6d. It is 3d if with 6d the loops cannot close or move, or motors
depend on one another, and with 3d they do not. A note gives the reason; --type sets the type of all closures.

Three consecutive revolute joints whose axes intersect, with massless links between them, become one spherical joint.

The description is of version 2.0, or of version 2.1 if it has a hinge. In versions 1 and 2.0, the 3d closures hold the
hinge.

PATTERNs are regular expressions that replace these conventions. A closure pattern matches a whole name. Its group side
distinguishes the two frames, the group loop (optional) is their common part, and the group type (optional) is 3d or 6d.
"""


def register(subparsers: argparse._SubParsersAction[argparse.ArgumentParser]) -> None:
    """Add the command to the parser."""
    parser = subparsers.add_parser(
        "generate",
        help="write a description from the names in a URDF",
        description=_DESCRIPTION,
        epilog=ending(
            "0 written, 1 the URDF has errors or its names contradict each other, 2 the command cannot run.",
            "eurdf generate arm.urdf -o arm.yaml",
            "eurdf generate arm.urdf --closure '(?P<loop>rod\\d+)_(?P<side>top|bottom)' --motor 'drive$'",
        ),
        formatter_class=argparse.RawDescriptionHelpFormatter,
    )
    add_urdf_path(parser)
    add_urdf_options(parser)
    add_output_option(parser)
    parser.add_argument("--force", action="store_true", help="replace OUT and its schema if they exist")
    add_schema_option(parser)
    for option, what in (
        ("--closure", "the frames of closures"),
        ("--motor", "actuated joints"),
        ("--spherical", "spherical joints"),
    ):
        parser.add_argument(
            option, metavar="PATTERN", action="append", default=[], help=f"names of {what} (repeatable)"
        )
    parser.add_argument(
        "--type", choices=("3d", "6d"), help="type of all closures, instead of the type from name or motion"
    )
    parser.add_argument("--root", choices=("fixed", "floating"), default="fixed", help="default: fixed")
    parser.add_argument(
        "--version",
        choices=("1", "2", "2.1"),
        help="version of the format; 2 is 2.0; default: 2, or 2.1 if there is a hinge",
    )
    parser.add_argument("--json", action="store_true", help="write one JSON object: the text, and what was found")
    parser.set_defaults(run=run)


def run(args: argparse.Namespace) -> int:
    """Generate and write a description, print notes, and return the exit code."""
    from eurdf.diagnostics import Diagnostics
    from eurdf.linking.description import read_urdf_alone
    from eurdf.writing.generation import generate
    from eurdf.writing.naming_conventions import BadPattern, conventions, hints

    if args.version == "1" and args.root != "fixed":
        raise CannotRun("version 1 cannot state a floating root; use version 2")
    require_urdf(args.urdf)
    options = urdf_options(args)
    try:
        convention = conventions(args.closure, args.motor, args.spherical)
    except BadPattern as reason:
        raise CannotRun(str(reason)) from None
    diagnostics = Diagnostics()
    urdf = read_urdf_alone(args.urdf, diagnostics, **options)
    if urdf is None:
        show_report(shown(args.urdf), tuple(diagnostics), args.json)
        return 1
    source = urdf.document.source
    if args.version == "1":  # which cannot name a xacro
        source = replace(source, made_from=())
    urdf_path = urdf_named(args.output or args.urdf, source)
    if args.output is not None:
        refuse_to_replace(args.output, args.force)

    @cache
    def beside(version: GeneratedVersion) -> EditorSchema | None:
        return None if args.output is None else schema_beside(args.output, version, args.schema, urdf, args.force)

    def reference(version: GeneratedVersion) -> str | None:
        schema = beside(version)
        return None if schema is None else schema.reference

    generation = generate(urdf, convention, args.version, args.root, urdf_path, reference, args.type)
    schema = beside(generation.version)
    advice = hints(urdf, generation.found, convention)
    if generation.mechanism is None:
        show_report(shown(args.urdf), tuple(generation.diagnostics), args.json)
        print_notes(["nothing was written: the names contradict each other"])
        return 1
    if args.output is not None:
        write_described(args.output, generation.text, schema, args.force)
    warnings = [found.message for found in diagnostics if found.code == "x-xacro-warning"]
    ignored = (f"{found.message}; {found.hint}" for found in diagnostics if found.code == "urdf-closure-ignored")
    warnings += dict.fromkeys(ignored)
    warnings += generation.found.warnings
    warnings += urdf_notes(source, urdf_path, options["xacro_args"])
    if args.version == "1" and urdf_path != "robot.urdf":
        warnings.append(f"version 1 cannot name its URDF; rename '{urdf_path}' to robot.urdf, beside the description")
    if args.json:
        write_json(_result(generation, args.output, schema, warnings, advice))
        return 0
    if args.output is None:
        write_yaml(generation.text)
    print_notes(
        [
            *_summary(generation),
            *(f"note: {note}" for note in generation.notes),
            *(f"warning: {warning}" for warning in warnings),
            *(f"hint: {hint}" for hint in advice),
        ]
    )
    if args.output is not None:
        print_notes([f"wrote '{args.output}'"])
    elif args.schema != "none":
        print_notes([NOT_BESIDE])
    if schema is not None:
        report_schema(schema)
    return 0


def _summary(generation: Generation) -> list[str]:
    found = generation.found
    closures = [f"{closure.name} ({', '.join(closure.frames)}, {closure.type})" for closure in found.closures]
    lines = [_count("closure", closures), _count("motor", found.motors)]
    if found.sphericals:
        lines.append(_count("spherical joint", found.sphericals))
    if generation.merges:
        lines.append(
            _count(
                "spherical joint", generation.merges, ", each merged from three revolute joints whose axes intersect"
            )
        )
    return lines


def _count(what: str, names: Collection[str], more: str = "") -> str:
    many = f"{len(names)} {what}{'' if len(names) == 1 else 's'}{more}"
    return many + (f": {', '.join(names)}" if names else "")


def _result(
    generation: Generation,
    output: str | None,
    schema: EditorSchema | None,
    warnings: Sequence[str],
    advice: Sequence[str],
) -> dict[str, Any]:
    from eurdf.diagnostics.report import encodable

    found = generation.found
    return {
        "output": None if output is None else encodable(output),
        "schema": None if schema is None else encodable(os.fspath(schema.path)),
        "closures": [
            {"name": closure.name, "type": closure.type, "frames": list(closure.frames), **closure.axis_keys}
            for closure in found.closures
        ],
        "motors": list(found.motors),
        "sphericals": list(found.sphericals),
        "merges": {name: list(three) for name, three in generation.merges.items()},
        "notes": [encodable(note) for note in generation.notes],
        "warnings": [encodable(warning) for warning in warnings],
        "hints": [encodable(hint) for hint in advice],
        "text": generation.text,
    }
