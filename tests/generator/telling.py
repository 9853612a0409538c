"""How far the change that an effect makes is from what declared values within their tolerance make.

Changes of torque and position under the recorded motion are taken over the density of what the true plant, led by the
recorded motor angle, misses of the recording, and compared there: lengths are standard deviations.
"""

from __future__ import annotations

import dataclasses
import math
from collections.abc import Callable
from dataclasses import dataclass

import numpy as np
import numpy.typing as npt
from scipy import signal
from scipy.ndimage import uniform_filter1d
from scipy.optimize import lsq_linear

from tests.generator.constants import declared_constants
from tests.generator.drawn_effects import OFF_GROUPS, TOLERANCES, TOUCHED
from tests.generator.driven import driven
from tests.generator.effects import ChannelDelay, Effect
from tests.generator.machines import Machine
from tests.generator.runs import Array, Run, at_rest, changes, longest_step

HIGHEST = 150.0
"""Highest frequency that counts [Hz]; a fifth of the rate of the rows where that is less."""


WIDTH = 0.30
"""Tolerance of a speed at which friction changes its sign, which no data sheet states."""

LOCAL = 0.1
"""Seconds over which what is missed is told to be large or small."""

BANDS = (5.0, 10.0, 20.0, 40.0, 80.0, 150.0)
"""Edges of the bands in which an effect may show [Hz]."""


@dataclass(frozen=True)
class Missed:
    """What the true plant, led by the recorded angle, misses, per channel.

    weights: of the rows, (rows,), 1 where as little is missed as usual. densities: of the weighted rows at `hertz`,
    (k,), white noise of unit variance being 1. inside: frequencies that count.
    """

    weights: tuple[Array, ...]
    densities: tuple[Array, ...]
    hertz: Array
    inside: npt.NDArray[np.bool_]


@dataclass(frozen=True)
class Visible:
    """How much an effect changes in each channel, in the band where it shows most: its rms over what is missed.

    hertz: edge of that band. size: error without the effect over that with it, sqrt(1 + r^2) of the larger r.
    """

    torque: float
    position: float
    hertz: tuple[float, float]

    @property
    def size(self) -> float:
        """Error of a plant without the effect, its declared values fitted, over the floor."""
        return math.hypot(1.0, max(self.torque, self.position))


def from_declared(run: Run, name: str, floor: Missed) -> float:
    """Return how far the planted effect of this name is from declared values that are off within their tolerance.

    What they change is simulated: as it is without inertia and damping, what they do at a resonance is left out, and a
    stiffness along the stroke seemed 34 standard deviations away where it is 16. Of an effect that says that a declared
    value is other, what has to be told is what of it is beyond the tolerance, and from all other values.
    """
    without: tuple[Effect, ...] = tuple(other for other in run.effects if other.name != name)
    target = whitened(floor, *_changed(run, without))
    if name not in TOUCHED:
        return distance(target, simulated_calibration(run, floor), free=0)
    shares = beyond(next(one for one in run.effects if one.name == name), run.machine)
    columns = simulated_calibration(run, floor, tuple(shares))
    speeds = columns[:, :SPEEDS]

    def left(sizes: Array) -> Array:
        values = changes_left(run, without, tuple(shares), sizes[SPEEDS:])
        return whitened(floor, *values) - speeds @ sizes[:SPEEDS]

    return max(shares.values()) * nearest(left, columns)


def nearest(left: Callable[[Array], Array], columns: Array) -> float:
    """Return the least length of what values leave of a target, each with unit prior deviation, within `FARTHEST`.

    Args:
        left: what values of given sizes leave, (values,) -> (k,).
        columns: what each takes away, (k, values), at the plant whose change is the target: values that leave nothing
            of it are one with the same resonances.

    Steps of Gauss and Newton, bounded as a whole and halved until they come nearer; then with the slopes of the place
    where they came to rest.
    """
    sizes, slopes = np.zeros(columns.shape[1]), columns
    rest = left(sizes)
    length = float(np.linalg.norm(rest))
    for _ in range(PASSES):
        before, matrix = length, np.vstack([slopes, np.eye(len(sizes))])
        for _ in range(PASSES):
            last, target = length, np.concatenate([rest + slopes @ sizes, np.zeros(len(sizes))])
            step = lsq_linear(matrix, target, (-FARTHEST, FARTHEST), method="bvls").x - sizes
            for _ in range(HALVINGS):
                there = left(sizes + step)
                nearer = math.hypot(float(np.linalg.norm(there)), float(np.linalg.norm(sizes + step)))
                if nearer < length:
                    sizes, rest, length = sizes + step, there, nearer
                    break
                step = 0.5 * step
            if last - length <= REST * length:
                break
        if slopes is not columns and before - length <= REST * length:
            break
        moves = np.diag(np.where(sizes > 0.0, -STEP, STEP))
        slopes = np.column_stack([(rest - left(sizes + move)) / move.sum() for move in moves])
    return length


