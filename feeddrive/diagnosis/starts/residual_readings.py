"""What the present residual holds: a force on the table, a friction over the position, the strongest orders."""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np
from scipy.signal import find_peaks

from feeddrive.diagnosis.finding.scene import Scene
from feeddrive.plant.analysis.stiffness_budget import static_stiffness
from feeddrive.typing import FloatArray

BINS = 60
"""Bins along the stroke."""

BINS_PER_TURN = 256
"""Angle bins per revolution; the highest order is a quarter of it."""

LEAST_PERIODS = 5
"""Periods in the travel below which the periodogram takes a trend over the stroke for a sine, or a sine for one."""

FEWEST_PERIODS = 2
"""Periods in the travel from which a sine is told from a line over the stroke, once both are fitted together."""

SKIRT = math.sqrt(2)
"""Frequency over the edge of the band up to which a sine is looked for: a sixteenth of it passes the filter, and a
ripple of a drive stands far above its noise."""

LONGEST_PERIOD = 2.0
"""Revolutions of the longest period of a lead that is looked for beside a line: a longer one is a curve along the
stroke, which the lead map takes. A force over some turns has no map."""

OVERSAMPLING = 8
"""Zero padding, so that a peak is met to an eighth of the resolution."""

TOLD = 1e-6
"""Share of their product by which sine and cosine stand apart on the samples: below it both are one column, but for
rounding, and what they take is none of either."""


def residual_force(scene: Scene, at: int) -> FloatArray:
    """Force that resists + motion beyond what is predicted [N], shape (n,), of the recording number `at`.

    From the torque over the radius; without a torque from the table lagging on the spring that holds it.
    """
    return residual_forces(scene, at)[0]


def residual_forces(scene: Scene, at: int) -> list[FloatArray]:
    """The force that is left, by every channel that shows it, the torque's first; shape (n,) each.

    On a soft drive the lag of the table tells forces that are lost in the noise of the torque.
    """
    residual, forces = scene.residuals[at], []
    if "motor_torque" in residual:
        forces.append(residual["motor_torque"] / scene.plant.chain.motor_radius)
    if "table_position" in residual and scene.plant.chain.elastic:
        forces.append(-static_stiffness(scene.plant, scene.plant.middle) * residual["table_position"])
    return forces


@dataclass(frozen=True)
class PositionCurve:
    """Friction beyond the model along the stroke: position [m], force [N], samples, each of shape (k,)."""

    position: FloatArray
    force: FloatArray
    samples: FloatArray


def friction_over_position(position: FloatArray, velocity: FloatArray, force: FloatArray) -> PositionCurve | None:
    """Mean resisting force per position bin, from both directions.

    Args:
        position: [m], shape (n,).
        velocity: [m/s], shape (n,).
        force: residual force, positive where the recording needs more [N], shape (n,).

    Returns:
        The curve, or None where the table hardly moves.
    """
    moving = np.abs(velocity) > 0.01 * np.abs(velocity).max(initial=0.0)
    if np.sum(moving) < 10 * BINS:
        return None
    x, resisting = position[moving], (force * np.sign(velocity))[moving]
    low, high = np.quantile(x, [0.002, 0.998])
    if not high > low:
        return None
    edges = np.linspace(low, high, BINS + 1)
    bins = np.clip(np.digitize(x, edges) - 1, 0, BINS - 1)
    samples = np.bincount(bins, minlength=BINS)
    mean = np.bincount(bins, weights=resisting, minlength=BINS) / np.maximum(samples, 1)
    filled = samples > 0
    centres = 0.5 * (edges[1:] + edges[:-1])
    return PositionCurve(centres[filled], mean[filled], samples[filled].astype(float))


def bump_of(curve: PositionCurve, count: int = 3) -> list[tuple[float, float, float]]:
    """Peak [N], centre [m] and half width [m] of the Gaussian bumps that fit the curve best.

    A scan over centre and width, each with the best peak; bins weigh by the root of their samples.
    """
    stroke = curve.position[-1] - curve.position[0]
    weight = np.sqrt(curve.samples)
    found = []
    for width in stroke * np.array([0.03, 0.05, 0.08, 0.12, 0.18, 0.28, 0.45]):
        for centre in np.linspace(curve.position[0], curve.position[-1], 41):
            shape = np.exp(-(((curve.position - centre) / width) ** 2))
            power = float(np.sum(weight * shape**2))
            peak = float(np.sum(weight * shape * curve.force)) / power
            found.append((peak**2 * power, peak, float(centre), float(width)))
    found.sort(reverse=True)
    chosen: list[tuple[float, float, float]] = []
    for _, peak, centre, width in found:
        if all(abs(centre - other[1]) > 0.5 * max(width, other[2]) for other in chosen):
            chosen.append((peak, centre, width))
        if len(chosen) == count:
            break
    return chosen


