"""What the editor can do with a robot: apply fixes, write the assembled configuration, show it in the viewer."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from pathlib import Path

from lsprotocol import types as lsp

from eurdf.diagnostics import Diagnostic, Edit, Fix
from eurdf.diagnostics.lines import Lines
from eurdf.editor.documents import is_xml_file
from eurdf.editor.open_robots import OpenRobots
from eurdf.editor.shown import shown
from eurdf.errors import CannotRun, InvalidRobot
from eurdf.linking.robot_files import read_valid

#: Commands of the code lens, each with the URI of the document as its argument.
ASSEMBLE, VIEW = "eurdf.assemble", "eurdf.view"


def code_actions(robots: OpenRobots, path: str, where: lsp.Range, only: Sequence[str] = ()) -> list[lsp.CodeAction]:
    """The fixes at a place of a document, each tried by a check; and all of the document at once."""
    fixable = [each for each in robots.found().get(path, ()) if each.fix is not None and _is_current(robots, each.fix)]
    found = [*_quick_fixes(robots, path, where, fixable)]
    if fixable:
        together = Fix.together(each.fix for each in fixable if each.fix is not None)
        edit = robots.documents.workspace_edit(together.edits)
        found.append(lsp.CodeAction("Apply all fixes of this robot", lsp.CodeActionKind.SourceFixAll, edit=edit))
    return [each for each in found if not only or any(str(each.kind).startswith(str(kind)) for kind in only)]


def _quick_fixes(
    robots: OpenRobots, path: str, where: lsp.Range, fixable: list[Diagnostic]
) -> Iterator[lsp.CodeAction]:
    for found in fixable:
        diagnostic = shown(robots, path, found)
        if found.fix is not None and diagnostic.range.start <= where.end and where.start <= diagnostic.range.end:
            yield lsp.CodeAction(
                title=found.fix.summary[:1].upper() + found.fix.summary[1:],
                kind=lsp.CodeActionKind.QuickFix,
                diagnostics=[diagnostic],
                is_preferred=True,
                edit=robots.documents.workspace_edit(found.fix.edits),
            )


def _is_current(robots: OpenRobots, fix: Fix) -> bool:
    """Whether the files of a fix still have the texts that it changes."""
    return all(edit.lines.text == robots.documents.text(edit.file) for edit in fix.edits)


def code_lenses(robots: OpenRobots, path: str) -> list[lsp.CodeLens]:
    """How the robot of a description moves, over its closures; and what can be done with it."""
    examined = robots.examined.get(path)
    document = None if is_xml_file(path) else robots.documents.yaml(path)
    if examined is None or examined.figures is None or document is None:
        return []
    of = examined.figures.analysis
    titles = {"nv": of.nv, "rows": of.nc, "rank": of.rank, "mobility": of.mobility, "residual": f"{of.residual:.1e}"}
    title = " · ".join(f"{name} {'unknown' if value is None else value}" for name, value in titles.items())
    key = next((each for each in ("closures", "couplings", "closed_loop") if each in document.data), None)
    start, _ = (0, 0) if key is None else document.span((key,), True)
    where = robots.documents.range(document.source.lines, start, start)
    uri = robots.documents.uri(path)
    commands = [lsp.Command(title, ""), lsp.Command("view", VIEW, arguments=[uri])]
    if document.data.get("extended_urdf"):  # version 1 has no configurations
        commands.insert(1, lsp.Command("assemble", ASSEMBLE, arguments=[uri]))
    return [lsp.CodeLens(where, each) for each in commands]


def assembled(robots: OpenRobots, path: str) -> lsp.WorkspaceEdit:
    """The edit that writes the closed configuration ``assembled`` into a description.

    Raises:
        CannotRun: The robot has errors, or no closed configuration is found within the limits.
    """
    from eurdf.kinematics.assembly import assemble  # only now: a simulator
    from eurdf.linking.configurations import beyond_limits
    from eurdf.pinocchio.robot import build_robot
    from eurdf.writing.saved_configuration import with_closed_configuration
    from eurdf.writing.yaml_edits import NotEditable

    try:
        read = read_valid(Path(path), texts=robots.snapshot())
    except InvalidRobot as error:
        raise CannotRun(f"correct this first: {error.diagnostics[0]}") from None
    robot = build_robot(read.mechanism, geometry=False)
    found = assemble(robot, limits=True)
    if not found.closes or beyond_limits(robot.mechanism.joints, robot.joint_positions(found.q)):
        raise CannotRun("no configuration within the joint limits was found that closes the loops")
    try:
        text, _ = with_closed_configuration(read, robot, found.q)
    except NotEditable as error:
        raise CannotRun(f"{error}; edit the file by hand") from None
    lines = Lines(robots.documents.text(path))
    return robots.documents.workspace_edit([_changed(path, lines, text)])


def _changed(path: str, lines: Lines, text: str) -> Edit:
    """The edit that makes one text of another: what differs, from the first character to the last."""
    before = lines.text
    start = next((i for i, (a, b) in enumerate(zip(before, text, strict=False)) if a != b), min(len(before), len(text)))
    same = 0
    while same < min(len(before), len(text)) - start and before[-1 - same] == text[-1 - same]:
        same += 1
    return Edit(path, start, len(before) - same, text[start : len(text) - same], lines)
