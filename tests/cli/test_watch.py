"""`feeddrive watch` as a person types it."""

from __future__ import annotations

import json
from pathlib import Path

import pytest

from feeddrive.cli.main import main
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
    assert "Nothing changed in 3 recordings." in shown and "stiffness" in shown and "trend.html" in shown
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


@pytest.mark.parametrize(
    ("words", "said"),
    [
        (["--limit", "play"], "is no limit"),
        (["--limit", "gap=1 µm"], 'no quantity "gap"'),
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
