"""Text tables as people and table programs write them: units below the names, empty columns behind, dates, words."""

from __future__ import annotations

import math
from pathlib import Path

import numpy as np
import pytest

from feeddrive.errors import InputError
from feeddrive.metrology.measured.forms import circle_test, linear_test
from feeddrive.metrology.measured.readings import read_readings
from feeddrive.recording import read_recording
from feeddrive.typing import FloatArray
from tests.analytic.trace_files import current, motion

TIME: FloatArray = np.arange(600) * 1e-3
PLACE, TORQUE = motion(TIME)[0], 1.25 * current(TIME)
DEVIATIONS = ((0.0, 1.5, -2.25), (1.0, 2.5, -1.25), (0.5, 1.75, -2.0))  # µm at a target, up, down, up
WORDS = [("1", "-1"), ("+", "-"), ("up", "down"), ("forward", "reverse"), ("↑", "↓"), ("avanti", "indietro")]


def written(tmp_path: Path, head: list[str], time: list[str], behind: str = "") -> Path:
    path = tmp_path / "a.csv"
    rows = [f"{stamp},{x!r},{m!r}{behind}" for stamp, x, m in zip(time, PLACE.tolist(), TORQUE.tolist(), strict=True)]
    path.write_text("\n".join([*(line + behind for line in head), *rows]) + "\n", encoding="utf-8")
    return path


def test_units_in_a_row_of_their_own(tmp_path: Path) -> None:
    head = ["time,table_position,motor_torque", "ms,mm,Nm"]
    recording = read_recording(written(tmp_path, head, [f"{1e3 * t:.0f}" for t in TIME]))
    assert np.array_equal(recording.channels["table_position"], PLACE / 1e3)
    assert np.allclose(recording.time, TIME, rtol=0.0, atol=1e-15)


def test_empty_columns_behind(tmp_path: Path) -> None:
    head = ["time [s],table_position [mm],motor_torque [Nm]"]
    recording = read_recording(written(tmp_path, head, [repr(t) for t in TIME.tolist()], ",,,"))
    assert set(recording.channels) == {"table_position", "motor_torque"}
    assert np.array_equal(recording.channels["motor_torque"], TORQUE)
    path = written(tmp_path, head, [repr(t) for t in TIME.tolist()], ",,")
    path.write_text(path.read_text().replace(f",{float(TORQUE[3])!r},,", ",,,"))
    with pytest.raises(InputError, match=r"row 5, column \"motor_torque \[Nm\]\": the cell is empty"):
        read_recording(path)


@pytest.mark.parametrize(
    "day", ["2026-01-31 23:59:{:09.6f}", "2026-01-31T23:59:{:09.6f}Z", "31.01.2026 23:59:{:09.6f}", "23:59:{:09.6f}"]
)
def test_dates_as_time(tmp_path: Path, day: str) -> None:
    head = ["time,table_position [mm],motor_torque [Nm]"]
    recording = read_recording(written(tmp_path, head, [day.format(59.0 + t) for t in TIME]))
    assert np.allclose(recording.time, TIME, rtol=0.0, atol=1e-9)
    assert any("dates of the time" in note for note in recording.notes)


def test_date_that_is_none_is_named_with_its_row(tmp_path: Path) -> None:
    stamps = [f"2026-01-31 10:00:{t:09.6f}" for t in TIME]
    stamps[7] = "2026-13-31 10:00:00.007"
    with pytest.raises(InputError, match=r"row 9.*2026-13-31.*is not a date"):
        read_recording(written(tmp_path, ["time,table_position [mm],motor_torque [Nm]"], stamps))


@pytest.mark.parametrize(("up", "down"), WORDS)
def test_directions_in_words(tmp_path: Path, up: str, down: str) -> None:
    rows = [f"{100 * i},{side},{value}" for values in (DEVIATIONS, DEVIATIONS) for i, (a, b, _) in enumerate(values)
            for side, value in ((up, a), (down, b))]  # fmt: skip
    path = tmp_path / "laser.csv"
    path.write_text("\n".join(["target [mm],direction,deviation [µm]", *rows]) + "\n", encoding="utf-8")
    test = linear_test(read_readings(path))
    assert test.up is not None and test.down is not None
    assert np.allclose(test.up[:, 0], [1e-6 * one[0] for one in DEVIATIONS], rtol=1e-12, atol=0.0)
    assert np.allclose(test.down[:, 1], [1e-6 * one[1] for one in DEVIATIONS], rtol=1e-12, atol=0.0)


def test_direction_that_is_no_word(tmp_path: Path) -> None:
    path = tmp_path / "laser.csv"
    path.write_text("target [mm],direction,deviation [µm]\n0,left,1\n", encoding="utf-8")
    with pytest.raises(InputError, match=r'row 2, column "direction": "left" is no direction; write 1 or up'):
        read_readings(path)


def ball_bar(path: Path, turns: float, begin: float, sides: tuple[int, ...], turned: bool = False) -> Path:
    lines = ["# radius = 150 mm", "angle [deg],radial [µm],direction"]
    for side in sides:
        angle = begin + side * 360.0 * np.linspace(0.0, turns, round(720 * turns) + 1)
        radial = 4.0 * np.cos(2.0 * np.radians(angle)) + 0.5 * np.cos(3.0 * np.radians(angle)) + 3.0 * (side < 0)
        rows = list(zip(angle.tolist(), radial.tolist(), strict=True))
        lines += [f"{a!r},{r!r},{side}" for a, r in (rows[::-1] if turned and side < 0 else rows)]
    path.write_text("\n".join(lines) + "\n", encoding="utf-8")
    return path


@pytest.mark.parametrize("begin", [0.3, 37.1, -91.7])
@pytest.mark.parametrize("side", [1, -1])
def test_overshoot_of_a_ball_bar_is_no_part_of_the_circle(tmp_path: Path, begin: float, side: int) -> None:
    """Half a turn more, a quarter before and one behind, weighs nothing: the same figures as the turn between them."""
    over = circle_test(read_readings(ball_bar(tmp_path / "a.csv", 1.5, begin, (side,))), None).circles[0]
    middle = begin + side * 90.0
    whole = circle_test(read_readings(ball_bar(tmp_path / "b.csv", 1.0, middle, (side,))), None).circles[0]
    assert over.direction == whole.direction == side
    assert math.isclose(over.deviation, whole.deviation, rel_tol=1e-9)
    assert np.allclose(over.glitches, whole.glitches, rtol=0.0, atol=1e-15)


def test_rows_that_turn_against_their_direction_are_refused(tmp_path: Path) -> None:
    with pytest.raises(InputError, match="the rows of direction -1 turn the other way"):
        circle_test(read_readings(ball_bar(tmp_path / "a.csv", 1.0, 0.0, (1, -1), turned=True)), None)


def test_lines_of_text_above_the_headings_are_told(tmp_path: Path) -> None:
    path = tmp_path / "a.csv"
    path.write_text("Logger 3 of hall 2\ntime [s],table_position [mm]\n0,1\n", encoding="utf-8")
    with pytest.raises(InputError, match=r'"Logger 3 of hall 2" is no row of headings; put # before'):
        read_recording(path)
