"""The gain of position actuators: a description has none."""

from __future__ import annotations

#: Error at which a position actuator reaches the effort limit, rad or m; and its gain without such a limit.
FULL_EFFORT_AT, GAIN = 0.1, 100.0


def position_gain(effort: float) -> float:
    """Of a joint with an effort limit, N·m/rad or N/m; 0 and infinity are no limit."""
    return effort / FULL_EFFORT_AT if 0.0 < effort < float("inf") else GAIN
