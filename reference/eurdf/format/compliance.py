"""The compliance of a closure, which version 2.1 adds."""

from __future__ import annotations

from typing import ClassVar

from pydantic import ConfigDict, Field

from eurdf.format.field import MayLack, NonNegative, StrictMapping
from eurdf.format.version2 import SaysSomething


class Compliance(SaysSomething):
    """How much a closure gives way under load: a hint for simulators with soft constraints."""

    one_of: ClassVar[tuple[str, ...]] = ("linear", "angular")
    model_config = ConfigDict(title="Compliance")

    linear: MayLack[NonNegative] = Field(
        default=None, title="Linear compliance", description="m/N, not negative; 0 is rigid.", examples=[1e-6]
    )
    angular: MayLack[NonNegative] = Field(
        default=None,
        title="Angular compliance",
        description="rad/(N·m), not negative; 0 is rigid. Only for closures that hold an orientation: 6d, hinge.",
        examples=[1e-4],
    )


class Compliant(StrictMapping):
    """A closure that can have a compliance."""

    compliance: MayLack[Compliance] = Field(
        default=None,
        title="Compliance",
        description="How much the closure gives way under load; it does not change the residual. Rigid if left out.",
        examples=[{"linear": 1e-6, "angular": 1e-4}],
    )
