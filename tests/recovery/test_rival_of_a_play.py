"""Rivals of a free play: compared on the samples that both predict; lost preload by its ratio, as edges may be soft."""

from __future__ import annotations

import math
from pathlib import Path

import pytest

from feeddrive.diagnosis.calibration.calibrate import calibrated
from feeddrive.diagnosis.certainty.ambiguity import AGAINST, _in_place
from feeddrive.diagnosis.certainty.imitations import imitations_of
from feeddrive.diagnosis.certainty.rival_odds import Residuals
from feeddrive.diagnosis.finding.attempt import with_predictable
from feeddrive.diagnosis.finding.search import Search
from feeddrive.diagnosis.forms.spring_law import from_declared, hardly_carrying
from feeddrive.diagnosis.judging.judge import prepared_for_judging
from feeddrive.diagnosis.likelihood.fit import fit
from feeddrive.diagnosis.likelihood.standing import regained, same_samples
from feeddrive.diagnosis.preparation import prepared
from feeddrive.effects.base import Port
from feeddrive.effects.friction.stribeck import Stribeck
from feeddrive.effects.transmission.backlash import Backlash
from feeddrive.effects.transmission.preload_loss import PreloadLoss
from feeddrive.plant.file.plant_file import read_plant
from feeddrive.recording import read_recording
from tests.generator import effects as planted
from tests.generator import recording_pair
from tests.generator.axis import AXES
from tests.recovery.fleet.case import case
from tests.recovery.test_numbers_beside import catalogued
from tests.recovery.unlisted import recording


def test_declared_values_of_a_rival_are_asked_on_the_samples_of_both() -> None:
    width = 2e-5
    pair = recording_pair(AXES["bench"], (planted.Backlash(width=width),), (1, 2), (7.0, 6.0))
    fitted, validate = (recording(one, name) for one, name in zip(pair, ("train", "validate"), strict=True))
    begun, (kept,), _ = prepared(catalogued().plant, [fitted], [validate], 0.75)
    play = Backlash.of(width=width)
    problem = with_predictable(calibrated(begun), [play])
    assert not same_samples(regained(problem, ()), problem)  # the play leaves some open
    found = Search(problem, fit(problem, [play]), (), (), {})
    after = problem.machine(found.fit.effects)
    judged = [prepared_for_judging(problem, kept, problem.plant, after)]
    mine = Residuals.of(problem, found.fit, [(one.after, one) for one in judged])
    rival = _in_place(found, judged, 0, Stribeck.of(Port.TABLE, delta_force=1.0, velocity=4e-3), mine)
    assert rival is not None
    assert math.isfinite(rival.odds) and rival.odds > 0  # the play is the truth


@pytest.mark.parametrize(
    ("seed", "lag", "takes_its_place"),
    [
        (701_617, 7.55e-9, False),  # a play of two steps of the encoder, whose edges the steps blur
        (9871, 4.43e-7, True),  # lost preload: two steps and a half
    ],
)
def test_a_lost_preload_takes_the_place_of_a_play_by_its_ratio(
    seed: int, lag: float, takes_its_place: bool, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    """Both are nearer to lost preload than to a play of sharp edges, by more than 20 to 1."""
    plant_file, fitted, judged_file = case(seed).write(tmp_path)
    plant, play = read_plant(plant_file), Backlash.of(width=lag)
    begun, (kept,), _ = prepared(plant, [read_recording(fitted)], [read_recording(judged_file)], 0.75)
    there = from_declared(calibrated(begun), [play], 0, play)
    assert there is not None
    found = Search(there.problem, there.fit, (), (), {})
    judged = [prepared_for_judging(there.problem, kept, plant, there.problem.machine(there.fit.effects))]
    mine = Residuals.of(there.problem, there.fit, [(one.after, one) for one in judged])
    (softer,) = imitations_of(there.fit.effects[0], plant)
    rival = _in_place(found, judged, 0, softer, mine)
    assert rival is not None and (rival.odds < -AGAINST) is takes_its_place
    monkeypatch.setattr("feeddrive.diagnosis.certainty.ambiguity.hardly_carrying", lambda *_: None)
    beside_sharp_edges = _in_place(found, judged, 0, softer, mine)
    assert beside_sharp_edges is not None and beside_sharp_edges.odds < -AGAINST


def test_a_lost_preload_that_loses_nothing_is_no_play() -> None:
    """A fit may end at the declared stiffness, where the force up to which it holds is any: no play has its width."""
    plant = catalogued().plant
    (recorded,) = [recording(one, "train") for one in recording_pair(AXES["bench"], (), (1, 2), (7.0, 6.0))[:1]]
    problem, _, _ = prepared(plant, [recorded], [], 0.75)
    idle = PreloadLoss.of(ratio=1.0, force=50.0)
    assert hardly_carrying(problem, fit(problem, [idle], iterations=0), 0) is None
    softer = fit(problem, [PreloadLoss.of(ratio=0.5, force=50.0)], iterations=0)
    assert hardly_carrying(problem, softer, 0) is not None
