"""`feeddrive diagnose` on temperatures and growth, as a user types it: files of the contract, bad input in a line."""

from __future__ import annotations

import csv
import json
import math
from pathlib import Path

import numpy as np
import pytest

from feeddrive.cli.main import main
from feeddrive.diagnosis.heat.heat_evidence import prepare_heat
from feeddrive.diagnosis.heat.heat_prediction import heat_predictor
from feeddrive.diagnosis.ledger.ledger import earlier_run
from feeddrive.files import plants_folder
from feeddrive.plant.file.plant_file import read_plant
from feeddrive.recording import read_recording
from feeddrive.thermal.run.warm_up import simulate

BENCH = plants_folder() / "thermal_bench.toml"
RPM = math.pi / 30
CHANNELS = (
    "nut_temperature", "front_bearing_temperature", "table_growth_200mm", "table_growth_250mm", "table_growth_300mm",
)  # fmt: skip
BETA = 0.02

# Short runs: the command, its files and its words are tested here, the findings in tests/recovery.
RUNS = {"train": ((750, 90), (0, 40)), "validate": ((500, 70), (0, 30)), "later": ((600, 80), (0, 40))}


def _write(path: Path, part: str, channels: tuple[str, ...] = CHANNELS, drop: str = "", rename: str = "") -> Path:
    """A recording with preload growth, simulated by the full model, noise added."""
    schedule = RUNS[part]
    speeds = np.repeat([float(rpm) for rpm, _ in schedule], [count for _, count in schedule])
    plant = read_plant(BENCH)
    grown = plant.with_effects(_preload_growth()).heat
    run = simulate(grown, heat_predictor(plant).model, 30.0, speeds * RPM, np.full(len(speeds), 23.0))
    generator = np.random.default_rng(len(part))
    columns = {"time [s]": 30.0 * np.arange(1, len(speeds) + 1), "screw_speed [rev/min]": speeds}
    columns["ambient_temperature [degC]"] = np.full(len(speeds), 23.0)
    for name in channels:
        growth = name.startswith("table_growth")
        noisy = run[name] * (1e6 if growth else 1.0) + (0.15 if growth else 0.03) * generator.normal(size=len(speeds))
        columns[f"{name if name != drop else rename} [{'um' if growth else 'degC'}]"] = np.round(noisy, 2)
    kept = {name: values for name, values in columns.items() if rename or not drop or not name.startswith(drop)}
    np.savetxt(path, np.column_stack(list(kept.values())), "%g", ",", header=",".join(kept), comments="")
    return path


def _preload_growth():
    from feeddrive.effects.catalogue import THERMAL_EFFECTS

    return THERMAL_EFFECTS["preload_growth"].of(coefficient=BETA)


