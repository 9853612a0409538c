"""The production axis: what its recordings show is what its truth says."""

from __future__ import annotations

from pathlib import Path

import numpy as np

from feeddrive.diagnosis.likelihood.predictability import predictable_samples
from feeddrive.diagnosis.preparation import prepared
from feeddrive.effects.transmission.backlash import Backlash
from feeddrive.plant.file.plant_file import read_plant
from feeddrive.recording import read_recording
from tests.recovery.fleet.plant_text import plant_text
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


def test_the_settled_half_of_every_stroke_is_predictable_with_a_worn_screw(tmp_path: Path) -> None:
    """The encoder's error leads a table of 0.18 mm play astray at a reversal, and no further than to its flank."""
    axis = production(3)
    channels = axis.recording(axis.days[-15])
    (tmp_path / "plant.toml").write_text(plant_text(axis.declared, "production"))
    names = {"time": "s", "motor_angle": "rad", "table_position": "m"}
    rows = np.column_stack([channels[name] for name in names])
    header = ",".join(f"{name} [{unit}]" for name, unit in names.items())
    np.savetxt(tmp_path / "worn.csv", rows, fmt="%.12g", delimiter=",", header=header, comments="")
    plant = read_plant(tmp_path / "plant.toml")
    problem, _, _ = prepared(plant, [read_recording(tmp_path / "worn.csv")], [], 0.75)
    (evidence,) = problem.evidence
    predictable = predictable_samples(plant.with_effects(Backlash.of(width=axis.days[-15].play)), evidence)
    speed = np.abs(evidence.motion_speed)
    steady = speed > 0.99 * np.median(speed[speed > 0.5 * speed.max()])
    # the table lands while the speed is already steady, and bounces for some tenths of a second of the 1.2 of a stroke
    assert 0.3 < np.mean(predictable[steady]) < 0.9
    # scaled up from an error of nothing at all, a hundredth of the recording was left
    assert np.mean(predictable) > 0.3
