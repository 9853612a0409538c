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
own inertia while it brakes; no table can know on which side it comes to rest. And where a steady force, such as weight,
is larger than friction, the table never leaves one flank and the play does not show at all:

    a_max = F / m

| symbol | meaning | unit |
|---|---|---|
| F, m | friction of the table in slow motion, moving mass | N, kg |
"""

from __future__ import annotations

import math
from dataclasses import dataclass, replace

import numpy as np

from feeddrive.effects.base import Effect, FrictionEffect, Port, SourceEffect, TransmissionEffect, TravelEffect
from feeddrive.errors import InputError
from feeddrive.plant.analysis.steady import steady_motions
from feeddrive.plant.plant import Plant
from feeddrive.units.quantity import format_quantity

SLOW = 5e-3
"""Velocity at which lost motion is stated [m/s]: 0.3 m/min, at which positioning tests approach their targets."""

NOTICED = 1e-7
"""Lost motion that a laser interferometer on a machine tells from none [m]."""

CURE = (
    "stiffen it or lower its friction (preload, alignment, lubrication), close the position loop by a scale, or use "
    "friction feed-forward"
)
"""What lessens wind-up."""


@dataclass(frozen=True)
class LostMotion:
    """Lost motion of a plant in slow motion.

    Attributes:
        width: of the free play [m].
        wind_up: u [m].
        force: of friction at the table, mean of both directions [N].
        weight: force on the table that does not turn with the direction, such as gravity [N]; positive to -.
        torque: of friction that the motor feels, mean of both directions [N m].
        holding: acceleration up to which friction keeps the table on its flank [m/s^2].
    """

    width: float
    wind_up: float
    force: float
    weight: float
    torque: float
    holding: float

    @property
    def rests(self) -> bool:
        """Whether a steady force holds the table on one flank in both directions, so that its play does not show."""
        return abs(self.weight) > self.force

    @property
    def play(self) -> float:
        """w [m], as far as it shows in slow motion."""
        return 0.0 if self.rests else self.width


def without_play(plant: Plant) -> Plant:
    """The plant with neither play nor travel errors: what is left of its lost motion is wind-up."""
    kept = tuple(
        one
        for one in plant.effects
        if not isinstance(one, TravelEffect) and not (isinstance(one, TransmissionEffect) and one.has_play)
    )
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
    radius, bare = plant.chain.motor_radius, without_play(plant)
    forward, reverse = steady_motions(bare, (SLOW, -SLOW), at)
    lags = [radius * float(one.state[0]) - at for one in (forward, reverse)]
    torque = 0.5 * (forward.torque - reverse.torque)
    # by virtual work: what the motor need not give where nothing acts on the table
    free = replace(bare, effects=tuple(one for one in bare.effects if not _acts_on_table(one)))
    unloaded = steady_motions(free, (SLOW, -SLOW), at)
    ahead, back = ((one.torque - two.torque) / radius for one, two in zip((forward, reverse), unloaded, strict=True))
    force, weight = max(0.5 * (ahead - back), 0.0), 0.5 * (ahead + back)
    mass = float(plant.chain_values()["table_mass"])
    holding = force / mass if mass > 0 else math.inf
    return LostMotion(declared_play(plant), lags[0] - lags[1], force, weight, torque, holding)


def _acts_on_table(effect: Effect) -> bool:
    return effect.port is Port.TABLE and isinstance(effect, FrictionEffect | SourceEffect)


def wind_up_words(lost: LostMotion) -> str:
    """What the wind-up is, in a sentence without its full stop."""
    cause = f"friction of {lost.torque:.2g} N m at the motor winds up the springs"
    if lost.force > 0:
        cause = f"friction (table {lost.force:.3g} N, {lost.torque:.2g} N m at the motor) winds up the springs"
    return f"{format_quantity(lost.wind_up, 'm')} of the lost motion is wind-up, not play: {cause}"


def refuse_wind_up(lost: LostMotion, where: str, least: float) -> None:
    """Refuse a table for lost motion without a play above `least` [m], the step of the control.

    The InputError says what the lost motion is, and its cure.
    """
    if lost.play >= least:
        return
    if lost.width >= least:
        raise InputError(f"no table is written: {resting_words(lost)}", where, "renew the preload, or leave it")
    if abs(lost.wind_up) < NOTICED:
        what = f"no lead error and no play of {format_quantity(least, 'm')} or more is known of this axis"
        raise InputError(what, where, "diagnose a recording over the whole stroke, and give its folder")
    raise InputError(f"no table is written: {wind_up_words(lost)}", where, CURE)


def resting_words(lost: LostMotion) -> str:
    """Why a play does not show, as a sentence without its full stop."""
    return (
        f"the play of {format_quantity(lost.width, 'm')} does not show in slow motion, as {abs(lost.weight):.3g} N "
        "hold the table on one flank against its friction; a backlash value would put it in"
    )


def flank_words(lost: LostMotion) -> str:
    """Up to which acceleration a backlash value holds, as a sentence."""
    if not np.isfinite(lost.holding):
        return ""
    return (
        f"Friction holds the table on its flank up to {lost.holding:.2g} m/s^2; braked harder it crosses the play by "
        "its inertia, and no value tells on which side it stops: renew the preload."
    )
