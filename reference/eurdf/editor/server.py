"""The server: what the editor asks, and the checks that run after each change while it goes on asking.

A check runs in a thread at each change, as soon as the one before has ended. What takes longer (causes, trials of
fixes, mobility) runs in a second thread when nothing was typed for a moment, and ends when something is.
"""

from __future__ import annotations

import asyncio
import logging
import subprocess
import sys
from collections.abc import Callable
from concurrent.futures import ThreadPoolExecutor
from contextlib import suppress
from functools import partial
from typing import Any, TypeVar

from lsprotocol import types as lsp
from pygls.exceptions import JsonRpcInvalidParams
from pygls.lsp.server import LanguageServer

from eurdf import __version__
from eurdf.editor import actions, navigation
from eurdf.editor.completion import completions
from eurdf.editor.documents import path_of
from eurdf.editor.hover import hover
from eurdf.editor.open_robots import KnownRobot, OpenRobots
from eurdf.editor.shown import SOURCE, shown
from eurdf.errors import CannotRun

#: Time without a change after which what takes longer begins, s.
PAUSE = 0.2

#: Time that a request waits at most for what takes longer, s.
PATIENCE = 3.0

_Answer = TypeVar("_Answer")


class EditorServer(LanguageServer):
    """The language server of one editor.

    Attributes:
        robots: The robots that are open in it.
    """

    def __init__(self) -> None:
        super().__init__(SOURCE, __version__, text_document_sync_kind=lsp.TextDocumentSyncKind.Full)
        self.robots = OpenRobots()
        self._due: dict[str, None] = {}  # robots to check
        self._later: dict[str, None] = {}  # robots of which more is to be found out
        self._changes = 0
        self._change = asyncio.Event()
        self._task: asyncio.Task[None] | None = None
        self._published: dict[str, list[lsp.Diagnostic]] = {}
        self._at_once, self._slowly = ThreadPoolExecutor(1), ThreadPoolExecutor(1)
        self._viewers: list[subprocess.Popen[bytes]] = []
        _add_features(self)

    # -- documents ----------------------------------------------------------------------------------------------------

    def changed(self, uri: str, text: str) -> None:
        """Take the text of a document, and check the robots that it belongs to."""
        path = self.robots.documents.change(uri, text)
        if path is not None:
            self._check(self.robots.robots_of(path))

    def saved(self, uri: str) -> None:
        """Check again what depends on a file that was written."""
        path = path_of(uri)
        if path is not None and path in self.robots.documents.opened:
            self.robots.saved(path)
            self.changed(uri, self.robots.documents.opened[path].text)
            self._check([*self.robots.examined])

    def closed(self, uri: str) -> None:
        """Forget a document; the robots of the others are checked with the file as it is on the disk."""
        if self.robots.documents.close(uri) is not None:
            opened = [*self.robots.documents.opened]
            left = dict.fromkeys(robot for path in opened for robot in self.robots.robots_of(path))
            self.robots.examined = {path: each for path, each in self.robots.examined.items() if path in left}
            self._check([*left])
            self._publish()

    # -- checks -------------------------------------------------------------------------------------------------------

    async def settled(self) -> None:
        """Wait until nothing more is to be found out, or until `PATIENCE` ends."""
        if self._task is not None:
            await asyncio.wait([self._task], timeout=PATIENCE)

    def _check(self, robots: list[str]) -> None:
        self._changes += 1
        self._change.set()
        self._due |= dict.fromkeys(robots)
        if self._task is None or self._task.done():
            self._task = asyncio.get_running_loop().create_task(self._work())

    async def _work(self) -> None:
        while self._due or self._later:
            if self._due:
                robot = next(iter(self._due))
                del self._due[robot]
                self._later[robot] = None
                await self._examine(robot, self._at_once, None)
                continue
            if not await self._typed_within(PAUSE):
                robot = next(iter(self._later))
                if await self._examine(robot, self._slowly, partial(self._is_unchanged, self._changes)):
                    del self._later[robot]

    async def _typed_within(self, seconds: float) -> bool:
        """Wait for a change, or until a time has passed; whether there was one."""
        self._change.clear()
        with suppress(asyncio.TimeoutError):
            await asyncio.wait_for(self._change.wait(), seconds)
        return self._change.is_set()

    def _is_unchanged(self, changes: int) -> bool:
        return changes == self._changes

    async def _examine(self, robot: str, pool: ThreadPoolExecutor, tries: Callable[[], bool] | None) -> bool:
        """Examine a robot in a thread; whether it has not changed meanwhile."""
        changes, loop = self._changes, asyncio.get_running_loop()
        task = partial(self.robots.examine, robot, self.robots.snapshot(), tries)
        try:
            examining = loop.run_in_executor(pool, task)
            if tries is not None:
                change = loop.create_task(self._change.wait())
                await asyncio.wait((examining, change), return_when=asyncio.FIRST_COMPLETED)
                change.cancel()
                if not examining.done():
                    return False  # what it finds will be of a text that is past
            examined: KnownRobot = await examining
        except Exception:  # a bug, which must not keep the editor from being served
            logging.getLogger(__name__).exception("cannot check '%s'", robot)
            self.window_log_message(lsp.LogMessageParams(lsp.MessageType.Error, f"cannot check '{robot}': see the log"))
            return True
        if tries is None or changes == self._changes:
            self.robots.examined[robot] = examined
            self._publish(robot)
        return changes == self._changes

    def _publish(self, robot: str | None = None) -> None:
        """Tell the editor what changed, and what is found in the file of a robot in any case."""
        found = self.robots.found()
        for path in dict.fromkeys((*found, *self._published)):
            diagnostics = [shown(self.robots, path, each) for each in found.get(path, ())]
            if path == robot or diagnostics != self._published.get(path):
                uri = self.robots.documents.uri(path)
                self.text_document_publish_diagnostics(lsp.PublishDiagnosticsParams(uri, diagnostics))
                self._published[path] = diagnostics
        for path in self._published.keys() - found.keys():
            del self._published[path]

    # -- commands -----------------------------------------------------------------------------------------------------

    def view(self, path: str) -> None:
        """Show the file of a robot in the viewer, which follows it when it is written."""
        command = [sys.executable, "-m", "eurdf", "view", path]
        viewer = subprocess.Popen(command, stdin=subprocess.DEVNULL, stdout=subprocess.DEVNULL)
        self._viewers.append(viewer)

    def end(self) -> None:
        """End what was started."""
        for viewer in self._viewers:
            viewer.terminate()
        for pool in (self._at_once, self._slowly):
            pool.shutdown(wait=False, cancel_futures=True)


