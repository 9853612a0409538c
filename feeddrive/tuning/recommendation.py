"""A recommended cascade, checked with the loop itself in every case, each setting with its why.

Order: velocity loop with its filters, then the position loop around it. Gains are rounded as they will be written and
lowered until every case holds, by the margins and eigenvalues of `servo.linear_loop`. Feed-forward is that of the plant
and changes no margin. Valid for small motion about a moving table and about one that friction holds: limits and
reversals are not in it.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace
from typing import TYPE_CHECKING

from feeddrive.errors import InputError
from feeddrive.plant.analysis.modes import inertia_at_motor
from feeddrive.plant.plant import Plant
from feeddrive.servo.cascade import Cascade, FeedForward
from feeddrive.servo.linear_loop import open_position_loop, open_velocity_loop, worst_eigenvalue
from feeddrive.servo.margins import GROWTH, Margins, margins
from feeddrive.servo.mechanics_response import Case
from feeddrive.tuning.demand import Demand
from feeddrive.tuning.filter_choice import NO_LIMITS, FilterLimits
from feeddrive.tuning.largest_gain import GainLimit
from feeddrive.tuning.position_loop import position_gain
from feeddrive.tuning.velocity_loop import VelocityGains, velocity_gains

if TYPE_CHECKING:
    import control

USABLE = 1.0
"""Least K_v worth recommending [1/s]; machine tools have 10 to 100."""

_LOWERED, _SLOWED = 0.98, 0.99
_TRIES = 12
_POINTS = 4000
"""Points of the frequency grid of margins; 5 times fewer than usual, and still 0.3 % of frequency apart."""


@dataclass(frozen=True)
class Reached:
    """What a recommended cascade reaches in one case.

    Attributes:
        case: position, velocity, payload.
        velocity, position: margins of the open loops.
        growth: of the worst eigenvalue of the whole loop, below 0 where stable [1/s].
    """

    case: Case
    velocity: Margins
    position: Margins
    growth: float


@dataclass(frozen=True)
class Recommendation:
    """A recommended cascade and how it was found.

    Attributes:
        cascade: the settings, as they are written.
        demand: what was asked.
        velocity: of the search for the velocity loop, before rounding.
        position: of the search for the position loop, before rounding.
        reached: margins in every case, by the loop itself.
    """

    cascade: Cascade
    demand: Demand
    velocity: VelocityGains
    position: GainLimit
    reached: tuple[Reached, ...]

    @property
    def worst(self) -> tuple[Reached, Reached]:
        """Cases of least phase margin of the velocity loop and of least gain margin of the position loop."""
        phase = min(self.reached, key=lambda one: one.velocity.phase)
        return phase, min(self.reached, key=lambda one: one.position.gain)


def recommend(
    plant: Plant, drive: Cascade, cases: Sequence[Case], demand: Demand, limits: FilterLimits = NO_LIMITS
) -> Recommendation:
    """The recommended cascade.

    Args:
        plant: the machine.
        drive: rates, current loop, dead time, feedback, limits and filters that stay; its gains are replaced.
        cases: in which the demand must hold; at least one.
        demand: margins.
        limits: what filters the drive has.

    Raises:
        InputError: no gains hold; says which loop, and what would.
    """
    bare = replace(drive, velocity_gain=0.0, position_gain=0.0, feed_forward=FeedForward(), balancing_time=0.0)
    found = velocity_gains(plant, bare, cases, demand, limits)
    reset = _rounded(found.reset_time)
    with_velocity = replace(
        bare,
        velocity_gain=_rounded(found.gain),
        reset_time=reset,
        tracking_time=reset,
        torque_filters=(*drive.torque_filters, *(choice.filter for choice in found.filters)),
    )
    with_velocity = _lowered_velocity(plant, with_velocity, cases, demand)
    limit = position_gain(plant, with_velocity, cases, demand)
    if limit.gain < USABLE:
        what = f"only K_v = {limit.gain:.2g} 1/s keeps {demand.phase:g}° and {demand.gain:g} dB, which is of no use"
        raise InputError(what, plant.name, "ask for less, or make the drive faster (rates, dead time)")
    complete = replace(with_velocity, position_gain=_rounded(0.995 * limit.gain), feed_forward=_forward(plant))
    cascade, reached = _lowered_position(plant, complete, cases, demand)
    return Recommendation(cascade, demand, found, limit, reached)


def _forward(plant: Plant) -> FeedForward:
    return FeedForward(speed=1.0, torque=1.0, inertia=inertia_at_motor(plant))


def _rounded(value: float) -> float:
    return float(f"{value:.3g}")


def _lowered_velocity(plant: Plant, cascade: Cascade, cases: Sequence[Case], demand: Demand) -> Cascade:
    """The cascade with its velocity loop slowed until the loop itself holds in every case.

    Gain down and reset time up together: the phase margin holds in an interval of gains, which a gain alone may leave
    at its lower end.
    """
    for _ in range(_TRIES):
        every = [_margins(open_velocity_loop(case.on(plant), cascade, case.velocity, case.position)) for case in cases]
        if all(holds(one, demand) for one in every):
            return cascade
        reset = _rounded(cascade.reset_time / _SLOWED)
        cascade = replace(
            cascade, velocity_gain=_rounded(_SLOWED * cascade.velocity_gain), reset_time=reset, tracking_time=reset
        )
    raise _unmet(plant, demand, "velocity")


def _lowered_position(
    plant: Plant, cascade: Cascade, cases: Sequence[Case], demand: Demand
) -> tuple[Cascade, tuple[Reached, ...]]:
    for _ in range(_TRIES):
        reached = tuple(reached_in(plant, cascade, case) for case in cases)
        if all(holds(one.position, demand) and one.growth < GROWTH for one in reached):
            return cascade, reached
        cascade = replace(cascade, position_gain=_rounded(_LOWERED * cascade.position_gain))
    raise _unmet(plant, demand, "position")


def reached_in(plant: Plant, cascade: Cascade, case: Case) -> Reached:
    """What a cascade reaches in a case, by the loop itself."""
    loaded = case.on(plant)
    velocity, position = (
        _margins(make(loaded, cascade, case.velocity, case.position))
        for make in (open_velocity_loop, open_position_loop)
    )
    growth = worst_eigenvalue(loaded, cascade, case.velocity, case.position)[1]
    return Reached(case, velocity, position, growth)


def _margins(loop: control.StateSpace) -> Margins:
    return margins(loop, points=_POINTS)


def holds(found: Margins, demand: Demand) -> bool:
    """Whether margins are what is asked."""
    return found.stable and found.phase >= demand.phase and found.gain >= demand.gain


def _unmet(plant: Plant, demand: Demand, loop: str) -> InputError:
    what = f"the {loop} loop keeps {demand.phase:g}° and {demand.gain:g} dB in no way that was found"
    return InputError(what, plant.name, "ask for less, or make the drive faster (rates, dead time)")
