"""The strongest sines of a residual over an angle: by octaves of orders, among fringes, and of few periods."""

from __future__ import annotations

import math
from dataclasses import dataclass
from functools import lru_cache

import numpy as np
from scipy.fft import fft, ifft, next_fast_len
from scipy.signal import find_peaks

from feeddrive.typing import BoolArray, ComplexArray, FloatArray, IntegerArray

BINS_PER_TURN = 256
"""Angle bins per revolution; the highest order is a quarter of it."""

LEAST_PERIODS = 5
"""Periods in the travel below which the periodogram takes a trend over the stroke for a sine, or a sine for one."""

FEWEST_PERIODS = 2
"""Periods in the travel from which a sine is told from a line over the stroke, once both are fitted together."""

SKIRT = math.sqrt(2)
"""Frequency over the edge of the band up to which a sine is looked for: a sixteenth of it passes the filter, and a
ripple of a drive stands far above its noise."""

LOST = 0.2
"""Share of its samples that an octave of orders may lose towards its upper end, and is cut where it would lose more: a
sine that is looked for in four fifths of where it shows takes four fifths of what it does."""

FINEST = 2**0.125
"""Width of such a cut at least, an eighth of an octave."""

LONGEST_PERIOD = 2.0
"""Revolutions of the longest period of a lead that is looked for beside a line: a longer one is a curve along the
stroke, which the lead map takes. A force over some turns has no map."""

COVERED = 0.5
"""Share of the travel that samples meet, above which a taper leaves most of them: its own mean is a half."""

MOST = 0.5
"""Share of the square of a residual from which a sine is most of it."""

OVERSAMPLING = 8
"""Zero padding, so that a peak is met to an eighth of the resolution."""

FRINGES = 16 * OVERSAMPLING
"""Reach about a peak within which a fringe of it is looked for: where most time is spent at places of a sixteenth of
the travel, the order stands among fringes of about its size that reach so far."""

AS_MUCH = 0.5
"""Part of what the best sine takes, from which another one is asked as well: its fringe, or the best of an octave."""

TOLD = 1e-6
"""Share of their product by which sine and cosine stand apart on the samples: below it both are one column, but for
rounding, and what they take is none of either."""


