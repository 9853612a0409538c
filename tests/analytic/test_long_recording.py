"""Hours of recording: what is kept of them, what it is joined by, and what the rest says."""

from __future__ import annotations

import math
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

import feeddrive as fd
from feeddrive.diagnosis.judging.judge import judged_recordings, prepared_for_judging
from feeddrive.diagnosis.motion.preparing import prepare
from feeddrive.diagnosis.preparation import informative, prepared
from feeddrive.diagnosis.suspicion.quality import flawed
from feeddrive.interface.measured.first_look import play_seen
from feeddrive.plant.file.plant_file import read_plant
from feeddrive.recording.checks.flaws import BAD, JOINED, flaw
from feeddrive.recording.long import joined
from feeddrive.recording.long.windows import informative_windows
from feeddrive.trend.pooling import pool
from feeddrive.trend.regressors import TRAVEL, grid_for, linear_pass
from feeddrive.trend.watched_quantities import prior_widths
from tests.recovery import trend_machine as machine
from tests.recovery.long_production import blocks
from tests.recovery.rigid_runs import PLANT, Truth, rigid_run

RADIUS = machine.LEAD / (2 * math.pi)
STEP = 2e-3


def machine_of(tmp_path: Path) -> fd.Axis:
    path = tmp_path / "plant.toml"
    path.write_text(machine.PLANT, encoding="utf-8")
    return fd.load(path)


def resting(recording: fd.Recording, about: int, rows: int) -> fd.Recording:
    """The recording with a rest of so many rows where the motor turns round next to a row."""
    speed = np.abs(np.diff(recording["motor_angle"][about : about + 1000]))
    at = about + int(np.argmin(speed))
    channels = {
        name: np.insert(samples, at, np.full(rows, samples[at])) for name, samples in recording.channels.items()
    }
    return replace(recording, time=STEP * np.arange(len(recording) + rows), channels=channels)


@pytest.fixture
def long_one(monkeypatch: pytest.MonkeyPatch) -> fd.Recording:
    """Ten minutes at 500 Hz, of which the second to the fifth stand still; recordings of two minutes are long here."""
    monkeypatch.setattr(joined, "LONGEST", 60_000)
    monkeypatch.setattr(joined, "KEPT_ROWS", 30_000)
    state = machine.State(play=6e-6, seed=5)
    return resting(machine.recording(state, seconds=360.0), 30_000, 120_000)


def test_short_recording_is_as_it_was() -> None:
    recording = machine.recording(machine.State(), seconds=8.0)
    assert joined.shortened(recording, RADIUS) is recording


def test_what_stands_still_tells_nothing(long_one: fd.Recording) -> None:
    stretches, _ = informative_windows(long_one, 60.0)
    assert sum(last - first for first, last in stretches) == 30_000
    inside = sum(max(0, min(last, 150_000) - max(first, 30_000)) for first, last in stretches)
    assert inside <= 10.0 / STEP  # one window for the level at rest at most


def test_what_is_kept_is_what_was_recorded(long_one: fd.Recording) -> None:
    found = joined.shortened(long_one, RADIUS)
    (bridge,) = (one for one in found.flaws if one.kind == JOINED)
    own = np.setdiff1d(np.arange(len(found)), bridge.rows)
    at = np.round((found.time[own] - long_one.time[0]) / STEP).astype(int)
    np.testing.assert_array_equal(found.time[own], long_one.time[at])
    for name, samples in found.channels.items():
        np.testing.assert_array_equal(samples[own], long_one[name][at])
    assert len(own) > 0.7 * len(found) and np.all(np.diff(found.time) > 0)


def test_bridges_are_motions_that_the_drive_could_make(long_one: fd.Recording) -> None:
    found = joined.shortened(long_one, RADIUS)
    for recording, factor in ((long_one, 1.0), (found, 1.02)):
        speed, bend = (np.abs(np.diff(recording["motor_angle"], order)).max() for order in (1, 2))
        if factor == 1.0:
            fastest, hardest = speed, bend
        assert speed <= factor * fastest
        # both ends are met at their own accelerations, beside that of the way
        assert bend <= 2.5 * hardest
    assert found["motor_angle"].min() >= long_one["motor_angle"].min()
    assert found["motor_angle"].max() <= long_one["motor_angle"].max()


def test_flaws_stay_at_their_samples(long_one: fd.Recording) -> None:
    first, last = informative_windows(long_one, 60.0)[0][-1]
    row = (first + last) // 2
    marked = replace(long_one, flaws=(flaw("motor_torque", BAD, [row], long_one["motor_torque"]),))
    found = joined.shortened(marked, RADIUS)
    (moved,) = (one for one in found.flaws if one.kind == BAD)
    assert found.time[moved.rows[0]] == long_one.time[row]


def test_joints_are_no_fault_of_the_recorder(long_one: fd.Recording) -> None:
    found = joined.shortened(long_one, RADIUS)
    assert any(one.kind == JOINED for one in found.flaws) and flawed([found]) == ()


def test_clock_goes_on_over_what_is_left_out(long_one: fd.Recording) -> None:
    found = joined.shortened(long_one, RADIUS)
    assert joined.clock(found)[-1] == pytest.approx(found.time[-1] - found.time[0])
    even = joined.clock(long_one)
    np.testing.assert_allclose(even, STEP * np.arange(len(long_one)))


