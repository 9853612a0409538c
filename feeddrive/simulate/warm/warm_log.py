"""A machine followed for hours from a slow log of its motor: temperatures at their pace, motion where it is uniform.

    P(v; l, o, b) = P_0 + (l - 1) P_l + (o - 1) P_o + (b - 1) P_b      friction power at a speed, linear in its factors
    x = x_uniform(θ, v, t; l, o, b) + u(x_nut, t) + Σ δ_frame

| symbol | meaning | unit |
|---|---|---|
| v | speed of a stroke: what rows within it turn by, over their length | rad/s |
| l, o, b | factors on load torque, nut oil, bearing oil at the present temperatures (`thermal.laws`) | 1 |
| u | growth of the screw where the nut is | m |

A row of a log is longer than a drive's cycles; within it the motor turns at the speed of its stroke for the share of
the row that its way takes, and rests for the others. What it does while accelerating is left out: some hundredths of
the heat of a short stroke. The heat network is stepped by `HEAT_STEP`, its inputs the means over it.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any

import casadi as ca
import numpy as np
from scipy.interpolate import RegularGridInterpolator
from scipy.ndimage import uniform_filter1d

from feeddrive.errors import InputError
from feeddrive.plant.plant import Plant
from feeddrive.plant.structure import parameter_values
from feeddrive.plant.warmed import followed
from feeddrive.recording import Recording
from feeddrive.simulate.uniform_motion import UniformMotion, uniform_motion
from feeddrive.thermal.full.full_model import FRONT, NUT, REAR
from feeddrive.thermal.laws.expansion import growths
from feeddrive.thermal.laws.laws import FOLLOWED, INPUTS, PATHS, BoundFunction, Laws, laws_of, values_of
from feeddrive.thermal.machine_heat import Heat
from feeddrive.thermal.reduced.parametric_model import HeatModel
from feeddrive.thermal.run.warm_up import Rows, channel_of, lagging, run
from feeddrive.typing import BoolArray, FloatArray, IntegerArray

HEAT_STEP = 20.0
"""Longest step of the heat network [s]: the skin of a seat settles in that, what is measured in minutes."""

UNIFORM = 1e-3
"""Share by which the speeds of two rows may differ within a stroke at constant speed."""

FEWEST = 10
"""Rows that must tell a speed before it counts as one of the machine's."""

_PLACES = 65
"""Places along the travel at which growth is worked out; between them it is straight to a nanometre."""


@dataclass(frozen=True, eq=False)
class WarmLog:
    """What a log tells of a motion, at n rows; of intervals, those that end at them. Each is a key of its own.

    Attributes:
        time: from the start [s].
        step: length of a row [s].
        angle: of the motor [rad].
        speed: of the stroke that the motor was on, with its sign [rad/s].
        share: of the row for which it turned at that speed.
        uniform: rows at whose instant the motor turned uniformly.
        torque: measured [N m]; None where it is not recorded.
        ambient: [degC].
    """

    time: FloatArray
    step: float
    angle: FloatArray
    speed: FloatArray
    share: FloatArray
    uniform: BoolArray
    torque: FloatArray | None
    ambient: FloatArray


def warm_log(recording: Recording, ambient: float) -> WarmLog:
    """What a recording with a motor angle tells, its air at `ambient` [degC] where it has no temperature of it.

    Raises InputError where no stroke is long enough to tell its speed.
    """
    angle, step = recording["motor_angle"], recording.sample_time
    turned = np.diff(angle, prepend=angle[0]) / step
    speed = _stroke_speeds(turned)
    found = np.abs(speed) > 0
    share = np.where(found, np.abs(turned) / np.where(found, np.abs(speed), 1.0), 0.0)
    after = np.append(turned[1:], 0.0)
    full = found & (np.abs(turned - speed) <= UNIFORM * np.abs(speed))
    uniform = full & (np.abs(after - speed) <= UNIFORM * np.abs(speed))
    if uniform.sum() < FEWEST:
        mend = f"log faster than once in {step:.3g} s, or longer strokes at constant speed"
        raise InputError("no stroke lasts long enough to tell its speed", recording.name, mend)
    air = recording["ambient_temperature"] if "ambient_temperature" in recording else np.full(len(angle), ambient)
    torque = recording.channels.get("motor_torque")
    time = step * np.arange(len(angle), dtype=np.float64)
    return WarmLog(time, step, angle, speed, np.minimum(share, 1.0), uniform, torque, air)


