"""Processes that are wrong, each in one way: ``python process.py WAY``. Each way is a function of the request.

Most accept whatever they load, with the path in the message of an issue, so that an answer shows its request. They go
wrong where the name of the description begins with ``trigger``, or at `start`, or at `stop`. Nothing of the suite is
imported.
"""

import json
import os
import signal
import subprocess
import sys
import time
from pathlib import Path

ROBOT = {
    "name": "r", "version": "2", "root": "fixed", "links": [], "frames": [], "joints": [], "closures": [],
    "actuators": [], "configurations": {}, "own": {},
}  # fmt: skip
JOINT = {
    "name": "j", "type": "revolute", "parent": "a", "child": "b", "lower": [0], "upper": [0], "velocity": [0],
    "effort": [0], "damping": [0], "friction": [0], "armature": [0],
}  # fmt: skip

WAIT = 60.0


def accepted(request, **members):
    issue = {"message": request["description"]}
    return {"id": request["id"], "outcome": "accepted", "robot": None, "issues": [issue]} | members


def started(request, **members):
    who = {"name": "fake", "version": "1", "language": "Python"}
    said = {"id": request["id"], "outcome": "started", "protocol": "1.0", "parser": who, "claims": {"2": ["accept"]}}
    return said | members


def write(data):
    """To standard output, all of it, at once."""
    if isinstance(data, str):
        data = data.encode()
    while data:
        data = data[os.write(1, data) :]


def say(answer):
    write(json.dumps(answer) + "\n")


def answer(request, outcome, **members):
    say({"id": request["id"], "outcome": outcome, **members})


def text(request, before="", after="", **members):
    """An answer that accepts, with one text instead of another."""
    write(json.dumps(accepted(request, **members)).replace(before, after, 1) + "\n")


def issue(request, **members):
    """An answer that accepts, with such an issue."""
    say(accepted(request, issues=[{"message": "m", **members}]))


def without(request, member):
    say({key: value for key, value in accepted(request).items() if key != member})


def waits(*_):
    time.sleep(WAIT)


def kills_itself(by):
    os.kill(os.getpid(), by)


def complains(sentence, code):
    """Ends with a line on standard error."""
    sys.stderr.write(f"{sentence}\n")
    sys.exit(code)


def for_ever(fd, data):
    while True:
        os.write(fd, data)


def in_pieces(request):
    for byte in json.dumps(accepted(request), ensure_ascii=False).encode() + b"\n":
        write(bytes([byte]))
        time.sleep(0.001)


def floods_stderr(request):
    """Writes 6 MB to standard error, and answers."""
    for _ in range(100):
        sys.stderr.write("x" * 2**16 + "\n")
    sys.stderr.write("the last of it\n")
    say(accepted(request))


def child():
    """A process that would stay, with the same pipes; its id."""
    return subprocess.Popen([sys.executable, "-I", "-S", "-c", "import time; time.sleep(60)"]).pid


def daemon():
    """The id of a process in a session of its own, whose parent has ended, with the pipes of this one."""
    told, tell = os.pipe()
    if (parent := os.fork()) == 0:
        os.setsid()
        if os.fork() == 0:
            os.write(tell, str(os.getpid()).encode())
            os.environ.clear()
            os.execv("/bin/sleep", ["sleep", "60"])
        os._exit(0)
    os.waitpid(parent, 0)
    os.close(tell)
    with os.fdopen(told) as pid:
        return int(pid.read())  # to its end, which is when the daemon has become `sleep`


def dies_before(started_process):
    """Ends, and leaves a process that has its pipes; its id is on standard error."""
    os.write(2, str(started_process).encode())
    os._exit(5)


def spins(request):
    """For ever, as its child and a daemon; their ids go where the environment says."""
    written = Path(os.environ["FAKE_PIDS"])
    written.with_suffix(".new").write_text(f"{os.getpid()} {child()} {daemon()}")
    written.with_suffix(".new").rename(written)
    while True:
        pass


def starts_once(request):
    """Where the file is that the environment names, it has started before."""
    started_before = Path(os.environ["FAKE_STARTED"])
    if started_before.exists():
        sys.exit(9)
    started_before.touch()
    say(started(request))


