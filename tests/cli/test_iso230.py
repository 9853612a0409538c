"""`feeddrive iso230` as a person types it."""

from __future__ import annotations

import json
from pathlib import Path

import pytest

from feeddrive.cli.main import main

LASER = "target [mm],up 1 [µm],down 1 [µm],up 2 [µm],down 2 [µm]\n0,0,-2,0.2,-2.2\n100,1,-1,1.2,-1.2\n"


@pytest.fixture
def laser(tmp_path: Path) -> Path:
    path = tmp_path / "laser.csv"
    path.write_text(LASER, encoding="utf-8")
    return path


def test_table_and_files(laser: Path, tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    out = tmp_path / "out"
    assert main(["iso230", str(laser), "--out", str(out)]) == 0
    shown = capsys.readouterr().out
    for word in ("ISO 230-2:2014", "mean B", "2.2 µm", "A↑", "written:"):
        assert word in " ".join(shown.split()), word
    assert {path.name for path in out.iterdir()} == {"report.html", "iso230.json", "positioning.png"}


def test_fewer_readings_than_the_standard_asks_for_are_said(
    laser: Path, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    assert main(["iso230", str(laser), "--json"]) == 0
    few = json.loads(capsys.readouterr().out)["fewer_than_asked"]
    assert few == [["targets", "2", "5"], ["approaches of each from one side", "2", "5"]]
    heads = ",".join(f"up {i} [µm],down {i} [µm]" for i in range(1, 6))
    rows = "\n".join(f"{100 * k}," + ",".join(f"{k + 0.1 * i},{k - 2 - 0.1 * i}" for i in range(5)) for k in range(5))
    full = tmp_path / "full.csv"
    full.write_text(f"target [mm],{heads}\n{rows}\n", encoding="utf-8")
    assert main(["iso230", str(full)]) == 0
    assert "Fewer than" not in capsys.readouterr().out


def test_json_is_what_the_file_says(laser: Path, tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    out = tmp_path / "out"
    assert main(["iso230", str(laser), "--json", "--out", str(out)]) == 0
    content = json.loads(capsys.readouterr().out)
    assert content == json.loads((out / "iso230.json").read_text(encoding="utf-8"))
    assert content["figures"]["B"] == {"value": pytest.approx(2.2e-6, rel=1e-12), "unit": "m"}
    assert content["targets"][1]["B [m]"] == pytest.approx(2.2e-6, rel=1e-12)


def test_plant_is_compared(laser: Path, capsys: pytest.CaptureFixture[str]) -> None:
    assert main(["iso230", str(laser), "--plant", "bench_axis"]) == 0
    assert "left without guide_friction" in " ".join(capsys.readouterr().out.split())


@pytest.mark.parametrize(
    ("words", "said"),
    [
        (["--part", "5"], "no part 5"),
        (["--part", "4"], 'no column "angle"'),
        (["--radius", "-1 mm", "--part", "4"], "radius"),
        (["--plant", "no_such_machine"], "no_such_machine"),
    ],
)
def test_what_cannot_be_is_one_line(
    laser: Path, tmp_path: Path, capsys: pytest.CaptureFixture[str], words: list[str], said: str
) -> None:
    out = tmp_path / "out"
    assert main(["iso230", str(laser), *words, "--out", str(out)]) == 2
    told = capsys.readouterr()
    assert told.err.startswith("error: ") and told.err.count("\n") == 1 and said in told.err
    assert not out.exists()
