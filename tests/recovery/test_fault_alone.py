"""A torque in another unit, or times of another clock, is said before any effect of the machine is searched.

The recordings are written down in closed form (`rigid_runs`), their friction off within its tolerance, and spoilt in
plain numpy by factors drawn at random. Neither shares code with the package.
"""

from __future__ import annotations

import re
from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from feeddrive.diagnosis import mended
from feeddrive.diagnosis.calibration.calibrate import calibrated
from feeddrive.diagnosis.diagnose import diagnose
from feeddrive.diagnosis.finding.search import Search, search
from feeddrive.diagnosis.preparation import prepared
from feeddrive.diagnosis.recordings import recordings_search
from feeddrive.diagnosis.suspicion import suspects
from feeddrive.diagnosis.suspicion.fault_alone import faults_alone
from feeddrive.diagnosis.suspicion.suspects import CLOCK, Suspect
from feeddrive.plant.file.plant_file import read_plant
from feeddrive.plant.plant import Plant
from feeddrive.recording import Recording, read_recording
from tests.recovery.fleet.case import case
from tests.recovery.rigid_runs import PLANT, Truth, rigid_run

STEP = 1e-3
"""Time between rows [s]: half or twice that is that of a servo loop as well."""

AS_DECLARED = Truth()

MEASURED = r'\1 = { value = \2, source = "measured" }'


@pytest.fixture(scope="module")
def rigid(tmp_path_factory: pytest.TempPathFactory) -> Plant:
    """The rigid axis, its friction measured: beside one of 30 % a clock may be a gain."""
    path = tmp_path_factory.mktemp("plant") / "rigid.toml"
    path.write_text(re.sub(r'^(coulomb|viscous) = (".*")$', MEASURED, PLANT, flags=re.M), encoding="utf-8")
    return read_plant(path)


@pytest.fixture(scope="module")
def from_data_sheet(tmp_path_factory: pytest.TempPathFactory) -> Plant:
    """The rigid axis, its friction as a data sheet has it."""
    path = tmp_path_factory.mktemp("plant") / "rigid.toml"
    path.write_text(PLANT, encoding="utf-8")
    return read_plant(path)


def runs(seed: int, truth: Truth = AS_DECLARED, off: float = 0.05) -> list[Recording]:
    """Two recordings of one machine, the second of other speeds; friction is off by a share, that of a measured one."""
    random = np.random.default_rng(seed)
    coulomb, viscous = (float(one) for one in random.uniform(1 - off, 1 + off, 2))
    off_by = replace(truth, coulomb=coulomb, viscous=viscous)
    first, second = replace(off_by, seed=seed), replace(off_by, seed=seed + 1)
    return [rigid_run("a", first, step=STEP), rigid_run("b", second, slow=1.2, step=STEP)]


def with_torque(run: Recording, factor: float) -> Recording:
    return replace(run, channels={**run.channels, "motor_torque": factor * run["motor_torque"]})


def with_clock(run: Recording, factor: float) -> Recording:
    return replace(run, time=factor * run.time, sample_time=factor * run.sample_time)


@pytest.mark.parametrize("seed", [101, 102, pytest.param(103, marks=pytest.mark.slow)])
def test_a_torque_in_another_unit(from_data_sheet: Plant, seed: int) -> None:
    """Beside friction as declared it is refused unread (`test_recording_faults`)."""
    factor = float(np.exp(np.random.default_rng(seed).choice([-1, 1]) * np.random.default_rng(seed).uniform(0.7, 4)))
    one, other = (with_torque(run, factor) for run in runs(seed, off=0.15))
    result, effects = diagnose(from_data_sheet, [one], [other])
    assert (result.effects, effects) == ((), ())
    (found,) = result.quality
    # beside a torque and a mass that are declared to 5 % each
    assert (found.kind, found.value) == ("channel_gain", pytest.approx(factor, rel=0.1))
    # one beside nothing, and one more where it was told by a scale that is free of its tolerance
    assert max(trial.round for trial in result.trials) <= 2


