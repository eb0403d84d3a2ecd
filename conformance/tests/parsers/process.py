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


# -- Ways that show when an error is to be loaded; each takes the request ---------------------------------------------


def sound(request):
    """Accepts, as it should."""
    say(accepted(request))


def hangs(request):
    """Never answers."""
    time.sleep(60)


def exits(request):
    """Ends with exit code 3 and a line on standard error."""
    sys.stderr.write("cannot go on\n")
    sys.exit(3)


def exits_with_success(request):
    """Ends with exit code 0, without an answer."""
    sys.exit(0)


def exits_after_answering(request):
    """Answers, and ends with exit code 4."""
    say(accepted(request))
    sys.exit(4)


def segfaults(request):
    """Ends by SIGSEGV."""
    os.kill(os.getpid(), signal.SIGSEGV)


def aborts_with_a_line(request):
    """Writes a line that is no answer, and ends by SIGABRT."""
    write("terminate called\n")
    os.kill(os.getpid(), signal.SIGABRT)


def another_id(request):
    """Answers with an id that was never asked."""
    say({**accepted(request), "id": request["id"] + 7})


def answer_before(request):
    """As one that is out of step: what it was asked before, once more."""
    say({**accepted(request), "id": request["id"] - 1})


def late(request):
    """Answers after 0.7 s."""
    time.sleep(0.7)
    say(accepted(request))


def twice(request):
    """Answers twice."""
    write(2 * (json.dumps(accepted(request)) + "\n"))


def in_pieces(request):
    """Writes its answer byte by byte."""
    line = json.dumps({**accepted(request), "robot": None}, ensure_ascii=False).encode() + b"\n"
    for byte in range(len(line)):
        write(line[byte : byte + 1])
        time.sleep(0.001)


def garbage(request):
    """Writes a line that is not JSON."""
    write("Segmentation fault (not really)\n")


def nothing_but_a_line_end(request):
    """Writes an empty line."""
    write("\n")


def not_utf8(request):
    """Writes a line in Latin-1."""
    write(b'{"id": %d, "outcome": "skipped", "reason": "\xe9"}\n' % request["id"])


def half_a_character(request):
    """Writes half of a surrogate pair."""
    say({"id": request["id"], "outcome": "skipped", "reason": "\ud800"})


def list_of_one(request):
    """Writes its answer in a list."""
    say([accepted(request)])


def cut_off(request):
    """A line without its end, and no more."""
    write(json.dumps(accepted(request))[:30])
    time.sleep(60)


def no_line_end(request):
    """Writes its answer without the end of the line."""
    write(json.dumps(accepted(request)))
    time.sleep(60)


def unknown_member(request):
    """Adds a member that answers do not have."""
    say({**accepted(request), "verdict": "fine"})


def member_missing(request):
    """Leaves out a member."""
    answer = accepted(request)
    del answer["robot"]
    say(answer)


def another_outcome_before(request):
    """Rejects and accepts in one answer."""
    write(json.dumps(accepted(request)).replace('"outcome"', '"outcome": "rejected", "outcome"') + "\n")


def two_ids(request):
    """Writes two ids into one answer."""
    write(json.dumps(accepted(request)).replace('"id"', '"id": 7, "id"') + "\n")


def number_too_long(request):
    """Writes a number of 5000 digits."""
    write(json.dumps({**accepted(request), "issues": [{"message": "m", "line": 7}]}).replace("7", "7" * 5000) + "\n")


def wrong_type(request):
    """Writes a number as text."""
    say({**accepted(request), "issues": [{"message": "m", "line": "12"}]})


def no_outcome(request):
    """Leaves out the outcome."""
    say({"id": request["id"]})


def unknown_outcome(request):
    """Writes an outcome that does not exist."""
    say({"id": request["id"], "outcome": "valid"})


def no_id(request):
    """Leaves out the id."""
    answer = accepted(request)
    del answer["id"]
    say(answer)


def wrong_kind(request):
    """Answers another request than the one it got."""
    say({"id": request["id"], "outcome": "evaluated", "values": []})


def not_a_number(request):
    """Writes NaN, which JSON does not have."""
    robot = {
        "name": "r", "version": "2", "root": "fixed", "links": [], "frames": [], "joints": [], "closures": [],
        "actuators": [], "configurations": {}, "own": {"/x-a": float("nan")},
    }  # fmt: skip
    say({**accepted(request), "robot": robot})


def number_too_large(request):
    """Writes a number beyond the range of a double."""
    robot = {
        "name": "r", "version": "2", "root": "fixed", "links": [], "frames": [], "joints": [], "closures": [],
        "actuators": [], "configurations": {}, "own": {"/x-a": "huge"},
    }  # fmt: skip
    write(json.dumps({**accepted(request), "robot": robot}).replace('"huge"', "1e400") + "\n")


def nested_deep(request):
    """Writes 100 000 opening brackets."""
    write("[" * 100_000 + "\n")


def endless_line(request):
    """Writes a line without end."""
    while True:
        write("x" * 2**16)


def endless_lines(request):
    """Writes lines without end."""
    while True:
        write("y\n" * 2**10)


def chatter_before(request):
    """Writes two lines before its answer."""
    write("loading...\nloaded\n")
    say(accepted(request))


def chatter_after(request):
    """Writes a line after its answer."""
    write(json.dumps(accepted(request)) + "\ndone\n")


def chatter_later(request):
    """Writes a line 0.1 s after its answer."""
    say(accepted(request))
    time.sleep(0.1)
    write("cleaned up\n")


