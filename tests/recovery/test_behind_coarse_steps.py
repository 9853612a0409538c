"""Slow effects behind coarse encoders: what the steps scatter by counts once, what they share stands against a name."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest

from feeddrive.diagnosis.diagnose import diagnose
from feeddrive.diagnosis.likelihood.encoder_along import encoder_along
from feeddrive.diagnosis.likelihood.fit import Fit, fit
from feeddrive.diagnosis.likelihood.problem import Problem
from feeddrive.diagnosis.likelihood.set_evidence import variance_along
from feeddrive.diagnosis.likelihood.standing import Standing, odds_between
from feeddrive.effects.base import Effect
from feeddrive.effects.chain.payload import Payload
from feeddrive.effects.source.constant_force import ConstantForce
from feeddrive.effects.travel.lead_error_cumulative import LeadErrorCumulative
from feeddrive.effects.travel.thermal_growth import ThermalGrowth
from feeddrive.plant.file.plant_file import read_plant
from feeddrive.recording import read_recording
from tests.recovery.fleet.case import case, encoder_null_seeds
from tests.recovery.fleet.problem import calibrated_case

COUNT = 50
"""Candidates and starts of a round."""

LEAD, GROWTH = 700_932, 701_204
"""A lead error of 3.07 µm/m at 2.2 times the floor, a growth of 1.7 µm/m at 1.4 times it; both of 16 bits."""

DIRECTIONS: tuple[Effect, ...] = (
    LeadErrorCumulative.of(slope=1e-7),
    ThermalGrowth.of(strain=1e-7, time_constant=5.0),
    ConstantForce.of(force=0.1),
)


@pytest.mark.parametrize(
    ("seed", "effect"),
    [
        (LEAD, LeadErrorCumulative.of(slope=3e-6)),
        (GROWTH, ThermalGrowth.of(strain=1.2e-6, time_constant=14.0)),
    ],
)
def test_a_slow_error_of_position_is_likelier_than_none(seed: int, effect: Effect, tmp_path: Path) -> None:
    problem = calibrated_case(seed, tmp_path)
    none, having = fit(problem, ()), fit(problem, [effect])
    assert odds_between(Standing(problem, none), Standing(problem, having), COUNT) > 0.0


@pytest.fixture(scope="module")
def healthy(tmp_path_factory: pytest.TempPathFactory) -> Problem:
    """A machine that lacks nothing, of 14 bits."""
    (seed,) = (one for one in encoder_null_seeds(50, 50) if one // 1000 % 100 == 14)
    return calibrated_case(seed, tmp_path_factory.mktemp("healthy"))


def test_along_what_steps_only_scatter_by_the_colour_of_the_residual_says_it_all(healthy: Problem) -> None:
    """The mean of four draws of chance is within twice the deviation that is expected of one, but once in 10 000.

    What is left along a direction is within three deviations, but once in 400: seeds are fixed.
    """
    none = fit(healthy, ())
    for effect in DIRECTIONS:
        along = none.residual - healthy.residual([effect])
        size = float(along @ none.residual) / float(along @ along)
        there = Fit((effect,), none.residual - size * along, along[:, None], np.zeros(1))
        expected = variance_along(healthy, there, none, there)
        given = encoder_along(healthy, healthy.machine(()), healthy.machine([effect]))
        assert given < 4 * expected
        assert size**2 * float(along @ along) < 9 * (expected + given)


def test_what_all_draws_share_stands_against_a_mass_of_the_sign_that_they_speak_for(healthy: Problem) -> None:
    """A mass takes away what it is asked with, draw by draw the same way; of the other sign the steps speak against it.

    They are no reason for what they speak against.
    """
    mass = 0.02 * healthy.plant.chain_values()["table_mass"]
    none = fit(healthy, ())

    def given(sign: float) -> float:
        return encoder_along(healthy, healthy.machine(()), healthy.machine([Payload.of(mass=sign * mass)]))

    having = fit(healthy, [Payload.of(mass=mass)], iterations=0)
    assert given(-1.0) > variance_along(healthy, none, none, having)
    assert given(1.0) == 0.0


@pytest.mark.slow
def test_a_play_of_a_tenth_of_a_micrometre_is_no_lost_preload(tmp_path: Path) -> None:
    """What the steps do beside a play scatters at its reversals alone; as if spread over all, it spoke for a spring."""
    plant_file, fitted, judged = case(701_359).write(tmp_path)
    found, _ = diagnose(read_plant(plant_file), [read_recording(fitted)], [read_recording(judged)])
    (play,) = found.effects
    assert play.name == "backlash"
    assert play.parameters["width"].value == pytest.approx(1.005e-7, rel=0.05)
