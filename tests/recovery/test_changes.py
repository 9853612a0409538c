"""What is other in one recording of an axis is said so, with its size; where nothing is, nothing is claimed.

The rigid recordings are written down in closed form (`rigid_runs`), those of the bench axis come from
`tests/generator`; neither shares code with the package.
"""

from __future__ import annotations

from pathlib import Path

import pytest

from feeddrive.diagnosis.calibration.calibrate import calibrated
from feeddrive.diagnosis.diagnose import diagnose
from feeddrive.diagnosis.judging.result import Diagnosis
from feeddrive.diagnosis.likelihood.coordinates import coordinates_of
from feeddrive.diagnosis.likelihood.fit import fit
from feeddrive.diagnosis.preparation import prepared
from feeddrive.diagnosis.recordings.change_report import is_none
from feeddrive.diagnosis.recordings.changes import Changes
from feeddrive.diagnosis.recordings.recordings import shift_of, target_of
from feeddrive.diagnosis.recordings.recordings_search import numbered
from feeddrive.effects.base import Port
from feeddrive.effects.friction.friction_vs_position import FrictionVsPosition
from feeddrive.effects.source.torque_ripple import TorqueRipple
from feeddrive.files import plants_folder
from feeddrive.plant.file.plant_file import read_plant
from feeddrive.plant.plant import Plant
from feeddrive.recording import Recording, read_recording
from feeddrive.report.words.verdict import verdict_sentences
from tests.generator import BENCH, recording_pair
from tests.generator import effects as planted
from tests.recovery.rigid_runs import PLANT, Truth, rigid_run

DATA = Path(__file__).parents[1] / "data" / "bench"


@pytest.fixture(scope="module")
def rigid(tmp_path_factory: pytest.TempPathFactory) -> Plant:
    """The declared rigid axis."""
    path = tmp_path_factory.mktemp("plant") / "rigid.toml"
    path.write_text(PLANT, encoding="utf-8")
    return read_plant(path)


def changed(result: Diagnosis) -> dict[tuple[str, str], float]:
    """Parameter and recording of every change to its difference."""
    return {(one.parameter, one.recording): one.difference.value for one in result.changes.changes}


@pytest.mark.parametrize("seed", [2, pytest.param(3, marks=pytest.mark.slow), pytest.param(4, marks=pytest.mark.slow)])
def test_nothing_changed_nothing_claimed(rigid: Plant, seed: int) -> None:
    first, second = rigid_run("a", Truth(seed=seed)), rigid_run("b", Truth(seed=10 + seed), slow=1.3)
    both, _ = diagnose(rigid, [first, second])
    apart, _ = diagnose(rigid, [first], [second])
    for result in (both, apart):
        assert [effect.name for effect in result.effects] == []
        assert result.changes.changes == ()
        assert result.changes.trials  # it was asked


@pytest.mark.parametrize(
    ("truth", "parameter", "size"),
    [
        (Truth(coulomb=1.1, seed=2), "coulomb_factor", 0.1),
        pytest.param(Truth(viscous=0.85, seed=2), "viscous_factor", -0.15, marks=pytest.mark.slow),
        pytest.param(Truth(mass=5.0, seed=2), "mass", 5.0, marks=pytest.mark.slow),
        pytest.param(Truth(force=4.0, seed=2), "force", 4.0, marks=pytest.mark.slow),
    ],
)
def test_a_level_is_other_in_the_second_recording(rigid: Plant, truth: Truth, parameter: str, size: float) -> None:
    first, second = rigid_run("a", Truth()), rigid_run("b", truth, slow=1.3)
    result, effects = diagnose(rigid, [first, second])
    assert [effect.name for effect in result.effects] == []  # what changed is no effect of the machine
    # 10 %: what is asked of a planted size
    assert changed(result) == {(parameter, "b"): pytest.approx(size, rel=0.1)}
    (change,) = result.changes.changes
    low, high = change.difference.ci95
    # the interval is one of 95 %; half of it more keeps this seed from deciding
    assert low - 0.25 * (high - low) <= size <= high + 0.25 * (high - low)
    assert [effect.values[parameter] for effect in effects] == [pytest.approx(change.here.value)]
    # the error is that of the noise, since each recording has its own level
    (torque,) = result.channels
    assert torque.after.rms < 1.2 * torque.noise_rms


