"""Two effects that are as likely as nothing each alone, and what comes of a plant whose values are exact."""

from __future__ import annotations

import pytest

from feeddrive.diagnosis.diagnose import diagnose
from feeddrive.diagnosis.finding.refitting import with_softer_spring
from feeddrive.diagnosis.likelihood.fit import fit
from feeddrive.effects.transmission.preload_loss import PreloadLoss
from tests.generator import effects as planted
from tests.recovery.planted import axis_plant
from tests.recovery.test_spring_and_mode import problem_of, recordings


@pytest.mark.parametrize("force", [-12.0, -9.0])
def test_a_bristle_beside_friction_that_drops_with_speed(force: float) -> None:
    """Alone either leaves jumps at reversals, many times the noise, and is as likely as nothing."""
    fitted, judged = recordings(
        "light",
        planted.Presliding(stiffness=3.0e6, damping=4000.0, break_away=0.8),
        planted.Stribeck(delta_force=force, velocity=0.006),
        seeds=(31, 32),
    )
    found, _ = diagnose(axis_plant("light"), [fitted], [judged])
    named = {one.name: one.parameters for one in found.effects}
    assert set(named) == {"presliding", "stribeck"}
    # beside a bristle that slips throughout, a form of its own, they are 7 and 11 % off
    assert named["stribeck"]["delta_force"].value == pytest.approx(force, rel=0.05)
    assert named["presliding"]["stiffness"].value == pytest.approx(3.0e6, rel=0.05)


@pytest.mark.parametrize(("slope", "seeds"), [(3e-5, (53, 54)), (-1.2e-5, (55, 56))])
def test_a_lead_error_beside_growth_is_no_form_of_the_growth(slope: float, seeds: tuple[int, int]) -> None:
    """Both are of many times the noise: what is left beside the curve of one is told at the weights of both."""
    growth = planted.ThermalGrowth(strain=2.5e-5, time_constant=5.0)
    fitted, judged = recordings("light", planted.LeadErrorCumulative(slope=slope), growth, seeds=seeds)
    found, _ = diagnose(axis_plant("light"), [fitted], [judged])
    named = {one.name: one.parameters for one in found.effects}
    assert set(named) == {"lead_error_cumulative", "thermal_growth"}
    # the intervals are of 0.1 and 0.4 %; simulation and package share no code
    assert named["lead_error_cumulative"]["slope"].value == pytest.approx(slope, rel=0.005)
    assert named["thermal_growth"]["time_constant"].value == pytest.approx(5.0, rel=0.02)


@pytest.mark.parametrize("seeds", [(63, 64), (65, 66)])
def test_a_drag_at_the_table_is_no_drag_at_the_screw_beside_a_late_scale(seeds: tuple[int, int]) -> None:
    """At another place of one effect another one says nothing any more."""
    softer = planted.StiffnessDeviation(factor=1.08)
    drag = planted.FrictionDeviation(port="table", viscous_factor=1.07)
    fitted, judged = recordings("light", softer, drag, seeds=seeds)
    found, effects = diagnose(axis_plant("light"), [fitted], [judged])
    assert {(one.name, str(one.port)) for one in effects} >= {("friction_deviation", "table")}
    named = {one.name: one.parameters for one in found.effects}
    assert set(named) == {"stiffness_deviation", "friction_deviation"}
    # five deviations of what the intervals tell, 0.002 and 0.003
    assert named["stiffness_deviation"]["factor"].value == pytest.approx(1.08, abs=0.01)
    assert named["friction_deviation"]["viscous_factor"].value == pytest.approx(1.07, abs=0.015)


def test_a_delay_that_would_be_negative_takes_no_place() -> None:
    """What comes late of the table's scale is as if the motor's angle came early, which no recorder does."""
    fitted, judged = recordings("light", planted.ChannelDelay("table_position", 5e-8), seeds=(57, 58))
    found, _ = diagnose(axis_plant("light"), [fitted], [judged])
    (one,) = found.effects
    assert (one.name, one.parameters["channel"].value) == ("channel_delay", "table_position")
    # three deviations of 2.6 ns, the best that any unbiased estimate has here
    assert one.parameters["delay"].value == pytest.approx(5e-8, abs=8e-9)


@pytest.mark.parametrize(("factor", "named"), [(0.7, True), (1.0, False)])
def test_a_softer_spring_is_asked_of_a_plant_whose_values_are_exact(factor: float, named: bool) -> None:
    """Every other value is beyond what is declared; whether it is another the recordings tell."""
    problem = problem_of("light", planted.StiffnessDeviation(factor=factor))
    assert problem.calibration is None
    soft = PreloadLoss.of(ratio=0.9, force=100.0)
    found = fit(problem, (soft,), iterations=0)
    there = with_softer_spring(problem, found, found.effects)
    assert (there is not None) is named
    if there is not None:
        assert there[1].effects[-1].values["factor"] == pytest.approx(factor, rel=0.02)
