"""Dialects of trace files as drives, controls and loggers write them beside the layouts of their makers' manuals."""

from __future__ import annotations

import importlib
import json
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from scipy.io import savemat

from feeddrive.errors import InputError
from feeddrive.interface.measured.inspection import inspect
from feeddrive.recording.files.opening import open_file
from feeddrive.recording.formats.parquet import NAME as PARQUET
from feeddrive.recording.traces.channel_choice import Wishes
from feeddrive.recording.traces.container import trace_of
from feeddrive.recording.traces.naming import candidate
from feeddrive.recording.traces.opened import Understood, columns_of, read_trace, understand
from feeddrive.recording.traces.trace import Signal, Trace
from feeddrive.typing import FloatArray
from tests.analytic.trace_files import current, motion, sinumerik_trace

TIME: FloatArray = np.arange(1500) * 1e-3
PLACE, TORQUE = motion(TIME)[0], 1.25 * current(TIME)


def library(name: str) -> Any:
    return pytest.importorskip(name)


def opened(path: Path, wishes: Wishes | None = None) -> Understood:
    """Return what a file is understood as."""
    wishes = wishes or Wishes()
    found = read_trace(open_file(path), wishes)
    assert isinstance(found, Trace)
    return understand(found, wishes, str(path))


def axis_of(time: FloatArray, place: Any = None, torque: Any = None) -> dict[str, Any]:
    """Return columns of a table of an axis."""
    return {"table_position [mm]": motion(time)[0] if place is None else place,
            "motor_torque [Nm]": 1.25 * current(time) if torque is None else torque}  # fmt: skip


def from_arrays(arrays: dict[str, Any], wishes: Wishes | None = None, **units: str) -> Understood:
    wishes = wishes or Wishes()
    return understand(trace_of(PARQUET, arrays, units, wishes.sample_time, "a.parquet"), wishes, "a.parquet")


@pytest.mark.parametrize(
    ("name", "counted", "resolved"),
    [
        ("time", TIME, 0.0),
        ("time_ms", TIME * 1e3, 1e-15),
        ("t_us", TIME * 1e6, 1e-15),
        ("TimeStamp", TIME, 0.0),
        ("elapsed time (ms)", TIME * 1e3, 1e-15),
        ("Tempo", TIME, 0.0),
        ("时间", TIME, 0.0),
        ("time", 1.7e9 + TIME, 2.4e-7),  # a double near 1.7e9 resolves 0.24 µs
        ("time", np.round(1.7e12 + TIME * 1e3), 1e-15),
        ("time", 1_700_000_000_000_000_000 + np.round(TIME * 1e9).astype(np.int64), 1e-15),
        ("time", 133_000_000_000_000_000 + np.round(TIME * 1e7).astype(np.int64), 1e-15),  # 100 ns since 1601
        ("time", 739000.25 + TIME / 86400.0, 1.1e-5),  # days as MATLAB counts them resolve 10 µs
        ("time", 45250.5 + TIME / 86400.0, 7e-7),
        ("time", np.datetime64("2026-01-31T10:00:00", "us") + np.round(TIME * 1e6).astype("m8[us]"), 1e-15),
    ],
)
def test_what_time_stamps_count(name: str, counted: Any, resolved: float) -> None:
    result = from_arrays({name: counted, **axis_of(TIME)})
    assert np.max(np.abs(result.time - result.time[0] - TIME)) <= resolved
    assert np.array_equal(result.channels["table_position"], PLACE / 1e3)


def test_whole_numbers_without_a_unit_are_no_seconds() -> None:
    arrays = {"time": np.arange(0, 3000, 2), **axis_of(2.0 * TIME)}
    assert "counts in whole numbers and has no unit" in from_arrays(arrays).choice.blocking
    result = from_arrays(arrays, Wishes(sample_time=2e-3))
    assert np.allclose(result.time, 2.0 * TIME, rtol=0.0, atol=1e-15)


def test_time_that_does_not_increase_is_named() -> None:
    stamps = TIME.copy()
    stamps[700] = stamps[699]
    assert (
        "the time time does not increase at row 701" in from_arrays({"time": stamps, **axis_of(TIME)}).choice.blocking
    )


