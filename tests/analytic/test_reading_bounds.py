"""What reading takes of memory, and what it does with files that are none, or hold what nobody measures."""

from __future__ import annotations

import gzip
import os
import subprocess
import sys
import zlib
from pathlib import Path

import numpy as np
import pytest

from feeddrive.errors import InputError
from feeddrive.recording import read_recording
from feeddrive.recording.files.csv_file import Layout, find_table
from feeddrive.recording.files.opening import TextFile

HEADER = "time [s],motor_torque [N m],motor_angle [rad],table_position [m]\n"

MEASURE = """
import resource, sys
from pathlib import Path
import numpy, scipy.ndimage
import feeddrive.recording.files.reading
from feeddrive.recording import read_recording
before = resource.getrusage(resource.RUSAGE_SELF).ru_maxrss
read_recording(Path(sys.argv[1]))
print(resource.getrusage(resource.RUSAGE_SELF).ru_maxrss - before)
"""


def table(rows: int) -> str:
    """Text of a recording of a machine that goes to and fro, 2 kHz."""
    time = np.arange(rows) * 5e-4
    angle = 60.0 * np.sin(2.0 * time)
    noise = np.random.default_rng(1).standard_normal((2, rows))
    torque = 0.5 * np.sign(np.cos(2.0 * time)) - 1.4 * np.sin(2.0 * time) + 0.04 * noise[0]
    position = 0.02 / (2 * np.pi) * angle + 1.5e-8 * noise[1]
    columns = zip(time, torque, angle, position, strict=True)
    return HEADER + "".join(f"{t:.4f},{m:.3f},{a:.7f},{p:.8f}\n" for t, m, a, p in columns)


@pytest.mark.skipif(sys.platform != "linux", reason="peak memory is told in kilobytes on Linux alone")
@pytest.mark.parametrize("name", ["a.csv", "a.csv.gz"])
def test_reading_takes_two_and_a_half_times_the_text_in_memory(tmp_path: Path, name: str) -> None:
    text = table(400_000).encode()
    (tmp_path / name).write_bytes(gzip.compress(text, 1) if name.endswith(".gz") else text)
    done = subprocess.run(
        [sys.executable, "-c", MEASURE, str(tmp_path / name)], capture_output=True, text=True, check=True
    )
    # Beside it a block of text and its numbers, some 30 MB whatever the length of the file.
    assert int(done.stdout) * 1024 < 2.5 * len(text) + 30e6


@pytest.mark.parametrize("change", ["comma", "semicolon", "crlf", "cr", "utf16", "trailing"])
def test_blocks_read_as_the_whole(tmp_path: Path, monkeypatch: pytest.MonkeyPatch, change: str) -> None:
    text = table(300)
    made = {
        "comma": text,
        "semicolon": text.replace(",", ";").replace(".", ","),
        "crlf": text.replace("\n", "\r\n"),
        "cr": text.replace("\n", "\r"),
        "utf16": text,
        "trailing": text.replace(",", "\t").replace("\n", "\t\n") + "\n  \n\x1a",
    }[change]
    (tmp_path / "a.csv").write_bytes(made.encode("utf-16" if change == "utf16" else "utf-8"))
    whole = read_recording(tmp_path / "a.csv")
    for block in (97, 1000):
        monkeypatch.setattr("feeddrive.recording.files.opening.BLOCK", block)
        pieces = read_recording(tmp_path / "a.csv")
        assert pieces.notes == whole.notes and pieces.sha256 == whole.sha256
        assert all(np.array_equal(pieces[name], whole[name]) for name in whole.channels)


@pytest.mark.parametrize(
    ("row", "cell", "said"),
    [(250, "x", '"x" is not a number'), (250, "", "empty"), (299, "1,2", "5 cells")],
)
def test_a_fault_in_a_later_block_has_its_row(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, row: int, cell: str, said: str
) -> None:
    lines = table(300).split("\n")
    lines[row - 1] = ",".join([*lines[row - 1].split(",")[:2], cell, lines[row - 1].split(",")[3]])
    (tmp_path / "a.csv").write_text("\n".join(lines))
    monkeypatch.setattr("feeddrive.recording.files.opening.BLOCK", 500)
    with pytest.raises(InputError, match=f"row {row}") as caught:
        read_recording(tmp_path / "a.csv")
    assert said in str(caught.value)


