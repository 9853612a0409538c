"""Recordings: reading, writing, mappings, and what is found in them, against series known in closed form."""

from __future__ import annotations

import hashlib
import math
import pickle
import tempfile
from contextlib import nullcontext
from pathlib import Path

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from scipy.io import savemat

from feeddrive.errors import InputError
from feeddrive.recording import (
    Recording,
    channel_unit,
    check_against_lead,
    check_against_stroke,
    read_recording,
    without_unfollowed_setpoint,
    write_recording,
)
from feeddrive.recording.checks.flaws import quantisation_step

LEAD = 0.020
RADIUS = LEAD / (2 * math.pi)
EMPS = Path(__file__).resolve().parents[3] / "shared" / "data" / "emps" / "DATA_EMPS.mat"
EMPS_MAP = Path(__file__).resolve().parents[2] / "plants" / "emps_map.toml"


def stroke(rows: int = 400, sample_time: float = 0.001) -> Recording:
    """A sine stroke of 100 mm with a rigid transmission and a torque in phase with the speed."""
    time = sample_time * np.arange(rows)
    angle = 0.05 / RADIUS * (1.0 - np.cos(8.0 * time))
    channels = {
        "setpoint": RADIUS * angle,
        "motor_torque": 0.5 + np.sin(8.0 * time),
        "motor_angle": angle,
        "table_position": RADIUS * angle,
    }
    return Recording("stroke", time, channels, sample_time)


def written(path: Path, text: str) -> Path:
    path.write_text(text, encoding="utf-8")
    return path


def csv_text(header: str, rows: int = 120, cells: str = "{t:.3f},{x:.4f}", end: str = "\n") -> str:
    lines = (cells.format(t=0.001 * i, x=math.sin(0.05 * i)) for i in range(rows))
    return end.join((header, *lines, ""))


def test_recording_gives_channels_length_and_duration() -> None:
    recording = stroke(400)
    assert "motor_angle" in recording
    assert "screw_speed" not in recording
    assert len(recording) == 400
    assert recording.duration == pytest.approx(0.4, rel=1e-15)
    with pytest.raises(InputError, match="no channel screw_speed; it has setpoint"):
        recording["screw_speed"]


def test_between_is_closed_at_its_start_and_open_at_its_end() -> None:
    part = stroke(400, 0.25).between(10.0, 20.0)
    assert part.time[0] == 10.0
    assert part.time[-1] == 19.75
    assert part["motor_torque"].size == len(part) == 40
    with pytest.raises(InputError, match="no sample"):
        stroke().between(5.0, 6.0)


def test_with_channels_leaves_the_first_recording_alone() -> None:
    first = stroke()
    second = first.with_channels({"cutting_force": np.zeros(len(first))})
    assert "cutting_force" in second
    assert "cutting_force" not in first
    assert second.time is first.time


def test_channel_of_another_length_is_refused() -> None:
    with pytest.raises(InputError, match="channel motor_torque has shape"):
        Recording("x", np.arange(5.0), {"motor_torque": np.zeros(4)}, 1.0)


def test_recording_can_be_sent_to_another_process() -> None:
    recording = stroke()
    copy = pickle.loads(pickle.dumps(recording))
    assert np.array_equal(copy["motor_angle"], recording["motor_angle"])


@pytest.mark.parametrize("name", ["a.csv", "a.csv.gz"])
def test_written_recording_reads_back_bit_for_bit(tmp_path: Path, name: str) -> None:
    first = stroke()
    write_recording(first, tmp_path / name)
    second = read_recording(tmp_path / name)
    assert list(second.channels) == list(first.channels)
    assert np.array_equal(second.time, first.time)
    for channel, samples in first.channels.items():
        assert np.array_equal(second[channel], samples)
    assert second.sample_time == first.sample_time
    assert second.name == name
    assert second.sha256 == hashlib.sha256((tmp_path / name).read_bytes()).hexdigest()
    assert [file.name for file in tmp_path.iterdir()] == [name]


