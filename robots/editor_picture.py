"""Draws a session in Neovim that writes the tutorial's robot: ``python -m robots.editor_picture [-o FILE]``."""

from __future__ import annotations

import os
import re
import subprocess
import sys
import tempfile
import time
from collections.abc import Callable, Sequence
from pathlib import Path
from typing import TYPE_CHECKING, Any

from robots.drawing import draw

if TYPE_CHECKING:
    from PIL.Image import Image

_ROOT = Path(__file__).parents[1]
_COLUMNS, _ROWS = 100, 22
_PATIENCE = 60.0  # the longest wait for what Neovim shows, s
_KEY_TIME, _LOOK_TIME, _END_TIME = 40, 1600, 5000  # how long a frame shows: after a key, to be read, at the end, ms
_FONT, _SIZE = "DejaVuSansMono.ttf", 15  # pixels
_KEYS, _COLORS = 3, 32  # keys from a frame to the next, and colours of all frames: both make the file small
_LOOK = " | ".join(
    (
        "filetype plugin on | filetype indent off",
        "set termguicolors noautoindent nohlsearch completeopt=menuone",
        "set number signcolumn=yes laststatus=0 noruler noshowcmd shortmess+=I",
        "highlight Normal guifg=#d8dee9 guibg=#1f232b",
        "highlight Pmenu guifg=#d8dee9 guibg=#3b4252",
        "highlight PmenuSel guifg=#1f232b guibg=#88c0d0",
        "highlight NormalFloat guibg=#2e3440",
        "highlight MsgSeparator guibg=#3b4252",
        "highlight EndOfBuffer guifg=#1f232b",
        "highlight DiagnosticError guifg=#e6818a",
        "highlight LspCodeLens guifg=#8793aa",
        "highlight LspCodeLensSeparator guifg=#8793aa",
        "highlight SignColumn guibg=#1f232b",
        "highlight LineNr guifg=#616e88",
        "highlight Identifier guifg=#88c0d0",
    )
)

#: A cell of the screen: its character, and the number of its highlight.
_Cell = tuple[str, int]


