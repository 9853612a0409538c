"""`feeddrive watch` as a person types it."""

from __future__ import annotations

import json
import warnings
from pathlib import Path

import numpy as np
import pytest

import feeddrive as fd
from feeddrive.cli.main import main
from feeddrive.trend.watched_quantities import Quantity, _is_some
from tests.recovery import trend_machine as machine
from tests.recovery.trend_files import write_recording


@pytest.fixture
def folder(tmp_path: Path) -> Path:
    """Three recordings of three days, and the plant beside them."""
    (tmp_path / "plant.toml").write_text(machine.PLANT, encoding="utf-8")
    place = tmp_path / "days"
    place.mkdir()
    for number in (1, 2, 3):
        recording = machine.recording(machine.State(seed=number, start=0.4 * number), seconds=4.0)
        write_recording(place / f"x_2026-01-0{number}.csv", recording)
    return place


def test_page_table_and_json(folder: Path, capsys: pytest.CaptureFixture[str]) -> None:
    plant = str(folder.parent / "plant.toml")
    assert main(["watch", str(folder), "--plant", plant]) == 0
    shown = " ".join(capsys.readouterr().out.split())
    assert "3 recordings are too few to tell a change, which takes 8." in shown and "Nothing changed" not in shown
    assert "stiffness" in shown and "trend.html" in shown and "too few to tell" in shown and "steady" not in shown
    out = folder.parent / "days_watch"
    assert {"trend.html", "trend.json", "trend.csv", "watch.npz", "trend_1.png"} <= {
        path.name for path in out.iterdir()
    }
    rows = (out / "trend.csv").read_text(encoding="utf-8").splitlines()
    assert rows[0].startswith("date,day [d],file,slope [m/m],play [m]") and len(rows) == 4
    assert main(["watch", str(folder), "--plant", plant, "--json"]) == 0
    content = json.loads(capsys.readouterr().out)
    assert content["format"] == "feeddrive-watch/1" and content["seconds"]["new_files"] == 0
    assert [one["file"] for one in content["recordings"]] == [f"x_2026-01-0{k}.csv" for k in (1, 2, 3)]
    play = next(one for one in content["quantities"] if one["name"] == "play")
    assert len(play["values"]) == 3 and play["unit"] == "m"


def test_of_few_recordings_what_was_measured_is_shown(folder: Path) -> None:
    """No course is told from three: their mean would be a value that no day has."""
    watched = fd.watch(folder, fd.load(folder.parent / "plant.toml"))
    stiffness = next(one for one in watched.trend.quantities if one.name == "stiffness")
    shown = next(row for row in watched.listing().rows if row[0] == stiffness.words)
    first, last = (f"{1e-6 * value:.4g} N/µm" for value in stiffness.values[[0, -1]])
    assert shown[1:5] == [first, last, "", "too few to tell"]


@pytest.mark.parametrize(("scenario", "shows"), [("friction_map", True), ("slow_reversal", False)])
def test_a_motion_shows_what_it_can_and_nothing_else(
    tmp_path: Path, capsys: pytest.CaptureFixture[str], scenario: str, shows: bool
) -> None:
    """An end of the stroke that hardly a row reaches told of -5969 N, and a stroke of 2 mm of a mass of -1661 kg."""
    folder = tmp_path / "runs"
    folder.mkdir()
    for number in (1, 2, 3):
        noise = {"table_position": "15 nm", "motor_torque": "0.02 N m"}
        changed = {f"record.noise.{channel}": size for channel, size in noise.items()} | {"record.seed": number}
        fd.run(scenario, plant="bench_axis", set=changed).save(folder / f"x_2026-01-0{number}.csv")
    assert main(["watch", str(folder), "--plant", "bench_axis", "--json"]) == 0
    found = {one["name"]: one["values"] for one in json.loads(capsys.readouterr().out)["quantities"]}
    assert np.allclose(found["force"], 0.0, atol=5.0)  # of a Coulomb level of 180 N; none is declared
    assert ("mass" in found) == shows and ("stiffness" in found) == shows and "torque_ripple" not in found
    if shows:  # the declared machine, to a tenth: friction rounded by tanh and a power law is no line of the speed
        assert np.allclose(found["coulomb"], 180.0, rtol=0.1)
        assert np.allclose(found["stiffness"], 202.8e6, rtol=0.01)


@pytest.mark.parametrize(
    ("words", "said"),
    [
        (["--limit", "play"], "is no limit"),
        (["--limit", "gap=1 µm"], 'no quantity "gap"'),
        (["--limit", "play=2"], "limit play"),
        (["--limit", "play=-1 µm"], "allows nothing"),
        (["--stamp", "%H%M%S"], "names no day"),
        (["--stamp", "%d.%m.%Y"], "no recording can be used"),
        (["--absolute", "nut_temperature"], "has no zero to keep"),
    ],
)
def test_what_cannot_be_is_one_line(
    folder: Path, capsys: pytest.CaptureFixture[str], words: list[str], said: str
) -> None:
    assert main(["watch", str(folder), "--plant", str(folder.parent / "plant.toml"), *words]) == 2
    told = capsys.readouterr()
    assert told.err.startswith("error: ") and told.err.count("\n") == 1 and said in told.err