def _stroke_speeds(turned: FloatArray) -> FloatArray:
    """Speed of the stroke that each row belongs to, (n,): the fastest of its rows that others have too; 0 at rest.

    A stroke is a run of rows of one direction. One that no full row tells has the speed of the last that was known.
    """
    fastest = float(np.max(np.abs(turned), initial=0.0))
    moving = np.abs(turned) > 1e-4 * fastest
    equal = np.zeros(len(turned), dtype=bool)
    near = np.abs(np.diff(turned)) <= UNIFORM * np.abs(turned[1:])
    equal[1:] |= near & moving[1:]
    equal[:-1] |= near & moving[:-1]
    keys = np.where(equal, np.round(np.log(np.maximum(np.abs(turned), 1e-300)) / UNIFORM), np.nan)
    known, counts = np.unique(keys[equal], return_counts=True)
    often = np.isin(keys, known[counts >= FEWEST]) | np.isin(keys + 1, known) & np.isin(keys - 1, known)
    equal &= often
    direction = np.where(moving, np.sign(turned), 0.0)
    starts = np.flatnonzero(np.diff(direction, prepend=2.0))
    speed, last = np.zeros(len(turned)), 0.0
    for first, end in zip(starts, np.append(starts[1:], len(turned)), strict=True):
        if direction[first] == 0:
            continue
        steady = np.abs(turned[first:end])[equal[first:end]]
        slowest = float(np.max(np.abs(turned[first:end])))
        last = float(np.median(steady)) if len(steady) else max(last, slowest)
        speed[first:end] = direction[first] * max(last, slowest) if not len(steady) else direction[first] * last
    return speed


def thermometers(heat: Heat) -> dict[str, tuple[str, float]]:
    """Channel of each thermometer to its output of the network and its declared noise [K], 0 for none declared."""
    if heat.sensors:
        return {one.channel: (one.output, one.noise) for one in heat.sensors if one.kind == "thermometer"}
    return {channel_of(output): (output, 0.0) for output in FOLLOWED}


def steady_mean(series: FloatArray, step: float) -> FloatArray:
    """Mean over `HEAT_STEP` about each row, (n,): a seat's skin warms with each stroke, and the network does not."""
    width = 2 * int(0.5 * HEAT_STEP / step) + 1
    return np.asarray(uniform_filter1d(series, width, mode="nearest"))


@dataclass(frozen=True, eq=False)
class WarmRun:
    """What the plant does in a log.

    Attributes:
        channels: to their prediction, (n,) [N m, m, degC]; motion where it is uniform, elsewhere the motor's own.
        motion: at the uniform rows, (k,).
        rises: of `laws.FOLLOWED` at the rows, (n, 4) [K].
    """

    channels: Mapping[str, FloatArray]
    motion: UniformMotion
    rises: FloatArray

    @property
    def size(self) -> int:
        """Bytes of what was computed."""
        return sum(series.nbytes for series in self.channels.values()) + 6 * self.motion.torque.nbytes


