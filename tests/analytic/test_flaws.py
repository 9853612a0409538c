"""Bad cells, held and clipped stretches, jumps and copies are found; sound recordings of any machine have none."""

from __future__ import annotations

import gzip
from pathlib import Path

import numpy as np
import numpy.typing as npt
import pytest

from feeddrive.diagnosis.motion.band import Band
from feeddrive.diagnosis.preparation import prepared
from feeddrive.diagnosis.suspicion.flawed_rows import refuse_little_left, sound_rows, without_copied_position
from feeddrive.errors import InputError
from feeddrive.files import plants_folder
from feeddrive.plant.file.plant_file import read_plant
from feeddrive.recording import Recording, read_recording, write_recording
from feeddrive.recording.checks.copies import are_copies, is_copy, refuse_copied_setpoint
from feeddrive.recording.checks.find_flaws import find_flaws
from feeddrive.recording.checks.flaws import BAD, CLIPPED, HELD, JOINED, Flaw, filled, flaw, quantisation_step
from tests.analytic.sound_recordings import sound_recording

Array = npt.NDArray[np.float64]
DATA = Path(__file__).resolve().parents[1] / "data"
NULL = DATA / "bench" / "null_train.csv.gz"
SEEDS = range(8)  # a few of those in the docstring of `sound_recording`, of which none has a flaw


@pytest.fixture(scope="module")
def null() -> Recording:
    """A recording of the bench axis without a flaw: 2 kHz, 22 bits, noise on torque and scale."""
    return read_recording(NULL)


def read_back(folder: Path, recording: Recording, **changed: Array) -> Recording:
    """The recording with some channels changed, written and read."""
    write_recording(recording.with_channels(changed), folder / "a.csv")
    return read_recording(folder / "a.csv")


def flaws_of(recording: Recording) -> dict[tuple[str, str], list[int]]:
    """Channel and kind -> rows."""
    return {(one.channel, one.kind): one.rows.tolist() for one in recording.flaws}


@pytest.mark.parametrize("seed", SEEDS)
def test_no_flaw_in_sound_machines_of_any_kind(seed: int) -> None:
    sound = sound_recording(seed)
    assert find_flaws(sound.channels, sound.sample_time, 2, sound.kind) == [], sound.kind


@pytest.mark.parametrize(
    "path", sorted(DATA.glob("*/*null*.csv.gz")), ids=lambda path: f"{path.parent.name} {path.name}"
)
def test_no_flaw_in_the_recordings_of_the_tests(path: Path) -> None:
    assert read_recording(path).flaws == ()


def test_no_flaw_in_measured_and_other_recordings(shared_data: Path) -> None:
    paths = [shared_data / "axis_cases" / case / "validate.csv.gz" for case in ("null", "backlash", "presliding")]
    paths.append(shared_data / "thermal_cases" / "null" / "train.csv")
    assert all(read_recording(path).flaws == () for path in paths)
    emps = read_recording(shared_data / "emps" / "DATA_EMPS.mat", plants_folder() / "emps_map.toml")
    assert emps.flaws == ()


@pytest.mark.parametrize("seed", SEEDS)
@pytest.mark.parametrize("channel", ["motor_angle", "table_position"])
def test_a_cell_of_another_row_is_found_in_any_machine(seed: int, channel: str) -> None:
    # As far off as the whole stroke, which no machine moves in a row.
    sound = sound_recording(seed)
    samples = sound.channels[channel].copy()
    row = int(0.4 * samples.size)
    samples[row] += 3.0 * float(np.ptp(samples))
    other = {"motor_torque": sound.channels["motor_torque"]}
    both = {**sound.channels, channel: samples}
    found = find_flaws(both, sound.sample_time, 2, sound.kind)
    assert [(one.channel, one.kind, one.rows.tolist()) for one in found] == [(channel, BAD, [row])], sound.kind
    if sound.sample_time < 2e-3:
        alone = find_flaws({**other, channel: samples}, sound.sample_time, 2, sound.kind)
        assert (channel, BAD) in {(one.channel, one.kind) for one in alone}, sound.kind


