"""`feeddrive export` as a user types it."""

from __future__ import annotations

import json
from pathlib import Path

import pytest

from feeddrive import compiler
from feeddrive.cli.main import main
from feeddrive.files import plants_folder


def test_every_form_in_one_call(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    forms = ("ss", "mat", "json", "casadi", "c", "fmu")
    arguments = [argument for form in forms for argument in ("--to", form)]
    assert main(["export", "bench_axis", *arguments, "--at", "x=200 mm,v=3 m/min", "--out", str(tmp_path)]) == 0
    shown = capsys.readouterr()
    assert shown.err == ""
    assert "linear about x = 200 mm, v = 3 m/min" in shown.out
    assert "torque limit of 30 N m" in shown.out
    assert {path.name for path in tmp_path.iterdir()} == {
        "bench_axis_ss.py", "bench_axis.mat", "bench_axis.json", "bench_axis.casadi", "bench_axis_casadi.json",
        "bench_axis.h", "bench_axis.c", "bench_axis_selftest.c", "bench_axis.fmu",
    }  # fmt: skip


def test_answer_as_json(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    assert main(["export", "kimm_testbed", "--to", "json", "--out", str(tmp_path), "--json"]) == 0
    content = json.loads(capsys.readouterr().out)
    assert content["files"] == {"json": [str(tmp_path / "kimm_testbed.json")]}
    assert content["point"] == {"table_position": 0.5, "linear_at_velocity": 0.05, "starts_at_velocity": 0.0}


@pytest.mark.parametrize(
    ("plant", "at", "said"),
    [
        ("bench_axis", "x=0.2", "bare number"),
        ("bench_axis", "x=200 N", "length"),
        ("bench_axis", "speed=3 m/min", 'write e.g. --at "x=200 mm,v=3 m/min"'),
        ("kimm_testbed", "x=1.5 m", "choose from 0 mm to 1000 mm"),
        ("no_such_machine", "", "neither a file nor"),
    ],
)
def test_bad_input_is_one_line(
    plant: str, at: str, said: str, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    assert main(["export", plant, "--to", "json", "--at", at, "--out", str(tmp_path / "made")]) == 2
    shown = capsys.readouterr().err
    assert said in shown and shown.count("\n") == 1
    assert not (tmp_path / "made").exists()


def test_unknown_form_names_the_known_ones(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    assert main(["export", "bench_axis", "--to", "simulink", "--out", str(tmp_path)]) == 2
    assert "fmu" in capsys.readouterr().err


def test_place_that_cannot_be_written(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    (tmp_path / "taken").write_text("a file")
    assert main(["export", "bench_axis", "--to", "json", "--out", str(tmp_path / "taken")]) == 2
    assert "is a file, not a folder" in capsys.readouterr().err


def test_name_that_would_break_a_comment(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    text = (plants_folder() / "bench_axis.toml").read_text(encoding="utf-8")
    path = tmp_path / "machine.toml"
    path.write_text(text.replace('name = "bench axis"', 'name = "axis */ #error \\n <é>"'), encoding="utf-8")
    arguments = [argument for form in ("ss", "c", "fmu") for argument in ("--to", form)]
    assert main(["export", str(path), *arguments, "--out", str(tmp_path / "made")]) == 0
    assert capsys.readouterr().err == ""
    header = (tmp_path / "made" / "axis_error.h").read_text(encoding="utf-8")
    assert header.splitlines()[1].startswith(" * axis * / #error")
    compile((tmp_path / "made" / "axis_error_ss.py").read_text(encoding="utf-8"), "axis_error_ss.py", "exec")


def test_without_a_compiler_the_fmu_says_so(
    tmp_path: Path, capsys: pytest.CaptureFixture[str], monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setenv("FEEDDRIVE_COMPILER", "none")
    compiler.find_compiler.cache_clear()
    try:
        assert main(["export", "bench_axis", "--to", "fmu", "--out", str(tmp_path)]) == 0
    finally:
        compiler.find_compiler.cache_clear()
    assert "no C compiler was found, it holds sources alone" in capsys.readouterr().out


def test_help_says_how_each_is_loaded(capsys: pytest.CaptureFixture[str]) -> None:
    assert main(["export", "--help"]) == 0
    shown = capsys.readouterr().out
    for text in ("casadi.Function.load", "ss(A,B,C,D)", "fmpy.simulate_fmu", "import system"):
        assert text in shown
