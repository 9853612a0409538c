"""A rival of a free play predicts what the play leaves open: the two are compared on the samples that both predict."""

from __future__ import annotations

import math

from feeddrive.diagnosis.calibration.calibrate import calibrated
from feeddrive.diagnosis.certainty.ambiguity import Residuals, _in_place
from feeddrive.diagnosis.finding.attempt import with_predictable
from feeddrive.diagnosis.finding.search import Search
from feeddrive.diagnosis.judging.judge import prepared_for_judging
from feeddrive.diagnosis.likelihood.fit import fit
from feeddrive.diagnosis.likelihood.set_evidence import regained, same_samples
from feeddrive.diagnosis.preparation import prepared
from feeddrive.effects.base import Port
from feeddrive.effects.friction.stribeck import Stribeck
from feeddrive.effects.transmission.backlash import Backlash
from tests.generator import effects as planted
from tests.generator import recording_pair
from tests.generator.axis import AXES
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
