"""What of E, M and B a plant explains, and by which of its effects.

The plant's motor goes to the targets as a control with a motor encoder sends it, from both sides, and the table's
deviation is read at rest: lead errors, growth, play, and what the springs give way under the friction left at a stop.
The same without one effect says what that effect explains. The zero of a scale is free: the mean difference of
measured and predicted deviations is no error.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace
from itertools import pairwise

import numpy as np

from feeddrive.effects.base import Effect
from feeddrive.engine.step.linear_part import SimulationError
from feeddrive.errors import InputError
from feeddrive.metrology.measured.measurements import LinearTest
from feeddrive.plant.plant import Plant
from feeddrive.simulate.driven import motor_motion, simulate_driven
from feeddrive.typing import FloatArray

SAMPLE = 1e-3
DWELL = 0.25
"""At a target [s], as its last half is read: ten time constants of a nut spring with its damping, and more."""

SPEED = 0.1
"""Fastest approach [m/s]: friction and not inertia loads the spring when the axis comes to rest."""

LEAST_MOVE = 0.1
"""Time of the shortest move [s]."""

OVERRUN = 1e-3
"""Beyond the outer targets [m]: several times any play, and the wind-up of any axis."""


@dataclass(frozen=True)
class Share:
    """Figures [m], and how much of the mean deviations is met.

    Attributes:
        systematic, mean_range, reversal: E, M and B; of one direction E alone, the others 0.
        explains: share of the squared mean deviations that is met [1].
    """

    systematic: float
    mean_range: float
    reversal: float
    explains: float


@dataclass(frozen=True)
class PlantShare:
    """What a plant explains of a positioning test.

    Attributes:
        measured, predicted: figures of the measurement and of the plant alone.
        left: of the measurement less the plant's deviations.
        without: label of an effect to what is left where the plant lacks it.
        up, down: the plant's deviations, (m,) [m].
        creeps: whether declared friction at the table is smooth in speed, so that it lets a wound-up spring relax at
        rest:
            the plant then has no lost motion of its springs, where a bristle would keep it.
    """

    measured: Share
    predicted: Share
    left: Share
    without: dict[str, Share]
    up: FloatArray
    down: FloatArray
    creeps: bool


def plant_share(test: LinearTest, plant: Plant) -> PlantShare:
    """Compare a positioning test with a plant.

    Raises:
        InputError: targets off the plant's screw, or a plant that cannot be followed.
    """
    up, down = predicted_deviations(plant, test.target)
    zero = test.less(np.zeros_like(up), np.zeros_like(down))
    nothing = np.zeros((len(up), 2))
    alone = LinearTest(
        test.target,
        None if test.up is None else nothing + up[:, None],
        None if test.down is None else nothing + down[:, None],
    )
    without: dict[str, Share] = {}
    for effect in plant.effects:
        fewer = _without(plant, effect)
        if fewer is not None:
            without[effect.label or effect.name] = _share(
                test, test.less(*fewer_deviations(fewer, test.target, up, down))
            )
    return PlantShare(
        _share(test, zero), _share(test, alone), _share(test, test.less(up, down)), without, up, down, _creeps(plant)
    )


def _creeps(plant: Plant) -> bool:
    smooth = any(bool(np.any(np.greater(one.values.get("smoothing_velocity", 0.0), 0.0))) for one in plant.effects)
    return smooth and not any(one.name == "presliding" for one in plant.effects)


def fewer_deviations(
    plant: Plant, target: FloatArray, up: FloatArray, down: FloatArray
) -> tuple[FloatArray, FloatArray]:
    """Deviations of a plant with an effect less; those given where it cannot be followed without the effect."""
    try:
        return predicted_deviations(plant, target)
    except InputError:
        return up, down


def _without(plant: Plant, effect: Effect) -> Plant | None:
    """The plant less one effect; None where it needs it."""
    try:
        return replace(plant, effects=tuple(one for one in plant.effects if one is not effect))
    except InputError:
        return None


def _share(test: LinearTest, left: LinearTest) -> Share:
    before, after = _means(test), _means(left)
    power = float(np.sum(before**2))
    explains = (
        round(1 - float(np.sum(after**2)) / power, 9) + 0.0 if power > 0 else 0.0
    )  # + 0.0: no minus before a zero
    both = left.both
    if both is None:
        (side,) = left.sides.values()
        return Share(side.systematic, 0.0, 0.0, explains)
    return Share(both.systematic, both.mean_range, both.reversal_value, explains)


def _means(test: LinearTest) -> FloatArray:
    """Mean deviations of all targets and sides about their mean: the zero of a scale is free."""
    means: FloatArray = np.concatenate([side.mean for side in test.sides.values()])
    return means - float(np.mean(means))


def predicted_deviations(plant: Plant, target: FloatArray) -> tuple[FloatArray, FloatArray]:
    """Deviations of the table at rest with the motor sent to the targets, along + and along -, (m,) [m].

    Raises:
        InputError: as `plant_share`.
    """
    for place in (float(target[0]), float(target[-1])):
        plant.chain.refuse_off_screw(place, f"{plant.name}, targets")
    rising = [*target, target[-1] + OVERRUN]
    places = [target[0] - OVERRUN, *rising, *reversed(target), target[0] - OVERRUN]
    angle, read = _staircase(np.array(places) / plant.chain.motor_radius, plant.chain.motor_radius)
    time: FloatArray = SAMPLE * np.arange(len(angle), dtype=np.float64)
    try:
        run = simulate_driven(plant, motor_motion(time, angle))
    except SimulationError as error:
        raise InputError(f"it cannot be followed through the targets ({error})", plant.name, "check it") from None
    deviation = run.table_position - plant.chain.motor_radius * angle
    at = np.array([float(np.mean(deviation[rows])) for rows in read])
    count = len(target)
    return at[1 : 1 + count], at[2 + count : 2 + 2 * count][::-1]


def _staircase(places: FloatArray, radius: float) -> tuple[FloatArray, Sequence[slice]]:
    """Motor angle through places [rad], with a stop at each, and the samples that are read there."""
    rest = round(DWELL / SAMPLE)
    angle, read = [np.full(rest, places[0])], [slice(rest // 2, rest)]
    begun = rest
    for one, other in pairwise(places):
        # a minimum-jerk move is 1.875 times as fast in its middle as on average
        count = round(max(LEAST_MOVE, 1.875 * abs(other - one) * radius / SPEED) / SAMPLE)
        s = np.arange(1, count + 1) / count
        angle += [one + (other - one) * s**3 * (10 - 15 * s + 6 * s**2), np.full(rest, other)]
        begun += count
        read.append(slice(begun + rest // 2, begun + rest))
        begun += rest
    return np.concatenate(angle), read
