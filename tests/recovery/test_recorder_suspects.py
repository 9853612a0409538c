"""A fault of the recorder is said as one, with the mend, and no effect of the machine stands for it.

The recordings are written down in closed form (`rigid_runs`) for an axis whose values are exact, and spoilt in plain
numpy; faults and their sizes are drawn. Neither shares code with the package.
"""

from __future__ import annotations

import re
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

from feeddrive.diagnosis.diagnose import diagnose
from feeddrive.diagnosis.finding.search import Search
from feeddrive.diagnosis.judging.result import Diagnosis, Trial
from feeddrive.diagnosis.likelihood.fit import fit
from feeddrive.diagnosis.likelihood.outputs import diagnosis_record
from feeddrive.diagnosis.likelihood.problem import LEVEL
from feeddrive.diagnosis.motion.axis_evidence import AxisEvidence
from feeddrive.diagnosis.preparation import prepared
from feeddrive.diagnosis.suspicion import suspects
from feeddrive.diagnosis.suspicion.logged_rows import rhythm, with_recorder_that_holds
from feeddrive.diagnosis.suspicion.quality import Quality
from feeddrive.diagnosis.suspicion.suspects import DRIFT, GAIN, Suspect, is_worth_a_search, suspected
from feeddrive.effects.base import Effect
from feeddrive.effects.chain.payload import Payload
from feeddrive.effects.friction.stribeck import Stribeck
from feeddrive.plant.file.plant_file import read_plant
from feeddrive.plant.plant import Plant
from feeddrive.recording import Recording, read_recording
from tests.recovery.fleet.case import case
from tests.recovery.rigid_runs import NOISE, PLANT, Truth, rigid_run

KEYS = "mass|coulomb|smoothing_velocity|viscous"
EXACT = re.sub(rf'^({KEYS}) = (".*")$', r'\1 = { value = \2, source = "simulated" }', PLANT, flags=re.M)

HELD = 700_760
"""A machine of 1690 kg with 12 bits, nothing planted, whose recorder writes the torque every tenth row."""

STEP = 1e-3
"""Time between rows [s]: clearly that of a servo loop, be the clock some per cent off."""


@pytest.fixture(scope="module")
def rigid(tmp_path_factory: pytest.TempPathFactory) -> Plant:
    """The rigid axis, its values exact."""
    path = tmp_path_factory.mktemp("plant") / "rigid.toml"
    path.write_text(EXACT, encoding="utf-8")
    return read_plant(path)


def runs(seed: int, truth: Truth) -> list[Recording]:
    """Two recordings of one machine, the second of other speeds."""
    first, second = replace(truth, seed=seed), replace(truth, seed=seed + 1)
    return [rigid_run("a", first, step=STEP), rigid_run("b", second, slow=1.2, step=STEP)]


def with_clock(run: Recording, factor: float) -> Recording:
    return replace(run, time=factor * run.time, sample_time=factor * run.sample_time)


def with_torque(run: Recording, torque: np.ndarray) -> Recording:
    return replace(run, channels={**run.channels, "motor_torque": torque})


def told(result: Diagnosis) -> Quality:
    (one,) = result.quality
    return one


@pytest.mark.parametrize("seed", [1, pytest.param(2, marks=pytest.mark.slow), pytest.param(3, marks=pytest.mark.slow)])
def test_a_clock_that_is_off(rigid: Plant, seed: int) -> None:
    random = np.random.default_rng(seed)
    factor = 1 + float(random.choice([-1, 1]) * random.uniform(0.008, 0.05))
    one, other = (with_clock(run, factor) for run in runs(seed, Truth()))
    result, effects = diagnose(rigid, [one], [other])
    assert (result.effects, effects) == ((), ())
    found = told(result)
    assert (found.kind, found.channel, found.mended) == ("clock_rate", "time", True)
    assert found.ci95 is not None
    # a tenth of what is off: what is asked of a planted size
    assert found.value - 1 == pytest.approx(factor - 1, rel=0.1)
    written = re.search(r'sample_time = "(.*) ms"', found.mend)
    assert written is not None and float(written.group(1)) == pytest.approx(1e3 * STEP, rel=0.1 * abs(factor - 1))
    assert diagnosis_record(result)["quality"][0]["value"] == found.value


