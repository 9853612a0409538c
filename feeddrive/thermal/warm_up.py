"""A run over rows of constant length: conductances and heats of every row, temperatures and growth at its end.

The full model is stepped implicitly, a reduced one exactly row by row; 6 h in rows of 30 s take milliseconds. Rows
whose conductances agree to 0.2 % share one propagator, at the mean of the group (`grouped`). A heat that follows the
nut's temperature (preload growing, oil thinning) is taken at the middle of its row, extrapolated from the two rows
before.
"""

from __future__ import annotations

import warnings
from collections.abc import Callable, Mapping
from dataclasses import dataclass

import numpy as np

from feeddrive.effects.thermal.base import Operation
from feeddrive.errors import InputError, ValidityWarning
from feeddrive.quantity import format_quantity
from feeddrive.thermal.acting import acting_conductances, acting_inputs, acting_nut_heat, sensed
from feeddrive.thermal.full_model import END, NUT, growth_name
from feeddrive.thermal.model import AMBIENT, HeatModel, Path
from feeddrive.thermal.plant import ThermalPlant
from feeddrive.thermal.sensors import CHANNELS
from feeddrive.thermal.stepping import Stepper
from feeddrive.typing import FloatArray, IntegerArray

NutHeat = Callable[[int, float], float]
"""(row, rise of the nut [K]) -> heat of the nut over that row [W]."""

_AGREEMENT = 2e-3


@dataclass(frozen=True, eq=False)
class Rows:
    """What acts over each of k rows.

    Attributes:
        step: length of a row [s].
        conductances: path to g, (k,) each.
        inputs: input name to its heat [W] or its rise over the start [K], (k,) each; those left out are zero.
        nut_heat: in place of the input "nut" where it follows the temperature; None where it does not.
    """

    step: float
    conductances: Mapping[Path, FloatArray]
    inputs: Mapping[str, FloatArray]
    nut_heat: NutHeat | None = None

    def __len__(self) -> int:
        return len(next(iter(self.conductances.values())))


def run(model: HeatModel, rows: Rows, start: FloatArray | None = None, substeps: int = 1) -> FloatArray:
    """States at the end of each row, (k, n).

    Args:
        model: full or reduced.
        rows: what acts.
        start: states before the first row, (n,); None for zero.
        substeps: of a row, for a full model.

    Raises:
        InputError: an input that the model does not have, series of unequal length, a negative conductance.

    Warns:
        ValidityWarning: a conductance outside the range of a reduced model.
    """
    inputs = _inputs(model, rows)
    table = np.column_stack([rows.conductances[path] for path in rows.conductances])
    distinct, which = grouped(table)
    steppers = _steppers(model, list(rows.conductances), distinct, rows.step, substeps)
    state = np.zeros(model.order) if start is None else start
    states = np.empty((len(rows), model.order))
    nut, column = model.readings[NUT], model.input_names.index(NUT)
    rise = before = float(nut @ state)
    for i, kind in enumerate(which):
        if rows.nut_heat is not None:
            inputs[i, column] = rows.nut_heat(i, 1.5 * rise - 0.5 * before)
        state = states[i] = steppers[kind](state, inputs[i])
        rise, before = float(nut @ state), rise
    return states


def grouped(table: FloatArray) -> tuple[FloatArray, IntegerArray]:
    """Groups of rows of conductances that agree to 0.2 %, for a measured speed is never twice the same.

    Half of that in a film coefficient is a few millikelvin; equal rows are a group of their own value.

    Args:
        table: (k, paths), none negative.

    Returns:
        Mean of each group, (g, paths), and the group of each row, (k,).

    Raises:
        InputError: a conductance that is negative or not finite.
    """
    if not np.all((table >= 0) & np.isfinite(table)):
        raise InputError("a conductance is negative or not finite", "conductances", "write zero or values above it")
    keys = np.round(np.log(np.maximum(table, 1e-12)) / _AGREEMENT)
    _, which = np.unique(keys, axis=0, return_inverse=True)
    which = which.ravel()
    sums = np.zeros((which.max() + 1, table.shape[1]))
    np.add.at(sums, which, table)
    return sums / np.bincount(which)[:, None], which.astype(np.int64)