@settings(max_examples=30, deadline=None)
@given(
    # Of any size that can be measured; the rest is refused.
    st.lists(st.floats(-1e9, 1e9).filter(lambda value: value == 0 or abs(value) > 1e-6), min_size=120, max_size=120),
    st.floats(min_value=1e-5, max_value=100.0),
)
def test_any_samples_survive_writing_and_reading(values: list[float], sample_time: float) -> None:
    samples = np.array(values)
    first = Recording("any", sample_time * np.arange(120), {"cutting_force": samples}, sample_time)
    with tempfile.TemporaryDirectory() as folder:
        path = Path(folder) / "any.csv"
        write_recording(first, path)
        second = read_recording(path)
    assert np.array_equal(second["cutting_force"], samples)
    # The mean step is rounded to twelve digits.
    assert second.sample_time == pytest.approx(sample_time, rel=1e-11)


def test_same_recording_gives_the_same_archive(tmp_path: Path) -> None:
    for name in ("a.csv.gz", "b.csv.gz"):
        write_recording(stroke(), tmp_path / name)
    assert (tmp_path / "a.csv.gz").read_bytes()[:10] == (tmp_path / "b.csv.gz").read_bytes()[:10]
    assert (
        hashlib.sha256((tmp_path / "a.csv.gz").read_bytes()).digest()
        == hashlib.sha256((tmp_path / "b.csv.gz").read_bytes()).digest()
    )


def test_foreign_units_become_si(tmp_path: Path) -> None:
    header = "time [ms],table_position [mm],motor_speed [rev/min],motor_angle [deg],nut_temperature [K]"
    rows = (f"{i},{i},{60 * i},{360 * i},{273.15 + i:.2f}" for i in range(120))
    recording = read_recording(written(tmp_path / "a.csv", "\n".join((header, *rows))))
    count = np.arange(120.0)
    assert recording.sample_time == 0.001
    # Products of two rounded numbers; 273.15 has an ulp of 5.7e-14.
    np.testing.assert_allclose(recording["table_position"], 0.001 * count, rtol=4e-16)
    np.testing.assert_allclose(recording["motor_speed"], 2 * math.pi * count, rtol=4e-16)
    np.testing.assert_allclose(recording["motor_angle"], 2 * math.pi * count, rtol=4e-16)
    np.testing.assert_allclose(recording["nut_temperature"], count, atol=1.2e-13)


@pytest.mark.parametrize(
    ("header", "cells"),
    [
        ("time [s],motor_torque [N m]", "{t:.3f},{x:.4f}"),
        ("time [s];motor_torque [N m]", "{t:.3f};{x:.4f}"),
        ("time [s]\tmotor_torque [Nm]", "{t:.3f}\t{x:.4f}"),
        ('"time [s]","motor_torque [N m]"', '"{t:.3f}","{x:.4f}"'),
        ("time [s], motor_torque [N m],", " {t:.3f}, {x:.4f},"),
        ("# logged by hand\n\ntime [s],motor_torque [N m]", "{t:.3f},{x:.4f}"),
    ],
)
@pytest.mark.parametrize("end", ["\n", "\r\n"])
def test_layouts_of_loggers_read_the_same(tmp_path: Path, header: str, cells: str, end: str) -> None:
    text = csv_text(header, cells=cells, end=end)
    path = tmp_path / "a.csv"
    path.write_bytes(text.encode())
    recording = read_recording(path)
    assert len(recording) == 120
    assert recording["motor_torque"][10] == float(f"{math.sin(0.5):.4f}")


@pytest.mark.parametrize("encoding", ["utf-8", "utf-8-sig", "utf-16", "latin-1"])
def test_encodings(tmp_path: Path, encoding: str) -> None:
    path = tmp_path / "a.csv"
    path.write_bytes(csv_text("time [s],table_position [µm]").encode(encoding))
    recording = read_recording(path)
    assert recording["table_position"].max() == pytest.approx(1e-6, rel=1e-3)  # the crest falls between samples
    assert any("Latin-1" in note for note in recording.notes) == (encoding == "latin-1")


