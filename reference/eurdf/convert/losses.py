"""What is lost between a robot and a file of another format: the kinds of loss, and each one that was found."""

from __future__ import annotations

from dataclasses import dataclass
from enum import Enum


class Effect(str, Enum):
    """How much of an element is left in what is written.

    ``exact``: all that has an effect on the robot, in other terms. ``approximate``: it behaves almost as it should.
    ``dropped``: nothing is left of it.
    """

    __str__ = str.__str__

    EXACT = "exact"
    APPROXIMATE = "approximate"
    DROPPED = "dropped"


#: What a mechanism can contain: the rows of the table of losses.
CONCEPTS = (
    "revolute joint",
    "continuous joint",
    "prismatic joint",
    "planar joint",
    "floating joint",
    "spherical joint",
    "universal joint",
    "cylindrical joint",
    "helical joint",
    "fixed joint",
    "floating root",
    "mimic joint",
    "position limit",
    "velocity limit",
    "effort limit",
    "acceleration limit",
    "damping",
    "friction",
    "armature",
    "gear ratio",
    "spring",
    "3d closure",
    "6d closure",
    "hinge closure",
    "distance closure",
    "coupling",
    "compliance",
    "actuator",
    "control range",
    "inertia",
    "link without mass",
    "visual shape",
    "collision shape",
    "mesh",
    "color",
    "texture",
    "frame",
    "configuration",
    "number",
    "name",
    "metadata",
)


@dataclass(frozen=True, slots=True)
class LossKind:
    """A way in which an export or an import cannot say what it is given.

    Attributes:
        code: Its permanent name, ``export-`` or ``import-`` and a few words.
        concept: One of `CONCEPTS`.
        effect: What is left.
        title: What happens, as one sentence.
        hint: What the user can do.
        error: Of an approximate one: how large the error is.
        only: Which elements of the concept it is about, or with which option; empty if it is about all.
        sayable: Whether the format could say it: it is dropped because of an option or of the robot's files.
    """

    code: str
    concept: str
    effect: Effect
    title: str
    hint: str
    error: str = ""
    only: str = ""
    sayable: bool = False


#: Losses that all formats to export to share.
COMMON = (
    LossKind(
        "export-no-range",
        "position limit",
        Effect.EXACT,
        "its limits are 0 and 0, which is no range: it has no limit in the file",
        "state 'lower' and 'upper', or make the joint 'fixed' to lock it",
        only="limits that are both 0",
    ),
    LossKind(
        "export-name",
        "name",
        Effect.EXACT,
        "is changed: the format cannot contain it, or has it already",
        "choose another name in the description",
        only="names that the format does not allow",
    ),
    LossKind(
        "export-metadata",
        "metadata",
        Effect.DROPPED,
        "metadata and user data are left out",
        "keep the description beside the file",
    ),
    LossKind(
        "export-hinge",
        "3d closure",
        Effect.EXACT,
        "becomes a hinge: its bodies turn about one axis against each other",
        "see the losses of hinge closures",
        only="--closures hinge",
    ),
    LossKind(
        "export-ball",
        "3d closure",
        Effect.EXACT,
        "stays as it is: its bodies turn about more than one axis against each other, or not at all",
        "choose a solver that has ball joints in loops",
        only="--closures hinge",
    ),
    LossKind(
        "export-mesh-path",
        "mesh",
        Effect.EXACT,
        "its package:// address becomes a path: other programs do not know the package",
        "write the file to a package, and change the path there, if you need the address",
        only="package:// addresses",
    ),
    LossKind(
        "export-mesh-missing",
        "mesh",
        Effect.DROPPED,
        "its file was not found",
        "give the folder of its package, --package-dir or package_dirs=",
        sayable=True,
        only="files not found",
    ),
    LossKind(
        "export-mesh-refused",
        "mesh",
        Effect.DROPPED,
        "is left out: it is outside the robot's folder, or is no mesh",
        "copy it into the robot's folder, give the folder of its package with --package-dir or package_dirs=, or use "
        "--allow-outside or allow_outside=True",
        sayable=True,
        only="files that are refused",
    ),
    LossKind(
        "export-file-outside",
        "mesh",
        Effect.EXACT,
        "is outside the robot's folder, and was read because of --allow-outside",
        "copy it into the robot's folder",
        only="--allow-outside",
    ),
)

