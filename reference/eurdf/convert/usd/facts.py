"""What USD lacks, and the numbers that its simulators need and a description does not have."""

from __future__ import annotations

from eurdf.convert.common_losses import (
    ACCELERATION,
    BEYOND_LIMITS,
    COMMON,
    NOT_REFERENCED,
    driven,
    impossible_inertia,
    no_configuration,
)
from eurdf.convert.conventions import LIGHT
from eurdf.convert.losses import approximate, by_writer, dropped, exact
from eurdf.convert.steps import is_skew

#: kg·m² that a principal moment of any body has at least.
LEAST_MOMENT = 1e-12

#: Damping of a position drive, as a time: damping = this · stiffness, in s.
DAMPING_TIME = 0.1

#: The kind of joint of USD that a closure is.
CLOSURES = {"3d": "spherical", "6d": "fixed", "hinge": "revolute", "distance": "distance"}

#: Joints and closures that are as in the description.
EXACT = (
    *(
        f"{kind} joint"
        for kind in ("revolute", "continuous", "prismatic", "planar", "floating", "spherical", "cylindrical", "fixed")
    ),
    *(f"{kind} closure" for kind in CLOSURES),
)

_DRIVEN = ("motor", "position")

ROWS = (
    approximate(
        "number",
        "frames of joints, masses, limits and gains are in single precision, angles in degrees: relative error 6e-8",
        "this is far below what a simulator in single precision computes; for more, export to MJCF",
        code="export-single-precision",
        error="6e-8 of each number",
    ),
    approximate(
        "universal joint",
        "becomes a D6 joint: USD does not state the order of its rotations; here it is x first, as in Newton",
        "check the joint away from its zero in a simulator other than Newton",
        error="none in Newton, and none at the joint's zero",
        where=lambda joint: not is_skew(joint),
    ),
    approximate(
        "universal joint",
        f"becomes two joints with a body of {LIGHT:g} kg and kg·m² between them, as its axes are not perpendicular",
        "use a simulator with reduced coordinates, to which light bodies do no harm",
        code="export-skew-universal-joint",
        error=f"{LIGHT:g} kg and kg·m² in the mass matrix",
        only="axes not perpendicular",
        where=is_skew,
    ),
    dropped(
        "helical joint",
        "becomes a D6 joint that turns and advances independently: nothing in USD couples a rotation to a translation",
        "couple the two axes in the simulator, or export to MJCF",
    ),
    approximate(
        "mimic joint",
        "NewtonMimicAPI states its leader, as USD has no mimic joints: other simulators leave it free",
        "in simulators other than Newton, couple the two joints by hand",
        error="none in Newton; elsewhere the joint is free",
        where=by_writer,
    ),
    dropped(
        "mimic joint",
        "is free: NewtonMimicAPI does not relate a rotation to a translation",
        "couple the two joints in the simulator, or export to MJCF",
        code="export-mimic-joint-dropped",
        only="a rotation and a translation",
        where=by_writer,
    ),
    approximate(
        "velocity limit",
        "is in the schemas of Newton and PhysX, as USD has none; of several axes, the smallest",
        "in other simulators, limit velocities in the controller",
        error="none in Newton and PhysX; elsewhere there is no limit",
        where=by_writer,
    ),
    dropped(
        "effort limit",
        "is left out: in USD, a drive has it, and the joint has none",
        "limit efforts in the controller",
        only="joints without a drive",
        where=by_writer,
    ),
    approximate(
        "damping",
        "is in the schema of Newton, as USD has no drive of spherical joints; of several axes, the mean",
        "in other simulators, damp the joint in the controller",
        code="export-ball-damping",
        error="none in Newton; elsewhere there is no damping",
        types=("spherical",),
    ),
    approximate(
        "friction",
        "is in the schema of Newton, as USD has none; of several axes, the mean",
        "set the friction of the joint in other simulators",
        error="none in Newton; elsewhere there is no friction",
        where=by_writer,
    ),
    approximate(
        "armature",
        "is in the schemas of Newton and PhysX, as USD has none; of several axes, the mean",
        "set the armature of the joint in other simulators",
        error="none in Newton and PhysX; elsewhere there is no armature",
        where=by_writer,
    ),
    dropped(
        "armature",
        "armature, friction and velocity limit are left out: simulators have one number for rotations and translations",
        "set them in the simulator",
        code="export-mixed-axes",
        only="planar, cylindrical and floating joints",
        where=by_writer,
    ),
    exact(
        "gear ratio",
        "drives are on the side of the joint; the rotor is in the armature, gear ratio² · rotor inertia",
        "divide commands of the motor side by the gear ratio",
        actuators=_DRIVEN,
        where=lambda motor: motor.is_actuated,
    ),
    dropped(
        "spring",
        "is left out: the joint has a position drive, and USD has one drive for an axis",
        "export with actuators 'motor'",
        sayable=True,
        actuators=("position",),
        where=by_writer,
    ),
    approximate(
        "coupling",
        "NewtonMimicAPI states it, as USD has no couplings: other simulators leave the joints free",
        "in simulators other than Newton, couple the two joints by hand",
        error="none in Newton; elsewhere the joints are free",
        where=by_writer,
    ),
    dropped(
        "coupling",
        "is left out: NewtonMimicAPI relates two rotations or two translations, and gives a joint one leader",
        "couple the joints in the simulator",
        code="export-coupling-dropped",
        only="a rotation and a translation, or several leaders",
        where=by_writer,
    ),
    dropped(
        "compliance", "is left out: USD has rigid joints alone", "set the compliance of the joint in the simulator"
    ),
    dropped(
        "actuator",
        "is left out: USD has no drive of spherical joints",
        "apply torques to the two bodies",
        code="export-no-drive",
        types=("spherical",),
        actuators=_DRIVEN,
    ),
    *driven("stiffness and damping of the drive"),
    dropped(
        "actuator",
        "its name is left out: a drive has that of its joint",
        "use the name of the joint",
        code="export-actuator-name",
        only="its name",
        actuators=_DRIVEN,
        where=lambda motor: motor.name != motor.joint.name,
    ),
    approximate(
        "control range",
        "is not symmetric: a drive has the larger of its two magnitudes as its largest force",
        "limit commands in the controller",
        error="the smaller magnitude may be exceeded, up to the larger one",
        only="not symmetric",
        actuators=_DRIVEN,
        where=lambda motor: motor.type != "spherical" and motor.control[0] != -motor.control[1],
    ),
    approximate(
        "link without mass",
        f"moves without inertia, and USD takes 0 for unknown: gets {LIGHT:g} kg and kg·m²",
        "give the link its mass, or merge its joints into one of a type with several axes",
        code="export-massless-link",
        error=f"{LIGHT:g} kg and kg·m² in the mass matrix",
        only="links that move",
    ),
    exact(
        "link without mass",
        "is fixed to the world, and USD takes 0 for unknown: gets 1 kg and 1 kg·m², without effect",
        "give the link its mass",
        code="export-massless-base",
        only="the fixed base",
    ),
    impossible_inertia("simulators ask for"),
    approximate(
        "collision shape",
        "the mesh collides as its convex hull",
        "set physics:approximation of the shape",
        code="export-convex-hull",
        error="the distance of the mesh to its convex hull",
        only="meshes",
    ),
    approximate(
        "mesh",
        "becomes a USD mesh",
        "add materials and normals to the mesh",
        code="export-mesh-converted",
        error="6e-8 of the coordinates of vertices; materials, textures and normals in the file are left out",
    ),
    dropped(
        "mesh",
        "it cannot be read",
        "convert the mesh, and name the new file in the URDF",
        code="export-mesh-format",
        sayable=True,
    ),
    dropped("texture", "is left out; the color is kept", "add the texture to the material"),
    dropped(
        "configuration",
        "is left out: a stage has one, where the bodies are",
        "export again with --configuration, or set the joints in the simulator",
        code="export-configurations",
        sayable=True,
        only="all but one",
        where=by_writer,
    ),
    BEYOND_LIMITS,
    no_configuration(": the bodies are where all coordinates are 0, and the loops may be open"),
    NOT_REFERENCED,
    ACCELERATION,
    *COMMON,
)
