"""Resolution of frame names."""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Sequence
from dataclasses import replace
from functools import partial
from itertools import chain

from eurdf.diagnostics import Fix
from eurdf.format.closure_model import Frame as FrameEntry
from eurdf.format.closure_model import FrameReference, NamedFrame
from eurdf.format.fixes import renumbered, report_name, restated
from eurdf.linking.joints import Joints
from eurdf.mechanism.body import Anchor, Frame
from eurdf.mechanism.pose import Pose
from eurdf.reading.yaml_node import Pointer
from eurdf.reading.yaml_reader import YamlDocument


class FrameNames:
    """Looks frames up: links, joints (EU-FRM-005: on the child's side), and the frames that the description adds."""

    def __init__(self, joints: Joints) -> None:
        self._made = joints
        self._urdf, self._joints = joints.urdf, joints.by_name
        # None for an invalid frame: its uses are not reported again.
        self._frames: dict[str, Anchor | None] = {}

    def add(self, entries: Iterable[FrameEntry]) -> tuple[Frame, ...]:
        """EU-FRM-003: add the frames of the description; each name is given once."""
        frames = []
        for entry in entries:
            if entry.name in self._frames or self._known(entry.name):
                what = "frame" if entry.name in self._frames else "link" if entry.name in self._urdf.links else "joint"
                self._made.reporter.report(
                    "duplicate-frame",
                    f"there is already a {what} '{entry.name}'",
                    (*entry.pointer, "name"),
                    "give the frame another name",
                    partial(frame_renumbered, self._made.reporter.document, entry, self.known()),
                )
                continue
            anchor = self.find(entry)
            if anchor is None:
                self._frames[entry.name] = None
            else:
                self._frames[entry.name] = Anchor(anchor.body, anchor.pose, entry.name)
                frames.append(Frame(entry.name, anchor.body, anchor.pose))
        return tuple(frames)

    def find(self, reference: FrameReference) -> Anchor | None:
        """The body and pose that a reference means; None, and a diagnostic, where it means none or two."""
        if isinstance(reference, NamedFrame):
            return self._by_name(reference.target, reference)
        body = self._body(reference)
        if body is None:
            return None
        return Anchor(body, Pose.from_xyz_rpy(reference.xyz, reference.rpy))

    def known(self) -> Iterator[str]:
        """The names of all links, joints and frames."""
        return chain(self._frames, self._urdf.links, self._urdf.joints, self._joints)

    def _known(self, name: str) -> bool:
        return name in self._urdf.links or name in self._urdf.joints or name in self._joints

    def _joint_child(self, name: str) -> str | None:
        joint = self._joints.get(name) or self._urdf.joints.get(name)
        return joint and joint.child

    def _by_name(self, name: str, reference: FrameReference) -> Anchor | None:
        """EU-FRM-001, EU-FRM-002: a name is that of exactly one frame.

        A link and the joint that carries it may share their name, for they share the frame.
        """
        if name in self._frames:
            return self._frames[name]
        child = self._joint_child(name)
        if name in self._urdf.links:
            if child is not None and child != name:
                self._made.reporter.report(
                    "ambiguous-frame",
                    f"'{name}' is both a link and a joint, and the child of the joint is another link, '{child}'",
                    reference.pointer,
                    f"write {{link: {name}}} or {{joint: {name}}}",
                    partial(self._either, name, reference.pointer),
                )
                return None
            return Anchor(name, frame=name)
        if child is not None:
            return Anchor(child, frame=name)
        if name not in self._made.faulty:
            known = self.known()
            self._report_unknown(name, "link, joint or frame", reference.pointer, known)
        return None

    def _either(self, name: str, pointer: Pointer) -> list[Fix]:
        """Proposals for an ambiguous name: each of its two meanings."""
        document = self._made.reporter.document
        return [replace(restated(document, pointer, {kind: name}), rivals=True) for kind in ("link", "joint")]

    def _body(self, reference: FrameReference) -> str | None:
        name, pointer = reference.target, (*reference.pointer, reference.kind)
        if reference.kind == "link":
            if name in self._urdf.links:
                return name
            self._report_unknown(name, "link", pointer, self._urdf.links)
            return None
        child = self._joint_child(name)
        if child is None and name not in self._made.faulty:
            self._report_unknown(name, "joint", pointer, chain(self._urdf.joints, self._joints))
        return child

    def _report_unknown(self, name: str, what: str, pointer: Pointer, known: Iterable[str]) -> None:
        message = f"'{name}' is not a {what} of the robot"
        report_name(self._made.reporter, "unknown-frame", message, pointer, name, known)


def frame_renumbered(document: YamlDocument, entry: FrameEntry, taken: Iterable[str]) -> Sequence[Fix]:
    """Another name for an added frame; none if a closure names it, for that can mean what has the name already."""
    if any(entry.name in closure["frames"] for closure in document.data.get("closures", ())):
        return ()
    return renumbered(document, (*entry.pointer, "name"), entry.name, {*taken, entry.name})