@pytest.mark.parametrize("seed", [4, pytest.param(5, marks=pytest.mark.slow), pytest.param(6, marks=pytest.mark.slow)])
def test_a_torque_of_another_scale(rigid: Plant, seed: int) -> None:
    random = np.random.default_rng(seed)
    factor = float(random.choice([0.85, 1.15]) * random.uniform(0.97, 1.03))
    one, other = (with_torque(run, factor * run["motor_torque"]) for run in runs(seed, Truth()))
    result, effects = diagnose(rigid, [one], [other])
    assert (result.effects, effects) == ((), ())
    found = told(result)
    assert (found.kind, found.channel) == ("channel_gain", "motor_torque")
    assert found.value == pytest.approx(factor, abs=0.1 * abs(factor - 1))
    assert f"factor = {1 / found.value:.4g}" in found.mend
    assert found.ci95 is not None and found.ci95[0] < found.value < found.ci95[1]


@pytest.mark.parametrize("seed", [21, pytest.param(22, marks=pytest.mark.slow)])
def test_a_torque_whose_zero_drifts(rigid: Plant, seed: int) -> None:
    # the whole drift is a tenth to a half of what friction asks for
    rate = float(np.random.default_rng(seed).choice([-1, 1]) * np.random.default_rng(seed).uniform(5e-4, 2e-3))
    one, other = (
        with_torque(run, run["motor_torque"] + rate * (run.time - run.time[0])) for run in runs(seed, Truth())
    )
    result, effects = diagnose(rigid, [one], [other])
    assert (result.effects, effects) == ((), ())
    found = told(result)
    assert (found.kind, found.channel, found.mended) == ("channel_drift", "motor_torque", True)
    assert found.value == pytest.approx(rate, rel=0.1)
    assert found.ci95 is not None and found.ci95[0] < found.value < found.ci95[1]


def test_a_drift_of_the_torque_leaves_a_recording_without_one_as_it_is() -> None:
    run, _ = runs(21, Truth())
    positions = replace(run, channels={name: run[name] for name in run.channels if name != "motor_torque"})
    drift = Suspect(DRIFT, size=0.1, deviation=0.01, rate=0.02)
    assert drift.mended(positions) is positions
    moved = run["motor_torque"] - drift.mended(run)["motor_torque"]
    assert moved == pytest.approx(0.1 * 0.02 * (run.time - run.time[0]))