class Neovim:
    """Neovim with a screen, and a user who types and waits for what it shows.

    Its settings are the Lua of ``docs/editor.md``, so `eurdf` is on the PATH.

    Attributes:
        frames: The screens that were shown, each with its time, ms.
    """

    def __init__(self, folder: Path, program: str = "nvim") -> None:
        import msgpack

        (settings,) = re.findall(r"```lua\n(.*?)```", (_ROOT / "docs" / "editor.md").read_text("utf-8"), re.DOTALL)
        (folder / "init.lua").write_text(settings, encoding="utf-8")
        path = os.pathsep.join((str(Path(sys.executable).parent), os.environ.get("PATH", "")))
        self._process = subprocess.Popen(
            [program, "--clean", "--embed", "--cmd", _LOOK, "-S", "init.lua"],
            cwd=folder,
            env={**os.environ, "PATH": path, "XDG_STATE_HOME": str(folder / "state")},
            stdin=subprocess.PIPE,
            stdout=subprocess.PIPE,
        )
        self._pack = msgpack.packb
        self._unpacker = msgpack.Unpacker(raw=False, strict_map_key=False)
        self._answers: dict[int, tuple[Any, Any]] = {}
        self._count = 0
        self._cells: list[list[_Cell]] = []
        self._cursor = 0, 0
        self._highlights: dict[int, dict[str, Any]] = {0: {}}
        self.frames: list[tuple[Screen, int]] = []
        self.call("nvim_ui_attach", _COLUMNS, _ROWS, {"rgb": True, "ext_linegrid": True})
        os.set_blocking(self._process.stdout.fileno(), False)  # type: ignore[union-attr]

    def __enter__(self) -> Neovim:
        return self

    def __exit__(self, *_: object) -> None:
        self._process.kill()
        self._process.communicate()

    def call(self, name: str, *arguments: Any) -> Any:
        """The answer of a function of Neovim's API."""
        self._count += 1
        assert self._process.stdin is not None
        self._process.stdin.write(self._pack([0, self._count, name, arguments]))
        self._process.stdin.flush()
        self._until(lambda: self._count in self._answers, name)
        error, answer = self._answers.pop(self._count)
        if error:
            raise RuntimeError(f"{name}: {error[1]}")
        return answer

    def lua(self, expression: str) -> Any:
        """The value of an expression of Lua."""
        return self.call("nvim_exec_lua", f"return {expression}", [])

    def type(self, keys: str) -> None:
        """Type keys, as Neovim names them, one by one."""
        for number, key in enumerate(re.findall(r"<[^<>]+>|.", keys)):
            self.call("nvim_input", key)
            self._settle()
            if number % _KEYS == 0:
                self._look(_KEYS * _KEY_TIME)

    def see(self, *texts: str, gone: str = "") -> None:
        """Wait until texts are on the screen, and one is not, and look at them."""

        def seen() -> bool:
            shown = str(self.screen())
            return all(text in shown for text in texts) and (not gone or gone not in shown)

        self._until(seen, f"{texts}, not {gone!r}")
        self._settle()
        self._look(_LOOK_TIME)

    def screen(self) -> Screen:
        """What is shown now."""
        return Screen([[*row] for row in self._cells], self._cursor, self._highlights)

    def _look(self, milliseconds: int) -> None:
        self.frames.append((self.screen(), milliseconds))

    def _until(self, done: Callable[[], bool], what: str) -> None:
        end = time.monotonic() + _PATIENCE
        while not done():
            if time.monotonic() > end or self._process.poll() is not None:
                raise TimeoutError(f"Neovim does not show {what}:\n{self.screen()}")
            self._read()

    def _settle(self) -> None:
        """Read until Neovim draws nothing for a moment."""
        while self._read():
            pass

    def _read(self) -> bool:
        """Take what Neovim says; whether it said something within 10 ms."""
        time.sleep(0.01)
        try:
            data = os.read(self._process.stdout.fileno(), 1 << 20)  # type: ignore[union-attr]
        except BlockingIOError:
            return False
        self._unpacker.feed(data)
        for message in self._unpacker:
            if message[0] == 1:
                self._answers[message[1]] = message[2], message[3]
            elif message[0] == 2 and message[1] == "redraw":
                for name, *events in message[2]:
                    for event in events:
                        self._draw(name, event)
        return bool(data)

    def _draw(self, name: str, event: list[Any]) -> None:
        if name == "grid_resize" or name == "grid_clear":
            self._cells = [[(" ", 0)] * _COLUMNS for _ in range(_ROWS)]
        elif name == "hl_attr_define":
            self._highlights[event[0]] = event[1]
        elif name == "default_colors_set":
            self._highlights[0] = {"foreground": event[0], "background": event[1]}
        elif name == "grid_cursor_goto":
            self._cursor = event[1], event[2]
        elif name == "grid_scroll":
            _, top, bottom, left, right, rows, _ = event
            for row in range(top, bottom - rows) if rows > 0 else range(bottom - 1, top - rows - 1, -1):
                self._cells[row][left:right] = self._cells[row + rows][left:right]
        elif name == "grid_line":
            _, row, column, cells, *_ = event
            highlight = 0
            for text, *more in cells:
                highlight = more[0] if more else highlight
                for _ in range(more[1] if len(more) > 1 else 1):
                    self._cells[row][column] = text, highlight
                    column += 1


class Screen:
    """What Neovim shows: characters with their colours, and the cursor."""

    def __init__(
        self, cells: list[list[_Cell]], cursor: tuple[int, int], highlights: dict[int, dict[str, Any]]
    ) -> None:
        self.cells, self.cursor, self.highlights = cells, cursor, highlights

    def __str__(self) -> str:
        return "\n".join("".join(text for text, _ in row).rstrip() for row in self.cells)

    def image(self) -> Image:
        """The screen as a picture."""
        from PIL import Image as Pillow
        from PIL import ImageDraw, ImageFont

        font = ImageFont.truetype(_FONT, _SIZE)
        width, height = round(font.getlength("M")), _SIZE + 5
        default = self.highlights[0]
        image = Pillow.new("RGB", (_COLUMNS * width, _ROWS * height), _color(default["background"]))
        pen = ImageDraw.Draw(image)
        for row, cells in enumerate(self.cells):
            for column, (text, number) in enumerate(cells):
                style = self.highlights[number]
                colors = [style.get(each, default[each]) for each in ("foreground", "background")]
                if style.get("reverse", False) ^ ((row, column) == self.cursor):
                    colors.reverse()
                x, y = column * width, row * height
                if colors[1] != default["background"]:
                    pen.rectangle((x, y, x + width - 1, y + height - 1), fill=_color(colors[1]))
                pen.text((x, y + 1), text, fill=_color(colors[0]), font=font)
                if style.get("underline") or style.get("undercurl"):
                    line = _color(style.get("special", colors[0]))
                    pen.line((x, y + height - 2, x + width - 1, y + height - 2), fill=line, width=1)
        return image