@pytest.mark.parametrize("separator", [";", "\t"])
def test_decimal_comma_is_read_and_said(tmp_path: Path, separator: str) -> None:
    text = csv_text(f"time [s]{separator}motor_torque [N m]", cells="{t:.3f}" + separator + "{x:.4f}").replace(".", ",")
    recording = read_recording(written(tmp_path / "a.csv", text))
    assert recording["motor_torque"][10] == float(f"{math.sin(0.5):.4f}")
    assert "the comma is read as the decimal sign" in recording.notes
    assert any("separated by" in note for note in recording.notes)


def test_comma_for_both_is_read_when_told(tmp_path: Path) -> None:
    text = csv_text("time [s],motor_torque [N m]").replace(".", ",")
    recording = read_recording(written(tmp_path / "a.csv", text), decimal=",")
    assert recording["motor_torque"][10] == float(f"{math.sin(0.5):.4f}")


def test_saturation_and_quantisation_are_said(tmp_path: Path) -> None:
    first = stroke(1000)
    clipped = np.clip(first["motor_torque"], -10.0, 1.2)
    position = np.round(first["table_position"] / 5e-5) * 5e-5
    write_recording(first.with_channels({"motor_torque": clipped, "table_position": position}), tmp_path / "a.csv")
    notes = " | ".join(read_recording(tmp_path / "a.csv").notes)
    assert "motor_torque is saturated at 1.2 N m" in notes
    assert "table_position moves in steps of 50 µm" in notes
    assert "motor_angle" not in notes


def test_clean_recording_has_no_notes(tmp_path: Path) -> None:
    write_recording(stroke(), tmp_path / "a.csv")
    assert read_recording(tmp_path / "a.csv").notes == ()


def test_quantisation_step_of_a_coarse_encoder_and_of_noise() -> None:
    rng = np.random.default_rng(1)
    angle = np.cumsum(rng.normal(size=20000)) * 1e-3
    step = 2 * math.pi / 2**20
    # Printed with 7 decimals, the step of 59.9e-7 appears as 59e-7 or 60e-7.
    assert quantisation_step(np.round(np.round(angle / step) * step, 7)) == pytest.approx(step, rel=0.02)
    assert quantisation_step(angle) == 0.0


@pytest.mark.parametrize("ppm", [60.0, -60.0])
def test_slow_clock_is_said(tmp_path: Path, ppm: float) -> None:
    recording = stroke(4000, 0.001 * (1 + ppm * 1e-6))
    write_recording(recording, tmp_path / "a.csv")
    assert any(f"{ppm:+.0f} ppm" in note for note in read_recording(tmp_path / "a.csv").notes)


def test_drifting_clock_is_said(tmp_path: Path) -> None:
    first = stroke(4000)
    drifting = Recording("d", first.time + 4e-4 * (first.time / 4.0) ** 2, first.channels, 0.001)
    write_recording(drifting, tmp_path / "a.csv")
    assert any("up to 0.1 samples" in note for note in read_recording(tmp_path / "a.csv").notes)


def test_coarse_time_stamps_are_no_gaps(tmp_path: Path) -> None:
    """3 kHz written with four decimals: steps of 0.3 ms and 0.4 ms."""
    cells = (f"{i / 3000:.4f},{math.sin(0.01 * i):.6f}" for i in range(3000))
    path = written(tmp_path / "a.csv", "\n".join(("time [s],motor_torque [N m]", *cells)))
    recording = read_recording(path)
    # The last stamp is rounded by up to 5e-5 s in 1 s.
    assert recording.sample_time == pytest.approx(1 / 3000, rel=5e-5)
    assert not any("drift" in note for note in recording.notes)


MAP = """
format = "feeddrive-map/1"
[time]
variable = "t"
unit = "ms"
[channels.motor_torque]
variable = ["gain", "u"]
unit = "N/V * V"
factor = "0.4 mm/rad"
[channels.motor_angle]
variable = "data.q"
unit = "m"
factor = "2500 rad/m"
[channels.motor_temperature]
variable = "sensors"
column = 2
unit = "V"
factor = "10 degC/V"
offset = "-5 K"
[channels.screw_speed]
variable = "n"
unit = "rev/min"
hold = "interval_before"
"""


