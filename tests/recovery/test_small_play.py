"""Small free play and lost preload on machines drawn at random, each beside its own declared values."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest

from feeddrive.diagnosis.calibration.calibrate import calibrated, recalibrated
from feeddrive.diagnosis.diagnose import diagnose
from feeddrive.diagnosis.forms.spring_law import with_likelier_law
from feeddrive.diagnosis.judging.result import Diagnosis
from feeddrive.diagnosis.likelihood.fit import fit
from feeddrive.diagnosis.likelihood.problem import Problem
from feeddrive.diagnosis.likelihood.standing import regained
from feeddrive.diagnosis.preparation import prepared
from feeddrive.effects.base import Effect, number
from feeddrive.effects.transmission.backlash import Backlash
from feeddrive.effects.transmission.preload_loss import PreloadLoss
from feeddrive.plant.file.plant_file import read_plant
from feeddrive.recording import read_recording
from tests.generator import effects as planted
from tests.generator.effects.relatives import Relative
from tests.recovery.fleet.case import case
from tests.recovery.planted import axis_plant
from tests.recovery.test_spring_and_mode import problem_of, recordings


@pytest.fixture(scope="module")
def problem(tmp_path_factory: pytest.TempPathFactory) -> Problem:
    """A machine with 0.952 um of play in 3526 rows of 4 ms, its declared values fitted beside nothing."""
    plant_file, fitted, _ = case(473).write(tmp_path_factory.mktemp("machine"))
    plant = read_plant(plant_file)
    return calibrated(prepared(plant, [read_recording(fitted)], [], 1.0)[0])


def test_small_play_is_found_where_lost_preload_stood_in_for_it(problem: Problem) -> None:
    """Values fitted beside nothing went five deviations away to stand in for the play: begun there it does not fit."""
    assert problem.calibration is not None and np.max(np.abs(problem.calibration.coordinates)) > 4
    taken = fit(problem, [PreloadLoss.of(ratio=0.37, force=87.0)], iterations=4)
    there = with_likelier_law(problem, taken, 40)
    assert there is not None and there.problem.calibration is not None
    (found,) = there.fit.effects
    assert isinstance(found, Backlash)
    # a step of the encoder, 17 bits to 15 mm, beside values that are not where they belong
    assert number(found.values["width"]) == pytest.approx(0.952e-6, abs=15e-3 / 2**17)
    # hardly more is left than with the true width, whose bounces are not known; the softness left twice as much
    true = (Backlash.of(width=0.952e-6),)
    truth = fit(recalibrated(regained(there.problem, true), true), true, iterations=0)
    assert there.fit.squared_error < 1.03 * truth.squared_error < 0.6 * taken.squared_error


@pytest.mark.slow
@pytest.mark.parametrize(
    ("seed", "names"),
    [
        (599, {"backlash"}),  # was nothing, or preload_loss
        (3421, {"preload_loss"}),  # 12 N at a ratio of 0.41: was backlash, in a set with it
        (3819, {"channel_delay", "backlash"}),  # values that stood in for the delay hid the play: the delay alone
        (10012, {"backlash"}),  # a braked mode stood beside it, by slopes near it; values at rest without it tell none
    ],
)
def test_small_play_and_lost_preload_are_named_alone(seed: int, names: set[str], tmp_path: Path) -> None:
    result = diagnosed(seed, tmp_path)
    assert {effect.name for effect in result.effects} == names and not result.ambiguous


@pytest.mark.slow
def test_softer_spring_is_named_with_the_preload_that_may_be_lost_up_to_every_force(tmp_path: Path) -> None:
    """A fifth of the stiffness: was nothing, or preload lost. Up to the forces seen both say the same, and no rival."""
    result = diagnosed(3057, tmp_path)
    (softer,) = result.effects
    assert softer.name == "stiffness_deviation"
    assert softer.parameters["factor"].value == pytest.approx(0.2, abs=0.03)  # its interval: 0.19 to 0.24
    (one,) = result.alike
    assert one.names == ("stiffness_deviation", "preload_loss") and "no force beyond" in one.reason


def diagnosed(seed: int, directory: Path) -> Diagnosis:
    plant, fitted, judged = case(seed).write(directory)
    return diagnose(read_plant(plant), [read_recording(fitted)], [read_recording(judged)])[0]


def test_a_play_of_an_axis_that_brakes_harder_than_its_friction() -> None:
    """The load pushes the motor there, and rests on the other flank: every landing begins anew where it is seen."""
    fitted, judged = recordings("bench", planted.Backlash(width=7.5e-6), seeds=(75, 76))
    found, _ = diagnose(axis_plant("bench"), [fitted], [judged])
    (play,) = found.effects
    low, high = (float(end) for end in play.parameters["width"].ci95)  # type: ignore[union-attr, arg-type]
    # bounces carried on for seconds left an interval of 4 nm; five deviations of what the scale's noise leaves here
    assert high - low < 2e-9
    assert play.parameters["width"].value == pytest.approx(7.5e-6, abs=1.5e-9)


@pytest.mark.parametrize(
    ("axis", "softness", "width", "law"),
    [("light", 0.14, 5e-8, Backlash), ("bench", 0.14, 1e-7, Backlash), ("light", 0.2, 2e-7, PreloadLoss)],
)
def test_soft_edges_are_lost_preload_from_a_tenth_of_the_stiffness_on(
    axis: str, softness: float, width: float, law: type[Effect]
) -> None:
    """Two straight lines come nearest with a tenth, where no ball touches yet, and with 0.16: `test_soft_edges`."""
    soft = Relative(planted.Backlash(width=width), "soft edges", {"gap_softness": softness * width}, ("gap_softness",))
    alone = problem_of(axis, soft)
    there = with_likelier_law(alone, fit(alone, [PreloadLoss.of(ratio=0.3, force=5e7 * width)]), count=40)
    assert there is not None
    (found,) = there.fit.effects
    assert isinstance(found, law)


@pytest.mark.parametrize("force", [3.0, 10.0])
def test_a_preload_whose_ratio_is_told_stays_lost(force: float) -> None:
    alone = problem_of("light", planted.PreloadLoss(ratio=0.35, force=force))
    there = with_likelier_law(alone, fit(alone, [PreloadLoss.of(ratio=0.35, force=force)]), count=40)
    assert there is not None
    (law,) = there.fit.effects
    assert isinstance(law, PreloadLoss) and number(law.values["ratio"]) == pytest.approx(0.35, rel=0.05)
