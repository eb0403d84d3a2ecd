"""Small random robots as the texts of their two files, of every type of joint, for comparing the oracle."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, field
from typing import Any

import numpy as np
from hypothesis import strategies as st

from eurdf_conformance.oracle.spatial import from_rpy

PLAIN = ("revolute", "continuous", "prismatic", "planar", "floating", "fixed")
REPLACED = {
    "spherical": ("revolute", "continuous"),
    "universal": ("revolute", "continuous"),
    "cylindrical": ("revolute", "continuous", "prismatic"),
    "helical": ("revolute", "continuous", "prismatic"),
    "locked": ("revolute", "continuous", "prismatic", "planar", "floating"),
}
FOLLOWING = ("revolute", "continuous", "prismatic")
LETTERS = ("xy", "xz", "yx", "yz", "zx", "zy")


def placed(xyz: Any, rpy: Any) -> str:
    """The origin element of a pose."""
    first, second = (" ".join(map(repr, vector.tolist())) for vector in (xyz, rpy))
    return f'<origin xyz="{first}" rpy="{second}"/>'


@dataclass
class Files:
    """A robot under construction: elements of its URDF, entries of its description, and numbers to draw from."""

    random: np.random.Generator
    urdf: list[str] = field(default_factory=list)
    joints: dict[str, Any] = field(default_factory=dict)
    #: Links that are named as frames on their bodies, so that a closure of two of them joins two bodies.
    bodies: list[str] = field(default_factory=list)
    links: int = 0

    def numbers(self, count: int, scale: float = 1.0) -> list[float]:
        return self.random.uniform(-scale, scale, count).tolist()

    def pose(self) -> str:
        return placed(self.random.uniform(-1.0, 1.0, 3), self.random.uniform(-3.0, 3.0, 3))

    def link(self, light: bool = False) -> str:
        """Write the next link."""
        name, self.links = f"link{self.links}", self.links + 1
        mass = self.random.uniform(1e-6, 9e-6) if light else self.random.uniform(0.1, 3.0)
        points = self.random.normal(size=(4, 3)) * np.sqrt(mass)
        moments = np.trace(points.T @ points) * np.eye(3) - points.T @ points
        numbers = zip(("ixx", "ixy", "ixz", "iyy", "iyz", "izz"), moments[np.triu_indices(3)], strict=True)
        matter = " ".join(f'{name}="{float(value)!r}"' for name, value in numbers)
        inertial = f'<inertial>{self.pose()}<mass value="{mass!r}"/><inertia {matter}/></inertial>'
        # Many exporters leave the links of a frame, or between two axes, without any.
        self.urdf.append(f'<link name="{name}">{"" if self.random.random() < 0.2 else inertial}</link>')
        return name

    def joint(
        self, name: str, kind: str, parent: str, child: str, axis: Sequence[float], origin: str, mimic: str = ""
    ) -> None:
        low, high, speed, force, damping, friction = (abs(number) for number in self.numbers(6))
        limit = f'<limit lower="{-low!r}" upper="{high!r}" velocity="{speed!r}" effort="{force!r}"/>'
        dynamics = f'<dynamics damping="{damping!r}" friction="{friction!r}"/>'
        self.urdf.append(
            f'<joint name="{name}" type="{kind}">{origin}<parent link="{parent}"/><child link="{child}"/>'
            f'<axis xyz="{" ".join(map(repr, map(float, axis)))}"/>{mimic}'
            f"{limit + dynamics}</joint>"
        )

    def ball(self, name: str, parent: str) -> str:
        """Three revolutes whose axes pass one point, nearly, on links of hardly any mass."""
        R, p = np.eye(3), np.zeros(3)
        for letter in "xyz":
            rpy, axis = self.random.uniform(-3.0, 3.0, 3), self.random.normal(size=3)
            turned = R @ from_rpy(rpy)
            origin = self.random.uniform(-1.0, 1.0) * turned @ axis + self.random.uniform(-1e-5, 1e-5, 3)
            xyz = R.T @ (origin - p)
            child = self.link(light=letter != "z")
            self.joint(f"{name}_r{letter}", "revolute", parent, child, axis.tolist(), placed(xyz, rpy))
            parent, R, p = child, turned, origin
        return parent

    def change(self, kind: str) -> dict[str, Any]:
        """What the description says of a joint that becomes of a kind."""
        if kind == "universal":
            vectors = [self.numbers(3), self.numbers(3)]
            return {"type": kind, "axes": str(self.random.choice(LETTERS)) if self.random.random() < 0.5 else vectors}
        return {"type": kind, "pitch": self.numbers(1)[0]} if kind == "helical" else {"type": kind}


@st.composite
def mechanisms(draw: st.DrawFn, version: str = "2") -> tuple[str, dict[str, Any], int]:
    """The URDF, the description as a value, and a seed for configurations."""
    seed = draw(st.integers(0, 2**32 - 1))
    files = Files(np.random.default_rng(seed))
    tips = [files.link()]
    files.bodies.append(tips[0])
    kinds = [*PLAIN, "ball", "mimic", "spherical", "universal", "locked"]
    kinds += ["cylindrical", "helical", "overridden"] if version == "2" else []
    leaders: list[str] = []
    movers: dict[str, str] = {}  # by the link that they carry
    for i, kind in enumerate(draw(st.lists(st.sampled_from(kinds), min_size=1, max_size=8))):
        name, parent = f"joint{i}", draw(st.sampled_from(tips))
        if kind == "ball":
            tips.append(files.ball(name, parent))
            files.bodies.append(tips[-1])
            if version == "1":
                # With two joints of the ball it may make the three that are merged, and has then no motor.
                movers.pop(parent, None)
            if version == "2" and draw(st.booleans()):
                files.joints[name] = {"type": "spherical", "merges": [f"{name}_r{letter}" for letter in "xyz"]}
            continue
        written = draw(st.sampled_from(REPLACED.get(kind, FOLLOWING if kind in ("mimic", "overridden") else (kind,))))
        mimic = ""
        if kind == "mimic" and leaders:
            multiplier, offset = files.numbers(2, 2.0)
            leader = draw(st.sampled_from(leaders))
            mimic = f'<mimic joint="{leader}" multiplier="{multiplier!r}" offset="{offset!r}"/>'
        tips.append(files.link())
        files.joint(name, written, parent, tips[-1], files.numbers(3), files.pose(), mimic)
        if kind in REPLACED:
            files.joints[name] = files.change("fixed" if kind == "locked" else kind)
        elif kind == "overridden":
            files.joints[name] = {"armature": abs(files.numbers(1)[0])}
        elif written in FOLLOWING:
            leaders.append(name)  # mimics too, so that there are chains
        if kind not in ("fixed", "locked"):
            files.bodies.append(tips[-1])
            movers |= {} if mimic else {tips[-1]: name}
    description = (described if version == "2" else published)(draw, files, tips, list(movers.values()))
    return f'<robot name="random">{"".join(files.urdf)}</robot>', description, seed


def pairs_of(draw: st.DrawFn, files: Files) -> list[tuple[str, str]]:
    """Different pairs of links on different bodies."""
    pairs = [(a, b) for a in files.bodies for b in files.bodies if a < b]
    return draw(st.lists(st.sampled_from(pairs), unique=True, max_size=3)) if pairs else []


def described(draw: st.DrawFn, files: Files, tips: list[str], movers: list[str]) -> dict[str, Any]:
    """A description of version 2."""
    frames = [
        {"name": f"frame{i}", "link": link, "xyz": files.numbers(3), "rpy": files.numbers(3, 3.0)}
        for i, link in enumerate(draw(st.lists(st.sampled_from(tips), max_size=2)))
    ]
    closures = [
        {
            "name": f"closure{i}",
            "type": draw(st.sampled_from(["3d", "6d"])),
            "frames": [{"link": a, "xyz": files.numbers(3), "rpy": files.numbers(3, 3.0)}, b],
        }
        for i, (a, b) in enumerate(pairs_of(draw, files))
    ]
    actuators = [
        {"joint": joint, "gear_ratio": 3.0 * files.numbers(1)[0], "rotor_inertia": abs(files.numbers(1)[0])}
        for joint in draw(st.lists(st.sampled_from(movers), unique=True, max_size=2) if movers else st.just([]))
    ]
    root = draw(st.sampled_from(["fixed", "floating"]))
    return {
        "extended_urdf": "2.0",
        "root": root,
        "joints": files.joints,
        "frames": frames,
        "closures": closures,
        "actuators": actuators,
    }


def published(draw: st.DrawFn, files: Files, tips: list[str], movers: list[str]) -> dict[str, Any]:
    """A description of version 1."""
    words = {"spherical": "SPHERICAL", "fixed": "FIXED"}
    pairs = pairs_of(draw, files)
    letters = [f"UJOINT_{draw(st.sampled_from(LETTERS)).upper()}" for _ in files.joints]
    kinds = [words.get(change["type"], word) for change, word in zip(files.joints.values(), letters, strict=True)]
    motors = [name for name in movers if files.joints.get(name, {}).get("type") != "universal"]
    return {
        "closed_loop": [list(pair) for pair in pairs],
        "type": [draw(st.sampled_from(["3d", "6D"])) for _ in pairs],
        "name_mot": motors[:2],
        "joint_name": list(files.joints),
        "joint_type": kinds,
    }
