"""A robot with one link on the base for each kind of joint."""

from __future__ import annotations

from support.described import body
from support.plain_urdf import joint_element, link_element, robot

CONTENT = '<axis xyz="0 0 1"/><limit lower="-2" upper="2" effort="1" velocity="1"/>'
KINDS = {"a": "revolute", "b": "continuous", "c": "prismatic", "d": "revolute", "e": "planar", "f": "floating"}
KINDS["g"] = "fixed"

STAR = robot(
    link_element("base"),
    *(body(f"l{name}") for name in KINDS),
    *(joint_element(name, kind, "base", f"l{name}", CONTENT) for name, kind in KINDS.items()),
)
