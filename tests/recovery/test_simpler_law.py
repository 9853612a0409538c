"""A law that has run to where it is a simpler one is told to be that; one that the recordings tell is not."""

from __future__ import annotations

import numpy as np
import pytest

from feeddrive.diagnosis.finding.scene import scene_of
from feeddrive.diagnosis.forms.simpler_law import (
    as_force,
    less_than_a_period,
    level_everywhere,
    without_resonance,
)
from feeddrive.diagnosis.likelihood.fit import fit
from feeddrive.diagnosis.likelihood.problem import Problem
from feeddrive.diagnosis.motion.prediction import AxisPredictor
from feeddrive.diagnosis.motion.preparing import prepare
from feeddrive.effects.base import Effect, Port
from feeddrive.effects.chain.payload import Payload
from feeddrive.effects.chain.structural_mode import NO_PEAK, StructuralMode
from feeddrive.effects.friction.friction_deviation import FrictionDeviation
from feeddrive.effects.friction.friction_vs_position import FrictionVsPosition
from feeddrive.effects.friction.stribeck import Stribeck
from feeddrive.effects.source.ball_pass_ripple import BallPassRipple
from feeddrive.effects.source.constant_force import ConstantForce
from feeddrive.effects.source.position_spring import PositionSpring
from feeddrive.effects.source.torque_ripple import TorqueRipple
from tests.recovery.drawn import drawn
from tests.recovery.planted import axis_plant, pair


def bench_with(effect: Effect) -> Problem:
    """The bench's recording, drawn anew with an effect in it."""
    plant = axis_plant("bench")
    evidence = prepare(pair("bench", "null")[0], plant, 1.0)
    return Problem(plant, (drawn(plant, evidence, [effect], 1),), AxisPredictor())


@pytest.mark.parametrize("times", [1.5, 3.0])
def test_a_stribeck_friction_that_falls_beyond_every_speed_is_a_level(times: float) -> None:
    problem = bench_with(FrictionDeviation.of(Port.TABLE, coulomb_factor=1.6, viscous_factor=1.0))
    fastest = max(abs(run.table_velocity).max() for run in scene_of(problem, ()).runs)
    found = fit(problem, (Stribeck.of(delta_force=10.0, velocity=times * fastest),))
    assert level_everywhere(problem, found) == list(found.effects)


@pytest.mark.parametrize("velocity", [0.02, 0.45])
def test_a_stribeck_friction_that_the_speeds_tell_is_none(velocity: float) -> None:
    """One among the speeds, and one beyond the greatest of 0.3 m/s, where a third of it has fallen."""
    law = Stribeck.of(delta_force=10.0, velocity=velocity)
    problem = bench_with(law)
    found = fit(problem, (law,))
    assert level_everywhere(problem, found) == []


def travelled(problem: Problem) -> tuple[float, float]:
    """Middle and length of what was travelled [m]."""
    (run,) = scene_of(problem, ()).runs
    return float(np.mean([run.table_position.min(), run.table_position.max()])), float(np.ptp(run.table_position))


@pytest.mark.parametrize("times", [1.5, 6.0])
def test_a_bump_wider_than_what_was_travelled_is_a_level(times: float) -> None:
    problem = bench_with(FrictionDeviation.of(Port.TABLE, coulomb_factor=1.6, viscous_factor=1.0))
    middle, travel = travelled(problem)
    found = fit(problem, (FrictionVsPosition.of(peak=10.0, centre=middle, half_width=times * travel),))
    assert level_everywhere(problem, found) == list(found.effects)


@pytest.mark.parametrize("times", [0.2, 1.2])
def test_a_bump_that_the_places_tell_is_none(times: float) -> None:
    """One within what was travelled, and one from whose end to its middle a sixth has fallen."""
    middle, travel = travelled(bench_with(ConstantForce.of(force=0.0)))
    law = FrictionVsPosition.of(peak=20.0, centre=middle, half_width=times * travel)
    problem = bench_with(law)
    assert level_everywhere(problem, fit(problem, (law,))) == []


@pytest.mark.parametrize(("periods", "is_none"), [(0.6, True), (0.95, True), (1.3, False), (40.0, False)])
@pytest.mark.parametrize("port", [Port.MOTOR, Port.SCREW])
def test_a_sine_of_less_than_a_period_is_none(periods: float, is_none: bool, port: Port) -> None:
    plant = axis_plant("bench")
    problem = Problem(plant, (prepare(pair("bench", "null")[0], plant, 1.0),), AxisPredictor())
    travel = float(np.ptp(problem.evidence[0].measured["table_position"]))
    lead = 2 * np.pi * (plant.chain.motor_radius if port is Port.MOTOR else plant.chain.radius)
    law = TorqueRipple if port is Port.MOTOR else BallPassRipple
    sine = law.of(port, amplitude=0.01, order=periods * lead / travel, phase=0.3)
    found = fit(problem, (sine,), iterations=0)
    assert less_than_a_period(problem, found) == ([sine] if is_none else [])


@pytest.mark.parametrize(
    ("frequency", "damping", "shows"),
    [(0.8, 0.05, True), (1.3, 0.05, True), (1.5, 0.05, False), (0.8, 0.7, True), (0.8, 0.72, False)],
)
def test_a_mode_that_does_not_resonate_is_none_beside_a_payload(frequency: float, damping: float, shows: bool) -> None:
    plant = axis_plant("bench")
    problem = Problem(plant, (prepare(pair("bench", "null")[0], plant, 1.0),), AxisPredictor())
    hertz = frequency * problem.evidence[0].edge
    mode = StructuralMode.of(mass=5.0, frequency=hertz, damping=damping)
    found = fit(problem, (Payload.of(mass=10.0), mode), iterations=0)
    assert without_resonance(problem, found) == ([] if shows else [mode])
    assert without_resonance(problem, fit(problem, (mode,), iterations=0)) == []  # `as_payload` asks for it there


def test_a_mode_without_a_peak_has_none_in_its_deflection() -> None:
    ratio = np.linspace(1e-3, 3.0, 3000)
    for damping, has_peak in ((NO_PEAK - 0.02, True), (NO_PEAK + 0.02, False)):
        deflection = np.abs(1 / (1 - ratio**2 + 2j * damping * ratio))
        assert bool(np.max(deflection) > deflection[0] * (1 + 1e-6)) is has_peak


def test_a_force_beside_a_spring_is_where_the_spring_pulls_nowhere() -> None:
    """The force of both is that of one spring: two values tell it, and no third."""
    law = PositionSpring.of(stiffness=2000.0, zero=0.35)
    problem = bench_with(law)
    two = (ConstantForce.of(force=-400.0), law.with_values(zero=0.15))
    found = fit(problem, two, iterations=0)
    _, there = as_force(problem, found, 20)
    (spring,) = there.effects
    assert spring.name == "position_spring"
    assert spring.values["zero"] == pytest.approx(0.35, abs=1e-3)  # read off 2000 N/m beside a noise of 0.1 N
    assert there.squared_error <= found.squared_error
    _, bare = as_force(problem, fit(problem, (two[0], law.with_values(stiffness=0.0)), iterations=0), 20)
    assert [one.name for one in bare.effects] == ["constant_force", "position_spring"]  # it has no place to take
