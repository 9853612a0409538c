"""Efficiency of a ball screw whose balls slip, driving and back-driven, and the lost share of torque.

    1/eta_a - 1 = f / (a_n - f b_n),     1 - eta_b = f / (a_n + f b_n)

| symbol | meaning | unit |
|---|---|---|
| eta_a | screw drives: axial power out over shaft power in | 1 |
| eta_b | nut drives (back-driving): shaft power out over axial power in | 1 |
| f | Coulomb friction coefficient | 1 |
| a_n, b_n | geometry, see `feeddrive.parts.screw.slip_angle` | 1 |

With F the axial force and r = lead / 2 pi, driving takes the torque F r / eta_a and back-driving gives F r eta_b, so
F r times the losses above is the friction torque. They are written without a difference of near numbers.
Limits: both efficiencies are 1 at f = 0; the screw jams at f = a_n/b_n (eta_a = 0) and does not run back from
f = b_n/a_n on (eta_b <= 0, self-locking). For alpha to 0 at beta = 45 deg, eta_a goes to (1 - f)/(1 + f), not to 0.
At fixed f and beta = 45 deg eta_a falls slightly with the lead angle: that a larger lead is more efficient is not in
this model. f is an effective number of one screw (the ball's moment is not balanced), good for f below 0.1.
Source: paper 000, eqs. (5), (6), after Lin (1989), to which these forms are equal.
"""

from __future__ import annotations

from feeddrive.parts.screw.slip_angle import Groove
from feeddrive.typing import Expression


def driving_loss(groove: Groove, friction: Expression) -> Expression:
    """1/eta_a - 1: friction torque over F r while the screw drives; below jamming (f < a_n/b_n)."""
    return friction / (groove.a_n - friction * groove.b_n)


def back_driving_loss(groove: Groove, friction: Expression) -> Expression:
    """1 - eta_b: friction torque over F r while the nut drives."""
    return friction / (groove.a_n + friction * groove.b_n)


def driving_efficiency(groove: Groove, friction: Expression) -> Expression:
    """eta_a, eq. (5); 0 or less where the screw jams."""
    rest = groove.a_n - friction * groove.b_n
    return rest / (rest + friction)


def back_driving_efficiency(groove: Groove, friction: Expression) -> Expression:
    """eta_b, eq. (6); 0 or less where the screw is self-locking."""
    return 1 - back_driving_loss(groove, friction)


def jamming_friction(groove: Groove) -> Expression:
    """f at which the screw can no longer drive, a_n/b_n."""
    return groove.a_n / groove.b_n


def self_locking_friction(groove: Groove) -> Expression:
    """f from which on the nut can no longer drive the screw, b_n/a_n."""
    return groove.b_n / groove.a_n
