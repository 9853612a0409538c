"""Droop of the torque constant, inertias, channels recorded late: closed forms, identities, refusals."""

from __future__ import annotations

import math
from dataclasses import replace
from pathlib import Path

import casadi as ca
import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from scipy.integrate import quad

from feeddrive.diagnosis.motion.axis_evidence import AxisEvidence
from feeddrive.diagnosis.motion.prediction import AxisPredictor
from feeddrive.diagnosis.motion.preparing import prepare
from feeddrive.effects.base import Effect, Port
from feeddrive.effects.chain.inertia_deviation import InertiaDeviation, declared_inertia
from feeddrive.effects.chain.payload import Payload
from feeddrive.effects.source.torque_constant_droop import TorqueConstantDroop
from feeddrive.effects.timing.channel_delay import ChannelDelay
from feeddrive.effects.timing.drive_delay import DriveDelay
from feeddrive.engine.lateness import LateChannels, late_mean
from feeddrive.errors import InputError, ValidityWarning
from feeddrive.export.notes import included, left_out
from feeddrive.files import find_scenario_file, plants_folder
from feeddrive.plant.analysis.linear import linear_matrices
from feeddrive.plant.analysis.steady import steady_motion
from feeddrive.plant.chain.chain import CHAINS
from feeddrive.plant.file.lumped_text import plant_text_with_effects
from feeddrive.plant.file.plant_file import read_plant
from feeddrive.plant.motor_torque import acting_torques, asked_torques
from feeddrive.plant.plant import Plant
from feeddrive.recording import Recording
from feeddrive.servo.sampled_plant import SampledController
from feeddrive.simulate.controlled.controlled import TorqueLoop, simulate_controlled
from feeddrive.simulate.controlled.sensitivity import simulate_sensitivity
from feeddrive.simulate.held_torque import simulate_torque
from feeddrive.simulate.scenario import scenario_run
from feeddrive.simulate.scenario.scenario import Scenario
from feeddrive.simulate.scenario.scenario_file import read_scenario
from feeddrive.simulate.scenario.scenario_run import run_scenario

BENCH = read_plant(plants_folder() / "bench_axis.toml")
TESTBED = read_plant(plants_folder() / "kimm_testbed.toml")
DROOP = TorqueConstantDroop.of(share=0.08, at_torque=9.0)
MASS = Plant(
    "one mass",
    CHAINS["rigid"]({"lead": 2 * math.pi, "motor_inertia": 0.4, "screw_inertia": 0.1, "table_mass": 0.5}),
)
"""A kilogram in all, moved by a metre per radian: torque is acceleration."""


def late(channel: str, delay: float) -> ChannelDelay:
    return ChannelDelay.of(place=channel, delay=delay)


@given(st.floats(0.0, 1 / 3), st.floats(0.1, 100.0), st.floats(-1.0, 1.0))
def test_droop_loses_its_share_at_its_torque_and_is_inverted(share: float, at: float, part: float) -> None:
    plant = BENCH.with_effects(TorqueConstantDroop.of(share=share, at_torque=at))
    asked = np.array([at, -at, part * at])
    acting = acting_torques(plant, asked)
    # rounding of a few products
    assert acting[:2] == pytest.approx([at * (1 - share), -at * (1 - share)], rel=1e-12)
    # at a share of 1/3 the slope is zero there, so that half of the digits are lost
    assert asked_torques(plant, acting) == pytest.approx(asked, rel=1e-6, abs=1e-9 * at)