def test_statistics_are_of_all(long_one: fd.Recording) -> None:
    notes = joined.shortened(long_one, RADIUS).notes
    told = " ".join(notes)
    assert "300000 rows" in told and "60 s" not in told.split("rows")[0]
    # 360 of 600 s move; sines rest for a moment at their ends
    share = float(next(note for note in notes if "moves for" in note).split("moves for ")[1].split(" %")[0])
    assert 55 <= share <= 61
    torque = long_one["motor_torque"]
    assert f"rms of motor_torque: {math.sqrt(np.mean(torque**2)):.2g}" in told


def test_play_of_the_whole_is_found_in_what_is_kept(long_one: fd.Recording, tmp_path: Path) -> None:
    """6 µm, as a short recording shows them: of which 1 % is turned over by less than 1 N, and noise is 20 nm."""
    axis = machine_of(tmp_path)
    grid = grid_for(axis.plant, long_one)
    travel = next(one for one in linear_pass(long_one, axis.plant, grid) if one.channel == "table_position")
    assert travel.rows < 30_000
    play = pool([travel], grid, prior_widths(axis.plant)).values[0, TRAVEL.index("play")]
    assert play == pytest.approx(6e-6, abs=0.1e-6)


@pytest.fixture(scope="module")
def production() -> fd.Recording:
    """Forty minutes of production at 1 kHz with 6 µm of play, warming up."""
    time, torque, angle, table = np.concatenate(list(blocks(2 / 3, 7, 6e-6))).T
    return fd.Recording.from_arrays(time=time, motor_torque=torque, motor_angle=angle, table_position=table)


def test_what_is_judged_lies_where_it_is_fitted(production: fd.Recording, monkeypatch: pytest.MonkeyPatch) -> None:
    """In place, direction and time: by time alone a third of it lies where nothing was fitted."""
    monkeypatch.setattr(joined, "KEPT_ROWS", 60_000)
    found = joined.shortened(production, RADIUS, 0.75)
    assert found.kept_apart is not None
    own = np.setdiff1d(np.arange(len(found)), next(one for one in found.flaws if one.kind == JOINED).rows)
    x = RADIUS * found["motor_angle"][own]
    moves = np.concatenate([[0.0], np.diff(x)])
    # 40 mm: a tenth of the lead map's shortest half wave; 10 µm/s is rest
    cells = 2 * (x // 0.04).astype(int) + (moves > 0)
    cells = np.where(np.abs(moves) > 1e-8, cells, -1)

    def beyond(judged: np.ndarray) -> float:
        """Share of the moving judged rows whose cell has no fitted row."""
        there = np.isin(cells[judged & (cells >= 0)], cells[~judged])
        return 1.0 - float(np.mean(there))

    judged = found.kept_apart[own]
    assert np.mean(judged) == pytest.approx(0.25, abs=0.07)
    assert beyond(judged) < 0.05 < 0.2 < beyond(np.arange(len(own)) > 0.75 * len(own))
    times = found.time[own]
    assert np.ptp(times[judged]) > 0.5 * np.ptp(times)


def test_judged_pieces_stay_what_they_are_in_a_part(production: fd.Recording) -> None:
    found = joined.shortened(production, RADIUS, 0.75)
    assert found.kept_apart is not None
    part = found.between(float(found.time[1000]), float(found.time[50_000]))
    assert part.kept_apart is not None
    np.testing.assert_array_equal(part.kept_apart, found.kept_apart[1000:50_000])
    assert joined.shortened(production, RADIUS).kept_apart is None  # judged on another recording


@pytest.mark.parametrize("play", [6e-6, 0.0])
def test_first_look_sees_a_play_beside_maps(play: float, tmp_path: Path) -> None:
    """A lead map of 4 µm that is declared nowhere stands beside it; a machine without play gives no start."""
    axis = machine_of(tmp_path)
    rows = np.concatenate(list(blocks(2 / 3, 8, play)))
    time, torque, angle, table = rows.T
    recording = fd.Recording.from_arrays(time=time, motor_torque=torque, motor_angle=angle, table_position=table)
    found = play_seen(axis.plant, informative(axis.plant, [recording], 0.75))
    assert [one.name for one in found] == (["backlash"] if play else [])
    if play:  # a start: the fit goes on from within a fifth
        assert found[0].values["width"] == pytest.approx(play, rel=0.2)


def test_noise_of_the_sensors_is_that_of_recorded_rows(long_one: fd.Recording, tmp_path: Path) -> None:
    """Bridges are smooth: a fifth of the rows, in which the quietest tenth would be found."""
    plant = machine_of(tmp_path).plant
    short = prepare(machine.recording(machine.State(play=6e-6, seed=5), seconds=60.0), plant, 1.0)
    whole = prepare(joined.shortened(long_one, RADIUS), plant, 1.0)
    for name, noise in short.noise.items():
        assert whole.noise[name] == pytest.approx(noise, rel=0.1)


def test_shown_is_what_is_judged_and_not_what_lies_between(tmp_path: Path) -> None:
    (tmp_path / "rigid.toml").write_text(PLANT, encoding="utf-8")
    plant = read_plant(tmp_path / "rigid.toml")
    recording = rigid_run("a", Truth())
    apart = np.zeros(len(recording), dtype=bool)
    apart[500:700] = apart[1500:1700] = True
    problem, (evidence,), _ = prepared(plant, [replace(recording, kept_apart=apart)], [], 0.75)
    (shown,) = judged_recordings(problem, [prepared_for_judging(problem, evidence, plant, plant)])
    np.testing.assert_array_equal(shown.time, recording.time[apart])
    assert all(np.isfinite(one.measured).all() for one in shown.channels)