@pytest.fixture
def fleet(folder: Path) -> Path:
    """Three axes in a folder of folders: one as it was, one whose plant is its own, one without a usable recording."""
    place = folder.parent / "axes"
    for name, numbers in (("X1", (1, 2)), ("Y1", (3, 4))):
        (place / name).mkdir(parents=True)
        for number in numbers:
            recording = machine.recording(machine.State(seed=number, start=0.4 * number), seconds=4.0)
            write_recording(place / name / f"{name}_2026-01-0{number}.csv", recording)
    (place / "Y1" / "plant.toml").write_text(machine.PLANT.replace('"120.0 kg"', '"125 kg"'), encoding="utf-8")
    (place / "Z1").mkdir()
    (place / "Z1" / "z_2026-01-01.csv").write_text("time [s],table_position [m]\n0,spindle\n", encoding="utf-8")
    return place


def test_axes_of_a_folder_each_by_itself(fleet: Path, capsys: pytest.CaptureFixture[str]) -> None:
    plant = str(fleet.parent / "plant.toml")
    assert main(["watch", str(fleet), "--plant", plant, "--each", "--json"]) == 0
    axes = {one["axis"]: one for one in json.loads(capsys.readouterr().out)["axes"]}
    assert list(axes) == ["Z1", "X1", "Y1"]  # what needs a person first
    assert axes["X1"]["recordings"] == 2 and axes["X1"]["newest"] == "2026-01-02T00:00:00"
    assert not axes["Z1"]["usable"] and "no recording can be used" in axes["Z1"]["verdict"]
    alone = fleet.parent / "alone"
    assert main(["watch", str(fleet / "X1"), "--plant", plant, "--out", str(alone)]) == 0
    _same(alone, fleet.parent / "axes_watch" / "X1")
    capsys.readouterr()
    assert main(["watch", str(fleet), "--plant", plant, "--each"]) == 0
    shown = " ".join(capsys.readouterr().out.split())
    assert "3 axes, 0 changed" in shown and "trend.html in the folder of each axis" in shown


def _same(one: Path, other: Path) -> None:
    """The results of two runs but for the time that they took."""
    assert (one / "trend.csv").read_bytes() == (other / "trend.csv").read_bytes()
    contents = [json.loads((place / "trend.json").read_text(encoding="utf-8")) for place in (one, other)]
    for content in contents:
        del content["seconds"]
    assert contents[0] == contents[1]


def test_a_dask_cluster_gives_the_same_numbers(fleet: Path) -> None:
    distributed = pytest.importorskip("distributed", reason="Dask is not installed: pip install 'feeddrive[dask]'")
    plant = str(fleet.parent / "plant.toml")
    assert main(["watch", str(fleet), "--plant", plant, "--each", "--out", str(fleet.parent / "here")]) == 0
    with (
        warnings.catch_warnings(action="ignore"),  # Dask's own
        distributed.LocalCluster(n_workers=1, threads_per_worker=1, dashboard_address=None) as cluster,
    ):
        there = ["--scheduler", cluster.scheduler_address, "--out", str(fleet.parent / "there")]
        assert main(["watch", str(fleet), "--plant", plant, "--each", *there]) == 0
    for name in ("X1", "Y1"):
        _same(fleet.parent / "here" / name, fleet.parent / "there" / name)


@pytest.mark.parametrize(
    ("words", "said"),
    [
        (["--scheduler", "tcp://127.0.0.1:8786"], "say --each"),
        (["--each", "--scheduler", "here"], "is not an address"),
        (["--each"], "there is no folder in it"),
    ],
)
def test_what_cannot_be_of_a_fleet(
    folder: Path, capsys: pytest.CaptureFixture[str], words: list[str], said: str
) -> None:
    place = folder
    if "--scheduler" in words and "--each" in words:
        (folder / "X1").mkdir()
    assert main(["watch", str(place), "--plant", str(folder.parent / "plant.toml"), *words]) == 2
    assert said in capsys.readouterr().err


@pytest.mark.parametrize(
    ("values", "shown"),
    [
        ([100.0, 130.0, 80.0, 110.0, 90.0], True),  # friction that follows the day
        ([100.0, 101.0, 99.0, 300.0, 301.0], True),  # and one that jumps
        ([5.0, -20.0, 30.0, -4.0, 12.0], False),
        ([-1661.0, -1660.0, -1662.0], False),
        ([100.0], True),
    ],
)
def test_what_no_machine_has_none_of_is_shown_where_it_is_more_than_none(values: list[float], shown: bool) -> None:
    quantity = Quantity("coulomb", "", "N", np.array(values), np.ones(len(values)))
    assert _is_some(quantity) is shown