@pytest.mark.parametrize("continued", [False, True])
@pytest.mark.parametrize(("first", "last"), [(0.01, 0.0), (0.0, 0.01)])
def test_a_ripple_of_one_recording_alone_is_a_change_and_the_plant_is_as_it_was_last(
    rigid: Plant, first: float, last: float, continued: bool
) -> None:
    recordings = [rigid_run("a", Truth(ripple=first)), rigid_run("b", Truth(ripple=last, seed=2), slow=1.3)]
    known = TorqueRipple.of(amplitude=0.007, order=3.0, phase=0.0)
    result, effects = diagnose(rigid, recordings, start=[known] if continued else [])
    assert [effect.name for effect in result.effects] == []  # not lacking in every recording
    # a phase is none where there is no ripple
    assert changed(result) == {("amplitude", "b"): pytest.approx(last - first, rel=0.1)}
    # what is not told from none is not carried
    assert [effect.values["amplitude"] for effect in effects] == ([pytest.approx(last, rel=0.1)] if last else [])


def test_a_continued_diagnosis_finds_what_the_last_recording_shows_alone(rigid: Plant) -> None:
    bump = (6.0, 0.03, 0.02)
    before = rigid_run("a", Truth(ripple=0.01))
    after = rigid_run("b", Truth(ripple=0.01, bump=bump, seed=2), slow=1.3)
    known = TorqueRipple.of(amplitude=0.01, order=3.0, phase=0.0)
    result, effects = diagnose(rigid, [before, after], start=[known])
    assert [effect.name for effect in result.effects] == ["torque_ripple"]
    assert changed(result) == {("peak", "b"): pytest.approx(bump[0], rel=0.1)}
    assert sorted(effect.name for effect in effects) == ["friction_vs_position", "torque_ripple"]


@pytest.mark.parametrize(
    ("first", "last"),
    [
        (Truth(ripple=0.01), Truth(bump=(15.0, 0.03, 0.01), seed=2)),
        pytest.param(Truth(bump=(15.0, 0.03, 0.01)), Truth(ripple=0.01, seed=2), marks=pytest.mark.slow),
    ],
)
def test_two_recordings_with_an_effect_each(rigid: Plant, first: Truth, last: Truth) -> None:
    result, effects = diagnose(rigid, [rigid_run("a", first), rigid_run("b", last, slow=1.3)])
    assert [effect.name for effect in result.effects] == []
    assert changed(result) == {
        ("amplitude", "b"): pytest.approx(last.ripple - first.ripple, rel=0.1),
        ("peak", "b"): pytest.approx(last.bump[0] - first.bump[0], rel=0.1),
    }
    assert [effect.name for effect in effects] == ["torque_ripple" if last.ripple else "friction_vs_position"]


@pytest.mark.parametrize(
    ("key", "peak", "none"),
    [("centre", 6.0, False), ("centre", 1e-3, False), ("peak", 6.0, False), ("peak", 1e-3, True)],
)
def test_only_a_size_that_differs_is_none(rigid: Plant, key: str, peak: float, none: bool) -> None:
    """A newton is seen a hundred times over; a place that differs says nothing of how much is there."""
    there = (peak, 0.03, 0.01)
    recordings = [rigid_run("a", Truth(bump=there)), rigid_run("b", Truth(bump=there, seed=2), slow=1.3)]
    problem = numbered(calibrated(prepared(rigid, recordings, [], 1.0)[0]))
    bump = FrictionVsPosition.of(Port.TABLE, peak=peak, centre=0.03, half_width=0.01)
    keys = [getattr(one, "key", "") for one in coordinates_of(bump, problem.plant)]
    target = target_of(bump, keys.index(key))
    differing = Changes(problem, fit(problem, [bump, shift_of(target, 0, 1)], iterations=0), (target,), ())
    assert is_none(problem, differing, bump, 1) is none


@pytest.mark.slow
@pytest.mark.parametrize("worn_last", [True, False])
def test_play_of_one_recording_alone(worn_last: bool) -> None:
    names = ["null", "backlash"] if worn_last else ["backlash", "null"]
    recordings = [read_recording(DATA / f"{name}_train.csv.gz") for name in names]
    result, effects = diagnose(read_plant(plants_folder() / "bench_axis.toml"), recordings)
    assert [effect.name for effect in result.effects] == []
    width = 7.5e-6  # as tests/data/bench says
    assert changed(result) == {
        ("width", f"{names[1]}_train.csv.gz"): pytest.approx(width if worn_last else -width, rel=0.01)
    }
    assert [effect.name for effect in effects] == (["backlash"] if worn_last else [])
    assert all(channel.after.rms < 1.2 * channel.noise_rms for channel in result.channels)


