"""What is the same in every recording is taken out: maps over position, common to all, beside terms of each.

    minimise  sum_i |y_i - A_i theta_i - B_i beta|^2 + sum_i |s theta_i / w|^2        over theta_i, beta

With the triangle [R11 R12 z1; 0 R22 z2] of recording i the maps see R22, z2 alone, and theta_i follows from R11
theta_i = z1 - R12 beta: hundreds of recordings are one small least-squares problem. A level or slope that a map
could hold as well as a term is the term's (maps have mean zero over their rows, that of the lead slope zero too). The
maps have a prior of their own, as wide as forces and lead errors are: a place at which hardly a row is, or a stroke of
part of a revolution, on which a curve, a ripple and a force are one, says nothing of them.
A tight place drags more where all drags more: the friction map of each recording is that of all times a free factor.
The last sum is a weak prior of width w, so that a recording that does not show a term says nothing of it and not
anything.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass

import numpy as np

from feeddrive.trend.regressors import TERMS, Grid, Pass
from feeddrive.typing import FloatArray

INFLATION = 30.0
"""Samples that tell as much as one of white noise: what is left is a fault of the model, alike over a good part of a
stroke. Sets how a prior weighs against rows, no result."""

SHOWN = 0.125
"""Share of the prior's width below which a term is known by a recording: of a mass four times as wide as declared
(`watched_quantities.LOOSEST`) to half of it."""

SCALES = 1.0
"""Width of the prior of the share by which a recording's friction map is another one than the usual: from none to
twice."""

OF_MAPS = {"table_position": "lead_sine", "motor_torque": "force"}
"""Channel to the term whose width is that of its maps: a lead error, a force."""

TURNS = 2
"""Times that the maps are taken anew beside their prior: what they leave hardly changes by it."""

STIFF = 1e6
"""Weight of the maps' freedom from level and slope against the rows."""


@dataclass(frozen=True, eq=False)
class Pooled:
    """Terms of every recording of one channel.

    Attributes:
        channel: of which.
        values: (n, p); not a number where a recording does not show a term.
        variance: relative, 1 for the usual recording, (n, p).
        deviation: of the values [SI], (n, p).
        declared: medians of what the plant's own prediction has, (p,).
        slow_force: median [N].
        places: of the maps [m], (k,).
        maps: (2, k).
        rest: rms of what terms and maps leave, (n,).
    """

    channel: str
    values: FloatArray
    variance: FloatArray
    deviation: FloatArray
    declared: FloatArray
    slow_force: float
    places: FloatArray
    maps: FloatArray
    rest: FloatArray


def pool(passes: Sequence[Pass], grid: Grid, widths: Mapping[str, float]) -> Pooled:
    """Solve for the maps and for the terms of every recording.

    Args:
        passes: of one channel, one per recording.
        grid: that they were taken on.
        widths: of the priors, by term, SI.
    """
    names = TERMS[passes[0].channel]
    count = len(names)
    low = min(one.first for one in passes)
    hats = max(one.first + one.hats for one in passes) - low
    places: FloatArray = grid.cell * np.arange(low, low + hats, dtype=np.float64)
    beta = _maps(passes, count, low, hats, places, grid.middle)
    for _ in range(TURNS):  # the prior is over what the maps leave
        usual = float(np.sqrt(INFLATION) * np.median([_rest(one, beta, count, low, hats) for one in passes]))
        weight = usual / widths[OF_MAPS[passes[0].channel]]
        beta = _maps(passes, count, low, hats, places, grid.middle, weight)
    noise = [_rest(one, beta, count, low, hats) for one in passes]
    usual = float(np.sqrt(INFLATION) * np.median(noise))
    prior = np.diag([max(usual, 1e-300) / widths[name] for name in names])
    values, variance, deviation = (np.empty((len(passes), count)) for _ in range(3))
    wide = np.array([widths[name] for name in names])
    for i, one in enumerate(passes):
        rows, right = _own_rows(one, beta, count, low, hats)
        stacked = np.vstack([rows, np.column_stack([prior, np.zeros(count)]), [*np.zeros(count), usual / SCALES]])
        solved = np.linalg.lstsq(stacked, np.concatenate([right, np.zeros(count + 1)]), rcond=None)[0]
        values[i] = solved[:count]
        inverse = np.linalg.pinv(stacked.T @ stacked)[:count, :count]
        variance[i], deviation[i] = np.diag(inverse), usual * np.sqrt(np.diag(inverse))
        unseen = ~np.any(one.triangle[:, :count], axis=0)
        variance[i, unseen], deviation[i, unseen] = 1.0, np.inf
        values[i, deviation[i] > SHOWN * wide] = np.nan
    typical = np.median(variance, axis=0)
    declared = np.median([one.declared for one in passes], axis=0)
    force = float(np.median([one.slow_force for one in passes]))
    return Pooled(
        passes[0].channel, values, np.maximum(1.0, variance / typical), deviation, declared, force, places,
        beta.reshape(2, -1), np.array(noise),
    )  # fmt: skip


