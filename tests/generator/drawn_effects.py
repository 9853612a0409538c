"""Effects drawn at random for a machine: the laws of the effect table, and relatives of them, within what is met.

A draw gives the effect in some size; `fits` says how large it may be on that machine, `least` how far a declared value
must be off before it is more than its tolerance.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Sequence
from dataclasses import dataclass

import numpy as np

from tests.generator import effects as planted
from tests.generator.constants import declared_constants
from tests.generator.effects import Effect
from tests.generator.effects.relatives import Relative
from tests.generator.machines import Machine, Random

TOLERANCES = {
    "mass": 0.05,
    "inertia": 0.05,
    "friction": 0.20,
    "stiffness": 0.20,
    "damping": 0.50,
    "torque_constant": 0.03,
}
"""Share by which a declared value of a kind may be off before that is a finding."""

BEYOND = 1.5
"""Tolerances by which a value is off at least, where that is what is planted."""

SECONDS = 12.0
"""Length that drawn time constants refer to [s]."""


@dataclass(frozen=True)
class Drawn:
    """An effect and its limits.

    effect: as drawn. low, high: least and largest factor on it that is allowed.
    """

    effect: Effect
    low: float
    high: float

    @property
    def relative(self) -> bool:
        """Whether its law is not that of the table."""
        return isinstance(self.effect, Relative)


def drawn_effect(name: str, machine: Machine, random: Random, seconds: float, relative: bool) -> Drawn | None:
    """Return an effect of this name; None where the law has no relative, or the machine cannot have it."""
    drawn = MAKERS[name](machine, random, seconds)
    if not relative:
        return drawn
    changed = RELATIVES.get(name)
    if changed is None:
        return None
    law, changes, lengths = changed(machine, random, seconds, drawn.effect)
    return Drawn(Relative(drawn.effect, law, changes, lengths), drawn.low, drawn.high)


def _log(random: Random, low: float, high: float) -> float:
    return float(math.exp(random.uniform(math.log(low), math.log(high))))


def _sign(random: Random, positive: float = 0.5) -> float:
    return 1.0 if random.random() < positive else -1.0


def _upto(effect: Effect, most: float, low: float = 1e-4) -> Drawn:
    """A size from nearly nothing to `most` times the drawn one."""
    return Drawn(effect, low, most)


def _coulomb_asymmetry(m: Machine, random: Random, seconds: float) -> Drawn:
    sign = _sign(random)
    return _upto(planted.CoulombAsymmetry(sign * 0.2 * m.axis.guide_coulomb), 10.0 if sign > 0 else 3.5)


def _viscous_asymmetry(m: Machine, random: Random, seconds: float) -> Drawn:
    sign = _sign(random)
    return _upto(planted.ViscousAsymmetry(sign * 0.3 * m.axis.guide_viscous), 10.0 if sign > 0 else 2.8)


def _stribeck(m: Machine, random: Random, seconds: float) -> Drawn:
    sign = _sign(random, 0.7)
    velocity = _log(random, 0.006, 0.1) * m.axis.top_speed
    velocity = max(velocity, 4.0 * m.axis.guide_velocity)
    return _upto(planted.Stribeck(sign * 0.3 * m.axis.guide_coulomb, velocity), 6.0 if sign > 0 else 2.2)


def _presliding(m: Machine, random: Random, seconds: float) -> Drawn:
    sliding = _log(random, 2e-6, 2e-5)
    stiffness = m.axis.guide_coulomb / sliding
    damping = 0.3 * math.sqrt(stiffness * m.axis.table_mass)
    return Drawn(planted.Presliding(stiffness, min(damping, 0.5 * m.axis.guide_coulomb / m.axis.top_speed)), 0.1, 10.0)


def _friction_vs_position(m: Machine, random: Random, seconds: float) -> Drawn:
    low, high = m.axis.travel
    width = (high - low) * _log(random, 0.03, 0.15)
    sign = _sign(random, 0.8)
    where = low + (high - low) * float(random.uniform(0.1, 0.7))
    return _upto(planted.FrictionVsPosition(sign * 0.5 * m.axis.guide_coulomb, where, width), 10.0 if sign > 0 else 1.4)


def _viscous_warmup(m: Machine, random: Random, seconds: float) -> Drawn:
    port = str(random.choice(["table", "screw"]))
    return _upto(planted.ViscousWarmup(port, 0.4, float(random.uniform(0.15, 0.5)) * seconds), 2.2)


def _friction_deviation(m: Machine, random: Random, seconds: float) -> Drawn:
    least = BEYOND * TOLERANCES["friction"]
    port = str(random.choice(["table", "screw"]))
    up = 0.4 * _sign(random, 0.7)
    both = random.random() < 0.4
    return Drawn(
        planted.FrictionDeviation(port, 1.0 + up, 1.0 + (up if both else 0.0)),
        least / 0.4,
        5.0 if up > 0 else 2.0,
    )


def _load_dependent_friction(m: Machine, random: Random, seconds: float) -> Drawn:
    return _upto(planted.LoadDependentFriction(0.08), 5.0)


def _torque_ripple(m: Machine, random: Random, seconds: float) -> Drawn:
    order = float(random.choice([1.0, 2.0, 4.0, 6.0, 8.0, 12.0, 18.0, 24.0]))
    phase = float(random.uniform(0.0, 2.0 * math.pi))
    return _upto(planted.TorqueRipple(0.1 * m.friction_torque, order, phase), 20.0)


def _ball_pass_ripple(m: Machine, random: Random, seconds: float) -> Drawn:
    level = m.axis.nut_coulomb + m.axis.bearing_coulomb
    order = float(random.uniform(2.3, 14.0))
    if abs(order - round(order)) < 0.06:
        order += 0.17
    return _upto(planted.BallPassRipple(0.2 * level, order, float(random.uniform(0.0, 2.0 * math.pi))), 4.5)


def _torque_constant_droop(m: Machine, random: Random, seconds: float) -> Drawn:
    limit = m.axis.controller.torque_limit
    return _upto(planted.TorqueConstantDroop(0.05, 0.5 * limit), 0.25 / (0.05 * 4.0))


def _constant_force(m: Machine, random: Random, seconds: float) -> Drawn:
    return _upto(planted.ConstantForce(_sign(random) * 0.4 * m.axis.guide_coulomb), 8.0)


def _position_spring(m: Machine, random: Random, seconds: float) -> Drawn:
    low, high = m.axis.travel
    zero = low + (high - low) * float(random.uniform(-0.2, 0.8))
    return _upto(planted.PositionSpring(0.5 * m.axis.guide_coulomb / (high - low), zero), 20.0)


def _backlash(m: Machine, random: Random, seconds: float) -> Drawn:
    return Drawn(planted.Backlash(_log(random, 3e-6, 30e-6)), 1e-3, 10.0)


def _lead_error_periodic(m: Machine, random: Random, seconds: float) -> Drawn:
    order = float(random.choice([1.0, 1.0, 1.0, 2.0, 3.0, 4.0]))
    return _upto(planted.LeadErrorPeriodic(2e-6, order, float(random.uniform(0.0, 2.0 * math.pi))), 20.0)


def _lead_error_cumulative(m: Machine, random: Random, seconds: float) -> Drawn:
    return _upto(planted.LeadErrorCumulative(_sign(random) * 30e-6), 20.0)


def _thermal_growth(m: Machine, random: Random, seconds: float) -> Drawn:
    return _upto(planted.ThermalGrowth(_sign(random, 0.8) * 20e-6, float(random.uniform(0.15, 0.6)) * seconds), 10.0)


def _stiffness_deviation(m: Machine, random: Random, seconds: float) -> Drawn:
    up = 0.4 * _sign(random, 0.3)
    least = BEYOND * TOLERANCES["stiffness"]
    return Drawn(planted.StiffnessDeviation(1.0 + up), least / 0.4, 3.0 if up > 0 else 2.0)


def _stiffness_vs_position(m: Machine, random: Random, seconds: float) -> Drawn:
    return _upto(planted.StiffnessVsPosition(0.4), 1.9)


def _preload_loss(m: Machine, random: Random, seconds: float) -> Drawn:
    force = float(random.uniform(1.0, 4.0)) * m.axis.guide_coulomb
    return _upto(planted.PreloadLoss(float(random.uniform(0.25, 0.7)), force), 5.0)


def _payload(m: Machine, random: Random, seconds: float) -> Drawn:
    least = BEYOND * TOLERANCES["mass"]
    sign = _sign(random, 0.75)
    return Drawn(planted.Payload(sign * 0.2 * m.axis.table_mass), least / 0.2, 7.0 if sign > 0 else 2.5)


def _inertia_deviation(m: Machine, random: Random, seconds: float) -> Drawn:
    least = BEYOND * TOLERANCES["inertia"]
    where = str(random.choice(["motor", "screw"]))
    whole = m.axis.motor_inertia if where == "motor" else m.axis.screw_inertia
    sign = _sign(random, 0.6)
    return Drawn(planted.InertiaDeviation(where, sign * 0.2 * whole), least / 0.2, 5.0 if sign > 0 else 2.5)


def _structural_mode(m: Machine, random: Random, seconds: float) -> Drawn:
    hertz, damping = _log(random, 12.0, 70.0), _log(random, 0.01, 0.08)
    return _upto(planted.StructuralMode(0.1 * m.axis.table_mass, hertz, damping), 4.0)


def _drive_delay(m: Machine, random: Random, seconds: float) -> Drawn:
    return Drawn(planted.DriveDelay(3e-4), 0.1, 5.0)


def _channel_delay(m: Machine, random: Random, seconds: float) -> Drawn:
    channels = ["motor_torque", "motor_angle", "table_position"]
    if not m.scale:
        # Without a table a late angle is a drive that acts late, to the last digit.
        channels = ["motor_torque"]
    return Drawn(planted.ChannelDelay(str(random.choice(channels)), 5e-4), 0.1, 8.0)


MAKERS: dict[str, Callable[[Machine, Random, float], Drawn]] = {
    "coulomb_asymmetry": _coulomb_asymmetry,
    "viscous_asymmetry": _viscous_asymmetry,
    "stribeck": _stribeck,
    "presliding": _presliding,
    "friction_vs_position": _friction_vs_position,
    "viscous_warmup": _viscous_warmup,
    "friction_deviation": _friction_deviation,
    "load_dependent_friction": _load_dependent_friction,
    "torque_ripple": _torque_ripple,
    "ball_pass_ripple": _ball_pass_ripple,
    "torque_constant_droop": _torque_constant_droop,
    "constant_force": _constant_force,
    "position_spring": _position_spring,
    "backlash": _backlash,
    "lead_error_periodic": _lead_error_periodic,
    "lead_error_cumulative": _lead_error_cumulative,
    "thermal_growth": _thermal_growth,
    "stiffness_deviation": _stiffness_deviation,
    "stiffness_vs_position": _stiffness_vs_position,
    "preload_loss": _preload_loss,
    "payload": _payload,
    "inertia_deviation": _inertia_deviation,
    "structural_mode": _structural_mode,
    "drive_delay": _drive_delay,
    "channel_delay": _channel_delay,
}

NEEDS_SCALE = (
    "lead_error_periodic", "lead_error_cumulative", "thermal_growth", "stiffness_deviation", "stiffness_vs_position",
    "preload_loss", "backlash",
)  # fmt: skip
"""Effects of the way between motor and table, hardly seen where the table is not measured."""

Changed = tuple[str, dict[str, float], tuple[str, ...]]


def _second_harmonic(key: str) -> Callable[[Machine, Random, float, Effect], Changed]:
    def changed(m: Machine, random: Random, seconds: float, effect: Effect) -> Changed:
        share = float(random.uniform(0.2, 0.6))
        return f"a second harmonic of {share:.2f}", {key: share}, ()

    return changed


def _soft_asymmetry(m: Machine, random: Random, seconds: float, effect: Effect) -> Changed:
    width = _log(random, 0.01, 0.05) * m.axis.top_speed
    return "a step that takes some speed", {"asymmetry_width": width}, ()


def _power_asymmetry(m: Machine, random: Random, seconds: float, effect: Effect) -> Changed:
    power = float(random.choice([0.5, 0.7, 1.5, 2.0]))
    return f"power {power} of the speed", {"asymmetry_power": power, "asymmetry_speed": 0.4 * m.axis.top_speed}, ()


def _stribeck_curve(m: Machine, random: Random, seconds: float, effect: Effect) -> Changed:
    kind = int(random.integers(1, 3))
    return ("1 / (1 + |v / vs|)", "exp(-|v / vs|)")[kind - 1], {"stribeck_kind": float(kind)}, ()


def _dahl(m: Machine, random: Random, seconds: float, effect: Effect) -> Changed:
    power = float(random.choice([0.5, 1.5, 2.0]))
    return f"Dahl's curve of exponent {power}", {"bristle_power": power}, ()


def _tight_place(m: Machine, random: Random, seconds: float, effect: Effect) -> Changed:
    kind = int(random.integers(1, 4))
    return ("1 / (1 + u^2)", "half a cosine", "flat with soft edges")[kind - 1], {"bump_kind": float(kind)}, ()


def _two_times(m: Machine, random: Random, seconds: float, effect: Effect) -> Changed:
    return (
        "two time constants",
        {"warmup_slow_share": float(random.uniform(0.3, 0.6)), "warmup_slow_time": 3.0 * seconds},
        (),
    )


def _growth_times(m: Machine, random: Random, seconds: float, effect: Effect) -> Changed:
    return (
        "two time constants",
        {"growth_slow_share": float(random.uniform(0.3, 0.6)), "growth_slow_time": 3.0 * seconds},
        (),
    )


def _load_power(m: Machine, random: Random, seconds: float, effect: Effect) -> Changed:
    power = float(random.choice([0.67, 1.33]))
    reference = max(m.axis.table_mass * m.axis.acceleration, m.axis.guide_coulomb)
    return f"power {power} of the load", {"load_power": power, "load_reference": reference}, ()


def _droop_power(m: Machine, random: Random, seconds: float, effect: Effect) -> Changed:
    power = float(random.choice([1.0, 1.5, 3.0, 4.0]))
    assert isinstance(effect, planted.TorqueConstantDroop)
    share = effect.share / effect.at_torque**power
    return f"power {power} of the torque", {"droop_power": power, "droop": share}, ("droop",)


def _saturating(m: Machine, random: Random, seconds: float, effect: Effect) -> Changed:
    low, high = m.axis.travel
    return "a spring that saturates", {"spring_reach": float(random.uniform(0.2, 0.5)) * (high - low)}, ()


SOFT_EDGES = (0.05, 0.14)
"""Length of the soft edges of a free play over its width.

