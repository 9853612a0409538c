"""`feeddrive read` as a person types it, and trace files given to the other commands as they are."""

from __future__ import annotations

import json
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from feeddrive.cli.main import main
from feeddrive.recording import read_recording
from tests.analytic import trace_files as made

FRF = Path(__file__).parents[1] / "data" / "traces" / "sinumerik_frf" / "freq_trace.xml.gz"
RESPONSE = "# from = motor_torque, to = motor_speed\nfrequency [Hz],magnitude [(rad/s)/(N m)],phase [deg]\n"


@pytest.fixture
def capture(tmp_path: Path) -> Path:
    """An Edge capture of one axis."""
    path = tmp_path / "capture.json"
    path.write_text(made.edge_json())
    return path


def shown(capsys: pytest.CaptureFixture[str], *words: object) -> dict[str, Any]:
    """Run with --json and return what is printed."""
    assert main(["read", *map(str, words), "--json"]) == 0
    found: dict[str, Any] = json.loads(capsys.readouterr().out)
    return found


def refused(capsys: pytest.CaptureFixture[str], *words: object) -> str:
    """Run and return the one line of the refusal."""
    assert main(["read", *map(str, words)]) == 2
    told = capsys.readouterr()
    assert told.out == ""
    assert told.err.startswith("error: ") and told.err.count("\n") == 1
    return told.err


def test_what_was_understood_is_shown(capture: Path, capsys: pytest.CaptureFixture[str]) -> None:
    assert main(["read", str(capture)]) == 0
    out = capsys.readouterr().out
    for said in ("SINUMERIK Edge capture, axis X1", "ENC_POS|1", "table_position [mm]", "250 samples are missing",
                 "1.25 N m/A", "mm/min", "part 2, the longest is read", "600 samples every 2 ms"):  # fmt: skip
        assert said in out.replace("\n", " "), said


def test_json(capture: Path, capsys: pytest.CaptureFixture[str]) -> None:
    found = shown(capsys, capture)
    assert (found["format"], found["kind"], found["axis"]) == ("feeddrive-read/1", "SINUMERIK Edge capture", "X1")
    by_name = {signal["name"]: signal for signal in found["signals"]}
    assert by_name["ENC_POS|1"]["channel"] == "table_position"
    assert by_name["ENC_POS|1"]["gaps"] == [{"behind_row": 300, "missing": 250}]
    assert by_name["CURRENT|1"]["channel"] is None
    constant = next(one for one in found["findings"] if one["about"] == "torque constant")
    assert constant["value"] == pytest.approx(made.TORQUE_CONSTANT, rel=1e-12)
    assert found["recording"]["samples"] == 600


