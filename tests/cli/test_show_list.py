"""`feeddrive list` and `feeddrive show` as a user types them."""

from __future__ import annotations

import json
from pathlib import Path

import pytest

from feeddrive.cli.main import main
from feeddrive.effects.catalogue import EFFECTS, THERMAL_EFFECTS
from feeddrive.files import plants_folder, shipped_plants


def test_list_names_plants_and_effects(capsys: pytest.CaptureFixture[str]) -> None:
    assert main(["list"]) == 0
    shown = capsys.readouterr().out
    for name in [*(path.stem for path in shipped_plants()), *EFFECTS, *THERMAL_EFFECTS]:
        assert name in shown
    assert "width [m]" in shown  # the unit is not taken for a style


def test_list_as_json(capsys: pytest.CaptureFixture[str]) -> None:
    assert main(["list", "--json"]) == 0
    content = json.loads(capsys.readouterr().out)
    assert [effect["name"] for effect in content["effects"]] == [*EFFECTS, *THERMAL_EFFECTS]
    assert {plant["name"] for plant in content["plants"]} == {path.stem for path in shipped_plants()}


@pytest.mark.parametrize("path", shipped_plants(), ids=lambda path: path.stem)
def test_show_every_shipped_plant(path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    assert main(["show", path.stem]) == 0
    shown = capsys.readouterr()
    assert ("thermal.lead" if path.stem == "thermal_bench" else "ball_screw.lead") in shown.out
    assert shown.err == ""


def test_show_tells_the_combined_stiffness_of_the_source(capsys: pytest.CaptureFixture[str]) -> None:
    assert main(["show", "bench_axis"]) == 0
    assert "202.7 N/µm" in capsys.readouterr().out  # paper 004, total


def test_show_as_json_into_a_file(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    out = tmp_path / "deep" / "axis.json"
    assert main(["show", "bench_axis", "--json", "--out", str(out)]) == 0
    assert capsys.readouterr().out == ""
    content = json.loads(out.read_text(encoding="utf-8"))
    # Paper 004 prints 202.7 N/µm, 83 and 17 %: half of the last digit.
    assert content["stiffness"]["total"] == pytest.approx(202.7e6, abs=0.05e6)
    assert content["stiffness"]["axial_share"] == pytest.approx(0.83, abs=0.005)
    assert content["values"]["table.mass"] == {
        "value": 134.0,
        "unit": "kg",
        "source": "declared axis of the simulated recordings",
    }


def test_show_as_text_into_a_file(tmp_path: Path) -> None:
    out = tmp_path / "axis.txt"
    assert main(["show", "emps", "--out", str(out)]) == 0
    assert "95.11 kg" in out.read_text(encoding="utf-8")


def test_unusual_value_becomes_one_warning_line(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    path = tmp_path / "machine.toml"
    text = (plants_folder() / "bench_axis.toml").read_text(encoding="utf-8")
    path.write_text(text.replace('"244.7 N/µm"', '"244.7 N/m"'), encoding="utf-8")
    assert main(["show", str(path)]) == 0
    shown = capsys.readouterr().err
    assert shown.startswith("warning: ") and "axial_stiffness" in shown and shown.count("\n") == 1


def test_misspelt_plant_names_the_nearest(capsys: pytest.CaptureFixture[str]) -> None:
    assert main(["show", "bench_axs"]) == 2
    assert "bench_axis" in capsys.readouterr().err