def test_each_group_has_its_own_clock() -> None:
    arrays = {"drive.t": TIME, "drive.motor_torque": TORQUE,
              "scale.t": 2.0 * TIME, "scale.table_position": motion(2.0 * TIME)[0]}  # fmt: skip
    units = {"drive.motor_torque": "N m", "scale.table_position": "mm"}
    result = understand(trace_of("made", arrays, units, None, "a"), Wishes(), "a")
    assert np.allclose(result.channels["table_position"], motion(result.time)[0] / 1e3, rtol=0.0, atol=1e-12)


def test_signal_that_lacks_values_keeps_its_own_times() -> None:
    slow = np.where(np.arange(TIME.size) % 4 == 0, PLACE, np.nan)  # two rates joined in one table
    result = from_arrays({"time": TIME, **axis_of(TIME, place=slow)})
    assert np.array_equal(result.time, TIME[::4])
    assert np.array_equal(result.channels["table_position"], PLACE[::4] / 1e3)


def test_unit_that_is_stated_and_unknown_is_not_replaced_by_the_usual_one() -> None:
    signal = Signal("s ist/X", TIME, PLACE, "inc")
    speed = Signal("v ist/X", TIME, motion(TIME)[1] * 60.0, "")  # the factor of mm and mm/min settles nothing here
    result = understand(Trace("made", (signal, speed)), Wishes(), "a")
    assert "table_position" not in result.channels
    assert any('is in "inc", which is not known' in question for question in result.choice.questions)


@pytest.mark.parametrize(
    ("name", "unit", "channel"),
    [
        ("/Nck/!SEMA/measPos2 [u1, 7]", "", "table_position"),
        ("/Nck/!SEMA/measPos1 [u1, 7]", "", "motor_side_position"),
        ("/Nck/!SD/nckServoDataActPos2ndEnc64 [u1, 1]", "", "table_position"),
        ("/Nck/!SD/nckServoDataActPos1stEnc64 [u1, 1]", "", "motor_side_position"),
        ("/Nck/!SEMA/cmdContrPos [u1, 1]", "", "setpoint"),
        ("/Nck/!SEMA/measPosDev [u1, 1]", "", ""),
        ("/Nck/!SD/nckServoDataCmdTorque64 [u1, 1]", "", ""),
        ("Torque setpoint", "Nm", ""),
        ("MotorTorqueCommand", "Nm", ""),
        ("fast/Position", "mm", "table_position"),
        ("limits/Position max", "mm", ""),
        ("position_mm", "", "table_position"),
        ("pos_act", "nm", "table_position"),
        ("torque_Nm", "", "motor_torque"),
        ("实际位置", "mm", "table_position"),
        ("指令位置", "mm", "setpoint"),
        ("位置误差", "mm", ""),
        ("电机转速", "rpm", "motor_speed"),
        ("Posizione effettiva", "mm", "table_position"),
        ("Coppia motore", "Nm", "motor_torque"),
        ("Velocità motore", "giri/min", "motor_speed"),
        ("Lagesollwert", "mm", "setpoint"),
        ("Position des Tisches", "mm", ""),  # a German genitive, no desired position
        ("des_pos", "mm", "setpoint"),
        ("hm2_5i25.0.encoder.00.position", "mm", "table_position"),
        ("Motordrehzahl", "1/min", "motor_speed"),
    ],
)
def test_names(name: str, unit: str, channel: str) -> None:
    found = candidate(Signal(name, TIME, PLACE, unit))
    assert (found.channel if found is not None else "") == channel
    assert found is None or not unit or found.unit


