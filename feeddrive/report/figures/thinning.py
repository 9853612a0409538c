"""Long series made short enough to draw: envelopes, thinned points, binned quantiles."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from feeddrive.typing import BoolArray, FloatArray


@dataclass(frozen=True)
class Bins:
    """Binned distribution of a residual: centres and the 10, 50 and 90 % quantiles, NaN in thin bins; shape (bins,).

    `share` is the part of the residual's variance that the bins' medians explain, from 0 to 1.
    """

    centre: FloatArray
    low: FloatArray
    median: FloatArray
    high: FloatArray
    share: float


def envelope(time: FloatArray, values: FloatArray, columns: int = 700) -> tuple[FloatArray, FloatArray]:
    """The smallest and the largest sample of each column of the drawing, so that no peak is lost.

    Time and values, (n,), become 2 * columns points at most; NaN is left out, and a column without samples is NaN,
    which breaks the line.
    """
    if values.size <= 2 * columns:
        return time, values
    edges = np.linspace(0, values.size, columns + 1).astype(np.int64)[:-1]
    missing = np.isnan(values)
    low = np.minimum.reduceat(np.where(missing, np.inf, values), edges)
    high = np.maximum.reduceat(np.where(missing, -np.inf, values), edges)
    pairs = np.column_stack([low, high]).ravel()
    pairs[~np.isfinite(pairs)] = np.nan
    return np.repeat(time[edges], 2), pairs


def thin(count: int, most: int) -> slice:
    """A slice that keeps at most `most` of `count` samples, evenly spread."""
    return slice(None, None, max(1, -(-count // most)))


def left_out_stretches(time: FloatArray, values: FloatArray, shortest: float) -> list[tuple[float, float]]:
    """Begin and end [s] of the runs of NaN in `values` that last at least `shortest` seconds."""
    return [
        (float(time[first]), float(time[last - 1]))
        for first, last in runs(np.isnan(values))
        if time[last - 1] - time[first] >= shortest
    ]


def runs(mask: BoolArray) -> list[tuple[int, int]]:
    """First and one-past-last index of each run of True in `mask`, shape (n,)."""
    edges = np.flatnonzero(np.diff(np.concatenate([[False], mask, [False]]).astype(np.int8)))
    return [(int(first), int(last)) for first, last in edges.reshape(-1, 2)]


def binned(variable: FloatArray, residual: FloatArray, edges: FloatArray, fewest: int = 20) -> Bins:
    """Quantiles of a residual, (n,), over bins of a variable, (n,), by rising edges, (bins + 1,), all finite.

    Bins with fewer samples than `fewest` are NaN; the share of the variance that they explain goes with them.
    """
    count = edges.size - 1
    index = _bin_index(variable, edges)
    order = np.argsort(index, kind="stable")
    starts = np.searchsorted(index[order], np.arange(count + 1))
    quantiles = np.full((3, count), np.nan)
    for bin_number in range(count):
        members = residual[order[starts[bin_number] : starts[bin_number + 1]]]
        if members.size >= fewest:
            quantiles[:, bin_number] = np.quantile(members, (0.1, 0.5, 0.9))
    share = _explained_share(residual, quantiles[1][index])
    return Bins(0.5 * (edges[1:] + edges[:-1]), quantiles[0], quantiles[1], quantiles[2], share)


def balanced(variable: FloatArray, residual: FloatArray, forward: BoolArray, edges: FloatArray) -> Bins:
    """As `binned`, the middle line being the mean of the medians of both directions of travel.

    What depends on the direction alone (friction, backlash) then leaves the line flat instead of flipping it. `forward`
    is whether the table moves in + direction, (n,); the plain median holds where no bin was passed in both.
    """
    pooled = binned(variable, residual, edges)
    there = binned(variable[forward], residual[forward], edges).median
    back = binned(variable[~forward], residual[~forward], edges).median
    line = 0.5 * (there + back)
    if not np.any(np.isfinite(line)):
        return pooled
    index = _bin_index(variable, edges)
    return Bins(pooled.centre, pooled.low, line, pooled.high, _explained_share(residual, line[index]))


def _bin_index(variable: FloatArray, edges: FloatArray) -> NDArray[np.intp]:
    """Number of the bin of each sample; what lies outside counts to the first or the last bin."""
    return np.clip(np.searchsorted(edges, variable, side="right") - 1, 0, edges.size - 2)


def _explained_share(residual: FloatArray, curve: FloatArray) -> float:
    """Share of the variance of a residual that a curve at the same samples explains."""
    kept = np.isfinite(curve)
    if np.count_nonzero(kept) < 2:
        return float("nan")
    total = float(np.var(residual[kept]))
    if total == 0.0:
        return 0.0
    return max(0.0, 1.0 - float(np.var(residual[kept] - curve[kept])) / total)
