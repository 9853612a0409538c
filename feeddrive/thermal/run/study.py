"""How a machine warms up: temperatures, growth, time constants, warm-up time, energy, and what its reduction costs.

The full model is stepped through the duty with its energy counted, the reduced one beside it. Where speed and air are
constant, the steady state and its approach are exact sums over the modes of the system, so that a warm-up time longer
than the run is known too.

| symbol | meaning | unit |
|---|---|---|
| τ_i | time constant of a mode | s |
| w_i | share of a mode in a step of an output, Σ w_i = 1 | 1 |
| u | growth of the table position | m |
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass

import numpy as np

from feeddrive.thermal.full.full_model import NUT
from feeddrive.thermal.laws.laws import FOLLOWED
from feeddrive.thermal.machine_heat import Heat
from feeddrive.thermal.reduced.parametric_model import HeatModel, Path
from feeddrive.thermal.reduced.reduction import DEFAULT_ORDER, compressed, reduce_model
from feeddrive.thermal.reduced.system import HeatSystem
from feeddrive.thermal.run.duty import Duty
from feeddrive.thermal.run.energy_balance import EnergyBalance, balance_of, with_ledger
from feeddrive.thermal.run.warm_up import HEATED, Rows, declared_rows, readings, run
from feeddrive.typing import FloatArray

_SUBSTEPS = 4
_SHOWN = 6
_LASTING = 12.0
"""Slowest time constants after which nothing moves any more: exp(-12) is 6e-6."""


@dataclass(frozen=True)
class TimeConstant:
    """τ [s] and its share in a step of the nut's temperature and of the growth at each position, name to share."""

    value: float
    shares: Mapping[str, float]


@dataclass(frozen=True)
class WarmUp:
    """When the growth at a place of the nut has come near the value that it settles at.

    Attributes:
        final: growth it settles at; under a changing duty that at the end of the run [m].
        time: from which on it stays within the band [s]; infinite where it does not get there.
        rise_time: after which it has made 63.2 % of its way [s].
    """

    final: float
    time: float
    rise_time: float


@dataclass(frozen=True, eq=False)
class ThermalStudy:
    """Outcome of a study.

    Attributes:
        heat: of the machine.
        duty: that it went through.
        series: channel to its values at the ends of the rows, (k,): temperatures [degC], growths [m].
        reduced: the same by the reduced model.
        states: of the full model, (k, n) [K].
        model: the full model, its ledger as the last state.
        order: number of states of the reduced model.
        conductances: means over the duty.
        heats: input name to its mean heat [W].
        constants: time constants at the mean conductances, those that carry most first.
        within: band of the warm-up time [m].
        warm_up: output name of each growth to its warm-up.
        energy: the balance.
    """

    heat: Heat
    duty: Duty
    series: Mapping[str, FloatArray]
    reduced: Mapping[str, FloatArray]
    states: FloatArray
    model: HeatModel
    order: int
    conductances: Mapping[Path, float]
    heats: Mapping[str, float]
    constants: tuple[TimeConstant, ...]
    within: float
    warm_up: Mapping[str, WarmUp]
    energy: EnergyBalance

    @property
    def reduction_errors(self) -> dict[str, float]:
        """Channel to the largest difference of the two models in this run [K, m]."""
        return {name: float(np.max(np.abs(self.series[name] - self.reduced[name]))) for name in self.series}


def study(heat: Heat, duty: Duty, within: float = 1e-6, order: int = DEFAULT_ORDER) -> ThermalStudy:
    """Let a machine warm up from rest and cold.

    Args:
        heat: the machine; its travel is where the nut goes to and fro.
        duty: what it does.
        within: band about the final growth for the warm-up time [m].
        order: number of states of the reduced model.

    Raises:
        InputError: a nut that leaves the shaft, a negative conductance, nothing that leads heat away.

    Warns:
        ValidityWarning: a speed or a conductance outside the range of films or reduction.
    """
    rows = declared_rows(heat, duty.step, duty.speeds, duty.ambient)
    full = heat.full_model()
    counted = with_ledger(full)
    states = run(counted, rows, substeps=_SUBSTEPS)
    small = reduce_model([full], heat.limits(), order)[0]
    start = float(duty.ambient[0])
    series = readings(counted, states, start)
    conductances = {path: float(np.mean(values)) for path, values in rows.conductances.items()}
    heats = {name: float(np.mean(values)) for name, values in rows.inputs.items()}
    modes = _modes(compressed(full.at(conductances)), heats)
    return ThermalStudy(
        heat, duty, series, readings(small, run(small, rows), start), states, counted, small.order, conductances,
        heats, _constants(modes), within, _warm_ups(modes, series, duty, within),
        balance_of(counted, states[-1], duty.step, _acting(rows, full, states)),
    )  # fmt: skip