def test_operate_trace_of_a_linear_axis_with_two_encoders(tmp_path: Path) -> None:
    """As an 840D sl of 2026 writes it: both encoders as nckServoData, values only when they change."""
    place, speed, _ = motion(TIME * 2.0)
    listed = [("CmdPos2ndEnc64", "posn", place), ("ActPos1stEnc64", "posn", place - 800.0),
              ("ActPos2ndEnc64", "posn", place), ("CmdVelCtrlIn64", "velo", speed * 60.0),
              ("ActVel1stEnc64", "velo", speed * 60.0), ("ActVel2ndEnc64", "velo", speed * 60.0),
              ("CtrlDev64", "posn", 0.0 * place), ("DrvLoad64", "percent", 0.0 * place),
              ("ActCurr64", "current", current(TIME * 2.0)), ("CmdTorque64", "611DTime1", TORQUE)]  # fmt: skip
    lines = ['<?xml version="1.0" encoding="utf-8" ?>', "<!--XML file generated by SINUMERIK Solution Line Trace-->",
             '<traceSession version="01.00.03.02"><traceData dataFrames="1"><dataFrame>',
             '<frameHeader dropOuts="0" startTime="2026-06-03T17:57:40.613Z" stopInc="2.998000"/>']  # fmt: skip
    lines += [
        f'<dataSignal key="s{i}" event="255" unitsType="{kind}" name="/Nck/!SD/nckServoData{name} [u1, 1]" '
        f'datapointCount="1500" domain="NCU_1" interval="0.002000" dataType="double" id="f{i}"/>'
        for i, (name, kind, _) in enumerate(listed, start=1)
    ]
    before = [""] * len(listed)
    for row in range(TIME.size):
        cells = [f"{values[row]:.6f}" for _, _, values in listed]
        new = [f'f{i}="{cell}"' for i, cell in enumerate(cells, start=1) if cell != before[i - 1]]
        lines.append(f'<rec time="{2e-3 * row:.6f}" {" ".join(new)}/>')
        before = cells
    path = tmp_path / "X.xml"
    path.write_text("\n".join([*lines, "</dataFrame></traceData></traceSession>"]), encoding="utf-8")
    result = opened(path, Wishes(lead=0.01))
    assert set(result.channels) == {"setpoint", "table_position", "motor_angle", "motor_current", "table_velocity"}
    assert np.max(np.abs(result.channels["table_position"] - place / 1e3)) < 1e-9  # written to 1 nm
    turns = (place - 800.0) / 10.0
    assert np.max(np.abs(result.channels["motor_angle"] / (2.0 * np.pi) - turns)) < 1e-7
    assert np.max(np.abs(result.channels["table_velocity"] - speed / 1e3)) < 1e-10


def test_xml_in_the_encoding_that_it_declares(tmp_path: Path) -> None:
    text, _ = sinumerik_trace()
    assert "utf-8" in text
    path = tmp_path / "a.xml"
    for written, coding in (("位置实际值", "gb2312"), ("Geschwindigkeit für X", "iso-8859-1")):
        begin = text.index('description="') + len('description="')
        named = text[:begin] + written + text[text.index('"', begin) :]
        path.write_bytes(named.replace("utf-8", coding).encode(coding))
        found = read_trace(open_file(path), Wishes())
        assert isinstance(found, Trace)
        assert written in {signal.about for signal in found.signals}


@pytest.mark.parametrize(("separator", "address"), [(",", "[u1; 1]"), (";", "[u1, 1]")])
def test_operate_trace_as_a_table(tmp_path: Path, separator: str, address: str) -> None:
    names = [f"+/Nck/!SD/nckServoData{name} {address}" for name in ("ActCurr32", "ActPos2ndEnc64", "ActVelMot32")]
    place, speed, _ = motion(TIME)
    rows = []
    for row, cells in enumerate(zip(TIME, current(TIME), place, speed * 60.0, strict=True)):
        written = [f"{cell:.6f}" for cell in cells]
        if row % 2:
            written[2] = ""  # the encoder is read every second cycle
        rows.append(separator.join(written if separator == "," else [cell.replace(".", ",") for cell in written]))
    path = tmp_path / "Trace_0623.csv"
    path.write_text("\n".join([separator.join(["time", *names]), *rows]) + "\n", encoding="utf-8")
    result = opened(path)
    assert np.allclose(result.time, TIME[::2], rtol=0.0, atol=1e-15)
    assert np.max(np.abs(result.channels["table_position"] - place[::2] / 1e3)) < 1e-9