def strongest_orders(
    angle: FloatArray, residual: FloatArray, highest: float = BINS_PER_TURN / 4, count: int = 3, lowest: float = 0.0,
    tapered: bool = True,
) -> list[float]:  # fmt: skip
    """Orders per revolution of the sines that take most of a residual, by least squares beside a mean.

    The residual is averaged per angle bin first, so that rests and slow strokes do not weigh by their duration. Bins
    that no sample met, between slow reversals and at speed, count for nothing: of a curve drawn across them, or of
    zeros in their place, the largest peaks would be those of the gaps. Source: Zechmeister and Kuerster, Astron.
    Astrophys. 496 (2009) 577, equations 4 to 15, the bins tapered so that a trend does not leak into high orders.
    Where most samples lie at some places of the travel, a peak of tapered bins is a fringe of theirs: the orders about
    it that take most of the samples stand in its place.

    Args:
        angle: shape (n,) [rad].
        residual: shape (n,).
        highest: order up to which peaks count.
        count: how many.
        lowest: order from which peaks count.
        tapered: whether bins weigh less towards the ends of the travel; else every bin that was met weighs alike.

    Returns:
        Orders, the strongest first; empty if the angle covers less than a revolution.
    """
    bins = np.floor(angle * BINS_PER_TURN / (2 * np.pi)).astype(int)
    bins -= bins.min()
    size = int(bins.max()) + 1
    turns = size / BINS_PER_TURN
    if turns < 1:
        return []
    samples = np.bincount(bins, minlength=size)
    mean = np.bincount(bins, weights=residual, minlength=size) / np.maximum(samples, 1)
    weight = np.where(samples > 0, np.hanning(size + 2)[1:-1] if tapered else 1.0, 0.0)
    orders = np.arange(OVERSAMPLING * size // 2 + 1) * BINS_PER_TURN / (OVERSAMPLING * size)
    allowed = np.flatnonzero((orders > max(lowest, LEAST_PERIODS / turns)) & (orders < min(highest, BINS_PER_TURN / 4)))
    if not len(allowed):
        return []
    tapering = _shares_of_sines(mean, weight / weight.sum(), allowed)
    peaks, _ = find_peaks(tapering, distance=OVERSAMPLING)
    best = peaks[np.argsort(tapering[peaks])[::-1][:count]]
    if tapered:
        share = _shares_of_sines(mean, samples / samples.sum(), allowed)
        best = _with_fringes(share, best)[:count]
    else:
        share = tapering
    # the top of the parabola through a peak and its neighbours: an eighth of the resolution is many deviations
    below, top, above = share[best - 1], share[best], share[best + 1]
    aside = 0.5 * (above - below) / np.maximum(2 * top - above - below, np.finfo(float).tiny)
    inside = (np.minimum(below, above) > 0) & (np.abs(aside) < 1)
    return [float(one) for one in orders[best] + np.where(inside, aside, 0.0) * orders[1]]


def _with_fringes(share: FloatArray, peaks: IntegerArray) -> IntegerArray:
    """Tops of what sines take of the samples, (n,), about some peaks: those that take most of what the highest does."""
    near = np.unique(np.clip(peaks[:, None] + np.arange(-FRINGES, FRINGES + 1), 1, len(share) - 2))
    tops = near[(share[near] >= share[near - 1]) & (share[near] > share[near + 1])]
    most = tops[share[tops] > AS_MUCH * np.max(share[tops], initial=0.0)]
    found: IntegerArray = most[np.argsort(share[most])[::-1]]
    return found


def _shares_of_sines(values: FloatArray, weight: FloatArray, allowed: IntegerArray) -> FloatArray:
    """Share of the weighted square about the mean that a sine of each frequency takes, `OVERSAMPLING` times as fine.

    Args:
        values: at even places, (n,).
        weight: of each, (n,), one together; 0 where there is no value.
        allowed: frequencies that are asked for, as they follow one another; the share of others is 0.
    """
    size = OVERSAMPLING * len(values)
    beyond = np.where(weight > 0, values - float(weight @ values), 0.0)
    square = float(weight @ beyond**2)
    first, last = int(allowed[0]), int(allowed[-1])
    taken, once = (_lines(one, size, first, last, 1) for one in (weight * beyond, weight))
    twice = _lines(weight, size, first, last, 2)
    # sums of cos, sin, cos^2, sin^2 and cos sin about their means; transforms are of exp(-i)
    cosine, sine = once.real, -once.imag
    cosines, sines = 0.5 * (1 + twice.real) - cosine**2, 0.5 * (1 - twice.real) - sine**2
    both = -0.5 * twice.imag - cosine * sine
    along = sines * taken.real**2 + cosines * taken.imag**2 + 2 * both * taken.real * taken.imag
    apart = cosines * sines - both**2
    told = apart > TOLD * cosines * sines  # else a mean and one column do as well
    shares = np.zeros(size // 2 + 1)
    shares[allowed] = np.where(told, along, 0.0) / np.where(told, apart * max(square, np.finfo(float).tiny), 1.0)
    return shares


def _lines(values: FloatArray, size: int, first: int, last: int, every: int) -> ComplexArray:
    """Some lines of the transform of values, (n,), that zeros continue to `size`: `every` times `first` to `last`.

    A size with a large prime factor takes long, and an octave of orders is a small part of all. By the chirp transform:
    2 j k = j^2 + k^2 - (k - j)^2. Source: Rabiner, Schafer and Rader, IEEE Trans. Audio 17 (1969) 86.
    """
    count, asked = len(values), last - first + 1
    room = next_fast_len(count + asked - 1)
    turned = np.exp(-2j * np.pi / size * (every * first * np.arange(count) % size))
    chirp, kernel = _chirp(count, asked, size, every)
    lines: ComplexArray = ifft(fft(values * turned * chirp[:count], room) * kernel)[count - 1 : count - 1 + asked]
    return lines * chirp[:asked]


@lru_cache(maxsize=4)
def _chirp(count: int, asked: int, size: int, every: int) -> tuple[ComplexArray, ComplexArray]:
    """exp(-i pi every m^2 / size), and the transform of its inverse about 0, from 1 - `count` to `asked` - 1."""
    squares = np.arange(max(count, asked)) ** 2 * every % (2 * size)  # of whole numbers: the phase keeps its digits
    chirp = np.exp(-1j * np.pi / size * squares)
    about = np.concatenate([chirp[count - 1 : 0 : -1], chirp[:asked]]).conj()
    return chirp, fft(about, next_fast_len(count + asked - 1))


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
    angle: FloatArray, residual: FloatArray, speed: FloatArray, edge: float, count: int = 3
) -> list[Sine]:
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

    Returns:
        Sines, the one that takes most first; the best of an octave that takes half as much stands among them, as some
        slow samples at the reversals give three fringes of one sine before another that the strokes show.
    """
    square, found = float(residual @ residual), longest_sine(angle, residual, LONGEST_PERIOD)
    if square == 0.0:
        return []
    foremost = []
    for slow, lowest, highest in _octaves(speed, edge):
        there, left = angle[slow], residual[slow]
        mean = np.ones((len(there), 1))
        level, _ = _taken(mean, left)
        # of some slow samples at the reversals a sine of any size passes near, and takes no more than is there
        sines = [
            _sine_of(order, there, left, mean, level, square)
            for order in strongest_orders(there, left, highest, count, lowest)
        ]
        foremost += sorted(sines, key=_share)[-1:]
        found += sines
    found.sort(key=_share, reverse=True)
    kept = found[:count]
    return [*kept, *(one for one in found[count:] if one in foremost and one.share > AS_MUCH * kept[0].share)]


def _share(one: Sine) -> float:
    return one.share


def sine_among_fringes(angle: FloatArray, residual: FloatArray, speed: FloatArray, edge: float) -> list[Sine]:
    """The sine that takes most of a residual that shows it at some places of the travel alone, or none.

    A drive that moves fast between slow reversals shows a high order at the ends of its travel: the order stands in
    fringes as fine as the whole travel, which the taper of `strongest_orders` hides, and a trend over the stroke meets
    one of them. So every bin that was met weighs alike, beside a line. Only a sine that takes most of what is left is
    told so: of less, what friction does at the reversals may be as much. Arguments as `strongest_sines`.
    """
    square, found = float(residual @ residual), list[Sine]()
    for slow, lowest, highest in _octaves(speed, edge) if square > 0 else []:
        there, left = angle[slow], residual[slow]
        if _covered(there) > COVERED:
            continue
        line = np.column_stack([np.ones(len(there)), there - np.mean(there)])
        level, coefficients = _taken(line, left)
        for order in strongest_orders(there, left - line @ coefficients, highest, 3, lowest, tapered=False):
            found.append(_sine_of(order, there, left, line, level, square))
    return [one for one in sorted(found, key=lambda one: -one.share)[:1] if one.share > MOST]


def _octaves(speed: FloatArray, edge: float) -> list[tuple[BoolArray, float, float]]:
    """Samples at which some orders are all in the band, (n,), and their ends: an octave, or as far as most samples go.

    Where the axis moves at one speed the orders that leave the band there are few, and those below them are looked for
    in its strokes: a drive that overshoots is a little faster for a moment.
    """
    rates = np.sort(np.abs(speed))
    if not len(rates) or rates[-1] == 0.0:
        return []
    seen = 2 * np.pi * SKIRT * edge
    octaves, lowest, highest = [], 0.0, seen / rates[-1]
    while lowest < BINS_PER_TURN / 4:
        slow = np.abs(speed) * highest <= seen * (1 + 1e-9)
        if not slow.any():
            break
        octaves.append((slow, lowest, highest))
        most = rates[math.ceil((1 - LOST) * np.count_nonzero(slow)) - 1]  # of those, as far as they go together
        lowest, highest = highest, min(max(seen / max(most, seen / (2 * highest)), FINEST * highest), 2 * highest)
    return octaves


def _sine_of(
    order: float, angle: FloatArray, residual: FloatArray, beside: FloatArray, level: float, square: float
) -> Sine:
    """The sine of an order that takes most of a residual, (n,), beside columns, (n, k), that take `level` alone."""
    columns = np.column_stack([np.sin(order * angle), np.cos(order * angle), beside])
    taken, (a, b, *_) = _taken(columns, residual)
    return Sine(float(order), float(np.hypot(a, b)), float(np.arctan2(b, a)), (taken - level) / square)


def _covered(angle: FloatArray) -> float:
    """Share of the angle bins between the first and the last one that samples meet."""
    bins = np.unique(np.floor(angle * BINS_PER_TURN / (2 * np.pi)).astype(int))
    return len(bins) / float(bins[-1] - bins[0] + 1)


def longest_sine(angle: FloatArray, residual: FloatArray, longest: float) -> list[Sine]:
    """The sine of few periods in the travel that takes most of a residual beside a line; none where there is no room.

    On a short stroke the error of every revolution has but some periods, which a periodogram cannot tell from a trend.

    Args:
        angle: shape (n,) [rad].
        residual: shape (n,).
        longest: period in revolutions up to which it is looked for.
    """
    turns, square = float(np.ptp(angle)) / (2 * np.pi), float(residual @ residual)
    if turns == 0.0 or square == 0.0:
        return []
    lowest, highest = max(FEWEST_PERIODS / turns, 1 / longest), LEAST_PERIODS / turns
    bins = np.floor((angle - angle.min()) * BINS_PER_TURN / (2 * np.pi)).astype(int)
    samples = np.bincount(bins)
    met = samples > 0
    there = angle.min() + (np.flatnonzero(met) + 0.5) * 2 * np.pi / BINS_PER_TURN
    root = np.sqrt(samples[met])  # the mean of a bin weighs as its samples do
    mean = np.bincount(bins, weights=residual)[met] / samples[met] * root
    line = np.column_stack([np.ones(len(there)), there - np.mean(there)]) * root[:, None]
    by_line = _taken(line, mean)[0]
    best: list[Sine] = []
    for order in np.arange(lowest, highest, 1 / (OVERSAMPLING * turns)):
        waves = np.column_stack([np.sin(order * there), np.cos(order * there)]) * root[:, None]
        taken, (a, b, *_) = _taken(np.column_stack([waves, line]), mean)
        share = (taken - by_line) / square
        if not best or share > best[0].share:
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
