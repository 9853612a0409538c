"""`feeddrive run` as a user types it: files, JSON, overrides, and one line for everything that is wrong."""

from __future__ import annotations

import json
from pathlib import Path

import pytest

from feeddrive.cli.main import main
from feeddrive.files import find_scenario_file, scenarios_folder
from feeddrive.recording.files.reading import read_recording


def test_run_writes_recording_figures_and_metrics(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    out = tmp_path / "deep" / "result"
    assert main(["run", "s_curve_positioning", "--out", str(out)]) == 0
    shown = capsys.readouterr()
    assert shown.err == ""
    assert "5 (m/min)/mm = 83.33 1/s" in shown.out and "settling" in shown.out
    assert {path.name for path in out.iterdir()} == {"recording.csv", "metrics.json", "motion.png", "settling.png"}
    assert (out / "motion.png").read_bytes().startswith(b"\x89PNG")
    content = json.loads((out / "metrics.json").read_text(encoding="utf-8"))
    assert content["format"] == "feeddrive-run/1"
    assert content["controller"]["position_gain"]["1/s"] == pytest.approx(5e3 / 60)
    points = content["evaluations"][0]["points"]
    assert [point["target"] for point in points] == [0.25, 0.27, 0.271, 0.05]
    recording = read_recording(out / "recording.csv")
    assert len(recording) == content["samples"]
    error = recording["setpoint"] - recording["table_position"]
    assert abs(error).max() == pytest.approx(content["following_error"]["maximum"], rel=1e-12)


def test_run_prints_json_alone(capsys: pytest.CaptureFixture[str]) -> None:
    assert main(["run", "step_position", "--json"]) == 0
    content = json.loads(capsys.readouterr().out)
    assert content["evaluations"][0]["kind"] == "step"
    assert content["evaluations"][0]["final"] == pytest.approx(0.1001, abs=1e-8)


def test_values_are_set_on_the_command_line(capsys: pytest.CaptureFixture[str]) -> None:
    settings = [
        "--set",
        "trajectory.height=0.05 mm",
        "--set",
        "controller.K_v=2 (m/min)/mm",
        "--set",
        "evaluate.1.at=0.1 s",
    ]
    assert main(["run", "step_position", "--json", *settings]) == 0
    content = json.loads(capsys.readouterr().out)
    assert content["controller"]["position_gain"]["(m/min)/mm"] == pytest.approx(2.0)
    assert content["evaluations"][0]["final"] == pytest.approx(0.10005, abs=1e-7)


def test_same_run_gives_the_same_files(tmp_path: Path) -> None:
    for name in ("a", "b"):
        assert main(["run", "step_force", "--out", str(tmp_path / name)]) == 0
    for path in (tmp_path / "a").iterdir():
        assert path.read_bytes() == (tmp_path / "b" / path.name).read_bytes()


@pytest.mark.parametrize(
    ("settings", "message"),
    [
        (["trajectory.velocty=1 m/min"], 'unknown key "velocty"; did you mean "velocity"?'),
        (["trajectory.velocity=1"], "is a bare number; write it with its unit"),
        (["trajectory.velocity=1 kg"], '"kg" does not measure a velocity'),
        (["trajectory.jerk=0 m/s^3"], "trajectory.jerk: the limit 0 is not above zero; no move is possible"),
        (["trajectory.kind=moove"], '"moove" is not possible; did you mean "moves"?'),
        (['trajectory.targets=["600 mm"]'], "100 mm beyond the travel at 1.55 s; the travel is 0 mm to 500 mm"),
        (['trajectory.velocity=["1 m/min", "2 m/min"]'], "2 velocities for 4 targets; write one velocity"),
        (["controller.position_rate=3 kHz"], "8000 Hz is no integer multiple of 3000 Hz; write 2666.66666667 Hz"),
        (["record.rate=3 kHz"], "8000 Hz is no integer multiple of 3000 Hz"),
        (["controller.velocity_gain=20 N m s/rad"], "the loop is unstable: eigenvalue"),
        (["controller.position_feedback=table top"], '"table top" is not possible; did you mean "table"?'),
        (["controller.mode=velocity", "controller.velocity_gain=0 N m s/rad"], "is not above zero"),
        (["controller.current_limit=20 A"], "belong together; add torque_constant"),
        (["controller.filter.1.frequency=3900 Hz"], "does not fit a sample rate of 8000 Hz"),
        (["controller.filter.2.frequency=1 Hz"], "no entry 2; count from 1 to 1"),
        (["controller.K_v=1 1/s", "controller.position_gain=1 1/s"], "both set position_gain; keep one of them"),
        (["controller.feed_forward.spead=1"], 'unknown key "spead"; did you mean "speed"?'),
        (["record.channels=[\"table_positon\"]"], 'did you mean "table_position"?'),
        (["record.noise.motor_torque=5"], "is a bare number"),
        (["run.duration=3000 h"], "ticks; 2 to 2e+09 are possible; check the units"),
        (["evaluate.1.kind=circular", "evaluate.1.window=1 um"], 'unknown key "window"'),
        (["plant=bench_axs"], "the nearest shipped plants: bench_axis"),
        (["controller=nowhere.toml"], "no such controller file"),
        (["trajectory.dwell"], '"trajectory.dwell" is not key=value'),
        (["name.first=x"], '"name" is a value, not a table'),
        (["effect=5"], "is not a list of tables"),
        (["surprise=1"], 'unknown key "surprise"'),
    ],
)  # fmt: skip
def test_what_is_wrong_is_told_in_one_line(
    settings: list[str], message: str, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    out = tmp_path / "out"
    flags = [flag for setting in settings for flag in ("--set", setting)]
    assert main(["run", "s_curve_positioning", "--out", str(out), *flags]) == 2
    shown = capsys.readouterr()
    assert shown.out == ""
    assert shown.err.startswith("error: ") and shown.err.count("\n") == 1
    assert message in shown.err
    assert not out.exists()


def test_figures_that_a_run_cannot_give_are_refused(capsys: pytest.CaptureFixture[str]) -> None:
    assert main(["run", "step_position", "--set", 'evaluate=[{kind="circular"}]']) == 2
    assert 'the set-point is no circle; use kind = "circle"' in capsys.readouterr().err


def test_unstable_loop_runs_when_it_is_wanted(capsys: pytest.CaptureFixture[str]) -> None:
    settings = ["--set", "controller.velocity_gain=20 N m s/rad", "--set", "trajectory.duration=0.2 s",
                "--set", 'evaluate=[{kind="following"}]']  # fmt: skip
    assert main(["run", "step_position", *settings]) == 2
    assert "set allow_unstable = true" in capsys.readouterr().err
    assert main(["run", "step_position", "--json", *settings, "--set", "controller.allow_unstable=true"]) == 0
    assert json.loads(capsys.readouterr().out)["controller"]["slowest_eigenvalue"]["growth 1/s"] > 0


@pytest.mark.parametrize(
    ("content", "message"),
    [
        ("", 'write format = "feeddrive-scenario/1" in its first line'),
        ("format = ", "is not TOML"),
        ('format = "feeddrive-scenario/1"\nplant = "bench_axis"\n', "controller is missing"),
        ('format = "feeddrive-scenario/1"\ncontroller = "x.toml"\n', "no such controller file"),
        ('format = "feeddrive-scenario/1"\nplant = 5\n[controller]\n', "5 is not a text"),
    ],
)
def test_bad_files_are_told_in_one_line(
    content: str, message: str, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    path = tmp_path / "scenario.toml"
    path.write_text(content, encoding="utf-8")
    assert main(["run", str(path)]) == 2
    shown = capsys.readouterr()
    assert shown.out == "" and shown.err.count("\n") == 1 and message in shown.err


def test_misspelt_scenario_names_the_nearest(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    assert main(["run", "s_curve_positionin"]) == 2
    assert "s_curve_positioning" in capsys.readouterr().err
    assert main(["run", str(tmp_path)]) == 2
    assert "is a folder" in capsys.readouterr().err
    occupied = tmp_path / "file"
    occupied.write_text("", encoding="utf-8")
    assert main(["run", "step_force", "--out", str(occupied)]) == 2
    assert "is a file, not a folder" in capsys.readouterr().err


def test_scenario_beside_its_own_plant_and_controller(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    """A copy of a scenario with its files beside it is found from any folder."""
    (tmp_path / "controllers").mkdir()
    controller = scenarios_folder() / "controllers" / "bench_axis.toml"
    (tmp_path / "controllers" / "bench_axis.toml").write_bytes(controller.read_bytes())
    text = find_scenario_file("step_position.toml").read_text(encoding="utf-8")
    (tmp_path / "own.toml").write_text(text, encoding="utf-8")
    assert main(["run", str(tmp_path / "own.toml"), "--json"]) == 0
    assert json.loads(capsys.readouterr().out)["name"] == "step of the position"


def test_recorded_force_is_read_from_a_file(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    rows = "\n".join(f"{0.001 * i!r},{-100.0 - i % 7}" for i in range(300))
    (tmp_path / "force.csv").write_text(f"time [s],cutting_force [N]\n{rows}\n", encoding="utf-8")
    text = find_scenario_file("step_force.toml").read_text(encoding="utf-8")
    text = text.replace('kind = "step"\nforce = "-500 N"\nstart = "0.1 s"', 'kind = "file"\npath = "force.csv"')
    text = text.replace('"controllers/', f'"{scenarios_folder().as_posix()}/controllers/')
    (tmp_path / "own.toml").write_text(text, encoding="utf-8")
    assert main(["run", str(tmp_path / "own.toml"), "--json"]) == 0
    assert json.loads(capsys.readouterr().out)["following_error"]["maximum"] > 1e-7


def test_values_of_the_plant_are_set_too(capsys: pytest.CaptureFixture[str]) -> None:
    """Twice the guide's friction takes its 2π/lead part more torque; entries are called by number or by name."""
    torque = {}
    for setting in ("plant.name=x", "plant.effect.1.coulomb=120 N", "plant.effect.guide_friction.coulomb=120 N"):
        assert main(["run", "step_velocity", "--json", "--set", setting]) == 0
        torque[setting] = json.loads(capsys.readouterr().out)["motor_torque"]["rms"]
    plain, by_number, by_name = torque.values()
    # the lead of 20 mm per revolution; the rest of the torque adds to it in the rms
    assert by_number == by_name and 0.5 < (by_number - plain) / (60 * 0.02 / 6.2832) < 1.001
    for setting, message in [
        ("plant.tabel.mass=1 kg", 'unknown key "tabel"; did you mean "table"?'),
        ("plant.table.mass=-1 kg", "table.mass"),
        (
            "plant.guide_friction.coulomb=1 N",
            'unknown key "guide_friction"; it is an effect: write effect.guide_friction',
        ),
        ("table.mass=1 kg", 'unknown key "table"; write plant.table.mass'),
        ("position_gain=40 1/s", 'unknown key "position_gain"; write controller.position_gain'),
        ("plant.effect.guide.coulomb=1 N", "no entry guide; count from 1 to 3, or name one of guide_friction"),
    ]:
        assert main(["run", "step_velocity", "--set", setting]) == 2
        assert message in capsys.readouterr().err
