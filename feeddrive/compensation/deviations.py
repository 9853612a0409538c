"""Deviations of the table along the stroke, of a plant with lead errors and of a recording with a scale.

Of a plant, from the very effects that act in its simulation:

    d+- = delta(p / r, p) -+ w / 2

| symbol | meaning | unit |
|---|---|---|
| delta | sum of the travel deviations at screw angle and table position (`plant.transmission_law`) | m |
| p, r | target, travel per screw angle | m, m/rad |
| w | play, `compensation.lost_motion` | m |

Valid for an axis whose position loop reads the motor encoder. Deviations over time are heat, and in no table of
positions; wind-up is none either.

Of a recording with a scale, the lead error as measured:

    y = x - r theta  or, standing,  y = x - x_set;     y = m(p) + h d / 2 + offset

| symbol | meaning | unit |
|---|---|---|
| x, theta, x_set | table position by the scale, motor angle, set-point | m, rad, m |
| r | nominal travel per motor angle | m/rad |
| m(p) | mean deviation of both directions at the position that the control indicates | m |
| h, d | difference of the directions, direction of motion (1 or -1) | m, 1 |

Only samples in steady motion that have crossed what the directions differ by count (with the motor angle), or the ends
of stand-stills (with the set-point alone). h holds play and wind-up alike: a recording by itself does not tell them
apart, so h goes into no table.
"""

from __future__ import annotations

import math
from dataclasses import dataclass, replace

import casadi as ca
import numpy as np

from feeddrive.compensation.lost_motion import declared_play
from feeddrive.compensation.table import PER_INTERVAL, Deviations, straight_pieces
from feeddrive.effects.base import TravelEffect, number
from feeddrive.effects.tabulated import TabulatedTravel
from feeddrive.effects.travel.lead_error_periodic import LeadErrorPeriodic
from feeddrive.effects.travel.thermal_growth import ThermalGrowth
from feeddrive.errors import InputError
from feeddrive.plant.plant import Plant
from feeddrive.plant.structure import parameter_symbols, parameter_values
from feeddrive.plant.transmission_law import travel_deviation
from feeddrive.recording.recording import Recording
from feeddrive.symbolic_turn import SYMBOLS
from feeddrive.typing import BoolArray, FloatArray
from feeddrive.units.quantity import format_quantity

_LEAST, _MOST = 2001, 40_001


@dataclass(frozen=True, eq=False)
class PlantDeviations:
    """What a table may be made of.

    Attributes:
        known: deviations along the stroke.
        shortest: shortest period of a lead error along the stroke [m]; infinite where none is periodic.
        of_time: names of travel errors that change with time, which no table of positions holds.
    """

    known: Deviations
    shortest: float
    of_time: tuple[str, ...]


def changes_with_time(effect: TravelEffect) -> bool:
    """Whether a travel error is one of heat."""
    return isinstance(effect, ThermalGrowth) or (isinstance(effect, TabulatedTravel) and effect.place == "time")


def plant_deviations(plant: Plant, ends: tuple[float, float]) -> PlantDeviations:
    """Deviations of a plant between two positions [m]."""
    travel = [one for one in plant.effects if isinstance(one, TravelEffect)]
    shortest = min((_period(one, plant.chain.radius) for one in travel), default=math.inf)
    count = int(np.clip(2 * PER_INTERVAL * (ends[1] - ends[0]) / shortest, _LEAST, _MOST))
    positions = np.linspace(ends[0], ends[1], count)
    lead = lead_deviation(plant, positions)
    play = declared_play(plant)
    timed = tuple(one.name for one in travel if changes_with_time(one))
    return PlantDeviations(Deviations(positions, lead - play / 2, lead + play / 2), shortest, timed)


@SYMBOLS.taken()
def lead_deviation(plant: Plant, positions: FloatArray) -> FloatArray:
    """Travel deviation delta at positions of the table [m], those over time left out, shape (n,) [m]."""
    kept = tuple(one for one in plant.effects if not (isinstance(one, TravelEffect) and changes_with_time(one)))
    still = replace(plant, effects=kept)
    symbols, x = parameter_symbols(still), ca.SX.sym("x")
    delta = travel_deviation(still, symbols, x / still.chain.radius, x, ca.SX(0))
    function = ca.Function("delta", [x, symbols.vector], [delta])
    values = function(positions.reshape(1, -1), ca.DM(parameter_values(still)))
    return np.asarray(values.full()).ravel()


