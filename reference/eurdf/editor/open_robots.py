"""The robots whose files are open in an editor: what was found, and how each was when it could last be built."""

from __future__ import annotations

import os
from collections.abc import Callable
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING

from eurdf.diagnostics import Diagnostic, FileError, Place
from eurdf.editor.documents import Documents, descriptions_beside, is_xml_file
from eurdf.editor.names import Occurrence, RobotNames
from eurdf.errors import EurdfError
from eurdf.linking.robot_files import named_urdf
from eurdf.loading import MeshFiles, examine
from eurdf.mechanism.mechanism import Mechanism
from eurdf.reading.source import Source, Texts
from eurdf.reading.xacro import is_xacro
from eurdf.reading.xml_reader import read_xml

if TYPE_CHECKING:
    from eurdf.kinematics.analysis import Analysis
    from eurdf.kinematics.opening import Opening

#: URDFs whose mesh files are remembered, at most: each text that is typed is one.
_REMEMBERED = 20


@dataclass(frozen=True)
class Figures:
    """How a robot moves that can be built.

    Attributes:
        analysis: Its mobility.
        openings: How far each closure and coupling is open in the configuration of the analysis, by name.
    """

    analysis: Analysis
    openings: dict[str, Opening]


@dataclass(frozen=True)
class KnownRobot:
    """What is known of a robot.

    Attributes:
        diagnostics: Of its texts as they are.
        mechanism: What it was when it could last be built; None if it never could.
        figures: How it moves; None if that is not known, or not yet.
    """

    diagnostics: tuple[Diagnostic, ...] = ()
    mechanism: Mechanism | None = None
    figures: Figures | None = None


class OpenRobots:
    """The robots of the documents that are open.

    Attributes:
        documents: The documents.
        examined: What is known of each robot, by the path of its description, or of a URDF that has none.
    """

    def __init__(self) -> None:
        self.documents = Documents()
        self.examined: dict[str, KnownRobot] = {}
        self._expanded = Texts()  # of xacros, with the warnings of xacro
        self._mesh_files: MeshFiles = {}
        self._names: dict[str, tuple[tuple[object, object], RobotNames]] = {}

    # -- which files belong together ----------------------------------------------------------------------------------

    def urdf_of(self, description: str) -> str:
        """The path of the URDF that a description names."""
        document = self.documents.yaml(description)
        return self.documents.shown(os.fspath(named_urdf(Path(description).parent, None, document)))

    def descriptions_of(self, path: str) -> list[str]:
        """A description itself; those that name a URDF, which are open or in its folder."""
        if not is_xml_file(path):
            return [path]
        opened = [each for each in self.documents.opened if not is_xml_file(each)]
        return [each for each in dict.fromkeys((*opened, *descriptions_beside(path))) if self.urdf_of(each) == path]

    def robots_of(self, path: str) -> list[str]:
        """The robots to examine if a document changes: those that are open, or one of those that have it."""
        descriptions = self.descriptions_of(path)
        opened = [each for each in descriptions if each in self.documents.opened]
        return opened or descriptions[:1] or [path]

    def names(self, path: str) -> RobotNames:
        """The names in the files of the robot that a document belongs to, as far as they can be read."""
        robot = self.robots_of(path)[0]
        description, urdf = (None, robot) if is_xml_file(robot) else (self.documents.yaml(robot), self.urdf_of(robot))
        files = description, self.documents.xml(urdf)
        key, names = self._names.get(robot, (None, None))
        if names is None or key != files:
            names = RobotNames(*files)
            self._names[robot] = files, names
        return names

    def can_move(self, names: RobotNames, joint: Occurrence) -> bool:
        """Whether a joint has a coordinate, in the URDF or by its type in the description."""
        mechanisms = (each.mechanism for each in self.examined.values() if each.mechanism is not None)
        types = {each.name: each.type for mechanism in mechanisms for each in mechanism.joints}
        known = types.get(joint.name)
        stated = None if joint.element is None else joint.element.get("type")
        return stated != "fixed" if known is None else not known.is_fixed

    # -- checks -------------------------------------------------------------------------------------------------------

    def saved(self, path: str) -> None:
        """Forget what a xacro was expanded to, for it, or a file that it includes, was saved."""
        self._expanded = Texts()

    def snapshot(self) -> Texts:
        """The texts to examine robots with, which do not change with those of the documents."""
        return Texts({**self._expanded, **self.documents.texts()})

    def examine(self, robot: str, texts: Texts, tries: Callable[[], bool] | None = None) -> KnownRobot:
        """What a check finds; with causes, fixes and how the robot moves if `tries` says whether to go on trying fixes.

        It reads nothing of the documents, and can run in another thread.
        """
        before = self.examined.get(robot, KnownRobot())
        if is_xacro(robot):  # a program, which is only run for a description that names it
            return KnownRobot(_of_syntax(robot, texts))
        for text in list(self._mesh_files)[:-_REMEMBERED]:
            self._mesh_files.pop(text, None)
        known = Texts(texts)
        try:
            read, report = examine(known, Path(robot), mesh_files=self._mesh_files, tries=tries)
        except EurdfError as error:
            return KnownRobot((Diagnostic("file-unreadable", str(error), Place(robot)),), before.mechanism)
        self._expanded.update(
            {name: text for name, text in known.items() if name.endswith((" (expanded)", " (warnings)"))}
        )
        mechanism = read.linked or before.mechanism
        figures = before.figures if mechanism is before.mechanism else None
        if tries is not None and read.linked is not None and tries():
            figures = _figures(read.linked)
        return KnownRobot(report.diagnostics, mechanism, figures)

    def found(self) -> dict[str, list[Diagnostic]]:
        """The diagnostics of all robots, by path of the file as it is open; those of an expanded xacro are its own."""
        found: dict[str, list[Diagnostic]] = {path: [] for path in self.documents.opened}
        for robot, examined in self.examined.items():
            found.setdefault(robot, [])
            for each in examined.diagnostics:
                at = found.setdefault(self.documents.shown(each.file.removesuffix(" (expanded)")), [])
                if each not in at:
                    at.append(each)
        return found


def _figures(mechanism: Mechanism) -> Figures:
    from eurdf.kinematics.analysis import analyze  # only now: a simulator
    from eurdf.kinematics.residual import closure_openings
    from eurdf.pinocchio.robot import build_robot

    robot = build_robot(mechanism, geometry=False)
    analysis = analyze(robot)
    return Figures(analysis, {each.name: each for each in closure_openings(robot, analysis.q)})


def _of_syntax(path: str, texts: Texts) -> tuple[Diagnostic, ...]:
    if path not in texts:
        return ()
    try:
        read_xml(Source(path, texts[path], texts[path].encode()))
    except FileError as error:
        return (error.diagnostic,)
    return ()
