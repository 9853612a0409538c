"""What is asked of a tuned cascade, and the cases in which it must hold."""

from __future__ import annotations

import itertools
from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np

from feeddrive.effects.base import Port
from feeddrive.errors import InputError
from feeddrive.plant.analysis.rest import ports_without_presliding
from feeddrive.plant.analysis.steady import MOVING
from feeddrive.plant.plant import Plant
from feeddrive.servo.mechanics_response import Case, Friction

PHASE, GAIN = 45.0, 8.0
"""Usual margins of automatic tuning in drives: 45 degrees and 8 dB."""

POSITIONS = 3
"""Table positions along the stroke, where the chain depends on them: the stiffest and softest are at ends or middle."""


@dataclass(frozen=True)
class Demand:
    """Margins that must hold in every case.

    Attributes:
        phase: least phase margin of either loop [deg].
        gain: least gain margin of either loop [dB].
        magnification: most by which the closed position loop may magnify a set-point, at the encoder and at the table
            [dB]; near 0, since a contour must not be overshot.

    Raises:
        InputError: a margin outside the range in which it has a meaning.
    """

    phase: float = PHASE
    gain: float = GAIN
    magnification: float = 0.1

    def __post_init__(self) -> None:
        if not 0 < self.phase < 90:
            what = f"a phase margin of {self.phase:g}° is not between 0° and 90°"
            raise InputError(what, "--margin-phase", "usual are 45° to 60°")
        if not 0 < self.gain < 60:
            raise InputError(
                f"a gain margin of {self.gain:g} dB is not between 0 dB and 60 dB",
                "--margin-gain",
                "usual are 6 dB to 12 dB",
            )


def cases_of(
    plant: Plant, positions: Sequence[float] = (), payloads: Sequence[float] = (), velocity: float = MOVING
) -> tuple[Case, ...]:
    """Every position of the table [m] with every payload beyond the declared one [kg], at a velocity [m/s].

    Without positions along the stroke where the chain depends on it, else mid-stroke. Raises InputError for a position
    off the screw or outside the stroke.
    """
    places = tuple(positions) or _along_stroke(plant)
    for place in places:
        plant.refuse_off_stroke(place, "--positions")
    return tuple(Case(place, velocity, mass) for place, mass in itertools.product(places, tuple(payloads) or (0.0,)))


def operating_points(
    plant: Plant, positions: Sequence[float] = (), payloads: Sequence[float] = (), velocity: float = MOVING
) -> tuple[Case, ...]:
    """Where the margins of a tuned cascade have to hold: every position with every payload, in motion and at rest.

    In motion friction acts by its small slope over the speed. At rest a declared bristle acts by its stiffness; where
    none is declared, friction is known to lie between two limits, and the margins have to hold in both: nothing holds
    the table, and nothing moves it, when the motor turns against the screw alone (`plant.analysis.rest`).

    Args, raises: as `cases_of`.
    """
    moving = cases_of(plant, positions, payloads, velocity)
    if not velocity:
        return moving
    creeping = ports_without_presliding(plant)
    freely = Friction.FREE if creeping else Friction.DECLARED
    rest = [replace(case, velocity=0.0, friction=freely) for case in moving]
    if Port.TABLE in creeping:  # of a table that is held no payload shows
        places = dict.fromkeys(case.position for case in moving)
        rest += [Case(place, 0.0, 0.0, Friction.HELD) for place in places]
    return (*moving, *rest)


def _along_stroke(plant: Plant) -> tuple[float, ...]:
    if plant.stroke is None or not plant.chain.varies:
        return (plant.middle,)
    return tuple(float(place) for place in np.linspace(*plant.stroke, POSITIONS))
