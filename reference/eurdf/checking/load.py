"""`eurdf.load`: a robot ready for Pinocchio, or the reasons why it cannot be built without guessing."""

from __future__ import annotations

import os
from collections.abc import Callable, Mapping, Sequence
from functools import partial

from eurdf.checking.loops import closure_diagnostics
from eurdf.checking.mesh_files import read_mesh_files
from eurdf.diagnostics import Diagnostic, Severity
from eurdf.exceptions import InvalidRobot
from eurdf.linking.description import Linked, Unlinked, describe, find_meshes, inertia_diagnostics
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
            nothing wrong with shapes is looked for. Where a mesh is missing, the robot is loaded and
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
        xacro_args: Values of the arguments of a xacro.
        confined: Whether it is an error if the description names a URDF outside its own folder, symbolic links
            followed. The URDF is then not opened. Meshes may be anywhere.

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
        inertias=False,
    )
    if isinstance(description, Unlinked):
        raise InvalidRobot(description.path, tuple(description.diagnostics))
    files: dict[str, str] = {}
    meshes: dict[str, Mesh] = {}
    of_meshes: tuple[Diagnostic, ...] = ()
    without_geometry: Callable[[], Exception] | None = None
    if geometry:
        files, missing = find_meshes(description.urdf, package_dirs)
        meshes, unreadable = read_mesh_files(description.urdf, files)
        of_meshes = (*missing, *unreadable)
        no_geometry = f"the geometry of {description.path} cannot be built; load it with geometry=False"
        if unreadable.error_count:
            found = (*description.diagnostics, *inertia_diagnostics(description), *of_meshes)
            raise InvalidRobot(description.path, found, no_geometry)
        if any(found.code == "urdf-mesh-missing" for found in missing):
            # The kinematics need no mesh, so that what `check` passes is loaded; but shapes are not left out in
            # silence.
            without_geometry = partial(InvalidRobot, description.path, tuple(missing), no_geometry)
    loops = strict or check_loops or "assembled" in description.mechanism.configurations
    robot = build_robot(
        description.mechanism,
        geometry=geometry and without_geometry is None,
        resolve=files.get,
        meshes=meshes,
        no_geometry=without_geometry,
        diagnose=partial(_diagnostics, description, of_meshes, loops),
    )
    if strict or check_loops:  # a solver runs now, not when the diagnostics are first used
        errors = [found for found in robot.diagnostics if found.severity is Severity.ERROR]
        if strict and errors:
            raise InvalidRobot(description.path, robot.diagnostics)
    return robot


def _diagnostics(
    description: Linked, of_meshes: Sequence[Diagnostic], loops: bool, robot: Robot
) -> tuple[Diagnostic, ...]:
    """All diagnostics of a robot that was loaded, in the order of `eurdf.check`."""
    of_loops = closure_diagnostics(description, robot) if loops else ()
    return (*description.diagnostics, *inertia_diagnostics(description), *of_meshes, *of_loops)