def simulate_log(
    plant: Plant, model: HeatModel, log: WarmLog, powers: Mapping[str, FloatArray] | None = None
) -> WarmRun:
    """Temperatures, table position and torque of a machine in a log of its motor.

    The heat model is reduced, with bodies of effects attached; `powers` are the `friction_powers` where they are known
    already.
    """
    laws, values, cold = laws_of(plant.joined_heat), values_of(plant.joined_heat), float(log.ambient[0])
    each = max(int(HEAT_STEP / log.step), 1)
    powers = powers or friction_powers(plant, log)
    rows = _heat_rows(plant, model, laws, values, log, each, powers)
    states: FloatArray = np.vstack([np.zeros((1, model.order)), run(model, rows)])
    times: FloatArray = rows.step * np.arange(len(states), dtype=np.float64)

    def at_rows(series: FloatArray) -> FloatArray:
        return np.asarray(np.interp(log.time, times, series))

    rises: FloatArray = np.column_stack([at_rows(states @ model.readings[name]) for name in FOLLOWED])
    channels: dict[str, FloatArray] = {}
    _, lags, _ = laws.sensing(0.0, values)
    for channel, (output, _) in thermometers(plant.heat).items():
        read = cold + at_rows(states @ model.readings[output])
        for i in laws.lagging.get(channel, ()):
            read = lagging(read, cold, float(lags[i, 0]), log.step)
        channels[channel] = steady_mean(read, log.step)
    motion = _motion(plant, laws, values, log, rises, cold)
    radius = plant.chain.motor_radius
    for name, series, elsewhere in (
        ("motor_torque", motion.torque, np.zeros(len(log.time))),
        ("table_position", motion.table_position, radius * log.angle),
    ):
        whole = elsewhere.copy()
        whole[log.uniform] = series
        channels[name] = whole
    channels["table_position"] = channels["table_position"] + _grown(plant, model, states, times, log, radius)
    return WarmRun(channels, motion, rises)


def _motion(
    plant: Plant, laws: Laws, values: FloatArray, log: WarmLog, rises: FloatArray, cold: float
) -> UniformMotion:
    """Uniform motion at its rows, friction at the temperatures there."""
    rows = log.uniform
    factors = laws.factors(rises[rows].T, cold, values).full()
    p = np.tile(np.array(parameter_values(plant))[:, None], int(rows.sum()))
    for name, factor in followed(plant).items():
        p[name] *= factors[factor]
    return uniform_motion(plant, log.angle[rows], log.speed[rows], log.time[rows], p, with_powers=False)


def _grown(
    plant: Plant, model: HeatModel, states: FloatArray, times: FloatArray, log: WarmLog, radius: float
) -> FloatArray:
    """Growth of screw and frame where the nut is at the rows, (n,) [m]."""
    place = plant.coupling.nut_at_zero + radius * log.angle
    places = np.linspace(float(place.min()), float(place.max()) + 1e-9, _PLACES)
    table = growths(plant.heat.rig, states @ np.asarray(model.profile).T, model.edges, places)
    grown = RegularGridInterpolator((times, places), table, bounds_error=False, fill_value=None)(
        np.column_stack([log.time, place])
    )
    for effect in plant.heat.effects:
        grown = grown + np.ravel(np.array(effect.growth(ca.DM(place), ca.DM(log.time), effect.values), dtype=float))
    return np.asarray(grown)


