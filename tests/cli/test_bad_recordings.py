"""Unusable recordings: each is refused in one line that names the file, the place and the mend."""

from __future__ import annotations

import gzip
import math
from collections.abc import Callable
from pathlib import Path

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from scipy.io import savemat

from feeddrive.errors import InputError
from feeddrive.recording import Recording, read_recording, write_recording

HEADER = "time [s],motor_torque [N m],table_position [m]"


def good_rows(rows: int = 200) -> list[list[str]]:
    return [[f"{0.001 * i:.3f}", f"{math.sin(0.1 * i):.4f}", f"{0.01 * math.cos(0.1 * i):.6f}"] for i in range(rows)]


def table(rows: list[list[str]], header: str = HEADER, separator: str = ",") -> str:
    return "\n".join((header, *(separator.join(row) for row in rows), ""))


def with_cell(row: int, column: int, cell: str) -> str:
    """A good table with one cell replaced; row 0 is row 2 of the file."""
    rows = good_rows()
    rows[row][column] = cell
    return table(rows)


def with_times(times: list[float]) -> str:
    rows = good_rows(len(times))
    for row, time in zip(rows, times, strict=True):
        row[0] = f"{time:.6f}"
    return table(rows)


def constant(column: int) -> str:
    rows = good_rows()
    for row in rows:
        row[column] = "1.5"
    return table(rows)


def comma_everywhere() -> str:
    return table(good_rows()).replace(".", ",")


SEMICOLONS = table(good_rows(), HEADER.replace(",", ";"), ";")
STEPS = np.full(199, 0.001)


def stamps(steps: np.ndarray) -> list[float]:  # type: ignore[type-arg]
    return [0.0, *np.cumsum(steps).tolist()]


def steps_with(index: int | slice, value: float) -> list[float]:
    steps = STEPS.copy()
    steps[index] = value
    return stamps(steps)