def changes_left(run: Run, effects: tuple[Effect, ...], without: tuple[str, ...], sizes: Array) -> tuple[Array, Array]:
    """Return what a run is over one with other effects, values being off by `sizes` of their tolerances, (rows,) each.

    sizes: one for every group but those `without`, (groups,), as powers of one tolerance: no value changes its sign.
    """
    factors, constant = {}, 1.0
    groups = [one for one in OFF_GROUPS if not set(one[0]) & set(without)]
    for (names, kind), size in zip(groups, sizes, strict=True):
        factor = (1.0 + TOLERANCES[kind]) ** float(size)
        if kind == "torque_constant":
            constant = factor
        else:
            factors |= dict.fromkeys(names, factor)
    other = dataclasses.replace(run.machine, axis=run.machine.axis.off_by(factors))
    torque, position = _changed(run, effects, other)
    rows = run.torque[run.rows]
    return rows - constant * (rows - torque), position


def beyond(effect: Effect, machine: Machine) -> dict[str, float]:
    """Return, for every value that an effect says to be other, the share of that which is beyond its tolerance."""
    before = declared_constants(machine.axis)
    after, kinds = effect.planted(before), {name: kind for names, kind in OFF_GROUPS for name in names}
    off = {name: abs(math.log(getattr(after, name) / getattr(before, name))) for name in TOUCHED[effect.name]}
    return {name: 1.0 - math.log1p(TOLERANCES[kinds[name]]) / by for name, by in off.items() if by > 0.0}


SPEEDS = 2
"""Columns of the speeds at which friction changes its sign: the first ones; nothing is simulated for them."""


def _changed(run: Run, effects: tuple[Effect, ...], machine: Machine | None = None) -> tuple[Array, Array]:
    """Return `changes`, less those of the run's own plant where the other one has a late channel as well.

    `changes` reads the other plant as one whose channels are in time.
    """
    torque, position = changes(run, effects, machine)
    if not any(isinstance(one, ChannelDelay) for one in effects):
        return torque, position
    own = changes(run, run.effects)
    return torque - own[0], position - own[1]


PASSES, HALVINGS, REST = 8, 6, 0.02
"""Sets of slopes, and steps with each, at most; halvings of a step; and the share of the length that ends both.
Masses, stiffnesses, frictions, dampings and the torque constant that all are off alike change nothing, so that the
first steps go far along what is straight near the true values alone: of 819 standard deviations that a payload made,
124 seemed to be beyond its tolerance after steps cut at `FARTHEST` value by value and never halved; 2 are."""

FARTHEST = 3.0
"""Tolerances that a value is off by in those simulations at most: three standard deviations of what is known of it."""

STEP = 0.02
"""Tolerances by which a value is off in a simulation that its slope is taken from: small in what a resonance moves by,
large to what an integrator misses. At a fifth of a tolerance what a resonance bends by is more than the values leave,
where all are off alike; a fiftieth and a two-hundred-and-fiftieth find the same nearest values."""


def simulated_calibration(run: Run, floor: Missed, without: tuple[str, ...] = ()) -> Array:
    """Return what `calibration` does of every group but those `without`, from simulations, (k, groups)."""
    columns = [calibration(run, floor, tuple(name for names, _ in OFF_GROUPS for name in names))]
    for names, kind in OFF_GROUPS:
        if set(names) & set(without):
            continue
        step, none = STEP * TOLERANCES[kind], np.zeros(len(run.torque[run.rows]))
        parts = step * run.torque[run.rows], none
        if kind != "torque_constant":
            other = run.machine.axis.off_by(dict.fromkeys(names, 1.0 + step))
            torque, position = _changed(run, run.effects, dataclasses.replace(run.machine, axis=other))
            parts = -torque, -position
        columns.append(whitened(floor, *parts)[:, None] / STEP)
    return np.hstack(columns)


