"""The parser in JavaScript in a browser: ``--parser="cmd:python -m support.browser_adapter DIST"``.

DIST is where ``js/build.js`` has bundled the package. Scripts of a page answer the requests; this program reads the
files of a robot, as bytes, and says which of those that the URDF names exist.
"""

from __future__ import annotations

import json
import re
import sys
from pathlib import Path
from tempfile import TemporaryDirectory
from urllib.parse import unquote, urlsplit

from support.browser import browser, served

_PAGE = """async () => {
  const { answer } = await import("/dist/answers.js");
  const bytesOf = async (path) => new Uint8Array(await (await fetch(path, { cache: "no-store" })).arrayBuffer());
  const textOf = async (key, { name, isThere, problem }) =>
    ({ name, problem, text: isThere ? await bytesOf(`/${key}`) : null });
  let texts;
  window.fetchTexts = async (description, urdf) => {
    texts = { description: await textOf("description", description), urdf: await textOf("urdf", urdf) };
  };
  window.reply = (line, existing) => {
    const asked = new Set();
    const files = (name) => (asked.add(name), existing.includes(name));
    return { answer: answer(JSON.parse(line), () => ({ ...texts, files })), asked: [...asked] };
  };
}"""

_REPLY = "given => window.reply(...given)"


def main() -> None:
    """Answer the requests on standard input until the last one."""
    with TemporaryDirectory() as name, served(Path(name)) as address, browser() as chromium:
        folder = Path(name)
        (folder / "dist").symlink_to(Path(sys.argv[1]).resolve())
        page = chromium.new_page()
        page.goto(f"{address}/dist/licenses.txt")
        page.evaluate(_PAGE)
        for line in map(bytes.decode, sys.stdin.buffer):
            request = json.loads(line)
            if request["command"] == "load":
                texts = [_text(folder / key, request[key]) for key in ("description", "urdf")]
                page.evaluate("given => fetchTexts(...given)", texts)
            reply = page.evaluate(_REPLY, [line, []])
            if existing := [name for name in reply["asked"] if _exists(name, Path(request["urdf"]))]:
                reply = page.evaluate(_REPLY, [line, existing])
            sys.stdout.write(f"{reply['answer']}\n")
            sys.stdout.flush()
            if request["command"] == "stop":
                break


def _text(link: Path, path: str) -> dict[str, str | bool | None]:
    """A file for `read`, without its bytes, which the page fetches from the link; no problem if it does not exist."""
    file = Path(path)
    link.unlink(missing_ok=True)
    problem = None
    if file.suffix.lower() == ".xacro":
        problem = "this parser expands no xacro"
    elif file.is_file():
        link.symlink_to(file)
    elif file.exists():
        problem = "it is no regular file"
    return {"name": file.name, "isThere": link.is_symlink(), "problem": problem}


def _exists(name: str, urdf: Path) -> bool:
    """Whether a name in a URDF is that of a file, EU-URD-028."""
    scheme, rest = match.groups() if (match := re.fullmatch(r"(?s)([a-zA-Z]+)://(.*)", name)) else ("", name)
    try:
        if scheme == "file":
            return Path(unquote(urlsplit(name).path)).is_file()
        if scheme == "package":
            around = next((each for each in urdf.parents if (each / "package.xml").is_file()), urdf.parent)
            return rest.split("/")[0] == around.name and (around.parent / rest).is_file()
        return not scheme and (urdf.parent / name).is_file()
    except (OSError, ValueError):  # too long, or a character that no name has
        return False


if __name__ == "__main__":
    main()
