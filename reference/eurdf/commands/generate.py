"""``eurdf generate``: write a description from the names in a URDF."""

from __future__ import annotations

from collections.abc import Collection
from dataclasses import replace
from functools import cache
from typing import TYPE_CHECKING, Any, Literal

from eurdf.commands.command import FORCE_DESCRIPTION, OUTPUT, URDF, cannot_run, command, flag, option, require_urdf
from eurdf.commands.output import write_result
from eurdf.commands.output_file import (
    NOT_BESIDE,
    SCHEMA,
    DescriptionFile,
    EditorSchema,
    refuse_to_replace,
    schema_beside,
    urdf_notes,
)
from eurdf.commands.terminal import write_notes, write_refusal
from eurdf.diagnostics import plural
from eurdf.errors import CannotRun
from eurdf.reading.robot_source import display_name

if TYPE_CHECKING:
    from eurdf.mechanism.mechanism import Root
    from eurdf.writing.generation import Generation
    from eurdf.writing.naming_conventions import GeneratedVersion

_DESCRIPTION = """\
Write a description from the names in a URDF.

  closures    closedloop1_A with closedloop1_B, or closing_knee_1 with closing_knee_2: names of links or joints.
              3d or 6d in the name is the type: closedloop3D_1A, closedloop1_A_3D. closing_knee_1_z and
              closing_knee_2_z, which onshape-to-robot adds on the axis of a revolute mate, are a second point. Closures
              of type 3d that join the same two parts at points that are as far apart in both are one hinge.
  motors      joints whose name begins or ends with the word mot or motor: motor_knee, mot1, left_motor_hip, hip_motor.
              The joints A_B_rev0, A_B_rev1 and A_B_rev2 of a ball mate, named after its parts, are none.
  sphericals  joints with spherical in their name.
  universals  none by their names: --universal says which, with the letters of their axes in the joint's frame.

A closure whose name does not state its type is 6d. It is 3d if with 6d the loops cannot close or move, or motors
depend on one another, and with 3d they do not. A note gives the reason; --type sets the type of all closures.

Three consecutive revolute joints whose axes intersect, with massless links between them, become one spherical joint.

The description is of version 2.0, or of version 2.1 if it has a hinge. In versions 1 and 2.0, the 3d closures hold the
hinge.

PATTERNs are regular expressions that replace these conventions. A closure pattern matches a whole name. Its group side
distinguishes the two frames, the group loop (optional) is their common part, and the group type (optional) is 3d or 6d.
"""


def _pattern(what: str) -> Any:
    return option(f"names of {what} (repeatable)", metavar="PATTERN", action="append", default=[])


@command(
    summary="write a description from the names in a URDF",
    description=_DESCRIPTION,
    exit_codes="0 written, 1 the URDF has errors or its names contradict each other, 2 the command cannot run.",
    examples=(
        "eurdf generate arm.urdf -o arm.yaml",
        "eurdf generate arm.urdf --closure '(?P<loop>rod\\d+)_(?P<side>top|bottom)' --motor 'drive$'",
        "eurdf generate leg.urdf --universal 'xy=free_(knee|foot)'",
    ),
)
def generate(
    options: dict[str, Any],
    urdf: str = URDF,
    output: str | None = OUTPUT,
    force: bool = FORCE_DESCRIPTION,
    schema: str = SCHEMA,
    closure: list[str] = _pattern("the frames of closures"),
    motor: list[str] = _pattern("actuated joints"),
    spherical: list[str] = _pattern("spherical joints"),
    universal: list[str] = option(
        "names of universal joints, after their axes: xy=PATTERN (repeatable)",
        metavar="AXES=PATTERN",
        action="append",
        default=[],
    ),
    closure_type: Literal["3d", "6d"] | None = option(
        "type of all closures, instead of the type from name or motion", "--type", choices=("3d", "6d")
    ),
    root: Root = option("default: fixed", choices=("fixed", "floating"), default="fixed"),
    version: GeneratedVersion | None = option(
        "version of the format; 2 is 2.0; default: 2, or 2.1 if there is a hinge", choices=("1", "2", "2.1")
    ),
    json: bool = flag("write one JSON object: the text, and what was found"),
) -> int:
    """Generate and write a description, and print notes."""
    from eurdf.diagnostics import Diagnostics
    from eurdf.linking.robot_files import read_urdf_alone
    from eurdf.writing import generation
    from eurdf.writing.naming_conventions import BadPattern, conventions
    from eurdf.writing.new_description import urdf_named

    if version == "1" and root != "fixed":
        raise CannotRun("version 1 cannot state a floating root; use version 2")
    require_urdf(urdf)
    with cannot_run(BadPattern):
        convention = conventions(closure, motor, spherical, universal)
    diagnostics = Diagnostics()
    tree = read_urdf_alone(urdf, diagnostics, **options)
    source = tree.document.source
    if version == "1":  # which cannot name a xacro
        source = replace(source, made_from=())
    urdf_path = urdf_named(output or urdf, source)
    if output is not None:
        refuse_to_replace(output, force)

    @cache
    def beside(version: GeneratedVersion) -> EditorSchema | None:
        return None if output is None else schema_beside(output, version, schema, tree, force)

    def reference(version: GeneratedVersion) -> str | None:
        made = beside(version)
        return None if made is None else made.reference

    made = generation.generate(tree, convention, version, root, urdf_path, reference, closure_type)
    if made.mechanism is None:
        write_refusal(display_name(urdf), made.diagnostics, json)
        write_notes(["nothing was written: the names contradict each other"], quiet=False)
        return 1
    warnings = [found.message for found in diagnostics if found.code == "x-xacro-warning"]
    ignored = (f"{found.message}; {found.hint}" for found in diagnostics if found.code == "urdf-closure-ignored")
    warnings += dict.fromkeys(ignored)
    warnings += made.found.warnings
    warnings += urdf_notes(source, urdf_path, options["xacro_args"])
    if version == "1" and urdf_path != "robot.urdf":
        warnings.append(f"version 1 cannot name its URDF; rename '{urdf_path}' to robot.urdf, beside the description")
    notes = [
        *_summary(made),
        *(f"note: {note}" for note in made.notes),
        *(f"warning: {warning}" for warning in warnings),
        *(f"hint: {hint}" for hint in made.hints),
    ]
    file = DescriptionFile(output, made.text, beside(made.version))
    file.write(force)
    if json:
        found = made.found
        closures = [
            {"name": each.name, "type": each.type, "frames": each.frames, **each.axis_keys} for each in found.closures
        ]
        names = {"motors": found.motors, "sphericals": found.sphericals, "merges": made.merges}
        names["universals"] = dict(found.universals)
        sentences = {"notes": made.notes, "warnings": warnings, "hints": made.hints}
        write_result({**file.paths, "closures": closures, **names, **sentences, "text": made.text})
    else:
        file.show(notes if output is not None or schema == "none" else [*notes, NOT_BESIDE], as_text=output is None)
    return 0


def _summary(generation: Generation) -> list[str]:
    found = generation.found
    closures = [f"{closure.name} ({', '.join(closure.frames)}, {closure.type})" for closure in found.closures]
    merged = ", each merged from three revolute joints whose axes intersect"
    return [
        _count("closure", closures),
        _count("motor", found.motors),
        *([_count("spherical joint", found.sphericals)] if found.sphericals else []),
        *([_count("universal joint", found.universals)] if found.universals else []),
        *([_count("spherical joint", generation.merges, merged)] if generation.merges else []),
    ]


def _count(what: str, names: Collection[str], more: str = "") -> str:
    return plural(len(names), what) + more + (f": {', '.join(names)}" if names else "")
