"""The physical minimum: what is too small for anyone to act on is no finding, however significant.

A delay d is of no size by itself: it moves a channel y by d dy/dt, so that the motion says what it does. Of a torque
that matters from `LEAST_MASS_SHARE` of its swing on, as an inertia does; of a position from the noise of its sensor on,
at the highest speed that was seen.
"""

from __future__ import annotations

from collections.abc import Collection

import numpy as np

from feeddrive.diagnosis.friction_at_port import TYPICAL_VELOCITY, declared_level, declared_viscous
from feeddrive.diagnosis.heat.heat_candidates import is_material_heat
from feeddrive.diagnosis.likelihood.problem import Problem
from feeddrive.effects.base import Effect, Kind, Port, number
from feeddrive.effects.chain.inertia_deviation import InertiaDeviation, declared_inertia
from feeddrive.effects.timing.channel_delay import ChannelDelay
from feeddrive.effects.timing.drive_delay import DriveDelay
from feeddrive.plant.plant import Plant

LEAST_FACTOR = 0.005
"""Deviation of a friction factor from 1, and share of the drag that falls as it warms, or is other in a direction. No
declared friction is known to that, but a quiet drive shows it, and what shows and is left without its name leaves the
error to the next best one."""

LEAST_SOFTENING = 0.02
"""Stiffness that is lost around zero force, over that under load."""

LEAST_SHARE = 0.003
"""Deviation of a stiffness from the declared one, and a force over the declared Coulomb level of the guide. No
catalogue knows either to that, but a scale shows it, and without its name it is taken for a play of some nanometres."""

LEAST_MASS_SHARE = 0.001
"""A mass over the declared table mass, what swings on it included, and an inertia over the declared one of its shaft: a
scale and a torque in steps of a thousandth show no less. So of a torque that a delay moves, over the torque's swing,
and of one that ripples, over all declared Coulomb levels.
What swings on the table counts as at its resonance, where the table feels 1 / (2 damping) of its mass."""

TINY = 1e-9
"""In place of no damping [1]."""

FORCE_KEYS = ("delta_force", "force", "peak")
"""Parameters that are forces at the table."""


def is_material(effect: Effect, plant: Plant) -> bool:
    """Whether an effect is of a size that matters on this plant."""
    if effect.kind is Kind.HEAT:
        return is_material_heat(effect, plant.heat)
    values = {key: value for key, value in effect.values.items() if isinstance(value, float)}
    if effect.name == "friction_deviation":
        return any(abs(values[key] - 1) >= LEAST_FACTOR for key in ("coulomb_factor", "viscous_factor"))
    if effect.name == "viscous_warmup":
        return abs(values["share"]) >= LEAST_FACTOR
    if effect.name == "viscous_asymmetry":
        other = abs(values["delta_viscous"]) * TYPICAL_VELOCITY
        return other >= LEAST_FACTOR * declared_viscous(plant, Port.TABLE)
    if effect.name == "stiffness_vs_position":
        return max(abs(values["share_over_stroke"]), abs(values["middle_compliance"])) >= LEAST_SHARE
    if effect.name == "preload_loss" and values["ratio"] > 1 - LEAST_SOFTENING:
        return False
    if effect.name in ("structural_mode", "payload"):
        resonance = max(0.5 / max(values.get("damping", 0.5), TINY), 1.0)
        return abs(values["mass"]) * resonance >= LEAST_MASS_SHARE * plant.chain.values["table_mass"]
    if isinstance(effect, InertiaDeviation):
        return abs(values["inertia"]) >= LEAST_MASS_SHARE * declared_inertia(plant.chain.values, effect.place)
    if effect.name == "stiffness_deviation":
        return abs(values["factor"] - 1) >= LEAST_SHARE
    if "amplitude" in values and effect.parameter("amplitude").unit == "N m":
        level = declared_level(plant, Port.SCREW) + plant.chain.radius * declared_level(plant, Port.TABLE)
        return abs(values["amplitude"]) >= LEAST_MASS_SHARE * level
    forces = [abs(number) for key, value in effect.values.items() if key in FORCE_KEYS for number in _numbers(value)]
    return not forces or max(forces) >= LEAST_SHARE * declared_level(plant, Port.TABLE)


def is_material_here(effect: Effect, problem: Problem) -> bool:
    """Whether an effect is of a size that matters on this plant and, of a delay, in the motion that was recorded."""
    if not is_material(effect, problem.plant):
        return False
    if isinstance(effect, DriveDelay):
        return _moves(problem, number(effect.values["delay"]), ("motor_torque",))
    if isinstance(effect, ChannelDelay):
        # all else seems early where the motor angle is late
        late = problem.evidence[0].channels if effect.place == "motor_angle" else (effect.place,)
        return _moves(problem, number(effect.values["delay"]), late)
    return True


def _moves(problem: Problem, delay: float, channels: Collection[str]) -> bool:
    """Whether a delay [s] moves one of the channels, in one of the recordings, by as much as matters; true without any.

    The rate is that of the prediction: the noise of a channel, differentiated, would make every delay matter.
    """
    asked = False
    for one in problem.evidence:
        predicted = problem.predictor.predict(problem.plant, one)
        for name in [name for name in one.channels if name in channels]:
            moved = delay * np.gradient(predicted[name], one.recording.sample_time)[one.counted]
            if name == "motor_torque":
                small = np.sqrt(np.mean(moved**2)) < LEAST_MASS_SHARE * np.std(predicted[name][one.counted])
            else:
                small = np.max(np.abs(moved), initial=0.0) < one.known_to(name)
            asked = True
            if not small:  # a declared plant that cannot be simulated leaves it open
                return True
    return not asked


def _numbers(value: float | tuple[float, ...]) -> tuple[float, ...]:
    return value if isinstance(value, tuple) else (value,)
