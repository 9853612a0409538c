"""Compensation with temperature sensors: a Kalman filter on the reduced heat model and its unknowns.

    predicted:  z⁻ = f(z),  P⁻ = F P Fᵀ + W        corrected:  z = z⁻ + G (y - C z⁻),  G = P⁻Cᵀ (C P⁻Cᵀ + R)⁻¹

| symbol | meaning |
|---|---|
| z, P | states of `thermal_augmented` and their covariance |
| F, W | derivative of the row's map; covariance that the unknowns gain in a row |
| y, C, R | readings as rises over the start, their place in z, variances of their noise |

The unknown factors multiply what is known (heats, film conductances), so the filter learns them while the axis moves
and keeps them while it rests: a gain fixed for one speed cannot. Linearised about the estimate (extended filter); the
errors of 10 % make its second-order terms 1 %. With 16 states and two sensors there are 23, some 25 000 multiplications
a row; with 10 there are 17, and 10 000. Valid from a cold start, or from the state that a run before it left.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from feeddrive.compensation.heat.thermal_augmented import Augmented, Row, Transition
from feeddrive.compensation.heat.thermal_error import TableError
from feeddrive.compensation.heat.thermal_sensors import Sensor, refuse_unmountable
from feeddrive.compensation.heat.thermal_unknowns import Unknowns
from feeddrive.errors import InputError
from feeddrive.thermal.machine_heat import Heat
from feeddrive.thermal.reduced.parametric_model import AMBIENT, HeatModel
from feeddrive.thermal.rig import refuse_unless_positive
from feeddrive.thermal.run.warm_up import declared_rows, grouped
from feeddrive.typing import FloatArray


@dataclass(frozen=True, eq=False)
class Observation:
    """What the filter finds at the end of each of k rows.

    Attributes:
        error: of the table along the stroke, (k, p) [m].
        deviation: standard deviation of `error` as the filter states it, (k, p) [m].
        unknowns: name to its estimate, (k,) each [1, K, W]; factors as deviations from 1.
        state, covariance: z and P after the last row, from which another run goes on.
    """

    error: FloatArray
    deviation: FloatArray
    unknowns: dict[str, FloatArray]
    state: FloatArray
    covariance: FloatArray


@dataclass(frozen=True, eq=False)
class ThermalObserver:
    """A compensation with sensors.

    Attributes:
        heat: what the file declares.
        system: reduced model, sensors, unknowns, row.
        error: of the table along the stroke.
    """

    heat: Heat
    system: Augmented
    error: TableError

    def observe(
        self,
        speeds: FloatArray,
        ambient: FloatArray,
        readings: FloatArray,
        start: tuple[FloatArray, FloatArray] | None = None,
        reference: float | None = None,
    ) -> Observation:
        """Run the filter.

        Args:
            speeds: of the screw over each row, (k,) [rad/s].
            ambient: recorded over each row, (k,) [degC]; all the same where it is not recorded.
            readings: of the sensors at the end of each row, as rises over the temperature at the start, (k, m) [K]; nan
                where a sensor failed. A start that is read with noise shifts them all: average it over some minutes.
            start: z and P before the first row; None for a cold start.
            reference: recorded ambient at the cold start [degC]; None for that of the first row.

        Raises:
            InputError: series of unequal length, another number of sensors, a speed or an ambient that is not finite.

        Warns:
            ValidityWarning: a speed above the highest that the plant declares.
        """
        if np.shape(readings) != (len(speeds), len(self.system.sensors)):
            what = f"readings of shape {np.shape(readings)} for {len(speeds)} rows"
            raise InputError(what, "readings", f"give {len(self.system.sensors)} columns, a row each")
        rows, transitions = self.rows(speeds, ambient, reference)
        z, P = self.system.cold() if start is None else start
        states, spread = np.empty((len(rows), len(z))), np.empty((len(rows), len(self.error.positions)))
        n = self.system.model.order
        for i, (row, transition) in enumerate(zip(rows, transitions, strict=True)):
            z, P = advance(self.system, z, P, row, transition, readings[i])
            states[i], spread[i] = z, _deviation(self.error.rows, P[:n, :n])
        found = dict(zip(self.system.unknowns.names, states[:, self.system.shown :].T, strict=True))
        return Observation(self.error.of(states[:, :n]), spread, found, z, P)

    def rows(
        self, speeds: FloatArray, ambient: FloatArray, reference: float | None = None
    ) -> tuple[list[Row], list[Transition]]:
        """What the controller knows of each row, and its transition (rows that agree to 0.2 % share one).

        Arguments as `observe`.
        """
        if not np.all(np.isfinite(ambient)):
            raise InputError("a recorded ambient is not finite", "ambient", "give the last good value where it failed")
        given, model = declared_rows(self.heat, self.system.step, speeds, ambient), self.system.model
        heat = sum(
            np.multiply.outer(given.inputs[name], vector)
            for name, vector in model.heats.items()
            if name in given.inputs
        )
        distinct, which = grouped(np.column_stack(list(given.conductances.values())))
        kinds = [
            self.system.transition(dict(zip(given.conductances, map(float, values), strict=True)))
            for values in distinct
        ]
        air = given.inputs[AMBIENT] + (0.0 if reference is None else ambient[0] - reference)
        rows = [Row(one, float(rise)) for one, rise in zip(np.asarray(heat), air, strict=True)]
        return rows, [kinds[kind] for kind in which]


def thermal_observer(
    heat: Heat,
    model: HeatModel,
    error: TableError,
    sensors: Sequence[Sensor],
    unknowns: Unknowns | None = None,
    step: float = 30.0,
) -> ThermalObserver:
    """An observer.

    Args:
        heat: what the file declares.
        model: reduced, such as `compensation_model` gives.
        error: of the table, of this model.
        sensors: at mountable places; none is a model that knows how wrong it may be.
        unknowns: what is not known; None for the stated ones, with surroundings that are not recorded.
        step: length of a row [s].

    Raises:
        InputError: a place where no sensor can be mounted, two sensors at one place, a step that is not positive.
    """
    refuse_unless_positive(step, "s", "step")
    refuse_unmountable(heat, sensors)
    return ThermalObserver(heat, Augmented(model, tuple(sensors), unknowns or Unknowns(), step), error)


def advance(
    system: Augmented, z: FloatArray, P: FloatArray, row: Row, at: Transition, readings: FloatArray
) -> tuple[FloatArray, FloatArray]:
    """One row of the filter: z and P at its end, with the readings taken there, (m,) [K], nan where there is none."""
    z, F = system.predicted(z, row, at)
    P = F @ P @ F.T + system.wandering()
    seen = np.isfinite(readings)
    if not seen.any():
        return z, P
    C, noise = system.reading[seen], np.array([sensor.noise for sensor in system.sensors])[seen]
    R = np.diag(noise**2)
    gain = np.linalg.solve(C @ P @ C.T + R, C @ P).T
    rest = np.eye(len(z)) - gain @ C
    # Joseph's form stays symmetric and positive.
    return z + gain @ (readings[seen] - C @ z), rest @ P @ rest.T + gain @ R @ gain.T


def _deviation(rows: FloatArray, P: FloatArray) -> FloatArray:
    return np.asarray(np.sqrt(np.clip(np.einsum("pn,nm,pm->p", rows, P, rows), 0.0, None)))