def _heat_rows(
    plant: Plant, model: HeatModel, laws: Laws, values: FloatArray, log: WarmLog, each: int,
    powers: Mapping[str, FloatArray],
) -> Rows:  # fmt: skip
    """What acts on the network, means over `each` rows of the log."""
    count, cold = len(log.time), float(log.ambient[0])
    group = (np.arange(count) // each).astype(np.int64)
    size = np.bincount(group)

    def mean(series: FloatArray) -> FloatArray:
        return np.asarray(np.bincount(group, weights=series) / size)

    groups, whole = len(size), each * log.step
    starts = (whole * np.arange(groups, dtype=np.float64))[None, :]
    given: tuple[Any, ...] = (
        starts,
        whole,
        mean(log.ambient - cold)[None, :],
        np.zeros((len(FOLLOWED), groups)),
        cold,
        values,
    )
    signed, which = _distinct(log.speed)
    shares = np.column_stack([mean(log.share * (which == kind) * (log.speed != 0)) for kind in range(len(signed))])
    conductances, inputs = (np.zeros((len(names), groups)) for names in (PATHS, INPUTS))
    alike = _alike(shares)
    for i, speed in enumerate((*signed, 0.0)):
        g, u = laws.acting(np.full((1, groups), speed), *given)
        acted, mean_of_alike = (of[:, i] if i < len(signed) else 1 - of.sum(axis=1) for of in (shares, alike))
        conductances, inputs = conductances + mean_of_alike * g.full(), inputs + acted * u.full()
    found = dict(zip(INPUTS, inputs, strict=True))
    own = {name: shares @ table for name, table in powers.items()}
    bodies = {
        "motor": own["motor"][:, 0] + mean(_winding(plant, log)),
        plant.coupling.guide_heat_to: own["guide"][:, 0],
    }
    for name, heat in bodies.items():
        if name in model.input_names:
            found[name] = heat
    rear = plant.coupling.rear_share
    base = np.column_stack([found[name] for name in (NUT, FRONT, REAR)])
    return Rows(whole, dict(zip(PATHS, conductances, strict=True)), found,
                _Following(laws, values, cold, base, own["nut"], own["bearings"], rear))  # fmt: skip


def _alike(shares: FloatArray) -> FloatArray:
    """Shares of time, (k, speeds), those that agree to a twentieth by their mean: films so, heats never.

    A film that is a fortieth off for a step and right in the mean moves no temperature, and each costs a propagator.
    """
    _, which = np.unique(np.round(shares / 0.05), axis=0, return_inverse=True)
    which = which.ravel()
    sums = np.zeros((which.max() + 1, shares.shape[1]))
    np.add.at(sums, which, shares)
    return np.asarray((sums / np.bincount(which)[:, None])[which])


class _Following:
    """Heats of nut, front and rear at the rises of a row."""

    def __init__(
        self, laws: Laws, values: FloatArray, cold: float, base: FloatArray, nut: FloatArray, bearings: FloatArray,
        rear: float,
    ) -> None:  # fmt: skip
        self._base, self._nut, self._bearings = base, nut, bearings
        self._shares = np.array([1.0 - rear, rear])
        self._rises, self._factors = np.zeros(len(FOLLOWED)), np.zeros(3)
        arguments = [self._rises, np.array([cold]), np.array(values, dtype=np.float64)]
        self._call = BoundFunction(laws.factors, arguments, {0: self._factors})

    def __call__(self, row: int, rises: FloatArray) -> FloatArray:
        self._rises[:] = rises
        self._call()
        by = np.concatenate([[1.0], self._factors - 1])
        heats: FloatArray = self._base[row].copy()
        heats[0] += float(self._nut[row] @ by)
        heats[1:] += self._shares * float(self._bearings[row] @ by)
        return heats


def _winding(plant: Plant, log: WarmLog) -> FloatArray:
    """Heat of the motor's winding at the rows [W]; none where its constant or the torque is not known."""
    constant = plant.coupling.motor_constant
    if constant is None or log.torque is None:
        return np.zeros(len(log.time))
    return np.asarray(log.torque**2 / constant**2)


def friction_powers(plant: Plant, log: WarmLog) -> dict[str, FloatArray]:
    """Friction powers of the parts at the speeds of a log, with the slopes by the three factors, (k, 4) [W]."""
    signed, _ = _distinct(log.speed)
    middle = np.full(len(signed), float(np.mean(log.angle)))
    started = np.zeros(len(signed))
    whole = np.tile(np.array(parameter_values(plant))[:, None], len(signed))
    tables = []
    for factor in (None, 0, 1, 2):
        p = whole.copy()
        for row, follows in followed(plant).items():
            if follows == factor:
                p[row] *= 1.1
        tables.append(uniform_motion(plant, middle, signed, started, p).powers)
    found = {}
    for name in ("nut", "bearings", "guide", "motor"):
        first = tables[0][name]
        found[name] = np.column_stack([first, *((table[name] - first) / 0.1 for table in tables[1:])])
    return found


def _distinct(speed: FloatArray) -> tuple[FloatArray, IntegerArray]:
    """Speeds of both signs, those within a thousandth as one, and which each row has; rest has any."""
    keys = np.where(
        speed != 0, np.sign(speed) * (np.round(np.log(np.maximum(np.abs(speed), 1e-300)) / UNIFORM) + 1e6), 0
    )
    kinds, which = np.unique(keys, return_inverse=True)
    means = np.bincount(which, weights=speed) / np.bincount(which)
    return np.where(kinds == 0, np.max(np.abs(speed)), means), which.astype(np.int64)