TEXTS: list[tuple[str, str, tuple[str, ...]]] = [
    ("no_unit", table(good_rows(), HEADER.replace(" [N m]", "")), ('"motor_torque" has no unit', "[N m]")),
    ("empty_unit", table(good_rows(), HEADER.replace("[N m]", "[]")), ("has no unit", "[N m]")),
    ("wrong_dimension", table(good_rows(), HEADER.replace("N m", "N")), ("a torque", 'column "motor_torque"')),
    ("torque_in_joule", table(good_rows(), HEADER.replace("N m", "J")), ("an energy",)),
    ("unknown_unit", table(good_rows(), HEADER.replace("N m", "Nmm m")), ("motor_torque",)),
    ("unknown_channel", table(good_rows(), HEADER.replace("torque", "torqe")), ('did you mean "motor_torque"',)),
    ("foreign_channel", table(good_rows(), HEADER.replace("motor_torque", "Torque")), ('did you mean "motor_torque"',)),
    ("repeated_column", table(good_rows(), HEADER.replace("table_position [m]", "time [s]")), ("two columns",)),
    ("no_time", table(good_rows(), HEADER.replace("time [s]", "setpoint [m]")), ("no time column", "time [s]")),
    ("only_time", "time [s]\n" + "\n".join(f"{i}" for i in range(200)), ("no channel",)),
    ("nan", with_cell(49, 1, "nan"), ("NaN", "row 51", 'column "motor_torque')),
    ("inf", with_cell(49, 2, "inf"), ("infinite", "row 51", 'column "table_position"')),
    ("overflow", with_cell(49, 2, "1e999"), ("infinite", "row 51")),
    ("blank_row", table(good_rows()).replace("\n0.050,", "\n\n0.050,"), ("blank", "row 52")),
    ("empty_cell", with_cell(49, 1, ""), ("empty", "row 51", 'column "motor_torque')),
    ("not_a_number", with_cell(49, 1, "err"), ('"err" is not a number', "row 51", 'column "motor_torque')),
    ("clock_time", with_cell(0, 0, "12:00:01"), ("not a number", "row 2", 'column "time')),
    ("short_row", table([*good_rows(), ["0.200", "1.0"]]), ("2 cells", "3 columns", "row 202")),
    ("long_row", with_cell(49, 2, "0.1,0.2"), ("4 cells", "row 51")),
    ("backwards", with_times(steps_with(99, -0.0005)), ("backwards", "row 102", 'column "time"')),
    ("two_runs", table([*good_rows(), *good_rows()]), ("backwards", "row 202")),
    ("duplicated_stamp", with_times(steps_with(99, 0.0)), ("twice", "row 102", 'column "time"')),
    ("gap", with_times(steps_with(99, 0.013)), ("gap of 12 missing samples (1 gap in the file)", "row 102")),
    ("lost_sample", with_times(steps_with(99, 0.002)), ("gap of 1 missing sample ", "row 102")),
    ("two_rates", with_times(steps_with(slice(150, None), 0.002)), ("two sample rates", "row 153", "0.002")),
    ("two_near_rates", with_times(steps_with(slice(100, None), 0.0011)), ("two sample rates",)),
    ("irregular", with_times(steps_with(slice(0, None, 3), 0.0003)), ("irregular", "row 3")),
    ("header_only", HEADER + "\n", ("no row of numbers",)),
    ("too_short", table(good_rows(99)), ("only 99 rows", "100")),
    ("constant_torque", constant(1), ("never changes", 'column "motor_torque"', "1.5")),
    ("constant_position", constant(2), ("never changes", 'column "table_position"')),
    ("comma_for_both", comma_everywhere(), ("decimal sign cannot be decided", "--decimal", "row 2")),
    ("comma_and_point", SEMICOLONS.replace("0.005;", "0,005;"), ("--decimal", "row 7")),
    ("semicolon_rows", table(good_rows(), separator=";"), ("row 2", "1 cells")),
    ("round_brackets", table(good_rows(), HEADER.replace("time [s]", "Time (s)")), ("round", "\"time [s]\"")),
    ("prose", "This is a letter.\nIt has no numbers.\n", ("no row of headings", "put # before")),
    ("header_of_brackets", table(good_rows(), "[s],[N m],[m]"), ("not a column heading", "name [unit]")),
    ("no_header", table(good_rows()).split("\n", 1)[1], ("no header row",)),
]  # fmt: skip


def refusal(path: Path, mapping: Path | None = None, decimal: str | None = None) -> str:
    """The line that a person gets."""
    with pytest.raises(InputError) as caught:
        read_recording(path, mapping, decimal=decimal)
    message = str(caught.value)
    assert "\n" not in message
    assert caught.value.mend
    return message


@pytest.mark.parametrize(("name", "text", "said"), TEXTS, ids=[name for name, _, _ in TEXTS])
def test_bad_text_is_refused(tmp_path: Path, name: str, text: str, said: tuple[str, ...]) -> None:
    path = tmp_path / f"{name}.csv"
    path.write_text(text, encoding="utf-8")
    message = refusal(path)
    assert message.startswith(str(path))
    for part in said:
        assert part in message


BYTES: list[tuple[str, bytes, str]] = [
    ("empty.csv", b"", "empty"),
    ("spaces.csv", b" \n\n", "empty"),
    ("garbage.csv", bytes(range(256)) * 40, "not a text file"),
    ("workbook.csv", b"PK\x03\x04" + b"\x00" * 26 + b"[Content_Types].xml", "save the sheet as CSV"),
    ("dump.csv", b"PK\x03\x04" + b"\x00" * 26 + b"day/a.csv", "unpack it and name a file of it"),
    ("renamed.csv", b"MATLAB 5.0 MAT-file" + b"\x00" * 200, "damaged MATLAB file"),
    ("cut.csv.gz", gzip.compress(table(good_rows()).encode())[:-40], "damaged or cut short"),
    ("empty.csv.gz", gzip.compress(b""), "empty"),
    ("false.csv.gz", b"\x1f\x8bnothing of the kind", "damaged"),
]


