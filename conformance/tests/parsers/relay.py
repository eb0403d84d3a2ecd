"""Relays a correct parser process, and changes the lines that it writes. Imports nothing heavy: it is started often."""

from __future__ import annotations

import re
import subprocess
import sys


def answers_without_the_id(line: bytes) -> bytes:
    """The answers have the id 0, whatever that of the request."""
    return re.sub(rb'"id":\s*\d+', b'"id":0', line, count=1)


def answers_twice(line: bytes) -> bytes:
    """Each request is answered twice."""
    return line + line


def ends_after_one_answer(line: bytes) -> bytes | None:
    """The process ends after its first answer."""
    return line if b'"started"' in line else None


def talks_while_it_reads(line: bytes) -> bytes:
    """What a library prints is on the standard output, too."""
    return b"Warning: no transmission found\n" + line if b'"issues"' in line else line


def misspells_a_member(line: bytes) -> bytes:
    """A member of each answer is misspelt."""
    return line.replace(b'"outcome"', b'"result"')


def writes_json_of_python(line: bytes) -> bytes:
    """The answers are what Python prints of a dictionary."""
    return line.replace(b'"', b"'")


def run(name: str, *command: str) -> None:
    """Be one of them, over standard input and output, before the process that a command starts."""
    wrong = globals()[name]
    with subprocess.Popen(command, stdin=sys.stdin, stdout=subprocess.PIPE) as child:
        for line in child.stdout or ():
            if (spoilt := wrong(line)) is None:
                child.kill()
                return
            sys.stdout.buffer.write(spoilt)
            sys.stdout.buffer.flush()


if __name__ == "__main__":
    run(*sys.argv[1:])
