"""What lies in a folder: dates, copies, archives, broken and growing files, and the checkpoint."""

from __future__ import annotations

import gzip
import json
import os
import time
import zipfile
from dataclasses import replace
from datetime import datetime
from pathlib import Path
from types import SimpleNamespace

import numpy as np
import pytest

import feeddrive as fd
from feeddrive.trend import change_searches
from feeddrive.trend.checkpoint import load_checkpoint, save_checkpoint
from feeddrive.trend.folder import stamp_of
from feeddrive.trend.watch import Trend
from tests.recovery import trend_machine as machine
from tests.recovery.trend_files import write_recording


@pytest.mark.parametrize(
    ("name", "head", "pattern", "expected"),
    [
        ("axis_2026-01-31.csv", "", "", "2026-01-31 00:00:00"),
        ("axis_20260131_1430.csv", "", "", "2026-01-31 14:30:00"),
        ("X1_20260131T143059.csv", "", "", "2026-01-31 14:30:59"),
        ("run_2026.01.31_14-30.csv", "", "", "2026-01-31 14:30:00"),
        ("a_31_01_26.csv", "", "%d_%m_%y", "2026-01-31 00:00:00"),
        ("a.csv", "# recorded 2026-01-31T14:30:05Z\ntime [s],x\n", "", "2026-01-31 14:30:05"),
        ("a.csv", "Datum;31.01.2026 14:30:05\n", "", "2026-01-31 14:30:05"),
        ("2026-02-01.csv", "Start: 2026-01-31 06:00\n", "", "2026-01-31 06:00:00"),  # content before name
        # 100 ns since 1601: 116444736000000000 is the beginning of 1970
        ("a.csv", "Name\tx\nStarttime of export\t116444736610000000\n", "", "1970-01-01 00:01:01"),
        ("a.csv", "Name:x\nStarttime of export:116444736610000000:Montag\n", "", "1970-01-01 00:01:01"),
        # TNCscope: s since 1970, and the control's own time an hour ahead of UTC
        ("a.sco", "%TNCscopeNT data file\n%TIME=1769869805\n%DIFFTIMEUTC=3600\n%[CURVE1]\n", "", "2026-01-31 15:30:05"),
        # SINUMERIK Operate: behind a long set-up of the display
        (
            "a.xml",
            200 * "<signal/>\n" + '<frameHeader startTime="2026-01-31T14:30:05.613Z"/>',
            "",
            "2026-01-31 14:30:05",
        ),
        ("a.csv", "time,table_position [mm]\n2026-01-31 14:30:05.001,1.5\n", "", "2026-01-31 14:30:05"),
    ],
)
def test_dates(name: str, head: str, pattern: str, expected: str) -> None:
    found = stamp_of(name, head, pattern)
    assert found is not None and str(found[0].replace(microsecond=0)) == expected


@pytest.mark.parametrize("name", ["axis.csv", "order_20261399.csv", "part_123456789012.csv", "v2.31.csv"])
def test_what_is_no_date(name: str) -> None:
    assert stamp_of(name, "time [s],table_position [m]\n0,2026\n", "") is None


def test_pattern_that_a_name_does_not_hold() -> None:
    with pytest.raises(fd.InputError, match="pattern"):
        stamp_of("axis.csv", "", "%Y%m%d")


@pytest.fixture
def axis(tmp_path: Path) -> fd.Axis:
    path = tmp_path / "plant.toml"
    path.write_text(machine.PLANT, encoding="utf-8")
    return fd.load(path)


def day(number: int, **changes: float) -> fd.Recording:
    """A short recording of one day."""
    state = machine.State(seed=number, start=0.37 * number)
    return machine.recording(replace(state, **changes), seconds=4.0)  # type: ignore[arg-type]


def statuses(trend: Trend) -> dict[str, str]:
    return {one.key: one.status for one in trend.entries}


