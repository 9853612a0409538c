"""What paper 003 says of ball loads and of friction against load and preload, beside what the program computes."""

from __future__ import annotations

import math
from dataclasses import replace

import numpy as np

from feeddrive.parts.contact import PointContact
from feeddrive.parts.guide.guide_carriage import carriage_friction
from feeddrive.parts.guide.guide_coefficients import SET_A
from feeddrive.parts.guide.guide_equilibrium import guide_equilibrium, preload_force, unloading_force
from feeddrive.parts.guide.guide_geometry import HSR_20R, HSR_30R, BallGuide
from feeddrive.reproduce.row import Paper, Row, claim, number

_PAPER = Paper.GUIDE
SIZES = {"HSR-20R": HSR_20R, "HSR-30R": HSR_30R}
FOUR_ROWS = "four rows, approach over both contacts of a ball"
SET = "coefficients fitted to the printed shares (set A)"
_TEST_SPEEDS = np.array([3.0, 6.0, 9.0, 12.0]) / 60.0
"""Table 3 [m/s]."""
_TEST_LOADS = (0.0, 1e3, 3e3, 6e3)


def load_rows() -> tuple[Row, ...]:
    """Rows of ball loads, of the loss of preload, and of friction over load."""
    each = (row for name in SIZES for row in (_parts(name), _unloading(name), *_friction_over_load(name)))
    return (*each, _frozen_angle(), _initial_load(), _preload_rate(), _joins(), _one_contact(), _growth())


def _balls(guide: BallGuide, load: float) -> tuple[float, float]:
    """Q_A and Q_B [N]."""
    found = guide_equilibrium(guide, load).ball_load
    return float(found[2]), float(found[0])


def _parts(name: str) -> Row:
    loads = np.linspace(0.0, 24e3, 13)
    balls = np.array([_balls(SIZES[name], float(load)) for load in loads])
    rises, falls = bool(np.all(np.diff(balls[:, 0]) > 0)), bool(np.all(np.diff(balls[:, 1]) <= 0))
    return claim(
        _PAPER, "sec. 2.2", f"{name}: load of part A rises, of part B falls", "A rises, B falls",
        f"A {balls[0, 0]:.1f} to {balls[-1, 0]:.0f} N, B {balls[0, 1]:.1f} to {balls[-1, 1]:.0f} N at 24 kN",
        rises and falls, law=guide_equilibrium, assumption=FOUR_ROWS,
    )  # fmt: skip


def _unloading(name: str) -> Row:
    guide = SIZES[name]
    ratio = unloading_force(guide) / preload_force(guide)
    return number(
        _PAPER, "sec. 4.2", f"{name}: load that takes the preload away, over the preload", "1", "2.83", ratio,
        law=unloading_force,
        assumption=FOUR_ROWS, otherwise="the contact angle moves under load; 2.83 holds with a fixed angle",
    )  # fmt: skip


def _frozen_angle() -> Row:
    """With the angle fixed part B is free where part A has twice the approach."""
    contact = HSR_20R.contacts[0]
    ratio = contact.load(2.0 * HSR_20R.preload_oversize) / contact.load(HSR_20R.preload_oversize)
    return number(_PAPER, "sec. 4.2", "the same with the contact angle fixed", "1", "2.83", ratio,
                  law=PointContact.load, assumption="contact angle fixed at 45 deg")  # fmt: skip


def _friction(guide: BallGuide, load: float, speed: float) -> float:
    return float(carriage_friction(guide, SET_A, speed, load).total)