def floods_stderr(request):
    """Writes 6 MB to standard error, and answers."""
    for _ in range(100):
        sys.stderr.write("x" * 2**16 + "\n")
    sys.stderr.write("the last of it\n")
    say(accepted(request))


def floods_stderr_for_ever(request):
    """Writes to standard error without end."""
    while True:
        os.write(2, b"x" * 2**16)


def child():
    """A process that would stay, with the same pipes; its id."""
    return subprocess.Popen([sys.executable, "-I", "-S", "-c", "import time; time.sleep(60)"]).pid


def has_a_child(request):
    """Leaves a child behind, and answers with its process id."""
    say({**accepted(request), "issues": [{"message": str(child())}]})


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


def has_a_daemon(request):
    """Leaves a daemon behind, and answers with its process id."""
    say({**accepted(request), "issues": [{"message": str(daemon())}]})


def dies_before_its_daemon(request):
    """Ends, and leaves a daemon."""
    os.write(2, str(daemon()).encode())
    os._exit(5)


def dies_before_its_child(request):
    """Ends, and leaves a child that has its pipes."""
    os.write(2, str(child()).encode())
    os._exit(5)


def spins(request):
    """For ever, as its child and a daemon; their ids go where the environment says."""
    written = Path(os.environ["FAKE_PIDS"])
    written.with_suffix(".new").write_text(f"{os.getpid()} {child()} {daemon()}")
    written.with_suffix(".new").rename(written)
    while True:
        pass


def closes_stdout(request):
    """Closes its standard output."""
    os.close(1)
    time.sleep(60)


def closes_stdin(request):
    """Answers, and closes its standard input."""
    os.close(0)
    say(accepted(request))
    time.sleep(60)


def carriage_returns(request):
    """Ends its lines with a carriage return and a line feed."""
    write(json.dumps(accepted(request)) + "\r\n")


def whole_numbers_with_a_point(request):
    """Writes integers with a decimal point."""
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
    """Answers `errored`."""
    say({"id": request["id"], "outcome": "errored", "message": "out of luck"})


# -- Ways that show at the start; each takes the request -------------------------------------------------------------


def crashes_at_start(request):
    """Ends with exit code 9 and a line on standard error."""
    sys.stderr.write("no licence found\n")
    sys.exit(9)


def hangs_at_start(request):
    """Never answers."""
    time.sleep(60)


def refuses_to_start(request):
    """Answers `errored`."""
    say({"id": request["id"], "outcome": "errored", "message": "no licence"})


def speaks_another_protocol(request):
    """Speaks version 2.0 of the protocol."""
    say({**started(request), "protocol": "2.0"})


def byte_order_mark(request):
    """Begins with a byte order mark."""
    write("\ufeff" + json.dumps(started(request)) + "\n")


def banner(request):
    """Writes a line before its first answer."""
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
    """Never answers."""
    time.sleep(60)


def does_not_end(request):
    """Answers, and goes on running."""
    say({"id": request["id"], "outcome": "stopped"})
    time.sleep(60)


def ends_with_its_input(request):
    """As one that does not look what it is asked, and goes on to wait for more."""
    say({"id": request["id"], "outcome": "stopped"})
    sys.stdin.read()


def crashes_at_the_end(request):
    """Answers, and ends by SIGSEGV."""
    say({"id": request["id"], "outcome": "stopped"})
    os.kill(os.getpid(), signal.SIGSEGV)


# -- Ways that show whatever is loaded ------------------------------------------------------------------------------


def always_accepted(request):
    """Accepts any description."""
    say({"id": request["id"], "outcome": "accepted", "robot": None, "issues": []})


def always_rejected(request):
    """Rejects any description."""
    say({"id": request["id"], "outcome": "rejected", "issues": []})


def always_rejected_with_chatter(request):
    """Rejects any description, and writes a line before each answer."""
    write("reading\n")
    always_rejected(request)


def starts_as(name):
    """The answer to `start` of one that claims the level accept for versions 1 and 2.1."""
    who, claims = {"name": name, "version": "1", "language": "Python"}, {"1": ["accept"], "2.1": ["accept"]}
    return lambda request: started(request) | {"parser": who, "claims": claims}


AT_START = (
    crashes_at_start,
    hangs_at_start,
    refuses_to_start,
    speaks_another_protocol,
    byte_order_mark,
    banner,
    starts_once,
)
AT_STOP = (ignores_stop, does_not_end, crashes_at_the_end, ends_with_its_input)
ALWAYS = (always_accepted, always_rejected, always_rejected_with_chatter)


def main(way):
    wrong = globals()[way]
    at_start = wrong if wrong in AT_START else starts_as(way) if wrong in ALWAYS else started
    for line in iter(sys.stdin.readline, ""):
        request = json.loads(line)
        match request["command"]:
            case "start":
                if (answer := at_start(request)) is not None:
                    say(answer)
            case "load" if wrong in ALWAYS:
                wrong(request)
            case "load" if wrong not in AT_START + AT_STOP and Path(request["description"]).name.startswith("trigger"):
                wrong(request)
            case "load":
                sound(request)
            case "evaluate" if wrong in ALWAYS:
                say({"id": request["id"], "outcome": "unsupported", "feature": "evaluate"})
            case "evaluate":
                say({"id": request["id"], "outcome": "evaluated", "values": [{}]})
            case "stop":
                if wrong in AT_STOP:
                    wrong(request)
                else:
                    say({"id": request["id"], "outcome": "stopped"})
                return


main(sys.argv[1])
