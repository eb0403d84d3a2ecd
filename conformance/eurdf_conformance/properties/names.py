"""New names for all named parts."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass
from typing import TypeVar

from eurdf_conformance.level import Version
from eurdf_conformance.properties.chance import Chance
from eurdf_conformance.properties.mechanism import Change, Mechanism, Spot

Value = TypeVar("Value")

#: Names that are good, EU-URD-011, though not what a program may expect: some are words of YAML 1.1 and not of 1.2.
CURIOUS = (
    *("no", "on", "Yes", "12:30", "1_000", "012", "1e3", "null", "~", "<<", "true", "0x1F", ".inf", "2.0", "100 %"),
    *("left/knee", "two words", "a: b", "# no comment", "it's", 'so "called"', "&anchor", "*alias", "!tag", "{x}"),
    *("[y]", "- z", "? k", "%d", "@at", "back\\slash", "a,b", "<tag/>", "name:"),
    *("тело", "关节", "Ωμέγα", "naïve", "e\u0301"),
    *("urdf", "link", "joint", "robot", "world", "base_link", "type", "closures", "xyz"),
)


@dataclass(frozen=True)
class Names:
    """A new name for each old name of links, joints, frames, closures and configurations."""

    links: Mapping[str, str]
    joints: Mapping[str, str]
    frames: Mapping[str, str]
    closures: Mapping[str, str]
    configurations: Mapping[str, str]

    def frame(self, name: str) -> str:
        """The new name of a frame, whether of a link, a joint or the description."""
        return next(names[name] for names in (self.links, self.joints, self.frames) if name in names)

    def link(self, name: str) -> str:
        """The new name of a link; any other name is unchanged."""
        return self.links.get(name, name)

    def closure(self, name: str) -> str:
        """The new name of a closure; any other name is unchanged."""
        return self.closures.get(name, name)

    def joint(self, name: str) -> str:
        """The new name of a joint; the root joint keeps its name."""
        return self.joints.get(name, name)


def new_names(mechanism: Mechanism, chance: Chance, version: Version) -> Names:
    """Unusual names, all different, for all parts that a version can name."""
    pool = [*chance.shuffled(CURIOUS), *(f"{name} {i}" for i in range(1, 9) for name in CURIOUS)]
    unused = iter(pool)

    def fresh(old: list[str]) -> dict[str, str]:
        return {name: next(unused) for name in dict.fromkeys(old)}

    joints = [joint.name for joint in mechanism.joints] + [
        name for name, change in mechanism.changes.items() if change.merges
    ]
    return Names(
        links=fresh([link.name for link in mechanism.links]),
        joints=fresh(joints),
        frames=fresh([frame.name for frame in mechanism.frames]),
        closures=fresh([closure.name for closure in mechanism.closures])
        if version == "2"
        else {closure.name: closure.name for closure in mechanism.closures},
        configurations=fresh([name for name in mechanism.configurations if name != "assembled"])
        | {"assembled": "assembled"},
    )


def renamed(mechanism: Mechanism, names: Names) -> Mechanism:
    """The same mechanism with other names."""
    joint, link = names.joint, names.links

    def spot(spot: Spot) -> Spot:
        return spot.model_copy(update={"of": link[spot.of] if spot.on == "link" else joint(spot.of)})

    def reference(reference: str | Spot) -> str | Spot:
        return names.frame(reference) if isinstance(reference, str) else spot(reference)

    return mechanism.replace(
        links=tuple(each.model_copy(update={"name": link[each.name]}) for each in mechanism.links),
        joints=tuple(
            each.model_copy(
                update={
                    "name": joint(each.name),
                    "parent": link[each.parent],
                    "child": link[each.child],
                    "mimic": each.mimic and each.mimic.model_copy(update={"joint": joint(each.mimic.joint)}),
                }
            )
            for each in mechanism.joints
        ),
        changes={joint(name): _change(change, joint) for name, change in mechanism.changes.items()},
        frames=tuple(
            each.model_copy(update={"name": names.frames[each.name], "spot": spot(each.spot)})
            for each in mechanism.frames
        ),
        closures=tuple(
            each.model_copy(update={"name": names.closures[each.name], "a": reference(each.a), "b": reference(each.b)})
            for each in mechanism.closures
        ),
        actuators=tuple(each.model_copy(update={"joint": joint(each.joint)}) for each in mechanism.actuators),
        configurations={
            names.configurations[name]: keyed(configuration, joint)
            for name, configuration in mechanism.configurations.items()
        },
    )


def keyed(mapping: Mapping[str, Value], name: Callable[[str], str]) -> dict[str, Value]:
    """The same values with other keys."""
    return {name(key): value for key, value in mapping.items()}


def _change(change: Change, joint: Callable[[str], str]) -> Change:
    return change.model_copy(update={"merges": tuple(map(joint, change.merges))})
