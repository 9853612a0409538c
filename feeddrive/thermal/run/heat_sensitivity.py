"""Temperatures and growth of a run with their exact slopes, for fits: the same rows, carried along with the states.

    x₁ = Φ(g) x + Γ(g) u,    dx₁/dp = Φ dx/dp + Γ (u_p + u_θ dθ/dp) + Σ_i (Φ_i x + Γ_i u) dg_i/dp

| symbol | meaning |
|---|---|
| p | parameters of `feeddrive.thermal.laws.laws` |
| g, u | conductances and inputs of a row, with slopes u_p, u_θ, dg/dp that CasADi takes from the laws |
| Φ_i, Γ_i | slopes of the exact step (`heat_propagators`) with conductance i, or a body's conductance or capacity |

The states are those of `warm_up.run`, of a reduced model; a group of rows that share a step is at the mean of its
conductances, and its slopes are those of each row.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from functools import lru_cache

import casadi as ca
import numpy as np

from feeddrive.symbolic_turn import SYMBOLS
from feeddrive.thermal.full.full_model import NUT
from feeddrive.thermal.laws.laws import FOLLOWED, INPUTS, PATHS, BoundFunction, Laws, growth_places, laws_of, values_of
from feeddrive.thermal.machine_heat import Heat
from feeddrive.thermal.reduced.heat_propagators import Propagator, propagator
from feeddrive.thermal.reduced.parametric_model import HeatModel, Path
from feeddrive.thermal.run.warm_up import channel_of, grouped, lagging, row_arguments
from feeddrive.typing import FloatArray

Slopes = dict[str, tuple[FloatArray, FloatArray]]
"""Channel to its values, (k,), and their slopes with the parameters asked for, (k, p)."""


def simulate_with_slopes(
    heat: Heat, model: HeatModel, step: float, speeds: FloatArray, ambient: FloatArray, wanted: Sequence[str]
) -> Slopes:
    """Channels as `warm_up.simulate` gives them, with their slopes with the parameters `wanted` (`Laws.names`), (p,).

    The bodies of effects are attached to the reduced model in the order of the effects.
    """
    laws, values, first = laws_of(heat), values_of(heat), float(ambient[0])
    columns = tuple(laws.names.index(name) for name in wanted)
    states, slopes = _states(laws, _network(laws, model, columns), step, speeds, ambient, values, columns)
    return _read(heat, laws, model, states, slopes, step, first, values, columns)


@dataclass(frozen=True, eq=False)
class _Network:
    """A reduced model in the states C^(1/2) θ.

    Attributes:
        model: whose matrices are meant.
        root: C^(1/2), (n,).
        bodies: of each parameter of a body that is asked for: the body's state, whether it is the capacity, its column.
    """

    model: HeatModel
    root: FloatArray
    bodies: tuple[tuple[int, bool, int], ...]

    def scaled(self, matrix: FloatArray) -> FloatArray:
        return np.asarray(matrix / np.outer(self.root, self.root))


def _network(laws: Laws, model: HeatModel, columns: Sequence[int]) -> _Network:
    """The bodies that effects attached last are the last states, in the order of `laws.bodies`."""
    bodies = []
    for i, label in enumerate(laws.bodies):
        for key, is_capacity in (("conductance", False), ("capacity", True)):
            at = laws.names.index(f"{label}.{key}")
            if at in columns:
                bodies.append((model.order - len(laws.bodies) + i, is_capacity, columns.index(at)))
    return _Network(model, np.sqrt(model.capacity), tuple(bodies))


@dataclass(frozen=True, eq=False)
class _Step:
    """A group's step, and its slopes with each moving path, then with each body's parameter."""

    exact: Propagator
    paths: tuple[tuple[FloatArray, FloatArray], ...]
    bodies: tuple[tuple[int, FloatArray, FloatArray], ...]


def _states(
    laws: Laws,
    network: _Network,
    step: float,
    speeds: FloatArray,
    ambient: FloatArray,
    values: FloatArray,
    columns: tuple[int, ...],
) -> tuple[FloatArray, FloatArray]:
    """C^(1/2) θ at the ends of the rows, (k, n), and the slopes of `readings`, (k, outputs, p)."""
    model, count = network.model, len(speeds)
    given = row_arguments(step, speeds, ambient)
    g, g_slope, u, u_slope = _rows(laws, given, float(ambient[0]), values, columns)
    moving = [i for i in range(len(PATHS)) if np.any(g_slope[:, i])]
    distinct, which = grouped(g)
    steps = [_step(network, one, step, [PATHS[i] for i in moving]) for one in distinct]
    places = [model.input_names.index(name) for name in INPUTS]
    read = np.vstack([model.readings[name] for name in FOLLOWED]) / network.root
    follow = _Follower(laws, columns) if laws.follows else None
    x, S = np.zeros(model.order), np.zeros((model.order, len(columns)))
    rows = np.vstack(list(model.readings.values())) / network.root
    states, slopes = np.empty((count, model.order)), np.empty((count, len(rows), len(columns)))
    rises = before = np.zeros(len(FOLLOWED))
    rises_slope = before_slope = np.zeros((len(FOLLOWED), len(columns)))
    for i, kind in enumerate(which):
        own, own_slope = u[i], u_slope[i]
        if follow is not None:
            here = 1.5 * rises - 0.5 * before
            own, own_slope, by_rise = follow(given, i, here, float(ambient[0]), values)
            own_slope = own_slope + by_rise @ (1.5 * rises_slope - 0.5 * before_slope)
        fed, fed_slope = np.zeros(len(model.input_names)), np.zeros((len(model.input_names), len(columns)))
        fed[places], fed_slope[places] = own, own_slope
        at = steps[kind]
        after = at.exact.propagator @ S + at.exact.input_map @ fed_slope
        for j, (kept, input_map) in zip(moving, at.paths, strict=True):
            after += np.outer(kept @ x + input_map @ fed, g_slope[i, j])
        for column, kept, input_map in at.bodies:
            after[:, column] += kept @ x + input_map @ fed
        x, S = at.exact.propagator @ x + at.exact.input_map @ fed, after
        states[i], slopes[i] = x, rows @ S
        before, before_slope, rises, rises_slope = rises, rises_slope, read @ x, read @ S
    return states, slopes


def _step(network: _Network, conductances: FloatArray, step: float, moving: Sequence[Path]) -> _Step:
    model, root = network.model, network.root
    system = model.at(dict(zip(PATHS, map(float, conductances), strict=True)))
    S, B = network.scaled(system.conductance), system.gains / root[:, None]
    exact = propagator(S, B, step)
    paths = []
    for path in moving:
        way = model.ways[path]
        gains = np.zeros_like(B)
        if way.source:
            gains[:, system.column(way.source)] = way.facing / root
        paths.append(exact.slopes(network.scaled(way.matrix), gains))
    bodies = []
    for state, is_capacity, column in network.bodies:
        change, gains = np.zeros_like(S), np.zeros_like(B)
        if is_capacity:
            # S = D K D with D = C^(-1/2): dD/dC = -D/(2C) at the body's own state
            half = -0.5 / model.capacity[state]
            change[state] += half * S[state]
            change[:, state] += half * S[:, state]
            gains[state] = half * B[state]
        else:
            link = np.zeros(model.order)
            link[:state], link[state] = model.ports[NUT][:state], -1.0
            change = network.scaled(np.outer(link, link))
        bodies.append((column, *exact.slopes(change, gains)))
    return _Step(exact, tuple(paths), tuple(bodies))


@lru_cache(maxsize=64)
def _sloped(laws: Laws, columns: tuple[int, ...]) -> ca.Function:
    """`Laws.acting` with its slopes by the columns and by the rises."""
    with SYMBOLS.taken():
        arguments = [ca.SX.sym(name, laws.acting.size1_in(i)) for i, name in enumerate(laws.acting.name_in())]
        g, u = laws.acting(*arguments)
        chosen = list(columns)
        by_p = [ca.densify(ca.jacobian(one, arguments[-1])[:, chosen]) for one in (g, u)]
        by_rise = ca.densify(ca.jacobian(u, arguments[4]))
        shown = [g, ca.vec(by_p[0]), u, ca.vec(by_p[1]), ca.vec(by_rise)]
        return ca.Function("heat_slopes", arguments, shown)


def _rows(
    laws: Laws, given: tuple[FloatArray, ...], cold: float, values: FloatArray, columns: tuple[int, ...]
) -> tuple[FloatArray, ...]:
    """g, (k, paths), with slopes, (k, paths, p); u, (k, inputs), with slopes; nothing has warmed."""
    g, g_slope, u, u_slope, _ = (np.asarray(one.full().T) for one in _sloped(laws, columns)(*given, cold, values))
    count = len(columns)
    # a column of CasADi stands column by column
    return (
        g,
        g_slope.reshape(len(g), count, len(PATHS)).swapaxes(1, 2),
        u,
        u_slope.reshape(len(u), count, len(INPUTS)).swapaxes(1, 2),
    )


class _Follower:
    """Inputs of a row at the rises there, (inputs,), and their slopes by p and by the rises."""

    def __init__(self, laws: Laws, columns: tuple[int, ...]) -> None:
        function = _sloped(laws, columns)
        self._shapes = (len(INPUTS), len(columns)), (len(INPUTS), len(FOLLOWED))
        self._scalars, self._rises = np.zeros(5), np.zeros(len(FOLLOWED))
        self._values = np.zeros(len(laws.names))
        self._shown = [np.zeros(max(function.size1_out(i), 1)) for i in range(2, 5)]
        one = [self._scalars[i : i + 1] for i in range(5)]
        arguments = [*one[:4], self._rises, one[4], self._values]
        self._call = BoundFunction(function, arguments, {2 + i: array for i, array in enumerate(self._shown)})

    def __call__(
        self, given: tuple[FloatArray, ...], row: int, rises: FloatArray, cold: float, values: FloatArray
    ) -> tuple[FloatArray, FloatArray, FloatArray]:
        speeds, starts, step, air, _ = given
        self._scalars[:] = speeds[0, row], starts[0, row], step, air[0, row], cold
        self._rises[:], self._values[:] = rises, values
        self._call()
        u, by_p, by_rise = self._shown
        count, p = self._shapes[0]
        return u.copy(), by_p[: count * p].reshape(p, count).T.copy(), by_rise.reshape(len(FOLLOWED), count).T.copy()


def _read(
    heat: Heat, laws: Laws, model: HeatModel, states: FloatArray, slopes: FloatArray, step: float,
    first: float, values: FloatArray, columns: tuple[int, ...],
) -> Slopes:  # fmt: skip
    """What sensors read, from states times C^(1/2)."""
    time = step * np.arange(1.0, len(states) + 1)
    frame, frame_slope, lags, lags_slope = (one.full() for one in _sensed(laws, columns)(time[None, :], values))
    places, p = list(growth_places(heat)), len(columns)
    moved = {name: (frame[i], frame_slope[i :: len(places)].T) for i, name in enumerate(places)}
    lag_slopes = lags_slope[:, 0].reshape(p, -1).T if p else np.zeros((len(lags), 0))
    named: Mapping[str, str] = {sensor.output: sensor.channel for sensor in heat.sensors}
    root = np.sqrt(model.capacity)
    roots = np.zeros((model.order, p))  # slope of C^(-1/2)
    for state, is_capacity, column in _network(laws, model, columns).bodies:
        if is_capacity:
            roots[state, column] = -0.5 * model.capacity[state] ** -1.5
    found: Slopes = {}
    for at, (name, row) in enumerate(model.readings.items()):
        channel = named.get(name, channel_of(name))
        start = 0.0 if name.startswith("growth") else first
        read, read_slope = start + states @ (row / root), slopes[:, at] + (states * row) @ roots
        if name in moved:
            read, read_slope = read + moved[name][0], read_slope + moved[name][1]
        for i in laws.lagging.get(channel, ()):
            read, read_slope = _lagged(read, read_slope, start, float(lags[i, 0]), lag_slopes[i], step)
        found[channel] = read, read_slope
    return found


@lru_cache(maxsize=64)
def _sensed(laws: Laws, columns: tuple[int, ...]) -> ca.Function:
    """(time, p) -> frame growths, their slopes by the columns, lags, theirs."""
    with SYMBOLS.taken():
        time, p = ca.SX.sym("time"), ca.SX.sym("p", len(laws.names))
        frame, lags, _ = laws.sensing(time, p)
        chosen = list(columns)
        slopes = [ca.vec(ca.densify(ca.jacobian(one, p)[:, chosen])) for one in (frame, lags)]
        return ca.Function("heat_sensed_slopes", [time, p], [frame, slopes[0], lags, slopes[1]])


def _lagged(
    values: FloatArray, slopes: FloatArray, first: float, lag: float, lag_slope: FloatArray, step: float
) -> tuple[FloatArray, FloatArray]:
    """`warm_up.lagging` with slopes, (k, p), of its input and of its time constant, (p,)."""
    read = lagging(values, first, lag, step)
    carried = np.column_stack([lagging(column, 0.0, lag, step) for column in slopes.T]) if slopes.size else slopes
    if lag <= 1e-6 * step or not np.any(lag_slope):
        return read, carried
    from scipy.signal import lfilter  # takes a second to import

    a = np.exp(-step / lag)
    a_slope = a * step / lag**2
    gain_slope = -a_slope * lag / step + (1 - a) / step
    before, read_before = (np.concatenate([[first], one[:-1]]) for one in (values, read))
    fed = a_slope * read_before - gain_slope * values + (gain_slope - a_slope) * before
    by_lag = lfilter([1.0], [1.0, -a], fed)
    return read, carried + np.outer(by_lag, lag_slope)