def _add_features(server: EditorServer) -> None:
    """Let the server answer what the protocol asks."""
    robots = server.robots

    def path(document: lsp.TextDocumentIdentifier) -> str | None:
        found = path_of(document.uri)
        return found if found in robots.documents.opened else None

    def of_place(answer: Callable[[OpenRobots, str, lsp.Position], _Answer]) -> Callable[[Any], _Answer | None]:
        def asked(params: Any) -> _Answer | None:
            at = path(params.text_document)
            return None if at is None else answer(robots, at, params.position)

        return asked

    def refusing(answer: Callable[[], _Answer]) -> _Answer:
        try:
            return answer()
        except (navigation.CannotRename, CannotRun) as reason:
            raise JsonRpcInvalidParams(str(reason)) from None

    @server.feature(lsp.INITIALIZE)
    def _(params: lsp.InitializeParams) -> None:
        robots.documents.encoding = str(getattr(server.workspace.position_encoding, "value", "utf-16"))

    @server.feature(lsp.TEXT_DOCUMENT_DID_OPEN)
    def _(params: lsp.DidOpenTextDocumentParams) -> None:
        server.changed(params.text_document.uri, params.text_document.text)

    @server.feature(lsp.TEXT_DOCUMENT_DID_CHANGE)
    def _(params: lsp.DidChangeTextDocumentParams) -> None:
        server.changed(params.text_document.uri, params.content_changes[-1].text)

    @server.feature(lsp.TEXT_DOCUMENT_DID_SAVE)
    def _(params: lsp.DidSaveTextDocumentParams) -> None:
        server.saved(params.text_document.uri)

    @server.feature(lsp.TEXT_DOCUMENT_DID_CLOSE)
    def _(params: lsp.DidCloseTextDocumentParams) -> None:
        server.closed(params.text_document.uri)

    triggers = [*'[{ ,:"<=/']
    server.feature(lsp.TEXT_DOCUMENT_COMPLETION, lsp.CompletionOptions(triggers))(of_place(completions))
    server.feature(lsp.TEXT_DOCUMENT_HOVER)(of_place(hover))
    server.feature(lsp.TEXT_DOCUMENT_DEFINITION)(of_place(navigation.definition))

    @server.feature(lsp.TEXT_DOCUMENT_REFERENCES)
    def _(params: lsp.ReferenceParams) -> list[lsp.Location] | None:
        declared = params.context.include_declaration
        return of_place(partial(navigation.references, declared=declared))(params)

    @server.feature(lsp.TEXT_DOCUMENT_DOCUMENT_SYMBOL)
    def _(params: lsp.DocumentSymbolParams) -> list[lsp.DocumentSymbol] | None:
        at = path(params.text_document)
        return None if at is None else navigation.symbols(robots, at)

    @server.feature(lsp.TEXT_DOCUMENT_PREPARE_RENAME)
    def _(params: lsp.PrepareRenameParams) -> lsp.Range | None:
        return refusing(lambda: of_place(navigation.to_rename)(params))

    @server.feature(lsp.TEXT_DOCUMENT_RENAME, lsp.RenameOptions(prepare_provider=True))
    def _(params: lsp.RenameParams) -> lsp.WorkspaceEdit | None:
        at = path(params.text_document)
        return None if at is None else refusing(lambda: navigation.rename(robots, at, params.position, params.new_name))

    @server.feature(
        lsp.TEXT_DOCUMENT_CODE_ACTION,
        lsp.CodeActionOptions([lsp.CodeActionKind.QuickFix, lsp.CodeActionKind.SourceFixAll]),
    )
    async def _(params: lsp.CodeActionParams) -> list[lsp.CodeAction] | None:
        await server.settled()
        at = path(params.text_document)
        return None if at is None else actions.code_actions(robots, at, params.range, params.context.only or ())

    @server.feature(lsp.TEXT_DOCUMENT_CODE_LENS)
    async def _(params: lsp.CodeLensParams) -> list[lsp.CodeLens] | None:
        await server.settled()
        at = path(params.text_document)
        return None if at is None else actions.code_lenses(robots, at)

    @server.command(actions.ASSEMBLE)
    async def _(uri: str) -> None:
        at = path(lsp.TextDocumentIdentifier(uri))
        if at is not None:
            edit = refusing(lambda: actions.assembled(robots, at))
            await server.workspace_apply_edit_async(lsp.ApplyWorkspaceEditParams(edit, "assemble"))

    @server.command(actions.VIEW)
    def _(uri: str) -> None:
        at = path(lsp.TextDocumentIdentifier(uri))
        if at is not None:
            server.view(at)
