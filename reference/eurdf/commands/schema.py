"""``eurdf schema``: write the JSON Schema of the format, for editors."""

from __future__ import annotations

from typing import Any

from eurdf.commands.command import OUTPUT, URDF_OPTIONS, WrittenInfo, command, flag, option, require_urdf
from eurdf.commands.output import write_result
from eurdf.commands.output_file import write_new
from eurdf.commands.terminal import write_notes, write_text
from eurdf.errors import CannotRun

_NAMES: Any = (
    option(
        "include the names of the links and joints of this robot, so that editors complete them",
        "--for",
        metavar="URDF",
    ),
    *URDF_OPTIONS,
)


@command(
    summary="write the JSON Schema of a description, for editors",
    description="Write the JSON Schema (2020-12) of Extended URDF. The first line of a description names it:\n\n"
    "  # yaml-language-server: $schema=./robot.schema.json",
    exit_codes="0 written, 1 the URDF has errors, 2 the command cannot run.",
    examples=("eurdf schema --for robot.urdf -o robot.schema.json",),
)
def schema(
    options: dict[str, Any],
    version: Any = option("version of the format; default: 2, which is 2.0", choices=("1", "2", "2.1"), default="2"),
    urdf: str | None = _NAMES,
    output: str | None = OUTPUT,
    force: bool = flag("replace OUT if it exists"),
    json: bool = flag("with -o, write one JSON object; the schema is JSON without it"),
) -> int:
    """Write the schema."""
    from eurdf.diagnostics import Diagnostics
    from eurdf.format.schema import json_schema, names_of, schema_text
    from eurdf.linking.robot_files import read_urdf_alone

    names = None
    if urdf is not None:
        require_urdf(urdf)
        names = names_of(read_urdf_alone(urdf, Diagnostics(), **options))
    elif any(options.values()):
        raise CannotRun("--package-dir and --xacro-arg need --for")
    text = schema_text(json_schema(version, names))
    if output is None:
        write_text(text)
    else:
        write_new(output, text, force)
        if json:
            write_result(WrittenInfo((output,), None))
        write_notes([f"wrote '{output}'"])
    return 0
