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

Torque that a preloaded double nut takes without axial load.

    T_a = t_n F_0 L / 2 pi,     t_n = 1/eta_a - eta_b

| symbol | meaning | unit |
|---|---|---|
| T_a | preload torque, to hold the nut or to turn the screw | N m |
| F_0 | preload | N |
| L | lead | m |
| t_n | torque over that of an ideal screw with the axial load F_0 | 1 |
| eta_a, eta_b | efficiencies of the nut that the screw drives, and of the one that drives the screw | 1 |

Slow, dry or little lubricated: no viscous torque is in it. Linear in F_0.
Source: paper 000, eq. (7). The available text has "- f_a" beside the first fraction; it belongs in its denominator.

Friction coefficient from a measured preload torque: the exact inverse of `feeddrive.parts.screw.screw_efficiency`.

    f = a_n t_n / (1 + sqrt(1 + t_n^2 b_n^2)),     t_n = 2 pi T_a / (F_0 L)

Symbols as in `parts.screw.preload_torque`. The paper writes a_n (sqrt(1 + t_n^2 b_n^2) - 1) / (t_n b_n^2), the
same value with a difference of near numbers; this form loses no digits and is 0 at no torque.
It assumes one f at both nuts. A torque that does not depend on the load (lubricant, seals) makes f look larger the
smaller the preload is: separate it first (`feeddrive.parts.screw.torque_regression`).
Source: paper 000, eq. (8).
"""

from __future__ import annotations

import math

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


def relative_preload_torque(groove: Groove, friction: Expression) -> Expression:
    """t_n, with one friction f at both nuts."""
    return driving_loss(groove, friction) + back_driving_loss(groove, friction)


def ideal_torque(force: Expression, lead: Expression) -> Expression:
    """F L / 2 pi [N m]: torque of a screw without friction, for an axial force [N] and a lead [m]."""
    return force * lead / (2 * math.pi)


def preload_torque(groove: Groove, friction: Expression, preload: Expression, lead: Expression) -> Expression:
    """T_a [N m] at a preload [N] and a lead [m]."""
    return relative_preload_torque(groove, friction) * ideal_torque(preload, lead)


def relative_torque(torque: Expression, preload: Expression, lead: Expression) -> Expression:
    """t_n from torque [N m], preload [N], not 0, and lead [m]."""
    return torque / ideal_torque(preload, lead)


def friction_from_torque(relative: Expression, groove: Groove) -> Expression:
    """f from t_n, which is 0 or more; numbers, arrays or expressions."""
    return groove.a_n * relative / (1 + (1 + (relative * groove.b_n) ** 2) ** 0.5)
