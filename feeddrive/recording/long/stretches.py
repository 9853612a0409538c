"""Which stretches of a long recording tell most of a machine.

Windows are taken one after the other, each the one that narrows the terms of a machine most (D-optimal design):

    next w = argmax log det(I + sum_(v taken) G_v + G_w),    G_w = sum over rows of z z'

| symbol | meaning |
|---|---|
| z | 1, v, a; sign v times hats over position, over log speed and over the hour; x, 1 times hats over the hour |
| v, a | speed and acceleration of the motor, of unit rms over the recording, as are all columns |
| I | the prior: each term as well known as by one usual row |

Reversals, strokes and constant speeds at new places, speeds and hours add to it; a repeated cycle and standstill do
not. The gain of a window never grows by those taken before (log det is submodular), so that the greedy choice reaches
63 % of the best at least (G. Nemhauser, L. Wolsey and M. Fisher, Mathematical Programming 14, 1978, theorem 4.2) and a
window whose old gain is below another's new one need not be asked again.
"""

from __future__ import annotations

import heapq

import numpy as np

from feeddrive.recording.recording import Recording
from feeddrive.typing import FloatArray

WINDOW = 10.0
"""Length of a window [s]: some strokes, and ten times the second that is lost where two are joined."""

ROWS = 100
"""Rows of a window that are looked at, at random places: twice the terms."""

BESIDE = 4
"""Rows on either side that speed and acceleration are taken over: at 1 kHz all that a drive does below 60 Hz."""

PLACES, SPEEDS, HOURS = 12, 8, 8
"""Hats over the stroke, over three decades of speed, and over the time of the recording."""

SEED = 3
"""Seed of the places of the rows that are looked at, so that a recording is always cut in the same way."""


def informative_windows(recording: Recording, seconds: float) -> list[tuple[int, int]]:
    """First row and row after the last of each stretch, by time; windows side by side are one stretch.

    Args:
        recording: with a motor angle or a table position.
        seconds: that are taken together.
    """
    position = recording["motor_angle" if "motor_angle" in recording else "table_position"]
    length = round(WINDOW / recording.sample_time)
    count = len(recording) // length
    gram = _grams(position, recording.sample_time, length, count)
    taken = sorted(_greedy(gram, max(1, round(seconds / WINDOW))))
    stretches: list[tuple[int, int]] = []
    for window in taken:
        first, last = window * length, (window + 1) * length
        if stretches and stretches[-1][1] == first:
            stretches[-1] = stretches[-1][0], last
        else:
            stretches.append((first, last))
    return stretches


def _grams(position: FloatArray, sample_time: float, length: int, count: int) -> FloatArray:
    """G of every window, (count, p, p)."""
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
        np.stack([np.ones_like(here), speed, acceleration], axis=-1),
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
