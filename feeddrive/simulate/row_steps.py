"""Rows of a recording and steps of its simulation: several steps a row where rows are slow, several rows a step where
they are fast, and what happens at the steps as rows show it.

What a comparison in the band can show, up to a tenth of the lower rate, passes. From steps of several rows it comes
back to a millionth, and a constant exactly: the mean of a position is a million times what a scale's noise is.
"""

from __future__ import annotations

from functools import lru_cache

import numpy as np
from numpy.lib.stride_tricks import sliding_window_view
from scipy.signal import firwin, upfirdn

from feeddrive.typing import FloatArray

TAPS, KAISER = 4, 7.86
"""Samples on either side over which a torque is averaged, and the window's shape: flat to 3e-4 up to a tenth of the
sample rate, and 1e-4 of what comes back to there from nine tenths and beyond (Kaiser, 80 dB)."""

THINNING, BETWEEN = (12, 12.0), (5, 11.5)
"""Steps on either side that the filters take, and their Kaiser windows' shapes (120 dB). What drives friction is not to
be shaken by what folds back: flat up to a third of the steps' rate, nothing from two thirds on. What comes back from
between the steps is filtered once more, by the band: flat up to a tenth, nothing from nine tenths on."""


def on_grid(series: FloatArray, substeps: int) -> FloatArray:
    """Samples, (n,), and straight between them, on a grid; (m,)."""
    at = np.arange((len(series) - 1) * substeps + 1) / substeps
    return np.interp(at, np.arange(len(series)), series) if substeps > 1 else series


def at_rate(series: FloatArray, substeps: int) -> FloatArray:
    """A series on a grid of `substeps` a sample, (m,), as samples show it, (n,): without what folds back as slow.

    A drive holds its torque from row to row, and the rows of the motor's angle hold what a jump of friction between
    them did only as far as it moved the motor, that is hardly beyond their own rate. The torque that the plant asks for
    is taken as far, by a zero-phase filter; read at the rows alone, a jump would be early or late by half a row.
    """
    if substeps == 1:
        return series
    taps = _taps(TAPS, KAISER, substeps)
    before, behind = np.full(TAPS * substeps, series[0]), np.full(TAPS * substeps, series[-1])
    filtered: FloatArray = np.convolve(np.concatenate([before, series, behind]), taps, mode="valid")
    return filtered[::substeps].copy()


def step_count(rows: int, every: int) -> int:
    """Instants of steps of `every` rows that reach from the first of so many rows to the last, or beyond it."""
    return -(-(rows - 1) // every) + 1


def at_steps(series: FloatArray, every: int, is_rate: bool = False) -> FloatArray:
    """A series, (n,), low-passed and at every k-th row, (`step_count`,).

    At its ends it is continued by its mirror image: about the end point, or a rate about the end.
    """
    reach = THINNING[0] * every
    beyond = reach + (step_count(len(series), every) - 1) * every - (len(series) - 1)
    before, behind = series[reach:0:-1], series[-2 : -beyond - 2 : -1]
    if not is_rate:
        before, behind = 2 * series[0] - before, 2 * series[-1] - behind
    filtered = upfirdn(_taps(*THINNING, every), np.concatenate([before, series, behind]), down=every)
    lead = 2 * THINNING[0]
    found: FloatArray = filtered[lead : lead + step_count(len(series), every)].copy()
    return found


def at_rows(series: FloatArray, every: int, rows: int) -> FloatArray:
    """A series at the steps, (m,), at all rows between them, (rows,)."""
    reach = BETWEEN[0]
    before, behind = 2 * series[0] - series[reach:0:-1], 2 * series[-1] - series[-2 : -reach - 2 : -1]
    about = sliding_window_view(np.concatenate([before, series, behind]), 2 * reach + 1)
    found: FloatArray = (np.ascontiguousarray(about) @ _taps_between(every)).ravel()[:rows]
    return found


@lru_cache(maxsize=16)
def _taps(reach: int, shape: float, every: int) -> FloatArray:
    taps: FloatArray = np.asarray(firwin(2 * reach * every + 1, 1 / every, window=("kaiser", shape)))
    return taps


@lru_cache(maxsize=16)
def _taps_between(every: int) -> FloatArray:
    """Shares, (2 reach + 1, every), of the steps about one in it and the rows behind it; those of a row add up to one.

    A row p behind a step is p / every of a step nearer to those that follow.
    """
    reach = BETWEEN[0]
    taps = np.append(_taps(*BETWEEN, every), np.zeros(every - 1)).reshape(2 * reach + 1, every)[::-1]
    shares: FloatArray = np.ascontiguousarray(taps / np.sum(taps, axis=0))
    return shares
