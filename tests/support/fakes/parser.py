"""Parsers that are wrong, each in one way: ``python parser.py WAY``.

Each accepts whatever it is to load, and says which in the message of an issue, so that an answer tells which request it
is the answer to. It goes wrong where the name of the description begins with ``fault``, or at `start`, or at `stop`,
as its way has it. It knows nothing of the package that is tested.
"""

import json
import os
import signal
import subprocess
import sys
import time
from pathlib import Path


def accepted(request):
    issue = {"message": request["description"]}
    return {"id": request["id"], "outcome": "accepted", "robot": None, "issues": [issue]}


def started(request):
    who = {"name": "fake", "version": "1", "language": "Python"}
    return {"id": request["id"], "outcome": "started", "protocol": "1.0", "parser": who, "claims": {"2": ["accept"]}}


def write(data):
    """To standard output, all of it, at once."""
    if isinstance(data, str):
        data = data.encode()
    while data:
        data = data[os.write(1, data) :]


def say(answer):
    write(json.dumps(answer) + "\n")


# -- Ways that show when a fault is to be loaded; each takes the request ---------------------------------------------


def sound(request):
    say(accepted(request))


def hangs(request):
    time.sleep(60)


def exits(request):
    sys.stderr.write("cannot go on\n")
    sys.exit(3)


def exits_with_success(request):
    sys.exit(0)


def exits_after_answering(request):
    say(accepted(request))
    sys.exit(4)


def segfaults(request):
    os.kill(os.getpid(), signal.SIGSEGV)


def aborts_with_a_line(request):
    write("terminate called\n")
    os.kill(os.getpid(), signal.SIGABRT)


def another_id(request):
    say({**accepted(request), "id": request["id"] + 7})


def answer_before(request):
    """As one that is out of step: what it was asked before, once more."""
    say({**accepted(request), "id": request["id"] - 1})


def late(request):
    time.sleep(0.7)
    say(accepted(request))


def twice(request):
    write(2 * (json.dumps(accepted(request)) + "\n"))


def in_pieces(request):
    line = json.dumps({**accepted(request), "robot": None}, ensure_ascii=False).encode() + b"\n"
    for byte in range(len(line)):
        write(line[byte : byte + 1])
        time.sleep(0.001)


def garbage(request):
    write("Segmentation fault (not really)\n")


def nothing_but_a_line_end(request):
    write("\n")


def not_utf8(request):
    write(b'{"id": %d, "outcome": "skipped", "reason": "\xe9"}\n' % request["id"])


def half_a_character(request):
    say({"id": request["id"], "outcome": "skipped", "reason": "\ud800"})


def list_of_one(request):
    say([accepted(request)])


def cut_off(request):
    """A line without its end, and no more."""
    write(json.dumps(accepted(request))[:30])
    time.sleep(60)


def no_line_end(request):
    write(json.dumps(accepted(request)))
    time.sleep(60)


def unknown_member(request):
    say({**accepted(request), "verdict": "fine"})


def member_missing(request):
    answer = accepted(request)
    del answer["robot"]
    say(answer)


def another_outcome_before(request):
    """Rejects and accepts in one answer."""
    write(json.dumps(accepted(request)).replace('"outcome"', '"outcome": "rejected", "outcome"') + "\n")


def two_ids(request):
    write(json.dumps(accepted(request)).replace('"id"', '"id": 7, "id"') + "\n")


def number_too_long(request):
    write(json.dumps({**accepted(request), "issues": [{"message": "m", "line": 7}]}).replace("7", "7" * 5000) + "\n")


def wrong_type(request):
    say({**accepted(request), "issues": [{"message": "m", "line": "12"}]})


def no_outcome(request):
    say({"id": request["id"]})


def unknown_outcome(request):
    say({"id": request["id"], "outcome": "valid"})


def no_id(request):
    answer = accepted(request)
    del answer["id"]
    say(answer)


def wrong_kind(request):
    say({"id": request["id"], "outcome": "evaluated", "values": []})


def not_a_number(request):
    robot = {
        "name": "r", "version": "2", "root": "fixed", "links": [], "frames": [], "joints": [], "closures": [],
        "actuators": [], "configurations": {}, "own": {"/x-a": float("nan")},
    }  # fmt: skip
    say({**accepted(request), "robot": robot})


def number_too_large(request):
    robot = {
        "name": "r", "version": "2", "root": "fixed", "links": [], "frames": [], "joints": [], "closures": [],
        "actuators": [], "configurations": {}, "own": {"/x-a": "huge"},
    }  # fmt: skip
    write(json.dumps({**accepted(request), "robot": robot}).replace('"huge"', "1e400") + "\n")


def nested_deep(request):
    write("[" * 100_000 + "\n")


def endless_line(request):
    while True:
        write("x" * 2**16)


def endless_lines(request):
    while True:
        write("y\n" * 2**10)


