"""``eurdf server``: the language server, which an editor starts."""

from __future__ import annotations

import os
import sys
from importlib.util import find_spec

from eurdf.commands.command import command
from eurdf.errors import MissingExtra

_DESCRIPTION = """\
Serve an editor that speaks the Language Server Protocol, on standard input and output. In descriptions, URDFs and
xacros that are open, saved or not, it reports what 'eurdf check' reports, completes keys and names, shows what things
are, goes to definitions, renames in all files, and applies fixes. https://microsoft.github.io/language-server-protocol

A xacro is expanded when a description that names it is opened, and when one of its files is saved.
"""


@command(
    summary="serve an editor: diagnostics, completion, renaming and fixes as you type",
    description=_DESCRIPTION,
    exit_codes="0 ended by the editor, 2 the command cannot run.",
    examples=("eurdf server",),
)
def server() -> int:
    """Serve until the editor ends."""
    if find_spec("pygls") is None:
        from eurdf.diagnostics.extras import install_command

        raise MissingExtra("the server needs pygls; install it with: " + install_command("editor"), "editor")
    import logging

    from eurdf.editor.server import EditorServer

    # What a library writes to the standard output must not get between the messages.
    answers = os.fdopen(os.dup(sys.stdout.fileno()), "wb")
    os.dup2(sys.stderr.fileno(), sys.stdout.fileno())
    logging.basicConfig(level=logging.ERROR, stream=sys.stderr)
    serving = EditorServer()
    try:
        serving.start_io(sys.stdin.buffer, answers)
    finally:
        serving.end()
    return 0
