"""Plain URDF: the spanning tree, with the joint types and properties that URDF has."""

from __future__ import annotations

import math
from collections.abc import Iterator, Sequence
from dataclasses import replace
from functools import cached_property

from lxml import etree

from eurdf.convert.coordinates import Coordinates
from eurdf.convert.export_format import ExportInput, ExportOutput, Format
from eurdf.convert.losses import Losses
from eurdf.convert.parts import part_of
from eurdf.convert.steps import ExportedJoint, turn_type
from eurdf.convert.urdf.facts import EXACT, ROWS
from eurdf.convert.urdf.tree import UrdfTree
from eurdf.mechanism.joint import Joint
from eurdf.mechanism.joint_types import JointType
from eurdf.mechanism.mechanism import ROOT_JOINT, root_joint
from eurdf.writing.urdf_elements import add_dynamics, add_limit, state_version
from eurdf.writing.xml_text import file_content


def write(given: ExportInput, losses: Losses) -> ExportOutput:
    """Write the plain URDF of a robot: ``robot.urdf``, and its meshes in ``meshes/``."""
    tree = PlainTree(given, losses)
    tree.write()
    return tree.output()


class PlainTree(UrdfTree):
    """A tree that has only the joint types of URDF, with frames as links."""

    whole = (JointType.PLANAR, JointType.FLOATING)

    def write(self) -> None:
        """Write links, joints and frames."""
        super().write()
        state_version(self.root)
        for frame in self.mechanism.frames:
            name = self.names.new(frame.name)
            etree.SubElement(self.root, "link", name=name)
            self.fixed(self.names.new(f"{name}_fixed"), frame.body, name, frame.pose)
        if self.mechanism.root == "floating":
            # The coordinates are those of the URDF once it is loaded as the hint says.
            self.parts.insert(0, part_of(root_joint(""), (ROOT_JOINT,), ()))

    def output(self) -> ExportOutput:
        """The files."""
        return ExportOutput({"robot.urdf": file_content(self.root), **self.meshes.files}, self.coordinates)

    @cached_property
    def _leaders(self) -> frozenset[str]:
        """Names of the joints that others mimic."""
        return frozenset(joint.mimic.joint for joint in self.mechanism.joints if joint.mimic is not None)

    def type(self, joint: Joint, step: ExportedJoint) -> JointType:
        """Of a turn without limits, ``continuous``.

        Not where joints mimic: Pinocchio lets no revolute or prismatic joint mimic a continuous one.
        """
        kind = step.joint.type
        is_alone = joint.type is JointType.REVOLUTE and joint.mimic is None and joint.name not in self._leaders
        return turn_type(joint) if is_alone else kind

    def add_properties(self, joint: Joint, step: ExportedJoint, element: etree._Element) -> None:
        """Add limits and losses; of planar and floating joints, those of the first axis."""
        properties = step.joint.properties

        def first(values: tuple[float, ...], otherwise: float) -> float:
            return values[0] if values else otherwise

        position = None
        if self.type(joint, step).is_ranged:
            position = step.joint.ranges[0]
        velocity, effort = first(properties.velocity, math.inf), first(properties.effort, math.inf)
        rates = {name: values[0] for name, values in properties.rates.items() if math.isfinite(values[0])}
        if position or math.isfinite(velocity) or math.isfinite(effort) or rates:
            add_limit(element, position, effort, velocity, rates)
        add_dynamics(element, first(properties.damping, 0.0), first(properties.friction, 0.0))

    def add_part(self, joint: Joint, names: Sequence[str], steps: Sequence[ExportedJoint]) -> None:
        """Add the joint: Pinocchio's q has cosine and sine of the angle of a continuous or planar joint."""
        if joint.mimic is not None:
            return
        own = [(name, step) for name, step in zip(names, steps, strict=True) if not step.lead]
        circular = [number for number, (_, step) in enumerate(own) if self.type(joint, step) == JointType.CONTINUOUS]
        if joint.type is JointType.PLANAR:
            circular = [2]
        ratios = ((step.velocities[0], 1.0, 0.0) for _, step in own)
        rotation = "xyz" if joint.type is JointType.SPHERICAL else "quaternion"
        part = part_of(joint, [name for name, _ in own], ratios, rotation=rotation)
        self.parts.append(replace(part, circular=tuple(circular)))

    @property
    def coordinates(self) -> Coordinates:
        """From the vectors of the robot to those of Pinocchio's model of the file, with its mimic joints."""
        rank = {name: number for number, name in enumerate(self._depth_first())}
        parts = sorted(self.parts, key=lambda part: -1 if part.joint == ROOT_JOINT else rank[part.names[0]])
        return Coordinates(tuple(parts), self._given.own, "xyzw", at_rest=False)

    def _depth_first(self) -> Iterator[str]:
        """Names of the joints in the order of Pinocchio: depth first, those of one link by their names."""
        leaving: dict[str, list[tuple[str, str]]] = {}
        for joint in self.root.findall("joint"):
            name, parent, child = (str(joint.xpath(f"string({at})")) for at in ("@name", "parent/@link", "child/@link"))
            leaving.setdefault(parent, []).append((name, child))
        found = sorted(leaving.get(self.links[self.mechanism.bodies[0].name], ()), reverse=True)
        while found:
            name, child = found.pop()
            yield name
            found += sorted(leaving.get(child, ()), reverse=True)


FORMAT = Format("urdf", "the plain URDF of the spanning tree", write, ROWS, EXACT)
