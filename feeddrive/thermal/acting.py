"""What a plant's thermal effects do: to the conductances, heats and surroundings of a run, and to what sensors read.

    g = g_0 Π cᵢ,    Q = Q_0 + Σ Qᵢ,    Q_nut = s ω (T_1 Π lᵢ(ΔT) + T_v Π vᵢ(ΔT)),    θ_i = θ_recorded + Σ Δθᵢ

| symbol | meaning | unit |
|---|---|---|
| g | film coefficients and contact conductance; the coolant's conductances add | W/(m² K), W/K |
| Q | heats of nut and seats | W |
| T_1, T_v, s | load and viscous torque of the nut, share of the heat | N m, 1 |
| l, v | factors at the nut's rise ΔT | 1 |
| θ_i | surroundings | K |
"""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence

import numpy as np
from scipy.signal import lfilter

from feeddrive.effects.thermal.base import Operation, ThermalEffect
from feeddrive.thermal.friction import Friction
from feeddrive.thermal.model import AMBIENT, Path
from feeddrive.typing import FloatArray

_FILMS = {Path.SCREW_FILM: "screw", Path.NUT_FILM: "nut", Path.FRONT_FILM: "front", Path.REAR_FILM: "rear"}


def acting_conductances(
    effects: Sequence[ThermalEffect], declared: Mapping[Path, FloatArray], run: Operation
) -> dict[Path, FloatArray]:  # fmt: skip
    """Conductances with the effects in, (k,) each."""
    found = dict(declared)
    for effect in effects:
        for path, film in _FILMS.items():
            found[path] = found[path] * effect.film_factor(film)
        found[Path.CONTACT] = found[Path.CONTACT] * effect.contact_factor()
        found[Path.COOLING] = found[Path.COOLING] + effect.coolant_conductance(run, effect.values)
    return found


def acting_inputs(
    effects: Sequence[ThermalEffect], declared: Mapping[str, FloatArray], run: Operation
) -> dict[str, FloatArray]:  # fmt: skip
    """Heats and surroundings with the effects in, (k,) each."""
    found = dict(declared)
    for effect in effects:
        for place, heat in effect.heats(run, effect.values).items():
            found[place] = found[place] + heat
        found[AMBIENT] = found[AMBIENT] + effect.surroundings(run, effect.values)
    return found


def acting_nut_heat(
    effects: Sequence[ThermalEffect], friction: Friction, load: float, speed: FloatArray
) -> Callable[[int, float], float] | None:
    """Heat of the nut over a row at a rise [K]; None where no effect follows the nut's temperature.

    Args:
        effects: of the plant.
        friction: of the nut.
        load: factor of the preload on the load torque.
        speed: of the screw over each row, (k,) [rad/s].
    """
    following = [effect for effect in effects if effect.follows_nut]
    if not following:
        return None
    by_load, by_oil = (friction.heats(speed, *pair).tolist() for pair in ((load, 0.0), (0.0, 1.0)))

    def heat(row: int, rise: float) -> float:
        loaded, oiled = by_load[row], by_oil[row]
        for effect in following:
            loaded *= effect.load_factor(rise, effect.values)
            oiled *= effect.viscous_factor(rise, effect.values)
        return float(loaded + oiled)

    return heat


def sensed(
    effects: Sequence[ThermalEffect], channel: str, values: FloatArray, first: float, run: Operation,
    position: float | None,
) -> FloatArray:  # fmt: skip
    """What a sensor reads, (k,): the growth of the frame added at `position` [m], its lags behind.

    Args:
        effects: of the plant.
        channel: its name.
        values: what is there at the end of each row, (k,).
        first: what was there at the start.
        run: rows.
        position: of the nut, of a growth; None for a temperature.
    """
    read = values
    for effect in effects:
        if position is not None:
            read = read + effect.growth(position, run.start + run.step, effect.values)
    for effect in effects:
        read = _lagging(read, first, effect.lag(channel), run.step)
    return read


def _lagging(values: FloatArray, first: float, time_constant: float, step: float) -> FloatArray:
    """First-order lag of a signal that is straight between the rows, (k,); exact for it."""
    if time_constant <= 1e-6 * step:
        return values
    a = np.exp(-step / time_constant)
    gain = (1 - a) * time_constant / step
    # dy/dt = (u - y)/τ with u from u₀ to u₁: y₁ = a y₀ + (1 - gain) u₁ + (gain - a) u₀
    before = np.concatenate([[first], values[:-1]])
    fed = (1 - gain) * values + (gain - a) * before
    lagged, _ = lfilter([1.0], [1.0, -a], fed, zi=np.array([a * first]))
    return np.asarray(lagged)
