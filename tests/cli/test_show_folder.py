"""`feeddrive show` with a folder to write to, and the rated life that it tells."""

from __future__ import annotations

import json
import math
from pathlib import Path

import numpy as np
import pytest

from feeddrive.cli.main import main
from feeddrive.recording import Recording
from feeddrive.recording.files.writing import write_recording

PNG = b"\x89PNG"


def test_folder_holds_json_and_figures(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    folder = tmp_path / "hsr"
    assert main(["show", "hsr_axis", "--out", str(folder)]) == 0
    shown = capsys.readouterr()
    assert "combined stiffness" in shown.out and shown.err == ""
    pictures = ["guide_shares", "screw_efficiency", "screw_life", "stiffness_position", "stiffness_shares"]
    assert sorted(path.name for path in folder.iterdir()) == sorted(["show.json", *(f"{one}.png" for one in pictures)])
    assert all((folder / f"{name}.png").read_bytes().startswith(PNG) for name in pictures)
    assert "not drawn" not in shown.out
    content = json.loads((folder / "show.json").read_text(encoding="utf-8"))
    assert main(["show", "hsr_axis", "--json"]) == 0
    assert json.loads(capsys.readouterr().out) == content


def test_machine_without_parts_has_no_figures_and_says_what_they_need(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    assert main(["show", "bench_axis", "--out", str(tmp_path)]) == 0
    shown = capsys.readouterr().out
    assert shown.count("not drawn: ") == 4 and "declare ball_screw.dynamic_rating" in shown
    assert [path.name for path in tmp_path.iterdir()] == ["show.json"]


def test_machine_of_heat_alone_gives_a_folder_too(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    assert main(["show", "thermal_bench", "--out", str(tmp_path / "heat")]) == 0
    assert "written: " in capsys.readouterr().out
    assert json.loads((tmp_path / "heat" / "show.json").read_text(encoding="utf-8"))["structure"] == "heat alone"


@pytest.mark.parametrize("command", ["show", "modes", "lump"])
def test_position_beyond_the_stroke_is_refused(command: str, capsys: pytest.CaptureFixture[str]) -> None:
    """The nut is still on its screw there (to 1100 mm), the table is not on its stroke."""
    further = ["--out", "never.toml"] if command == "lump" else []
    assert main([command, "kimm_testbed", "--at", "1050 mm", *further]) == 2
    said = capsys.readouterr().err
    assert (
        said == "error: --at: the table at 1050 mm is outside the stroke of KIMM testbed; choose from 0 mm to 1000 mm\n"
    )


def test_springs_of_a_lumped_chain_stand_once(capsys: pytest.CaptureFixture[str]) -> None:
    """Its parts are its axial and torsional stiffness, which stood twice in one column that adds up to 100 %."""
    assert main(["show", "bench_axis"]) == 0
    shown = capsys.readouterr().out
    assert shown.count("244.7 N/µm") == 2 and shown.count("1183 N/µm") == 1  # the declared value, and the stiffness


def test_file_where_the_folder_should_be_is_refused(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    (tmp_path / "taken").write_text("here", encoding="utf-8")
    assert main(["show", "hsr_axis", "--out", str(tmp_path / "taken")]) == 2
    assert "is a file" in capsys.readouterr().err
    assert (tmp_path / "taken").read_text(encoding="utf-8") == "here"


def test_life_is_told_with_its_loads(capsys: pytest.CaptureFixture[str]) -> None:
    assert main(["show", "hsr_axis"]) == 0
    shown = capsys.readouterr().out
    assert "Rated life of the ball screw" in shown and "preload alone" in shown
    assert main(["show", "hsr_axis", "--json"]) == 0
    life = json.loads(capsys.readouterr().out)["life"]
    assert [row["force"] for row in life] == [0.0, 4000.0]
    assert life[1]["nut_loads"][0] - life[1]["nut_loads"][1] == pytest.approx(4000.0, rel=1e-9)


def test_no_rating_tells_no_life(capsys: pytest.CaptureFixture[str]) -> None:
    assert main(["show", "kimm_testbed"]) == 0
    assert "Rated life" not in capsys.readouterr().out


def test_a_recording_tells_what_it_takes_of_each_nut(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    time = np.arange(0.0, 2.0, 1e-3)
    turns = 10 * (1 - np.cos(math.pi * np.clip(time / 1.8, 0.0, 1.0)))
    angle = 2 * math.pi * turns
    write_recording(Recording("stroke", time, {"motor_angle": angle}, 1e-3), tmp_path / "stroke.csv")
    asked = ["show", "hsr_axis", "--recording", str(tmp_path / "stroke.csv")]
    assert main([*asked, "--out", str(tmp_path / "out")]) == 0
    shown = capsys.readouterr().out
    assert "life of the ball screw that it takes" in shown and "billionths" in shown and "million times" in shown
    assert (tmp_path / "out" / "used_life.png").read_bytes().startswith(PNG)
    told = json.loads((tmp_path / "out" / "show.json").read_text(encoding="utf-8"))["used_life"]
    assert told["revolutions"] == pytest.approx(20.0, rel=1e-3)
    used = [20 / 1e6 * (load / 52e3) ** 3 for load in told["equivalent_loads"]]
    assert told["used"] == pytest.approx(used, rel=1e-3)
    # preload 3.6 kN, and the force of 320 kg that speed up and slow down: neither nut is far from it on average
    assert all(3400 < load < 3900 for load in told["equivalent_loads"])
    assert main(["show", "thermal_bench", "--recording", str(tmp_path / "stroke.csv")]) == 2
    assert "leave the recording out" in capsys.readouterr().err
