"""A new user's axis: `feeddrive init`, `parts` and `keys` as typed, and every command on the file at once."""

from __future__ import annotations

import json
import time
import tomllib
from pathlib import Path

import pytest

import feeddrive as fd
from feeddrive.cli.main import main

NEW = ["--screw", "32 x 10 mm", "--length", "1.2 m", "--motor", "400 W", "--guide", "25", "--mass", "80 kg"]


@pytest.fixture(scope="module")
def axis(tmp_path_factory: pytest.TempPathFactory) -> Path:
    path = tmp_path_factory.mktemp("new") / "my_axis.toml"
    started = time.monotonic()
    assert main(["init", str(path), *NEW]) == 0
    assert time.monotonic() - started < 180  # what a new user is promised; it takes seconds
    return path


def test_the_file_is_short_and_says_every_further_key(axis: Path) -> None:
    text = axis.read_text(encoding="utf-8")
    lines = [line.strip() for line in text.splitlines()]
    assert len([line for line in lines if line and not line.startswith("#")]) <= 40
    entries = tomllib.loads(text)
    assert entries["ball_screw"]["part"].startswith("R32-10") and entries["motor"]["part"] == "SGM7J-04A"
    for section in ("motor", "coupling", "ball_screw", "support", "nut", "table", "guide", "damping"):
        for key in fd.keys(f"plant.{section}").keys:
            offered = any(line.startswith(f"# {key.name} = ") for line in lines)
            elsewhere = "geometry" in key.when or "no carriage" in key.when or '"three_inertias"' in key.when
            assert key.name in entries[section] or offered or key.name == "source" or elsewhere, key.name


def test_a_key_that_is_offered_may_be_written(axis: Path, tmp_path: Path) -> None:
    """The value of a part, taken out of its comment and changed, is what the plant then has."""
    text = axis.read_text(encoding="utf-8").replace('# lead = "10 mm"', 'lead = "5 mm"')
    path = tmp_path / "changed.toml"
    path.write_text(text, encoding="utf-8")
    changed = fd.load(path)
    assert changed.plant.chain.values["lead"] == 0.005
    assert [one.rule for one in changed.check().warnings if "part" in one.rule] == ["ball_screw.lead as its part"]