def _placed(one: Pass, low: int, hats: int) -> FloatArray:
    """Columns of the common maps that a recording's two maps are, (2 own hats,)."""
    at = one.first - low + np.arange(one.hats)
    return np.concatenate([at, hats + at])


def _maps(
    passes: Sequence[Pass], count: int, low: int, hats: int, places: FloatArray, middle: float, prior: float = 0.0
) -> FloatArray:
    """The common maps, (2 hats,); `prior` is the weight of a prior that they are zero."""
    rows, right = [], []
    for one in passes:
        columns = _placed(one, low, hats)
        block = np.zeros((one.triangle.shape[0] - count, 2 * hats))
        block[:, columns] = one.triangle[count:, count:-1]
        rows.append(block)
        right.append(one.triangle[count:, -1])
    stacked, seen = np.vstack(rows), np.concatenate(right)
    if len(seen) > 40 * hats:  # as many rows as recordings times hats: the triangle says the same
        triangle = np.asarray(np.linalg.qr(np.column_stack([stacked, seen]), mode="r"))
        stacked, seen = triangle[:, :-1], triangle[:, -1]
    size = max(float(np.linalg.norm(stacked)), 1e-300) / np.sqrt(stacked.size)
    seen_there = np.sum(stacked**2, axis=0)  # as many as rows
    rows_at = (seen_there[:hats] + seen_there[hats:]) / max(float(seen_there.sum()), 1e-300) * hats
    level, slope = rows_at, rows_at * (places - middle) / max(float(np.ptp(places)), 1e-12)
    free = np.zeros((3, 2 * hats))
    free[0, :hats], free[1, hats:] = level, level
    if passes[0].channel == "table_position":
        free[2, :hats] = slope  # which a term holds; no term of the forces goes with position
    small = max(1e-6 * size, prior) * np.eye(2 * hats)  # hats that no recording visits are zero
    whole = np.vstack([stacked, STIFF * size * free, small])
    found: FloatArray = np.linalg.lstsq(whole, np.concatenate([seen, np.zeros(3 + 2 * hats)]), rcond=None)[0]
    return found


def _own_rows(one: Pass, beta: FloatArray, count: int, low: int, hats: int) -> tuple[FloatArray, FloatArray]:
    """What the terms of a recording, (count,), and the scale of its friction map have to meet, the maps taken out."""
    own = beta[_placed(one, low, hats)]
    friction = np.where(np.arange(len(own)) < one.hats, 0.0, own if one.channel == "motor_torque" else 0.0)
    maps = one.triangle[:, count:-1]
    rows = np.column_stack([one.triangle[:, :count], maps @ friction])
    found: FloatArray = one.triangle[:, -1] - maps @ own
    return rows, found


def _rest(one: Pass, beta: FloatArray, count: int, low: int, hats: int) -> float:
    """Rms of what terms and maps leave of a recording."""
    own = beta[_placed(one, low, hats)]
    left = one.triangle[count:, -1] - one.triangle[count:, count:-1] @ own
    return float(np.sqrt(float(left @ left) / one.rows))
