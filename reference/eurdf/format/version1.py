"""Version 1, the published dialect: five keys and no version key; other keys are user-defined (EU-ONE-001)."""

from __future__ import annotations

from typing import Annotated, Any, Literal

from pydantic import BaseModel, BeforeValidator, ConfigDict, Field, model_validator
from pydantic_core import PydanticCustomError
from typing_extensions import Self

from eurdf.format.field import STRICT, FrameName, MovingJointName, UrdfJointName

ClosureType = Literal["3d", "3D", "6d", "6D"]

JointType = Literal["SPHERICAL", "FIXED", "UJOINT_XY", "UJOINT_XZ", "UJOINT_YX", "UJOINT_YZ", "UJOINT_ZX", "UJOINT_ZY"]

_TOGETHER = ("joint_name", "joint_type")


def _refuse_names(value: Any) -> Any:
    """EU-ONE-001: refuse a list of names, so that a pair without brackets gives one error, not two."""
    if isinstance(value, list) and value and all(isinstance(item, str) for item in value):
        raise PydanticCustomError("wrong-type", "must be a list of pairs: [[A, B], …]")
    return value


class Version1(BaseModel):
    """A robot's loop closures, actuators and joints beside its URDF, in the published dialect.

    The file has no version key. Keys other than these five are user-defined.
    """

    model_config = ConfigDict(
        **STRICT,
        extra="allow",
        title="Extended URDF, version 1",
        json_schema_extra={"dependentRequired": {"joint_name": ["joint_type"], "joint_type": ["joint_name"]}},
    )

    closed_loop: Annotated[
        list[Annotated[list[FrameName], Field(min_length=2, max_length=2)]], BeforeValidator(_refuse_names)
    ] = Field(
        default=[],
        title="Loop closures",
        description="Pairs of frames, A and B, that a closure joins: names of links or joints of the URDF.",
        examples=[[["rod_tip", "knee_crank"]]],
    )
    type: list[ClosureType] = Field(
        default_factory=list,
        title="Closure types",
        description="One for each pair of 'closed_loop', in its order. 3d: the origins of frames A and B coincide. 6d:"
        " their orientations also agree. If the key is left out, all closures are 6d.",
        examples=[["6d", "3d"]],
    )
    name_mot: list[MovingJointName] = Field(
        default=[],
        title="Actuated joints",
        description="Names of the joints that have a motor.",
        examples=[["motor_hip_x", "motor_knee"]],
    )
    joint_name: list[UrdfJointName] = Field(
        default=[],
        title="Replaced joints",
        description="Joints of the URDF that get a type which URDF does not have; needs 'joint_type'.",
        examples=[["hip_ball", "knee_cardan"]],
    )
    joint_type: list[JointType] = Field(
        default=[],
        title="Their types",
        description="One for each joint of 'joint_name', in its order, in capitals. SPHERICAL: a ball joint."
        " UJOINT_AB: two revolutes about the axes A, then B, of the joint's frame. FIXED: locked at zero.",
        examples=[["SPHERICAL", "UJOINT_XY"]],
    )

    @model_validator(mode="after")
    def _names_and_types_stand_together(self) -> Self:
        written = self.model_fields_set.intersection(_TOGETHER)
        if len(written) == 1:
            present = written.pop()
            lacking = _TOGETHER[present == _TOGETHER[0]]
            raise PydanticCustomError(
                "missing-key",
                "has '{present}' but lacks '{key}', which it needs",
                {"key": lacking, "present": present},
            )
        return self
