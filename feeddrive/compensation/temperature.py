"""Thermal compensation that a control takes: K0 and tan beta over the one sensor that predicts best.

    dK(x, T) = K0(T) + tan beta(T) (x - P0)        error = actual - target

| symbol | meaning | unit |
|---|---|---|
| K0, P0 | error at the reference position, and that position | m |
| tan beta | error per length | m/m |
| T | reading of the sensor, its lag included | degC |

Of a machine that declares heat: the table is fitted to warm-ups and cool-downs at a quarter, half and the whole of its
highest speed on the reduced model; the sensor is chosen on a random duty; reported is a warm-up and cool-down at
0.7 of the highest speed on the full model, which nothing was fitted to. Of a recording: fitted to its first part, the
sensor chosen and judged on the rest. The error is that of an axis that reads its position at the motor.
"""

from __future__ import annotations

import re
from collections.abc import Mapping
from dataclasses import dataclass

import numpy as np

from feeddrive.compensation.heat.thermal_error import LeftOver, compensation_model, left_over
from feeddrive.compensation.heat.thermal_line import LineTable, line_table
from feeddrive.compensation.heat.thermal_sensors import Sensor, lagged, mountable_places
from feeddrive.compensation.heat.thermal_trial import TriedMachine, random_duty, tried_machine
from feeddrive.errors import InputError
from feeddrive.recording.recording import Recording
from feeddrive.thermal.machine_heat import Heat
from feeddrive.thermal.reduced.parametric_model import HeatModel
from feeddrive.typing import FloatArray
from feeddrive.units.quantity import percent

STEP = 60.0
"""Row of the duties [s]; a sensor of 60 s follows within it."""

FITTED_SPEEDS, JUDGED_SPEED = (0.25, 0.5, 1.0), 0.7
"""Shares of the highest speed."""

FITTED_PART = 0.6
"""Share of a recording that is fitted: the warm-up and some of what follows must be in it."""

_HOURS, _SEED, _POINTS = 4, 7, 8
_GROWTH = re.compile(r"table_growth_([0-9]+(?:\.[0-9]+)?)mm")


@dataclass(frozen=True, eq=False)
class HeatTable:
    """A table over one sensor and what it leaves.

    Attributes:
        name: of the machine or recording.
        sensor: the chosen one.
        table: K0 and tan beta over its reading; positions as in `positions`.
        left: error before and after on the judged motion.
        judged: what that motion is, in words.
        ranking: sensor to the share of the rms error that its table leaves, best first.
        times: of the judged motion [s], (k,).
        positions: along the stroke [m], (p,).
        before, after: error of the judged motion, (k, p) [m].
    """

    name: str
    sensor: str
    table: LineTable
    left: LeftOver
    judged: str
    ranking: Mapping[str, float]
    times: FloatArray
    positions: FloatArray
    before: FloatArray
    after: FloatArray


def heat_table(heat: Heat, reference: float | None = None) -> HeatTable:
    """The table of a machine that declares heat, about P0, a position of the nut [m], or the low end of its travel.

    Raises InputError: a nut that does not travel, or sensors that hardly get warm.
    """
    travel = heat.rig.travel
    if not travel.high > travel.low:
        raise InputError("the nut does not travel", heat.name, "declare travel in [thermal] from low to high")
    p0 = travel.low if reference is None else reference
    reduced, rows, top = compensation_model(heat), round(_HOURS * 3600 / STEP), heat.highest_speed
    fitted = [_tried(heat, reduced, np.repeat([share * top, 0.0], rows)) for share in FITTED_SPEEDS]
    duty = random_duty(np.random.default_rng(_SEED), 2 * rows, top * np.array([0.3, 0.6, 0.9]), 90)
    chosen_on = _tried(heat, reduced, duty)
    tables: dict[str, LineTable] = {}
    ranking: dict[str, float] = {}
    for place in mountable_places(heat):
        readings = np.concatenate([_reading(heat, one, place) for one in fitted])
        if float(np.ptp(readings)) <= 0.5:
            continue
        errors = np.vstack([one.error for one in fitted])
        tables[place] = line_table(readings, errors, fitted[0].positions, p0, _POINTS)
        ranking[place] = _share(_left(heat, tables[place], chosen_on, place)[0])
    if not tables:
        raise InputError("no sensor gets half a kelvin warm", heat.name, "there is nothing to compensate")
    best = min(ranking, key=lambda place: ranking[place])
    judged = _tried(heat, heat.full_model(), np.repeat([JUDGED_SPEED * top, 0.0], rows))
    left, after = _left(heat, tables[best], judged, best)
    words = f"warm-up and cool-down of {_HOURS} h each at {JUDGED_SPEED:g} of the highest speed, not fitted"
    ordered = dict(sorted(ranking.items(), key=lambda one: one[1]))
    return HeatTable(
        heat.name, best, tables[best], left, words, ordered, judged.times, judged.positions, judged.error, after
    )


def _tried(heat: Heat, model: HeatModel, speeds: FloatArray) -> TriedMachine:
    return tried_machine(heat, model, STEP, speeds, np.full(len(speeds), heat.ambient))


def _reading(heat: Heat, machine: TriedMachine, place: str) -> FloatArray:
    return np.asarray(heat.ambient + lagged(machine.rises[place], STEP, Sensor(place).lag))


def _left(heat: Heat, table: LineTable, machine: TriedMachine, place: str) -> tuple[LeftOver, FloatArray]:
    corrected = table.line(_reading(heat, machine, place)).at(machine.positions)
    return left_over(machine.error, corrected), np.asarray(machine.error - corrected)


def _share(left: LeftOver) -> float:
    return left.rms_after / left.rms_before if left.rms_before > 0 else 1.0


def recorded_heat_table(recording: Recording, reference: float | None = None) -> HeatTable:
    """The table of a recording of temperatures and growth, about P0 [m], or the least position.

    `table_growth_<position>mm` at two positions or more is actual minus target; the sensors are `*_temperature`. Raises
    InputError: too few of either, or a sensor that hardly moves.
    """
    growths = sorted(
        (float(match[1]) * 1e-3, name) for name in recording.channels if (match := _GROWTH.fullmatch(name))
    )
    sensors = [name for name in recording.channels if name.endswith("_temperature")]
    if len(growths) < 2 or not sensors:
        mend = "record table_growth_100mm, table_growth_400mm and nut_temperature, or the like"
        raise InputError(f"{len(growths)} growths and {len(sensors)} temperatures", recording.name, mend)
    positions = np.array([x for x, _ in growths])
    error = np.column_stack([recording[name] for _, name in growths])
    error = error - error[0]
    split = round(FITTED_PART * len(recording))
    p0 = float(positions[0]) if reference is None else reference
    tables, ranking, left = {}, {}, {}
    for name in sensors:
        readings = recording[name]
        if float(np.ptp(readings[:split])) <= 0.5:
            continue
        tables[name] = line_table(readings[:split], error[:split], positions, p0, _POINTS)
        left[name] = left_over(error[split:], tables[name].line(readings[split:]).at(positions))
        ranking[name] = _share(left[name])
    if not tables:
        raise InputError("no temperature moves by half a kelvin", recording.name, "record a warm-up")
    best = min(ranking, key=lambda name: ranking[name])
    after = error[split:] - tables[best].line(recording[best][split:]).at(positions)
    words = f"the last {percent(1 - FITTED_PART)} of the recording, not fitted"
    ordered = dict(sorted(ranking.items(), key=lambda one: one[1]))
    return HeatTable(recording.name, best, tables[best], left[best], words, ordered, recording.time[split:],
                     positions, error[split:], after)  # fmt: skip
