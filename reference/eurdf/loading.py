"""`eurdf.load` and `eurdf.check`: from files to a robot ready for Pinocchio, or to everything that is wrong with them.

`of_any_robot` makes a function of a robot one that also takes what `load` takes. The module is not named after one of
them: importing it would put it in the place of the function.
"""

from __future__ import annotations

import os
from collections.abc import Callable, Mapping, Sequence
from contextlib import suppress
from functools import cache, partial
from inspect import currentframe, signature
from typing import TYPE_CHECKING, Any, Concatenate, ParamSpec, TypeVar

from eurdf.advice.angles import advise_on_angles
from eurdf.advice.lengths import advise_on_lengths
from eurdf.advice.likely_closures import advise_on_missing_closures
from eurdf.advice.loops import closure_diagnostics
from eurdf.advice.near_assembled import advise_on_near_assembled
from eurdf.advice.plausibility import advise_on_plausibility, spring_notes
from eurdf.advice.quaternions import advise_on_quaternions
from eurdf.advice.symmetry import advise_on_symmetry
from eurdf.advice.trial import Evidence, is_of_the_text
from eurdf.diagnostics import Diagnostic, Diagnostics, Fix, Severity, quoted
from eurdf.diagnostics.report import Report
from eurdf.errors import InvalidRobot
from eurdf.format.urdf.data import Urdf
from eurdf.linking.mesh_files import FoundFiles, find_meshes, place_of_file
from eurdf.linking.mimics import warn_of_ignored_mimics
from eurdf.linking.robot_files import ReadRobot, inertia_diagnostics, read_robot
from eurdf.mechanism.mechanism import Root
from eurdf.mesh_files.kinds import KINDS, suffix_of
from eurdf.pinocchio.arguments import accepting
from eurdf.pinocchio.meshes import Mesh, read_meshes
from eurdf.reading.robot_source import RobotSource, is_stream
from eurdf.reading.source import Texts
from eurdf.writing.simplification import saving

if TYPE_CHECKING:
    from eurdf.kinematics.analysis import Analysis
    from eurdf.pinocchio.robot import Robot

#: The types of a `RobotSource`, as a tuple: a union would be made in each call.
SOURCES = (str, bytes, os.PathLike, Mapping)

#: Mesh files by the text of the URDF that names them: where they are, the meshes by path, and what is wrong with some.
MeshFiles = dict[bytes, tuple[FoundFiles, dict[str, Mesh], Diagnostics]]

# Characters that all trials of fixes read, at most: those of about fifty trials of a humanoid.
_MOST_READ_AGAIN = 5_000_000

_Rest = ParamSpec("_Rest")
_Result = TypeVar("_Result")


class _TooMuch(Exception):  # noqa: N818 - never seen outside
    """Ends the trials of fixes."""


