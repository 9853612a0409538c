"""A machine on which a compensation is tried: the full model at other films and heats, on a duty of moves and rests."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace

import numpy as np

from feeddrive.compensation.heat.thermal_error import table_error
from feeddrive.compensation.heat.thermal_sensors import Sensor, mountable_places, simulated_readings
from feeddrive.compensation.heat.thermal_unknowns import deviating
from feeddrive.thermal.machine_heat import Heat
from feeddrive.thermal.reduced.parametric_model import HeatModel
from feeddrive.thermal.rig import refuse_unless
from feeddrive.thermal.run.warm_up import declared_rows, run
from feeddrive.typing import FloatArray

_SUBSTEPS = 4


@dataclass(frozen=True, eq=False)
class TriedMachine:
    """What happened on the machine, at the end of each of k rows.

    Attributes:
        step: length of a row [s].
        speeds: of the screw over each row, (k,) [rad/s].
        ambient: over each row, (k,) [degC].
        positions: along the stroke, (p,) [m].
        error: of the table, (k, p) [m].
        rises: mountable place to its true rise over the start, (k,) each [K].
    """

    step: float
    speeds: FloatArray
    ambient: FloatArray
    positions: FloatArray
    error: FloatArray
    rises: Mapping[str, FloatArray]

    @property
    def times(self) -> FloatArray:
        """Ends of the rows, (k,) [s]."""
        return np.asarray(self.step * np.arange(1.0, len(self.speeds) + 1))

    def readings(self, sensors: Sequence[Sensor], generator: np.random.Generator) -> FloatArray:
        """Readings of sensors with lag and noise, as rises over the start, (k, m) [K]."""
        rises = np.array([self.rises[sensor.place] for sensor in sensors]).reshape(len(sensors), len(self.speeds))
        return simulated_readings(rises.T, self.step, sensors, generator)


def tried_machine(
    plant: Heat, model: HeatModel, step: float, speeds: FloatArray, ambient: FloatArray, *,
    heat: float = 1.0, film: float = 1.0, others: Mapping[str, FloatArray] | None = None,
) -> TriedMachine:  # fmt: skip
    """Run a machine whose heats and films are not as declared, by factors, from a cold start.

    Rows of `step` [s] hold speeds of the screw, (k,) [rad/s], and the true ambient, (k,) [degC]. The model is full, on
    another mesh than that of the compensation; `others` are inputs to heats that the plant does not declare, such as a
    motor's, (k,) [W].
    """
    rows = deviating(declared_rows(plant, step, speeds, ambient), heat, film, film)
    rows = replace(rows, inputs={**rows.inputs, **(others or {})})
    states = run(model, rows, substeps=_SUBSTEPS)
    error = table_error(plant, model)
    rises = {place: states @ model.readings[place] for place in mountable_places(plant)}
    return TriedMachine(step, speeds, ambient, error.positions, error.of(states), rises)


def random_duty(
    generator: np.random.Generator, rows: int, speeds: FloatArray, longest: int, rest: float = 0.3
) -> FloatArray:
    """Speeds of stretches of random length, each a rest or one of `speeds`, (rows,) [rad/s].

    A stretch has `longest` rows at most and a sixth of it at least; `rest` is the probability of a rest.
    """
    refuse_unless(0 <= rest <= 1, f"{rest:g} is no probability", "rest", "write a number from 0 to 1")
    refuse_unless(longest >= 1 and rows >= 1, "a duty without rows", "rows", "write at least 1")
    found: list[float] = []
    while len(found) < rows:
        speed = 0.0 if generator.random() < rest else float(generator.choice(speeds))
        found += [speed] * int(generator.integers(max(longest // 6, 1), longest + 1))
    return np.array(found[:rows])