def test_bad_cells_are_filled_said_and_placed(tmp_path: Path, null: Recording) -> None:
    angle, torque, position = (null[name].copy() for name in ("motor_angle", "motor_torque", "table_position"))
    angle[9000], torque[[12000, 15001]], position[[7000, 7001]] = 0.0, (999.0, -999.0), 0.0
    recording = read_back(tmp_path, null, motor_angle=angle, motor_torque=torque, table_position=position)
    assert flaws_of(recording) == {
        ("motor_angle", BAD): [9000],
        ("motor_torque", BAD): [12000, 15001],
        ("table_position", BAD): [7000, 7001],
    }
    # A cubic misses smooth motion by its fourth derivative: 2 kHz rows of a stroke, well below a microradian per step.
    assert abs(recording["motor_angle"][9000] - null["motor_angle"][9000]) < 1e-5
    assert abs(recording["table_position"][7000] - null["table_position"][7000]) < 2e-7
    assert abs(recording["motor_torque"][12000]) < 10.0
    assert any(
        "motor_torque: 2 samples far from what stands beside (999 N m in row 12002" in n for n in recording.notes
    )


@pytest.mark.parametrize("channel", ["motor_angle", "table_position", "motor_torque"])
@pytest.mark.parametrize("rows", [8, 30, 200])
def test_held_dropouts_are_found(tmp_path: Path, null: Recording, channel: str, rows: int) -> None:
    samples, starts = null[channel].copy(), (1440, 4080, 7920)
    for start in starts:
        samples[start : start + rows] = samples[start]
    found = flaws_of(read_back(tmp_path, null, **{channel: samples}))
    assert set(found) == {(channel, HELD)}
    assert found[channel, HELD] == [row for start in starts for row in range(start, start + rows)]


@pytest.mark.parametrize("bits", [10, 12, 16])
def test_filled_samples_move_in_the_steps_of_their_channel(bits: int) -> None:
    """A value between two steps would be the least difference of the channel, and its steps would not be seen."""
    random, step = np.random.default_rng(bits), 2 * np.pi / 2**bits
    time = 5e-4 * np.arange(8000)
    angle = step * np.rint(20.0 * np.sin(3.0 * time + random.uniform(0, 6)) / step)
    angle = np.array([float(f"{value:.12g}") for value in angle])  # as a file holds it
    assert quantisation_step(angle) == pytest.approx(step, rel=1e-6)
    broken = angle.copy()
    broken[1234], broken[4000:4007] = 1e6, broken[3999]
    flaws = (flaw("motor_angle", BAD, [1234], broken), flaw("motor_angle", HELD, range(4000, 4007), broken))
    mended = filled({"motor_angle": broken}, flaws)["motor_angle"]
    assert quantisation_step(mended) == pytest.approx(step, rel=1e-6)
    # within the steps of the samples it was made from, and of its own: the curve through them is that of a slow sine
    assert np.max(np.abs(mended - angle)) < 4 * step + 1e-6


@pytest.mark.parametrize("every", [2, 3, 5, 10])
def test_channels_of_slower_loops_are_sound(tmp_path: Path, null: Recording, every: int) -> None:
    index = np.arange(len(null)) // every * every
    for names in (
        ["motor_torque"],
        ["motor_angle", "table_position"],
        ["motor_torque", "motor_angle", "table_position"],
    ):
        assert flaws_of(read_back(tmp_path, null, **{name: null[name][index] for name in names})) == {}


@pytest.mark.parametrize("step", [0.01, 0.1, 0.5, 2.0])
def test_coarse_torques_are_sound(tmp_path: Path, null: Recording, step: float) -> None:
    assert flaws_of(read_back(tmp_path, null, motor_torque=step * np.round(null["motor_torque"] / step))) == {}