def _period(effect: TravelEffect, radius: float) -> float:
    """Period of a travel error along the stroke, or twice the distance of a table's points [m]."""
    if isinstance(effect, LeadErrorPeriodic):
        return 2 * math.pi * radius / number(effect.values["order"])
    if isinstance(effect, TabulatedTravel) and not changes_with_time(effect) and len(effect.breakpoints) > 1:
        return 2 * float(np.min(np.diff(effect.breakpoints)))
    return math.inf


_QUIET = 0.05
"""s: over which a velocity is read, and at the end of a stand-still."""

_STEADY = 0.1
"""Share by which the velocity may change over that time in steady motion; beyond it inertia winds up the springs."""

_STANDING = 1e-5
"""m/s: slower is standing."""

TURNED = 3.0
"""Travel after a reversal, over what the directions differ by, from which a sample counts: play is crossed after one
such difference, and what friction winds up after as much again; noise takes the rest."""

_BINS_PER_REVOLUTION = 16

_ENOUGH = 0.1
"""Least share of the usual number of samples between two points; at the ends of strokes, where the axis
brakes, fewer lie."""


@dataclass(frozen=True, eq=False)
class RecordedDeviations:
    """What a recording tells.

    Attributes:
        known: mean deviation of both directions, in both.
        difference: h, reverse less forward [m]; None where only one direction was recorded.
        scatter: of single samples about what is known, rms [m].
        from_motor: whether the motor angle was compared, and not the set-point.
        ends: least and greatest position [m].
    """

    known: Deviations
    difference: float | None
    scatter: float
    from_motor: bool
    ends: tuple[float, float]


def recorded_deviations(recording: Recording, radius: float | None, period: float | None = None) -> RecordedDeviations:
    """The mean deviation along the stroke of `table_position` from `motor_angle`, or a `setpoint` with stand-stills.

    `radius` is the nominal travel per motor angle [m/rad], None to compare the set-point; `period` that of the screw
    along the stroke [m], None for the distance of the stand-stills. Raises InputError: no scale, no comparison, or too
    little motion.
    """
    if "table_position" not in recording:
        raise InputError("there is no table_position", recording.name, "record the scale, or give a diagnosis")
    if radius is not None and "motor_angle" in recording:
        at = radius * recording["motor_angle"]
        offset = float(np.median(recording["table_position"] - at))
        indicated, error = at + offset, recording["table_position"] - at - offset
        chosen, direction = _steady(recording, indicated)
        if not chosen.any():
            raise InputError("nothing moves steadily", recording.name, "record slow strokes at constant velocity")
        found = _solved(recording, indicated[chosen], error[chosen], direction[chosen], period, True)
        crossed = chosen & (_since_reversal(indicated, direction) > TURNED * abs(found.difference or 0.0))
        if not crossed.any() or np.array_equal(crossed, chosen):
            return found
        return _solved(recording, indicated[crossed], error[crossed], direction[crossed], period, True)
    if "setpoint" not in recording:
        has = "motor_angle and no lead is given" if "motor_angle" in recording else "neither motor_angle nor setpoint"
        raise InputError(f"it has {has}", recording.name, 'write --lead "20 mm" with motor_angle, or record setpoint')
    places, values, ways = _stops(recording)
    return _solved(recording, places, values, ways, None, False)


def _steady(recording: Recording, indicated: FloatArray) -> tuple[BoolArray, FloatArray]:
    """Samples in steady motion, and the direction of each."""
    half = max(1, round(_QUIET / recording.sample_time / 2))
    if len(indicated) < 6 * half:
        raise InputError("the recording is too short", recording.name, f"record {6 * _QUIET:g} s or more")
    ahead, behind = np.roll(indicated, -half), np.roll(indicated, half)
    velocity = (ahead - behind) / (2 * half * recording.sample_time)
    velocity[:half], velocity[-half:] = 0.0, 0.0
    before, after = np.roll(velocity, half), np.roll(velocity, -half)
    change = np.abs(after - before)
    chosen: BoolArray = (np.abs(velocity) > _STANDING) & (change < _STEADY * np.abs(velocity))
    chosen[: 2 * half], chosen[-2 * half :] = False, False
    return chosen, np.sign(velocity)


