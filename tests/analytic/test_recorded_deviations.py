"""The lead error as a recording with a scale shows it, between the reversals and at the ends of the strokes."""

from __future__ import annotations

import numpy as np
import pytest

from feeddrive.compensation.deviations import recorded_deviations
from feeddrive.recording import Recording

SLOPE, PLAY, STEP = 40e-6, 7.5e-6, 1e-3


def creeping() -> Recording:
    """Strokes of 100 mm at 20 mm/s that creep at 0.1 mm/s for a tenth of a second after each reversal."""
    velocity: list[float] = []
    for number in range(8):
        side = -1.0 if number % 2 else 1.0
        velocity += [1e-4 * side] * 100 + [0.02 * side] * 5000
    indicated = 0.1 + np.cumsum(velocity) * STEP
    behind, table = 0.0, []
    for now, rate in zip(indicated, velocity, strict=True):  # the table stays until the play is crossed
        behind = min(max(behind - rate * STEP, -PLAY / 2), PLAY / 2)
        table.append(now * (1 + SLOPE) + behind)
    time = np.arange(len(indicated)) * STEP
    return Recording("creeping", time, {"motor_angle": indicated, "table_position": np.array(table)}, STEP)


def test_a_sample_that_still_crosses_the_play_does_not_count() -> None:
    """The ends of the strokes were off by a fifteenth of the play; the straight line is as planted there too."""
    found = recorded_deviations(creeping(), 1.0, 0.02)
    assert found.difference == pytest.approx(PLAY, rel=1e-3)
    places = found.known.positions
    line = found.known.forward - found.known.forward[0] - SLOPE * (places - places[0])
    assert np.max(np.abs(line)) < 0.002 * PLAY  # nothing is noisy here