def test_init_and_check_say_what_is_still_a_guess(
    axis: Path, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    assert main(["init", str(tmp_path / "again.toml"), *NEW]) == 0
    shown = capsys.readouterr().out
    for key in ("nut.preload", "damping.ratio", "coupling.part", "guide.carriage", "table.stroke"):
        assert key in shown
    assert "is still a guess" not in shown  # every guess once, in the table of the guesses
    assert main(["check", str(axis), "--json"]) == 0
    rules = [rule["rule"] for rule in json.loads(capsys.readouterr().out)["rules"]]
    guessed = {rule.removesuffix(" is still a guess") for rule in rules if rule.endswith(" is still a guess")}
    assert {"nut.preload", "damping.ratio", "table.first_nut_position", "table_position.resolution"} <= guessed
    assert all(key in shown for key in guessed)  # by the same name


def test_tune_and_run_work_on_it_at_once(
    axis: Path, tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    """Paths in --set count from the current folder, all of them."""
    monkeypatch.chdir(axis.parent)
    assert main(["tune", "my_axis.toml", "--positions", "500 mm", "--out", "tuned"]) == 0
    settings = ["plant=my_axis.toml", "controller=tuned/controller.toml", "trajectory.acceleration=1 m/s^2",
                'trajectory.targets=["60 mm", "50 mm"]', "trajectory.velocity=3 m/min"]  # fmt: skip
    typed = [word for one in settings for word in ("--set", one)]
    assert main(["run", "s_curve_positioning", *typed, "--out", str(tmp_path / "run")]) == 0
    recording = fd.read(tmp_path / "run" / "recording.csv")
    assert recording["table_position"].max() == pytest.approx(0.06, abs=1e-4)
    capsys.readouterr()
    assert main(["run", "s_curve_positioning", "--set", "plant=no_axis.toml"]) == 2
    assert "paths count from" in capsys.readouterr().err


def test_a_path_in_set_is_not_taken_from_the_folder_of_the_scenario(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    """A controller beside the scenario and one of the same name in the current folder: what is typed is the latter."""
    beside, here = tmp_path / "scenarios", tmp_path / "here"
    beside.mkdir(), here.mkdir()
    text = (fd.load("bench_axis").path.parents[1] / "scenarios" / "controllers" / "bench_axis.toml").read_text()
    (beside / "servo.toml").write_text("not a controller", encoding="utf-8")
    (here / "servo.toml").write_text(text, encoding="utf-8")
    (beside / "hold.toml").write_text(
        'format = "feeddrive-scenario/1"\nplant = "bench_axis"\ncontroller = "servo.toml"\n'
        '[trajectory]\nkind = "hold"\nposition = "1 mm"\nduration = "10 ms"\n', encoding="utf-8",
    )  # fmt: skip
    force = here / "force.csv"
    rows = [f"{row * 1e-4:.4f},{row}" for row in range(120)]
    force.write_text("\n".join(["time [s],cutting_force [N]", *rows, ""]), encoding="utf-8")
    monkeypatch.chdir(here)
    scenario = str(beside / "hold.toml")
    assert main(["run", scenario]) == 2
    assert main(["run", scenario, "--set", "controller=servo.toml"]) == 0
    with_force = (beside / "hold.toml").read_text() + '[[force]]\nkind = "file"\npath = "nowhere.csv"\n'
    (beside / "hold.toml").write_text(with_force, encoding="utf-8")
    assert main(["run", scenario, "--set", "controller=servo.toml", "--set", "force.1.path=force.csv"]) == 0
    capsys.readouterr()


@pytest.mark.slow
def test_diagnose_works_on_it_at_once(axis: Path, tmp_path: Path) -> None:
    """A short recording that the axis itself makes, with a noise as sensors have it, lacks nothing."""
    new = fd.load(axis)
    servo = fd.tune(new)
    noise = {"record.noise.motor_torque": "0.01 N m", "record.noise.table_position": "0.1 um"}
    stroke = {"trajectory.acceleration": "1 m/s^2", "trajectory.jerk": "50 m/s^3",
              "trajectory.targets": '["110 mm", "100 mm", "160 mm", "100 mm", "300 mm", "100 mm"]',
              "trajectory.velocity": '["1 m/min", "1 m/min", "3 m/min", "3 m/min", "9 m/min", "9 m/min"]'}  # fmt: skip
    run = fd.run("friction_map", plant=new, controller=servo, set={**noise, **stroke})
    found = fd.diagnose(new, run.recording)
    assert not found.effects


@pytest.mark.parametrize(
    ("options", "remedy"),
    [
        (["--screw", "32x11"], "nearest are 32 mm x 10 mm"),
        (["--screw", "32"], "write diameter x lead"),
        (["--screw", "0 x 10 mm"], "write positive values"),
        (["--screw", "32 x -10 mm"], "write positive values"),
        (["--screw", "32 x ten"], 'unknown unit "ten"'),
        (["--motor", "0 W"], "write positive values"),
        (["--motor", "2 kg"], "W"),
        (["--name", 'a"b'], "without quotation marks"),
        (["--bearing", "GWB AKD 18"], "is a coupling, not a bearing"),
        (["--preload", "much"], "does not begin with a number"),
        (["--screw", "R32-10K5"], "near are R32-10K5-FDC-28.7"),
        (["--screw", ""], "write --screw '32 x 10 mm', or a name that `feeddrive parts screw` lists"),
        (["--motor", "500 W"], "nearest are SGM7J-06A (600 W"),
        (["--motor", ""], "write --motor '400 W', or a name that `feeddrive parts motor` lists"),
        (["--mass", "80"], 'write it with its unit, e.g. "80 kg"'),
        (["--mass", "-3 kg"], "write a positive value"),
        (["--length", ""], "write --stroke '800 mm', or --length of the screw"),
        (["--length", "150 mm"], "write the --stroke too"),
        (["--stroke", "3 m"], "write a longer --length"),
        (["--guide", "26"], "write one of 15, 20, 25, 30, 35, 45, 55, 65"),
        (["--guide", "HSR-25R"], "of HSR-20R, HSR-30R the geometry is known"),
        (["--supports", "fixed-simple"], "write one of fixed-free, fixed-supported, supported-supported, fixed-fixed"),
        (["--orientation", "up"], "write one of horizontal, vertical"),
        (["--structure", "rigid"], "write one of distributed_screw, three_inertias"),
        (["--carriages", "0"], "write a whole number, such as 4"),
    ],
)
def test_every_refusal_carries_its_own_remedy(
    options: list[str], remedy: str, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    path = tmp_path / "axis.toml"
    assert main(["init", str(path), *NEW, *options]) == 2
    shown = capsys.readouterr().err
    assert remedy in shown and shown.count("\n") == 1
    assert not path.exists()


@pytest.mark.parametrize(
    "options",
    [
        ["--structure", "three_inertias", "--orientation", "vertical", "--supports", "fixed-fixed"],
        ["--screw", "25x10", "--guide", "20 mm", "--bearing", "17TAB04DF", "--coupling", "GWB AK 30"],
        ["--screw", "25x10", "--guide", "HSR-20R", "--motor", "SGMSH-20AA"],
        ["--screw", "R40-20K3-FSCDIN", "--stroke", "800 mm", "--guide", "HGH25CA"],
        ["--screw", "16x5", "--length", "400 mm", "--motor", "100 W", "--mass", "5 kg", "--guide", "15"],
        ["--screw", "63x20", "--motor", "5 kW", "--mass", "1000 kg", "--length", "3 m", "--guide", "45"],
    ],
)  # fmt: skip
def test_other_axes_are_read_too(options: list[str], tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    path = tmp_path / "axis.toml"
    status = main(["init", str(path), *NEW, *options])
    assert status == 0, capsys.readouterr().err
    made = fd.load(path)
    assert made.plant.stroke is not None and made.modes().listing().rows
    assert main(["init", str(path), *NEW]) == 2  # what is there is kept
    assert "exists already" in capsys.readouterr().err


def test_questions_are_asked_on_a_terminal(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    asked = {"Ball screw": "32 x 10 mm", "Motor": "400 W", "Mass": "80 kg", "Stroke": "800 mm", "Size": "25"}
    seen: list[str] = []

    def answer(question: str, **_: object) -> str:
        seen.append(question)
        return next(value for start, value in asked.items() if question.startswith(start))

    monkeypatch.setattr("sys.stdin.isatty", lambda: True)
    monkeypatch.setattr("typer.prompt", answer)
    path = tmp_path / "asked.toml"
    assert main(["init", str(path), "--motor", "400 W"]) == 0
    assert len(seen) == 4 and not any(question.startswith("Motor") for question in seen)
    assert fd.load(path).plant.stroke == (0.0, 0.8)


def test_parts_and_keys_as_typed(capsys: pytest.CaptureFixture[str]) -> None:
    assert main(["parts", "screw", "--diameter", "32mm", "--lead", "10mm", "--json"]) == 0
    parts = json.loads(capsys.readouterr().out)["parts"]
    assert {part["nominal_diameter"] for part in parts} == {"32 mm"} and all(part["address"] for part in parts)
    assert main(["keys", "plant.ball_screw", "--json"]) == 0
    keys = {key["key"]: key for key in json.loads(capsys.readouterr().out)["keys"]}
    assert keys["lead"]["unit"] == "m" and keys["lead"]["usual"] == "1 mm to 80 mm" and keys["lead"]["required"]
    assert main(["keys", "plant.ball_scrw"]) == 2
    assert 'did you mean "ball_screw"?' in capsys.readouterr().err
    assert main(["keys"]) == 0
    shown = capsys.readouterr().out
    assert all(kind in shown for kind in ("plant", "controller", "scenario", "mapping", "measured"))
