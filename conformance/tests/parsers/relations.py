"""Parsers whose answers depend on what must not matter: they violate relations between two answers."""

from __future__ import annotations

import json
import math
import re
from collections.abc import Callable, Sequence
from pathlib import Path
from typing import Any

import numpy as np
import yaml

from eurdf_conformance.oracle import OracleRobot
from eurdf_conformance.protocol.message import Accepted, Jacobian, MassMatrix, Quantity, Rejected, Values
from eurdf_conformance.protocol.reply import accepted
from parsers.oracle import Configuration, OracleParser


class WrongParser(OracleParser):
    """The oracle, until a method says otherwise."""

    def load(self, description: Path, urdf: Path) -> Accepted | Rejected:
        self.description, self.urdf = description.read_text("utf-8-sig"), urdf.read_text("utf-8")
        return super().load(description, urdf)

    def evaluate(
        self, configurations: Sequence[Configuration], frames: Sequence[str], quantities: Sequence[Quantity]
    ) -> list[Values]:
        assert self.robot is not None
        found = super().evaluate([self.place(q) for q in configurations], frames, quantities)
        return [self.say(values, self.robot, q) for values, q in zip(found, configurations, strict=True)]

    def place(self, q: Configuration) -> Configuration:
        return q

    def say(self, values: Values, robot: OracleRobot, q: Configuration) -> Values:
        return values


def with_k(values: Values, change: Callable[[str, Any], Any]) -> Values:
    """Other rows of K, by the name of their closure."""
    if values.jacobian is None:
        return values
    rows = {name: change(name, np.array(rows)).tolist() for name, rows in values.jacobian.rows.items()}
    return values.model_copy(update={"jacobian": Jacobian(columns=values.jacobian.columns, rows=rows)})


def with_m(values: Values, change: Callable[[Any], Any]) -> Values:
    """Another mass matrix."""
    if values.mass_matrix is None:
        return values
    matrix = change(np.array(values.mass_matrix.matrix)).tolist()
    return values.model_copy(update={"mass_matrix": MassMatrix(columns=values.mass_matrix.columns, matrix=matrix)})


def with_poses(values: Values, change: Callable[[str, Any], Any]) -> Values:
    """Frames somewhere else."""
    if values.poses is None:
        return values
    poses = {
        name: pose.model_copy(update={"translation": change(name, np.array(pose.translation)).tolist()})
        for name, pose in values.poses.items()
    }
    return values.model_copy(update={"poses": poses})


def off(values: Values) -> Values:
    """Everything a little off."""
    found = with_poses(values, lambda name, p: p + 0.01)
    found = with_k(found, lambda name, K: K * 1.01 + 0.01)
    return with_m(found, lambda M: M * 1.01)


class ForgetsInlineAngles(WrongParser):
    """Reads no `rpy` of a frame that is said in place."""

    def load(self, description: Path, urdf: Path) -> Accepted | Rejected:
        document = yaml.safe_load(description.read_text("utf-8-sig"))
        for closure in document.get("closures", []):
            for frame in closure["frames"]:
                if isinstance(frame, dict):
                    frame.pop("rpy", None)
        other = description.with_name("other.yaml")
        other.write_text(json.dumps(document), "utf-8")
        return super().load(other, urdf)


class OrderOfNames(WrongParser):
    """Names the columns in alphabetical order, whatever they mean."""

    def say(self, values: Values, robot: OracleRobot, q: Configuration) -> Values:
        found = {}
        for quantity in ("jacobian", "mass_matrix"):
            if (value := getattr(values, quantity)) is not None:
                found[quantity] = value.model_copy(update={"columns": sorted(value.columns)})
        return values.model_copy(update=found)


class OrderOfFile(WrongParser):
    """Depends on the order of links in the URDF."""

    def load(self, description: Path, urdf: Path) -> Accepted | Rejected:
        super().load(description, urdf)
        assert self.robot is not None
        name = next(iter(self.robot.urdf.links))
        return accepted(self.robot.canonical().model_copy(update={"name": name}))

    def say(self, values: Values, robot: OracleRobot, q: Configuration) -> Values:
        order = list(robot.urdf.links)
        found = with_poses(values, lambda name, p: p + 0.01 * order.index(name) if name in order else p)
        return with_m(found, lambda M: M * (2 + order.index(min(order))))


