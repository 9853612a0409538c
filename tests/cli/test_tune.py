"""`feeddrive tune` as a user types it: what is recommended runs, and one line for everything that is wrong."""

from __future__ import annotations

import json
from pathlib import Path

import pytest

import feeddrive as fd
from feeddrive.cli.main import main
from feeddrive.files import find_plant, find_scenario_file


def test_recommendation_is_written_and_runs(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    out = tmp_path / "tuned"
    assert main(["tune", "bench_axis", "--payload", "0kg,50kg", "--out", str(out)]) == 0
    shown = capsys.readouterr()
    assert shown.err == ""
    for text in ("K_p", "T_n", "notch", "(m/min)/mm", "1/s", "held back by", "Margins reached", "payload 50 kg"):
        assert text in shown.out
    names = {path.name for path in out.iterdir()}
    assert names == {"controller.toml", "tune.json", "bode_velocity_open.png", "bode_position_open.png"}
    content = json.loads((out / "tune.json").read_text(encoding="utf-8"))
    assert content["format"] == "feeddrive-tune/1"
    points = content["operating_points"]
    assert points["velocity [m/s]"] == [0.0, pytest.approx(0.05)] and points["payload [kg]"] == [0.0, 50.0]
    assert len(content["reached"]) == 5  # held, no payload of the table shows
    assert points["text"] == (
        "table at 0 mm, payloads 0 kg and 50 kg, at 3 m/min, at rest without friction and at rest with the table held"
    )
    assert points["text"] in " ".join(shown.out.split())
    assert points["text"] in (out / "controller.toml").read_text(encoding="utf-8")
    for one in content["reached"]:
        for loop in ("velocity_loop", "position_loop"):
            phase, gain = one[loop]["phase_deg"], one[loop]["gain_db"]
            # a scale on a table that is held sees nothing: a margin without end
            endless = one["friction"] == "held" and loop == "position_loop"
            assert (endless and phase is None) or phase >= 45
            assert (endless and gain is None) or gain >= 8
            assert one[loop]["stable"]
    # the nonlinear machine under the recommended controller, with its feed-forward
    controller = f"controller={(out / 'controller.toml').resolve()}"
    assert main(["run", "s_curve_positioning", "--json", "--set", controller]) == 0
    ran = json.loads(capsys.readouterr().out)
    assert ran["controller"]["position_gain"]["1/s"] == pytest.approx(content["position_gain"]["1/s"])
    assert all(point["time"] is not None and point["time"] < 0.1 for point in ran["evaluations"][0]["points"])


def test_curves_of_the_open_loop_are_named_apart() -> None:
    """Two cases at rest differ by what holds the table: on one figure they must not have one name."""
    for one in fd.tune(fd.load("bench_axis"))._figures():
        names = one.figure.axes[0].get_legend_handles_labels()[1]
        assert names == ["at 3 m/min", "at rest without friction", "at rest with the table held"]
        assert len({line.get_linestyle() for line in one.figure.axes[0].get_legend().get_lines()}) == 3


def test_drive_of_a_scenario_and_json_alone(capsys: pytest.CaptureFixture[str]) -> None:
    assert main(["tune", "bench_axis", "--scenario", "step_position", "--feedback", "motor", "--json"]) == 0
    content = json.loads(capsys.readouterr().out)
    assert content["position_feedback"] == "motor"
    assert 'position_feedback = "motor"' in content["controller"] and "speed_limit" in content["controller"]


@pytest.mark.parametrize(
    ("flags", "message"),
    [
        (["--margin-phase", "45"], "45 is a bare number"),
        (["--margin-phase", "120deg"], "a phase margin of 120° is not between 0° and 90°"),
        (["--margin-phase", "89deg"], "no gain of the velocity loop keeps 89° and 8 dB in every case"),
        (["--margin-gain", "-3dB"], "a gain margin of -3 dB is not between 0 dB and 60 dB"),
        (["--position-rate", "3kHz"], "8000 Hz is no integer multiple of 3000 Hz; write 2666.66666667 Hz"),
        (["--velocity-rate", "0 Hz"], "0 Hz is not above zero"),
        (["--dead-time", "-1ms"], "-1ms is negative"),
        (["--feedback", "tabel"], 'did you mean "table"?'),
        (["--payload", "-200kg"], "leaves no mass"),
        (["--scenario", "nothing"], "neither a file nor the name of a shipped scenario"),
    ],
)
def test_what_is_wrong_is_told_in_one_line(
    flags: list[str], message: str, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    out = tmp_path / "out"
    assert main(["tune", "bench_axis", *flags, "--out", str(out)]) == 2
    shown = capsys.readouterr()
    assert shown.out == "" and shown.err.startswith("error: ") and shown.err.count("\n") == 1
    assert message in shown.err
    assert not out.exists()


def test_parameters_of_a_drive_and_what_they_change(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    now, out = tmp_path / "now.txt", tmp_path / "out"
    now.write_text("p1460[0] = 2\np1462[0] = 10\nMD32200 = 3\n", encoding="utf-8")
    assert main(["tune", "bench_axis", "--form", "sinamics", "--present", str(now), "--out", str(out)]) == 0
    shown = capsys.readouterr()
    assert shown.err == ""
    for text in (
        "What would change",
        "circle, deviation",
        "p1460[0] = ",
        "N m s/rad, speed controller P gain",
        "source:",
    ):
        assert text in shown.out
    assert (out / "sinamics.txt").read_text(encoding="utf-8") in shown.out
    assert {"retuned_step.png", "retuned_circle.png"} <= {path.name for path in out.iterdir()}
    content = json.loads((out / "tune.json").read_text(encoding="utf-8"))
    assert content["drive"]["parameters"][0] | {"value": 0} == {
        "name": "p1460[0]", "value": 0, "unit": "N m s/rad", "resolution": 1e-4,
        "meaning": "speed controller P gain", "source": content["drive"]["parameters"][0]["source"],
    }  # fmt: skip
    assert content["present"]["changes"][0]["setting"] == "K_p" and len(content["present"]["brings"]) == 3


@pytest.mark.parametrize(
    ("flags", "message"),
    [
        (
            ["--form", "fanuc"],
            "in no public page that could be read; take K_v, K_p, T_n and the filters from controller.toml",
        ),
        (["--form", "sinumeric"], '"sinumeric" is not possible'),
        (["--form", "heidenhain"], "the torque constant is not declared"),
        (["--present", "nothing.txt"], "nothing.txt: cannot be read"),
    ],
)
def test_what_is_wrong_with_a_form_is_told_in_one_line(
    flags: list[str], message: str, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    assert main(["tune", "bench_axis", *flags, "--out", str(tmp_path / "out")]) == 2
    shown = capsys.readouterr()
    assert shown.out == "" and shown.err.count("\n") == 1 and message in shown.err
    assert not (tmp_path / "out").exists()


def test_bench_page_of_a_diagnosed_axis(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    folder = tmp_path / "found"
    folder.mkdir()
    plant = find_plant("bench_axis").read_text(encoding="utf-8")
    effect = '\n[[effect]]\nname = "torque_ripple"\namplitude = "0.1 N m"\norder = 3.0\nphase = "0 rad"\n'
    (folder / "plant_after.toml").write_text(plant + effect, encoding="utf-8")
    found = {"format": "feeddrive-diagnosis/1", "effects": [{"name": "torque_ripple"}]}
    (folder / "diagnosis.json").write_text(json.dumps(found), encoding="utf-8")
    page = tmp_path / "bench.html"
    controller = str(find_scenario_file("controllers/bench_axis.toml"))
    asked = ["bench", "bench_axis", "--diagnosis", str(folder), "--scenario", controller]
    assert main([*asked, "--out", str(page)]) == 0
    assert "written: " in capsys.readouterr().out
    data = json.loads(page.read_text(encoding="utf-8").split('id="data">')[1].split("</script>")[0])
    assert data["effects"][0]["name"] == "torque_ripple" and data["effects"][0]["found"]
    assert [one["key"] for one in data["effects"][0]["sliders"]] == ["amplitude"]
    assert main(asked) == 2
    assert "--out is missing" in capsys.readouterr().err
