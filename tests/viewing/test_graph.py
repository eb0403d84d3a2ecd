"""The graph of links and loops."""

from __future__ import annotations

from dataclasses import replace
from xml.etree import ElementTree

import eurdf
from eurdf.viewing.graph import graph_svg


def test_graph_has_a_line_for_each_link_and_an_arc_for_each_closure() -> None:
    mechanism = eurdf.load("digit_leg", geometry=False).mechanism
    svg = ElementTree.fromstring(graph_svg(mechanism))
    space = {"svg": "http://www.w3.org/2000/svg"}
    lines = svg.findall(".//svg:text", space)
    assert [line.text for line in lines] == [body.name for body in mechanism.bodies]
    joints = [line.find("svg:title", space).text for line in lines[1:]]
    assert joints == [f"{joint.type} joint {joint.name}" for joint in mechanism.joints]
    arcs = [title.text for title in svg.findall(".//svg:path/svg:title", space)]
    assert arcs == [f"{closure.name} ({closure.type})" for closure in mechanism.closures]
    assert sum(line.get("font-weight") is not None for line in lines) == len(mechanism.actuators)
    attack = "<img src=x onerror=alert(1)>"
    hostile = graph_svg(replace(mechanism, bodies=(replace(mechanism.bodies[0], name=attack),), joints=(), closures=()))
    assert "<img" not in hostile
    assert attack in [element.text for element in ElementTree.fromstring(hostile).iter()]
