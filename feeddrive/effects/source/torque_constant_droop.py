"""Torque per ampere that falls with the square of the current: the motor's iron saturates.

    T_acts = T (1 - s (T / T0)^2)

| symbol | key | meaning | unit |
|---|---|---|---|
| s | share | of the torque that is lost at T0; at most 1/3, beyond which more current would give less torque | 1 |
| T0 | at_torque | computed torque at which that share is stated | N m |
| T | (recorded) | torque constant times current: what is asked for, limited and recorded | N m |
| T_acts | | torque that acts on the rotor | N m |

Only s / T0^2 can be seen in a recording: 2 % at 5 N m is 8 % at 10 N m. A diagnosis gives the share at three tenths of
the declared torque limit, so that recordings of one machine compare, or else at the largest torque recorded. Beyond
T0 / sqrt(3 s), where the parabola would turn back, the torque is held at its greatest value, and a simulation that goes
there warns. Odd in the torque; dissipative, as it takes from what drives.

It differs from a mass or an inertia, which ask for torque in proportion, by the third power of the torque: a recording
that accelerates at one level alone cannot tell them apart.
Source: Krause, Wasynczuk, Sudhoff, Analysis of Electric Machinery, 2nd ed., section 5.6 (saturation); the square is the
first term of a series that must be even in the current.
"""

from __future__ import annotations

from collections.abc import Mapping

from feeddrive.effects.base import DriveEffect, Parameter, Signature
from feeddrive.typing import Expression


class TorqueConstantDroop(DriveEffect):
    """Loss of torque with the cube of the torque asked for."""

    name = "torque_constant_droop"
    words = "torque per ampere falling at high current"
    parameters = (
        Parameter("share", "1", 0.0, 1 / 3, size=0.05),
        Parameter("at_torque", "N m", 1e-6, 1e7, size=10.0),
    )
    signature = Signature(
        ("motor_torque",), "cube of the motor torque", ("payload", "inertia_deviation", "load_dependent_friction")
    )
    curve_over = "motor_torque"
    additive = True

    def droop(self, p: Mapping[str, Expression]) -> Expression:
        """s / T0^2 [1/(N m)^2]."""
        return p["share"] / p["at_torque"] ** 2