def simulate(
    plant: ThermalPlant, model: HeatModel, step: float, speeds: FloatArray, ambient: FloatArray,
    rows: Rows | None = None,
) -> dict[str, FloatArray]:  # fmt: skip
    """Temperatures and growth of a machine from the speed of its screw and the air around it.

    Args:
        plant: what the file declares.
        model: its full or its reduced model.
        step: time between rows [s].
        speeds: of the screw over each row, (k,) [rad/s].
        ambient: over each row, (k,) [degC]; the run starts at the first one, at rest and cold.
        rows: what acts, where it is not as declared (see `declared_rows`); None for the declared plant.

    Returns:
        Channel to its values at the end of each row, (k,): temperatures [degC], growths [m].
    """
    states = run(model, rows or declared_rows(plant, step, speeds, ambient), substeps=4)
    first, operation = float(ambient[0]), _operation(step, speeds)
    places = {growth_name(x): x for x in plant.rig.growth_positions} | {END: plant.rig.length}
    named = {sensor.output: sensor.channel for sensor in plant.sensors}
    found = {}
    for name, row in model.readings.items():
        x = places.get(name)
        channel = named.get(name, channel_of(name))
        start = 0.0 if name.startswith("growth") else first
        found[channel] = sensed(plant.effects, channel, start + states @ row, start, operation, x)
    return found


def declared_rows(plant: ThermalPlant, step: float, speeds: FloatArray, ambient: FloatArray) -> Rows:
    """What acts on the plant as its file says, effects among it; arguments as `simulate`.

    Raises:
        InputError: no rows, or series of unequal length.

    Warns:
        ValidityWarning: a speed above the highest that the plant declares.
    """
    if len(speeds) != len(ambient) or len(speeds) == 0:
        raise InputError(f"{len(speeds)} speeds and {len(ambient)} ambient temperatures", "", "give one of each a row")
    fastest = float(np.max(np.abs(speeds)))
    if fastest > plant.highest_speed * (1 + 1e-9):
        told = f"{format_quantity(fastest, 'rad/s')} is above the highest speed declared"
        shown = format_quantity(plant.highest_speed, "rad/s")
        warnings.warn(f"{told}, {shown}: films and friction are extrapolated", ValidityWarning, stacklevel=2)
    inputs = {**plant.heats(speeds), AMBIENT: ambient - ambient[0]}
    operation = _operation(step, speeds)
    return Rows(
        step,
        acting_conductances(plant.effects, plant.conductances(speeds), operation),
        acting_inputs(plant.effects, inputs, operation),
        acting_nut_heat(plant.effects, plant.nut, 1.0, operation.speed),
    )


def _operation(step: float, speeds: FloatArray) -> Operation:
    return Operation(np.abs(speeds), step * np.arange(len(speeds), dtype=np.float64), step)


def channel_of(output: str) -> str:
    """Name in recordings of an output of a model, where no sensor gives it another."""
    return f"table_{output}" if output.startswith("growth") else CHANNELS.get(output, f"{output}_temperature")


def readings(model: HeatModel, states: FloatArray, start: float) -> dict[str, FloatArray]:
    """Channels of a recording from states (k, n): temperatures over `start` [degC], growths [m]."""
    found = {}
    for name, row in model.readings.items():
        values = states @ row
        found[channel_of(name)] = values if name.startswith("growth") else start + values
    return found


def _inputs(model: HeatModel, rows: Rows) -> FloatArray:
    table = np.zeros((len(rows), len(model.input_names)))
    for name, values in rows.inputs.items():
        if name not in model.input_names:
            raise InputError(f'no input "{name}"', "", f"known are {', '.join(model.input_names)}")
        if np.shape(values) != (len(rows),):
            raise InputError(f"{np.size(values)} values for {len(rows)} rows", name, "give one a row")
        if not np.all(np.isfinite(values)):
            raise InputError("a value is not finite", name, "leave out or mend the rows that have none")
        table[:, model.input_names.index(name)] = values
    return table


def _steppers(
    model: HeatModel, paths: list[Path], distinct: FloatArray, step: float, substeps: int
) -> list[Stepper]:  # fmt: skip
    return [model.at(dict(zip(paths, map(float, values), strict=True))).stepper(step, substeps) for values in distinct]