@pytest.mark.parametrize(("name", "data", "said"), BYTES, ids=[name for name, _, _ in BYTES])
def test_bad_bytes_are_refused(tmp_path: Path, name: str, data: bytes, said: str) -> None:
    (tmp_path / name).write_bytes(data)
    message = refusal(tmp_path / name)
    assert message.startswith(str(tmp_path / name))
    assert said in message


def test_gz_of_a_plain_name_is_still_read(tmp_path: Path) -> None:
    (tmp_path / "a.csv").write_bytes(gzip.compress(table(good_rows()).encode()))
    assert len(read_recording(tmp_path / "a.csv")) == 200


def test_absent_file_and_folder(tmp_path: Path) -> None:
    assert "no such file" in refusal(tmp_path / "absent.csv")
    assert "is a folder" in refusal(tmp_path)


def test_decimal_option_is_judged(tmp_path: Path) -> None:
    path = tmp_path / "a.csv"
    path.write_text(table(good_rows(), HEADER.replace(",", ";"), ";"), encoding="utf-8")
    assert "not a decimal sign" in refusal(path, decimal=";")
    path.write_text(comma_everywhere(), encoding="utf-8")
    assert "6 cells" in refusal(path, decimal=".")
    path.write_text(comma_everywhere().replace("0,005,", "0,", 1), encoding="utf-8")
    assert "5 cells do not make 3 numbers" in refusal(path, decimal=",")


MAP = 'format = "feeddrive-map/1"\n[time]\nvariable = "t"\nunit = "s"\n'
TORQUE = '[channels.motor_torque]\nvariable = "u"\nunit = "N m"\n'

MAPPINGS: list[tuple[str, str, tuple[str, ...]]] = [
    ("not_toml", "format = ", ("not TOML",)),
    ("no_format", MAP.split("\n", 1)[1] + TORQUE, ("feeddrive-map/1",)),
    ("no_channel", MAP, ("no channel",)),
    ("unknown_key", MAP + TORQUE + 'unitt = "N"\n', ('did you mean "unit"',)),
    ("unknown_table", MAP + TORQUE + "[chanels.x]\n", ('did you mean "channels"',)),
    ("unknown_channel", MAP + TORQUE.replace("motor_torque", "torque"), ('did you mean "motor_torque"',)),
    ("no_unit", MAP + '[channels.motor_torque]\nvariable = "u"\n', ("unit", "motor_torque")),
    ("no_variable", MAP + '[channels.motor_torque]\nunit = "N m"\n', ("variable", "motor_torque")),
    ("wrong_unit", MAP + TORQUE.replace("N m", "N"), ("a torque", "motor_torque")),
    ("wrong_factor", MAP + TORQUE + 'factor = "2 mm"\n', ("motor_torque, unit times factor",)),
    ("evaluated_factor", MAP + TORQUE + 'factor = "2*3.14"\n', ("motor_torque, factor",)),
    ("wrong_hold", MAP + TORQUE + 'hold = "first_order"\n', ("zero_order", "interval_before")),
    ("two_times", 'sample_time = "1 ms"\n' + MAP + TORQUE, ("either [time] or sample_time",)),
    ("negative_step", 'format = "feeddrive-map/1"\nsample_time = "-1 ms"\n' + TORQUE, ("not positive",)),
    ("bare_step", 'format = "feeddrive-map/1"\nsample_time = 0.001\n' + TORQUE, ("bare number",)),
    ("bad_separator", MAP + TORQUE + '[file]\nseparator = "|"\n', ("'|'",)),
    ("absent_variable", MAP + TORQUE.replace('"u"', '"uu"'), ('no variable "uu"', 'did you mean "u"')),
    ("text_variable", MAP + TORQUE.replace('"u"', '"name"'), ("not a real numeric vector",)),
    ("short_variable", MAP + TORQUE.replace('"u"', '"short"'), ("different lengths",)),
    ("short_factor", MAP + TORQUE.replace('"u"', '["u", "short"]'), ("cannot be multiplied",)),
    ("absent_column", MAP + TORQUE.replace('"u"', '"matrix"') + "column = 3\n", ("no column 3",)),
    ("table_for_key", MAP.replace("[time]", "time = 3\n[extra]"), ("unknown key", "extra")),
]  # fmt: skip


