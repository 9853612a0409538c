"""Slow logs of a motion: strokes told from rows, uniform motion, friction declared once for motion and heat."""

from __future__ import annotations

from functools import cache

import numpy as np
import pytest

from feeddrive.diagnosis.heat.warm import prepare_warm, warm_predictor
from feeddrive.diagnosis.preparation import Shown, shown
from feeddrive.effects.catalogue import EFFECTS
from feeddrive.errors import InputError
from feeddrive.interface.axis import Axis, load
from feeddrive.plant.analysis.steady import steady_motion
from feeddrive.recording import Recording
from feeddrive.simulate.uniform_motion import uniform_motion
from feeddrive.simulate.warm.warm_log import friction_powers, warm_log
from feeddrive.thermal.laws.friction import Friction
from feeddrive.thermal.laws.laws import laws_of, values_of
from feeddrive.thermal.thermal_coupling import Temperatures

VALUES: dict[str, dict[str, float]] = {
    "backlash": {"width": 8e-6},
    "presliding": {"stiffness": 4e7, "damping": 0.0},
    "lead_error_cumulative": {"slope": 2e-5},
}


@cache
def axis() -> Axis:
    """The shipped axis that warms up."""
    return load("warm_axis")


def cycling(
    speed: float = 40.0, stroke: float = 5.3, dwell: float = 1.4, rows: int = 600
) -> tuple[Recording, np.ndarray]:
    """A log of strokes of `stroke` s at `speed` [rad/s] with dwells, and where the motor turned at each row."""
    fine = np.arange(0, rows, 0.001)
    phase = fine % (2 * (stroke + dwell))
    back = (phase > stroke + dwell) & (phase < 2 * stroke + dwell)
    turning = np.where(phase < stroke, speed, np.where(back, -speed, 0.0))
    angle = np.cumsum(turning) * 0.001
    return _recording({"motor_angle": angle[::1000]}), turning[::1000]


def _recording(channels: dict[str, np.ndarray]) -> Recording:
    """Channels once a second."""
    return Recording("log", np.arange(float(len(next(iter(channels.values()))))), channels, 1.0)


def test_strokes_are_told_from_rows() -> None:
    recording, turning = cycling()
    log = warm_log(recording, 20.0)
    np.testing.assert_allclose(np.abs(log.speed[log.share > 0]), 40.0, rtol=1e-3)  # what rows of a stroke agree to
    np.testing.assert_allclose(log.speed[log.uniform], turning[log.uniform], rtol=1e-3)
    assert 0.3 < log.uniform.mean() < 0.7
    # A row's share is the time that it turned: over all rows that of the cycle, to the ends of the log.
    assert np.mean(log.share) == pytest.approx(5.3 / 6.7, abs=0.01)
    assert log.torque is None and np.all(log.ambient == 20.0)


def test_strokes_shorter_than_rows_are_refused() -> None:
    with pytest.raises(InputError, match="no stroke lasts long enough"):
        warm_log(cycling(stroke=0.8, dwell=0.37)[0], 20.0)


@pytest.mark.parametrize("effects", [(), ("backlash",), ("presliding",), ("lead_error_cumulative",)])
def test_uniform_motion_is_the_steady_one(effects: tuple[str, ...]) -> None:
    plant = axis().plant.with_effects(*(EFFECTS[name].of(None, "", **VALUES[name]) for name in effects))
    angle, speed = np.array([40.0, 90.0, 150.0]), np.array([30.0, -60.0, 94.0])
    found = uniform_motion(plant, angle, speed, np.zeros(3))
    for i in range(3):
        steady = steady_motion(plant, float(speed[i]) * plant.chain.motor_radius, float(found.table_position[i]))
        # `steady_motion` ends at a residual of 1e-12 of its stiffest spring times the travel: 50 µN m, 1e-9 rad here.
        assert steady.torque == pytest.approx(found.torque[i], abs=5e-5)
        assert steady.state[0] == pytest.approx(angle[i], abs=2e-8)
    balance = found.torque * speed - sum(found.powers[name] for name in ("nut", "bearings", "guide", "motor"))
    np.testing.assert_allclose(balance, 0.0, atol=1e-3)  # travel errors and a bristle take no power but rounding's


