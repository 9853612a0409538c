"""`feeddrive diagnose --continue`: recordings added to an earlier diagnosis, and the ledger that keeps all of it."""

from __future__ import annotations

import contextlib
import io
import json
import math
import re
from pathlib import Path
from typing import Any

import pytest

from feeddrive.cli.main import main
from feeddrive.recording import write_recording
from tests.recovery.rigid_runs import LEAD, MASS, PLANT, Truth, rigid_run


def typed(*words: str) -> tuple[int, str, str]:
    """Status and the two streams of `feeddrive diagnose`."""
    out, err = io.StringIO(), io.StringIO()
    with contextlib.redirect_stdout(out), contextlib.redirect_stderr(err):
        status = main(["diagnose", *words])
    return status, out.getvalue(), err.getvalue()


def ledger(folder: Path) -> list[dict[str, Any]]:
    """The runs of a ledger."""
    record = json.loads((folder / "ledger.json").read_text(encoding="utf-8"))
    assert record["format"] == "feeddrive-ledger/1"
    runs: list[dict[str, Any]] = record["runs"]
    return runs


@pytest.fixture(scope="module")
def files(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """A folder with a plant, two recordings, a measured number, and a first diagnosis of one recording with it."""
    folder = tmp_path_factory.mktemp("machine")
    (folder / "rigid.toml").write_text(PLANT, encoding="utf-8")
    write_recording(rigid_run("a", Truth(ripple=0.01), 8.0), folder / "a.csv")
    write_recording(rigid_run("b", Truth(ripple=0.01, coulomb=1.15, seed=2), 8.0, 1.3), folder / "b.csv")
    inertia = MASS * (LEAD / (2 * math.pi)) ** 2
    number = f'[[measured]]\nquantity = "inertia_at_motor"\nvalue = "{inertia!r} kg m^2"\n'
    (folder / "numbers.toml").write_text(number, encoding="utf-8")
    words = (str(folder / "rigid.toml"), str(folder / "a.csv"), "--measured", str(folder / "numbers.toml"))
    status, _, err = typed(*words, "--out", str(folder / "report"))
    assert (status, err) == (0, "")
    return folder


def test_first_run_is_kept(files: Path) -> None:
    run = ledger(files / "report")[0]
    assert run["continues"] is None
    assert [Path(one["path"]).name for one in run["fit"]] == ["a.csv"]
    taken = [one["effect"] for one in run["tried"] if one["taken"]]
    assert taken == ["torque_ripple"]
    assert all(one["reason"] for one in run["tried"])
    # a mass and friction levels are calibrated, so that what says no more than that they are other is not tried
    assert {one["effect"] for one in run["tried"]} > {"stribeck", "constant_force", "viscous_asymmetry"}
    names, matrix = run["covariance"]["values"], run["covariance"]["matrix"]
    assert "torque_ripple.amplitude" in names
    assert len(matrix) == len(names) == len(matrix[0])


def test_a_recording_is_added(files: Path, tmp_path: Path) -> None:
    before = (files / "report" / "ledger.json").read_bytes()
    status, out, err = typed(str(files / "b.csv"), "--continue", str(files / "report"), "--out", str(tmp_path))
    assert (status, err) == (0, "")
    assert (files / "report" / "ledger.json").read_bytes() == before  # the earlier state stays where it is
    first, second = ledger(tmp_path)
    assert first == ledger(files / "report")[0]
    assert second["continues"] == 1
    assert second["measured"] == first["measured"] and Path(first["measured"]["path"]).name == "numbers.toml"
    (number,) = json.loads((tmp_path / "diagnosis.json").read_text(encoding="utf-8"))["measured"]
    assert number["met"] and number["fitted"]
    assert [Path(one["path"]).name for one in second["fit"]] == ["a.csv", "b.csv"]
    assert [one["name"] for one in second["effects"]] == ["torque_ripple"]
    (change,) = second["changes"]
    assert (change["parameter"], change["recording"], change["against"]) == ("coulomb_factor", "b.csv", "a.csv")
    assert change["difference"] == pytest.approx(0.15, rel=0.1)  # 10 %: what is asked of a planted size
    assert any("torque_ripple is confirmed" in one for one in second["since"])
    assert "since the earlier diagnosis: torque_ripple is confirmed" in out
    page = (tmp_path / "report.html").read_text(encoding="utf-8")
    assert re.search(r"guide Coulomb level 1\d", page, re.IGNORECASE)
    assert "Since the earlier diagnosis" in page


def refused(words: list[str], told: str) -> None:
    """Exit status 2 and one line."""
    status, out, err = typed(*words)
    assert (status, out) == (2, "")
    assert err.startswith("error: ")
    assert err.count("\n") == 1
    assert told in err


def test_what_cannot_be_continued(files: Path, tmp_path: Path) -> None:
    report, b = str(files / "report"), str(files / "b.csv")
    before = (files / "report" / "ledger.json").read_bytes()
    refused([b, "--continue", str(tmp_path)], "no ledger.json")
    refused([str(files / "a.csv"), "--continue", report], "already")
    refused(["bench_axis", b, "--continue", report], "another plant")
    refused([str(files / "rigid.toml"), "--continue", report], "no recording to add")
    (tmp_path / "ledger.json").write_text("{", encoding="utf-8")
    refused([b, "--continue", str(tmp_path)], "cannot be read")
    refused([str(files / "rigid.toml"), b, "--out", str(tmp_path)], "cannot be read")
    assert (files / "report" / "ledger.json").read_bytes() == before


def test_files_that_are_not_what_they_were(tmp_path: Path, files: Path) -> None:
    record = json.loads((files / "report" / "ledger.json").read_text(encoding="utf-8"))
    moved = tmp_path / "a.csv"
    record["runs"][-1]["fit"][0]["path"] = str(moved)
    (tmp_path / "ledger.json").write_text(json.dumps(record), encoding="utf-8")
    words = [str(files / "b.csv"), "--continue", str(tmp_path)]
    refused(words, "is missing")
    moved.write_text("time [s],motor_torque [N m]\n0,0\n", encoding="utf-8")
    refused(words, "not what it was")
    record["runs"][-1]["fit"][0]["path"] = str(files / "a.csv")
    record["runs"][-1]["measured"]["path"] = str(tmp_path / "numbers.toml")
    (tmp_path / "ledger.json").write_text(json.dumps(record), encoding="utf-8")
    refused(words, "is missing")


def test_what_is_missing_on_the_command_line(files: Path) -> None:
    refused([str(files / "rigid.toml"), "--out", str(files / "none")], "no recording")
    refused([str(files / "rigid.toml"), str(files / "a.csv")], "--out is missing")