def test_a_judged_recording_with_another_level_is_recognised_and_its_error_stays(rigid: Plant) -> None:
    ripple = 0.01
    first = rigid_run("a", Truth(ripple=ripple))
    second = rigid_run("b", Truth(ripple=ripple, coulomb=1.15, seed=2), slow=1.3)
    result, _ = diagnose(rigid, [first], [second])
    assert [effect.name for effect in result.effects] == ["torque_ripple"]
    assert result.effects[0].carries
    assert changed(result) == {("coulomb_factor", "b"): pytest.approx(0.15, rel=0.1)}
    (change,) = result.changes.changes
    assert not change.fitted
    assert change.statement.startswith("guide Coulomb level 1")
    assert "% (± 0.3 %) higher in b than in a" in change.statement
    assert "wear" in change.reading
    (torque,) = result.channels
    assert torque.after.rms > 3 * torque.noise_rms  # the change is stated, and lowers no error
    assert result.changes.explains is not None
    assert result.changes.explains["motor_torque"] > 0.9
    # with the level allowed for nothing is left, and the verdict does not call it unexplained
    left = result.unexplained["motor_torque"]
    assert left.above is not None
    assert not left.above.is_left
    assert left.statement.startswith("What differs in the judged recordings is allowed for here.")
    assert "Still unexplained" not in " ".join(verdict_sentences(result))


@pytest.mark.slow
def test_an_effect_that_is_not_in_the_judged_recording_is_denied_by_it(rigid: Plant) -> None:
    first, second = rigid_run("a", Truth(ripple=0.01)), rigid_run("b", Truth(seed=2), slow=1.3)
    result, effects = diagnose(rigid, [first], [second])
    assert result.effects == ()
    assert effects == ()
    assert "torque_ripple" in [refused.name for refused in result.refused]


@pytest.mark.slow
def test_three_recordings_and_an_effect_of_all(rigid: Plant) -> None:
    ripple = 0.01
    runs = [
        rigid_run("monday", Truth(ripple=ripple)),
        rigid_run("tuesday", Truth(ripple=ripple, seed=2), slow=1.3),
        rigid_run("friday", Truth(ripple=ripple, viscous=0.8, seed=3), slow=1.1),
    ]
    result, _ = diagnose(rigid, runs)
    assert [effect.name for effect in result.effects] == ["torque_ripple"]
    assert changed(result) == {("viscous_factor", "friday"): pytest.approx(-0.2, rel=0.1)}
    (own,) = [one for one in result.changes.per_recording if one.parameter == "viscous_factor"]
    # 0.02: the physical minimum of a friction factor
    assert [own.values[name].value for name in ("monday", "tuesday", "friday")] == pytest.approx([1, 1, 0.8], abs=0.02)
    assert "torque_ripple.amplitude" in result.changes.shared


def test_what_changed_and_went_back_is_told_both_ways(rigid: Plant) -> None:
    """A level of one day alone: the day after it is as on the first, which no comparison with the first one tells."""
    runs = [
        rigid_run("monday", Truth()),
        rigid_run("tuesday", Truth(viscous=0.8, seed=2), slow=1.3),
        rigid_run("friday", Truth(seed=3), slow=1.1),
    ]
    result, _ = diagnose(rigid, runs)
    told = [(one.parameter, one.against, one.recording, one.difference.value) for one in result.changes.changes]
    assert [one[:3] for one in told] == [
        ("viscous_factor", "monday", "tuesday"), ("viscous_factor", "tuesday", "friday")
    ]  # fmt: skip
    assert [one[3] for one in told] == pytest.approx([-0.2, 0.2], rel=0.15)


def bench(name: str, effects: tuple[object, ...], seeds: tuple[int, int], **off: float) -> tuple[Recording, Recording]:
    """A pair of short recordings of the bench axis."""
    both = recording_pair(BENCH, effects, seeds, (8.0, 6.0), off=off)  # type: ignore[arg-type]
    channels = [dict(one) for one in both]
    runs = [Recording(f"{name}{i}", one.pop("time"), one, BENCH.sample_time) for i, one in enumerate(channels)]
    return runs[0], runs[1]


@pytest.mark.slow
def test_level_of_an_elastic_axis_beside_its_effects() -> None:
    plant = read_plant(Path(plants_folder()) / "bench_axis.toml")
    effects = (planted.TorqueRipple(amplitude=0.09, order=6.0, phase=0.7), planted.Stribeck(-22.0, 6e-3))
    result, _ = diagnose(plant, [bench("a", effects, (1, 2))[0], bench("b", effects, (3, 4), guide_coulomb=1.1)[1]])
    assert sorted(effect.name for effect in result.effects) == ["stribeck", "torque_ripple"]
    assert changed(result) == {("coulomb_factor", "b1"): pytest.approx(0.1, rel=0.1)}


@pytest.mark.slow
def test_play_that_grew() -> None:
    plant = read_plant(Path(plants_folder()) / "bench_axis.toml")
    first, _ = bench("a", (planted.Backlash(4e-6),), (5, 6))
    _, second = bench("b", (planted.Backlash(9e-6),), (7, 8))
    result, _ = diagnose(plant, [first, second])
    assert [effect.name for effect in result.effects] == ["backlash"]
    assert changed(result) == {("width", "b1"): pytest.approx(5e-6, rel=0.1)}
    assert "wear" in result.changes.changes[0].reading
