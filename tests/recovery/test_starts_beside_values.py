"""Starts are read where declared values have taken what they can of an effect, and have the size that suits best."""

from __future__ import annotations

import pytest

from feeddrive.diagnosis.calibration.calibrate import calibrated
from feeddrive.diagnosis.finding.attempt import started
from feeddrive.diagnosis.finding.candidates import CANDIDATES
from feeddrive.diagnosis.finding.scene import scene_of
from feeddrive.diagnosis.likelihood.problem import Problem
from feeddrive.diagnosis.preparation import prepared
from feeddrive.diagnosis.starts import mode, transmission_starts
from feeddrive.effects.base import number
from tests.generator import effects as planted
from tests.generator import recording_pair
from tests.generator.axis import AXES
from tests.generator.effects import Effect as Planted
from tests.recovery.test_numbers_beside import catalogued
from tests.recovery.unlisted import recording


def calibrated_without(*effects: Planted) -> Problem:
    """The bench with the tolerances of a catalogue, its declared values fitted without what was planted."""
    pair = recording_pair(AXES["bench"], effects, (1, 2), (7.0, 6.0))
    fitted, judged = (recording(one, name) for one, name in zip(pair, ("train", "validate"), strict=True))
    return calibrated(prepared(catalogued().plant, [fitted], [judged], 0.75)[0])


@pytest.mark.parametrize(("mass", "frequency"), [(1.5, 57.0), (3.0, 45.0)])
def test_a_mode_is_read_off_where_the_table_mass_has_taken_what_it_is_below_its_resonance(
    mass: float, frequency: float
) -> None:
    problem = calibrated_without(planted.StructuralMode(mass=mass, frequency=frequency, damping=0.012))
    ((start,),) = mode.structural_mode(scene_of(problem, ()))
    assert number(start.values["frequency"]) == pytest.approx(frequency, rel=0.01)
    # a resonance of 1 Hz beside lines of a motion of 5 s, which are 0.2 Hz wide
    assert number(start.values["mass"]) == pytest.approx(mass, rel=0.25)


@pytest.mark.parametrize(("rise", "velocity"), [(2.0, 0.002), (4.0, 0.004)])
def test_a_stribeck_rise_is_started_in_its_own_size(rise: float, velocity: float) -> None:
    """At many times its size a step along the slope with the velocity, which grows with it, leads away."""
    problem = calibrated_without(planted.Stribeck(delta_force=rise, velocity=velocity))
    (candidate,) = [one for one in CANDIDATES if one.name == "stribeck"]
    (attempt,) = started(scene_of(problem, ()), candidate)
    # velocities that are tried are a factor of three apart: the next one makes up for its distance by the size
    assert number(attempt.fit.effects[-1].values["delta_force"]) == pytest.approx(rise, rel=0.25)


@pytest.mark.parametrize("force", [2.0, 10.0])
def test_a_loss_of_preload_is_read_off_where_the_stiffness_has_taken_what_it_is_under_load(force: float) -> None:
    problem = calibrated_without(planted.PreloadLoss(ratio=0.3, force=force))
    ((start,),) = transmission_starts.preload_loss(scene_of(problem, ()))
    # below the friction of 60 N force and ratio say one lag at every stop, b F1, whose grid has steps of a third
    lag = (1 / number(start.values["ratio"]) - 1) * number(start.values["force"])
    assert lag == pytest.approx((1 / 0.3 - 1) * force, rel=0.35)