def test_droops_add_and_end_where_torque_rises_no_further() -> None:
    two = BENCH.with_effects(DROOP, TorqueConstantDroop.of(share=0.02, at_torque=4.5))
    one = BENCH.with_effects(TorqueConstantDroop.of(share=0.16, at_torque=9.0))  # 0.02 at 4.5 is 0.08 at 9
    asked = np.linspace(-40.0, 40.0, 81)
    assert acting_torques(two, asked) == pytest.approx(acting_torques(one, asked), rel=1e-12)
    top = 9.0 / math.sqrt(3 * 0.16)
    beyond = np.abs(asked) > top
    assert np.abs(acting_torques(one, asked)[beyond]) == pytest.approx(2 / 3 * top, rel=1e-12)
    assert asked_torques(one, np.array([2 * top])) == pytest.approx([top], rel=1e-12)


def test_drooping_axis_is_the_axis_under_the_torque_that_acts() -> None:
    time = 5e-4 * np.arange(400)
    torque = 8 * np.sin(2 * math.pi * 8 * time)
    drooping = BENCH.with_effects(DROOP)
    run = simulate_torque(drooping, time, torque)
    same = simulate_torque(BENCH, time, acting_torques(drooping, torque))
    np.testing.assert_array_equal(run.position, same.position)
    np.testing.assert_array_equal(run.torque, torque)  # what is recorded is what was asked for


def test_torque_asked_for_beyond_the_top_warns() -> None:
    time = 1e-3 * np.arange(10)
    with pytest.warns(ValidityWarning, match="rises no further beyond 18.37 N m"):
        simulate_torque(BENCH.with_effects(DROOP), time, np.full(10, 20.0))


def test_droop_acts_on_the_torque_behind_the_lag() -> None:
    """One mass, constant command: v(t) = integral of f(u (1 - exp(-t / tau)))."""
    tick, lag, command = 1e-4, 2e-3, 10.0
    state, fed, read, k, p = (
        ca.SX.sym(name, size) for name, size in (("s", 0), ("r", 1), ("m", 1), ("k", 1), ("p", 0))
    )
    function = ca.Function("open", [state, fed, read, k, p], [state, fed, ca.SX.zeros(0, 1)])
    controller = SampledController(function, np.zeros(0), np.zeros(0), tick, ("torque",), ("motor_speed",), ())
    plant = MASS.with_effects(DROOP)
    run = simulate_controlled(plant, controller, np.full((60, 1), command), torque_loop=TorqueLoop(lag))

    def pushed(time: float) -> float:
        torque = command * (1 - math.exp(-time / lag))
        return torque * (1 - 0.08 * (torque / 9) ** 2)

    wanted = [quad(pushed, 0, time)[0] for time in run.time]
    # The engine's own tolerance of 1e-11 m a step, forgotten at 100 1/s.
    assert run.table_velocity == pytest.approx(wanted, abs=1e-8)
    assert run.torque == pytest.approx(command * -np.expm1(-run.time / lag), abs=1e-9)


@pytest.mark.parametrize("plant", [BENCH, TESTBED], ids=["three inertias", "along the screw"])
def test_linearised_droop_has_the_slope_at_the_point(plant: Plant) -> None:
    drooping = plant.with_effects(TorqueConstantDroop.of(share=0.3, at_torque=3.0))
    asked = steady_motion(drooping, 0.2, 0.3).torque
    # 5e-4: the search for a steady motion ends where rounding of the stiffest spring's force does
    wanted = [steady_motion(plant, 0.2, 0.3).torque]
    assert acting_torques(drooping, np.array([asked])) == pytest.approx(wanted, rel=5e-4)
    ratio = linear_matrices(drooping, 0.2, 0.3)[1][:, 0].sum() / linear_matrices(plant, 0.2, 0.3)[1][:, 0].sum()
    assert ratio == pytest.approx(
        1 - 3 * 0.3 * (asked / 3.0) ** 2, rel=1e-3
    )  # friction's slope at slightly other loads