def mat_content(rows: int = 200) -> dict[str, object]:
    count = np.arange(float(rows))
    return {
        "t": count[:, None],
        "gain": 35.0,
        "u": np.sin(0.1 * count),
        "data": {"q": 0.001 * count},
        "sensors": np.column_stack((count, 0.01 * count)),
        "n": 60.0 * count,
    }


def test_mat_file_through_a_mapping(tmp_path: Path) -> None:
    content = mat_content()
    savemat(tmp_path / "a.mat", content)
    recording = read_recording(tmp_path / "a.mat", written(tmp_path / "map.toml", MAP))
    count = np.arange(200.0)
    assert recording.sample_time == 0.001
    # A few roundings each.
    np.testing.assert_allclose(recording["motor_torque"], 35.0 * 0.4e-3 * np.sin(0.1 * count), rtol=1e-15)
    np.testing.assert_allclose(recording["motor_angle"], 2.5 * count, rtol=1e-15)
    np.testing.assert_allclose(recording["motor_temperature"], 0.1 * count - 5.0, rtol=1e-14, atol=1e-14)
    np.testing.assert_allclose(recording["screw_speed"][:-1], 2 * math.pi * (count[:-1] + 1.0), rtol=1e-15)
    assert "read through the mapping map.toml" in recording.notes


def test_lever_arm_as_a_length_is_the_same(tmp_path: Path) -> None:
    savemat(tmp_path / "a.mat", mat_content())
    first = read_recording(tmp_path / "a.mat", written(tmp_path / "a.toml", MAP))
    second = read_recording(tmp_path / "a.mat", written(tmp_path / "b.toml", MAP.replace("mm/rad", "mm")))
    assert np.array_equal(first["motor_torque"], second["motor_torque"])


def test_foreign_csv_without_header_and_time(tmp_path: Path) -> None:
    rows = "\n".join(f"{i};{math.sin(i):.5f}".replace(".", ",") for i in range(150))
    mapping = """
        format = "feeddrive-map/1"
        sample_time = "2 ms"
        [file]
        header_row = 0
        separator = ";"
        [channels.motor_current]
        variable = "2"
        unit = "mA"
    """
    path = written(tmp_path / "log.txt", rows)
    recording = read_recording(path, written(tmp_path / "map.toml", mapping))
    assert recording.sample_time == 0.002
    assert recording.time[0] == 0.0
    assert recording["motor_current"][1] == pytest.approx(0.84147e-3, rel=1e-15)


def test_foreign_csv_with_a_row_of_units(tmp_path: Path) -> None:
    rows = "\n".join(f"{i},{math.sin(i):.5f}" for i in range(150))
    mapping = """
        format = "feeddrive-map/1"
        [file]
        header_row = 2
        first_row = 4
        [time]
        variable = "Zeit"
        unit = "ms"
        [channels.motor_torque]
        variable = "M_ist"
        unit = "Nm"
    """
    path = written(tmp_path / "log.csv", "export 7\nZeit,M_ist\nms,Nm\n" + rows)
    recording = read_recording(path, written(tmp_path / "map.toml", mapping))
    assert len(recording) == 150
    assert recording["motor_torque"][1] == 0.84147


def test_emps_mapping_reads_the_units_that_the_file_is_said_to_have(tmp_path: Path) -> None:
    """The shipped mapping on variables of the same names; the data set itself is not in the project."""
    count = np.arange(500.0)
    savemat(
        tmp_path / "e.mat",
        {"t": 0.001 * count, "qg": 0.1 * count, "qm": 0.1 * np.sin(count), "gtau": 35.0, "vir": np.cos(count),
         "kp": 160.0, "kv": 240.0},
    )  # fmt: skip
    recording = read_recording(tmp_path / "e.mat", EMPS_MAP)
    assert list(recording.channels) == ["setpoint", "motor_torque", "motor_angle"]
    # The factors are written with 17 digits.
    np.testing.assert_allclose(recording["motor_torque"], 35.0 * np.cos(count) * 0.0025 / (2 * math.pi), rtol=1e-14)
    np.testing.assert_allclose(recording["motor_angle"], 0.1 * np.sin(count) * 2 * math.pi / 0.0025, rtol=1e-14)