def test_edge_capture_whose_names_are_words(tmp_path: Path) -> None:
    """Words are the same for all axes, addresses are not: a torque of another axis must not be taken."""
    listed = [("Cycle", "CYCLE")] + [
        (name, f"{short}|{axis}") for axis in (1, 2) for name, short in
        (("CommandedAxisPosition", "DES_POS"), ("ActualAxisPosition", "ENC_POS"), ("Torque", "TORQUE"))
    ]  # fmt: skip
    signals = [{"Name": name, "Type": "DOUBLE", "Axis": "", "Address": address} for name, address in listed]
    rows = np.column_stack((4814008 + np.arange(TIME.size), PLACE, PLACE, TORQUE, -PLACE, -PLACE, -TORQUE))
    capture = {"Header": {"SignalListHFData": signals, "CycleTimeMs": "1"}, "Payload": [{"HFData": rows.tolist()}]}
    path = tmp_path / "capture.json"
    path.write_text(json.dumps(capture), encoding="utf-8")
    result = opened(path, Wishes(axis="1"))
    assert np.array_equal(result.channels["motor_torque"], TORQUE)
    assert result.time[1] - result.time[0] == pytest.approx(1e-3, rel=1e-12)  # a text is a number as well
    with pytest.raises(InputError, match="axes 1, 2"):
        columns_of(opened(path), str(path))
    path.write_text(json.dumps([capture, capture]), encoding="utf-8")
    with pytest.raises(InputError, match="holds 2 captures"):
        opened(path)


def test_matlab_5(tmp_path: Path) -> None:
    path = tmp_path / "rec.mat"
    parts = {"table_position": (PLACE, "mm"), "motor_torque": (TORQUE, "Nm")}
    savemat(path, {"rec": {name: {"time": TIME, "data": one, "unit": unit} for name, (one, unit) in parts.items()}})
    result = opened(path)
    assert np.array_equal(result.channels["table_position"], PLACE / 1e3)
    assert np.array_equal(result.channels["motor_torque"], TORQUE)
    assert np.array_equal(result.time, TIME)
    found = inspect(path)  # and by the mapping that is written of it
    mapping = tmp_path / "map.toml"
    mapping.write_text(found.mapping, encoding="utf-8")
    again = inspect(path, mapping).recording
    assert found.recording is not None and again is not None
    assert np.array_equal(again["motor_torque"], found.recording["motor_torque"])


def test_matlab_tables_are_refused_with_the_line_that_saves_them(tmp_path: Path) -> None:
    h5py = library("h5py")
    path = tmp_path / "table.mat"
    with h5py.File(path, "w") as file:
        handle = file.create_dataset("run", data=np.array([[3707764736, 2, 1, 1, 1, 1]], dtype=np.uint32))
        handle.attrs["MATLAB_class"], handle.attrs["MATLAB_object_decode"] = np.bytes_("timetable"), np.int32(3)
    with pytest.raises(InputError, match=r"holds run: a table.*timetable2table"):
        opened(path)


def test_matlab_7_3_structs_cells_and_texts(tmp_path: Path) -> None:
    h5py = library("h5py")
    path = tmp_path / "rec.mat"

    def text(group: Any, name: str, letters: str) -> None:
        written = group.create_dataset(name, data=np.array([[ord(letter)] for letter in letters], dtype=np.uint16))
        written.attrs["MATLAB_class"] = np.bytes_("char")

    with h5py.File(path, "w") as file:
        for name, values, unit in (("table_position", PLACE, "mm"), ("motor_torque", TORQUE, "Nm")):
            group = file.create_group(f"rec/{name}")
            group["time"], group["data"] = TIME[None, :], values[None, :]
            text(group, "unit", unit)
        text(file, "comment", "warm, after service")
        kept = file.create_group("#refs#")
        kept["a"] = PLACE[None, :]
        cell = file.create_dataset("cell", (1, 1), dtype=h5py.ref_dtype)
        cell[0, 0] = kept["a"].ref
    found = read_trace(open_file(path), Wishes())
    assert isinstance(found, Trace)
    assert {signal.name for signal in found.signals} == {
        "rec.table_position", "rec.table_position.time", "rec.motor_torque", "rec.motor_torque.time", "cell{1}",
    }  # fmt: skip
    result = opened(path)
    assert np.array_equal(result.channels["table_position"], PLACE / 1e3)
    assert np.array_equal(result.time, TIME)


