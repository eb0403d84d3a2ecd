"""The sites that are frames."""

from __future__ import annotations

from eurdf.importing.mjcf.reading import MjcfReading
from eurdf.importing.mjcf.values import pose_from, usable
from eurdf.mechanism.body import Frame
from eurdf.mechanism.mechanism import ROOT_JOINT
from eurdf.writing.names import UniqueNames


def read_frames(reading: MjcfReading) -> tuple[Frame, ...]:
    """The sites with names, except the ends of closures, whose poses the closures state."""
    model = reading.model
    ends: set[int] = set()
    for index, kind in enumerate(model["eq_objtype"]):
        if kind == "site":
            ends |= {model["eq_obj1id"][index], model["eq_obj2id"][index]}
    for tendon in range(len(model["tendon_adr"])):
        ends |= {site for what, site, _ in reading.wraps(tendon) if what == "site"}
    bodies = (*reading.bodies.values(), *reading.extra)
    taken = {body.name for body in bodies} | {joint.name for joint in reading.joints}
    names = UniqueNames(reading.losses, "universe", ROOT_JOINT, *taken, code="import-name")
    found = []
    for site, body in enumerate(model["site_bodyid"]):
        name = usable(model.names["site"][site])
        if body not in reading.bodies or site in ends:
            continue
        if not name:
            reading.losses.add("import-frame", f"site {site} of {reading.bodies[body].name}")
            continue
        pose = pose_from(model["site_pos"][site], model["site_quat"][site])
        found.append(Frame(names.new(name), reading.bodies[body].name, pose))
    return tuple(found)
