"""Parsers in Python for `protocol.serve`, each with one peculiarity."""

import os
import subprocess
import sys

from eurdf_conformance.protocol.message import Issue, Pose, Values
from eurdf_conformance.protocol.reply import accepted, rejected, skipped, unsupported

ROBOT = {
    "name": "r", "version": "2", "root": "fixed", "links": [], "frames": [], "joints": [], "closures": [],
    "actuators": [], "configurations": {}, "own": {},
}  # fmt: skip


class Plain:
    """Says of each robot where its files are; evaluates nothing."""

    name, version, language = "plain", "1", "Python"
    claims = {"2": ["accept"]}  # noqa: RUF012

    def load(self, description, urdf):
        return accepted(issues=[str(description), str(urdf)])


class Talkative(Plain):
    """Prints to standard output by every method, and reads standard input."""

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
                try:
                    return accepted({"name": "robot"})
                except ValueError:  # as who takes each for a wrong file
                    return rejected("it is wrong")
            case "no_plain_data":
                return accepted({"links": {"a", "b"}})
            case "not_a_number":
                return accepted(ROBOT | {"own": {"/x": [{"y": float("nan")}]}})
            case "no_issue":
                return rejected(ValueError("no such frame"))
            case "values":
                return [Values(mass=float("inf"))]
            case "pose":
                return Pose(rotation=[[1.0, 0.0, 0.0]], translation=[0.0, 0.0, 0.0])
            case "half_a_character":
                return skipped("\ud800")
            case "nothing":
                return None
            case _:
                return accepted()

    def evaluate(self, configurations, frames, quantities):
        if frames == ["nothing"]:
            return None
        if not frames:
            return unsupported("evaluate without frames")
        return [Values(mass=float(len(each)), center_of_mass=[0.0, 0.0, 1.0]) for each in configurations]


# -- No parsers ------------------------------------------------------------------------------------------------------


def claiming(said):
    return type("Claiming", (Plain,), {"claims": said})


number_for_version = claiming({2: ["accept"]})
no_mapping = claiming(["accept"])
no_level = claiming({"2": ["acept"]})
no_list = claiming({"2": "accept"})
number = 3


class NoName:
    version, language, claims = "1", "Python", Plain.claims

    def load(self, description, urdf):
        return accepted()


class NoLoad:
    name, version, language, claims = "mine", "1", "Python", Plain.claims


class NumberForVersion(Plain):
    version = 1


class OnePath(Plain):
    def load(self, description):
        return accepted()


class OneArgument(Plain):
    def evaluate(self, configurations):
        return []


class TakesArguments(Plain):
    def __init__(self, path):
        self.path = path


class Raises(Plain):
    def __init__(self):
        raise RuntimeError("no licence")


def function(description, urdf):
    return accepted()


PLAIN = Plain()


class holder:  # noqa: N801 - a name space
    inner = PLAIN
