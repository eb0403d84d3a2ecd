"""An editor, as far as a language server sees one: it opens files, and asks for completion and hover text.

The server is `eurdf server`, or `yaml-language-server` of npm, which `tests/support/editor/package.json` names; VS
Code's YAML extension, Neovim, Emacs and others run it.
"""

from __future__ import annotations

import asyncio
import shutil
from collections.abc import Awaitable, Callable, Sequence
from pathlib import Path
from typing import TypeVar

from lsprotocol import types as lsp
from pygls.lsp.client import BaseLanguageClient

SERVER = Path(__file__).parent / "editor" / "node_modules" / "yaml-language-server" / "bin" / "yaml-language-server"
NODE = shutil.which("node")

#: Why the server cannot be run, or nothing.
MISSING = (
    "Node.js is not on the PATH: install it, then npm install --prefix tests/support/editor"
    if NODE is None
    else ""
    if SERVER.is_file()
    else "the YAML language server is not installed: npm install --prefix tests/support/editor"
)

_TIMEOUT = 60.0

_Answer = TypeVar("_Answer")


class Editor:
    """An editor with a language server and no settings.

    Attributes:
        found: What is underlined, by URI.
    """

    def __init__(self, command: Sequence[str]) -> None:
        self._command = command
        self._client = BaseLanguageClient("editor", "1")
        self.found: dict[str, list[lsp.Diagnostic]] = {}
        self._version = 1

        @self._client.feature(lsp.TEXT_DOCUMENT_PUBLISH_DIAGNOSTICS)
        def _(params: lsp.PublishDiagnosticsParams) -> None:
            self.found[params.uri] = list(params.diagnostics)

        @self._client.feature(lsp.WORKSPACE_CONFIGURATION)
        def _(params: lsp.ConfigurationParams) -> list[object]:
            # No settings, but that nothing is fetched from the network.
            offline = {"schemaStore": {"enable": False}}
            return [offline if item.section == "yaml" else None for item in params.items]

        @self._client.feature(lsp.CLIENT_REGISTER_CAPABILITY)
        def _(params: lsp.RegistrationParams) -> None:
            return None

    async def start(self) -> None:
        await self._client.start_io(*self._command)
        item = lsp.ClientCompletionItemOptions(snippet_support=True)
        document = lsp.TextDocumentClientCapabilities(
            completion=lsp.CompletionClientCapabilities(completion_item=item), hover=lsp.HoverClientCapabilities()
        )
        capabilities = lsp.ClientCapabilities(text_document=document)
        await self._client.initialize_async(lsp.InitializeParams(capabilities=capabilities))
        self._client.initialized(lsp.InitializedParams())

    async def stop(self) -> None:
        await self._client.shutdown_async(None)
        self._client.exit(None)
        await self._client.stop()

    async def open(self, path: Path) -> list[tuple[int, int, str]]:
        """Open a file, and wait for what is underlined: line and column, from 1, and message."""
        uri = path.as_uri()
        text = path.read_text(encoding="utf-8")
        self._client.text_document_did_open(lsp.DidOpenTextDocumentParams(lsp.TextDocumentItem(uri, "yaml", 1, text)))
        while uri not in self.found:
            await asyncio.sleep(0.02)
        return sorted((at.range.start.line + 1, at.range.start.character + 1, at.message) for at in self.found[uri])

    async def type(self, path: Path, text: str, *, of: Path | None = None) -> list[lsp.Diagnostic]:
        """Give a file that is open another text, and wait for what is underlined in it, or in another file."""
        self._version += 1
        document = lsp.VersionedTextDocumentIdentifier(version=self._version, uri=path.as_uri())
        change = lsp.TextDocumentContentChangeWholeDocument(text=text)
        params = lsp.DidChangeTextDocumentParams(document, [change])
        uri = (of or path).as_uri()
        self.found.pop(uri, None)
        self._client.text_document_did_change(params)
        while uri not in self.found:
            await asyncio.sleep(0.01)
        return self.found[uri]

    def close(self, path: Path) -> None:
        identifier = lsp.TextDocumentIdentifier(path.as_uri())
        self._client.text_document_did_close(lsp.DidCloseTextDocumentParams(identifier))

    async def code_actions(self, path: Path, where: lsp.Range) -> list[lsp.CodeAction]:
        document = lsp.TextDocumentIdentifier(path.as_uri())
        params = lsp.CodeActionParams(document, where, lsp.CodeActionContext([]))
        found = await self._client.text_document_code_action_async(params)
        return [each for each in found or () if isinstance(each, lsp.CodeAction)]

    async def code_lenses(self, path: Path) -> Sequence[lsp.CodeLens]:
        params = lsp.CodeLensParams(lsp.TextDocumentIdentifier(path.as_uri()))
        return await self._client.text_document_code_lens_async(params) or ()

    async def rename(self, path: Path, at: lsp.Position, name: str) -> lsp.WorkspaceEdit | None:
        params = lsp.RenameParams(lsp.TextDocumentIdentifier(path.as_uri()), at, name)
        return await self._client.text_document_rename_async(params)

    async def command(self, name: str, *arguments: object) -> None:
        await self._client.workspace_execute_command_async(lsp.ExecuteCommandParams(name, list(arguments)))

    async def completions(self, path: Path, line: int, column: int) -> list[str]:
        """What is offered at a place of an open file, line and column from 1."""
        at = lsp.CompletionParams(lsp.TextDocumentIdentifier(path.as_uri()), lsp.Position(line - 1, column - 1))
        answer = await self._client.text_document_completion_async(at)
        items = answer.items if isinstance(answer, lsp.CompletionList) else answer or []
        return [item.label for item in items]

    async def hover(self, path: Path, line: int, column: int) -> str:
        """The text shown where the pointer rests, line and column from 1."""
        at = lsp.HoverParams(lsp.TextDocumentIdentifier(path.as_uri()), lsp.Position(line - 1, column - 1))
        answer = await self._client.text_document_hover_async(at)
        if answer is None:
            return ""
        assert isinstance(answer.contents, lsp.MarkupContent)
        return answer.contents.value


def in_editor(session: Callable[[Editor], Awaitable[_Answer]], command: Sequence[str] = ()) -> _Answer:
    """Run a session in an editor that is started for it, with the server of YAML by default; return what it returns."""

    async def run() -> _Answer:
        editor = Editor(command or (str(NODE), str(SERVER), "--stdio"))
        await editor.start()
        try:
            return await session(editor)
        finally:
            await editor.stop()

    return asyncio.run(asyncio.wait_for(run(), _TIMEOUT))