class ForgetsAColumn(WrongParser):
    """Has one velocity too few."""

    def say(self, values: Values, robot: OracleRobot, q: Configuration) -> Values:
        if (M := values.mass_matrix) is not None and M.columns:
            cut = MassMatrix(columns=M.columns[1:], matrix=[row[1:] for row in M.matrix[1:]])
            return values.model_copy(update={"mass_matrix": cut})
        if (K := values.jacobian) is not None and K.columns:
            rows = {name: [row[1:] for row in rows] for name, rows in K.rows.items()}
            return values.model_copy(update={"jacobian": Jacobian(columns=K.columns[1:], rows=rows)})
        return values


class Weightless(WrongParser):
    """Moves with no effort."""

    def say(self, values: Values, robot: OracleRobot, q: Configuration) -> Values:
        return with_m(values, lambda M: 0.0 * M)


class LosesARowOf3d(WrongParser):
    """Holds 3d closures in one direction less."""

    def say(self, values: Values, robot: OracleRobot, q: Configuration) -> Values:
        return with_k(values, lambda name, K: np.vstack([0.0 * K[:1], K[1:]]) if len(K) == 3 else K)


class SeenFromTheWorld(WrongParser):
    """Sees residuals from the world, and weighs by the height."""

    def say(self, values: Values, robot: OracleRobot, q: Configuration) -> Values:
        at, found = robot.kinematics(q), dict(values.residuals or {})
        for name, (_, a, _) in robot.closures.items():
            if name in found:
                wRa = (at.root @ at.pose(a))[:3, :3]
                found[name] = [*(wRa @ np.array(found[name][:3])).tolist(), *found[name][3:]]
        root = next(iter(robot.urdf.links))
        height = float((at.root @ at.pose(robot.tree.links[root]))[2, 3])
        values = with_m(values, lambda M: M * (1.0 + height))
        return values.model_copy(update={"residuals": found}) if values.residuals is not None else values


class HoldsTheRoot(WrongParser):
    """Lets a closure hold a root that floats."""

    def say(self, values: Values, robot: OracleRobot, q: Configuration) -> Values:
        afloat = np.array([name == "root_joint" for name, _ in robot.velocities])
        values = with_k(values, lambda name, K: K + afloat)
        return with_m(values, lambda M: M + 0.1 * afloat.any())


class InMillimetres(WrongParser):
    """Adds a length, and a mass, that does not scale."""

    def say(self, values: Values, robot: OracleRobot, q: Configuration) -> Values:
        values = with_poses(values, lambda name, p: p + 0.001)
        values = with_k(values, lambda name, K: K + 0.001)
        return with_m(values, lambda M: M + 0.001 * np.eye(len(M)))


class Where(WrongParser):
    """Is a little off where the files say some words."""

    words = ""

    def say(self, values: Values, robot: OracleRobot, q: Configuration) -> Values:
        return off(values) if re.search(self.words, self.description + self.urdf) else values


class OffWhereSprung(Where):
    """Lets springs change where things are, and their inertia."""

    words = "stiffness"


class OffWhereLocked(Where):
    """Does not lock, quite."""

    words = "joint[0-9]+: fixed"

    def load(self, description: Path, urdf: Path) -> Accepted | Rejected:
        read = super().load(description, urdf)
        if isinstance(read, Accepted) and read.robot and re.search(self.words + "|FIXED", self.description):
            return read.model_copy(update={"robot": read.robot.model_copy(update={"joints": []})})
        return read


class OffWhereLocked1(OffWhereLocked):
    """Does not lock, quite, in version 1."""

    words = "FIXED"


class UniversalBackwards(WrongParser):
    """Turns about the second axis first."""

    def place(self, q: Configuration) -> Configuration:
        assert self.robot is not None
        kinds = {joint.name: joint.type for joint in self.robot.tree.joints}
        return {name: list(reversed(each)) if kinds[name] == "universal" else each for name, each in q.items()}


class OffByLinks(WrongParser):
    """Weighs the names of links."""

    def say(self, values: Values, robot: OracleRobot, q: Configuration) -> Values:
        return with_m(values, lambda M: M * (1.0 + 0.01 * len(robot.urdf.links)))


class OffWhereLeftOut(WrongParser):
    """Places what is left out a little off its neutral."""

    def say(self, values: Values, robot: OracleRobot, q: Configuration) -> Values:
        return off(values) if len(q) < len(robot.neutral()) else values


class MindsTheSign(WrongParser):
    """Takes −q for another rotation than q, and a turn for more than none."""

    def say(self, values: Values, robot: OracleRobot, q: Configuration) -> Values:
        turned = any(abs(each[0]) > math.pi or (len(each) > 3 and each[-1] < 0.0) for each in q.values())
        return off(values) if turned else values
