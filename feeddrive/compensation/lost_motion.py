"""Lost motion taken apart: what is play, which a table may take away, and what only looks like it.

    b = w + u,   u = s+ - s-,   s = r theta - x  in slow steady motion without play

| symbol | meaning | unit |
|---|---|---|
| b | lost motion of a reversal read at the motor, and at the table | m |
| w | play: free width of the transmission | m |
| u | wind-up: friction loads the springs one way, then the other | m |
| s+, s- | how far the table lags behind the motor, moving along + and along - | m |

Play is there whatever the load. Wind-up is proportional to friction: it changes with lubrication, load and wear, builds
up over the presliding of the guides and not at once, and a value that fits today bites into the contour tomorrow. So a
backlash value is written for w alone. Where the table is not held on its flank by friction, it crosses the play by its
own inertia while it brakes; no table can know on which side it comes to rest:

    a_max = F / m

| symbol | meaning | unit |
|---|---|---|
| F, m | friction of the table in slow motion, moving mass | N, kg |
"""

from __future__ import annotations

import math
from dataclasses import dataclass, replace

import numpy as np

from feeddrive.effects.base import TransmissionEffect, TravelEffect
from feeddrive.errors import InputError
from feeddrive.plant.plant import Plant
from feeddrive.plant.steady import steady_motions
from feeddrive.quantity import format_quantity

SLOW = 5e-3
"""Velocity at which lost motion is told [m/s]: 0.3 m/min, at which positioning tests approach their targets."""

NOTICED = 1e-7
"""Lost motion that a laser interferometer on a machine tells from none [m]."""

CURE = (
    "stiffen it or lower its friction (preload, alignment, lubrication), close the position loop by a scale, or use "
    "friction feed-forward"
)
"""Of wind-up."""


@dataclass(frozen=True)
class LostMotion:
    """Lost motion of a plant in slow motion.

    Attributes:
        play: w [m].
        wind_up: u [m].
        force: of friction between nut and table, mean of both directions [N]; 0 in a rigid structure.
        torque: of friction that the motor feels, mean of both directions [N m].
        holding: acceleration up to which friction keeps the table on its flank [m/s^2].
    """

    play: float
    wind_up: float
    force: float
    torque: float
    holding: float

    @property
    def total(self) -> float:
        """b [m]."""
        return self.play + self.wind_up


def without_play(plant: Plant) -> Plant:
    """The plant with neither play nor travel errors: what is left of its lost motion is wind-up."""
    kept = tuple(
        one for one in plant.effects
        if not isinstance(one, TravelEffect) and not (isinstance(one, TransmissionEffect) and one.has_play)
    )  # fmt: skip
    return replace(plant, effects=kept)


def declared_play(plant: Plant) -> float:
    """Total play of a plant [m]."""
    gaps = [one for one in plant.effects if isinstance(one, TransmissionEffect) and one.has_play]
    return float(sum(one.free_play(one.values) for one in gaps))


def lost_motion(plant: Plant, position: float | None = None) -> LostMotion:
    """Lost motion at a table position [m]; in the middle of the stroke if not given.

    Raises:
        InputError: no steady motion is found there.
    """
    at = plant.middle if position is None else position
    radius = plant.chain.motor_radius
    forward, reverse = steady_motions(without_play(plant), (SLOW, -SLOW), at)
    lags = [radius * float(one.state[0]) - at for one in (forward, reverse)]
    torque = 0.5 * (forward.torque - reverse.torque)
    force = _table_friction(plant, at)
    mass = float(plant.chain_values()["table_mass"])
    return LostMotion(declared_play(plant), lags[0] - lags[1], force, torque, force / mass if mass > 0 else math.inf)


def _table_friction(plant: Plant, position: float) -> float:
    """Friction of the table in slow motion, mean of both directions [N]: what holds it on a flank.

    By virtual work: the torque that the plant asks for, less what it asks for without any friction at the table.
    """
    bare = without_play(plant)
    kept = tuple(one for one in bare.effects if str(one.port) != "table" or not _is_friction(one))
    with_it, without = (
        steady_motions(one, (SLOW, -SLOW), position) for one in (bare, replace(bare, effects=kept))
    )  # fmt: skip
    torques = [0.5 * (pair[0].torque - pair[1].torque) for pair in (with_it, without)]
    return float(max(torques[0] - torques[1], 0.0) / plant.chain.motor_radius)


def _is_friction(effect: object) -> bool:
    from feeddrive.effects.base import FrictionEffect

    return isinstance(effect, FrictionEffect)


def wind_up_words(lost: LostMotion) -> str:
    """What the wind-up is, in a sentence without its full stop."""
    cause = f"friction of {lost.torque:.2g} N m at the motor winds up the springs"
    if lost.force > 0:
        cause = f"friction (table {lost.force:.3g} N, {lost.torque:.2g} N m at the motor) winds up the springs"
    return f"{format_quantity(lost.wind_up, 'm')} of the lost motion is wind-up, not play: {cause}"


def refuse_wind_up(lost: LostMotion, where: str, least: float) -> None:
    """Refuse a table for lost motion that is no play.

    Args:
        lost: of the axis.
        where: for the message.
        least: play below this is none [m], the step of the control.

    Raises:
        InputError: there is no play; says what the lost motion is, and its cure.
    """
    if lost.play >= least:
        return
    if abs(lost.wind_up) < NOTICED:
        what = f"no lead error and no play of {format_quantity(least, 'm')} or more is known of this axis"
        raise InputError(what, where, "diagnose a recording over the whole stroke, and give its folder")
    raise InputError(f"no table is written: {wind_up_words(lost)}", where, CURE)


def flank_words(lost: LostMotion) -> str:
    """Up to which acceleration a backlash value holds, as a sentence."""
    if not np.isfinite(lost.holding):
        return ""
    return (
        f"Friction holds the table on its flank up to {lost.holding:.2g} m/s^2; braked harder it crosses the play by "
        "its inertia, and no value tells on which side it stops: renew the preload."
    )
