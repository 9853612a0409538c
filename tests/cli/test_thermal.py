"""`feeddrive thermal` as a user types it."""

from __future__ import annotations

import json
from pathlib import Path

import pytest

from feeddrive.cli.main import main
from feeddrive.files import find_plant
from feeddrive.recording.files.reading import read_recording
from tests.analytic.thermal_cases import BENCH_FILE

BENCH = str(BENCH_FILE)


def test_warm_up_is_told_written_and_read_back(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    asked = ["thermal", BENCH, "--speed", "750 rev/min", "--duration", "3 h", "--out", str(tmp_path)]
    assert main(asked) == 0
    told = capsys.readouterr().out
    for expected in ("750 rev/min constant", "within 1 µm after", "W/K", "does not close by", "reduced", "28.09 min",
                     "end of the screw"):  # fmt: skip
        assert expected in told
    assert "nut at end" not in told  # which no nut reaches
    content = json.loads((tmp_path / "thermal.json").read_text(encoding="utf-8"))
    assert content["format"] == "feeddrive-thermal/1"
    assert content["energy"]["imbalance"] < 1e-9
    assert content["models"]["reduced"] < content["models"]["full"] / 20
    # The order that is the default keeps within 2 mK and 5 nm over the whole range.
    assert content["models"]["largest_error"]["nut_temperature"] < 2e-3
    assert content["models"]["largest_error"]["table_growth_300mm"] < 5e-9
    again = read_recording(tmp_path / "recording.csv")
    assert again["nut_temperature"][-1] == pytest.approx(content["series"]["nut_temperature"][-1], abs=1e-3)
    for figure in ("thermal_warm_up.png", "thermal_field.png"):
        assert (tmp_path / figure).read_bytes().startswith(b"\x89PNG")


def test_duty_file_and_json(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    duty = tmp_path / "duty.csv"
    rows = [f"{60 * i},{500 if i < 60 else 0},{23 + i / 120}" for i in range(1, 121)]
    duty.write_text("\n".join(["time [s],screw_speed [rev/min],ambient_temperature [degC]", *rows]), encoding="utf-8")
    assert main(["thermal", BENCH, "--duty", str(duty), "--json", "--stroke", "150 mm to 350 mm"]) == 0
    content = json.loads(capsys.readouterr().out)
    assert content["travel"] == [0.15, 0.35]
    nut = content["series"]["nut_temperature"]
    # Heated for an hour, at rest for another.
    assert nut[59] > nut[0] + 3
    assert nut[-1] < nut[59]
    assert content["energy"]["imbalance"] < 1e-9


@pytest.mark.parametrize(
    ("options", "told"),
    [
        (["--stroke", "600 mm"], "longer than the 400 mm"),
        (["--stroke", "400 mm to 480 mm"], "leaves the shaft"),
        (["--stroke", "1 mm to 2 mm to 3 mm"], "is no stroke"),
        (["--stroke", "-10 mm"], "is no stroke"),
        (["--speed", "750"], "bare number"),
        (["--speed", "0 rev/min"], "heats nothing"),
        (["--duration", "-3 h"], "is no duration"),
        (["--duration", "1e9 h"], "too long"),
        (["--within", "0 µm"], "is no error"),
        (["--duty", "none.csv"], "no such file"),
        (["--duty", "none.csv", "--speed", "1 rev/min"], "leave them out"),
    ],
)
def test_bad_input_is_one_line(options: list[str], told: str, capsys: pytest.CaptureFixture[str]) -> None:
    assert main(["thermal", BENCH, *options]) == 2
    written = capsys.readouterr().err
    assert told in written
    assert written.count("\n") == 1


def test_plant_without_heat_or_with_negative_conductance(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    assert main(["thermal", str(find_plant("bench_axis"))]) == 2
    assert "declares no heat" in capsys.readouterr().err
    bad = tmp_path / "bad.toml"
    text = BENCH_FILE.read_text(encoding="utf-8")
    bad.write_text(text.replace('contact_conductance = "1250', 'contact_conductance = "-1250'), encoding="utf-8")
    assert main(["thermal", str(bad)]) == 2
    assert "-1250 W/(m² K) is not possible" in capsys.readouterr().err


def test_speed_beyond_the_range_is_said(capsys: pytest.CaptureFixture[str]) -> None:
    assert main(["thermal", BENCH, "--speed", "5000 rev/min", "--duration", "10 min"]) == 0
    told = capsys.readouterr().err
    assert "above the highest speed declared" in told
    assert "for which the reduced model was made" in told
