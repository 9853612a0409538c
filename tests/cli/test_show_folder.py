"""`feeddrive show` with a folder to write to, and the rated life that it tells."""

from __future__ import annotations

import json
from pathlib import Path

import pytest

from feeddrive.cli.main import main

PNG = b"\x89PNG"


def test_folder_holds_json_and_figures(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    folder = tmp_path / "hsr"
    assert main(["show", "hsr_axis", "--out", str(folder)]) == 0
    shown = capsys.readouterr()
    assert "combined stiffness" in shown.out and shown.err == ""
    assert sorted(path.name for path in folder.iterdir()) == [
        "show.json", "stiffness_position.png", "stiffness_shares.png",
    ]  # fmt: skip
    assert all((folder / f"stiffness_{name}.png").read_bytes().startswith(PNG) for name in ("position", "shares"))
    content = json.loads((folder / "show.json").read_text(encoding="utf-8"))
    assert main(["show", "hsr_axis", "--json"]) == 0
    assert json.loads(capsys.readouterr().out) == content


def test_machine_without_parts_has_no_figures(tmp_path: Path) -> None:
    assert main(["show", "bench_axis", "--out", str(tmp_path)]) == 0
    assert [path.name for path in tmp_path.iterdir()] == ["show.json"]


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