def _color(value: int) -> str:
    return f"#{value:06x}"


def tutorial(folder: Path) -> str:
    """Write the URDF of the tutorial into a folder; its last description."""
    text = (_ROOT / "spec" / "tutorial.md").read_text(encoding="utf-8")
    (urdf,) = re.findall(r":file: robot\.urdf\n(.*?)```", text, re.DOTALL)
    (folder / "robot.urdf").write_text(urdf, encoding="utf-8")
    *_, last = re.findall(r"```\{example\} valid\n:with: tutorial\n(.*?)```", text, re.DOTALL)
    return str(last)


def write_robot(editor: Neovim) -> None:
    """Write the tutorial's description from an empty file until it is valid, with two mistakes and a wrong name."""
    menu = "<C-x><C-o>"
    editor.type(":edit robot.yaml<CR>")
    editor.see("the file is empty")
    editor.type("iex" + menu)
    editor.see("required")
    editor.type('<C-y>"2.0"<CR>ur' + menu)
    editor.see("URDF file")
    editor.type("<C-y>" + menu)
    editor.see("File")
    editor.type("<C-y><CR>closures:<CR>  - name: rocker_pin<CR>    type: 6d<CR>")
    editor.type("    frames: [cl" + menu)
    editor.see("closing_rocker_pin_2 ")
    editor.type("<C-n><C-n><C-y>, cl" + menu)
    editor.see("closing_rocker_pin_2 ")
    editor.type("<C-n><C-n><C-y>]<CR>actuators:<CR>  - {" + menu)
    editor.see("Gear ratio")
    editor.type("<C-y>" + menu)
    editor.see("rocker_pivot")
    editor.type("<C-y>, gear_ratio: 20, rotor_inertia: 4.0e-6}<Esc>")
    editor.see("no configuration was found")
    editor.type("4G<C-w>d")
    editor.see("3d, not 6d")
    editor.type("/6d<CR>cw3d<Esc>")
    editor.see("type: 3d", "mobility 1", gone="no configuration")
    editor.type("?rocker_pin<CR>K")
    editor.see("its loops have mobility 1")
    editor.type("Goframes:<CR>  - {name: pen, link: copler, xyz: [0.185, 0.1, 0]}<Esc>")
    editor.see("'copler'")
    editor.type("?copler<CR>gra")
    editor.see("1: Write 'coupler'")
    editor.type("1<CR>")
    editor.see("link: coupler", gone="copler")
    editor.type("Goconfigurations:<CR>  assembled: {}<CR>metadata: {license: BSD-3-Clause}<Esc>")
    editor.see("the loops are open")
    editor.type("?assembled<CR>gra")
    editor.see("1: ")
    editor.type("1<CR>")
    editor.see("crank_pin", gone="the loops are open")
    editor.type(":write | !eurdf check robot.yaml<CR>")
    editor.see("valid")


def save_session(file: Path) -> None:
    """Run the session, and write its frames to an animated WebP file that repeats without end."""
    with tempfile.TemporaryDirectory() as folder:
        tutorial(Path(folder))
        with Neovim(Path(folder)) as editor:
            write_robot(editor)
    from PIL import Image as Pillow

    pages = [screen.image() for screen, _ in editor.frames]
    times = [time for _, time in editor.frames]
    width, height = pages[0].size
    sheet = Pillow.new("RGB", (width, height * len(pages[:: len(pages) // 8])))
    for number, page in enumerate(pages[:: len(pages) // 8]):
        sheet.paste(page, (0, number * height))
    palette = sheet.quantize(_COLORS)
    first, *others = (page.quantize(palette=palette, dither=Pillow.Dither.NONE).convert("RGB") for page in pages)
    # No frame is whole but the first, and the slowest method makes the file ten times smaller.
    small = {"lossless": True, "method": 6, "quality": 100, "kmin": len(pages), "kmax": len(pages) + 1}
    durations = [*times[:-1], _END_TIME]
    first.save(file, save_all=True, append_images=others, duration=durations, loop=0, **small)


def main(arguments: Sequence[str] | None = None) -> int:
    """Draws the moving picture; 0 if it is drawn, 2 if it cannot be."""
    default = _ROOT / "docs" / "pictures" / "editor.webp"
    return draw("editor_picture", "Draw a session in Neovim.", default, save_session, arguments)


if __name__ == "__main__":
    sys.exit(main())