@pytest.mark.parametrize("plant", [BENCH, TESTBED, MASS], ids=["three inertias", "along the screw", "rigid"])
@pytest.mark.parametrize("where", InertiaDeviation.places)
def test_inertia_is_felt_whole_where_all_turns_together(plant: Plant, where: str) -> None:
    more = plant.with_effects(InertiaDeviation.of(place=where, inertia=3e-4))
    turned = np.array(plant.chain.rigid_motion(plant.chain.values), dtype=float)
    felt = [float(turned @ np.array(p.chain.mass(p.chain_values(), 0.2), dtype=float) @ turned) for p in (plant, more)]
    ratio = turned[0] * plant.chain.radius if where == "motor" and plant is TESTBED else 1.0
    assert felt[1] - felt[0] == pytest.approx(3e-4 * (ratio / plant.chain.radius) ** 2, rel=1e-9)
    grown = declared_inertia(more.chain_values(), where) - declared_inertia(plant.chain.values, where)
    assert grown == pytest.approx(3e-4, rel=1e-9)


def test_places_of_one_effect_are_not_the_same_equations() -> None:
    time = 5e-4 * np.arange(200)
    torque = 3 * np.sin(2 * math.pi * 40 * time)
    for where in ("motor", "screw", "motor"):
        plant = BENCH.with_effects(InertiaDeviation.of(place=where, inertia=3e-4))
        plain = BENCH.with_chain_values(plant.chain_values())
        run, same = simulate_torque(plant, time, torque), simulate_torque(plain, time, torque)
        np.testing.assert_array_equal(run.position, same.position)


def test_rigid_axis_cannot_tell_an_inertia_from_a_mass() -> None:
    r = MASS.chain.radius
    masses = [
        np.array(plant.chain.mass(plant.chain_values()), dtype=float)
        for plant in (
            MASS.with_effects(Payload.of(mass=0.2)),
            MASS.with_effects(InertiaDeviation.of(place="motor", inertia=0.2 * r**2)),
            MASS.with_effects(InertiaDeviation.of(place="screw", inertia=0.2 * r**2)),
        )
    ]
    assert masses[1] == pytest.approx(masses[0], rel=1e-15) and masses[2] == pytest.approx(masses[0], rel=1e-15)


def test_port_of_an_inertia_is_its_shaft() -> None:
    assert InertiaDeviation.of(place="screw", inertia=0.0).port == Port.SCREW
    with pytest.raises(InputError, match="not the same shaft"):
        InertiaDeviation.of(Port.MOTOR, place="screw", inertia=0.0)
    with pytest.raises(InputError, match=r"where 'table' is not possible.*motor, screw"):
        InertiaDeviation.of(place="table", inertia=0.0)


def test_late_position_is_read_off_the_motion_between_ticks() -> None:
    tick, delay, rate = 1.25e-4, 3.37e-4, 2 * math.pi * 200
    time = tick * np.arange(200)
    position, speed = np.sin(rate * time), rate * np.cos(rate * time)
    channels = LateChannels.at_rest(BENCH.with_effects(late("table_position", delay)), tick, {})
    found, held_on = channels.read({"table_position": position, "table_velocity": speed})
    wanted = np.sin(rate * (time - delay))
    bound = (tick * rate) ** 4 / 384  # of the cubic
    assert found["table_position"][3:] == pytest.approx(wanted[3:], abs=1.01 * bound)
    assert np.abs(found["table_position"][3:] - wanted[3:]).max() > 0.1 * bound  # it is this error that is met
    after, _ = held_on.read({"table_position": position[:1] * 0, "table_velocity": speed[:1] * 0})
    assert after["table_position"][0] == pytest.approx(math.sin(rate * (200 * tick - delay)), abs=1.01 * bound)


def test_late_torque_is_the_mean_over_the_late_interval() -> None:
    torque = np.array([1.0, 2.0, 4.0, 8.0])
    assert late_mean(torque, 1e-3, 1e-3) == pytest.approx([0, 1, 2, 4], abs=1e-12)
    assert late_mean(torque, 1e-3, 1.25e-3) == pytest.approx([0, 0.75, 1.75, 3.5], abs=1e-12)