def calibration(run: Run, floor: Missed, without: tuple[str, ...] = ()) -> Array:
    """Return what every group of declared values but those `without` changes that is off by one tolerance, (k, groups).

    Quasi-static, as below the first resonance: x = r phi - F / k - r T / kt, the force F of the nut and the torque T of
    the screw being those of masses, friction and weight in the motion of the run.
    """
    a, cycle = run.machine.axis, run.machine.axis.sample_time
    r, gear = a.transmission, a.ratio
    velocity, turning = run.states[:, 5], run.states[:, 3]
    heavy = a.table_mass * (np.gradient(velocity, cycle) + a.fall)
    dry, wet = a.guide_coulomb * np.tanh(velocity / a.guide_velocity), a.guide_viscous * velocity
    spinning = a.screw_inertia * np.gradient(turning, cycle)
    drag = (a.nut_coulomb + a.bearing_coulomb) * np.tanh(turning / a.drag_speed)
    oil = a.nut_power * np.sign(turning) * np.abs(turning) ** (2.0 / 3.0)
    motor = a.motor_inertia * np.gradient(run.states[:, 1], cycle)
    force = heavy + dry + wet - a.counterbalance
    twisting = r * force + spinning + drag + oil
    none = np.zeros_like(force)

    def by_force(part: Array) -> tuple[Array, Array]:
        return part * r / gear, -part * (1.0 / a.axial_stiffness + r**2 / a.torsional_stiffness)

    def by_torque(part: Array) -> tuple[Array, Array]:
        return part / gear, -part * r / a.torsional_stiffness

    def turning_over(level: float, over: Array) -> Array:
        """Change with the logarithm of the speed that `over` is of."""
        return np.asarray(-level * over / np.cosh(np.minimum(np.abs(over), 300.0)) ** 2)

    change: dict[str, tuple[Array, Array]] = {
        "table_mass": by_force(heavy),
        "motor_inertia": (motor, none),
        "screw_inertia": by_torque(spinning),
        "guide_coulomb": by_force(dry),
        "guide_viscous": by_force(wet),
        "nut_coulomb": by_torque(drag),
        "nut_power": by_torque(oil),
        "axial_stiffness": (none, force / a.axial_stiffness),
        "torsional_stiffness": (none, r * twisting / a.torsional_stiffness),
        "axial_damping": (none, a.axial_damping * np.gradient(force, cycle) / a.axial_stiffness**2),
        "torsional_damping": (none, r * a.torsional_damping * np.gradient(twisting, cycle) / a.torsional_stiffness**2),
        "torque_constant": (run.torque, none),
    }
    columns = []
    for names, kind in OFF_GROUPS:
        if set(names) & set(without):
            continue
        torque, position = (TOLERANCES[kind] * part[run.rows] for part in change[names[0]])
        columns.append(whitened(floor, torque, position))
    for part in (
        by_force(turning_over(a.guide_coulomb, velocity / a.guide_velocity)),
        by_torque(turning_over(a.nut_coulomb + a.bearing_coulomb, turning / a.drag_speed)),
    ):
        columns.append(whitened(floor, *(WIDTH * one[run.rows] for one in part)))
    return np.column_stack(columns)


def missed(run: Run, seed: int) -> Missed:
    """Return what the plant of a run, led by the recorded motor angle, misses of its recording.

    What the encoder's steps do through friction and free play, and what the motor does between rows, are in it: rows at
    which it misses more than half of all do count for as much less, and what is left has a density of its own.
    """
    machine, c = run.machine, run.constants
    recorded = run.recorded(seed)
    step = longest_step(c, machine.axis.top_speed)
    torque, position = driven(machine, c, recorded["motor_angle"], at_rest(run.setpoint[0], c), step)
    errors = [recorded["motor_torque"] - torque]
    if machine.scale:
        errors.append(recorded["table_position"] - position)
    rate, weights, densities = 1.0 / machine.row_time, [], []
    sections = signal.butter(4, min(HIGHEST, 0.1 * rate), fs=rate, output="sos")
    for error in errors:
        inside = signal.sosfiltfilt(sections, error - np.median(error))
        local = np.sqrt(uniform_filter1d(inside**2, max(3, round(LOCAL * rate)), mode="nearest").clip(1e-300))
        weights.append(np.minimum(1.0, np.median(local) / local))
        densities.append(_smoothed(np.abs(_spectrum(error, weights[-1])) ** 2))
    hertz: Array = np.asarray(np.fft.rfftfreq(len(torque), machine.row_time), dtype=np.float64)
    return Missed(tuple(weights), tuple(densities), hertz, (hertz > 0.0) & (hertz <= min(HIGHEST, 0.2 * rate)))


