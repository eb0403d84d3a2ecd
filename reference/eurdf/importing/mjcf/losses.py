"""The losses of an import from MJCF."""

from __future__ import annotations

from eurdf.convert.losses import Effect, LossKind
from eurdf.importing.mesh_copies import NAMED_FILE

LOSSES = (
    LossKind(
        "import-name",
        "name",
        Effect.EXACT,
        "is changed: the name is missing, reserved, or used by another element",
        "give the element a unique name in the file",
    ),
    LossKind(
        "import-scenery",
        "world",
        Effect.DROPPED,
        "the shapes of the world, and bodies that nothing moves, are left out: the root of the robot floats",
        "import the file of the robot alone",
    ),
    LossKind(
        "import-softness",
        "equality",
        Effect.APPROXIMATE,
        "becomes rigid: solref and solimp are left out",
        "give the closure a compliance, if simulators should know it",
    ),
    LossKind("import-inactive-equality", "equality", Effect.DROPPED, "is not active, and is left out", "activate it"),
    LossKind(
        "import-equality",
        "equality",
        Effect.DROPPED,
        "is left out: it is no closure of two bodies and no linear relation of joints",
        "describe it by a closure, a coupling or a mimic joint",
    ),
    LossKind(
        "import-redundant-equality",
        "equality",
        Effect.EXACT,
        "is left out: it joins two bodies that are fixed to each other, or repeats another equality",
        "remove it",
    ),
    LossKind(
        "import-locked-joint", "joint", Effect.EXACT, "is fixed where an equality holds it", "make it a fixed body"
    ),
    LossKind(
        "import-tendon",
        "tendon",
        Effect.DROPPED,
        "its limits, springs and losses are left out",
        "describe what it does by springs of joints or couplings",
    ),
    LossKind(
        "import-tendon-actuator",
        "actuator",
        Effect.APPROXIMATE,
        "pulls a tendon: becomes a motor of the one joint that moves all others of the tendon",
        "check which joint the motor should drive",
    ),
    LossKind(
        "import-actuator",
        "actuator",
        Effect.DROPPED,
        "is left out: it does not act on one joint",
        "name the actuated joint in the description",
    ),
    LossKind(
        "import-second-actuator",
        "actuator",
        Effect.DROPPED,
        "is left out: its joint has another actuator",
        "keep one actuator of a joint",
    ),
    LossKind(
        "import-actuator-gain",
        "actuator",
        Effect.DROPPED,
        "its gain, bias and dynamics are left out: it becomes a source of torque or force",
        "keep its controller beside the description",
    ),
    LossKind(
        "import-effort-limit",
        "effort limit",
        Effect.APPROXIMATE,
        "is not stated: the largest torque or force of the actuator is taken",
        "correct it in the description",
    ),
    LossKind(
        "import-unequal-effort",
        "effort limit",
        Effect.APPROXIMATE,
        "is not the same in both directions: the larger one is taken",
        "give the actuator a control range",
    ),
    LossKind(
        "import-ball-limit",
        "position limit",
        Effect.DROPPED,
        "is left out: a spherical joint has no limits",
        "limit the angle of the joint in the simulator",
    ),
    LossKind(
        "import-ball-spring",
        "spring",
        Effect.DROPPED,
        "is left out: spherical and floating joints have no springs",
        "add the spring in the simulator",
    ),
    LossKind(
        "import-nonlinear-spring",
        "spring",
        Effect.DROPPED,
        "the nonlinear part of its stiffness or damping is left out",
        "add it in the simulator",
    ),
    LossKind(
        "import-gravity-compensation",
        "link",
        Effect.DROPPED,
        "its gravity compensation is left out",
        "compensate gravity in the controller",
    ),
    LossKind(
        "import-mocap",
        "link",
        Effect.APPROXIMATE,
        "is moved by the user (mocap): becomes fixed",
        "make it a body with a free joint",
    ),
    LossKind(
        "import-shape",
        "shape",
        Effect.DROPPED,
        "is left out: URDF has no planes, ellipsoids, height fields and signed distance fields",
        "replace it by boxes, spheres, capsules, cylinders or a mesh",
    ),
    LossKind(
        "import-hidden-shape",
        "shape",
        Effect.DROPPED,
        "is left out: it is neither visible nor touches anything",
        "remove it",
    ),
    LossKind(
        "import-mesh",
        "mesh",
        Effect.DROPPED,
        "is left out",
        "correct its file, or name the folder of the file with --within (within= in Python), and import again",
    ),
    NAMED_FILE,
    LossKind(
        "import-mesh-converted",
        "mesh",
        Effect.APPROXIMATE,
        "is not in a file that URDF can name: its vertices, in single precision, are written as OBJ",
        "save it as STL or OBJ",
    ),
    LossKind("import-texture", "texture", Effect.DROPPED, "is left out; the color is kept", "add it to the URDF"),
    LossKind(
        "import-frame", "frame", Effect.DROPPED, "a site without a name is left out", "give it a name in the file"
    ),
    LossKind(
        "import-configuration",
        "configuration",
        Effect.DROPPED,
        "is left out: a coordinate is beyond its limits",
        "correct the keyframe or the limits",
    ),
    LossKind(
        "import-simulation",
        "simulation",
        Effect.DROPPED,
        "is no part of a description",
        "keep it in a file of the simulator",
    ),
)
