"""`eurdf.load`: a robot ready for Pinocchio, or the reasons why it cannot be built without guessing."""

from __future__ import annotations

import os
from collections.abc import Callable, Iterator, Mapping, Sequence
from functools import partial

from eurdf.checking.loops import closure_diagnostics
from eurdf.checking.mesh_files import read_mesh_files
from eurdf.diagnostics import Diagnostic, Severity
from eurdf.exceptions import InvalidRobot
from eurdf.linking.description import Linked, Unlinked, describe, find_meshes, inertia_diagnostics
from eurdf.mechanism.body import Shape
from eurdf.mechanism.mechanism import Root
from eurdf.pinocchio.meshes import Mesh
from eurdf.pinocchio.robot import Robot, build_robot
from eurdf.reading.given import Given


def load(
    path: Given,
    urdf: Given | None = None,
    root: Root | None = None,
    geometry: bool = True,
    *,
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
            input, a pipe, or a text: one that begins with ``<`` is a URDF, any other a description.
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
    if root not in (None, "fixed", "floating"):
        raise ValueError(f"root is {root!r}; it must be 'fixed' or 'floating'")
    description = describe(
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
    if isinstance(description, Unlinked):
        raise InvalidRobot(description.path, tuple(description.diagnostics))
    paths: dict[str, str] = {}
    meshes: dict[str, Mesh] = {}
    of_meshes: tuple[Diagnostic, ...] = ()
    without_geometry: Callable[[], Exception] | None = None
    if geometry:
        files = find_meshes(description.urdf, package_dirs, confined=confined, allow_outside=allow_outside)
        paths = files.paths
        meshes, unreadable = read_mesh_files(description.urdf, files)
        of_meshes = (*files.diagnostics, *unreadable)
        no_geometry = f"the geometry of {description.path} cannot be built; load it with geometry=False"
        if any(found.severity is Severity.ERROR for found in of_meshes):
            found = (*description.diagnostics, *inertia_diagnostics(description), *of_meshes)
            raise InvalidRobot(description.path, found, no_geometry)
        if any(shape.kind == "mesh" and paths.get(shape.filename) not in meshes for shape in _shapes(description)):
            # The kinematics need no mesh, so that what `check` passes is loaded; but shapes are not left out in
            # silence.
            without_geometry = partial(InvalidRobot, description.path, of_meshes, no_geometry)
    loops = strict or check_loops or "assembled" in description.mechanism.configurations
    robot = build_robot(
        description.mechanism,
        geometry=geometry and without_geometry is None,
        resolve=paths.get,
        meshes=meshes,
        no_geometry=without_geometry,
        diagnose=partial(_diagnostics, description, of_meshes, loops),
    )
    if strict or check_loops:  # a solver runs now, not when the diagnostics are first used
        errors = [found for found in robot.diagnostics if found.severity is Severity.ERROR]
        if strict and errors:
            raise InvalidRobot(description.path, robot.diagnostics)
    return robot


def _shapes(description: Linked) -> Iterator[Shape]:
    for link in description.urdf.links.values():
        yield from (*link.visuals, *link.collisions)


def _diagnostics(
    description: Linked, of_meshes: Sequence[Diagnostic], loops: bool, robot: Robot
) -> tuple[Diagnostic, ...]:
    """All diagnostics of a robot that was loaded, in the order of `eurdf.check`."""
    of_loops = closure_diagnostics(description, robot) if loops else ()
    return (*description.diagnostics, *inertia_diagnostics(description), *of_meshes, *of_loops)
