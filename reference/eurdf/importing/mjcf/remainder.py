"""What a model has beside the robot, all of which is left out."""

from __future__ import annotations

from eurdf.importing.mjcf.reading import WORLD, MjcfReading
from eurdf.importing.mjcf.values import flat

_COUNTED = {
    "nsensor": "sensors",
    "ncam": "cameras",
    "nlight": "lights",
    "npair": "contact pairs",
    "nexclude": "contact exclusions",
    "nflex": "flexible bodies",
    "nskin": "skins",
    "nhfield": "height fields",
    "nplugin": "plugins",
}


def leave_out_scenery(reading: MjcfReading) -> None:
    """Bodies that are not part of the robot."""
    left = [body for body in range(len(reading.model["body_parentid"])) if body not in reading.bodies]
    for body in left:
        geoms = [geom for geom, owner in enumerate(reading.model["geom_bodyid"]) if owner == body]
        if body or geoms:
            reading.losses.add(
                "import-scenery", reading.model.names["body"][body] or (f"body {body}" if body else WORLD)
            )


def leave_out_rest(reading: MjcfReading) -> None:
    """What the model has beside the robot."""
    model = reading.model
    for each in model.left_out:
        reading.losses.add(
            "import-mesh" if each.kind == "mesh" else "import-shape", each.name, f"is left out: {each.reason}"
        )
    equal = {
        (model["eq_obj1id"][i], model["eq_obj2id"][i]) for i, kind in enumerate(model["eq_type"]) if kind == "tendon"
    }
    used = {tendon for pair in equal for tendon in pair}
    kinds = zip(model["actuator_trntype"], model["actuator_trnid"], strict=True)
    used |= {ids[0] for kind, ids in kinds if kind == "tendon"}
    for tendon, name in enumerate(model.names["tendon"]):
        passive = any(
            any(flat(model[f"tendon_{what}"][tendon])) for what in ("limited", "stiffness", "damping", "frictionloss")
        )
        if passive or tendon not in used:
            reading.losses.add("import-tendon", name or f"tendon {tendon}")
    shown = [f"{count} {_COUNTED[name]}" for name, count in model.counts.items() if count]
    if shown:
        reading.losses.add("import-simulation", reading.name, f"left out: {', '.join(shown)}")
