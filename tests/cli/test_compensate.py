"""`feeddrive compensate` as a person types it: files, their sheets, refusals in one line, names that mean harm."""

from __future__ import annotations

import json
from pathlib import Path

import pytest

import feeddrive as fd
from feeddrive.cli.main import main
from feeddrive.compensation.compensate import Wishes, plant_table
from feeddrive.compensation.sheet import left
from tests.analytic import compensation_readers as read

ROOT = Path(__file__).resolve().parents[2]
HOSTILE = "axis; M30 *) (* % \u00e4\u00b5 $MA_X=1"
ENDS = ["--from", "0 mm", "--to", "60 mm"]


@pytest.fixture
def worn(tmp_path: Path) -> Path:
    """A bench axis with a name that means harm, backlash and a lead error."""
    text = (ROOT / "plants" / "bench_axis.toml").read_text(encoding="utf-8")
    text = text.replace('name = "bench axis"', f'name = "{HOSTILE}"')
    text = text.replace('coulomb = "60 N"', 'coulomb = "600 N"')  # which lets the predicted motion be brisk
    text += '\n[[effect]]\nname = "backlash"\nwidth = "8 um"\n'
    text += '\n[[effect]]\nname = "lead_error_cumulative"\nslope = "90 um/m"\n'
    path = tmp_path / "worn.toml"
    path.write_text(text, encoding="utf-8")
    controller = (ROOT / "scenarios" / "controllers" / "bench_axis.toml").read_text(encoding="utf-8")
    motor = controller.replace('position_feedback = "table"', 'position_feedback = "motor"')
    (tmp_path / "motor.toml").write_text(motor, encoding="utf-8")
    return path


def test_file_and_sheet_are_written(
    worn: Path, tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    monkeypatch.chdir(tmp_path)
    typed = ["compensate", "worn.toml", "--form", "sinumerik-cec", *ENDS, "--every", "5mm", "--axis", "X1"]
    typed += ["--controller", "motor.toml", "--out", "cec.ini", "--figure", "circle.png", "--json"]
    assert main(typed) == 0
    told = json.loads(capsys.readouterr().out)
    assert told["positions"][-1] == pytest.approx(0.06)
    assert told["play"] == pytest.approx(8e-6, abs=1e-7)
    assert {row["figure"].split()[0] for row in told["predicted"]} == {"ISO", "largest"}
    assert all(row["after"] < row["before"] for row in told["predicted"])
    written = (tmp_path / "cec.ini").read_bytes()
    assert written.isascii()
    assert written.count(b"M30") == 1  # in the comment of the first line alone
    tables = read.read_cec_tables(written.decode(), "X1")
    assert tables[1].at(0.0) == pytest.approx(4e-3, abs=1e-4)
    assert tables[-1].at(60.0) == pytest.approx(-4e-3 - 5.4e-3, abs=1e-4)
    sheet = (tmp_path / "cec.ini.txt").read_text(encoding="utf-8")
    for words in ("Check of one point", "MD32710", "after repair", "Friction at reversals", "wind-up"):
        assert words in sheet
    assert sheet.isprintable() or all(one.isprintable() for one in sheet if one != "\n")
    assert (tmp_path / "circle.png").read_bytes().startswith(b"\x89PNG")
    assert not list(tmp_path.glob(".*"))  # nothing half


@pytest.mark.parametrize(
    ("typed", "words"),
    [
        (["bench_axis", *ENDS], "wind-up, not play"),
        (["worn.toml"], "no stroke is declared"),
        (["worn.toml", "--form", "sinumerik"], "sinumerik-"),
        (["worn.toml", "--form", "fanuc"], 'did you mean "fanuc-parameters"?'),
        (["worn.toml", *ENDS, "--axis", "X;M30"], "no name of an axis"),
        (["worn.toml", *ENDS, "--every", "10"], "10"),
        (["worn.toml", *ENDS, "--every", "-1 mm"], "not above zero"),
        (["worn.toml", *ENDS, "--every", "1 um", "--form", "isg"], "takes 1500"),
        (["worn.toml", "--from", "0 mm"], "--from and --to belong together"),
        (["worn.toml", "--from", "60 mm", "--to", "0 mm"], "stroke (--from, --to): is not two ascending"),
        (["worn.toml", *ENDS, "--reference", "9 m"], "far off the stroke"),
        (["worn.toml", *ENDS, "--controller", str(ROOT / "scenarios/controllers/bench_axis.toml")], "reads the scale"),
        (["worn.toml", "--form", "sinumerik-temp"], "declares no heat"),
        (["thermal_bench", "--form", "isg"], "--form sinumerik-temp"),
        ([".", *ENDS], "is no diagnosis"),
        (["nowhere", *ENDS], "nowhere"),
        (["nowhere.csv", *ENDS], "nowhere.csv"),
        (["worn.toml", *ENDS, "--out", "."], "is a folder"),
        (["worn.toml", *ENDS, "--resolution", "1 pm"], "or more"),
    ],
)  # fmt: skip
def test_refusals_are_one_line_and_leave_old_files(
    typed: list[str], words: str, worn: Path, tmp_path: Path, monkeypatch: pytest.MonkeyPatch,
    capsys: pytest.CaptureFixture[str],
) -> None:  # fmt: skip
    monkeypatch.chdir(tmp_path)
    (tmp_path / "old.comp").write_text("mine")
    out = [] if "--out" in typed else ["--out", "old.comp"]
    assert main(["compensate", *typed, *out]) == 2
    error = capsys.readouterr().err.strip().splitlines()
    assert len(error) == 1
    assert words in error[0]
    assert (tmp_path / "old.comp").read_text() == "mine"
    assert not (tmp_path / "old.comp.txt").exists()


def test_sheet_comes_before_the_file(worn: Path, tmp_path: Path) -> None:
    """A disk that is full between the two leaves a sheet without its table, never a table without its sign rule."""
    from feeddrive.compensation.compensate import Wishes, plant_table
    from feeddrive.interface.compensating import Compensation

    done = Compensation(plant_table(fd.load(worn).plant, Wishes("linuxcnc", stroke=(0.0, 0.06))), "X")
    assert list(done.files)[-1] == ""
    done.save(tmp_path / "x.comp")
    assert (tmp_path / "x.comp").read_text() == done.text
    assert "COMP_FILE_TYPE = 0" in (tmp_path / "x.comp.txt").read_text()


@pytest.mark.slow
def test_heat_is_written_for_the_plc(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    out = tmp_path / "temp.st"
    assert main(["compensate", "thermal_bench", "--form", "sinumerik-temp", "--axis", "X1", "--out", str(out)]) == 0
    assert "over nut" in capsys.readouterr().out
    offset, slope, p0 = read.run_structured_text(out.read_text(), 23.0)
    assert p0 == 200.0
    assert abs(offset) < 2e-3
    assert abs(slope) < 2e-5  # cold, nothing has grown
    assert "MD32750" in (tmp_path / "temp.st.txt").read_text()


@pytest.mark.parametrize(("recorded", "told"), [((0.0, 0.06), False), ((0.0, 0.03), True), (None, False)])
def test_table_beyond_what_was_recorded_says_so(worn: Path, recorded: tuple[float, float] | None, told: bool) -> None:
    wishes = Wishes("csv", every=5e-3, stroke=(0.0, 0.06), recorded=recorded)
    lines = [line for line in left(plant_table(fd.load(worn).plant, wishes)) if line.startswith("Recorded was")]
    assert lines == ["Recorded was 0 mm to 30 mm alone: beyond it the table goes on as was found there, measured by "
                     "nobody."] * told  # fmt: skip
