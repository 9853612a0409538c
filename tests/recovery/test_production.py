"""The production axis: what its recordings show is what its truth says."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest

from feeddrive.diagnosis.calibration.calibrate import calibrated, recalibrated
from feeddrive.diagnosis.diagnose import diagnose
from feeddrive.diagnosis.finding.attempt import with_predictable
from feeddrive.diagnosis.finding.search import Search
from feeddrive.diagnosis.judging.judge import prepared_for_judging
from feeddrive.diagnosis.likelihood.fit import fit
from feeddrive.diagnosis.likelihood.predictability import predictable_samples
from feeddrive.diagnosis.preparation import prepared
from feeddrive.diagnosis.recordings.compared import judged_changes
from feeddrive.effects.base import Effect
from feeddrive.effects.friction.presliding import Presliding
from feeddrive.effects.transmission.backlash import Backlash
from feeddrive.effects.travel.lead_error_cumulative import LeadErrorCumulative
from feeddrive.effects.travel.lead_error_periodic import LeadErrorPeriodic
from feeddrive.plant.file.plant_file import read_plant
from feeddrive.plant.plant import Plant
from feeddrive.recording import Recording, read_recording
from tests.recovery.fleet.plant_text import plant_text
from tests.recovery.fleet.production import BLOCKS, TOLERANCES, Production, production


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


def declared(axis: Production, folder: Path) -> Plant:
    """The plant file of an axis, read."""
    (folder / "plant.toml").write_text(plant_text(axis.declared, "production", TOLERANCES))
    return read_plant(folder / "plant.toml")


def recorded(axis: Production, day: int, folder: Path) -> Recording:
    """A day's recording with the scale alone, written and read."""
    channels = axis.recording(axis.days[day])
    names = {"time": "s", "motor_angle": "rad", "table_position": "m"}
    rows = np.column_stack([channels[name] for name in names])
    header = ",".join(f"{name} [{unit}]" for name, unit in names.items())
    np.savetxt(folder / f"{day}.csv", rows, fmt="%.12g", delimiter=",", header=header, comments="")
    return read_recording(folder / f"{day}.csv")


def test_the_settled_half_of_every_stroke_is_predictable_with_a_worn_screw(tmp_path: Path) -> None:
    """The encoder's error leads a table of 0.18 mm play astray at a reversal, and no further than to its flank."""
    axis = production(3)
    plant, worn = declared(axis, tmp_path), recorded(axis, -15, tmp_path)
    problem, _, _ = prepared(plant, [worn], [], 0.75)
    (evidence,) = problem.evidence
    predictable = predictable_samples(plant.with_effects(Backlash.of(width=axis.days[-15].play)), evidence)
    speed = np.abs(evidence.motion_speed)
    steady = speed > 0.99 * np.median(speed[speed > 0.5 * speed.max()])
    # the table lands while the speed is already steady, and bounces for some tenths of a second of the 1.2 of a stroke
    assert 0.3 < np.mean(predictable[steady]) < 0.9
    # scaled up from an error of nothing at all, a hundredth of the recording was left
    assert np.mean(predictable) > 0.3


@pytest.mark.slow
def test_worn_screw_is_named_by_its_play_with_the_scale_alone(tmp_path: Path) -> None:
    """Its masses and its friction are guesses, and half of every stroke is a table that bounces from flank to flank."""
    axis = production(3)
    fitted, judged = (recorded(axis, day, tmp_path) for day in (-15, -14))
    found, _ = diagnose(declared(axis, tmp_path), [fitted], [judged])
    values = {one.name: one.parameters for one in found.effects}
    assert "backlash" in values
    assert set(values) <= {"backlash", "lead_error_periodic", "lead_error_cumulative", "presliding"}
    # the width is told by rows that have come to rest on a flank, in a machine whose friction is another
    assert values["backlash"]["width"].value == pytest.approx(axis.days[-15].play, rel=0.02)
    (channel,) = found.channels
    assert channel.after.rms < 0.05 * channel.before.rms


@pytest.mark.slow
def test_play_that_grew_is_told_of_a_worn_recording_that_is_judged(tmp_path: Path) -> None:
    """What is known of the new machine is all that the worn one lacks, but for 0.18 mm of play."""
    axis = production(3)
    plant, new, worn = declared(axis, tmp_path), recorded(axis, 10, tmp_path), recorded(axis, -15, tmp_path)
    problem, (evidence,), _ = prepared(plant, [new], [worn], 0.75)
    problem = calibrated(problem)
    effects: tuple[Effect, ...] = (
        LeadErrorPeriodic.of(amplitude=3e-6, order=1.0, phase=5.3),
        LeadErrorCumulative.of(slope=-1e-5),
        Backlash.of(width=3e-6),
        Presliding.of(stiffness=11e6, damping=0.0, break_away=0.8),
    )
    for _ in range(2):
        problem = with_predictable(problem, effects)
        problem = recalibrated(problem, fit(problem, effects).effects)
        effects = fit(problem, effects).effects
    judged = prepared_for_judging(problem, evidence, plant, problem.machine(effects))
    changes = judged_changes(Search(problem, fit(problem, effects), (), (), {}), [judged])
    assert changes is not None
    grew = axis.days[-15].play - axis.days[10].play
    (change,) = changes.stated
    assert (change.effect, change.parameter) == ("backlash", "width")
    assert change.difference.value == pytest.approx(grew, rel=0.02)
    assert changes.explains["table_position"] > 0.99