def load(
    path: RobotSource,
    urdf: RobotSource | None = None,
    *,
    root: Root | None = None,
    geometry: bool = True,
    mimic: bool = True,
    check_loops: bool = False,
    strict: bool = False,
    package_dirs: Sequence[str | os.PathLike[str]] = (),
    xacro_args: Mapping[str, str] | None = None,
    confined: bool = False,
    allow_outside: bool = False,
) -> Robot:
    """Load a robot.

    Errors that leave something to guess are refused (EU-CNF-001). Unphysical inertias and loops that cannot close are
    not: real files have them, and their kinematics are still of use. They are in ``robot.diagnostics`` (EU-CNF-003),
    for which they are looked for when it is first used; whether loops can close, only if `check_loops` says so.

    Args:
        path: A folder, a YAML file, a bare URDF or xacro, the name of a robot of the collection, ``-`` for standard
            input, a pipe, or a text: one that begins with ``<`` is a URDF, any other a description, also of one line,
            such as ``"closures: []"``. Or what a description contains, as a mapping; lines in diagnostics are then
            those of its JSON with a line for each value.
        urdf: A URDF in place of the one that the description names (``robot.urdf`` beside it by default): a file,
            ``-``, a pipe or a text.
        root: ``fixed`` or ``floating``, in place of what the description says (fixed by default).
        geometry: Whether to load the visual and collision geometry, meshes too. Without it, bodies have no shapes, and
            nothing wrong with shapes is looked for. Where a mesh is missing or not read, the robot is loaded and
            ``robot.diagnostics`` says so (EU-URD-028); asking it for its geometry raises `InvalidRobot`.
        mimic: Whether the mimic joints of the URDF follow the joints that drive them, as in
            ``pin.buildModelFromUrdf(path, mimic=True)``. If not, each is free, as in
            ``pin.buildModelFromUrdf(path)``, and an error in which joint it mimics is kept in ``robot.diagnostics``.
            With a description of version 1 they are free in any case (EU-ONE-009).
        check_loops: Whether to find out if the loops can close at all, which takes a solver, and to report in
            ``robot.diagnostics`` if they cannot, as `eurdf.check` does. Whether a configuration ``assembled`` closes
            them is reported in any case.
        strict: Whether to refuse every error, those of the inertia and closure phases too; this also checks the loops.
        package_dirs: Folders to look for the packages of meshes in, before ``ROS_PACKAGE_PATH`` and
            ``AMENT_PREFIX_PATH``.
        xacro_args: Values of the arguments of a xacro: the one that is given, or that the description names. The latter
            may only read files of the robot and of packages.
        confined: Whether it is an error if the description names a URDF outside its own folder or a xacro, or the URDF
            a mesh outside the robot's folder and the packages, symbolic links followed. The file is then not opened.
        allow_outside: Whether meshes, and files that they name, are read that are neither in the robot's folder nor in
            a package. If not, they are left out, with a warning. The robot's folder is the nearest one, from that of
            the URDF upwards, with a ``package.xml``; without one, that of the URDF.

    Returns:
        The robot: its Pinocchio model, its constraint models in file order, its actuation, its geometry.

    Raises:
        RobotNotFound: There are no such files.
        InvalidRobot: The robot cannot be built without guessing, or `geometry` is asked for and a mesh is
            unreadable.
        CannotExpand: A xacro has an error, or `xacro_args` are given for what is no xacro.
        MissingExtra: A xacro is given, and the extra ``xacro`` is not installed.
    """
    from eurdf.pinocchio.robot import build_robot  # only now: a simulator, which `check` does without if it can

    if root not in (None, "fixed", "floating"):
        raise ValueError(f"root is {root!r}; it must be 'fixed' or 'floating'")
    read = read_robot(
        path,
        urdf,
        root,
        geometry=geometry,
        mimic=mimic,
        package_dirs=package_dirs,
        xacro_args=xacro_args,
        confined=confined,
        allow_outside=allow_outside,
        inertias=False,
    )
    if read.linked is None:
        raise InvalidRobot(read.path, tuple(read.diagnostics))
    paths: dict[str, str] = {}
    meshes: dict[str, Mesh] = {}
    of_meshes: tuple[Diagnostic, ...] = ()
    without_geometry: Callable[[], Exception] | None = None
    if geometry:
        files = find_meshes(read.urdf, package_dirs, confined=confined, allow_outside=allow_outside)
        paths = files.paths
        meshes, unreadable = _read_mesh_files(read.urdf, files)
        of_meshes = (*files.diagnostics, *unreadable)
        no_geometry = f"the geometry of {read.path} cannot be built; load it with geometry=False"
        if any(found.severity is Severity.ERROR for found in of_meshes):
            found = (*read.diagnostics, *inertia_diagnostics(read), *of_meshes)
            raise InvalidRobot(read.path, found, no_geometry)
        if any(shape.kind == "mesh" and paths.get(shape.filename) not in meshes for shape in read.urdf.shapes):
            # The kinematics need no mesh, so that what `check` passes is loaded; but shapes are not left out in
            # silence.
            without_geometry = partial(InvalidRobot, read.path, of_meshes, no_geometry)
    loops = strict or check_loops or "assembled" in read.mechanism.configurations
    robot = build_robot(
        read.mechanism,
        geometry=geometry and without_geometry is None,
        resolve=paths.get,
        meshes=meshes,
        no_geometry=without_geometry,
        diagnose=partial(_diagnostics, read, of_meshes, loops),
    )
    if strict or check_loops:  # a solver runs now, not when the diagnostics are first used
        errors = [found for found in robot.diagnostics if found.severity is Severity.ERROR]
        if strict and errors:
            raise InvalidRobot(read.path, robot.diagnostics)
    return robot


def _diagnostics(read: ReadRobot, of_meshes: Sequence[Diagnostic], loops: bool, robot: Robot) -> tuple[Diagnostic, ...]:
    """All diagnostics of a robot that was loaded, in the order of `eurdf.check`."""
    of_loops = closure_diagnostics(read, robot) if loops else Diagnostics()
    of_loops.tried(lambda *_: False)
    return (*read.diagnostics, *inertia_diagnostics(read), *of_meshes, *of_loops)


def as_robot(given: Robot | RobotSource, *, geometry: bool = False) -> Robot:
    """The robot that a caller gave, or the one that `load` makes of the path, text or name that was given."""
    return load(given, geometry=geometry) if isinstance(given, SOURCES) else given