def _friction_over_load(name: str) -> tuple[Row, Row]:
    guide, speed = SIZES[name], float(_TEST_SPEEDS[0])
    light, heavy = (_friction(guide, load, speed) / _friction(guide, 0.0, speed) for load in (1e3, 6e3))
    remaining = _balls(guide, 6e3)[1]
    return (
        claim(_PAPER, "sec. 4.2", f"{name}: friction at 1 kN hardly above that at 0 kN, 3 m/min", "slight rise",
              f"factor {light:.3f}", 1.0 <= light < 1.1, law=carriage_friction, assumption=f"{FOUR_ROWS}; {SET}"),
        claim(_PAPER, "sec. 4.2", f"{name}: at 6 kN the preload is lost and friction rises much, 3 m/min", "large rise",
              f"part B carries {remaining:.0f} N, factor {heavy:.2f}", remaining == 0.0 and heavy > 1.5,
              law=carriage_friction, assumption=f"{FOUR_ROWS}; {SET}"),
    )  # fmt: skip


def _initial_load() -> Row:
    first = [_balls(replace(HSR_30R, preload_oversize=1e-6 * size), 0.0)[0] for size in (0, 4, 7)]
    shown = ", ".join(f"{ball:.1f}" for ball in first)
    return claim(_PAPER, "sec. 2.2", "ball load without load rises with preload: 0, 4, 7 µm, HSR-30R", "rises", shown,
                 first == sorted(first), law=guide_equilibrium, unit="N")  # fmt: skip


def preload_rate(size: float) -> float:
    """Rise of Q_A from 0 to 1 kN, HSR-30R with an oversize [m], per load [1]."""
    guide = replace(HSR_30R, preload_oversize=size)
    return (_balls(guide, 1e3)[0] - _balls(guide, 0.0)[0]) / 1e3


def _preload_rate() -> Row:
    at_4, at_7 = (1e3 * preload_rate(1e-6 * size) for size in (4, 7))
    return claim(
        _PAPER, "sec. 2.2", "ball load rises slower with load at preload 7 than at 4, HSR-30R", "slower",
        f"{at_7:.1f} N/kN against {at_4:.1f} N/kN", at_7 < at_4, law=guide_equilibrium, assumption=FOUR_ROWS,
    )  # fmt: skip


def _joins() -> Row:
    none, most = (_balls(replace(HSR_30R, preload_oversize=1e-6 * size), 12e3)[0] for size in (0, 7))
    gap = 100.0 * (most / none - 1.0)
    return claim(_PAPER, "sec. 2.2", "beyond some load as without preload: preload 7 against 0 at 12 kN, HSR-30R",
                 "no preload left", f"{gap:.1f} % apart", gap < 5.0, law=guide_equilibrium,
                 assumption=FOUR_ROWS)  # fmt: skip


class OneContact(BallGuide):
    """A guide whose approach is taken for that of one contact, as (1) reads with C_br or C_bc."""

    @property
    def hertz_constant(self) -> float:
        """C of the rail's contact alone [m/N^(2/3)]."""
        return self.contacts[0].constant


def _one_contact() -> Row:
    guide = OneContact(**vars(HSR_30R))
    force = 1e-3 * unloading_force(guide)
    return claim(
        _PAPER, "eqs. 1, 3", "HSR-30R loses its preload before 6 kN, with C of one contact in (1)", "lost at 6 kN",
        f"lost at {force:.1f} kN", force < 6.0, law=unloading_force,
        otherwise="the approach of (3) is that of both contacts: C = C_br + C_bc",
    )  # fmt: skip


def _growth() -> Row:
    """Over table 3, both sizes: every step of load and of speed adds friction."""
    steps = []
    for guide in SIZES.values():
        force = np.array([carriage_friction(guide, SET_A, _TEST_SPEEDS, load).total for load in _TEST_LOADS])
        steps += [float(np.min(np.diff(force, axis=axis))) for axis in (0, 1)]
    return claim(_PAPER, "sec. 4.2", "friction rises with load and speed over table 3", "rises",
                 f"every step adds at least {max(min(steps), -math.inf):.3f} N", min(steps) > 0.0,
                 law=carriage_friction, assumption=f"{FOUR_ROWS}; {SET}")  # fmt: skip
