"""The spanning tree of a mechanism as a Pinocchio model, equal to the one Pinocchio's URDF parser builds.

For a mechanism that is a plain URDF the result equals ``pin.buildModelFromUrdf(path, mimic=True)`` to the last bit
where Pinocchio builds one: the same operations in the same order, through the same functions if Python can reach them.
For a mechanism linked with ``mimic=False`` it equals ``pin.buildModelFromUrdf(path)``. Limits beyond 1e15, which are
none (EU-FIL-006), are infinite; those of acceleration and jerk are left out, as Python cannot set them.
"""

from __future__ import annotations

from collections.abc import Collection, Mapping
from itertools import count

import pinocchio as pin

from eurdf.mechanism.joint import Joint, Mimic
from eurdf.mechanism.mechanism import ROOT_JOINT, Mechanism
from eurdf.mechanism.pose import IDENTITY
from eurdf.pinocchio.frames import placement_of
from eurdf.pinocchio.inertia import inertias_of, is_zero
from eurdf.pinocchio.joint_model import joint_models
from eurdf.pinocchio.limits import set_limits
from eurdf.pinocchio.mimic import following, with_followers

_Indices = tuple[int, int, int, int]  # of a joint: its own, and where its q, its v and its v with mimic joints start

_UNIVERSE = 0
_IDENTITY = pin.SE3.Identity()
_FREE_FLYER = pin.JointModel(pin.JointModelFreeFlyer())
_BODY, _JOINT, _FIXED_JOINT, _OP_FRAME = (
    pin.FrameType.BODY,
    pin.FrameType.JOINT,
    pin.FrameType.FIXED_JOINT,
    pin.FrameType.OP_FRAME,
)


def build_model(mechanism: Mechanism) -> pin.Model:
    """Build the model of the spanning tree, with every link, joint and named frame of the mechanism.

    Pinocchio's own URDF parser fails on a joint that mimics one that comes later or itself mimics, and on one that
    mimics a continuous joint and is none, or the reverse. Here the coordinate of a leader that comes late belongs to a
    joint of its own, named ``<leader>/coordinate``, which moves nothing and which the leader mimics as its mimic joints
    do; a chain is resolved to its end; such a continuous joint is one angle with infinite limits.

    A universal or cylindrical joint is two joints in series, as Pinocchio's derivatives need (`joint_models`): the last
    has its name, the first the name ``<joint>/1``, or the next such name that is free. There is no body between.

    Its velocities are those of EU-JNT-026; the inertias of links that fixed joints hold together are summed
    (EU-INR-005), and armatures are part of the mass matrix (EU-INR-006).

    Args:
        mechanism: A valid mechanism.

    Returns:
        The model. Frames that the description adds are OP_FRAME; the frame of a joint that was split in two is
        FIXED_JOINT, under the joint's name.
    """
    model = pin.Model()
    model.name = mechanism.name
    led = following(mechanism)
    root, *bodies = mechanism.bodies
    root_inertia, *inertias = inertias_of([body.inertia for body in mechanism.bodies])
    joint_id, body_frame = _add_root(model, mechanism, root_inertia)
    root_nq, root_nv = model.nq, model.nv

    names = {joint.name for joint in mechanism.joints}
    free: list[tuple[Joint, int]] = []  # joints with coordinates of their own, in the model's order
    sources: dict[str, _Indices] = {}  # indices of the leaders' coordinates
    for joint in led.late:
        (moving,) = joint_models(joint, unwrapped=joint.name in led.unwrapped)
        free.append((joint, moving.nq))
        # It hangs from a floating root, whose coordinates stay the first.
        coordinate = model.addJoint(joint_id, moving, _IDENTITY, _coordinate_name(joint.name, names))
        sources[joint.name] = _indices(model, coordinate)

    add_joint, add_frame, append_body = model.addJoint, model.addFrame, model.appendBodyToJoint
    add_joint_frame, add_body_frame = model.addJointFrame, model.addBodyFrame
    mimics, unwrapped = led.mimics, led.unwrapped
    # For each body: the joint that moves it, its placement in that joint, and its frame.
    sites = {root.name: (joint_id, _IDENTITY, body_frame)}
    for joint, body, inertia in zip(mechanism.joints, bodies, inertias, strict=True):
        name = joint.name
        parent_joint, parent_placement, parent_frame = sites[joint.parent]
        placement = placement_of(joint.placement)
        if parent_placement is not _IDENTITY:
            placement = parent_placement * placement
        if joint.type.is_fixed:
            if joint.offset is not IDENTITY:
                placement = placement * placement_of(joint.offset)
            joint_id = parent_joint
            joint_frame = add_frame(pin.Frame(name, joint_id, parent_frame, placement, _FIXED_JOINT, inertia))
        else:
            *before, moving = joint_models(joint, unwrapped=name in unwrapped)
            mimic = mimics.get(name) or (Mimic(name) if name in sources else None)
            if mimic is None:
                free.append((joint, moving.nq + len(before)))
                for part in before:
                    parent_joint = add_joint(parent_joint, part, placement, _part_name(name, names))
                    parent_frame, placement = add_joint_frame(parent_joint, parent_frame), _IDENTITY
                joint_id = add_joint(parent_joint, moving, placement, name)
                if mimics:
                    sources[name] = _indices(model, joint_id)
            else:
                joint_id = add_joint(parent_joint, _follower(moving, mimic, sources), placement, name)
            if joint.offset is IDENTITY:
                placement = _IDENTITY
                joint_frame = add_joint_frame(joint_id, parent_frame)
            else:
                placement = placement_of(joint.offset)
                joint_frame = add_frame(pin.Frame(name, joint_id, parent_frame, placement, _JOINT))
            if body.inertia is not None and not is_zero(body.inertia):
                append_body(joint_id, inertia, placement)
        if not body.virtual:
            joint_frame = add_body_frame(body.name, joint_id, placement, joint_frame)
        sites[body.name] = joint_id, placement, joint_frame

    for frame in mechanism.frames:
        joint_id, placement, parent_frame = sites[frame.body]
        kind = _OP_FRAME if frame.kind == "frame" else _FIXED_JOINT
        placement = placement * placement_of(frame.pose)
        add_frame(pin.Frame(frame.name, joint_id, parent_frame, placement, kind), False)
    folded = with_followers(mechanism, led)
    set_limits(
        model,
        [(joint.with_properties(folded[joint.name]) if joint.name in folded else joint, nq) for joint, nq in free],
        root_nq,
        root_nv,
    )
    return model