@pytest.mark.parametrize("share", [0.9, 0.6, 0.3])
def test_a_torque_cut_off_below_the_drives_limit_is_found(tmp_path: Path, null: Recording, share: float) -> None:
    top = round(share * float(np.max(np.abs(null["motor_torque"]))), 3)
    recording = read_back(tmp_path, null, motor_torque=np.clip(null["motor_torque"], -top, top))
    assert {(one.kind, abs(one.level)) for one in recording.flaws} == {(CLIPPED, top)}
    cut = np.flatnonzero(np.abs(null["motor_torque"]) >= top)
    marked = np.unique(np.concatenate([one.rows for one in recording.flaws]))
    # Single samples at the limit beside samples below it are noise that touched it: they are right to within the noise.
    assert np.isin(cut, marked).mean() > 0.75
    assert np.isin(marked, cut).all()


def test_a_position_cut_off_is_found(tmp_path: Path, null: Recording) -> None:
    top = 0.8 * float(np.max(null["table_position"]))
    found = flaws_of(read_back(tmp_path, null, table_position=np.minimum(null["table_position"], top)))
    assert set(found) == {("table_position", CLIPPED)}


def test_limits_of_the_declared_drive_are_kept_and_others_left_out() -> None:
    rows, band = np.arange(500, 600), Band(100.0, 2000.0)
    recording = Recording("a", np.arange(4000) * 5e-4, {"motor_torque": np.zeros(4000)}, 5e-4)
    for level, kept in ((30.0, True), (-30.2, True), (27.0, False)):
        flawed = Recording("a", recording.time, recording.channels, 5e-4, flaws=(
            Flaw("motor_torque", CLIPPED, rows, level, 1),))  # fmt: skip
        sound = sound_rows(flawed, 30.0, band)
        assert bool(sound.all()) is kept
        if not kept:  # four periods of 100 Hz on either side
            assert np.flatnonzero(~sound)[[0, -1]].tolist() == [500 - 80, 599 + 80]
    angle = Recording("a", recording.time, recording.channels, 5e-4, flaws=(Flaw("motor_angle", BAD, rows, 0.0, 1),))
    assert np.flatnonzero(~sound_rows(angle, 30.0, band))[[0, -1]].tolist() == [0, 599 + 1000]
    with pytest.raises(InputError, match="motor_angle holds 100 samples"):
        refuse_little_left(np.arange(4000) < 1900, angle)
    refuse_little_left(np.arange(4000) < 1900, recording)
    joined = Recording(
        "a", recording.time, recording.channels, 5e-4, flaws=(Flaw("motor_angle", JOINED, rows, 0.0, 1),)
    )
    refuse_little_left(np.arange(4000) < 1900, joined)  # between pieces that are kept of hours nothing was recorded


def test_flaws_follow_a_cut() -> None:
    flaw = Flaw("motor_torque", BAD, np.array([3, 50, 51, 90]), 9.0, 3)
    recording = Recording("a", np.arange(100) * 0.01, {"motor_torque": np.zeros(100)}, 0.01, flaws=(flaw,))
    cut = recording.between(0.5, 0.8)
    assert [(one.rows.tolist(), one.runs) for one in cut.flaws] == [([0, 1], 1)]
    assert recording.between(0.1, 0.3).flaws == ()


def test_rows_written_twice_or_lost_are_refused(tmp_path: Path, null: Recording) -> None:
    for rows in (np.r_[0:4110, 4080:9000], np.r_[0:4080, 4280:9000]):
        changed = Recording("a", np.arange(rows.size) * 5e-4, {n: s[rows] for n, s in null.channels.items()}, 5e-4)
        with pytest.raises(InputError, match=r"row 4\d+, column .* jumps by") as caught:
            read_back(tmp_path, changed)
        assert "lost or written twice" in caught.value.mend


def test_an_angle_within_one_revolution_is_refused(tmp_path: Path, null: Recording) -> None:
    with pytest.raises(InputError, match="begins again at every revolution"):
        read_back(tmp_path, null, motor_angle=np.mod(null["motor_angle"], 2 * np.pi))


