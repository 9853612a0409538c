"""The production axis: what its recordings show is what its truth says."""

from __future__ import annotations

import numpy as np

from tests.recovery.fleet.production import BLOCKS, production


def test_play_and_reversals_are_where_the_truth_has_them() -> None:
    """The way back is behind the way out by what the play grew, and reversals lie at the same place of each block."""
    axis = production(1, runs=250)
    gaps, lengths = [], []
    for day in (axis.days[0], axis.days[-25]):
        channels = axis.recording(day)
        error = channels["table_position"] - channels["motor_angle"] * axis.true.radius
        speed = np.gradient(channels["motor_angle"])
        out, back = speed > 0.5 * speed.max(), speed < 0.5 * speed.min()
        gaps.append(float(np.median(error[back]) - np.median(error[out])))
        lengths.append(len(speed))
        blocks = out[: len(out) // BLOCKS * BLOCKS].reshape(BLOCKS, -1)
        assert np.mean(blocks == blocks[0]) > 0.99
    grown = axis.days[-25].play - axis.days[0].play
    # Both machines are cold. Medians: a table that brakes runs ahead, to the other flank of its play.
    assert axis.days[-25].minute == 0.0 and lengths[0] == lengths[1]
    assert abs(gaps[1] - gaps[0] - grown) < 2e-6
