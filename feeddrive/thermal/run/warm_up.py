"""A run over rows of constant length: conductances and heats of every row, temperatures and growth at its end.

The full model is stepped implicitly, a reduced one exactly row by row; 6 h in rows of 30 s take milliseconds. Rows
whose conductances agree to 0.2 % share one propagator, at the mean of the group (`grouped`). A heat that follows a
temperature (preload growing, oil thinning) is taken at the middle of its row, extrapolated from the two rows before.
What acts is stated by `laws` alone.
"""

from __future__ import annotations

import warnings
from collections.abc import Callable, Mapping
from dataclasses import dataclass
from itertools import pairwise
from typing import Any

import casadi as ca
import numpy as np

from feeddrive.errors import InputError, ValidityWarning
from feeddrive.thermal.full.full_model import FRONT, NUT, REAR
from feeddrive.thermal.laws.laws import FOLLOWED, INPUTS, PATHS, BoundFunction, Laws, growth_places, laws_of, values_of
from feeddrive.thermal.machine_heat import CHANNELS, Heat
from feeddrive.thermal.reduced.heat_propagators import propagator
from feeddrive.thermal.reduced.parametric_model import HeatModel, Path
from feeddrive.thermal.reduced.stepping import Stepper
from feeddrive.thermal.reduced.system import HeatSystem
from feeddrive.typing import FloatArray, IntegerArray
from feeddrive.units.quantity import format_quantity

Following = Callable[[int, FloatArray], FloatArray]
"""(row, rises of `laws.FOLLOWED` (4) [K]) -> heats of nut, front and rear over that row (3) [W]."""

_AGREEMENT = 2e-3
_WORTH = 8
"""Rows from which a sum over modes takes less time than stepping."""
HEATED = (NUT, FRONT, REAR)
"""Inputs that may follow temperatures."""


@dataclass(frozen=True, eq=False)
class Rows:
    """What acts over each of k rows.

    Attributes:
        step: length of a row [s].
        conductances: path to g, (k,) each.
        inputs: input name to its heat [W] or its rise over the start [K], (k,) each; those left out are zero.
        following: in place of the heats of nut, front and rear where they follow temperatures; None where they do not.
    """

    step: float
    conductances: Mapping[Path, FloatArray]
    inputs: Mapping[str, FloatArray]
    following: Following | None = None

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
    systems = [model.at(dict(zip(rows.conductances, map(float, one), strict=True))) for one in distinct]
    state = np.zeros(model.order) if start is None else start
    if rows.following is None and not systems[0].is_sparse:
        return _stretches(systems, which, inputs, rows.step, state)
    steppers = [_stepper(system, rows.step, substeps) for system in systems]
    states = np.empty((len(rows), model.order))
    read = np.vstack([model.readings[name] for name in FOLLOWED])
    columns = [model.input_names.index(name) for name in HEATED]
    rises = before = read @ state
    for i, kind in enumerate(which):
        if rows.following is not None:
            inputs[i, columns] = rows.following(i, 1.5 * rises - 0.5 * before)
        state = states[i] = steppers[kind](state, inputs[i])
        before, rises = rises, read @ state if rows.following is not None else rises
    return states


def _stepper(system: HeatSystem, step: float, substeps: int) -> Stepper:
    """What advances a system by a row; a reduced one by its modes."""
    if system.is_sparse:
        return system.stepper(step, substeps)
    root = np.sqrt(system.capacity)
    exact = propagator(system.conductance / np.outer(root, root), system.gains / root[:, None], step)
    kept, fed = exact.propagator * root / root[:, None], exact.input_map / root[:, None]
    return lambda state, given: kept @ state + fed @ given


def _stretches(
    systems: list[HeatSystem], which: IntegerArray, inputs: FloatArray, step: float, state: FloatArray
) -> FloatArray:
    """States of a reduced model whose inputs are known beforehand: one sum over modes where nothing changes."""
    root = np.sqrt(systems[0].capacity)
    exact = [propagator(one.conductance / np.outer(root, root), one.gains / root[:, None], step) for one in systems]
    changes = np.flatnonzero((np.diff(which) != 0) | np.any(np.diff(inputs, axis=0) != 0, axis=1)) + 1
    state, states = state * root, np.empty((len(which), len(root)))
    for first, last in pairwise((0, *changes.tolist(), len(which))):
        at = exact[which[first]]
        if last - first > _WORTH:
            states[first:last] = at.held(state, inputs[first], last - first)
            state = states[last - 1]
            continue
        for i in range(first, last):
            state = states[i] = at.propagator @ state + at.input_map @ inputs[i]
    return np.asarray(states / root)


