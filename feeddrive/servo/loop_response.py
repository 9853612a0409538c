"""Responses of the loops that a cascade closes over a plant: open with margins, closed with bandwidth and peak.

| loop | open, cut at | closed, from -> to |
|---|---|---|
| velocity | torque command | speed set-point -> measured speed |
| position | position error | position set-point -> measured position, without feed-forward |

Sampled as the drive samples them, up to half their sample rate; dead time and delay are exact (`servo.linear_loop`).
"""

from __future__ import annotations

import math
from dataclasses import dataclass, replace
from enum import StrEnum
from typing import TYPE_CHECKING

import numpy as np

from feeddrive.errors import InputError
from feeddrive.plant.analysis.ode import INPUTS
from feeddrive.plant.plant import Plant
from feeddrive.servo.cascade import Cascade, FeedForward
from feeddrive.servo.cascade_function import REFERENCES
from feeddrive.servo.linear_loop import (
    closed_loop,
    closed_velocity_loop,
    open_position_loop,
    open_velocity_loop,
    worst_eigenvalue,
)
from feeddrive.servo.margins import GROWTH, Margins, frequency_response, margins
from feeddrive.servo.mechanics_response import UNITS, Case, Response, grid, refuse_no_range, refuse_unknown
from feeddrive.typing import FloatArray

if TYPE_CHECKING:
    import control

_LOOP_UNITS = UNITS | {
    "position": "m",
    "velocity": "m/s",
    "acceleration": "m/s^2",
    "speed_excitation": "rad/s",
    "torque_excitation": "N m",
    "measured_position": "m",
    "measured_speed": "rad/s",
    "speed_command": "rad/s",
    "position_error": "m",
    "unlimited_torque": "N m",
}
GIVEN = (*REFERENCES, INPUTS[1])
"""What a closed loop may be driven by: references of the cascade, cutting force."""

SHOWN = (
    "motor_angle",
    "motor_speed",
    "table_position",
    "table_velocity",
    "position_error",
    "speed_command",
    "measured_speed",
    "unlimited_torque",
    "measured_position",
)
"""What of a closed loop may be looked at."""


class Loop(StrEnum):
    """A loop of the cascade."""

    VELOCITY = "velocity"
    POSITION = "position"


@dataclass(frozen=True)
class ClosedFigures:
    """What is read off a closed loop.

    Attributes:
        bandwidth: where the response has fallen by 3 dB for the first time [Hz]; NaN if it never does.
        peak: largest magnitude relative to that at the lowest frequency [dB].
        peak_frequency: where [Hz].
    """

    bandwidth: float
    peak: float
    peak_frequency: float


def loops_of(cascade: Cascade) -> tuple[Loop, ...]:
    """The loops that a cascade closes.

    Raises:
        InputError: it closes none.
    """
    if not cascade.velocity_gain:
        raise InputError("the controller closes no loop", "controller", "give it a velocity_gain")
    return (Loop.VELOCITY, Loop.POSITION) if cascade.position_gain else (Loop.VELOCITY,)


def open_response(
    plant: Plant, cascade: Cascade, loop: Loop, case: Case, low: float, high: float
) -> tuple[Response, Margins]:
    """The open loop between two frequencies [Hz], and its margins up to half its sample rate.

    Raises:
        InputError: frequencies that are no range, or as `linear_loop`.
    """
    make = open_velocity_loop if loop is Loop.VELOCITY else open_position_loop
    system = make(case.on(plant), cascade, case.velocity, case.position)
    name = f"{loop} loop, open"
    return _response(system, name, name, "1", low, high), margins(system)


def closed_response(plant: Plant, cascade: Cascade, loop: Loop, case: Case, low: float, high: float) -> Response:
    """The closed loop from its set-point to what it measures.

    Raises:
        InputError: as `open_response`.
    """
    if loop is Loop.VELOCITY:
        system = closed_velocity_loop(case.on(plant), cascade, case.velocity, case.position)
        return _response(system, "speed_set_point", "measured_speed", "1", low, high)
    bare = replace(cascade, feed_forward=FeedForward(), balancing_time=0.0)
    system = closed_loop(case.on(plant), bare, case.velocity, case.position)["measured_position", "position"]
    return _response(system, "position_set_point", "measured_position", "1", low, high)


def controlled_response(
    plant: Plant, cascade: Cascade, given: str, output: str, case: Case, low: float, high: float
) -> Response:
    """The controlled axis from any of `GIVEN` to any of `SHOWN`, such as the cutting force to the table position.

    Feed-forward acts on the velocity and acceleration alone, which are references of their own here.

    Raises:
        InputError: an unknown channel, or as `open_response`.
    """
    refuse_unknown(given, GIVEN, "--from")
    refuse_unknown(output, SHOWN, "--to")
    system = closed_loop(case.on(plant), cascade, case.velocity, case.position)[output, given]
    top, bottom = _LOOP_UNITS[output], _LOOP_UNITS[given]
    unit = "1" if top == bottom else "/".join(f"({one})" if set(one) & {" ", "/"} else one for one in (top, bottom))
    return _response(system, given, output, unit, low, high)


def refuse_unstable_case(plant: Plant, cascade: Cascade, case: Case, where: str) -> None:
    """Refuse a loop that is unstable in a case.

    Raises:
        InputError: it is; names the eigenvalue.
    """
    value, growth, frequency = worst_eigenvalue(case.on(plant), cascade, case.velocity, case.position)
    if growth > GROWTH:
        what = f"the loop is unstable: eigenvalue {value:.4g} grows by {growth:.3g} 1/s at {frequency:.0f} Hz"
        raise InputError(what, where, "lower position_gain or velocity_gain; `feeddrive tune` recommends some")


def closed_figures(response: Response) -> ClosedFigures:
    """Bandwidth and peak of a closed loop."""
    relative = response.decibel - response.decibel[0]
    below = np.flatnonzero(relative < -3.0)
    place = int(np.argmax(relative))
    bandwidth = _crossing(response.frequency, relative, int(below[0])) if len(below) else math.nan
    return ClosedFigures(bandwidth, float(relative[place]), float(response.frequency[place]))


def _crossing(frequency: FloatArray, relative: FloatArray, index: int) -> float:
    pair = slice(index - 1, index + 1)
    return float(np.exp(np.interp(3.0, -relative[pair], np.log(frequency[pair]))))


def _response(system: control.StateSpace, given: str, output: str, unit: str, low: float, high: float) -> Response:
    refuse_no_range(low, high)
    highest = min(high, 0.5 / float(system.dt))
    refuse_no_range(low, highest)
    frequency = grid(low, highest)
    return Response(given, output, unit, frequency, frequency_response(system, frequency))
