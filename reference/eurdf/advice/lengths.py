"""Advice on lengths that are so large that they are likely in millimetres, and on robots below a millimetre."""

from __future__ import annotations

import math
from collections.abc import Callable, Iterator, Mapping
from functools import partial

from eurdf.closures import CLOSED
from eurdf.diagnostics import Diagnostics, Place
from eurdf.format.urdf.data import Urdf
from eurdf.linking.mesh_files import place_of_file
from eurdf.linking.robot_files import ReadRobot
from eurdf.pinocchio.meshes import Mesh

# A length beyond this, in m, is looked at. In a hundred published robots the longest is 2.9 m.
_LONG = 10.0

# Beyond this, in m, a length would be a kilometre and more in millimetres: it has another error.
_MOST = 1e6

# A single length is likely in millimetres where it is so many times the median of the distances between joints.
_TIMES = 100.0

# In kg for each metre of the median of the distances between joints: what weighs more, as a crane does, may be so long.
_HEAVY = 10.0

# A robot all of whose lengths are below this, in m, is not much larger than closures may be open.
_SHORT = 1e-3

# A length in m, what it is the length of, and its place.
_Found = tuple[float, str, Callable[[], Place]]


def advise_on_lengths(read: ReadRobot, meshes: Mapping[str, Mesh], diagnostics: Diagnostics) -> None:
    """Report lengths that are likely in millimetres: of the whole robot, or else single ones far beyond the others.

    And a robot with loops that is smaller than a millimetre.
    """
    urdf = read.urdf
    joints = [found for found in _between_joints(urdf) if found[0] > 0.0]
    if not joints:
        return
    ordered = sorted(length for length, _, _ in joints)
    half = len(ordered) // 2
    median = 0.5 * (ordered[half] + ordered[-half - 1])
    if _LONG < median <= _MOST:
        mass = sum(link.inertia.mass for link in urdf.links.values() if link.inertia is not None)
        if mass <= _HEAVY * median:
            length, what, place = next(found for found in joints if found[0] >= median)
            weight = f", and all links weigh {mass:.3g} kg" if mass > 0.0 else ""
            message = f"{what} is {length:.4g} m; the median for all joints is {median:.4g} m{weight}"
            diagnostics.report("x-length-in-millimetres", message, place, _hint(length))
        return
    in_meshes, in_urdf, in_yaml = (
        list(_of_meshes(urdf, meshes)),
        [*joints, *_centres_of_mass(urdf)],
        list(_of_yaml(read)),
    )
    length, what, place = max((*in_urdf, *in_yaml), key=lambda found: found[0])
    if length < _SHORT and read.mechanism.constraints:
        message = f"{what} is {length:.4g} m, and no length of the robot is larger"
        hint = f"lengths are in m; closures may be open by {CLOSED:g} m, so state so small a robot in a larger unit"
        diagnostics.report("x-tiny-robot", message, place, hint)
    for of_a_kind in (in_urdf, in_yaml, in_meshes):
        long = [found for found in of_a_kind if max(_LONG, _TIMES * median) < found[0] <= _MOST]
        if not long:
            continue
        length, what, place = long[0]
        more = f"; {len(long) - 1} more are too large" if len(long) > 1 else ""
        message = (
            f"{what} is {length:.4g} m, {length / median:.3g} times the median distance between joints, {median:.3g} m"
        )
        hint = _hint(length)
        if of_a_kind is in_meshes:
            hint = """if the mesh is in millimetres, add scale="0.001 0.001 0.001" to <mesh>"""
        diagnostics.report("x-length-in-millimetres", message + more, place, hint)


def _hint(length: float) -> str:
    return f"lengths are in m: {length:.4g} mm are {length / 1000.0:.4g} m"


def _between_joints(urdf: Urdf) -> Iterator[_Found]:
    """The origins of the joints, except those that only place the robot in its world."""
    for joint in urdf.joints.values():
        if joint.parent != urdf.root or not joint.type.is_fixed:
            origin = joint.element.find("origin")
            place = partial(urdf.document.place, joint.element if origin is None else origin, "xyz")
            yield math.hypot(*joint.placement.xyz), f"the distance of joint '{joint.name}' from its parent", place


def _centres_of_mass(urdf: Urdf) -> Iterator[_Found]:
    for link in urdf.links.values():
        if link.inertia is not None and link.inertial is not None and any(link.inertia.pose.xyz):
            origin = next(link.inertial.iterchildren("origin"))
            place = partial(urdf.document.place, origin, "xyz")
            yield (
                math.hypot(*link.inertia.pose.xyz),
                f"the distance of the centre of mass of link '{link.name}' from its origin",
                place,
            )


def _of_yaml(read: ReadRobot) -> Iterator[_Found]:
    """The positions of the frames that the description gives."""
    if read.yaml is None:
        return
    for reference in read.description.references:
        if any(reference.xyz):
            place = partial(read.description.document.place, (*reference.pointer, "xyz"))
            yield math.hypot(*reference.xyz), "the distance of a frame from its link or joint", place


def _of_meshes(urdf: Urdf, meshes: Mapping[str, Mesh]) -> Iterator[_Found]:
    """The sizes of meshes that are not scaled; a format other than STL and OBJ can state its unit."""
    seen: set[str] = set()
    for link in urdf.links.values():
        for shape in (*link.visuals, *link.collisions):
            uri = shape.filename
            if uri in meshes and uri not in seen and shape.size == (1.0, 1.0, 1.0):
                seen.add(uri)
                if uri.lower().endswith((".stl", ".obj")):
                    place = partial(place_of_file, urdf, "mesh", uri)
                    yield meshes[uri].size, f"the size of mesh '{uri}'", place
