"""The fastest motion from rest to rest under limits of velocity, acceleration and jerk, in closed form.

Seven phases: jerk +J, 0, -J, constant velocity, -J, 0, +J, of durations T_j, T_a, T_j, T_v, T_j, T_a, T_j:

    T_j = min(A / J, sqrt(V / J), (D / 2J)^(1/3))
    T_a = min(V / A - T_j, -3/2 T_j + sqrt(T_j^2 / 4 + D / A))  where T_j = A / J, else 0
    T_v = D / v - (T_a + 2 T_j),   v = J T_j (T_a + T_j)

| symbol | meaning | unit |
|---|---|---|
| D | distance | m |
| V, A, J | limits of velocity, acceleration, jerk | m/s, m/s^2, m/s^3 |
| v | velocity reached | m/s |

Source: Lambrechts, Boerlage, Steinbuch, Trajectory planning and feedforward design for electromechanical motion
systems, Control Engineering Practice 13 (2005), section 3, for the third order.
"""

from __future__ import annotations

import math
from dataclasses import dataclass

from feeddrive.errors import InputError
from feeddrive.simulate.setpoints.setpoint_motion import Piece, chained

_ROUNDING = 1e-12
"""A share of the ramps that only rounding makes of constant velocity."""


@dataclass(frozen=True)
class Limits:
    """Limits of a motion, SI.

    Attributes:
        velocity, acceleration, jerk: [m/s, m/s^2, m/s^3].
        where: for messages.

    Raises:
        InputError: a limit that is not above zero.
    """

    velocity: float
    acceleration: float
    jerk: float
    where: str = "trajectory"

    def __post_init__(self) -> None:
        for key in ("velocity", "acceleration", "jerk"):
            if not (getattr(self, key) > 0 and math.isfinite(getattr(self, key))):
                raise InputError(
                    f"the limit {getattr(self, key):g} is not above zero",
                    f"{self.where}.{key}",
                    "no move is possible; write a positive limit",
                )


def phases(distance: float, limits: Limits) -> tuple[float, float, float]:
    """T_j, T_a and T_v of the fastest move over a distance >= 0 [m]; all are 0 where there is none [s]."""
    big_v, big_a, big_j = limits.velocity, limits.acceleration, limits.jerk
    if distance == 0:
        return 0.0, 0.0, 0.0
    jerking = min(big_a / big_j, math.sqrt(big_v / big_j), math.cbrt(distance / (2 * big_j)))
    accelerating = 0.0
    if jerking == big_a / big_j:
        by_distance = -1.5 * jerking + math.sqrt(0.25 * jerking**2 + distance / big_a)
        accelerating = max(0.0, min(big_v / big_a - jerking, by_distance))
    reached = big_j * jerking * (accelerating + jerking)
    ramp = accelerating + 2 * jerking
    cruising = distance / reached - ramp
    return jerking, accelerating, cruising if cruising > _ROUNDING * ramp else 0.0


def move(start: float, target: float, limits: Limits) -> list[Piece]:
    """Pieces of the fastest move between two positions [m], from rest to rest; none where they are the same."""
    tj, ta, tv = phases(abs(target - start), limits)
    j = math.copysign(limits.jerk, target - start)
    return chained(start, [(tj, j), (ta, 0.0), (tj, -j), (tv, 0.0), (tj, -j), (ta, 0.0), (tj, j)])
