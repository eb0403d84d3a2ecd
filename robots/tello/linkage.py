"""The rods of Tello's hip and ankle: lengths, and the angles of the cranks in closed form.

Angles are Tello's own: 0 where the leg is straight, the sole level, and a crank of the hip level. All turn about y, to
the left, but the roll of the hip, which turns about x, forward.
"""

from __future__ import annotations

import math

from robots.builder import Vector3

#: Cranks of the hip, m; the arms of the thigh are as long. They are this far beside the middle of the leg, and the axes
#: of the motors this far above those of the hip.
CRANK, HALF_WIDTH, ABOVE = 0.08, 0.07, 0.1425
HIP_ROD = 0.155

SHIN, ANKLE_ROD = 0.26, 0.2146
_CRANK, _LEVER, _OFFSET = 0.04, 0.035, 0.042

#: Directions in the shin, from up (z) towards the front (x), rad: of the crank and of the lever of the foot in the zero
#: of their joints, and from the pivot of the crank to the knee.
_CRANK_AT, _LEVER_AT, _OFFSET_AT = math.radians(180.0 - 59.16), math.radians(180.0 - 66.0), math.radians(20.0)


def _toward(angle: float, length: float) -> Vector3:
    return (length * math.sin(angle), 0.0, length * math.cos(angle))


#: From the ankle to the pivot of the crank, from there to its tip, and from the ankle to the end of the lever, m.
ANKLE_PIVOT: Vector3 = (-_OFFSET * math.sin(_OFFSET_AT), 0.0, SHIN - _OFFSET * math.cos(_OFFSET_AT))
ANKLE_CRANK = _toward(_CRANK_AT, _CRANK)
ANKLE_LEVER = _toward(_LEVER_AT, _LEVER)


def hip_cranks(roll: float, pitch: float) -> tuple[float, float]:
    """Angles (rad) of the cranks on the left and on the right of a left hip, at which the rods reach the thigh."""
    first, second = (_hip_crank(roll, pitch, side) for side in (1.0, -1.0))
    return first, second


def _hip_crank(roll: float, pitch: float, side: float) -> float:
    """The angle y at which the tip (-c cos y, ±w, c sin y) is a rod's length from the end of the thigh's arm."""
    along, up = -CRANK * math.cos(pitch), CRANK * math.sin(pitch)
    y = side * HALF_WIDTH * math.cos(roll) - up * math.sin(roll)
    z = side * HALF_WIDTH * math.sin(roll) + up * math.cos(roll) - ABOVE
    square = CRANK**2 + along**2 + z**2 + (y - side * HALF_WIDTH) ** 2
    return _angle(2.0 * CRANK * along, -2.0 * CRANK * z, HIP_ROD**2 - square, near=0.0)


def ankle_crank(ankle: float) -> float:
    """Angle (rad) of the crank at the shin, at which the rod reaches the foot."""
    x, _, z = turned(ANKLE_LEVER, ankle)
    x, z = x - ANKLE_PIVOT[0], z - ANKLE_PIVOT[2]
    square = _CRANK**2 + x**2 + z**2
    return _angle(-2.0 * _CRANK * z, -2.0 * _CRANK * x, ANKLE_ROD**2 - square, near=_CRANK_AT) - _CRANK_AT


def turned(vector: Vector3, angle: float) -> Vector3:
    """A vector turned about y, to the left."""
    x, y, z = vector
    return (x * math.cos(angle) + z * math.sin(angle), y, z * math.cos(angle) - x * math.sin(angle))


def _angle(cosine: float, sine: float, value: float, near: float) -> float:
    """The solution of cosine·cos y + sine·sin y = value that is nearest to an angle (rad)."""
    middle, half = math.atan2(sine, cosine), math.acos(value / math.hypot(cosine, sine))
    return min((middle - half, middle + half), key=lambda angle: abs(math.remainder(angle - near, math.tau)))