def tdms(path: Path, channels: list[tuple[str, str, Any, dict[str, Any]]]) -> Path:
    library("nptdms")
    writer = importlib.import_module("nptdms")
    with writer.TdmsWriter(str(path)) as file:
        file.write_segment([writer.ChannelObject(*channel) for channel in channels])
    return path


def test_tdms_groups_stamps_and_axes(tmp_path: Path) -> None:
    wave = {"wf_increment": 1.0, "wf_xunit_string": "ms", "wf_start_time": np.datetime64("2026-01-01T10:00:00")}
    path = tdms(tmp_path / "a.tdms", [
        ("fast", "Motor Torque", TORQUE, wave | {"NI_UnitDescription": "Nm"}),
        ("slow", "Position", motion(2.0 * TIME)[0], wave | {"wf_increment": 2.0, "unit_string": "mm"}),
    ])  # fmt: skip
    result = opened(path)
    assert np.max(np.abs(result.channels["table_position"] - motion(result.time)[0] / 1e3)) < 1e-12
    assert "motor_torque" in result.channels
    stamps = np.datetime64("2026-01-01T10:00:00", "us") + np.round(TIME * 1e6).astype("m8[us]")
    path = tdms(tmp_path / "b.tdms", [
        ("g", "Time", stamps, {}), ("g", "Position", PLACE, {"unit_string": "mm"}),
        ("g", "Motor Torque", TORQUE, {"unit_string": "Nm"}),
    ])  # fmt: skip
    assert np.allclose(opened(path).time, TIME, rtol=0.0, atol=1e-15)
    path = tdms(tmp_path / "c.tdms", [("g", "Position", PLACE, {"unit_string": "mm", "wf_increment": 1.0})])
    assert "--sample-time" in opened(path).choice.blocking  # 1 with no start is what nobody set


def test_parquet_types(tmp_path: Path) -> None:
    arrow = library("pyarrow")
    parquet = importlib.import_module("pyarrow.parquet")
    day = np.datetime64("2026-01-31T10:00:00", "us")
    stamps = arrow.array([str(day + np.timedelta64(int(us), "us")) for us in np.round(TIME * 1e6)])
    drive = arrow.StructArray.from_arrays(
        [arrow.array(PLACE), arrow.array(np.round(TORQUE, 6)).cast(arrow.decimal128(12, 6))], names=list(axis_of(TIME))
    )
    parquet.write_table(arrow.table([stamps, drive], names=["time", "drive"]), tmp_path / "a.parquet")
    result = opened(tmp_path / "a.parquet")
    assert np.allclose(result.time, TIME, rtol=0.0, atol=1e-15)
    assert np.array_equal(result.channels["table_position"], PLACE / 1e3)
    assert np.allclose(result.channels["motor_torque"], np.round(TORQUE, 6), rtol=0.0, atol=1e-15)
    capture = {"CYCLE": np.arange(TIME.size) + 4814008, "ENC_POS|1": PLACE, "TORQUE|1": TORQUE}
    parquet.write_table(arrow.table(capture), tmp_path / "b.parquet")
    result = opened(tmp_path / "b.parquet")
    assert np.allclose(result.time, 2.0 * TIME, rtol=0.0, atol=1e-12)


def test_mdf_group_without_a_time_is_left_out(tmp_path: Path) -> None:
    asammdf = library("asammdf")
    twice = np.array([0.0, 0.0, 1.0])
    with asammdf.MDF(version="4.10") as file:
        for name, values, time, unit in (
            ("motor_torque", TORQUE, TIME, "Nm"), ("table_position", PLACE, TIME, "mm"), ("event", twice, twice, ""),
        ):  # fmt: skip
            file.append([asammdf.Signal(samples=values, timestamps=time, name=name, unit=unit)])
        file.save(tmp_path / "a.mf4")
    result = opened(tmp_path / "a.mf4")
    assert np.array_equal(result.channels["motor_torque"], TORQUE)
    assert "the time of event does not increase; it is left out" in result.notes
