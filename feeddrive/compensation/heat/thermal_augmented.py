"""The reduced heat model with lagging sensors and wandering unknowns, one row at a time.

    C dx/dt = -(K + Σ fᵢ Kᵢ) x + (1 + q) B Q + Σ w_j b_j + (a + Σ fᵢ aᵢ)(θ + θ_u),    τ ds/dt = L x - s

| symbol | meaning | unit |
|---|---|---|
| x, s | states of the reduced model; readings of the sensors without noise, rises over the start | , K |
| q, fᵢ | deviation of the heats; of the films of screw (with seats) and nut | 1 |
| θ, θ_u | recorded rise of the surroundings; its unseen part | K |
| w_j, b_j | heats of no declared size, where they enter | W |
| K, Kᵢ, a, aᵢ | conductances, the films' part in them; the same for the areas that face the air | W/K |

Over a row the linear part is propagated exactly; what the deviations add is held at its value at the row's start, an
error of second order in f and row length. The state of the filter is z = (x, s, q, f_screw, f_nut, θ_u, w).
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from itertools import starmap

import numpy as np

from feeddrive.compensation.heat.thermal_sensors import Sensor
from feeddrive.compensation.heat.thermal_unknowns import NUT_FILMS, SCREW_FILMS, Unknowns, stationary_step
from feeddrive.errors import InputError
from feeddrive.thermal.reduced.parametric_model import AMBIENT, HeatModel, Path
from feeddrive.thermal.reduced.stepping import exact_propagator
from feeddrive.typing import FloatArray

_LEAST_LAG = 0.01
"""Least lag of a sensor, in rows: one that follows at once is given so much lag, which nobody can tell from none."""


@dataclass(frozen=True, eq=False)
class Transition:
    """A row at one set of conductances; n states, m sensors.

    Attributes:
        propagator: of (x, s) over the row, (n + m, n + m).
        spread: what a heat held over the row does to them, (n + m, n) [per W].
        facing: a, (n,) [W/K].
        films: (Kᵢ, aᵢ) of the screw and of the nut, (n, n) and (n,) each [W/K].
    """

    propagator: FloatArray
    spread: FloatArray
    facing: FloatArray
    films: tuple[tuple[FloatArray, FloatArray], ...]


@dataclass(frozen=True, eq=False)
class Row:
    """What the controller knows of a row.

    Attributes:
        heat: B Q of the declared heats, (n,) [W].
        ambient: θ [K].
    """

    heat: FloatArray
    ambient: float


@dataclass(frozen=True, eq=False)
class Augmented:
    """Model, sensors and unknowns as one system in rows.

    Attributes:
        model: reduced.
        sensors: m of them, possibly none.
        unknowns: u of them.
        step: length of a row [s].
    """

    model: HeatModel
    sensors: tuple[Sensor, ...]
    unknowns: Unknowns
    step: float

    @property
    def shown(self) -> int:
        """Number of x and s, n + m."""
        return self.model.order + len(self.sensors)

    @property
    def size(self) -> int:
        """Number of states of the filter, n + m + u."""
        return self.shown + len(self.unknowns.names)

    @property
    def reading(self) -> FloatArray:
        """Matrix from z to the readings, (m, n + m + u)."""
        return np.eye(self.size)[self.model.order : self.shown]

    @property
    def loose_heats(self) -> FloatArray:
        """b_j of the heats of no declared size, (n, j).

        Raises:
            InputError: an input that the model does not have.
        """
        columns = [np.zeros((self.model.order, 0))]
        for name, _ in self.unknowns.heats:
            if name not in self.model.heats:
                raise InputError(f'no heat "{name}"', "unknowns", f"known are {', '.join(self.model.heats)}")
            columns.append(self.model.heats[name][:, None])
        return np.hstack(columns)

    def transition(self, conductances: Mapping[Path, float]) -> Transition:
        """A row at conductances, path to g.

        Raises:
            InputError: a negative conductance.

        Warns:
            ValidityWarning: a conductance outside the model's range.
        """
        system, n = self.model.at(conductances), self.model.order
        lags = np.array([max(sensor.lag, _LEAST_LAG * self.step) for sensor in self.sensors])
        rate = np.zeros((self.shown, self.shown))
        rate[:n, :n] = system.conductance / system.capacity[:, None]
        for i, sensor in enumerate(self.sensors):
            rate[n + i, :n] = -self.model.readings[sensor.place] / lags[i]
            rate[n + i, n + i] = 1 / lags[i]
        gains = np.vstack([np.diag(1 / system.capacity), np.zeros((len(lags), n))])
        films = tuple(_film(self.model, conductances, paths) for paths in (SCREW_FILMS, NUT_FILMS))
        return Transition(*exact_propagator(rate, gains, self.step), system.gains[:, system.column(AMBIENT)], films)

    def predicted(self, z: FloatArray, row: Row, at: Transition) -> tuple[FloatArray, FloatArray]:
        """z at the end of a row and its derivative by z at the start, (N,) and (N, N)."""
        n, shown, loose = self.model.order, self.shown, self.loose_heats
        heat, films, unseen, wandering = z[shown], z[shown + 1 : shown + 3], z[shown + 3], z[shown + 4 :]
        air = row.ambient + unseen
        pulls = np.column_stack(list(starmap(lambda K, a: a * air - K @ z[:n], at.films)))
        facing = at.facing + sum(f * a for f, (_, a) in zip(films, at.films, strict=True))
        flow = (1 + heat) * row.heat + loose @ wandering + at.facing * air + pulls @ films
        kept = self.unknowns.kept(self.step)
        after = np.concatenate([at.propagator @ z[:shown] + at.spread @ flow, kept * z[shown:]])
        slope = np.zeros((self.size, self.size))
        slope[:shown, :shown] = at.propagator
        slope[:shown, :n] -= at.spread @ sum(f * K for f, (K, _) in zip(films, at.films, strict=True))
        slope[:shown, shown:] = at.spread @ np.column_stack([row.heat, pulls, facing, loose])
        slope[shown:, shown:] = np.diag(kept)
        return after, slope

    def wandering(self) -> FloatArray:
        """Covariance that the unknowns gain in a row, (N, N)."""
        return np.diag(np.concatenate([np.zeros(self.shown), stationary_step(self.unknowns, self.step)]))

    def cold(self) -> tuple[FloatArray, FloatArray]:
        """z and its covariance at a cold start: all at one temperature, the factors unknown, the air as recorded."""
        spread = np.concatenate([np.zeros(self.shown), self.unknowns.deviations**2])
        spread[self.shown + 3] = 0.0
        return np.zeros(self.size), np.diag(spread)


def _film(model: HeatModel, conductances: Mapping[Path, float], paths: Sequence[Path]) -> tuple[FloatArray, FloatArray]:
    matrix, facing = np.zeros((model.order, model.order)), np.zeros(model.order)
    for path in paths:
        g, way = conductances.get(path, 0.0), model.ways[path]
        matrix, facing = matrix + g * way.matrix, facing + g * way.facing
    return matrix, facing