def _since_reversal(indicated: FloatArray, direction: FloatArray) -> FloatArray:
    """Travel since the direction last turned [m], (n,); that since the beginning before it does."""
    turned = np.concatenate([[True], direction[1:] != direction[:-1]])
    last = np.maximum.accumulate(np.where(turned, np.arange(len(indicated)), 0))
    travel: FloatArray = np.abs(indicated - indicated[last])
    return travel


def _stops(recording: Recording) -> tuple[FloatArray, FloatArray, FloatArray]:
    """Targets, deviations and directions of approach of the stand-stills."""
    setpoint, position = recording["setpoint"], recording["table_position"]
    count = max(2, round(_QUIET / recording.sample_time))
    still = np.concatenate([[False], np.abs(np.diff(setpoint)) < _STANDING * recording.sample_time])
    edges = np.flatnonzero(np.diff(np.concatenate([[0], still.astype(int), [0]])))
    places, values, ways = [], [], []
    previous = None
    for start, end in zip(edges[::2], edges[1::2], strict=True):
        if end - start < 2 * count:
            continue
        target = float(setpoint[end - 1])
        if previous is not None and target != previous:
            places.append(target)
            values.append(float(np.mean(position[end - count : end])) - target)
            ways.append(float(np.sign(target - previous)))
        previous = target
    if len(set(places)) < 2:
        what = "the set-point stands at fewer than two targets"
        raise InputError(what, recording.name, 'drive a staircase over the stroke, or give --lead "20 mm"')
    return np.array(places), np.array(values), np.array(ways)


def _solved(
    recording: Recording,
    places: FloatArray,
    values: FloatArray,
    ways: FloatArray,
    period: float | None,
    from_motor: bool,
) -> RecordedDeviations:
    """Mean deviation at nodes and the difference of the directions, by least squares in turn."""
    low, high = float(places.min()), float(places.max())
    width = high - low
    if from_motor:
        bins = 200 if period is None else int(np.clip(_BINS_PER_REVOLUTION * width / period, 2, 20_000))
        nodes = _filled(np.linspace(low, high, bins + 1), places)
    else:
        nodes = np.unique(places)
    if not width > 0 or len(nodes) < 2:
        raise InputError("the axis hardly moves", recording.name, "record strokes over the whole travel")
    inside = (places >= nodes[0]) & (places <= nodes[-1])
    places, values, ways = places[inside], values[inside], ways[inside]
    both = bool(np.any(ways > 0) and np.any(ways < 0))
    half, mean = 0.0, np.zeros(len(nodes))
    for _ in range(30 if both else 1):
        mean = straight_pieces(places, values + half * ways, nodes)
        left = values - np.interp(places, nodes, mean)
        # d' (I - P) d h = d' (I - P) y would be exact; taken in turn it is the same where the rounds settle
        step = -float(np.mean((left + half * ways) * ways)) if both else 0.0
        half += step
        if abs(step) < 1e-12:
            break
    rest = values - np.interp(places, nodes, mean) + half * ways
    difference = 2 * half if both else None
    scatter = float(np.std(rest))
    ends = (float(nodes[0]), float(nodes[-1]))
    return RecordedDeviations(Deviations(nodes, mean, mean.copy()), difference, scatter, from_motor, ends)


def _filled(nodes: FloatArray, places: FloatArray) -> FloatArray:
    """Nodes that samples lie beside, on both sides where there are two; stretches in between are straight."""
    count = np.histogram(places, nodes)[0]
    enough = count >= _ENOUGH * np.median(count[count > 0])
    inner = np.concatenate([[True], enough]) & np.concatenate([enough, [True]])
    kept = inner & np.concatenate([[enough[0]], enough[:-1] | enough[1:], [enough[-1]]])
    return np.asarray(nodes[kept])


def difference_words(found: RecordedDeviations) -> str:
    """Remarks on the difference of the directions."""
    if found.difference is None:
        return "Only one direction was recorded: the table is the same in both."
    shown = format_quantity(found.difference, "m")
    return (
        f"Between the directions {shown} differ. A recording alone does not tell play from wind-up by friction, so "
        "it is in no table: diagnose the recording and give that folder."
    )
