"""A law of another form than the catalogue's keeps its name: a table over its variable is its own curve."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from feeddrive.diagnosis.finding.scene import Scene, scene_of
from feeddrive.diagnosis.finding.search import Search
from feeddrive.diagnosis.judging.judge import Judged, prepared_for_judging
from feeddrive.diagnosis.likelihood.fit import fit
from feeddrive.diagnosis.likelihood.problem import Problem
from feeddrive.diagnosis.motion.prediction import AxisPredictor
from feeddrive.diagnosis.motion.preparing import prepare
from feeddrive.diagnosis.starts import needs, starts
from feeddrive.diagnosis.unexplained.unexplained import without_stand_ins
from feeddrive.effects.base import Effect
from feeddrive.effects.catalogue import EFFECTS
from tests.generator.axis import AXES
from tests.generator.effects import BallPassRipple, LeadErrorPeriodic, TorqueRipple
from tests.generator.effects import Effect as Planted
from tests.generator.effects.relatives import Relative
from tests.generator.pair import recording_pair
from tests.recovery.planted import axis_plant
from tests.recovery.unlisted import recording


def kept(truth: Planted, *names: Effect) -> list[str]:
    """Names that stand after all of them, fitted, are held against a table."""
    pair = recording_pair(AXES["bench"], (truth,), (21, 22), (7.0, 6.0))
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
    # a twentieth: of a larger one the table's period, known to a thousandth, leaves what a sine takes
    truth = Relative(LeadErrorPeriodic(2e-6, 2.0, 0.3), "a second harmonic", {"travel_second": 0.05})
    assert kept(truth, EFFECTS["lead_error_periodic"].of(amplitude=1e-7, order=4.0, phase=0.6)) == []


def test_harmonics_of_what_was_found_are_tried_in_one_direction_as_well() -> None:
    pair = recording_pair(AXES["bench"], (BallPassRipple(0.02, 3.3, 0.3),), (23, 24), (6.0, 6.0))
    plant = axis_plant("bench")
    problem = Problem(plant, (prepare(recording(pair[0], "train"), plant, 1.0),), AxisPredictor())
    found = EFFECTS["ball_pass_ripple"].of(amplitude=0.02, order=3.3, phase=0.3)
    scene = scene_of(problem, [found])
    forward = np.gradient(scene.runs[0].table_position) > 0
    (evidence,) = problem.evidence
    one_way = replace(problem, evidence=(replace(evidence, fitted=evidence.fitted & forward),))
    there = replace(scene, problem=one_way)
    assert needs.both_directions(there) and not needs.screw_drag_turns(there)
    (forms,) = starts.ball_pass_ripple(replace(scene, residuals=({"motor_torque": second_order(scene)},)))
    assert 6.6 in [one.values["order"] for one in forms]


def second_order(scene: Scene) -> np.ndarray:
    """What is left where the drag repeats with 6.6 periods a turn as well, little beside the noise of others."""
    run = scene.runs[0]
    noise = 0.05 * np.random.default_rng(1).standard_normal(len(run.screw_angle))
    return noise + 0.01 * np.sin(6.6 * run.screw_angle) * np.sign(run.screw_speed)
