"""``eurdf migrate``: convert a description from version 1 to version 2."""

from __future__ import annotations

import os
from pathlib import Path
from typing import Any

from eurdf.commands.command import FORCE_DESCRIPTION, OUTPUT, ROBOT, cannot_run, command, flag
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
from eurdf.errors import CannotMigrate

_DESCRIPTION = """\
Convert a description from version 1 to version 2, with the same model.

Version 2 states explicitly what version 1 implies: merged revolute joints, names of closures. If the URDF has mimic
joints, which version 1 lets move freely, the result has version 2.1, which can say so; else version 2.0. Comments and
your own data are kept; your own keys get the prefix x-. Before the result is written, it is read and checked: if its
model differs, nothing is written.
"""


@command(
    summary="convert a description from version 1 to version 2",
    description=_DESCRIPTION,
    exit_codes="0 written or nothing to do, 1 the robot has errors, 2 the command cannot run.",
    examples=("eurdf migrate robot.v1.yaml -o robot.yaml",),
)
def migrate(
    options: dict[str, Any],
    path: str = ROBOT,
    output: str | None = OUTPUT,
    force: bool = FORCE_DESCRIPTION,
    schema: str = SCHEMA,
    json: bool = flag("write one JSON object: the text, and what was done"),
) -> int:
    """Migrate and write a description, and print notes."""
    from eurdf.linking.robot_files import read_valid
    from eurdf.writing.migrated_text import schema_named, version_needed
    from eurdf.writing.new_description import described, migrated, nothing_to_do, urdf_named

    read = read_valid(path, **options)
    with cannot_run(CannotMigrate):
        document = described(read)
    version, tree = read.description.version, read.urdf
    source, urdf = document.source, tree.document.source
    if version != "1":
        written: str = version
        file = DescriptionFile(None, source.text, None)
        notes = [nothing_to_do(read)]
    else:
        beside: EditorSchema | None = None
        reference = schema_named(document, tree) if schema == "format" else None
        if output is not None and not _leads_to_a_schema(reference, output):
            refuse_to_replace(output, force)
            beside = schema_beside(output, version_needed(tree), schema, tree, force)
            reference = None if beside is None else beside.reference
        urdf_path = urdf_named(output or source.file, urdf)
        with cannot_run(CannotMigrate):
            made = migrated(read, urdf_path, reference)
        file, written = DescriptionFile(output, made.text, beside), made.mechanism.version
        notes = [*made.notes, *urdf_notes(urdf, urdf_path, options["xacro_args"])]
        file.write(force)
        if output is None and reference is None and schema != "none":
            notes.append(NOT_BESIDE)
    if json:
        names = {"path": read.path, "from": version, "to": written}
        write_result({**names, **file.paths, "notes": notes, "text": file.text})
    else:
        near = (str(found) for found in read.diagnostics if found.code == "near-miss-key")
        file.show([*notes, *near], as_text=output is None)
    return 0


def _leads_to_a_schema(reference: str | None, output: str) -> bool:
    """Whether the schema that the first line of a description names exists."""
    if reference is None:
        return False
    return reference.startswith(("http://", "https://")) or os.path.isfile(os.path.join(Path(output).parent, reference))