#: Of limits that URDF has from version 1.2 on.
ACCELERATION = LossKind(
    "export-acceleration-limit",
    "acceleration limit",
    Effect.DROPPED,
    "limits of acceleration, deceleration and jerk are left out: the format has none",
    "limit them where motions are planned",
)

#: Of a file that a mesh names, where meshes are copied.
NAMED_FILE = LossKind(
    "export-mesh-names",
    "mesh",
    Effect.DROPPED,
    "a material, a buffer or a picture that it names is left out",
    "copy it into the robot's folder, and name it by its path from the mesh",
    sayable=True,
    only="files that it names",
)

#: Of the configuration to start from, where it is written.
BEYOND_LIMITS = LossKind(
    "export-beyond-limits",
    "configuration",
    Effect.APPROXIMATE,
    "has joints beyond their limits: none was found that closes the loops within all of them",
    "widen the limits, or state a configuration 'assembled' within them",
    error="a simulation that starts there pushes the joints back",
    only="joints beyond their limits",
)

#: Of a mesh that is converted though it should have been referenced.
NOT_REFERENCED = LossKind(
    "export-mesh-not-referenced",
    "mesh",
    Effect.EXACT,
    "is in meshes/ in spite of --mesh-files reference, since it is converted",
    "keep meshes/ beside the file",
    only="--mesh-files reference",
)

#: Losses of meshes that a program cannot read.
CONVERSION = (
    NOT_REFERENCED,
    LossKind(
        "export-mesh-converted",
        "mesh",
        Effect.APPROXIMATE,
        "its format is not one that the program reads: becomes an OBJ file",
        "convert the mesh with its materials, and name the new file in the URDF",
        error="none in the triangles; materials, textures and normals in the file are left out",
        only="files that the program does not read",
    ),
    LossKind(
        "export-mesh-format",
        "mesh",
        Effect.DROPPED,
        "its format is not one that the program reads, and it cannot be converted",
        "convert the mesh, and name the new file in the URDF",
        sayable=True,
        only="files that nothing reads",
    ),
)


@dataclass(frozen=True, slots=True)
class Loss:
    """One loss of one export or import.

    Attributes:
        code: Name of its kind.
        effect: What is left.
        concept: Kind of the element, one of `CONCEPTS`.
        name: Name of the element: of a joint, a link, a closure, an actuator.
        message: What happened, with values.
        hint: What the user can do.
    """

    code: str
    effect: Effect
    concept: str
    name: str
    message: str
    hint: str

    def __str__(self) -> str:
        return f"{self.effect}: {self.concept} '{self.name}': {self.message} [{self.code}]"


class Losses:
    """The losses that an export or an import finds, each of a kind that its format has registered."""

    def __init__(self, kinds: tuple[LossKind, ...]) -> None:
        self._kinds = {kind.code: kind for kind in kinds}
        self._found: dict[tuple[str, str], Loss] = {}

    def add(self, code: str, name: str, message: str = "") -> None:
        """Record a loss; the second one of a kind for the same element is the same loss.

        Args:
            code: Of a registered kind.
            name: Name of the element.
            message: What happened; the title of the kind by default.
        """
        kind = self._kinds[code]
        loss = Loss(code, kind.effect, kind.concept, name, message or kind.title, kind.hint)
        self._found.setdefault((code, name), loss)

    @property
    def found(self) -> tuple[Loss, ...]:
        """What was recorded, in order."""
        return tuple(self._found.values())
