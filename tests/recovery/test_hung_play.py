"""Free play of a table that hangs: the load holds it on one flank, and no motion here reaches the other."""

from __future__ import annotations

import numpy as np
import pytest

from feeddrive.diagnosis.calibration.calibrate import calibrated
from feeddrive.diagnosis.certainty.one_sided import OPEN, all_intervals, one_sided, with_usual_sizes
from feeddrive.diagnosis.certainty.uncertainty import certainty, intervals
from feeddrive.diagnosis.forms.spring_law import play_from_declared
from feeddrive.diagnosis.judging.asked_of_fit import sizes_around_none
from feeddrive.diagnosis.judging.result import ParameterResult
from feeddrive.diagnosis.likelihood.fit import fit
from feeddrive.diagnosis.likelihood.problem import UNEXPLAINED, Problem
from feeddrive.diagnosis.preparation import prepared
from feeddrive.effects.base import number
from feeddrive.effects.chain.payload import Payload
from feeddrive.effects.transmission.backlash import Backlash
from feeddrive.files import find_plant
from feeddrive.plant.file.plant_file import read_plant
from feeddrive.report.words.parameters import parameter_text
from tests.recovery.parts.cases import SECONDS
from tests.recovery.parts_runs import made

WIDTH = 3.1e-6


@pytest.fixture(scope="module")
def problem() -> Problem:
    recording = made("vertical_axis", SECONDS, False, 1, (("backlash", WIDTH),))
    return prepared(read_plant(find_plant("vertical_axis")), [recording], [], 1.0)[0]


def test_a_width_that_no_motion_reached_is_told_from_below(problem: Problem) -> None:
    """The chirp opens the play for some tenths of a micrometre: wider ones predict the same, and none is denied."""
    found = fit(problem, [Backlash.of(width=0.5 * WIDTH)], iterations=0)
    known = certainty(problem, found)
    by_slope, (told,) = intervals(problem, found, known)[0]["width"], all_intervals(problem, found, known)
    assert by_slope is not None and by_slope[0][0] == 0.0  # a deviation of the width times what its slope tells: none
    assert told["width"] is not None
    ((low, high),) = told["width"]
    # below it the table meets the other flank; above it nothing does until millimetres move the nut on the screw
    assert 0.1e-6 < low < 0.25 * WIDTH and high > OPEN * low
    left = [
        float(np.sum(problem.residual([Backlash.of(width=w)]) ** 2)) for w in (0.9 * low, 1.1 * low, WIDTH, 10 * WIDTH)
    ]
    assert left[0] > left[1] + 4 and max(left[1:]) < min(left[1:]) + 4
    assert sizes_around_none(problem, found) == [""]
    # where the fit ended is chance: the play is as wide as plays are, and the prediction no other
    usual = with_usual_sizes(problem, found)
    assert number(usual.effects[0].values["width"]) == Backlash.parameter("width").size
    assert usual.squared_error == pytest.approx(found.squared_error, abs=4)
    # a fit from there on goes nowhere: its slope tells nothing
    again = fit(problem, usual.effects)
    assert number(again.effects[0].values["width"]) == pytest.approx(5e-6, rel=0.5)
    shown = parameter_text("width", ParameterResult(number(found.effects[0].values["width"]), "m", (low, high)))
    assert shown.sentence.startswith("at least 0.") and shown.sentence.endswith("µm")


@pytest.mark.slow
def test_a_play_that_fitted_values_hide_is_begun_beside_those_declared(problem: Problem) -> None:
    """Values within their tolerances take what the open play leaves in a few passages; beside them none is better."""
    values = calibrated(problem)
    found = fit(values, ())
    assert values.plain_error(()) > UNEXPLAINED
    there = play_from_declared(values, found)
    assert there is not None
    # what remains is the sensors' noise, and the values are where they were declared
    assert there.problem.plain_error(there.fit.effects) < UNEXPLAINED
    assert there.problem.calibration is not None
    assert np.max(np.abs(there.problem.calibration.coordinates)) < 2.0
    assert play_from_declared(there.problem, there.fit) is None


def test_a_size_that_its_slope_tells_is_left_to_it(problem: Problem) -> None:
    """A mass of nothing among its noise: its interval holds none, by its slope, and so it is denied."""
    found = fit(problem, [Backlash.of(width=0.5 * WIDTH), Payload.of(mass=1e-3)], iterations=0)
    assert one_sided(problem, found, 1) is None
    assert [bool(why) for why in sizes_around_none(problem, found)] == [False, True]