def chatter_before(request):
    write("loading...\nloaded\n")
    say(accepted(request))


def chatter_after(request):
    write(json.dumps(accepted(request)) + "\ndone\n")


def chatter_later(request):
    say(accepted(request))
    time.sleep(0.1)
    write("cleaned up\n")


def floods_stderr(request):
    for _ in range(100):
        sys.stderr.write("x" * 2**16 + "\n")
    sys.stderr.write("the last of it\n")
    say(accepted(request))


def floods_stderr_for_ever(request):
    while True:
        os.write(2, b"x" * 2**16)


def child():
    """A process that would stay, with the same pipes; its id."""
    return subprocess.Popen([sys.executable, "-I", "-S", "-c", "import time; time.sleep(60)"]).pid


def has_a_child(request):
    say({**accepted(request), "issues": [{"message": str(child())}]})


def dies_before_its_child(request):
    os.write(2, str(child()).encode())
    os._exit(5)


def spins(request):
    """For ever, as its child; their ids go where the environment says."""
    written = Path(os.environ["FAKE_PIDS"])
    written.with_suffix(".new").write_text(f"{os.getpid()} {child()}")
    written.with_suffix(".new").rename(written)
    while True:
        pass


def closes_stdout(request):
    os.close(1)
    time.sleep(60)


def closes_stdin(request):
    os.close(0)
    say(accepted(request))
    time.sleep(60)


def carriage_returns(request):
    write(json.dumps(accepted(request)) + "\r\n")


def whole_numbers_with_a_point(request):
    issue = {"message": request["description"], "line": 3.0}
    say({**accepted(request), "id": float(request["id"]), "issues": [issue]})


def null_for_a_number(request):
    """As JavaScript writes NaN."""
    joint = {
        "name": "j", "type": "revolute", "parent": "a", "child": "b", "lower": [0], "upper": [0], "velocity": [0],
        "effort": [0], "damping": [None], "friction": [0], "armature": [0],
    }  # fmt: skip
    robot = {
        "name": "r", "version": "2", "root": "fixed", "links": 50 * ["a link"], "frames": [], "joints": [joint],
        "closures": [], "actuators": [], "configurations": {}, "own": {},
    }  # fmt: skip
    say({**accepted(request), "robot": robot})


def errors(request):
    say({"id": request["id"], "outcome": "errored", "message": "out of luck"})


# -- Ways that show at the start; each takes the request -------------------------------------------------------------


def crashes_at_start(request):
    sys.stderr.write("no licence found\n")
    sys.exit(9)


def hangs_at_start(request):
    time.sleep(60)


def refuses_to_start(request):
    say({"id": request["id"], "outcome": "errored", "message": "no licence"})


def speaks_another_protocol(request):
    say({**started(request), "protocol": "2.0"})


def byte_order_mark(request):
    write("\ufeff" + json.dumps(started(request)) + "\n")


def banner(request):
    write("Welcome to Fake 1.0!\n")
    say(started(request))


def starts_once(request):
    """Where the file is that the environment names, it has started before."""
    started_before = Path(os.environ["FAKE_STARTED"])
    if started_before.exists():
        sys.exit(9)
    started_before.touch()
    say(started(request))


# -- Ways that show at the end ---------------------------------------------------------------------------------------


def ignores_stop(request):
    time.sleep(60)


def does_not_end(request):
    say({"id": request["id"], "outcome": "stopped"})
    time.sleep(60)


def ends_with_its_input(request):
    """As one that does not look what it is asked, and goes on to wait for more."""
    say({"id": request["id"], "outcome": "stopped"})
    sys.stdin.read()


def crashes_at_the_end(request):
    say({"id": request["id"], "outcome": "stopped"})
    os.kill(os.getpid(), signal.SIGSEGV)


_AT_START = (
    crashes_at_start,
    hangs_at_start,
    refuses_to_start,
    speaks_another_protocol,
    byte_order_mark,
    banner,
    starts_once,
)
AT_START = {way.__name__: way for way in _AT_START}
AT_STOP = {way.__name__: way for way in (ignores_stop, does_not_end, crashes_at_the_end, ends_with_its_input)}


def main(way):
    at_start, at_stop = AT_START.get(way, started), AT_STOP.get(way)
    at_fault = sound if way in AT_START or way in AT_STOP else globals()[way]
    for line in iter(sys.stdin.readline, ""):
        request = json.loads(line)
        match request["command"]:
            case "start":
                answer = at_start(request)
                if answer is not None:
                    say(answer)
            case "load" if Path(request["description"]).name.startswith("fault"):
                at_fault(request)
            case "load":
                sound(request)
            case "evaluate":
                say({"id": request["id"], "outcome": "evaluated", "values": [{}]})
            case "stop":
                if at_stop is not None:
                    at_stop(request)
                else:
                    say({"id": request["id"], "outcome": "stopped"})
                return


main(sys.argv[1])
