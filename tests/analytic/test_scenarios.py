"""Scenarios: what is known of their answer, resumed runs, the torque a drive shows, every shipped one."""

from __future__ import annotations

import math
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

from feeddrive.errors import InputError
from feeddrive.files import find_scenario_file, shipped_scenarios
from feeddrive.metrology.circular import Circular
from feeddrive.metrology.evaluate import as_json, evaluate
from feeddrive.metrology.following import Following
from feeddrive.metrology.loops import ForceLoop
from feeddrive.metrology.positioning import Positioning
from feeddrive.metrology.response import Response, linear_response
from feeddrive.recording.files.reading import read_recording
from feeddrive.recording.files.writing import write_recording
from feeddrive.servo.cascade_function import cascade_controller
from feeddrive.servo.linear_loop import open_position_loop, open_velocity_loop
from feeddrive.servo.margins import margins
from feeddrive.servo.vendor_names import ALIASES
from feeddrive.simulate.controlled.acting_torque import ActingTorque
from feeddrive.simulate.controlled.controlled import TorqueLoop, resting_state, simulate_controlled
from feeddrive.simulate.scenario.scenario import Scenario, ScenarioResult
from feeddrive.simulate.scenario.scenario_file import read_scenario
from feeddrive.simulate.scenario.scenario_run import run_scenario
from tests.claims.book import CLAIMS


def scenario(name: str, **changes: str) -> Scenario:
    """A shipped scenario with values changed; `__` stands for a dot."""
    overrides = {key.replace("__", "."): value for key, value in changes.items()}
    return read_scenario(find_scenario_file(f"{name}.toml"), overrides)


def one(result: ScenarioResult, kind: type) -> object:
    """The first figure of a kind that the scenario asks for."""
    return next(found.figure for found in evaluate(result) if isinstance(found.figure, kind))


@pytest.mark.parametrize("path", shipped_scenarios(), ids=lambda path: path.stem)
def test_every_shipped_scenario_runs_at_full_length(path: Path) -> None:
    result = run_scenario(read_scenario(path))
    assert result.scenario.description
    assert all(np.isfinite(samples).all() for samples in result.series.values())
    figures = evaluate(result)
    assert figures
    for figure in figures:
        assert as_json(figure)["kind"] == figure.evaluation.kind


def test_following_error_without_feed_forward_is_velocity_over_gain() -> None:
    found = run_scenario(scenario("milling",
                                  controller__feed_forward__speed="0", force__1__end="0.5 s"))  # fmt: skip
    steady = (found.time > 1.5) & (found.time < 2.5)
    error = (found.series["setpoint"] - found.series["table_position"])[steady]
    # v / K_v = 96 µm, less half the motion within a position tick that is held: (T/2) v would be 2 µm;
    # the set-point is compared at the tick itself, so nothing is lost. The scale's step is 10 nm.
    np.testing.assert_allclose(error, 8e-3 / found.scenario.cascade.position_gain, atol=2e-8)


def test_measured_response_is_that_of_the_linear_loop() -> None:
    """The simulation of a moving axis under a multisine against the linearised closed loop of the same function."""
    result = run_scenario(scenario("frf_velocity"))
    response = one(result, Response)
    assert isinstance(response, Response)
    linear = linear_response(result, "speed_command", "motor_speed", response.frequency)
    assert linear is not None
    # friction curvature at 2 m/min over ±30 rev/min: some 0.1 % of full scale at the lowest lines
    CLAIMS["servo.response"].check(100 * np.abs(response.response - linear).max())


def test_reversal_value_is_the_backlash_less_the_wind_up() -> None:
    """Backlash of 5 µm with a motor encoder: the table stops inside the play, friction pushes it against a flank."""
    width = [
        one(run_scenario(scenario("lost_motion", effect__1__width=text)), Positioning) for text in ("5 µm", "15 µm")
    ]
    assert all(isinstance(found, Positioning) for found in width)
    first, second = (found.reversal_value for found in width)  # type: ignore[attr-defined]
    # the wind-up is the same, so 10 µm more play are 10 µm more reversal; creep of tanh friction in the dwell: 1 %
    assert second - first == pytest.approx(10e-6, rel=0.01)