With edges of s times the width the spring F = k (e + (hypot(e - w/2, s w) - hypot(e + w/2, s w)) / 2) carries in the
middle as well, 1 - 1 / hypot(1, 2 s) of k. The spring of two straight lines of the same lost motion, slope a k inside
and k outside, that is nearest to it in force has a = 0.02 at s = 0.05, a tenth at 0.14, 0.22 at a quarter and 0.37 at
0.4. A nut that carries a tenth and more of its stiffness under no load touches there: what such a law is a relative of
is lost preload, not free play. tests/analytic/test_soft_edges.py works these numbers out.
"""


def _soft_edge(m: Machine, random: Random, seconds: float, effect: Effect) -> Changed:
    assert isinstance(effect, planted.Backlash)
    softness = float(random.uniform(*SOFT_EDGES)) * effect.width
    return "soft edges", {"gap_softness": softness}, ("gap_softness",)


def _curved(m: Machine, random: Random, seconds: float, effect: Effect) -> Changed:
    low, high = m.axis.travel
    return "a parabola beside the line", {"lead_curve": float(random.uniform(0.3, 0.8)) / (high - low)}, ()


def _stiffness_power(m: Machine, random: Random, seconds: float, effect: Effect) -> Changed:
    return "a compliance over the square of the position", {"stroke_power": 2.0}, ()


def _smooth_preload(m: Machine, random: Random, seconds: float, effect: Effect) -> Changed:
    return "a smooth change of stiffness", {"preload_smooth": 1.0}, ()


def _sliding_mode(m: Machine, random: Random, seconds: float, effect: Effect) -> Changed:
    assert isinstance(effect, planted.StructuralMode)
    speed = float(random.uniform(0.2, 0.6)) * m.axis.acceleration / (2.0 * math.pi * effect.frequency)
    return "a damper that saturates", {"mode_speed": speed}, ()


RELATIVES: dict[str, Callable[[Machine, Random, float, Effect], Changed]] = {
    "coulomb_asymmetry": _soft_asymmetry,
    "viscous_asymmetry": _power_asymmetry,
    "stribeck": _stribeck_curve,
    "presliding": _dahl,
    "friction_vs_position": _tight_place,
    "viscous_warmup": _two_times,
    "load_dependent_friction": _load_power,
    "torque_ripple": _second_harmonic("ripple_second"),
    "ball_pass_ripple": _second_harmonic("passing_second"),
    "torque_constant_droop": _droop_power,
    "position_spring": _saturating,
    "backlash": _soft_edge,
    "lead_error_periodic": _second_harmonic("travel_second"),
    "lead_error_cumulative": _curved,
    "thermal_growth": _growth_times,
    "stiffness_vs_position": _stiffness_power,
    "preload_loss": _smooth_preload,
    "structural_mode": _sliding_mode,
}


def off_factors(random: Random, kept: frozenset[str]) -> dict[str, float]:
    """Return true over declared value of the numbers of an axis and of its torque constant.

    Every one within its tolerance, two of them up to twice. `kept` are left as they are.
    """
    wide = set(random.choice(len(OFF_GROUPS), 2, replace=False))
    factors: dict[str, float] = {}
    for index, (names, kind) in enumerate(OFF_GROUPS):
        tolerance = TOLERANCES[kind] * (2.0 if index in wide else 1.0)
        share = float(random.uniform(-1.0, 1.0))
        # A factor and its inverse are equally far off where a tolerance is large.
        factor = math.exp(share * math.log1p(tolerance))
        for name in names:
            if name not in kept:
                factors[name] = round(factor, 4)
    return factors


OFF_GROUPS: tuple[tuple[tuple[str, ...], str], ...] = (
    (("table_mass",), "mass"),
    (("motor_inertia",), "inertia"),
    (("screw_inertia",), "inertia"),
    (("guide_coulomb",), "friction"),
    (("guide_viscous",), "friction"),
    (("nut_coulomb", "bearing_coulomb"), "friction"),
    (("nut_power",), "friction"),
    (("axial_stiffness",), "stiffness"),
    (("torsional_stiffness",), "stiffness"),
    (("axial_damping",), "damping"),
    (("torsional_damping",), "damping"),
    (("torque_constant",), "torque_constant"),
)
"""Numbers that are off together, and the kind of their tolerance."""

TOUCHED = {
    "payload": ("table_mass",),
    "inertia_deviation": ("motor_inertia", "screw_inertia"),
    "friction_deviation": ("guide_coulomb", "guide_viscous", "nut_coulomb", "bearing_coulomb", "nut_power"),
    "stiffness_deviation": ("axial_stiffness",),
}
"""Effects that say that a declared value is other, and the values."""


def are_possible(effects: Sequence[Effect], machine: Machine) -> bool:
    """Whether the equations allow the effects together: positive friction, masses, stiffness."""
    c = declared_constants(machine.axis)
    try:
        for effect in effects:
            c = effect.planted(c)
    except ValueError:
        return False
    parts = (c.coulomb_asymmetry, c.stribeck_force, c.bump_peak)
    level = c.guide_coulomb + sum(min(part, 0.0) for part in parts)
    largest = c.droop * machine.axis.controller.torque_limit**c.droop_power
    numbers = np.array([level, c.table_mass, c.motor_inertia, c.screw_inertia, c.axial_stiffness, 0.4 - largest])
    phase = np.linspace(0.0, 2.0 * math.pi, 721)
    rising = float(np.max(np.sin(phase) + c.passing_second * np.sin(2.0 * phase)))
    drag = c.nut_coulomb + c.bearing_coulomb - abs(c.passing_amplitude) * rising
    return bool(np.all(numbers > 0.0)) and c.stroke_share < 0.9 and drag > 0.0
