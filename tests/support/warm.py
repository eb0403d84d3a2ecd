"""Runs Python programs of the package in a process that has imported it already.

A test of a command, or of the suite as pytest runs it, needs a process of its own. To start Python and to import
pytest, NumPy and the cases takes longer than most of these tests do. So one process imports them, and forks for each
program that is to be run: what runs is what ``python -m MODULE`` runs, in its own folder and environment.
"""

from __future__ import annotations

import atexit
import json
import os
import subprocess
import sys
import tempfile
from collections.abc import Mapping, Sequence
from functools import cache
from pathlib import Path

#: Seconds after which a program that has not ended is killed.
TIMEOUT = 300

#: The seed whose fresh cases that process has drawn: a run of the suite with it need not draw them.
SEED = 0

#: Names a folder that all workers share: fresh cases are drawn once a session.
SESSION = "EURDF_TESTS_SESSION"


def run_module(
    module: str, arguments: Sequence[str], *, cwd: Path | None = None, environment: Mapping[str, str] | None = None
) -> subprocess.CompletedProcess[str]:
    """What ``python -m MODULE ARGUMENTS`` comes to.

    Args:
        module: The module.
        arguments: Its arguments.
        cwd: The folder that it is run in; that of the tests if left out.
        environment: Its environment variables; those of the tests if left out.
    """
    with tempfile.TemporaryDirectory() as folder:
        streams = [str(Path(folder, name)) for name in ("stdout", "stderr")]
        request = {
            "argv": [module, *arguments],
            "cwd": str(cwd or Path.cwd()),
            "environment": dict(os.environ if environment is None else environment),
            "streams": streams,
        }
        server = _server()
        assert server.stdin is not None
        assert server.stdout is not None
        server.stdin.write(json.dumps(request) + "\n")
        server.stdin.flush()
        code = int(server.stdout.readline())
        out, err = (Path(stream).read_text(encoding="utf-8") for stream in streams)
    return subprocess.CompletedProcess(request["argv"], code, out, err)


@cache
def _server() -> subprocess.Popen[str]:
    # Threads do not survive a fork: it has none.
    environment = os.environ | {"OPENBLAS_NUM_THREADS": "1", "OMP_NUM_THREADS": "1"}
    server = subprocess.Popen(
        [sys.executable, __file__], stdin=subprocess.PIPE, stdout=subprocess.PIPE, text=True, env=environment
    )
    atexit.register(server.communicate)
    return server


def _serve() -> None:
    import gc
    import importlib

    for name in ("pytest", "hypothesis", "numpy", "eurdf.commands.main", "eurdf_conformance.suite.plugin"):
        importlib.import_module(name)
    sys.path.append(str(Path(__file__).parents[2]))
    importlib.import_module("robots.builder")
    sys.path.pop()
    from eurdf_conformance.corpus.read import all_cases

    all_cases()
    _draw()
    gc.freeze()
    answers = os.fdopen(os.dup(1), "w")
    for line in sys.stdin:
        child = os.fork()
        if child == 0:
            answers.close()
            os._exit(_run(**json.loads(line)))
        _, status = os.waitpid(child, 0)
        answers.write(f"{os.waitstatus_to_exitcode(status)}\n")
        answers.flush()


def _draw() -> None:
    """Draw the fresh cases, unless another worker has."""
    import fcntl

    from eurdf_conformance.fresh.case import drawn_text, fresh_cases, keep_drawn

    session = Path(os.environ[SESSION])
    drawn = session / "drawn.json"
    with (session / "lock").open("w") as lock:
        fcntl.flock(lock, fcntl.LOCK_EX)
        if drawn.exists():
            keep_drawn(SEED, drawn.read_text(encoding="utf-8"))
        else:
            drawn.write_text(drawn_text(SEED), encoding="utf-8")
    fresh_cases(SEED)


def _run(argv: list[str], cwd: str, environment: dict[str, str], streams: list[str]) -> int:
    import runpy
    import signal
    import traceback

    signal.alarm(TIMEOUT)
    os.close(0)
    os.open(os.devnull, os.O_RDONLY)
    for number, stream in enumerate(streams, start=1):
        written = os.open(stream, os.O_WRONLY | os.O_CREAT)
        os.dup2(written, number)
        os.close(written)
    os.environ.clear()
    os.environ.update(environment)
    os.chdir(cwd)
    sys.path[0] = cwd
    sys.path[1:1] = environment.get("PYTHONPATH", "").split(os.pathsep)
    sys.argv = argv
    code: object = 0
    try:
        runpy.run_module(argv[0], run_name="__main__", alter_sys=True)
    except SystemExit as end:
        code = end.code
    except BaseException:
        traceback.print_exc()
        code = 1
    if isinstance(code, str):
        sys.stderr.write(f"{code}\n")
    atexit._run_exitfuncs()
    sys.stdout.flush()
    sys.stderr.flush()
    return int(code) if isinstance(code, int) else int(code is not None)


if __name__ == "__main__":
    _serve()