def _acting(rows: Rows, full: HeatModel, states: FloatArray) -> Mapping[str, FloatArray]:
    """Heats that acted; those that follow temperatures as `run` takes them."""
    if rows.following is None:
        return rows.inputs
    read = np.vstack([full.readings[name] for name in FOLLOWED])
    rises = np.vstack([np.zeros((2, len(FOLLOWED))), states[:-1, :-1] @ read.T])
    given = np.array([rows.following(i, 1.5 * rises[i + 1] - 0.5 * rises[i]).copy() for i in range(len(states))])
    return {**rows.inputs, **dict(zip(HEATED, given.T, strict=True))}


@dataclass(frozen=True, eq=False)
class _Modes:
    """A step of all heats at once: rates (n,) [1/s], output name to its part by each mode (n,) [K, m]."""

    rates: FloatArray
    parts: Mapping[str, FloatArray]

    def rest(self, name: str, times: FloatArray) -> FloatArray:
        """What an output still has to go at some times [K, m]."""
        return np.asarray(np.exp(-np.multiply.outer(times, self.rates)) @ self.parts[name])


def _modes(system: HeatSystem, heats: Mapping[str, float]) -> _Modes:
    """Modes of a dense symmetric system with every C one."""
    rates, vectors = np.linalg.eigh(system.conductance)
    given = np.array(
        [heats.get(name, 0.0) if name not in ("ambient", "coolant") else 0.0 for name in system.input_names]
    )
    driven = vectors.T @ (system.gains @ given)
    rates = np.maximum(rates, 1e-12)
    return _Modes(rates, dict(zip(system.output_names, (system.rows @ vectors) * driven / rates, strict=True)))


def _constants(modes: _Modes) -> tuple[TimeConstant, ...]:
    names = [name for name in modes.parts if name == NUT or name.startswith("growth")]
    shares = {name: modes.parts[name] / (np.sum(modes.parts[name]) or 1.0) for name in names}
    weight = np.max([np.abs(share) for share in shares.values()], axis=0)
    chosen = sorted(np.argsort(-weight)[:_SHOWN], key=lambda i: modes.rates[i])
    return tuple(
        TimeConstant(float(1 / modes.rates[i]), {name: float(share[i]) for name, share in shares.items()})
        for i in chosen
    )


def _warm_ups(modes: _Modes, series: Mapping[str, FloatArray], duty: Duty, within: float) -> dict[str, WarmUp]:
    found = {}
    for name in (one for one in modes.parts if one.startswith("growth")):
        if duty.is_constant:
            found[name] = _approach(modes, name, within)
        else:
            values = np.concatenate([[0.0], series[f"table_{name}"]])
            found[name] = _settling(np.concatenate([[0.0], duty.times]), values, float(values[-1]), within)
    return found


def _approach(modes: _Modes, name: str, within: float) -> WarmUp:
    """Warm-up of a constant duty, exact by the modes on a fine grid of time."""
    final = float(np.sum(modes.parts[name]))
    times = np.linspace(0.0, _LASTING / float(modes.rates[0]), 40_001)
    return _settling(times, final - modes.rest(name, times), final, within)


def _settling(times: FloatArray, values: FloatArray, final: float, within: float) -> WarmUp:
    """Last crossing of the band, and first of 63.2 % of the way, between the samples on a straight line."""
    away = np.abs(values - final)
    outside = np.flatnonzero(away > within)
    if len(outside) == 0:
        reached = 0.0
    else:
        i = int(outside[-1])
        reached = np.inf if i == len(times) - 1 else _crossing(times, away, i, within)
    up = np.flatnonzero(np.abs(values) >= (1 - np.exp(-1)) * abs(final))
    risen = (
        np.inf
        if len(up) == 0
        else 0.0
        if up[0] == 0
        else _crossing(times, np.abs(values), int(up[0]) - 1, (1 - float(np.exp(-1))) * abs(final))
    )
    return WarmUp(final, float(reached), float(risen))


def _crossing(times: FloatArray, values: FloatArray, i: int, level: float) -> float:
    share = (level - values[i]) / (values[i + 1] - values[i])
    return float(times[i] + share * (times[i + 1] - times[i]))