@pytest.mark.skipif(not EMPS.exists(), reason="the EMPS data set is not on this machine")
def test_emps_fits_its_lead() -> None:
    recording = read_recording(EMPS, EMPS_MAP)
    assert len(recording) == 24841
    assert recording.sample_time == pytest.approx(0.001, rel=1e-6)  # stamps carry 2e-8 s of jitter
    check_against_lead(recording, 0.0025, "DATA_EMPS.mat")


@pytest.mark.parametrize(("factor", "refused"), [(1.0, False), (1.09, False), (0.92, False), (1.12, True), (0.9, True)])
def test_lead_fits_the_channels_to_a_tenth(factor: float, refused: bool) -> None:
    # The slope over the declared lead: 1 / 1.09 and 1 / 0.92 are within a tenth of one, 1 / 1.12 and 1 / 0.9 are not.
    with pytest.raises(InputError, match="while the plant's lead is") if refused else nullcontext():
        check_against_lead(stroke(), factor * LEAD, "a.csv")


@pytest.mark.parametrize(
    ("change", "said"),
    [
        (lambda r: {"motor_angle": r["table_position"], "table_position": r["motor_angle"]}, "are swapped"),
        (lambda r: {"table_position": -r["table_position"]}, "sign"),
        (lambda r: {"table_position": 1000 * r["table_position"]}, "looks like mm"),
        (lambda r: {"motor_angle": r["motor_angle"] / (2 * math.pi)}, "looks like revolutions"),
        (lambda r: {"motor_angle": r["motor_angle"] * 180 / math.pi}, "looks like degrees"),
        (lambda r: {"table_position": 0.5 * r["table_position"]}, "10 mm per revolution"),
        (lambda r: {"table_position": 0.5 * r["table_position"]}, "lead is 20 mm"),
        (lambda r: {"table_position": 0.01 * r["motor_torque"]}, "do not move together"),
    ],
)
def test_channels_that_contradict_the_lead(change: object, said: str) -> None:
    recording = stroke()
    assert callable(change)
    with pytest.raises(InputError) as caught:
        check_against_lead(recording.with_channels(change(recording)), LEAD, "a.csv")
    message = str(caught.value)
    assert message.startswith("a.csv: ")
    assert said in message
    assert "\n" not in message


@pytest.mark.parametrize(
    ("factor", "stroke_length", "said"),
    [
        (1.0, 0.1, ""),
        (1.0, 0.06, ""),  # the table went 95 mm with nine tenths of its rows: an overtravel, or a stroke in use
        (180 / math.pi, 0.12, "looks like degrees"),
        (2 * math.pi, 0.12, "check the unit of motor_angle, and the lead"),
        (1.0, 0.04, "check the unit of motor_angle, and the lead"),
        (1000.0, 0.12, "check the unit of motor_angle, and the lead"),
    ],
)
def test_a_motor_that_turns_further_than_the_stroke(factor: float, stroke_length: float, said: str) -> None:
    recording = stroke()
    angle = factor * recording["motor_angle"]
    angle[7] = 1e6  # an outlier cell is not a stroke
    there = recording.with_channels({"motor_angle": angle})
    with pytest.raises(InputError, match=said) if said else nullcontext():
        check_against_stroke(there, LEAD, (0.2, 0.2 + stroke_length), "a.csv")
    check_against_stroke(there, LEAD, None, "a.csv")


@pytest.mark.parametrize("factor", [1000.0, 0.0, -1.0])
def test_setpoint_that_is_not_followed_is_left_out_and_said(factor: float) -> None:
    recording = stroke()
    other = factor * recording["setpoint"] + (1.0 - abs(np.sign(factor))) * recording["motor_torque"]
    left = without_unfollowed_setpoint(recording.with_channels({"setpoint": other}), LEAD)
    assert "setpoint" not in left
    assert "does not follow the setpoint" in left.notes[-1]
    assert without_unfollowed_setpoint(recording, LEAD) is recording


def test_open_channel_names_have_units() -> None:
    assert channel_unit("front_bearing_temperature", "") == "degC"
    assert channel_unit("table_growth_250mm", "") == "m"