@pytest.mark.parametrize("name", ["table_position", "motor_angle"])
def test_a_setpoint_in_place_of_the_actual_value_is_refused(tmp_path: Path, null: Recording, name: str) -> None:
    factor = 1.0 if name == "table_position" else 2 * np.pi / 0.02
    recording = read_back(tmp_path, null, **{name: factor * null["setpoint"]})
    with pytest.raises(InputError, match=f"setpoint and {name} are the same signal"):
        prepared(read_plant(plants_folder() / "bench_axis.toml"), [recording], [], 0.75)


def test_a_position_made_from_the_angle_is_not_compared(null: Recording) -> None:
    plant = read_plant(plants_folder() / "bench_axis.toml")
    made = null.with_channels({"table_position": null["motor_angle"] * plant.chain.motor_radius})
    left = without_copied_position(made, plant)
    assert "table_position" not in left and "not a scale on the table" in left.notes[-1]
    assert "table_position" in without_copied_position(null, plant)


def test_a_copy_is_told_beside_samples_that_were_filled(tmp_path: Path, null: Recording) -> None:
    """Each column is filled for itself where it repeats values: the two are then no copies there."""
    plant = read_plant(plants_folder() / "bench_axis.toml")
    setpoint = 0.1 + 0.05 * np.sin(np.pi * null.time)
    held = setpoint / plant.chain.motor_radius
    held[3500:3540] = held[3500]
    found = read_back(tmp_path, null, setpoint=setpoint, motor_angle=held)
    assert any(one.channel == "motor_angle" and one.rows.size for one in found.flaws)
    assert not is_copy(found["setpoint"], found["motor_angle"])
    assert are_copies(found, "setpoint", "motor_angle") and not are_copies(null, "setpoint", "motor_angle")
    with pytest.raises(InputError, match="setpoint and motor_angle are the same signal"):
        refuse_copied_setpoint(found)


@pytest.mark.parametrize("seed", SEEDS)
def test_two_sensors_are_no_copies(seed: int) -> None:
    sound = sound_recording(seed)
    assert not is_copy(sound.channels["motor_angle"], sound.channels["table_position"]), sound.kind


def test_a_temperature_apart_from_its_neighbours_is_refused(tmp_path: Path) -> None:
    time = 30.0 * np.arange(400)
    noise = 0.03 * np.random.default_rng(3).standard_normal(400)
    warm = Recording("w", time, {"nut_temperature": 23 + 10 * (1 - np.exp(-time / 3000)) + noise}, 30.0)
    assert read_back(tmp_path, warm).flaws == ()
    spoilt = warm["nut_temperature"].copy()
    spoilt[200] = 850.0  # an open thermocouple
    with pytest.raises(InputError, match='row 202, column "nut_temperature": 850 °C'):
        read_back(tmp_path, warm, nut_temperature=spoilt)


def test_gz_and_plain_find_the_same(tmp_path: Path, null: Recording) -> None:
    torque = null["motor_torque"].copy()
    torque[5000] = 999.0
    first = read_back(tmp_path, null, motor_torque=torque)
    (tmp_path / "b.csv.gz").write_bytes(gzip.compress((tmp_path / "a.csv").read_bytes()))
    second = read_recording(tmp_path / "b.csv.gz")
    assert flaws_of(first) == flaws_of(second) == {("motor_torque", BAD): [5000]}
    assert np.array_equal(first["motor_torque"], second["motor_torque"])


def test_a_copy_is_told_through_the_digits_of_a_file() -> None:
    """Positions made from the angle and written with twelve digits; a sensor that sees a nanometre more is none."""
    random = np.random.default_rng(4)
    angle = np.cumsum(random.standard_normal(4000)) * 0.05 + 120.0
    position = angle * 0.020 / (2 * np.pi)
    digits = [np.array([float(f"{value:.12g}") for value in series]) for series in (angle, position)]
    assert is_copy(*digits)
    assert not is_copy(angle, position + 1e-9 * random.standard_normal(4000))