def scenario(*effects: Effect) -> Scenario:
    read = read_scenario(find_scenario_file("sine_tracking.toml"), {"run.duration": "0.5 s"})
    recorder = replace(read.recorder, noise={}, quantised=False)
    return replace(read, plant=read.plant.with_effects(*effects), recorder=recorder)


def test_scenario_records_one_channel_late_and_moves_as_before() -> None:
    plain = run_scenario(scenario())
    sample = plain.scenario.sample_time
    for channel in ChannelDelay.places:
        found = run_scenario(scenario(late(channel, 3 * sample)))
        for name, samples in plain.recording.channels.items():
            shifted = np.concatenate([np.full(3, found.recording[name][0]), samples[:-3]])
            # sums of like means in another order; positions are moved as they are
            wanted = shifted if name == channel else samples
            assert found.recording[name] == pytest.approx(wanted, rel=1e-13, abs=1e-15)
        np.testing.assert_array_equal(found.series[channel], plain.series[channel])


class _StoppedError(Exception):
    pass


def test_resumed_run_with_late_channels_is_bit_identical(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    wanted, checkpoint = scenario(late("motor_torque", 1.1e-3), late("table_position", 0.31e-3)), tmp_path / "state.npz"
    whole = run_scenario(wanted)
    monkeypatch.setattr(scenario_run, "STRETCH", 400)
    monkeypatch.setattr(scenario_run, "CHECKPOINT_EVERY", 0.0)
    monkeypatch.setattr(scenario_run, "CHECKPOINT_SHARE", 1e9)  # at every stretch, however slow the disk

    def stop(share: float) -> None:
        if share > 0.4:
            raise _StoppedError

    with pytest.raises(_StoppedError):
        run_scenario(wanted, checkpoint, stop)
    shares: list[float] = []
    resumed = run_scenario(wanted, checkpoint, shares.append)
    assert shares[0] > 0.4  # it did not start anew
    for name, samples in whole.recording.channels.items():
        np.testing.assert_array_equal(resumed.recording[name], samples)


def test_exports_say_what_acts_and_what_is_left_out() -> None:
    plant = BENCH.with_effects(DROOP, late("motor_angle", 2e-4), InertiaDeviation.of(place="screw", inertia=1e-4))
    assert "effect torque_constant_droop at port motor" in included(plant)
    assert not any("channel_delay" in line for line in included(plant))
    assert any(line.startswith("channel_delay: motor_angle is recorded 0.2 ms late") for line in left_out(plant))


def test_derivative_with_a_channel_delay_is_refused() -> None:
    state, fed, read, k, p = (
        ca.SX.sym(name, size) for name, size in (("s", 0), ("r", 1), ("m", 1), ("k", 1), ("p", 0))
    )
    function = ca.Function("open", [state, fed, read, k, p], [state, fed, ca.SX.zeros(0, 1)])
    controller = SampledController(function, np.zeros(0), np.zeros(0), 1e-3, ("torque",), ("motor_speed",), ())
    plant = BENCH.with_effects(late("motor_angle", 2e-4))
    with pytest.raises(InputError, match="acts on the recording alone"):
        simulate_sensitivity(plant, controller, np.zeros((5, 1)), ("channel_delay.delay",))


@pytest.fixture(scope="module")
def evidence() -> AxisEvidence:
    """Three seconds of the bench axis under a smooth torque, recorded without noise."""
    time = 1e-3 * np.arange(3500)
    torque = 2.5 * np.sin(2 * math.pi * 1.3 * time) + 2 * np.sin(2 * math.pi * 17 * time)
    run = simulate_torque(BENCH, time, torque)
    channels = {"motor_torque": torque, "motor_angle": run.motor_angle, "table_position": run.position}
    return prepare(Recording("smooth", time, channels, 1e-3), BENCH, 1.0)


def predicted(evidence: AxisEvidence, *effects: Effect) -> dict[str, np.ndarray]:
    plant = BENCH.with_effects(*effects)
    found = AxisPredictor().predict(plant, evidence)
    return {name: series[evidence.counted] for name, series in found.items()}


def test_delays_that_are_the_same_predict_the_same(evidence: AxisEvidence) -> None:
    drive = predicted(evidence, DriveDelay.of(delay=4e-4))
    angle = predicted(evidence, late("motor_angle", 4e-4))
    np.testing.assert_array_equal(drive["motor_torque"], angle["motor_torque"])
    plain = predicted(evidence)
    np.testing.assert_array_equal(drive["table_position"], plain["table_position"])
    both = predicted(evidence, late("motor_angle", 4e-4), late("table_position", 4e-4))
    np.testing.assert_array_equal(both["motor_torque"], drive["motor_torque"])
    np.testing.assert_array_equal(both["table_position"], plain["table_position"])
    torque = predicted(evidence, late("motor_torque", 4e-4))
    negative = predicted(evidence, DriveDelay.of(delay=-4e-4))
    np.testing.assert_array_equal(torque["motor_torque"], negative["motor_torque"])


def test_late_rows_are_those_of_a_late_recording(evidence: AxisEvidence) -> None:
    """Two samples late by moving rows is two samples late by the law; in the band both filters are the same."""
    recording, moved = evidence.recording, 2
    for channel in ChannelDelay.places:
        rows = {name: series[moved:] for name, series in recording.channels.items()}
        rows[channel] = recording[channel][:-moved]
        time = recording.time[moved:]
        other = prepare(Recording("late", time, rows, 1e-3), BENCH, 1.0)
        plant = BENCH.with_effects(late(channel, moved * 1e-3))
        found = AxisPredictor().predict(plant, other)
        kept = other.counted & (other.recording.time - time[0] > 1.0)  # the driven load side starts elsewhere
        for name, series in found.items():
            miss = (other.measured[name] - series)[kept]
            miss = miss - miss.mean() if name == "table_position" else miss
            plain = (evidence.measured[name] - AxisPredictor().predict(BENCH, evidence)[name])[evidence.counted]
            # what the plain prediction misses, and 1e-7 of what is measured for the spline of the shift
            assert np.abs(miss).max() <= 2 * np.ptp(plain) + 1e-7 * np.ptp(other.measured[name])


def test_plant_after_predicts_the_same(evidence: AxisEvidence, tmp_path: Path) -> None:
    effects = (
        DROOP, InertiaDeviation.of(place="screw", inertia=-2e-4), InertiaDeviation.of(place="motor", inertia=1e-4),
        late("motor_torque", 3e-4), late("table_position", 1e-6),
    )  # fmt: skip
    text = (plants_folder() / "bench_axis.toml").read_text(encoding="utf-8")
    path = tmp_path / "plant_after.toml"
    path.write_text(plant_text_with_effects(text, effects), encoding="utf-8")
    again = read_plant(path)
    assert [(e.name, e.place, e.port, e.values) for e in again.effects[-5:]] == [
        (e.name, e.place, e.port, e.values) for e in effects
    ]
    there = AxisPredictor().predict(again, evidence)
    for name, series in predicted(evidence, *effects).items():
        np.testing.assert_array_equal(there[name][evidence.counted], series)


def test_port_may_be_left_out_of_a_plant_file(tmp_path: Path) -> None:
    text = (plants_folder() / "bench_axis.toml").read_text(encoding="utf-8")
    path = tmp_path / "plant.toml"
    block = '\n[[effect]]\nname = "inertia_deviation"\nwhere = "screw"\ninertia = "1e-4 kg m^2"\n'
    path.write_text(text + block, encoding="utf-8")
    assert read_plant(path).effects[-1].port == Port.SCREW
    path.write_text(text + block + 'port = "motor"\n', encoding="utf-8")
    with pytest.raises(InputError, match="not the same shaft"):
        read_plant(path)