def test_stiffness_loop_has_the_stiffness_of_the_chain() -> None:
    """Motor held by its encoder: torsional and axial spring in series, 202.7 N/µm, and presliding beside them."""
    loop = one(run_scenario(scenario("stiffness_loop")), ForceLoop)
    assert isinstance(loop, ForceLoop)
    radius = 0.020 / (2 * math.pi)
    series = 1 / (radius**2 / 11_982.4 + 1 / 244.7e6)
    # friction at screw and guide takes part of the force at the turns: the least-squares slope is a few per cent off
    assert loop.stiffness == pytest.approx(series, rel=0.05)


def test_quadrant_glitches_are_symmetric_and_smaller_with_friction_feed_forward() -> None:
    quick = {"trajectory__turns": "2.2", "trajectory__velocity": "6 m/min"}
    plain = one(run_scenario(scenario("circular_test", **quick)), Circular)
    helped = one(run_scenario(scenario("circular_test", **quick, controller__feed_forward__coulomb="0.54 N m",
                                       controller__feed_forward__smoothing_speed="0.5 rad/s")), Circular)  # fmt: skip
    assert isinstance(plain, Circular) and isinstance(helped, Circular)
    assert plain.glitch[0] == pytest.approx(plain.glitch[1], rel=1e-3)  # nothing in the axis knows a direction
    assert plain.glitch[0] > 0
    assert helped.glitch[0] < 0.5 * plain.glitch[0]


def test_recorded_torque_is_what_acts() -> None:
    """Mean of the lagged, delayed torque against the engine's own torque at the ticks."""
    wanted = scenario("step_position", controller__dead_time="210 us")
    cascade, controller = wanted.cascade, cascade_controller(wanted.cascade)
    loop = TorqueLoop(cascade.current_lag, cascade.dead_time)
    time = np.arange(2000) * cascade.sample_time
    motion = wanted.trajectory.at(time)
    zeros = np.zeros_like(time)
    reference = np.column_stack([motion.position, motion.velocity, motion.acceleration, zeros, zeros])
    start = resting_state(wanted.plant, controller, loop, motion.position[0])
    run = simulate_controlled(wanted.plant, controller, reference, None, loop, start)
    state, torques = ActingTorque.at_rest(loop, cascade.sample_time), []
    for k in range(200, 2000, 200):  # in stretches, as a long run does
        torques.append(state.state[0])
        assert torques[-1] == pytest.approx(run.torque[k - 200], abs=1e-9)  # rounding of 10 N m
        _, state = state.means(loop, cascade.sample_time, run.command[k - 200 : k])
    means, _ = ActingTorque.at_rest(loop, cascade.sample_time).means(loop, cascade.sample_time, run.command)
    # the trapezium of the torque at the ticks differs from its mean by the curve within a tick, and not on average
    trapezium = 0.5 * (run.torque[1:] + run.torque[:-1])
    assert np.mean(means[:-1]) == pytest.approx(np.mean(trapezium), abs=2e-3)
    assert np.max(np.abs(means)) <= np.max(np.abs(run.command))


class _StoppedError(Exception):
    pass