def _spectrum(series: Array, weights: Array) -> npt.NDArray[np.complex128]:
    """Return the Fourier transform of a weighted series; white noise of unit variance has unit mean square."""
    window = np.hanning(len(series))
    values = weights * (series - np.average(series, weights=weights))
    spectrum: npt.NDArray[np.complex128] = np.fft.rfft(values * window) / math.sqrt(float(window @ window))
    return spectrum


def _smoothed(power: Array) -> Array:
    """Return the power averaged over neighbours: a fifth of the frequency on either side, eight at least."""
    total, at = np.concatenate([[0.0], np.cumsum(power)]), np.arange(len(power))
    reach = np.maximum(8, at // 5)
    first, last = np.maximum(at - reach, 0), np.minimum(at + reach + 1, len(power))
    return np.asarray((total[last] - total[first]) / (last - first))


def whitened(floor: Missed, torque: Array, position: Array) -> Array:
    """Return both channels, Fourier transformed, over what is missed: real numbers of unit variance, (k,)."""
    parts = []
    for values, weights, density in zip((torque, position), floor.weights, floor.densities, strict=False):
        scaled = (_spectrum(values, weights) * np.sqrt(2.0 / density))[floor.inside]
        parts += [scaled.real, scaled.imag]
    return np.concatenate(parts)


def visible(floor: Missed, base: Array, torque: Array, position: Array) -> Visible:
    """Return how visible changes of the rows, (rows,) each, are once declared values have done what they can.

    Args:
        floor: what the true plant misses.
        base: `calibration` of the run.
        torque, position: changes [N m], [m].
    """
    target = whitened(floor, torque, position)
    left, best, edges = remaining(target, base, free=0), [0.0, 0.0], [0.0, 0.0]
    hertz = floor.hertz[floor.inside]
    parts = left.reshape(len(floor.densities), 2, len(hertz))
    for channel, density in enumerate(floor.densities):
        noise = density[floor.inside]
        power = 0.5 * np.sum(parts[channel] ** 2, axis=0) * noise
        for edge in BANDS:
            inside = hertz <= edge
            ratio = math.sqrt(float(np.sum(power[inside]) / np.sum(noise[inside])))
            if ratio > best[channel]:
                best[channel], edges[channel] = ratio, edge
            if edge >= hertz[-1]:
                break
    return Visible(best[0], best[1], (edges[0], edges[1]))


def distance(target: Array, columns: Array, free: int) -> float:
    """Return the length of what columns leave of a target; all but the last `free` have unit prior deviation."""
    solution, scale = _solved(target, columns, free)
    priors = (solution / scale)[: columns.shape[1] - free]
    return math.hypot(float(np.linalg.norm(target - columns @ (solution / scale))), float(np.linalg.norm(priors)))


def remaining(target: Array, columns: Array, free: int) -> Array:
    """Return what columns leave of a target, (k,); all but the last `free` have unit prior deviation."""
    solution, scale = _solved(target, columns, free)
    return np.asarray(target - columns @ (solution / scale))


def _solved(target: Array, columns: Array, free: int) -> tuple[Array, Array]:
    """Return sizes of unit columns, and lengths of the columns."""
    count = columns.shape[1]
    scale = np.linalg.norm(columns, axis=0)
    scale[scale == 0.0] = 1.0
    prior = np.diag(np.concatenate([np.ones(count - free), np.zeros(free)]) / scale)
    stacked = np.vstack([columns / scale, prior])
    wanted = np.concatenate([target, np.zeros(count)])
    return np.asarray(np.linalg.lstsq(stacked, wanted, rcond=None)[0]), scale