def test_canonical_file_and_mapping_that_give_the_same_again(
    capture: Path, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    out, again = tmp_path / "rec.csv.gz", tmp_path / "again.csv.gz"
    found = shown(capsys, capture, "--out", out)
    assert found["written"] == [str(out), str(tmp_path / "rec_map.toml")]
    shown(capsys, capture, "--map", tmp_path / "rec_map.toml", "--out", again)
    first, direct, second = (read_recording(path) for path in (out, capture, again))
    assert list(first.channels) == list(second.channels) == ["table_position", "setpoint", "motor_torque"]
    for name in first.channels:
        assert np.array_equal(first[name], direct[name])
        assert np.array_equal(first[name], second[name])
    assert not (tmp_path / "again_map.toml").exists()


def test_mapping_keeps_a_turned_sign_the_lead_and_the_part(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    capture = tmp_path / "a.json"
    names, rows = made.edge_rows()
    turned = [[-cell if name in ("TORQUE|1", "CURRENT|1") else cell for name, cell in zip(names, row, strict=True)]
              for row in rows]  # fmt: skip
    capture.write_text(made.edge_json().replace(json.dumps(rows)[1:-1], "").replace("ENC_POS|1", "ENC1_POS|1"))
    tree = json.loads(capture.read_text())
    tree["Payload"] = [{"HFData": turned}]
    capture.write_text(json.dumps(tree))
    out = tmp_path / "rec.csv"
    shown(capsys, capture, "--lead", "10 mm", "--part", 1, "--out", out)
    mapping = (tmp_path / "rec_map.toml").read_text()
    assert "factor = -1.0" in mapping and "part = 1" in mapping and "rad/mm" in mapping
    shown(capsys, capture, "--map", tmp_path / "rec_map.toml", "--out", tmp_path / "b.csv")
    first, second = read_recording(out), read_recording(tmp_path / "b.csv")
    assert len(first) == 300
    place, _, _ = made.motion(first.time)
    assert first["motor_angle"] == pytest.approx(place / 10.0 * 2.0 * np.pi, rel=1e-12, abs=1e-12)
    assert first["motor_torque"] == pytest.approx(made.TORQUE_CONSTANT * made.current(first.time), rel=1e-12)
    for name in first.channels:
        # The factor of the mapping is written with all digits; the product is rounded once more.
        np.testing.assert_allclose(first[name], second[name], rtol=1e-15)


def test_questions_name_the_option_that_settles_them(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    path = tmp_path / "a.log"
    path.write_text(made.halscope_new())
    found = shown(capsys, path)
    assert found["recording"] is None
    assert "--channel 'table_position=joint.0.pos-fb [mm]'" in found["questions"][0]
    line = refused(capsys, path, "--out", tmp_path / "o.csv")
    assert "--channel 'table_position=joint.0.pos-fb [mm]'" in line
    assert not (tmp_path / "o.csv").exists() and not (tmp_path / "o_map.toml").exists()
    settled = shown(capsys, path, "--channel", "table_position=joint.0.pos-fb [mm]")
    assert settled["recording"]["samples"] == 500


def test_halsampler_needs_names_and_time(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    path = tmp_path / "a.txt"
    path.write_text(made.halsampler())
    words = (path, "--columns", "place,speed", "--sample-time", "1 ms", "--channel", "table_position=place [mm]")
    found = shown(capsys, *words, "--part", 1)
    assert found["recording"]["samples"] == 200
    assert "name every column" in refused(capsys, path, "--columns", "a,b,c")


@pytest.mark.parametrize(
    ("words", "said"),
    [
        (("--axis", "Q"), "there is no axis Q"),
        (("--channel", "torque=TORQUE|1"), 'did you mean "motor_torque"?'),
        (("--channel", "motor_torque"), "says no channel"),
        (("--channel", "motor_torque=nothing [N m]"), 'there is no signal "nothing"'),
        (("--lead", "10"), "is a bare number"),
        (("--lead", "-1 mm"), "is not above zero"),
        (("--rate", "1 mm"), "--rate"),
        (("--rate", "0 Hz"), "is not above zero"),
        (("--part", "7"), "there is no part 7"),
        (("--part", "-1"), "there is no part -1"),
        (("--out", "rec.xlsx"), "correct the ending of --out"),
        (("--figure", "a.png"), "drawn of frequency responses alone"),
    ],
)
def test_wishes_that_cannot_be_met(
    capture: Path, capsys: pytest.CaptureFixture[str], words: tuple[str, ...], said: str
) -> None:
    assert said in refused(capsys, capture, *words)


def test_frequency_response(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    out, picture = tmp_path / "r.csv", tmp_path / "r.png"
    found = shown(capsys, FRF, "--out", out, "--figure", picture)
    assert (found["kind"], found["from"], found["to"]) == ("frequency response", "motor_speed_setpoint", "motor_speed")
    assert (found["lines"], found["high"]) == (1023, 4000.0)
    assert out.read_text().startswith("# from = motor_speed_setpoint, to = motor_speed\nfrequency [Hz],magnitude [1],")
    assert picture.read_bytes().startswith(b"\x89PNG")
    again = shown(capsys, out)
    assert {key: again[key] for key in ("from", "to", "lines")} == {key: found[key] for key in ("from", "to", "lines")}


def test_canonical_recording_is_shown_too(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    path = tmp_path / "a.csv"
    path.write_text("time [s],table_position [mm]\n" + "".join(f"{i * 1e-3:.3f},{i * i}\n" for i in range(200)))
    found = shown(capsys, path)
    assert (found["kind"], found["samples"]) == ("recording", 200)


def test_bode_takes_a_frequency_response(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    path = tmp_path / "r.csv"
    path.write_text(RESPONSE + "".join(f"{f},{2.0 / f},-90\n" for f in range(1, 50)))
    out = tmp_path / "bode"
    assert main(["bode", "kimm_testbed", "--recording", str(path), "--out", str(out), "--json"]) == 0
    measured = json.loads(capsys.readouterr().out)["measured"]
    assert measured["frequency"][:2] == [1.0, 2.0]
    # 20 log10(2) of 2 (rad/s)/(N m) at 1 Hz.
    assert measured["magnitude_db"][0] == pytest.approx(6.0206, abs=1e-4)
    assert (out / "bode.json").exists()
    path.write_text(RESPONSE.replace("motor_torque", "cutting_force") + "1,2,0\n2,1,0\n3,1,0\n")
    assert main(["bode", "kimm_testbed", "--recording", str(path)]) == 2
    assert "is the response from cutting_force to motor_speed" in capsys.readouterr().err


def test_diagnose_takes_a_trace_and_refuses_a_response(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    assert main(["diagnose", "kimm_testbed", str(FRF), "--out", str(tmp_path / "o")]) == 2
    line = capsys.readouterr().err
    assert "a response from motor_speed_setpoint is not compared" in line
    path = tmp_path / "a.log"
    path.write_text(made.halscope_old())
    assert main(["diagnose", "kimm_testbed", str(path), "--out", str(tmp_path / "o")]) == 2
    assert "--channel 'table_position=joint.0.pos-fb [mm]'" in capsys.readouterr().err
    assert not (tmp_path / "o").exists()