def strongest_orders(
    angle: FloatArray, residual: FloatArray, highest: float = BINS_PER_TURN / 4, count: int = 3, lowest: float = 0.0,
    tapered: bool = True,
) -> list[float]:  # fmt: skip
    """Orders per revolution of the sines that take most of a residual, by least squares beside a mean.

    The residual is averaged per angle bin first, so that rests and slow strokes do not weigh by their duration. Bins
    that no sample met, between slow reversals and at speed, count for nothing: of a curve drawn across them, or of
    zeros in their place, the largest peaks would be those of the gaps. Source: Zechmeister and Kuerster, Astron.
    Astrophys. 496 (2009) 577, equations 4 to 15, the bins tapered so that a trend does not leak into high orders.

    Args:
        angle: shape (n,) [rad].
        residual: shape (n,).
        highest: order up to which peaks count.
        count: how many.
        lowest: order from which peaks count.
        tapered: whether bins weigh less towards the ends of the travel; else every bin that was met weighs alike.

    Returns:
        Orders, the strongest first; empty if the angle covers less than two revolutions.
    """
    bins = np.floor(angle * BINS_PER_TURN / (2 * np.pi)).astype(int)
    bins -= bins.min()
    size = int(bins.max()) + 1
    turns = size / BINS_PER_TURN
    if turns < 2:
        return []
    samples = np.bincount(bins, minlength=size)
    mean = np.bincount(bins, weights=residual, minlength=size) / np.maximum(samples, 1)
    weight = np.where(samples > 0, np.hanning(size + 2)[1:-1] if tapered else 1.0, 0.0)
    share = _shares_of_sines(mean, weight / weight.sum())
    orders = np.arange(len(share)) * BINS_PER_TURN / (OVERSAMPLING * size)
    allowed = (orders > max(lowest, LEAST_PERIODS / turns)) & (orders < min(highest, BINS_PER_TURN / 4))
    share = np.where(allowed, share, 0.0)
    peaks, _ = find_peaks(share, distance=OVERSAMPLING)
    best = peaks[np.argsort(share[peaks])[::-1][:count]]
    # the top of the parabola through a peak and its neighbours: an eighth of the resolution is many deviations
    below, top, above = share[best - 1], share[best], share[best + 1]
    aside = 0.5 * (above - below) / np.maximum(2 * top - above - below, np.finfo(float).tiny)
    return [float(one) for one in orders[best] + np.where(np.minimum(below, above) > 0, aside, 0.0) * orders[1]]


def _shares_of_sines(values: FloatArray, weight: FloatArray) -> FloatArray:
    """Share of the weighted square about the mean that a sine of each frequency takes, `OVERSAMPLING` times as fine.

    Args:
        values: at even places, (n,).
        weight: of each, (n,), one together; 0 where there is no value.
    """
    size = OVERSAMPLING * len(values)
    beyond = np.where(weight > 0, values - float(weight @ values), 0.0)
    square = float(weight @ beyond**2)
    taken, window = np.fft.rfft(weight * beyond, size), np.fft.fft(weight, size)
    once, twice = window[: len(taken)], window[2 * np.arange(len(taken)) % size]
    # sums of cos, sin, cos^2, sin^2 and cos sin about their means; transforms are of exp(-i)
    cosine, sine = once.real, -once.imag
    cosines, sines = 0.5 * (1 + twice.real) - cosine**2, 0.5 * (1 - twice.real) - sine**2
    both = -0.5 * twice.imag - cosine * sine
    along = sines * taken.real**2 + cosines * taken.imag**2 + 2 * both * taken.real * taken.imag
    apart = cosines * sines - both**2
    told = apart > TOLD * cosines * sines  # else a mean and one column do as well
    return np.where(told, along, 0.0) / np.where(told, apart * max(square, np.finfo(float).tiny), 1.0)


def sine_at(angle: FloatArray, residual: FloatArray, order: float) -> tuple[float, float]:
    """Amplitude and phase of the best sine of this order: residual = A sin(order angle + phase) + constant."""
    columns = np.column_stack([np.sin(order * angle), np.cos(order * angle), np.ones(len(angle))])
    a, b, _ = np.linalg.lstsq(columns, residual, rcond=None)[0]
    return float(np.hypot(a, b)), float(np.arctan2(b, a))


@dataclass(frozen=True)
class Sine:
    """A sine over an angle: residual = amplitude sin(order angle + phase), and the share of the square it takes."""

    order: float
    amplitude: float
    phase: float
    share: float


