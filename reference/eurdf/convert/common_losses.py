"""Losses that formats to export to share."""

from __future__ import annotations

from collections.abc import Iterable
from typing import Any

from eurdf.convert.losses import LossKind, approximate, by_writer, dropped, exact

#: Losses that all formats to export to share.
COMMON = (
    exact(
        "position limit",
        "its limits are 0 and 0, which is no range: it has no limit in the file",
        "state 'lower' and 'upper', or make the joint 'fixed' to lock it",
        code="export-no-range",
        only="limits that are both 0",
        where=lambda joint: joint.lacks_range,
    ),
    exact(
        "name",
        "is changed: the format cannot contain it, or has it already",
        "choose another name in the description",
        only="names that the format does not allow",
    ),
    dropped("metadata", "metadata and user data are left out", "keep the description beside the file"),
    dropped(
        "contact",
        "is left out: contacts with the world are no part of a description",
        "add it to the file, or simulate the ground",
        sayable=True,
    ),
    exact(
        "3d closure",
        "becomes a hinge: its bodies turn about one axis against each other",
        "see the losses of hinge closures",
        code="export-hinge",
        only="--closures hinge",
        where=by_writer,
    ),
    exact(
        "3d closure",
        "stays as it is: its bodies turn about more than one axis against each other, or not at all",
        "choose a solver that has ball joints in loops",
        code="export-ball",
        only="--closures hinge",
        where=by_writer,
    ),
    exact(
        "mesh",
        "its package:// address becomes a path: other programs do not know the package",
        "write the file to a package, and change the path there, if you need the address",
        code="export-mesh-path",
        only="package:// addresses",
    ),
    dropped(
        "mesh",
        "its file was not found",
        "give the folder of its package, --package-dir or package_dirs=",
        code="export-mesh-missing",
        sayable=True,
        only="files not found",
    ),
    dropped(
        "mesh",
        "is left out: it is outside the robot's folder, or is no mesh",
        "copy it into the robot's folder, give the folder of its package with --package-dir or package_dirs=, or use "
        "--allow-outside or allow_outside=True",
        code="export-mesh-refused",
        sayable=True,
        only="files that are refused",
    ),
    exact(
        "mesh",
        "is outside the robot's folder, and was read because of --allow-outside",
        "copy it into the robot's folder",
        code="export-file-outside",
        only="--allow-outside",
    ),
)

#: Of a kind of closure or joint that a format does not know. No kind of ours has these: the tests see to it.
UNKNOWN = (
    dropped(
        "closure",
        "is left out: the format does not know its type",
        "export to another format, or describe the loop by closures of other types",
        code="export-closure-kind",
        message=lambda closure: f"is left out: the format does not know the type '{closure.type}'",
    ),
    approximate(
        "joint",
        "the format does not know its type: becomes turns, slides and balls in series",
        "use Export.coordinates",
        code="export-joint-kind",
        error="none in poses; links between the joints may need mass",
        message=lambda joint: f"the format does not know the type '{joint.type}': becomes turns, slides and balls",
    ),
)

#: Of limits that URDF has from version 1.2 on.
ACCELERATION = dropped(
    "acceleration limit",
    "limits of acceleration, deceleration and jerk are left out: the format has none",
    "limit them where motions are planned",
)

#: Of a file that a mesh names, where meshes are copied.
NAMED_FILE = dropped(
    "mesh",
    "a material, a buffer or a picture that it names is left out",
    "copy it into the robot's folder, and name it by its path from the mesh",
    code="export-mesh-names",
    sayable=True,
    only="files that it names",
)

#: Of the configuration to start from, where it is written.
BEYOND_LIMITS = approximate(
    "configuration",
    "has joints beyond their limits: none was found that closes the loops within all of them",
    "widen the limits, or state a configuration 'assembled' within them",
    code="export-beyond-limits",
    error="a simulation that starts there pushes the joints back",
    only="joints beyond their limits",
    where=by_writer,
)

#: Of a mesh that is converted though it should have been referenced.
NOT_REFERENCED = exact(
    "mesh",
    "is in meshes/ in spite of --mesh-files reference, since it is converted",
    "keep meshes/ beside the file",
    code="export-mesh-not-referenced",
    only="--mesh-files reference",
)

#: Losses of meshes that a program cannot read.
CONVERSION = (
    NOT_REFERENCED,
    approximate(
        "mesh",
        "its format is not one that the program reads: becomes an OBJ file",
        "convert the mesh with its materials, and name the new file in the URDF",
        code="export-mesh-converted",
        error="none in the triangles; materials, textures and normals in the file are left out",
        only="files that the program does not read",
    ),
    dropped(
        "mesh",
        "its format is not one that the program reads, and it cannot be converted",
        "convert the mesh, and name the new file in the URDF",
        code="export-mesh-format",
        sayable=True,
        only="files that nothing reads",
    ),
)


def no_configuration(consequence: str) -> LossKind:
    """Of a robot with loops for which no closed configuration was found."""
    return dropped(
        "configuration",
        f"no closed configuration was found{consequence}",
        "find one with `eurdf assemble`, and write it to the description as 'assembled'",
        code="export-no-configuration",
        sayable=True,
        only="none is closed",
        where=by_writer,
    )


def impossible_inertia(program: str) -> LossKind:
    """Of inertias that no body has, where a program refuses or replaces these."""
    return approximate(
        "inertia",
        f"is not that of a body with volume, which {program}: principal moments are raised",
        "correct the inertia in the URDF; `eurdf check` reports those that no body has",
        error="the message gives the change of a principal moment; none in mass and centre of mass",
        only="what no body has",
    )


def unequal(concepts: Iterable[str], **more: Any) -> tuple[LossKind, ...]:
    """Of joints whose axes have different values of these, of which the mean is written."""
    title = "the axes of the joint have different values: their mean is written"
    return tuple(
        approximate(
            concept,
            title,
            "give the axes of the joint one value",
            code=f"export-unequal-{concept}",
            error="difference of the values to their mean",
            where=by_writer,
            **more,
        )
        for concept in concepts
    )


def driven(what_to_set: str) -> tuple[LossKind, ...]:
    """Of actuators, in a format that has them: of gains of position actuators, and of those that are not asked for."""
    return (
        approximate(
            "actuator",
            "the description has no gain",
            f"set {what_to_set}",
            code="export-position-gain",
            error="gain and damping are this export's choice",
            actuators=("position",),
            where=by_writer,
        ),
        dropped(
            "actuator",
            "is left out, as asked for",
            "export with actuators 'motor' or 'position'",
            code="export-no-actuator",
            sayable=True,
            actuators=("none",),
        ),
    )