def of_any_robot(
    function: Callable[Concatenate[Robot, _Rest], _Result], *, geometry: bool = False
) -> Callable[Concatenate[Robot | RobotSource, _Rest], _Result]:
    """A function whose first argument, the robot, may also be given as `load` takes it, with or without its geometry.

    Returns:
        The function, as one of the module that calls this, in which it must have the same name to be pickled.
    """
    of_any = accepting(function, partial(as_robot, geometry=geometry))
    first, *others = signature(function).parameters.values()
    accepted = first.replace(annotation="Robot | RobotSource")
    of_any.__signature__ = signature(function).replace(parameters=[accepted, *others])  # type: ignore[attr-defined]
    caller = currentframe()
    of_any.__module__ = caller.f_back.f_globals["__name__"] if caller and caller.f_back else of_any.__module__
    return of_any


def check(
    path: RobotSource,
    urdf: RobotSource | None = None,
    *,
    package_dirs: Sequence[str | os.PathLike[str]] = (),
    xacro_args: Mapping[str, str] | None = None,
    confined: bool = False,
    allow_outside: bool = False,
) -> Report:
    """Check a robot: EU-DIA-001, EU-DIA-003: every error that no other error hides is reported.

    It also gives advice (EU-DIA-006): warnings without a clause, whose codes begin with ``x-``. Notes name springs that
    are never at rest, and say what `eurdf.simplify` saves.

    The arguments are those of `load`.

    Returns:
        The findings of all phases, in the order of the phases.

    Raises:
        RobotNotFound, CannotExpand, MissingExtra: See `load`.
        ValueError: `confined` and `allow_outside` are both True.
    """
    return check_texts(
        {},
        path,
        urdf,
        package_dirs=package_dirs,
        xacro_args=xacro_args,
        confined=confined,
        allow_outside=allow_outside,
    )


def check_texts(texts: Mapping[str, str], path: RobotSource, urdf: RobotSource | None = None, **options: Any) -> Report:
    """The result of `check`, with texts in place of those of files: see `read_robot`."""
    return examine(Texts(texts), path, urdf, **options)[1]


def examine(
    known: Texts,
    path: RobotSource,
    urdf: RobotSource | None = None,
    *,
    mesh_files: MeshFiles | None = None,
    tries: Callable[[], bool] | None = lambda: True,
    **options: Any,
) -> tuple[ReadRobot, Report]:
    """The robot that `check` reads, and its result.

    Args:
        known: Texts in place of those of files: see `read_robot`.
        path: As `check` takes it, and so are the URDF and the other options.
        urdf: See ``path``.
        **options: See ``path``.
        mesh_files: What was found before, to which is added what is found now.
        tries: Asked before each trial of a fix whether to go on; None for what is found at once: no causes, no trials,
            no mesh files but those that were found before.
    """
    find = {name: value for name, value in options.items() if name != "xacro_args"}
    mesh_files = {} if mesh_files is None else mesh_files
    left = _MOST_READ_AGAIN

    @cache
    def evidence_with(code: str, *fixes: Fix) -> Evidence:
        nonlocal left
        left -= sum(map(len, known.values()))
        if left < 0 or not (tries and tries()):
            raise _TooMuch
        trial = read_robot(path, urdf, **options, texts=Texts({**known, **Fix.together(fixes).texts()}))
        return (
            Evidence(trial.diagnostics.counts())
            if is_of_the_text(code)
            else _findings(trial, mesh_files, find, causes=False)
        )

    def is_right(found: Diagnostic, fix: Fix) -> bool:
        if not fix.edits:  # it is only asked
            return False
        after = evidence_with(found.code, fix)
        if after.is_as_good_as(evidence, found.code) and not after.is_enough_for(found.code):
            # An error that is left hides what is wrong with this fix: try it with the likeliest fixes of all.
            after = evidence_with(found.code, fix, *likeliest)
        return after.is_enough_for(found.code) and after.is_as_good_as(evidence, found.code)

    read = read_robot(path, urdf, **options, texts=known)
    evidence = _findings(read, mesh_files, find, causes=tries is not None, new_meshes=tries is not None)
    likeliest = [found.proposals[0] for found in read.diagnostics if found.proposals]
    if not (is_stream(path) or (urdf is not None and is_stream(urdf))):  # which can be read only once
        with suppress(_TooMuch):  # what has not been tried stays a question
            read.diagnostics.tried(is_right)
    is_sound = tries and read.linked is not None and read.yaml is not None and not read.diagnostics.error_count
    notes = (*spring_notes(read.mechanism), *saving(read.mechanism)) if is_sound else ()
    return read, Report(read.path, tuple(read.diagnostics), notes)