def test_a_folder_as_it_comes(tmp_path: Path, axis: fd.Axis) -> None:
    """Recordings, a copy, one in an archive, a dump in a folder, a broken one, one without a date, and what is none."""
    folder = tmp_path / "recordings"
    (folder / "dump").mkdir(parents=True)
    first = write_recording(folder / "x_2026-01-01.csv", day(1))
    write_recording(folder / "dump" / "x_2026-01-02.csv", day(2))
    inside = write_recording(tmp_path / "x_2026-01-03.csv", day(3))
    with zipfile.ZipFile(folder / "week.zip", "w") as archive:
        archive.write(inside, "control/x_2026-01-03.csv")
        archive.writestr("control/notes.ini", "[a]\n")
    (folder / "x_2026-01-04.csv.gz").write_bytes(gzip.compress(first.read_bytes()))
    (folder / "x_2026-01-05.csv").write_text("time [s],motor_torque [N m]\n0,1\n0.1,spindle\n", encoding="utf-8")
    write_recording(folder / "x.csv", day(6))
    (folder / "y_2026-01-07.csv.part").write_text("time", encoding="utf-8")
    (folder / "photo.png").write_bytes(b"\x89PNG")
    (folder / "torn.zip").write_bytes(b"PK\x03\x04 and no more")
    os.utime(folder / "x_2026-01-05.csv", (time.time() - 600, time.time() - 600))
    found = fd.watch(folder, axis)
    assert statuses(found.trend) == {
        "x_2026-01-01.csv": "used", "dump/x_2026-01-02.csv": "used", "week.zip!control/x_2026-01-03.csv": "used",
        "x_2026-01-04.csv.gz": "copy", "x_2026-01-05.csv": "broken", "x.csv": "undated",
        "y_2026-01-07.csv.part": "waiting",
    }  # fmt: skip
    assert [str(found.trend.when(one)) for one in found.trend.days] == [f"2026-01-0{k} 00:00:00" for k in (1, 2, 3)]
    assert any("torn.zip" in note for note in found.trend.notes)
    told = {one.key: one.reason for one in found.trend.entries}
    assert "spindle" in told["x_2026-01-05.csv"] and "--stamp" in told["x.csv"]


def test_only_what_is_new_is_read(tmp_path: Path, axis: fd.Axis, monkeypatch: pytest.MonkeyPatch) -> None:
    folder = tmp_path / "recordings"
    folder.mkdir()
    for number in (1, 2, 3):
        write_recording(folder / f"x_2026-01-0{number}.csv", day(number))
    before = fd.watch(folder, axis)
    assert before.trend.fresh == 3
    write_recording(folder / "x_2026-01-04.csv", day(4))
    seen: list[str] = []
    again = fd.watch(folder, axis, progress=seen.append)
    assert again.trend.fresh == 1 and len(again.trend.used) == 4
    assert [text for text in seen if text.startswith("reading")] == ["reading 1 of 1: x_2026-01-04.csv"]
    # the same numbers as from a fresh start
    fresh = fd.watch(folder, axis, out=tmp_path / "elsewhere")
    for one, other in zip(again.trend.quantities, fresh.trend.quantities, strict=True):
        np.testing.assert_array_equal(one.values, other.values)