@pytest.mark.parametrize("seed", [7, pytest.param(8, marks=pytest.mark.slow), pytest.param(9, marks=pytest.mark.slow)])
def test_a_torque_that_the_recorder_repeats(rigid: Plant, seed: int) -> None:
    every = int(np.random.default_rng(seed).integers(2, 10))
    spoilt = [
        with_torque(run, run["motor_torque"][np.arange(len(run)) // every * every]) for run in runs(seed, Truth())
    ]
    result, effects = diagnose(rigid, spoilt[:1], spoilt[1:])
    assert (result.effects, effects) == ((), ())
    assert {(one.kind, round(one.value / STEP)) for one in result.quality} == {("channel_hold", every)}


def test_a_repeated_torque_beside_an_encoder_whose_steps_show(tmp_path: Path) -> None:
    """What the steps make of the torque beyond the band is no torque, and is not to fold into every tenth row."""
    drawn = case(HELD)
    path, recording, _ = drawn.write(tmp_path)
    problem, _, _ = prepared(read_plant(path), [read_recording(recording)], [], 1.0)
    (evidence,) = problem.evidence
    assert isinstance(evidence, AxisEvidence) and "motor_torque" in evidence.gains
    held, _, (quality,) = with_recorder_that_holds(problem, [])
    assert quality.kind == "channel_hold" and quality.value == pytest.approx(10e-3)
    # noise, and what the steps leave in the band, by which it is weighed; folded, they left 3.4
    assert held.plain_error(()) < 1.3


def test_a_machine_that_lacks_something_is_not_taken_for_a_recorder(rigid: Plant) -> None:
    one, other = runs(11, Truth(mass=9.0, ripple=0.01))
    result, _ = diagnose(rigid, [one], [other])
    assert {effect.name for effect in result.effects} == {"payload", "torque_ripple"}
    assert [found.kind for found in result.quality if found.mended] == []


def searched(rigid: Plant, run: Recording, *effects: Effect, gain: float = 0.0) -> Search:
    """A search of one recording that ended with some effects as they are, the first of which had brought a gain."""
    problem, _, _ = prepared(rigid, [run], [run], 0.75)
    found, trials = fit(problem, effects, iterations=0), [Trial(1, one.name, gain, 0.0, True) for one in effects[:1]]
    return Search(problem, found, tuple(trials), (), {}, begun=(problem, fit(problem, ())))


def test_a_fault_is_not_thanked_for_a_fit_that_is_not_at_its_end(rigid: Plant) -> None:
    run, _ = runs(31, Truth(mass=9.0))
    # a part of the payload that is there: the rest is a step of the payload, be there another column or none
    found = searched(rigid, run, Payload.of(mass=7.0))
    assert found.problem.plain_error(found.fit.effects) > 2
    for one in suspects._asked(found.problem, found.fit):
        assert not one.comparison.pays


def test_a_fault_is_asked_alone_only_where_it_leaves_less_without_a_name(rigid: Plant) -> None:
    run, _ = runs(33, Truth())
    noisy = run["motor_torque"] + 3 * NOISE * np.random.default_rng(34).standard_normal(len(run))
    # less than a twentieth of the squared error, which a search without a name would have to win (`is_better`)
    small, large = (with_torque(run, factor * noisy) for factor in (1.0085, 1.1))
    assert suspected(searched(rigid, small)) is None
    # a name may be spared for it
    assert suspected(searched(rigid, small, Payload.of(mass=0.0))) is not None
    found = suspected(searched(rigid, large))
    assert found is not None and found.kind == "channel_gain"


def test_a_mended_recording_is_searched_where_the_fault_leaves_as_little_as_an_effect(rigid: Plant) -> None:
    heavy, _ = runs(35, Truth(mass=9.0))
    off, _ = runs(35, Truth())
    fault = Suspect(GAIN, 0.1)
    for run, worth in ((heavy, False), (with_torque(off, np.exp(0.1) * off["motor_torque"]), True)):
        found = searched(rigid, run, Payload.of(mass=4.0))
        mended, _, _ = prepared(rigid, [fault.mended(run)], [run], 0.75)
        assert is_worth_a_search(fault, mended, found) == worth
        assert is_worth_a_search(replace(fault, beside=True), mended, found)


def test_a_fault_must_leave_as_little_as_the_one_effect_does_where_the_search_ended(rigid: Plant) -> None:
    """A fit from the declared values on may end elsewhere: what the recording begun with holds beside stands for it."""
    heavy, light = (runs(36, Truth(mass=mass))[0] for mass in (9.0, 4.0))
    shaken = np.sin(40.0 * heavy.time)
    ended, begun = (
        searched(rigid, with_torque(heavy, heavy["motor_torque"] + size * shaken), Payload.of(mass=4.0))
        for size in (0.0, 10 * NOISE)
    )
    mended, _, _ = prepared(rigid, [with_torque(light, light["motor_torque"] + 3 * NOISE * shaken)], [light], 0.75)
    found = replace(ended, fit=fit(ended.problem, ended.fit.effects), begun=begun.begun)
    fault = Suspect(GAIN, 0.1)
    assert not is_worth_a_search(fault, mended, found)
    assert is_worth_a_search(fault, mended, replace(begun, fit=fit(begun.problem, begun.fit.effects)))


def test_a_fault_of_one_value_is_not_searched_beside_one_effect_of_one_value_where_noise_is_left(rigid: Plant) -> None:
    """Nobody tells the two apart; with two values beside it the fault may spare one, and is searched."""
    run, _ = runs(37, Truth())
    fault = Suspect(GAIN, 0.01)
    for effects, worth in (([Payload.of(mass=0.0)], False), ([Stribeck.of(delta_force=0.5, velocity=0.05)], True)):
        ended = searched(rigid, run, *effects)
        found = replace(ended, fit=fit(ended.problem, effects))
        mended, _, _ = prepared(rigid, [run], [run], 0.75)
        assert mended.plain_error(()) < 1 / LEVEL**2  # the recording holds nothing but noise
        assert is_worth_a_search(fault, mended, found) is worth


def test_an_offset_and_a_constant_force_are_said_together(rigid: Plant) -> None:
    one, other = (with_torque(run, run["motor_torque"] + 0.01) for run in runs(13, Truth()))
    result, _ = diagnose(rigid, [one], [other])
    assert [effect.name for effect in result.effects] == ["constant_force"]
    assert ("constant_force", "channel_offset") in result.ambiguous
    assert told(result).alternatives == ("constant_force",)
    assert told(result).value == pytest.approx(0.01, rel=0.1)
    assert "offset = -0.01" in told(result).mend or "offset = -10" in told(result).mend


def test_the_rhythm_of_a_repeated_channel() -> None:
    random = np.random.default_rng(17)
    fresh = random.standard_normal(400)
    every, first = int(random.integers(2, 30)), 1
    assert rhythm(np.repeat(fresh, every)[every - first :]) == (every, first)
    assert rhythm(random.standard_normal(4000)) is None
    assert rhythm(np.round(np.sin(np.linspace(0, 40, 4000)), 1)) is None  # coarse steps change at any row