def _findings(
    read: ReadRobot, mesh_files: MeshFiles, find: Mapping[str, Any], *, causes: bool, new_meshes: bool = True
) -> Evidence:
    """Add what is found after reading to the diagnostics of a robot.

    Mesh files are found as ``find`` says, and not read again for the same text of a URDF; those of a new one only if
    asked for. Causes are proposed only if they are asked for.

    Returns:
        What a trial compares.
    """
    diagnostics = read.diagnostics
    refused = diagnostics.refused  # without meshes, which the kinematics does not need
    meshes: dict[str, Mesh] = {}
    analysis: Analysis | None = None
    if read.tree is not None and (new_meshes or read.tree.document.source.data in mesh_files):
        text = read.urdf.document.source.data
        if text not in mesh_files:
            files = find_meshes(read.urdf, **find)
            mesh_files[text] = files, *_read_mesh_files(read.urdf, files)
        files, by_path, unreadable = mesh_files[text]
        meshes = {uri: by_path[path] for uri, path in files.paths.items() if path in by_path}
        for found in (*files.diagnostics, *unreadable):
            diagnostics.add(found)
    before = len(diagnostics)
    if read.linked is not None and not refused:
        if read.yaml is not None:
            advise_on_near_assembled(read, diagnostics)
            if read.mechanism.constraints:
                analysis = _check_loops(read, causes)
            else:
                advise_on_quaternions(read, None, diagnostics)
                advise_on_missing_closures(read, diagnostics, causes)
        warn_of_ignored_mimics(read.mechanism, read.urdf, diagnostics)
        advise_on_angles(read, diagnostics)
        advise_on_lengths(read, meshes, diagnostics)
        advise_on_plausibility(read, diagnostics)
        if len(diagnostics) == before and not diagnostics.error_count:  # else the cause may be reported already
            advise_on_symmetry(read, diagnostics)
    return Evidence(diagnostics.counts(), not diagnostics.error_count, analysis)


def _check_loops(read: ReadRobot, causes: bool) -> Analysis | None:
    """Report what needs a simulator: whether the loops close and, where there is no error, advice on how they move.

    Returns:
        How the robot moves, where there is no error.
    """
    # Only now: a description without closures is checked without a simulator.
    from eurdf.advice.actuation import advise_on_actuation
    from eurdf.advice.limits import advise_on_limits
    from eurdf.advice.loops import advise_on_neutral
    from eurdf.advice.massless import advise_on_massless_links
    from eurdf.kinematics.analysis import analyze
    from eurdf.kinematics.assembly import assemble
    from eurdf.pinocchio.robot import build_robot

    diagnostics = read.diagnostics
    robot = build_robot(read.mechanism, geometry=False)
    assembly = None if "assembled" in robot.configurations else assemble(robot)
    for found in closure_diagnostics(read, robot, assembly):
        diagnostics.add(found)
    given_up = assembly is not None and assembly.reason == "not decided"
    if not given_up and not diagnostics.error_count:
        q = robot.configurations["assembled"] if assembly is None else assembly.q
        advise_on_quaternions(read, robot, diagnostics)
        if assembly is not None and advise_on_neutral(read, robot, diagnostics):
            return None  # the rest would be consequences
        advise_on_massless_links(read, robot, q, diagnostics)
        analysis = analyze(robot, q) if robot.mechanism.actuators else None
        advise_on_actuation(read, robot, analysis, diagnostics, causes=causes)
        advise_on_limits(read, robot, q, diagnostics)
        return analysis
    return None


def _read_mesh_files(urdf: Urdf, files: FoundFiles) -> tuple[dict[str, Mesh], Diagnostics]:
    """EU-URD-034: every mesh file that `find_meshes` found can be read as a mesh.

    The meshes, by path; one diagnostic for each mesh that cannot be read, and one for all of other formats.
    """
    paths = files.paths
    scaled = [(shape.filename, shape.size) for shape in urdf.shapes if shape.kind == "mesh" and shape.filename in paths]
    loaded = {suffix: kind.name for suffix, kind in KINDS.items() if kind.is_loaded}
    others = [uri for uri in dict.fromkeys(uri for uri, _ in scaled) if suffix_of(paths[uri]) not in loaded]
    meshes, reasons = read_meshes((each for each in scaled if each[0] not in others), paths, files.folders)
    diagnostics = Diagnostics()
    if others:
        count = "1 mesh file has" if len(others) == 1 else f"{len(others)} mesh files have"
        diagnostics.report(
            "x-mesh-format",
            f"{count} a format that is not read: {quoted(others)}",
            partial(place_of_file, urdf, "mesh", others[0]),
            f"convert them to one of {', '.join(loaded.values())}",
        )
    for uri, reason in reasons.items():
        place = partial(place_of_file, urdf, "mesh", uri)
        diagnostics.report("urdf-mesh-unreadable", f"mesh '{uri}' cannot be read: {reason}", place)
    return meshes, diagnostics