def strongest_sines(
    angle: FloatArray, residual: FloatArray, speed: FloatArray, edge: float, count: int = 3,
    longest: float = LONGEST_PERIOD,
) -> list[Sine]:  # fmt: skip
    """Sines that take most of a residual, each looked for at the samples at which it is in the band.

    An order n shows where n |speed| is below the edge, or little above: a high one at low speed alone, where the fast
    strokes, in which it is filtered off, or sampled as another one, are noise. So octaves of orders are looked for,
    each where the speed is so low that the whole octave is in the band; what each takes of the square is compared (of
    noise the best takes as much of few samples as of many).

    Args:
        angle: shape (n,) [rad].
        residual: shape (n,).
        speed: rate of the angle, (n,) [rad/s].
        edge: of the band [Hz].
        count: how many.
        longest: period in revolutions up to which one of few periods in the travel is looked for.

    Returns:
        Sines, the one that takes most first.
    """
    fastest, square = float(np.max(np.abs(speed), initial=0.0)), float(residual @ residual)
    if fastest == 0.0 or square == 0.0:
        return []
    seen = 2 * np.pi * SKIRT * edge
    found, lowest, highest = _longest_sine(angle, residual, longest), 0.0, seen / fastest
    while lowest < BINS_PER_TURN / 4:
        slow = np.abs(speed) * highest <= seen * (1 + 1e-9)
        if not slow.any():
            break
        there, left = angle[slow], residual[slow]
        line = np.column_stack([np.ones(len(there)), there - np.mean(there)])
        by_line, straight = _taken(line, left)
        bent = left - line @ straight
        # slow at the ends of the travel alone: orders stand in fringes as fine as the whole of it, which a taper hides
        orders = [
            one for taper in (True, False) for one in strongest_orders(there, bent, highest, count, lowest, taper)
        ]
        for order in orders:
            columns = np.column_stack([np.sin(order * there), np.cos(order * there), line])
            # of some slow samples at the reversals a sine of any size passes near, and takes no more than is there
            taken, (a, b, *_) = _taken(columns, left)
            found.append(Sine(order, float(np.hypot(a, b)), float(np.arctan2(b, a)), (taken - by_line) / square))
        lowest, highest = highest, 2 * highest
    best = list[Sine]()
    apart = np.pi / max(float(np.ptp(angle)), 1e-12)  # two orders nearer than half the resolution are one
    for one in sorted(found, key=lambda one: -one.share):
        if all(abs(one.order - other.order) > apart for other in best):
            best.append(one)
    return best[:count]


def _longest_sine(angle: FloatArray, residual: FloatArray, longest: float) -> list[Sine]:
    """The sine of few periods in the travel that takes most of a residual beside a line; none where there is no room.

    On a short stroke the error of every revolution has but some periods, which a periodogram cannot tell from a trend.
    """
    turns = float(np.ptp(angle)) / (2 * np.pi)
    lowest, highest = max(FEWEST_PERIODS / turns, 1 / longest), LEAST_PERIODS / turns
    bins = np.floor((angle - angle.min()) * BINS_PER_TURN / (2 * np.pi)).astype(int)
    samples = np.bincount(bins)
    met = samples > 0
    there = angle.min() + (np.flatnonzero(met) + 0.5) * 2 * np.pi / BINS_PER_TURN
    root = np.sqrt(samples[met])  # the mean of a bin weighs as its samples do
    mean = np.bincount(bins, weights=residual)[met] / samples[met] * root
    line = np.column_stack([np.ones(len(there)), there - np.mean(there)]) * root[:, None]
    square, by_line = float(residual @ residual), _taken(line, mean)[0]
    best: list[Sine] = []
    for order in np.arange(lowest, highest, 1 / (OVERSAMPLING * turns)):
        waves = np.column_stack([np.sin(order * there), np.cos(order * there)]) * root[:, None]
        taken, (a, b, *_) = _taken(np.column_stack([waves, line]), mean)
        if not best or (taken - by_line) / square > best[0].share:
            share = (taken - by_line) / square
            best = [Sine(float(order), float(np.hypot(a, b)), float(np.arctan2(b, a)), share)]
    return best


def _taken(columns: FloatArray, residual: FloatArray) -> tuple[float, FloatArray]:
    """What columns take of the square of a residual, and their coefficients.

    By normal equations: a few columns, of which `TOLD` is the least that stands apart.
    """
    length = np.sqrt(np.einsum("ij,ij->j", columns, columns))
    size = np.where(length > 0, length, 1.0)
    normal = columns.T @ columns / np.outer(size, size)
    solved = np.linalg.lstsq(normal, columns.T @ residual / size, rcond=TOLD)[0]
    coefficients = np.asarray(solved / size, dtype=np.float64)
    left = residual - columns @ coefficients
    return float(residual @ residual - left @ left), coefficients
