"""`eurdf.load`: a robot ready for Pinocchio, or the reasons why it cannot be built without guessing."""

from __future__ import annotations

import os
from collections.abc import Mapping, Sequence
from functools import partial

from eurdf.checking.loops import closure_diagnostics
from eurdf.checking.mesh_files import read_mesh_files
from eurdf.exceptions import InvalidRobot
from eurdf.linking.description import Unlinked, describe, find_meshes
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
    not: real files have them, and their kinematics are still of use. They are in ``robot.diagnostics`` (EU-CNF-003);
    whether loops can close is looked for only if `check_loops` says so.

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
    )
    diagnostics = description.diagnostics
    if isinstance(description, Unlinked):
        raise InvalidRobot(description.path, tuple(diagnostics))
    files: dict[str, str] = {}
    meshes: dict[str, Mesh] = {}
    lacks_mesh = False
    no_geometry = f"the geometry of {description.path} cannot be built; load it with geometry=False"
    if geometry:
        files, missing = find_meshes(description.urdf, package_dirs)
        meshes, unreadable = read_mesh_files(description.urdf, files)
        for found in (*missing, *unreadable):
            diagnostics.add(found)
        if unreadable.error_count:
            raise InvalidRobot(description.path, tuple(diagnostics), no_geometry)
        lacks_mesh = any(found.code == "urdf-mesh-missing" for found in missing)
    robot = build_robot(description.mechanism, geometry=geometry and not lacks_mesh, resolve=files.get, meshes=meshes)
    if strict or check_loops or "assembled" in description.mechanism.configurations:
        for found in closure_diagnostics(description, robot):
            diagnostics.add(found)
    if strict and diagnostics.error_count:
        raise InvalidRobot(description.path, tuple(diagnostics))
    return robot.diagnosed(
        tuple(diagnostics),
        # The kinematics need no mesh, so that what `check` passes is loaded; but shapes are not left out in silence.
        partial(InvalidRobot, description.path, tuple(missing), no_geometry) if lacks_mesh else None,
    )
