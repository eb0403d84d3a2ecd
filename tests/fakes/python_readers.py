"""Readers in Python for `protocol.serve`, each with one peculiarity."""

import os
import subprocess
import sys

from eurdf_conformance.protocol.message import Issue, Values
from eurdf_conformance.protocol.reply import accepted, rejected, skipped, unsupported


class Plain:
    """Says of each robot where its files are; evaluates nothing."""

    name, version, language = "plain", "1", "Python"
    claims = {"2": ["accept"]}  # noqa: RUF012

    def load(self, description, urdf):
        return accepted(issues=[str(description), str(urdf)])


class Talkative(Plain):
    """Prints to standard output in every way there is, and reads standard input."""

    def load(self, description, urdf):
        print("from Python")  # noqa: T201
        os.write(1, b"from below\n")
        subprocess.run(["echo", "from a child"], check=True)
        return accepted(issues=[f"read {sys.stdin.read()!r}"])


class Failing(Plain):
    """Raises what the name of the description says."""

    def load(self, description, urdf):
        if description.stem == "exit":
            sys.exit(6)
        raise {"key": KeyError, "recursion": RecursionError, "memory": MemoryError}[description.stem]("lost")

    def evaluate(self, configurations, frames, quantities):
        raise ValueError("no robot was accepted")


class Answers(Plain):
    """Gives every kind of answer."""

    def load(self, description, urdf):
        match description.stem:
            case "rejected":
                issue = Issue(code="unknown-frame", file="robot.yaml", line=3, column=5, message="no such frame")
                return rejected(issue, "another")
            case "unsupported":
                return unsupported("helical joints", "nobody needed them")
            case "skipped":
                return skipped("it is Sunday")
            case "no_canonical_description":
                return accepted({"name": "robot"})
            case "half_a_character":
                return skipped("\ud800")
            case "nothing":
                return None
            case _:
                return accepted()

    def evaluate(self, configurations, frames, quantities):
        if not frames:
            return unsupported("evaluate without frames")
        return [Values(mass=float(len(each)), center_of_mass=[0.0, 0.0, 1.0]) for each in configurations]


class WrongClaims(Plain):
    """Claims a level that there is not."""

    claims = {"2": ["everything"]}  # noqa: RUF012


PLAIN = Plain()


class holder:  # noqa: N801 - a name space
    inner = PLAIN
