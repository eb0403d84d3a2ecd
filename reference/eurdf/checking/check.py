"""`eurdf.check`: everything that can be found wrong with a robot."""

from __future__ import annotations

import os
from collections.abc import Mapping, Sequence

from eurdf.checking.advice.angles import advise_on_angles
from eurdf.checking.advice.lengths import advise_on_lengths
from eurdf.checking.advice.mimics import advise_on_mimics
from eurdf.checking.advice.quaternions import advise_on_quaternions
from eurdf.checking.loops import closure_diagnostics
from eurdf.checking.mesh_files import read_mesh_files
from eurdf.diagnostics.report import Report
from eurdf.linking.description import Described, Unlinked, describe, find_meshes
from eurdf.pinocchio.meshes import Mesh
from eurdf.reading.given import Given


def check(
    path: Given,
    urdf: Given | None = None,
    *,
    package_dirs: Sequence[str | os.PathLike[str]] = (),
    xacro_args: Mapping[str, str] | None = None,
    confined: bool = False,
    allow_outside: bool = False,
) -> Report:
    """Check a robot: EU-DIA-001, EU-DIA-003: every error that no other error hides is reported.

    It also gives advice (EU-DIA-006): warnings without a clause, whose codes begin with ``x-``.

    Args:
        path: A folder, a YAML file, a bare URDF or xacro, the name of a robot of the collection, ``-`` for standard
            input, a pipe, or a text: one that begins with ``<`` is a URDF, any other a description.
        urdf: A URDF in place of the one that the description names: a file, ``-``, a pipe or a text.
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
        The findings of all phases, in the order of the phases.

    Raises:
        RobotNotFound: Where there are no such files.
        CannotExpand: A xacro has an error, or `xacro_args` are given for what is no xacro.
        MissingExtra: A xacro is given, and the extra ``xacro`` is not installed.
        ValueError: `confined` and `allow_outside` are both True.
    """
    description = describe(
        path,
        urdf,
        package_dirs=package_dirs,
        xacro_args=xacro_args,
        confined=confined,
        allow_outside=allow_outside,
    )
    diagnostics = description.diagnostics
    refused = diagnostics.refused  # without meshes, which the kinematics does not need
    meshes: dict[str, Mesh] = {}
    if description.urdf is not None:
        files = find_meshes(description.urdf, package_dirs, confined=confined, allow_outside=allow_outside)
        by_path, unreadable = read_mesh_files(description.urdf, files)
        meshes = {uri: by_path[path] for uri, path in files.paths.items() if path in by_path}
        for found in (*files.diagnostics, *unreadable):
            diagnostics.add(found)
    if not isinstance(description, Unlinked) and not refused:
        if isinstance(description, Described):
            if description.mechanism.constraints:
                _check_loops(description)
            else:
                advise_on_quaternions(description, None, diagnostics)
        advise_on_mimics(description, diagnostics)
        advise_on_angles(description, diagnostics)
        advise_on_lengths(description, meshes, diagnostics)
    return Report(description.path, tuple(diagnostics))


def _check_loops(description: Described) -> None:
    """Report what needs a simulator: whether the loops close and, where there is no error, advice on how they move."""
    # Only now: a description without closures is checked without a simulator.
    from eurdf.checking.advice.actuation import advise_on_actuation
    from eurdf.checking.advice.limits import advise_on_limits
    from eurdf.checking.advice.massless import advise_on_massless_links
    from eurdf.kinematics.assembly import assemble
    from eurdf.pinocchio.robot import build_robot

    diagnostics = description.diagnostics
    robot = build_robot(description.mechanism, geometry=False)
    assembly = None if "assembled" in robot.configurations else assemble(robot)
    for found in closure_diagnostics(description, robot, assembly):
        diagnostics.add(found)
    given_up = assembly is not None and assembly.reason == "not decided"
    if not given_up and not diagnostics.error_count:
        q = robot.configurations["assembled"] if assembly is None else assembly.q
        advise_on_quaternions(description, robot, diagnostics)
        advise_on_massless_links(description, robot, q, diagnostics)
        advise_on_actuation(description, robot, q, diagnostics)
        advise_on_limits(description, robot, q, diagnostics)
