"""The files of `feeddrive diagnose`: of one plant file, of one run, and no entry of the ledger lost.

What is diagnosed is told beforehand; the files are written as ever.
"""

from __future__ import annotations

import hashlib
import json
import os
import subprocess
import sys
from pathlib import Path

import pytest

import feeddrive
from feeddrive.cli.main import main
from feeddrive.files import find_plant, find_scenario_file
from feeddrive.interface.measured import diagnosis_run as diagnosing
from feeddrive.report.figures.drawing import RenderedFigure
from tests.analytic import report_examples as examples

PLANT = find_plant("bench_axis").read_bytes()
RECORDING = str(find_scenario_file("recordings/demo.csv.gz"))
FILES = {"diagnosis.json", "ledger.json", "plant_after.toml", "prediction.csv", "report.html"}

PROGRAM = """
import pathlib, sys, time
from feeddrive.interface.measured import diagnosis_run as diagnosing
from feeddrive.cli.main import main
from feeddrive.report.figures.drawing import RenderedFigure
from tests.analytic import report_examples as examples
folder, name, others = pathlib.Path(sys.argv[1]), sys.argv[2], sys.argv[3:]
def diagnose(*_):
    (folder / name).touch()
    while not all((folder / other).exists() for other in others):
        time.sleep(0.01)
    return examples.nothing_missing(2000), ()
diagnosing.diagnose = diagnose
diagnosing.render_figures = lambda _: ()
sys.exit(main(["diagnose", "bench_axis", %r, "--out", str(folder / "out")]))
"""
"""A diagnosis that ends only when the others have begun."""


@pytest.fixture
def told(monkeypatch: pytest.MonkeyPatch) -> None:
    """A diagnosis that finds nothing, at once."""
    monkeypatch.setattr(diagnosing, "diagnose", lambda *_: (examples.nothing_missing(2000), ()))
    monkeypatch.setattr(diagnosing, "render_figures", lambda _: ())


def test_plant_edited_meanwhile_is_reported_as_it_was_read(
    tmp_path: Path, told: None, monkeypatch: pytest.MonkeyPatch
) -> None:
    plant = tmp_path / "machine.toml"
    plant.write_bytes(PLANT)

    def diagnose(*_: object) -> object:
        plant.write_bytes(PLANT.replace(b'"134 kg"', b'"999 kg"'))
        return examples.nothing_missing(2000), ()

    monkeypatch.setattr(diagnosing, "diagnose", diagnose)
    assert main(["diagnose", str(plant), RECORDING, "--out", str(tmp_path / "out")]) == 0
    assert (tmp_path / "out" / "plant_after.toml").read_bytes() == PLANT
    run = json.loads((tmp_path / "out" / "ledger.json").read_text())["runs"][0]
    assert run["plant"]["sha256"] == hashlib.sha256(PLANT).hexdigest()


def test_plant_removed_meanwhile(tmp_path: Path, told: None, monkeypatch: pytest.MonkeyPatch) -> None:
    plant = tmp_path / "machine.toml"
    plant.write_bytes(PLANT)

    def diagnose(*_: object) -> object:
        plant.unlink()
        return examples.nothing_missing(2000), ()

    monkeypatch.setattr(diagnosing, "diagnose", diagnose)
    assert main(["diagnose", str(plant), RECORDING, "--out", str(tmp_path / "out")]) == 0
    assert (tmp_path / "out" / "plant_after.toml").read_bytes() == PLANT


def test_plant_edited_while_it_is_read(
    tmp_path: Path, told: None, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    plant = tmp_path / "machine.toml"
    plant.write_bytes(PLANT)
    read = diagnosing.load

    def edited(*arguments: object) -> object:
        plant.write_bytes(PLANT.replace(b'"134 kg"', b'"999 kg"'))
        return read(*arguments)  # type: ignore[arg-type]

    monkeypatch.setattr(diagnosing, "load", edited)
    assert main(["diagnose", str(plant), RECORDING, "--out", str(tmp_path / "out")]) == 2
    assert "machine.toml: was changed while it was read" in capsys.readouterr().err
    assert not (tmp_path / "out").exists()


@pytest.mark.parametrize("at", ["write_outputs", "save_figures", "write_report", "write_ledger"])
def test_stopped_at_any_file_the_earlier_ones_stay(
    at: str, tmp_path: Path, told: None, monkeypatch: pytest.MonkeyPatch
) -> None:
    arguments = ["diagnose", "bench_axis", RECORDING, "--out", str(tmp_path / "out")]
    assert main(arguments) == 0
    before = {path.name: path.read_bytes() for path in (tmp_path / "out").iterdir()}
    assert set(before) == FILES
    write = getattr(diagnosing, at)

    def stopped(*others: object) -> None:
        write(*others)
        raise KeyboardInterrupt

    monkeypatch.setattr(diagnosing, at, stopped)
    assert main(arguments) == 130
    assert {path.name: path.read_bytes() for path in (tmp_path / "out").iterdir()} == before


def test_two_at_the_same_time_lose_no_entry_of_the_ledger(tmp_path: Path) -> None:
    environment = {**os.environ, "PYTHONPATH": str(Path(feeddrive.__file__).parents[1])}
    names = ("one", "two", "three")
    started = [
        subprocess.Popen(
            [sys.executable, "-c", PROGRAM % RECORDING, str(tmp_path), name, *names],
            env=environment, stdout=subprocess.DEVNULL, stderr=subprocess.PIPE,
        )
        for name in names
    ]  # fmt: skip
    assert [(one.wait(timeout=300), one.communicate()[1]) for one in started] == [(0, b"")] * 3
    runs = json.loads((tmp_path / "out" / "ledger.json").read_text())["runs"]
    assert [run["run"] for run in runs] == [1, 2, 3]
    assert {path.name for path in (tmp_path / "out").iterdir()} == FILES


def test_figure_of_an_earlier_run_does_not_stay_beside_the_new_ones(
    tmp_path: Path, told: None, monkeypatch: pytest.MonkeyPatch
) -> None:
    arguments = ["diagnose", "bench_axis", RECORDING, "--out", str(tmp_path)]
    drawn = (RenderedFigure("curve_stribeck", "Curve", "", b"png"), RenderedFigure("tried", "Tried", "", b"png"))
    monkeypatch.setattr(diagnosing, "render_figures", lambda _: drawn)
    assert main(arguments) == 0
    (tmp_path / "mine.png").write_bytes(b"mine")
    monkeypatch.setattr(diagnosing, "render_figures", lambda _: drawn[1:])
    assert main(arguments) == 0
    assert {path.name for path in tmp_path.iterdir()} == {*FILES, "tried.png", "mine.png"}


def test_ledger_cannot_lead_a_removal_out_of_the_folder(tmp_path: Path, told: None) -> None:
    out, other = tmp_path / "out", tmp_path / "other.txt"
    arguments = ["diagnose", "bench_axis", RECORDING, "--out", str(out)]
    assert main(arguments) == 0
    other.write_text("mine")
    record = json.loads((out / "ledger.json").read_text())
    record["runs"][0]["written"] += ["../other.txt", str(other), "..", ".", 5]
    (out / "ledger.json").write_text(json.dumps(record))
    assert main(arguments) == 0
    assert other.read_text() == "mine"