def grouped(table: FloatArray) -> tuple[FloatArray, IntegerArray]:
    """Mean (g, paths) of rows of conductances (k, paths) that agree to 0.2 %, and the group of each row, (k,).

    A measured speed is never twice the same; half of 0.2 % in a film coefficient is a few millikelvin. Equal rows are a
    group of their own value. Raises InputError for a conductance that is negative or not finite.
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
    heat: Heat,
    model: HeatModel,
    step: float,
    speeds: FloatArray,
    ambient: FloatArray,
    rows: Rows | None = None,
) -> dict[str, FloatArray]:
    """Temperatures and growth of a machine from the speed of its screw and the air around it.

    Args:
        heat: what the file declares.
        model: its full or its reduced model.
        step: time between rows [s].
        speeds: of the screw over each row, (k,) [rad/s].
        ambient: over each row, (k,) [degC]; the run starts at the first one, at rest and cold.
        rows: what acts, where it is not as declared (see `declared_rows`); None for the declared plant.

    Returns:
        Channel to its values at the end of each row, (k,): temperatures [degC], growths [m].
    """
    states = run(model, rows or declared_rows(heat, step, speeds, ambient), substeps=4)
    return sensed(heat, model, states, step, float(ambient[0]))


def declared_rows(heat: Heat, step: float, speeds: FloatArray, ambient: FloatArray) -> Rows:
    """What acts on the plant as its file says, effects among it; arguments as `simulate`.

    Raises:
        InputError: no rows, or series of unequal length.

    Warns:
        ValidityWarning: a speed above the highest that the plant declares.
    """
    if len(speeds) != len(ambient) or len(speeds) == 0:
        raise InputError(f"{len(speeds)} speeds and {len(ambient)} ambient temperatures", "", "give one of each a row")
    fastest = float(np.max(np.abs(speeds)))
    if fastest > heat.highest_speed * (1 + 1e-9):
        what = f"{format_quantity(fastest, 'rad/s')} is above the highest speed declared"
        shown = format_quantity(heat.highest_speed, "rad/s")
        warnings.warn(f"{what}, {shown}: films and friction are extrapolated", ValidityWarning, stacklevel=2)
    laws, values, cold = laws_of(heat), values_of(heat), float(ambient[0])
    g, u = laws.acting(*row_arguments(step, speeds, ambient), cold, values)
    conductances = dict(zip(PATHS, np.asarray(ca.DM(g).full()), strict=True))
    inputs = dict(zip(INPUTS, np.asarray(ca.DM(u).full()), strict=True))
    following = _Followed(laws, step, speeds, ambient, values) if laws.follows else None
    return Rows(step, conductances, inputs, following)


def row_arguments(step: float, speeds: FloatArray, ambient: FloatArray) -> tuple[Any, ...]:
    """Speeds, starts, step, air and rises for `Laws.acting`, a column each row, where nothing has warmed."""
    count = len(speeds)
    starts = step * np.arange(count, dtype=np.float64)
    return speeds[None, :], starts[None, :], step, (ambient - ambient[0])[None, :], np.zeros((len(FOLLOWED), count))


class _Followed:
    """Heats of a row at the rises there, by a buffer of its own: a call from Python would cost more than the row."""

    def __init__(self, laws: Laws, step: float, speeds: FloatArray, ambient: FloatArray, values: FloatArray) -> None:
        self._speeds, self._step = speeds, step
        self._scalars, self._rises, self._inputs = np.zeros(5), np.zeros(len(FOLLOWED)), np.zeros(len(INPUTS))
        self._scalars[2], self._scalars[4] = step, ambient[0]
        self._air = ambient - ambient[0]
        one = [self._scalars[i : i + 1] for i in range(5)]
        arguments = [*one[:4], self._rises, one[4], np.array(values, dtype=np.float64)]
        self._call = BoundFunction(laws.acting, arguments, {1: self._inputs})

    def __call__(self, row: int, rises: FloatArray) -> FloatArray:
        self._scalars[0], self._scalars[1], self._scalars[3] = self._speeds[row], row * self._step, self._air[row]
        self._rises[:] = rises
        self._call()
        return self._inputs[: len(HEATED)]


def sensed(heat: Heat, model: HeatModel, states: FloatArray, step: float, first: float) -> dict[str, FloatArray]:
    """Channels that a plant's sensors read from states (k, n), frame growth added and lags behind; as `simulate`."""
    laws, values = laws_of(heat), values_of(heat)
    time = step * np.arange(1.0, len(states) + 1)
    frame, lags, _ = laws.sensing(time[None, :], values)
    moved = dict(zip(growth_places(heat), frame.full(), strict=True))
    named = {sensor.output: sensor.channel for sensor in heat.sensors}
    found = {}
    for name, row in model.readings.items():
        channel = named.get(name, channel_of(name))
        start = 0.0 if name.startswith("growth") else first
        read = start + states @ row + moved.get(name, 0.0)
        for i in laws.lagging.get(channel, ()):
            read = lagging(read, start, float(lags[i, 0]), step)
        found[channel] = read
    return found


def lagging(values: FloatArray, first: float, time_constant: float, step: float) -> FloatArray:
    """First-order lag of a signal that is straight between the rows, (k,); exact for it."""
    if time_constant <= 1e-6 * step:
        return values
    from scipy.signal import lfilter  # takes a second to import

    a = np.exp(-step / time_constant)
    gain = (1 - a) * time_constant / step
    # dy/dt = (u - y)/τ with u from u₀ to u₁: y₁ = a y₀ + (1 - gain) u₁ + (gain - a) u₀
    before = np.concatenate([[first], values[:-1]])
    fed = (1 - gain) * values + (gain - a) * before
    lagged, _ = lfilter([1.0], [1.0, -a], fed, zi=np.array([a * first]))
    return np.asarray(lagged)


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
