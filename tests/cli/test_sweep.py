"""`feeddrive sweep` as a user types it: the same from every worker, resumed when killed, one line for errors."""

from __future__ import annotations

import csv
import json
import os
import shutil
import signal
import subprocess
import sys
import time
import warnings
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from feeddrive.cli.main import main
from feeddrive.files import find_scenario_file
from feeddrive.simulate.sweep.sweep_design import make_design
from feeddrive.simulate.sweep.sweep_values import read_parameters

SWEEP = ["sweep", "step_position", "--set", "trajectory.duration=0.2 s"]
GRID = ["--vary", "controller.position_gain=40:1000:4 1/s", "--vary", "plant.table.mass=100,200 kg"]
"""The two runs of the largest gain are unstable."""


def _table(folder: Path) -> list[dict[str, str]]:
    with open(folder / "table.csv", encoding="utf-8", newline="") as file:
        return list(csv.DictReader(file))


@pytest.fixture(scope="module")
def serial(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """The sweep of `GRID`, run by this process alone."""
    out = tmp_path_factory.mktemp("sweep") / "serial"
    assert main([*SWEEP, *GRID, "--workers", "1", "--out", str(out)]) == 0
    return out


def test_table_and_results_hold_every_run(serial: Path, capsys: pytest.CaptureFixture[str]) -> None:
    rows, content = _table(serial), json.loads((serial / "results.json").read_text(encoding="utf-8"))
    assert [float(row["controller.position_gain [1/s]"]) for row in rows] == [40, 40, 360, 360, 680, 680, 1000, 1000]
    assert [float(row["plant.table.mass [kg]"]) for row in rows] == [100, 200] * 4
    failed = [row for row in rows if row["status"] == "failed"]
    assert failed and all("unstable" in row["remark"] and not row["step.rise [s]"] for row in failed)
    assert [bool(run["failed"]) for run in content["runs"]] == [row["status"] == "failed" for row in rows]
    assert content["format"] == "feeddrive-sweep/1" and content["metrics"]["step.rise"] == "s"
    assert (serial / "sweep.png").read_bytes().startswith(b"\x89PNG")
    # a row is what the single run gives, to the last bit
    settings = ["--set", "controller.position_gain=360 1/s", "--set", "plant.table.mass=200 kg"]
    assert main(["run", *SWEEP[1:], *settings, "--json"]) == 0
    single = json.loads(capsys.readouterr().out)
    assert float(rows[3]["following_error.rms [m]"]) == single["following_error"]["rms"]
    assert float(rows[3]["step.overshoot [1]"]) == single["evaluations"][0]["overshoot"]


def _same(one: Path, other: Path) -> None:
    for name in ("table.csv", "results.json", "sweep.png"):
        assert (one / name).read_bytes() == (other / name).read_bytes()


def test_processes_give_the_same_bits(serial: Path, tmp_path: Path) -> None:
    assert main([*SWEEP, *GRID, "--workers", "2", "--out", str(tmp_path)]) == 0
    _same(serial, tmp_path)


def test_dask_cluster_gives_the_same_bits(serial: Path, tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    distributed = pytest.importorskip("distributed", reason="Dask is not installed: pip install 'feeddrive[dask]'")
    with (
        warnings.catch_warnings(action="ignore"),  # Dask's own
        distributed.LocalCluster(n_workers=2, threads_per_worker=1, dashboard_address=None) as cluster,
    ):
        scheduler = ["--scheduler", cluster.scheduler_address]
        assert main([*SWEEP, *GRID, *scheduler, "--out", str(tmp_path)]) == 0
    _same(serial, tmp_path)


def test_killed_sweep_resumes_without_loss(tmp_path: Path) -> None:
    """Workers finish and write the unit in hand when the main process is killed; the table is that of a whole run."""
    sweep = [*SWEEP, "--vary", "controller.position_gain=40:80:41 1/s", "--workers", "2", "--out"]
    out, whole = tmp_path / "killed", tmp_path / "whole"
    run = subprocess.Popen([sys.executable, "-m", "feeddrive", *sweep, str(out)], start_new_session=True)
    _wait_until(lambda: len(list(out.glob("units/*.json"))) > 2 or run.poll() is not None)
    os.kill(run.pid, signal.SIGKILL)
    assert run.wait() == -signal.SIGKILL
    _wait_until(lambda: not _living(run.pid))
    cut = json.loads((out / "sweep.json").read_text(encoding="utf-8"))
    units = sorted(int(path.stem) for path in out.glob("units/*.json"))
    everything = 1 + -(-40 // cut["unit_size"])
    lost = sorted({*range(units[-1])} - {*units})  # handed to the other worker, but not begun when the end came
    assert len(lost) <= 1 and 2 < len(units) < everything
    written = {path: path.stat().st_mtime_ns for path in out.glob("units/*.json")}
    done = subprocess.run([sys.executable, "-m", "feeddrive", *sweep, str(out)], capture_output=True, text=True)
    assert done.returncode == 0 and done.stderr == ""
    assert f"│ {1 + (len(units) - 1) * cut['unit_size']} " in done.stdout  # runs from the earlier start
    assert {path: path.stat().st_mtime_ns for path in written} == written
    assert main([*[one if one != "2" else "1" for one in sweep], str(whole)]) == 0
    _same(out, whole)


def _wait_until(condition: Any) -> None:
    end = time.monotonic() + 60
    while not condition():
        assert time.monotonic() < end
        time.sleep(0.01)


def _living(session: int) -> list[str]:
    """Processes of a session that have not ended; where there is no /proc none is seen."""
    found = []
    for path in Path("/proc").glob("[0-9]*/stat"):
        try:
            fields = path.read_text().rpartition(")")[2].split()
        except OSError:
            continue
        if fields[3] == str(session) and fields[0] not in "ZX":
            found.append(path.parent.name)
    return found


def test_missing_unit_is_done_again_and_a_foreign_one_refused(
    serial: Path, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    out = tmp_path / "copy"
    shutil.copytree(serial, out)
    (out / "units" / "0003.json").unlink()
    (out / "table.csv").unlink()
    assert main([*SWEEP, *GRID, "--workers", "1", "--out", str(out)]) == 0
    assert "of these from an earlier start │ 7" in capsys.readouterr().out
    _same(serial, out)
    (out / "units" / "0003.json").write_text("{", encoding="utf-8")
    assert main([*SWEEP, *GRID, "--workers", "1", "--out", str(out)]) == 2
    assert "0003.json: cannot be read; remove it; its runs are then done again" in capsys.readouterr().err
    assert main([*SWEEP, "--vary", "plant.table.mass=100,200 kg", "--out", str(out)]) == 2
    assert "holds another sweep" in capsys.readouterr().err


def test_random_values_fill_their_range() -> None:
    """Latin hypercube: one sample in each of N slices; the same seed gives the same samples."""
    path = find_scenario_file("step_position.toml")
    parameters = read_parameters(
        [
            "plant.table.mass=100~200 kg",
            "controller.position_feedback=motor,table",
            "controller.feed_forward.torque=0~1",
        ]
    )
    design = make_design(path, {}, parameters, samples=10, seed=3)
    assert len(design.rows) == 20
    mass = np.array([float(row[0]) for row in design.rows if row[1] == "motor"])
    assert sorted(np.floor((mass - 100) / 10)) == [*range(10)]
    assert [row[0] for row in design.rows[:10]] == [row[0] for row in design.rows[10:]]
    again = make_design(path, {}, parameters, samples=10, seed=3)
    assert again == design and make_design(path, {}, parameters, samples=10, seed=4).digest != design.digest


def test_main_effects_of_random_and_listed_values(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    varied = ["--vary", "plant.table.mass=100~200 kg", "controller.position_feedback=motor,table", "--samples", "3"]
    out = ["--metric", "step.rise", "--workers", "1", "--out", str(tmp_path)]
    assert main([*SWEEP, *varied, *out]) == 0
    assert "3 random values" in capsys.readouterr().out
    assert len(_table(tmp_path)) == 6 and (tmp_path / "sweep.png").is_file()


@pytest.mark.parametrize(
    ("options", "message"),
    [
        ([], "nothing is varied"),
        (["--vary", "controller.position_gain"], "is not key=values"),
        (["--vary", "controller.positon_gain=1:2:3 1/s"], 'unknown key "positon_gain"; did you mean "position_gain"?'),
        (["--vary", "plant.tabel.mass=1:2:3 kg"], 'unknown key "tabel"; did you mean "table"?'),
        (["--vary", "plant.table.mass=-5:5:3 kg"], "--vary plant.table.mass, "),
        (["--vary", "plant.table.mass=1:5:3"], "is a bare number; write it with its unit"),
        (["--vary", "plant.table.mass=1:5:3 1/s"], '"1/s" does not measure a mass'),
        (["--vary", "plant.table.mass=1 g:5 kg:3"], '"1 g" is not in kg; write all values in one unit'),
        (["--vary", "plant.table.mass=100:200:0 kg"], "0 points; write at least 2"),
        (["--vary", "plant.table.mass=100:200:x kg"], '"x" is not a number of points'),
        (["--vary", "plant.table.mass=100:200"], "is no range; write first:last:points"),
        (["--vary", "plant.table.mass=100 kg"], "one value is not varied"),
        (["--vary", "plant.table.mass=100,100 kg,"], "has an empty value"),
        (["--vary", "plant.table.mass=100 kg,100 kg"], "has a value twice"),
        (["--vary", "plant.table.mass=100:200:1000 kg", "controller.K_v=10:20:1000 1/s"], "1000000 runs; at most"),
        (["--vary", "plant.table.mass=1:2:3 kg", "plant.table.mass=1:2:3 kg"], "is varied twice"),
        (["--vary", "trajectory.duration=1:2:3 s"], "is set and varied; leave out its --set"),
        (["--vary", "plant.table.mass=100~200 kg"], "no number of samples; write --samples 100"),
        (["--vary", "plant.table.mass=200~100 kg", "--samples", "5"], "write the smaller end first"),
        (["--vary", "plant.table.mass=100,200 kg", "--samples", "5"], "nothing is random"),
        (["--vary", "plant=bench_axis,bench_axs"], "the nearest shipped plants: bench_axis"),
        (["--vary", "plant.table.mass=100,200 kg", "--workers", "0"], "0 workers; write 1 to 256"),
        (["--vary", "plant.table.mass=100,200 kg", "--scheduler", "here"], "is not an address"),
        (["--vary", "plant.table.mass=100,200 kg", "--metric", "step.rize", "--workers", "1"], '"step.rise"?'),
        (["--vary", "controller.velocity_gain=20,30 N m s/rad", "--workers", "1"], "all 2 runs failed, the first: the"),
    ],
)  # fmt: skip
def test_what_is_wrong_is_told_in_one_line(
    options: list[str], message: str, capsys: pytest.CaptureFixture[str]
) -> None:
    assert main([*SWEEP, *options]) == 2
    shown = capsys.readouterr()
    assert shown.out == "" and shown.err.startswith("error: ") and shown.err.count("\n") == 1
    assert message in shown.err


def test_scheduler_that_does_not_answer_is_told(
    capsys: pytest.CaptureFixture[str], monkeypatch: pytest.MonkeyPatch
) -> None:
    pytest.importorskip("distributed", reason="Dask is not installed: pip install 'feeddrive[dask]'")
    monkeypatch.setattr("feeddrive.simulate.sweep.sweep_dask._PATIENCE", 0.2)
    with warnings.catch_warnings(action="ignore"):
        assert main([*SWEEP, *GRID, "--scheduler", "tcp://127.0.0.1:9"]) == 2
    assert "no Dask scheduler answers" in capsys.readouterr().err