#: Ways to load.
AT_LOAD = {
    "sound": lambda request: say(accepted(request)),
    "hangs": waits,
    "exits": lambda request: complains("cannot go on", 3),
    "exits_with_success": lambda request: sys.exit(0),
    "exits_after_answering": lambda request: (say(accepted(request)), sys.exit(4)),
    "segfaults": lambda request: kills_itself(signal.SIGSEGV),
    "aborts_with_a_line": lambda request: (write("terminate called\n"), kills_itself(signal.SIGABRT)),
    "another_id": lambda request: say(accepted(request, id=request["id"] + 7)),
    "answer_before": lambda request: say(accepted(request, id=request["id"] - 1)),
    "late": lambda request: (time.sleep(0.7), say(accepted(request))),
    "twice": lambda request: write(2 * (json.dumps(accepted(request)) + "\n")),
    "in_pieces": in_pieces,
    "garbage": lambda request: write("Segmentation fault (not really)\n"),
    "nothing_but_a_line_end": lambda request: write("\n"),
    "not_utf8": lambda request: write(b'{"id": %d, "outcome": "skipped", "reason": "\xe9"}\n' % request["id"]),
    "half_a_character": lambda request: answer(request, "skipped", reason="\ud800"),
    "list_of_one": lambda request: say([accepted(request)]),
    "cut_off": lambda request: (write(json.dumps(accepted(request))[:30]), waits()),
    "no_line_end": lambda request: (write(json.dumps(accepted(request))), waits()),
    "unknown_member": lambda request: say(accepted(request, verdict="fine")),
    "member_missing": lambda request: without(request, "robot"),
    "another_outcome_before": lambda request: text(request, '"outcome"', '"outcome": "rejected", "outcome"'),
    "two_ids": lambda request: text(request, '"id"', '"id": 7, "id"'),
    "number_too_long": lambda request: text(request, "77", "7" * 5000, issues=[{"message": "m", "line": 77}]),
    "wrong_type": lambda request: issue(request, line="12"),
    "no_outcome": lambda request: say({"id": request["id"]}),
    "unknown_outcome": lambda request: answer(request, "valid"),
    "no_id": lambda request: without(request, "id"),
    "wrong_kind": lambda request: answer(request, "evaluated", values=[]),
    "not_a_number": lambda request: say(accepted(request, robot=ROBOT | {"own": {"/x-a": float("nan")}})),
    "number_too_large": lambda request: text(request, '"huge"', "1e400", robot=ROBOT | {"own": {"/x-a": "huge"}}),
    "nested_deep": lambda request: write("[" * 100_000 + "\n"),
    "endless_line": lambda request: for_ever(1, b"x" * 2**16),
    "endless_lines": lambda request: for_ever(1, b"y\n" * 2**10),
    "chatter_before": lambda request: (write("loading...\nloaded\n"), say(accepted(request))),
    "chatter_after": lambda request: write(json.dumps(accepted(request)) + "\ndone\n"),
    "chatter_later": lambda request: (say(accepted(request)), time.sleep(0.1), write("cleaned up\n")),
    "floods_stderr": floods_stderr,
    "floods_stderr_for_ever": lambda request: for_ever(2, b"x" * 2**16),
    "has_a_child": lambda request: issue(request, message=str(child())),
    "has_a_daemon": lambda request: issue(request, message=str(daemon())),
    "dies_before_its_daemon": lambda request: dies_before(daemon()),
    "dies_before_its_child": lambda request: dies_before(child()),
    "spins": spins,
    "closes_stdout": lambda request: (os.close(1), waits()),
    "closes_stdin": lambda request: (os.close(0), say(accepted(request)), waits()),
    "carriage_returns": lambda request: write(json.dumps(accepted(request)) + "\r\n"),
    "whole_numbers_with_a_point": lambda request: say(
        accepted(request, id=float(request["id"]), issues=[{"message": request["description"], "line": 3.0}])
    ),
    # As JavaScript writes NaN
    "null_for_a_number": lambda request: say(
        accepted(request, robot=ROBOT | {"links": 50 * ["a link"], "joints": [JOINT | {"damping": [None]}]})
    ),
    "errors": lambda request: answer(request, "errored", message="out of luck"),
}

#: Ways to start.
AT_START = {
    "crashes_at_start": lambda request: complains("no licence found", 9),
    "hangs_at_start": waits,
    "refuses_to_start": lambda request: answer(request, "errored", message="no licence"),
    "speaks_another_protocol": lambda request: say(started(request, protocol="2.0")),
    "byte_order_mark": lambda request: write("\ufeff" + json.dumps(started(request)) + "\n"),
    "banner": lambda request: (write("Welcome to Fake 1.0!\n"), say(started(request))),
    "starts_once": starts_once,
}

#: Ways to stop.
AT_STOP = {
    "ignores_stop": waits,
    "does_not_end": lambda request: (answer(request, "stopped"), waits()),
    "crashes_at_the_end": lambda request: (answer(request, "stopped"), kills_itself(signal.SIGSEGV)),
    # As one that does not look what it is asked, and goes on to wait for more
    "ends_with_its_input": lambda request: (answer(request, "stopped"), sys.stdin.read()),
}

#: Ways to load any description; these do not evaluate.
ALWAYS = {
    "always_accepted": lambda request: answer(request, "accepted", robot=None, issues=[]),
    "always_rejected": lambda request: answer(request, "rejected", issues=[]),
    "always_rejected_with_chatter": lambda request: (write("reading\n"), answer(request, "rejected", issues=[])),
}


def main(way):
    assert way in AT_LOAD | AT_START | AT_STOP | ALWAYS, way
    who = {"name": way, "version": "1", "language": "Python"}
    claims = {"parser": who, "claims": {"1": ["accept"], "2.1": ["accept"]}} if way in ALWAYS else {}
    start = AT_START.get(way, lambda request: say(started(request, **claims)))
    stop = AT_STOP.get(way, lambda request: answer(request, "stopped"))
    for line in iter(sys.stdin.readline, ""):
        request = json.loads(line)
        match request["command"]:
            case "start":
                start(request)
            case "load" if way in ALWAYS:
                ALWAYS[way](request)
            case "load":
                wrong = Path(request["description"]).name.startswith("trigger")
                AT_LOAD[way if wrong and way in AT_LOAD else "sound"](request)
            case "evaluate" if way in ALWAYS:
                answer(request, "unsupported", feature="evaluate")
            case "evaluate":
                answer(request, "evaluated", values=[{}])
            case "stop":
                stop(request)
                return


main(sys.argv[1])