@pytest.mark.parametrize("seed", [111, 112, pytest.param(113, marks=pytest.mark.slow)])
def test_times_of_another_clock(rigid: Plant, seed: int) -> None:
    random = np.random.default_rng(seed)
    factor = float(np.exp(random.choice([-1, 1]) * random.uniform(0.15, 0.5)))  # of two, it is refused unread
    one, other = (with_clock(run, factor) for run in runs(seed))
    result, effects = diagnose(rigid, [one], [other])
    assert (result.effects, effects) == ((), ())
    (found,) = result.quality
    # the square of the clock stands against a mass that is declared to 5 %
    assert (found.kind, found.value) == ("clock_rate", pytest.approx(factor, rel=0.05))
    assert found.explains > 0.5 and max(trial.round for trial in result.trials) == 1


@pytest.mark.slow
@pytest.mark.parametrize(("seed", "kind", "factor"), [(701752, "channel_gain", 0.0321), (701414, "clock_rate", 0.5)])
def test_a_drawn_machine_with_such_a_recorder(tmp_path: Path, seed: int, kind: str, factor: float) -> None:
    """A torque as a share of the rated one; times half as long, beside a mass that is off by 8 %, its square 17 %."""
    plant, recording, judge = case(seed).write(tmp_path)
    result, effects = diagnose(read_plant(plant), [read_recording(recording)], [read_recording(judge)])
    assert (result.effects, effects) == ((), ())
    (found,) = (one for one in result.quality if one.kind in ("channel_gain", "clock_rate"))
    assert (found.kind, found.value) == (kind, pytest.approx(factor, rel=0.05))


@pytest.mark.parametrize("truth", [Truth(), Truth(force=15.0), Truth(ripple=0.01)])
def test_what_a_machine_lacks_is_no_fault(rigid: Plant, truth: Truth) -> None:
    run, _ = runs(131, truth)
    problem, _, _ = prepared(rigid, [run], [run], 0.75)
    assert faults_alone(calibrated(problem)) == []


def test_a_payload_is_named_where_a_clock_would_take_as_much(rigid: Plant) -> None:
    one, other = runs(131, Truth(mass=20.0))
    problem, _, _ = prepared(rigid, [one], [other], 1.0)
    first, *_ = faults_alone(calibrated(problem))
    assert first.kind == "clock_rate"
    result, _ = diagnose(rigid, [one], [other])
    assert [effect.name for effect in result.effects] == ["payload"]
    assert result.quality == ()


def test_rounds_that_came_to_the_end_of_a_search_are_not_made_again(
    rigid: Plant, monkeypatch: pytest.MonkeyPatch
) -> None:
    one, other = runs(131, Truth(mass=20.0))
    asked = []

    def counted(*arguments: Any, **options: Any) -> Search:
        asked.append(options)
        return search(*arguments, **options)

    for where in (mended, recordings_search):
        monkeypatch.setattr(where, "search", counted)
    diagnose(rigid, [one], [other])
    assert asked == [{"most_rounds": mended.ROUNDS}]


@pytest.mark.slow
def test_a_table_half_as_heavy_is_no_clock(tmp_path: Path) -> None:
    """Beside a delay of a microsecond, which came first, a clock of 10 % left as little, and a Stribeck drop."""
    plant, recording, judge = case(702949).write(tmp_path)
    result, _ = diagnose(read_plant(plant), [read_recording(recording)], [read_recording(judge)])
    assert [effect.name for effect in result.effects] == ["payload"]
    assert not [one for one in result.quality if one.kind == "clock_rate"]


def test_a_fault_that_no_recorder_has_is_none() -> None:
    """Mended of it, a recording of ten seconds had 2.8e9 rows."""
    assert suspects._is_sure(Suspect(CLOCK, np.log(3.0), deviation=0.01))
    assert not suspects._is_sure(Suspect(CLOCK, -14.0, deviation=0.01))


def test_a_fault_on_its_own_is_begun_with_its_whole_size(rigid: Plant) -> None:
    run, _ = runs(141)
    for kind, spoilt in (("channel_gain", with_torque(run, 0.03)), ("clock_rate", with_clock(run, 2.0))):
        problem, _, _ = prepared(rigid, [spoilt], [spoilt], 0.75)
        first, *_ = faults_alone(calibrated(problem))
        wanted = np.log({"channel_gain": 0.03, "clock_rate": 2.0}[kind])
        # friction, off by up to 5 %, is half of the torque
        assert (first.kind, first.size) == (kind, pytest.approx(wanted, abs=0.05))
