"""The bodies, with their inertias."""

from __future__ import annotations

import math

from eurdf.importing.mjcf.reading import WORLD, MjcfReading
from eurdf.importing.mjcf.shapes import read_shapes
from eurdf.importing.mjcf.values import pose_from, usable, vector
from eurdf.mechanism.body import Body, Inertia
from eurdf.mechanism.pose import Pose

#: Mass (kg) and moments (kg·m²) up to this are those of a link without inertia, which MuJoCo does not allow to move.
LEAST = 1e-13


def read_body(reading: MjcfReading, body: int) -> Body:
    """A body, with its shapes."""
    model = reading.model
    stated = model.names["body"][body]
    name = reading.links.new(usable(stated) or (f"body_{body}" if body else WORLD))
    if not stated or usable(stated) != stated:
        reading.losses.add("import-name", stated or f"body {body}", f"becomes '{name}'")
    if model["body_gravcomp"][body]:
        reading.losses.add("import-gravity-compensation", name)
    if model["body_mocapid"][body] >= 0:
        reading.losses.add("import-mocap", name)
    visuals, collisions = read_shapes(reading, body)
    return Body(name, _inertia(reading, body), tuple(visuals), tuple(collisions))


def _inertia(reading: MjcfReading, body: int) -> Inertia | None:
    model = reading.model
    mass, principal = model["body_mass"][body], model["body_inertia"][body]
    if mass <= LEAST and max(principal) <= LEAST:
        return None
    full = model.full_inertia.get(body)
    # The compiler may have scaled or balanced it.
    if full is not None and math.isclose(sum(full[:3]), sum(principal), rel_tol=1e-12):
        xx, yy, zz, xy, xz, yz = full
        return Inertia(mass, Pose(vector(model["body_ipos"][body])), (xx, xy, xz, yy, yz, zz))
    xx, yy, zz = principal
    pose = pose_from(model["body_ipos"][body], model["body_iquat"][body])
    return Inertia(mass, pose, (xx, 0.0, 0.0, yy, 0.0, zz))
