"""The program between the runner and a parser: it starts the parser, and ends all that the parser started.

``python -I -S keeper.py FD PROGRAM [ARGUMENT…]`` starts the program, which inherits standard input, output and error,
and writes lines to the socket FD: ``failed ERRNO`` if it cannot be started, else ``started``; ``ended CODE`` when it
ends, negative for a signal. When the runner shuts down its end of the socket, or is gone, however it went, the keeper
kills what is left, writes ``left [NAMES]`` and ends.

On Linux the keeper is a sub-reaper: also a process that left the group and the session of the parser, and whose parent
has ended, is its descendant. Elsewhere it kills the group, and what left the group is out of reach. This file imports
nothing of the package, since it starts with each parser.
"""

import contextlib
import json
import os
import select
import signal
import sys
import time
from collections.abc import Iterator
from pathlib import Path

_LINUX = sys.platform == "linux"

_PR_SET_CHILD_SUBREAPER = 36

# How long killed processes may take to end, s.
_DEATH = 3.0


def main(control: int, command: list[str]) -> None:
    """Start the program, wait for its end or that of the runner, and clean up."""
    os.set_inheritable(control, False)
    if _LINUX:
        import ctypes

        ctypes.CDLL(None).prctl(_PR_SET_CHILD_SUBREAPER, 1, 0, 0, 0)
    told, tell = os.pipe()
    os.set_blocking(tell, False)
    signal.signal(signal.SIGCHLD, lambda *_: None)
    signal.set_wakeup_fd(tell, warn_on_full_buffer=False)
    program = _start(command)
    if isinstance(program, OSError):
        os.write(control, f"failed {program.errno}\n".encode())
        return
    os.write(control, b"started\n")
    # The pipes are the program's alone: when it closes one, the other end must see that.
    null = os.open(os.devnull, os.O_RDWR)
    for stream in range(3):
        os.dup2(null, stream)
    code: int | None = None
    while control not in select.select([control, told], [], [])[0]:
        os.read(told, 4096)
        if code is None and (code := _exit_code(program)) is not None:
            os.write(control, f"ended {code}\n".encode())
    left = _end(program)
    with contextlib.suppress(BrokenPipeError):
        os.write(control, f"left {json.dumps(left)}\n".encode())


def _start(command: list[str]) -> int | OSError:
    """The id of the program's process, which leads a session of its own; or why it cannot be started."""
    failed, fail = os.pipe()
    process = os.fork()
    if process == 0:
        signal.set_wakeup_fd(-1)
        # Python ignores these, and ignored signals are inherited.
        for number in (signal.SIGPIPE, signal.SIGXFSZ):
            signal.signal(number, signal.SIG_DFL)
        os.setsid()
        try:
            os.execvp(command[0], command)
        except OSError as error:
            os.write(fail, str(error.errno).encode())
        os._exit(127)
    os.close(fail)
    errno = os.read(failed, 16)
    os.close(failed)
    return OSError(int(errno), "") if errno else process


def _exit_code(process: int) -> int | None:
    """How it ended, None while it runs. Where possible it is not reaped: so the id of its group remains its own."""
    if hasattr(os, "waitid"):
        found = os.waitid(os.P_PID, process, os.WEXITED | os.WNOWAIT | os.WNOHANG)
        if found is None:
            return None
        return found.si_status if found.si_code == os.CLD_EXITED else -found.si_status
    ended, status = os.waitpid(process, os.WNOHANG)  # macOS before Python 3.13
    return os.waitstatus_to_exitcode(status) if ended else None


def _end(program: int) -> list[str]:
    """Kill what is left of the program and of all that it started; the names of those that had left its group."""
    names: dict[int, str] = {}
    with contextlib.suppress(ProcessLookupError, PermissionError):
        os.killpg(program, signal.SIGKILL)
    until = time.monotonic() + _DEATH
    while _LINUX and time.monotonic() < until:
        alive = list(_descendants())
        if not alive:
            break
        for process, group, name in alive:
            if group != program:
                names[process] = name
            with contextlib.suppress(ProcessLookupError, PermissionError):
                os.kill(process, signal.SIGKILL)
        time.sleep(0.002)
    return [names[process] for process in sorted(names)]


def _descendants() -> Iterator[tuple[int, int, str]]:
    """Id, group and name of each process that this one, or a process that it is the reaper of, has started."""
    parents: dict[int, int] = {}
    found: dict[int, tuple[int, str]] = {}
    for entry in os.listdir("/proc"):
        if not entry.isdigit():
            continue
        with contextlib.suppress(OSError):
            # PID (NAME) STATE PARENT GROUP …: the name may have spaces and parentheses.
            name, _, rest = Path(f"/proc/{entry}/stat").read_text(errors="replace").partition("(")[2].rpartition(")")
            state, parent, group, *_ = rest.split()
            parents[int(entry)] = int(parent)
            if state not in "ZX":
                found[int(entry)] = int(group), name
    own, others = {os.getpid()}, set(parents) - {os.getpid()}
    while children := {process for process in others if parents[process] in own}:
        own, others = own | children, others - children
    yield from ((process, *found[process]) for process in own & found.keys() if process != os.getpid())


if __name__ == "__main__":
    main(int(sys.argv[1]), sys.argv[2:])