def test_resumed_run_is_bit_identical(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr("feeddrive.simulate.scenario.scenario_run.STRETCH", 4000)
    monkeypatch.setattr("feeddrive.simulate.scenario.scenario_run.CHECKPOINT_EVERY", 0.0)
    monkeypatch.setattr(
        "feeddrive.simulate.scenario.scenario_run.CHECKPOINT_SHARE", 1e9
    )  # at every stretch, however slow the disk
    wanted, checkpoint = scenario("sine_tracking"), tmp_path / "state.npz"
    whole = run_scenario(wanted)

    def stop(share: float) -> None:
        if share > 0.4:
            raise _StoppedError

    with pytest.raises(_StoppedError):
        run_scenario(wanted, checkpoint, stop)
    assert checkpoint.is_file()
    shares: list[float] = []
    resumed = run_scenario(wanted, checkpoint, shares.append)
    assert shares[0] > 0.4  # it did not start anew
    assert not checkpoint.exists()
    for name, samples in whole.recording.channels.items():
        np.testing.assert_array_equal(resumed.recording[name], samples)
    for name, samples in whole.series.items():
        np.testing.assert_array_equal(resumed.series[name], samples)


def test_checkpoint_of_another_scenario_is_not_used(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr("feeddrive.simulate.scenario.scenario_run.STRETCH", 1000)
    monkeypatch.setattr("feeddrive.simulate.scenario.scenario_run.CHECKPOINT_EVERY", 0.0)
    monkeypatch.setattr(
        "feeddrive.simulate.scenario.scenario_run.CHECKPOINT_SHARE", 1e9
    )  # at every stretch, however slow the disk
    checkpoint = tmp_path / "state.npz"

    def stop(share: float) -> None:
        raise _StoppedError

    with pytest.raises(_StoppedError):
        run_scenario(scenario("step_position"), checkpoint, stop)
    shares: list[float] = []
    run_scenario(scenario("step_position", trajectory__height="0.2 mm"), checkpoint, shares.append)
    assert shares[0] < 0.5
    checkpoint.write_bytes(b"nonsense")
    with pytest.raises(InputError, match="is not a checkpoint; remove it to start anew"):
        run_scenario(scenario("step_position"), checkpoint)


def test_noise_is_seeded_and_resolution_kept() -> None:
    first, again = (run_scenario(scenario("sine_tracking")).recording for _ in range(2))
    other = run_scenario(scenario("sine_tracking", record__seed="4")).recording
    np.testing.assert_array_equal(first["table_position"], again["table_position"])
    assert not np.array_equal(first["table_position"], other["table_position"])
    steps = first["table_position"] / 10e-9  # the scale's resolution
    np.testing.assert_allclose(steps, np.round(steps), atol=1e-6)
    noise = (
        first["motor_torque"] - run_scenario(scenario("sine_tracking", record__noise="{}")).recording["motor_torque"]
    )
    assert np.std(noise) == pytest.approx(0.04, rel=0.03)  # of 6000 samples: 1 %, three times


def test_recording_is_read_again(tmp_path: Path) -> None:
    """What a scenario writes, `feeddrive diagnose` reads: same channels, same numbers."""
    recording = run_scenario(scenario("sine_tracking")).recording
    write_recording(recording, tmp_path / "recording.csv")
    read = read_recording(tmp_path / "recording.csv")
    assert set(read.channels) == {"setpoint", "motor_torque", "motor_angle", "table_position"}
    np.testing.assert_array_equal(read["motor_torque"], recording["motor_torque"])


def test_names_of_makers_are_converted() -> None:
    own = scenario("step_position").cascade
    for key, value in {
        "POSCTRL_GAIN": "5",
        "kvFactor": "83.3333333333333",
        "K_v": "5 (m/min)/mm",
        "p1462": "10",
    }.items():
        found = scenario("step_position", **{f"controller__{key}": value}).cascade
        assert found.position_gain == pytest.approx(own.position_gain, rel=1e-12)
        assert found.reset_time == pytest.approx(own.reset_time, rel=1e-12)
    with pytest.raises(InputError, match="60 is a bare number"):  # K_v alone fixes no unit
        scenario("step_position", controller__K_v="60")


def test_following_is_taken_from_the_stretch_asked_for() -> None:
    result = run_scenario(scenario("step_force"))
    early, late = (found.figure for found in evaluate(result))
    assert isinstance(early, Following) and isinstance(late, Following)
    assert late.maximum < 1e-3 * early.maximum  # the integrator has brought the table back


def test_limits_of_the_drive_are_kept() -> None:
    result = run_scenario(scenario("emergency_stop"))
    assert np.max(np.abs(result.series["motor_torque"])) <= 20.0
    limited = replace(result.scenario.cascade, torque_limit=5.0)
    slower = run_scenario(replace(result.scenario, cascade=limited))
    assert np.max(np.abs(slower.series["motor_torque"])) <= 5.0


def test_readme_names_every_scenario() -> None:
    text = find_scenario_file("README.md").read_text(encoding="utf-8")
    for path in shipped_scenarios():
        assert f"| `{path.stem}` |" in text


def test_readme_names_every_alias() -> None:
    text = find_scenario_file("README.md").read_text(encoding="utf-8")
    for name in ALIASES:
        assert f"`{name}`" in text


def test_shipped_controller_has_the_margins_that_its_file_tells() -> None:
    wanted = scenario("step_position")
    speed = margins(open_velocity_loop(wanted.plant, wanted.cascade))
    place = margins(open_position_loop(wanted.plant, wanted.cascade))
    # half of the last digit told
    assert speed.gain == pytest.approx(11.0, abs=0.5)
    assert speed.phase == pytest.approx(51.0, abs=0.5)
    assert place.gain == pytest.approx(17.0, abs=1.0)
    assert speed.stable and place.stable