@pytest.mark.parametrize(("name", "text", "said"), MAPPINGS, ids=[name for name, _, _ in MAPPINGS])
def test_bad_mapping_is_refused(tmp_path: Path, name: str, text: str, said: tuple[str, ...]) -> None:
    count = np.arange(200.0)
    content = {"t": count, "u": np.sin(count), "name": "axis 1", "short": count[:150], "matrix": np.ones((200, 2))}
    savemat(tmp_path / "a.mat", content)
    mapping = tmp_path / f"{name}.toml"
    mapping.write_text(text, encoding="utf-8")
    message = refusal(tmp_path / "a.mat", mapping)
    assert message.startswith((str(mapping), str(tmp_path / "a.mat")))
    for part in said:
        assert part in message


def test_absent_mapping(tmp_path: Path) -> None:
    assert "no such mapping file" in refusal(tmp_path / "a.mat", tmp_path / "absent.toml")


def test_mat_file_without_mapping_says_what_it_holds(tmp_path: Path) -> None:
    savemat(tmp_path / "a.mat", {"q": np.arange(3.0)})
    message = refusal(tmp_path / "a.mat")
    assert "it holds q" in message
    assert "--channel" in message


@pytest.mark.parametrize("data", [b"MATLAB 7.3 MAT-file".ljust(512) + b"\x89HDF\r\n\x1a\n", b"\x89HDF\r\n\x1a\n"])
def test_mat_file_of_version_7_3(tmp_path: Path, data: bytes) -> None:
    (tmp_path / "a.mat").write_bytes(data + b"\x00" * 100)
    assert "save(file, '-v7')" in refusal(tmp_path / "a.mat")


def test_mat_file_of_garbage(tmp_path: Path) -> None:
    (tmp_path / "a.mat").write_bytes(bytes(range(256)) * 20)
    assert "not a .mat file" in refusal(tmp_path / "a.mat")


@settings(max_examples=200, deadline=None)
@given(st.binary(max_size=400))
def test_any_bytes_are_refused_as_input(tmp_path_factory: pytest.TempPathFactory, data: bytes) -> None:
    folder = tmp_path_factory.getbasetemp()
    for name in ("any.csv", "any.mat"):
        (folder / name).write_bytes(data)
        refusal(folder / name)


@settings(max_examples=100, deadline=None)
@given(st.integers(0, 199), st.integers(0, 2), st.text(max_size=12))
def test_any_cell_is_a_number_or_refused(
    tmp_path_factory: pytest.TempPathFactory, row: int, column: int, cell: str
) -> None:
    path = tmp_path_factory.getbasetemp() / "cell.csv"
    path.write_text(with_cell(row, column, cell), encoding="utf-8", errors="replace")
    try:
        recording = read_recording(path)
    except InputError as error:
        assert "\n" not in str(error)
        return
    assert len(recording) == 200
    assert all(np.all(np.isfinite(samples)) for samples in recording.channels.values())


WRITE: list[tuple[str, Callable[[Path], Path], str]] = [
    ("ending", lambda folder: folder / "a.txt", ".csv"),
    ("folder_is_a_file", lambda folder: folder / "file" / "a.csv", "cannot be written"),
]


@pytest.mark.parametrize(("name", "place", "said"), WRITE, ids=[name for name, _, _ in WRITE])
def test_recording_that_cannot_be_written(tmp_path: Path, name: str, place: Callable[[Path], Path], said: str) -> None:
    (tmp_path / "file").write_text("x")
    recording = Recording("r", np.arange(3.0), {"motor_torque": np.arange(3.0)}, 1.0)
    with pytest.raises(InputError) as caught:
        write_recording(recording, place(tmp_path))
    assert said in str(caught.value)


def test_foreign_channel_is_not_written(tmp_path: Path) -> None:
    recording = Recording("r", np.arange(3.0), {"torque": np.arange(3.0)}, 1.0)
    with pytest.raises(InputError, match="motor_torque"):
        write_recording(recording, tmp_path / "a.csv")
    assert list(tmp_path.iterdir()) == []
