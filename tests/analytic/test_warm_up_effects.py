"""Thermal effects in a run of drive and heat: what a diagnosis found acts there too."""

from __future__ import annotations

import numpy as np
import pytest

from feeddrive.effects.base import Effect
from feeddrive.effects.catalogue import THERMAL_EFFECTS
from feeddrive.simulate.warm.warm_up_cycle import Cycle, ServoCycle
from feeddrive.simulate.warm.warm_up_result import CLOSES
from feeddrive.simulate.warm.warm_up_run import MacroSteps, run_warm_up
from feeddrive.thermal.reduced.parametric_model import Path
from feeddrive.thermal.run.energy_balance import with_ledger
from tests.analytic.warm_cases import short_cycle


def _effect(name: str, place: str = "", **values: float) -> Effect:
    return THERMAL_EFFECTS[name].of(None, place, **values)


def _cycle(*effects: Effect, nut: float = 0.0, time: float = 0.0) -> Cycle:
    """The cycle with effects, all of the nut warmer by `nut` [K] than the start."""
    servo = ServoCycle(short_cycle(*effects))
    model = with_ledger(servo.heat_model())
    state = nut * np.linalg.pinv(np.atleast_2d(model.readings["nut"]))[:, 0]
    return servo.at(model, state, time)


def test_motor_heat_enters_at_the_front_for_the_time_of_turning() -> None:
    before, after = _cycle(), _cycle(_effect("motor_heat", power=7.0, at_speed=200.0, share_at_rest=1.0))
    gained = after.heats["front"] - before.heats["front"]
    assert 0.5 * 7.0 < gained < 7.0  # the axis rests for 40 ms of 0.6 s, and turns for the rest
    assert after.power.into_network - before.power.into_network == pytest.approx(gained, rel=1e-9)
    assert after.heats["nut"] == pytest.approx(before.heats["nut"], rel=1e-9)


def test_films_are_those_of_the_effect() -> None:
    before, after = _cycle(), _cycle(_effect("convection_deviation", "screw", factor=1.3))
    assert after.conductances[Path.SCREW_FILM] == pytest.approx(1.3 * before.conductances[Path.SCREW_FILM])
    assert after.conductances[Path.NUT_FILM] == pytest.approx(before.conductances[Path.NUT_FILM])


def test_preload_follows_the_nut() -> None:
    before, after = _cycle(nut=2.0), _cycle(_effect("preload_growth", coefficient=0.02), nut=2.0)
    assert after.preload == pytest.approx(1.04 * before.preload)
    assert after.nut_torque > 1.015 * before.nut_torque  # 4 % of half of the drag or more


def test_frame_shows_at_the_stops() -> None:
    effect = _effect("structure_growth", growth=3e-6, time_constant=1000.0)
    before, after = _cycle(time=1000.0), _cycle(effect, time=1000.0)
    np.testing.assert_allclose(after.stop_errors - before.stop_errors, 3e-6 * (1 - np.exp(-1)), rtol=1e-6)


def test_energy_closes_with_effects() -> None:
    effects = _effect("motor_heat", power=7.0, at_speed=200.0), _effect("heat_sink", conductance=0.5, capacity=900.0)
    run = run_warm_up(short_cycle(*effects), 120.0, MacroSteps(fixed=60.0))
    assert abs(run.energy.imbalance) < CLOSES
    assert "heat_sink" in run.points[-1].temperatures