def test_decimal_signs_that_differ_between_blocks(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    lines = table(300).replace(",", ";").split("\n")
    lines[200] = lines[200].replace(".", ",")
    (tmp_path / "a.csv").write_text("\n".join(lines))
    monkeypatch.setattr("feeddrive.recording.files.opening.BLOCK", 500)
    with pytest.raises(InputError, match=r"row 201.*decimal sign cannot be decided"):
        read_recording(tmp_path / "a.csv")
    with pytest.raises(InputError, match="row 2: a decimal point stands"):
        read_recording(tmp_path / "a.csv", decimal=",")


def bomb(letters: bytes) -> bytes:
    packer = zlib.compressobj(9, zlib.DEFLATED, 31)
    return b"".join([packer.compress(letters * (1_000_000 // len(letters))) for _ in range(100)]) + packer.flush()


@pytest.mark.parametrize("letters", [b"1,1,1,1\n", b"\n", b"1", b"\x00"], ids=["rows", "blank", "one", "null"])
@pytest.mark.parametrize("name", ["a.csv.gz", "a.mat"])
def test_a_bomb_is_refused(tmp_path: Path, letters: bytes, name: str) -> None:
    (tmp_path / name).write_bytes(bomb(letters))
    with pytest.raises(InputError):
        read_recording(tmp_path / name)


def test_what_is_no_file_is_refused_at_once(tmp_path: Path) -> None:
    os.mkfifo(tmp_path / "pipe.csv")
    (tmp_path / "loop.csv").symlink_to(tmp_path / "loop.csv")
    names = ("pipe.csv", "loop.csv", "a\0.csv", "a" * 300 + ".csv", "")
    for path in (*(tmp_path / name for name in names), Path("/dev/zero"), Path("/dev/null")):
        with pytest.raises(InputError):
            read_recording(path)
        with pytest.raises(InputError):
            read_recording(tmp_path / "a.mat", path)


@pytest.mark.parametrize(
    ("column", "factor", "said"),
    [
        (1, "e150", "a million times what is usual"),
        (1, "e-300", "changes by no more than"),
        (3, "e9", "a million times"),
        (0, "e300", 'column "time"'),
        (0, "e-15", "changes by no more than"),
    ],
)
def test_numbers_that_nobody_measures_are_refused(tmp_path: Path, column: int, factor: str, said: str) -> None:
    rows = [line.split(",") for line in table(300).split("\n")[1:-1]]
    for row in rows:
        row[column] += factor
    (tmp_path / "a.csv").write_text(HEADER + "\n".join(",".join(row) for row in rows))
    with pytest.raises(InputError) as caught:
        read_recording(tmp_path / "a.csv")
    assert said in str(caught.value)


def test_a_million_columns_and_a_row_without_end_are_refused(tmp_path: Path) -> None:
    (tmp_path / "a.csv").write_text(",".join(["1"] * 1_000_000))
    with pytest.raises(InputError, match="1000000 columns"):
        read_recording(tmp_path / "a.csv")
    with pytest.raises(InputError, match="no header at the beginning"):
        find_table(iter(["\n" * 20_000]), Layout(), "a.csv")


def test_deep_and_long_mappings_are_refused(tmp_path: Path) -> None:
    long = ("a." * 50_000 + "a = 1", "[" * 100_000, "a = [\n" * 20_000, "#" * 2_000_000, "a = " + "9" * 6900)
    for text in long:
        (tmp_path / "map.toml").write_text(text)
        with pytest.raises(InputError) as caught:
            read_recording(tmp_path / "a.mat", tmp_path / "map.toml")
        assert "map.toml" in caught.value.where and len(str(caught.value)) < 400


def test_names_from_a_file_reach_no_terminal(tmp_path: Path) -> None:
    name = "\x1b[31m\u202e.csv"
    (tmp_path / name).write_text(table(300))
    assert read_recording(tmp_path / name).name == "\\x1b[31m\\u202e.csv"
    (tmp_path / "a.csv").write_text(table(300).replace("motor_torque", "\u2066torque" + "x" * 300_000))
    with pytest.raises(InputError) as caught:
        read_recording(tmp_path / "a.csv")
    assert "\u2066" not in str(caught.value) and len(str(caught.value)) < 400


def test_the_checksum_is_of_the_whole_file(tmp_path: Path) -> None:
    (tmp_path / "a.csv").write_text(table(300))
    file = TextFile(tmp_path / "a.csv")
    text = "".join(file.blocks())
    assert text == table(300)