def _add_root(model: pin.Model, mechanism: Mechanism, inertia: pin.Inertia) -> tuple[int, int]:
    """EU-VER-004: add the root body, fixed or floating; returns the joint that moves it, and its frame."""
    root = mechanism.bodies[0]
    if mechanism.root == "fixed":
        return _UNIVERSE, model.addFrame(pin.Frame(root.name, _UNIVERSE, 0, _IDENTITY, _BODY, inertia))
    joint_id = model.addJoint(_UNIVERSE, _FREE_FLYER, _IDENTITY, ROOT_JOINT)
    joint_frame = model.addJointFrame(joint_id, 0)
    if root.inertia is not None and not is_zero(root.inertia):
        model.appendBodyToJoint(joint_id, inertia, _IDENTITY)
    return joint_id, model.addBodyFrame(root.name, joint_id, _IDENTITY, joint_frame)


def _indices(model: pin.Model, joint_id: int) -> _Indices:
    joint = model.joints[joint_id]
    return joint_id, joint.idx_q, joint.idx_v, joint.idx_vExtended


def _follower(moving: pin.JointModel, mimic: Mimic, sources: Mapping[str, _Indices]) -> pin.JointModelMimic:
    # The constructor finds the leader by the indices of the joint that it is given.
    moving = pin.JointModel(moving)
    moving.setIndexes(*sources[mimic.joint])
    return pin.JointModelMimic(moving, mimic.multiplier, mimic.offset)


def _coordinate_name(leader: str, taken: Collection[str]) -> str:
    name = f"{leader}/coordinate"
    while name in taken:
        name += "'"
    return name


def _part_name(joint: str, taken: Collection[str]) -> str:
    """Name of the first of two joints in series, of which the second has the joint's own."""
    return next(name for name in (f"{joint}/{number}" for number in count(1)) if name not in taken)
