"""`feeddrive bode` as a user types it: tables, JSON, figures, and one line for everything that is wrong."""

from __future__ import annotations

import json
from pathlib import Path

import numpy as np
import pytest

from feeddrive.cli.main import main
from feeddrive.files import find_plant, scenarios_folder
from feeddrive.plant.analysis.steady import steady_motion
from feeddrive.plant.file.plant_file import read_plant
from feeddrive.simulate.held_torque import simulate_torque

OPEN = ["--loop", "open", "--scenario", "step_position"]
CLOSED = ["--loop", "closed", "--scenario", "step_position"]


def test_mechanics_in_tables(capsys: pytest.CaptureFixture[str]) -> None:
    assert main(["bode", "bench_axis"]) == 0
    shown = capsys.readouterr()
    assert shown.err == ""
    for text in ("189.6 Hz", "anti-resonance", "512.5 Hz", "(rad/s)/(N m)", "100 Hz", "-13.28 dB"):
        assert text in shown.out


def test_family_over_positions_as_json_and_figure(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    flags = ["--to", "table_position", "--positions", "0 mm, 500mm,1 m", "--out", str(tmp_path / "a"), "--json"]
    assert main(["bode", "kimm_testbed", *flags]) == 0
    content = json.loads(capsys.readouterr().out)
    assert content["format"] == "feeddrive-bode/1"
    (family,) = content["responses"]
    assert (family["from"], family["to"], family["unit"]) == ("motor_torque", "table_position", "m/(N m)")
    first = [curve["resonances"][0]["frequency"] for curve in family["curves"]]
    assert [curve["position"] for curve in family["curves"]] == [0.0, 0.5, 1.0]
    assert first == sorted(first, reverse=True)
    assert json.loads((tmp_path / "a" / "bode.json").read_text(encoding="utf-8")) == content
    assert (tmp_path / "a" / "bode_mechanics.png").read_bytes().startswith(b"\x89PNG")


def test_open_loops_with_margins(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    assert main(["bode", "bench_axis", *OPEN, "--payload", "0kg,50kg", "--json", "--out", str(tmp_path)]) == 0
    velocity, position = json.loads(capsys.readouterr().out)["responses"]
    assert velocity["title"] == "velocity loop, open" and position["title"] == "position loop, open"
    found = [curve["margins"] for curve in velocity["curves"]]
    assert all(one["stable"] and one["gain_db"] > 6 and one["phase_deg"] > 30 for one in found)
    assert found[0] != found[1]
    assert {path.name for path in tmp_path.iterdir()} == {
        "bode.json",
        "bode_velocity_open.png",
        "bode_position_open.png",
    }


def test_closed_loops_and_the_compliance_of_the_controlled_axis(capsys: pytest.CaptureFixture[str]) -> None:
    assert main(["bode", "bench_axis", *CLOSED]) == 0
    assert "bandwidth, -3 dB" in capsys.readouterr().out
    assert main(["bode", "bench_axis", *CLOSED, "--from", "cutting_force", "--to", "table_position"]) == 0
    assert "µm/N" in capsys.readouterr().out


def test_recording_is_laid_over(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    plant, tick = read_plant(find_plant("bench_axis")), 1 / 4000
    bits = np.random.default_rng(5).integers(0, 2, 8000) * 2.0 - 1.0
    time, torque = tick * np.arange(8000), steady_motion(plant, 0.05).torque + bits - bits.mean()
    run = simulate_torque(plant, time, torque, 0.0, 0.05)
    rows = "\n".join(f"{t!r},{u!r},{a!r}" for t, u, a in zip(time.tolist(), torque.tolist(), run.motor_angle.tolist(),
                                                             strict=True))  # fmt: skip
    path = tmp_path / "shaken.csv"
    path.write_text(f"time [s],motor_torque [N m],motor_angle [rad]\n{rows}\n", encoding="utf-8")
    assert main(["bode", "bench_axis", "--recording", str(path), "--json", "--out", str(tmp_path / "out")]) == 0
    measured = json.loads(capsys.readouterr().out)["measured"]
    assert np.median(measured["coherence"]) > 0.9
    # 1/(J s) at 50 Hz, as the table of numbers has it: -6.24 dB
    near = np.abs(np.array(measured["frequency"]) - 50) < 5
    assert np.mean(np.array(measured["magnitude_db"])[near]) == pytest.approx(-6.24, abs=1.0)


@pytest.mark.parametrize(
    ("flags", "message"),
    [
        (["--at", "x=2 m"], "--at: the table at 2000 mm is outside the stroke of KIMM testbed; choose from 0 mm"),
        (["--positions", "0 mm,1200 mm"], "the table at 1200 mm is outside the stroke"),
        (["--positions", "0.2"], "0.2 is a bare number"),
        (["--positions", "0 mm", "--at", "x=1 mm"], "positions are given twice"),
        (["--from", "motor_torqe"], 'unknown channel "motor_torqe"; did you mean "motor_torque"?'),
        (["--to", "spindle"], 'unknown channel "spindle"; known are motor_angle, motor_speed'),
        (["--payload", "-200 kg"], "leaves no mass"),
        (["--range", "5 Hz"], "is not two frequencies"),
        (["--range", "50 Hz,5 Hz"], "50 Hz to 5 Hz is no range of frequencies"),
        (["--loop", "open"], "a loop needs a controller; name a scenario"),
        (["--loop", "opened", "--scenario", "step_position"], '"opened" is not possible; did you mean "open"?'),
        ([*OPEN, "--to", "table_position"], "an open loop has no --from or --to"),
        (["--scenario", "step_positio"], 'did you mean "step_position"?'),
        ([*CLOSED, "--from", "setpoint"], 'unknown channel "setpoint"'),
        (["--recording", "nowhere.csv"], "no such file"),
        ([*OPEN, "--recording", "x.csv"], "a recording is laid over the mechanics"),
    ],
)
def test_what_is_wrong_is_told_in_one_line(
    flags: list[str], message: str, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    out = tmp_path / "out"
    assert main(["bode", "kimm_testbed", *flags, "--out", str(out)]) == 2
    shown = capsys.readouterr()
    assert shown.out == "" and shown.err.startswith("error: ") and shown.err.count("\n") == 1
    assert message in shown.err
    assert not out.exists()


@pytest.mark.parametrize("loop", ["open", "closed"])
def test_unstable_loop_is_refused_with_its_eigenvalue(
    loop: str, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    written = (scenarios_folder() / "controllers" / "bench_axis.toml").read_text(encoding="utf-8")
    path = tmp_path / "wild.toml"
    path.write_text(written.replace('velocity_gain = "', 'velocity_gain = "9'), encoding="utf-8")
    assert main(["bode", "bench_axis", "--loop", loop, "--scenario", str(path)]) == 2
    shown = capsys.readouterr().err
    assert shown.count("\n") == 1 and "the loop is unstable: eigenvalue" in shown and "grows by" in shown