def test_heat_takes_the_friction_that_the_motion_declares() -> None:
    heat = axis().heat
    speeds = np.array([20.0, 94.0, 300.0])
    for own, written in (
        (heat.nut, Friction(0.35, 10.0, 339e-6, 33.5e-3)),
        (heat.front, Friction(0.09, 4.5, 87.6e-6, 37e-3)),
        (heat.rear, Friction(0.03, 1.5, 87.6e-6, 37e-3)),
    ):
        assert own is not None
        # What stood in the file a second time, rounded to two or three digits.
        np.testing.assert_allclose(own.heats(speeds), written.heats(speeds), rtol=2e-3)


def test_powers_of_a_warm_machine_follow_its_oil() -> None:
    plant = axis().plant
    log = warm_log(cycling()[0], 20.0)
    powers = friction_powers(plant, log)
    rises = np.array([10.0, 8.0, 4.0, 3.0])
    factors = laws_of(plant.joined_heat).factors(rises, 20.0, values_of(plant.joined_heat)).full()[:, 0]
    changes = plant.coupling.changes(Temperatures(*(20.0 + rises)), 20.0, plant.heat.preload, 33.5e-3, 11.7e-6)
    np.testing.assert_allclose(factors, [changes.preload, changes.nut_viscous, changes.bearing_viscous], rtol=1e-9)
    by = np.concatenate([[1.0], factors - 1])
    # Of 0.35 N m of preload and an oil that makes 0.0082 N m (rad/s)^(-2/3), at 40 rad/s; half the load on both nuts.
    wanted = 40.0 * (0.3504 * changes.preload + 8.23e-3 * changes.nut_viscous * 40.0 ** (2 / 3))
    assert powers["nut"][-1] @ by == pytest.approx(wanted, rel=5e-3)


def test_a_log_shows_both_motion_and_heat() -> None:
    log, _ = cycling()
    nut = {"nut_temperature": np.full(len(log), 20.0)}
    with_both = {**log.channels, "table_position": 1.6e-3 * log["motor_angle"], **nut}
    assert shown(axis().plant, [_recording(with_both)]) is Shown.BOTH
    heat_alone = {"screw_speed": np.abs(log["motor_angle"]), **nut}
    assert shown(axis().plant, [_recording(heat_alone)]) is Shown.HEAT
    assert shown(axis().plant, [log]) is Shown.MOTION


def test_prediction_of_a_log_answers_the_chain() -> None:
    """A spring half as stiff gives way twice as far, with a prediction of the stiff one at hand."""
    log, _ = cycling()
    plant, noise = axis().plant, 1e-7 * np.random.default_rng(3).standard_normal(len(log))
    table = plant.chain.motor_radius * log["motor_angle"] + noise
    nut = np.full(len(log), 20.0) + 1e5 * noise
    recording = _recording({**log.channels, "table_position": table, "nut_temperature": nut})
    evidence, predictor = prepare_warm(recording, plant, 1.0), warm_predictor(plant)
    stiffness = plant.chain_values()["axial_stiffness"]
    softer = plant.with_chain_values({**plant.chain_values(), "axial_stiffness": 0.5 * stiffness})
    positions = [predictor.predict(one, evidence)["table_position"] for one in (plant, softer)]
    left = (positions[0] - positions[1])[evidence.counted] * np.sign(evidence.log.speed[evidence.counted])
    # the guide's drag over the spring once more, by its lead: 55 N and 180 N s/m, as the file has them
    drag = 55.0 + 180.0 * np.abs(evidence.log.speed[evidence.counted]) * plant.chain.motor_radius
    np.testing.assert_allclose(left, drag / stiffness, rtol=1e-6)