@pytest.fixture(scope="module")
def folder(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """The files of one run of the command."""
    folder = tmp_path_factory.mktemp("heat")
    train, validate, _ = (str(_write(folder / f"{part}.csv", part)) for part in RUNS)
    assert main(["diagnose", "thermal_bench", train, "--validate", validate, "--out", str(folder / "out")]) == 0
    return folder


def test_contract_files_say_what_was_planted(folder: Path) -> None:
    record = json.loads((folder / "out" / "diagnosis.json").read_text(encoding="utf-8"))
    assert record["format"] == "feeddrive-diagnosis/1"
    assert [effect["name"] for effect in record["effects"]] == ["preload_growth"]
    found = record["effects"][0]["parameters"]["coefficient"]
    assert found["unit"] == "1/K"
    assert found["value"] == pytest.approx(BETA, rel=0.15)  # what is asked of a parameter
    assert {channel["name"] for channel in record["channels"]} == set(CHANNELS)
    for channel in record["channels"]:
        assert channel["band_hz"] == [0.0, pytest.approx(1 / 60)]
        assert channel["after"]["rms"] < channel["before"]["rms"]
    tried = {entry["name"] for entry in record["refused"]}
    assert {"motor_heat", "convection_deviation", "sensor_lag"} <= tried


def test_relative_is_rms_over_rms_of_the_measured(folder: Path) -> None:
    record = json.loads((folder / "out" / "diagnosis.json").read_text(encoding="utf-8"))
    with (folder / "out" / "prediction.csv").open(encoding="utf-8") as file:
        rows = list(csv.DictReader(file))
    for channel in record["channels"]:
        name, unit = channel["name"], channel["unit"]
        measured, after = (
            np.array([float(row[f"{name} {kind} [{unit}]"]) for row in rows]) for kind in ("measured", "after")
        )
        rms = float(np.sqrt(np.mean((measured - after) ** 2)))
        assert channel["after"]["rms"] == pytest.approx(rms, rel=1e-6)  # ten digits are written
        assert channel["after"]["relative"] == pytest.approx(rms / float(np.sqrt(np.mean(measured**2))), rel=1e-6)


def test_plant_after_reads_back_and_predicts_the_same(folder: Path) -> None:
    plant = read_plant(folder / "out" / "plant_after.toml")
    assert [effect.name for effect in plant.effects] == ["preload_growth"]
    evidence = prepare_heat(read_recording(folder / "validate.csv"), plant.heat, 0.0)
    shown = heat_predictor(plant).predict(plant, evidence)
    with (folder / "out" / "prediction.csv").open(encoding="utf-8") as file:
        rows = list(csv.DictReader(file))
    for name in CHANNELS:
        unit = "m" if name.startswith("table_growth") else "degC"
        written = np.array([float(row[f"{name} after [{unit}]"]) for row in rows])
        np.testing.assert_allclose(shown[name], written, rtol=1e-8, atol=1e-12)  # ten digits are written


def test_report_shows_hours_and_degrees(folder: Path) -> None:
    page = (folder / "out" / "report.html").read_text(encoding="utf-8").replace("\N{NO-BREAK SPACE}", " ")
    assert "preload torque growing as the nut warms" in page
    assert "rows of 30 s" in page
    assert (folder / "out" / "series_1_nut_temperature.png").is_file()
    assert not list((folder / "out").glob("spectrum*"))  # nothing of minutes shows over hertz


@pytest.mark.parametrize(
    ("drop", "rename", "told"),
    [
        ("screw_speed", "", "no channel screw_speed"),
        ("ambient_temperature", "", "no channel ambient_temperature"),
        ("nut_temperature", "nutt_temperature", 'did you mean "nut_temperature"?'),
    ],
)
def test_bad_recording_is_one_line(
    drop: str, rename: str, told: str, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    path = _write(tmp_path / "bad.csv", "train", drop=drop, rename=rename)
    assert main(["diagnose", "thermal_bench", str(path), "--out", str(tmp_path / "out")]) == 2
    error = capsys.readouterr().err
    assert told in error and error.count("\n") == 1
    assert not (tmp_path / "out").exists()


def test_recording_and_plant_of_different_kinds(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    slow = _write(tmp_path / "slow.csv", "train")
    fast = Path(__file__).resolve().parents[1] / "data" / "bench" / "null_train.csv.gz"
    for plant, recording, told in (
        ("bench_axis", slow, "a recording of temperatures"),
        ("thermal_bench", fast, "no channel screw_speed"),
    ):
        assert main(["diagnose", plant, str(recording), "--out", str(tmp_path / "out")]) == 2
        error = capsys.readouterr().err
        assert told in error and error.count("\n") == 1


@pytest.mark.parametrize("channels", [("nut_temperature",), ("table_growth_300mm",)])
def test_one_channel_says_what_it_cannot_show(
    channels: tuple[str, ...], tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    path = _write(tmp_path / "one.csv", "train", channels)
    assert main(["diagnose", "thermal_bench", str(path), "--out", str(tmp_path / "out"), "--json"]) == 0
    record = json.loads(capsys.readouterr().out)
    assert [channel["name"] for channel in record["channels"]] == list(channels)
    reasons = {entry["name"]: entry["reason"] for entry in record["refused"]}
    assert "slow sensor" in reasons["sensor_lag"]
    if channels == ("nut_temperature",):
        assert "growth" in reasons["structure_growth"] and "ends of the screw" in reasons["motor_heat"]


def test_commands_that_need_masses_refuse_the_plant(capsys: pytest.CaptureFixture[str]) -> None:
    assert main(["modes", "thermal_bench"]) == 2
    error = capsys.readouterr().err
    assert "declares heat alone" in error and error.count("\n") == 1


def test_check_and_show_of_heat_alone(capsys: pytest.CaptureFixture[str]) -> None:
    assert main(["check", "thermal_bench"]) == 0
    assert "no warnings" in capsys.readouterr().out
    assert main(["show", "thermal_bench", "--json"]) == 0
    content = json.loads(capsys.readouterr().out)
    assert content["structure"] == "heat alone"
    # The declared film: 0.29033 N^(2/3) at 750 rev/min, and the torques of the rig times 0.609 ω.
    assert content["speeds"][2]["screw_film"] == pytest.approx(0.29033 * 750 ** (2 / 3), rel=1e-4)


@pytest.mark.slow
def test_a_recording_is_added_to_a_heat_diagnosis(folder: Path, tmp_path: Path) -> None:
    words = ["diagnose", str(folder / "later.csv"), "--continue", str(folder / "out"), "--out", str(tmp_path / "out")]
    assert main(words) == 0
    runs = json.loads((tmp_path / "out" / "ledger.json").read_text(encoding="utf-8"))["runs"]
    assert [run["continues"] for run in runs] == [None, 1]
    assert [Path(one["path"]).name for one in runs[1]["fit"]] == ["train.csv", "later.csv"]
    assert "preload_growth" in [effect["name"] for effect in runs[1]["effects"]]
    assert any("preload_growth is confirmed" in sentence for sentence in runs[1]["since"])


def test_effects_of_a_heat_ledger_are_read(folder: Path) -> None:
    earlier = earlier_run(folder / "out")
    assert [effect.name for effect in earlier.effects] == ["preload_growth"]
    record = json.loads((folder / "out" / "diagnosis.json").read_text(encoding="utf-8"))
    found = record["effects"][0]["parameters"]["coefficient"]["value"]
    assert earlier.effects[0].values["coefficient"] == pytest.approx(found, rel=1e-12)
