"""Which windows of a long recording are informative, and which pieces of them are kept for judging.

Windows are taken one after the other, each the one that narrows the terms of a machine most (D-optimal design):

    next w = argmax log det(I + sum_(v taken) G_v + G_w),    G_w = sum over rows of z z'

| symbol | meaning |
|---|---|
| z | 1, v, a; s, abs(s) times hats over x; s times hats over log v and over the hour; x, 1 times hats over the hour |
| x, v, a, s | position, speed, acceleration and direction of the motor, s = 0 at rest; all columns of unit rms |
| I | the prior: each term as well known as by one usual row |

Reversals, strokes and constant speeds at new places, speeds and hours add to it; a repeated cycle and standstill do
not. The gain of a window never grows by those taken before (log det is submodular), so that the greedy choice reaches
63 % of the best at least (G. Nemhauser, L. Wolsey and M. Fisher, Mathematical Programming 14, 1978, theorem 4.2) and a
window whose old gain is below another's new one need not be asked again.

What has no name and differs over the stroke, by direction or from hour to hour (a lead map, warming up) is an error of
every fit. Judged where the fit has not been, it would outweigh what a name brings there. So the windows are cut into
pieces, and those are judged with which both parts, the judged J and the fitted F, tell most by themselves:

    next p = argmax log det(I + G_J + G_p) + log det(I + G_F - G_p)

A piece that is alone at its place costs F what it gives J, and stays fitted; of two that are alike one is judged.
"""

from __future__ import annotations

import heapq

import numpy as np

from feeddrive.recording.recording import Recording
from feeddrive.typing import FloatArray

WINDOW = 10.0
"""Length of a window [s]: some strokes, and ten times the second that is lost where two are joined."""

PIECES = 4
"""Pieces of a window: each a move or two, and five blocks of cross-validation."""

ROWS = 60
"""Rows of a piece that are looked at, at random places: as many as terms."""

BESIDE = 4
"""Rows on either side that speed and acceleration are taken over: at 1 kHz all that a drive does below 60 Hz."""

PLACES, SPEEDS, HOURS = 12, 8, 8
"""Hats over the stroke, over three decades of speed, and over the time of the recording."""

SEED = 3
"""Seed of the places of the rows that are looked at, so that a recording is always cut in the same way."""


Rows = tuple[int, int]
"""The first row and that after the last."""


def informative_windows(recording: Recording, seconds: float, split: float = 1.0) -> tuple[list[Rows], list[Rows]]:
    """The stretches to keep, by time, windows side by side as one; and the pieces of them that are judged.

    Args:
        recording: with a motor angle or a table position.
        seconds: that are kept together.
        split: share of them that is fitted; the rest is judged.
    """
    position = recording["motor_angle" if "motor_angle" in recording else "table_position"]
    length = round(WINDOW / PIECES / recording.sample_time)
    count = len(recording) // (PIECES * length)
    pieces = _grams(position, recording.sample_time, length, PIECES * count)
    windows = pieces.reshape(count, PIECES, *pieces.shape[1:]).sum(axis=1)
    taken = sorted(_greedy(windows, max(1, round(seconds / WINDOW))))
    stretches: list[Rows] = []
    for window in taken:
        first, last = window * PIECES * length, (window + 1) * PIECES * length
        if stretches and stretches[-1][1] == first:
            stretches[-1] = stretches[-1][0], last
        else:
            stretches.append((first, last))
    numbers = np.concatenate([window * PIECES + np.arange(PIECES) for window in taken])
    judged = sorted(numbers[_judged(pieces[numbers], split)].tolist())
    return stretches, [(piece * length, (piece + 1) * length) for piece in judged]


def _grams(position: FloatArray, sample_time: float, length: int, count: int) -> FloatArray:
    """G of every piece, (count, p, p)."""
    random = np.random.default_rng(SEED)
    looked_at = min(ROWS, length - 2 * BESIDE)
    rows = np.sort(random.integers(BESIDE, length - BESIDE, (count, looked_at)), axis=1)
    rows = rows + length * np.arange(count)[:, None]
    before, here, after = (position[rows + shift] for shift in (-BESIDE, 0, BESIDE))
    reach = BESIDE * sample_time
    speed, acceleration = (after - before) / (2 * reach), (after - 2 * here + before) / reach**2
    low, high = float(here.min()), float(here.max())
    fastest = max(float(np.quantile(np.abs(speed), 0.99)), 1e-300)
    moving = np.sign(speed) * (np.abs(speed) > 1e-3 * fastest)
    slowness = np.log10(np.clip(np.abs(speed) / fastest, 1e-3, 1.0)) / 3 + 1
    place, hour = (here - low) / max(high - low, 1e-300), rows / (length * count)
    columns = np.concatenate([
        np.stack([np.ones_like(here), speed, acceleration], axis=-1), np.abs(moving[..., None]) * _hats(place, PLACES),
        moving[..., None] * _hats(place, PLACES), moving[..., None] * _hats(slowness, SPEEDS),
        moving[..., None] * _hats(hour, HOURS), _hats(hour, HOURS), (place[..., None] - 0.5) * _hats(hour, HOURS),
    ], axis=-1)  # fmt: skip
    size = np.sqrt(np.mean(columns**2, axis=(0, 1)))
    columns = columns / np.where(size > 0, size, 1.0)
    found: FloatArray = np.einsum("wri,wrj->wij", columns, columns, optimize=True)
    return found


def _hats(share: FloatArray, count: int) -> FloatArray:
    """Hats over 0 to 1, (..., count)."""
    found: FloatArray = np.clip(1 - np.abs(share[..., None] * (count - 1) - np.arange(count)), 0.0, None)
    return found


def _greedy(gram: FloatArray, most: int) -> list[int]:
    """Numbers of the windows, the most telling first."""
    known = np.eye(gram.shape[1])
    base = 0.0
    queue = [(-float(gain), window, 0) for window, gain in enumerate(np.linalg.slogdet(known + gram)[1])]
    heapq.heapify(queue)
    taken: list[int] = []
    while queue and len(taken) < most:
        _, window, asked = heapq.heappop(queue)
        if asked < len(taken):  # its gain was less than this when others were not yet taken
            again = float(np.linalg.slogdet(known + gram[window])[1]) - base
            heapq.heappush(queue, (-again, window, len(taken)))
            continue
        taken.append(window)
        known = known + gram[window]
        base = float(np.linalg.slogdet(known)[1])
    return taken


def _judged(gram: FloatArray, split: float) -> list[int]:
    """Numbers of the pieces to judge on."""
    fitted, judged = np.eye(gram.shape[1]) + gram.sum(axis=0), np.eye(gram.shape[1])
    found: list[int] = []
    left = list(range(len(gram)))
    for _ in range(round((1 - split) * len(gram))):
        both = np.linalg.slogdet(judged + gram[left])[1] + np.linalg.slogdet(fitted - gram[left])[1]
        best = left.pop(int(np.argmax(both)))
        fitted, judged = fitted - gram[best], judged + gram[best]
        found.append(best)
    return found
