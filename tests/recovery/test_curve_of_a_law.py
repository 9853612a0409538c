"""A law of another form than the catalogue's keeps its name: a table over its variable is its own curve."""

from __future__ import annotations

import pytest

from feeddrive.diagnosis.finding.search import Search
from feeddrive.diagnosis.judging.judge import Judged, prepared_for_judging
from feeddrive.diagnosis.likelihood.evidence import prepare
from feeddrive.diagnosis.likelihood.fit import Problem, fit
from feeddrive.diagnosis.likelihood.prediction import AxisPredictor
from feeddrive.diagnosis.unexplained.unexplained import without_stand_ins
from feeddrive.effects.base import Effect
from feeddrive.effects.catalogue import EFFECTS
from tests.generator.axis import AXES
from tests.generator.effects import Effect as Planted
from tests.generator.effects import LeadErrorPeriodic, TorqueRipple
from tests.generator.effects.relatives import Relative
from tests.generator.pair import recording_pair
from tests.recovery.planted import axis_plant
from tests.recovery.unlisted import recording


def kept(truth: Planted, *names: Effect) -> list[str]:
    """Names that stand after all of them, fitted, are held against a table."""
    pair = recording_pair(AXES["bench"], (truth,), (21, 22), (8.0, 6.5))
    fitted, judged = (recording(one, name) for one, name in zip(pair, ("train", "validate"), strict=True))
    plant = axis_plant("bench")
    problem = Problem(plant, (prepare(fitted, plant, 1.0),), AxisPredictor())
    found = Search(problem, fit(problem, names), (), (), {})
    there: list[Judged] = [
        prepared_for_judging(problem, prepare(judged, plant, 0.0), plant, problem.machine(found.fit.effects))
    ]
    return [one.name for one in without_stand_ins(found, there).fit.effects]


@pytest.mark.parametrize(
    ("law", "second"),
    [(LeadErrorPeriodic(2e-6, 2.0, 0.3), "travel_second"), (TorqueRipple(0.1, 2.0, 0.3), "ripple_second")],
)
def test_a_sine_is_not_denied_by_its_own_harmonics(law: Planted, second: str) -> None:
    # a third of the amplitude at twice the order: a table over the period takes it, the sine does not
    sine = EFFECTS[law.name].of(amplitude=law.amplitude, order=2.0, phase=0.3)
    assert kept(Relative(law, "a second harmonic", {second: 1 / 3}), sine) == [law.name]


def test_a_name_that_takes_the_smaller_part_is_denied() -> None:
    truth = Relative(LeadErrorPeriodic(2e-6, 2.0, 0.3), "a second harmonic", {"travel_second": 0.25})
    assert kept(truth, EFFECTS["lead_error_periodic"].of(amplitude=5e-7, order=4.0, phase=0.6)) == []