def test_a_file_that_grows_is_read_again(tmp_path: Path, axis: fd.Axis) -> None:
    folder = tmp_path / "recordings"
    folder.mkdir()
    whole = write_recording(folder / "x_2026-01-01.csv", day(1)).read_text(encoding="utf-8")
    growing = folder / "x_2026-01-02.csv"
    write_recording(growing, day(2))
    text = growing.read_text(encoding="utf-8")
    growing.write_text(text[: len(text) // 2 + 7].rsplit(",", 1)[0], encoding="utf-8")  # a row is cut in its middle
    found = fd.watch(folder, axis)
    assert statuses(found.trend)["x_2026-01-02.csv"] == "waiting"
    growing.write_text(text, encoding="utf-8")
    assert statuses(fd.watch(folder, axis).trend) == {"x_2026-01-01.csv": "used", "x_2026-01-02.csv": "used"}
    assert whole


def test_another_plant_and_a_damaged_checkpoint_start_anew(tmp_path: Path, axis: fd.Axis) -> None:
    folder = tmp_path / "recordings"
    folder.mkdir()
    write_recording(folder / "x_2026-01-01.csv", day(1))
    fd.watch(folder, axis)
    other = tmp_path / "other.toml"
    other.write_text(machine.PLANT.replace('"120.0 kg"', '"130 kg"'), encoding="utf-8")
    found = fd.watch(folder, fd.load(other))
    assert found.trend.fresh == 1 and any("plant or the options changed" in note for note in found.trend.notes)
    kept = tmp_path / "recordings_watch" / "watch.npz"
    kept.write_bytes(kept.read_bytes()[:500])
    found = fd.watch(folder, axis)
    assert found.trend.fresh == 1 and any("damaged" in note for note in found.trend.notes)


def test_checkpoint_comes_back_as_it_was(tmp_path: Path, axis: fd.Axis) -> None:
    folder = tmp_path / "recordings"
    folder.mkdir()
    write_recording(folder / "x_2026-01-01.csv", day(1))
    fd.watch(folder, axis)
    place = tmp_path / "recordings_watch"
    with np.load(place / "watch.npz") as held:
        identity = json.loads(bytes(held["index"]).decode())["plant"]
    kept, remark = load_checkpoint(place, identity)
    assert remark == ""
    save_checkpoint(tmp_path, kept)
    again, _ = load_checkpoint(tmp_path, identity)
    for key, entry in kept.entries.items():
        other = again.entries[key]
        assert replace(entry, passes=()) == replace(other, passes=())
        for one, two in zip(entry.passes, other.passes, strict=True):
            np.testing.assert_array_equal(one.triangle, two.triangle)
            np.testing.assert_array_equal(one.declared, two.declared)


def test_a_distance_in_place_of_dates(tmp_path: Path, axis: fd.Axis) -> None:
    folder = tmp_path / "recordings"
    folder.mkdir()
    for number in range(3):
        write_recording(folder / f"run{number}.csv", day(number))
    found = fd.watch(folder, axis, every="12 h", first="2026-05-01 06:00")
    assert found.trend.begin == datetime(2026, 5, 1, 6) and list(found.trend.days) == [0.0, 0.5, 1.0]


@pytest.mark.parametrize(
    ("options", "said"),
    [
        ({"absolute": "motor_torque"}, "has no zero to keep"),
        ({"every": "0 s"}, "not above zero"),
        ({"every": "1 day", "first": "31 January"}, "is no date"),
        ({"limits": {"backlash": "10 µm"}}, 'no quantity "backlash"'),
        ({"limits": {"play": "-1 µm"}}, "allows nothing"),
        ({"limits": {"play": "10"}}, "bare number"),
    ],
)
def test_options_that_are_none(tmp_path: Path, axis: fd.Axis, options: dict[str, object], said: str) -> None:
    folder = tmp_path / "recordings"
    folder.mkdir()
    for number in range(4):
        write_recording(folder / f"x_2026-01-0{number + 1}.csv", day(number))
    with pytest.raises(fd.InputError, match=said):
        fd.watch(folder, axis, **options)


def test_nothing_to_follow(tmp_path: Path, axis: fd.Axis) -> None:
    with pytest.raises(fd.InputError, match="no such folder"):
        fd.watch(tmp_path / "nowhere", axis)
    (tmp_path / "empty").mkdir()
    with pytest.raises(fd.InputError, match=r"no recording can be used \(the folder holds no file of one\); add"):
        fd.watch(tmp_path / "empty", axis)
    (tmp_path / "empty" / "broken.csv").write_text("what is this", encoding="utf-8")
    with pytest.raises(fd.InputError, match="no recording can be used"):
        fd.watch(tmp_path / "empty", axis, out=tmp_path / "out")
    assert not (tmp_path / "out").exists()  # neither a result nor what it knows
    (tmp_path / "file").write_text("", encoding="utf-8")
    with pytest.raises(fd.InputError, match="is a file, not a folder"):
        fd.watch(tmp_path / "empty", axis, out=tmp_path / "file")


@pytest.mark.parametrize(
    ("effect", "said"),
    [
        ("backlash", "Full search: play is larger."),
        ("payload", "are too little to tell backlash; they would say payload is larger, which all recordings"),
        ("", "(4 s and 4 s) are too little to tell backlash; what is said above rests on all recordings."),
    ],
)
def test_search_of_two_recordings_does_not_contradict_all_of_them(
    effect: str, said: str, tmp_path: Path, axis: fd.Axis, monkeypatch: pytest.MonkeyPatch
) -> None:
    """The full search sees the two beside the change; it is asked once."""
    asked = []

    def found(plant: object, recordings: list[fd.Recording]) -> tuple[object, tuple[()]]:
        asked.append([one.name for one in recordings])
        words = "play is larger" if effect == "backlash" else f"{effect} is larger"
        changes = [SimpleNamespace(effect=effect, statement=words)] if effect else []
        return SimpleNamespace(changes=SimpleNamespace(changes=changes), effects=()), ()

    monkeypatch.setattr(change_searches, "diagnose", found)
    folder = tmp_path / "days"
    folder.mkdir()
    for number in range(1, 13):
        write_recording(folder / f"x_2026-01-{number:02d}.csv", day(number, play=1e-6 + 4e-6 * (number > 7)))
    watched = fd.watch(folder, axis, search=True)
    assert "play jumps by +4" in watched.verdict and said in watched.verdict
    assert fd.watch(folder, axis, search=True).verdict == watched.verdict
    assert asked == [["x_2026-01-07.csv", "x_2026-01-09.csv"]]


def test_a_file_of_another_axis_is_not_mixed_in(tmp_path: Path, axis: fd.Axis) -> None:
    """Of the same form, but with another lead: it is listed with both leads and moves no value."""
    folder = tmp_path / "days"
    folder.mkdir()
    for number in range(3):
        write_recording(folder / f"x_2026-01-{number + 1:02d}.csv", day(number))
    other = day(7)
    halved = other.channels | {"motor_angle": 2.0 * other.channels["motor_angle"]}
    write_recording(folder / "y_2026-01-02.csv", replace(other, channels=halved))
    found = fd.watch(folder, axis).trend
    assert statuses(found)["y_2026-01-02.csv"] == "broken"
    assert len(found.used) == 3
    (entry,) = [one for one in found.entries if one.key == "y_2026-01-02.csv"]
    assert "moves 5 mm per revolution" in entry.reason and "lead is 10 mm" in entry.reason
