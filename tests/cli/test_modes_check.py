"""`feeddrive modes` and `feeddrive check`, and slips in catalogue values, as a user types them."""

from __future__ import annotations

import json
from pathlib import Path

import pytest

from feeddrive.cli.main import main
from feeddrive.files import plants_folder
from tests.analytic.screw_fem import ScrewDrive, frequencies


def _edited(folder: Path, name: str, *changes: tuple[str, str]) -> str:
    text = (plants_folder() / f"{name}.toml").read_text(encoding="utf-8")
    for old, new in changes:
        assert old in text
        text = text.replace(old, new, 1)
    path = folder / "machine.toml"
    path.write_text(text, encoding="utf-8")
    return str(path)


def test_modes_along_the_stroke(capsys: pytest.CaptureFixture[str]) -> None:
    assert main(["modes", "kimm_testbed"]) == 0
    shown = capsys.readouterr().out
    # Finite elements, nut at 100 and at 1100 mm; the digest of paper 004 has 229 and 157 Hz held, 272 and 173 Hz free.
    drive = ScrewDrive(elements=300)
    true = [frequencies(drive, z, braked=held, count=1)[0] for z in (0.1, 1.1) for held in (True, False)]
    for number in (f"{frequency:.1f}" for frequency in true):
        assert number in shown


def test_modes_at_positions_as_json(capsys: pytest.CaptureFixture[str]) -> None:
    assert main(["modes", "kimm_testbed", "--at", "464mm", "--at", "0.1 m", "--json"]) == 0
    content = json.loads(capsys.readouterr().out)
    assert content["positions"] == [0.464, 0.1]
    assert content["held"][0][0] == pytest.approx(185.6, abs=0.3)
    assert content["free"][0][0] == pytest.approx(209, abs=0.6)


def test_modes_into_a_folder(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    out = tmp_path / "deep" / "modes"
    assert main(["modes", "hsr_axis", "--out", str(out)]) == 0
    assert json.loads((out / "modes.json").read_text(encoding="utf-8"))["format"] == "feeddrive-modes/1"
    assert (out / "modes.png").read_bytes().startswith(b"\x89PNG")


def test_modes_of_structures_without_position(capsys: pytest.CaptureFixture[str]) -> None:
    assert main(["modes", "bench_axis"]) == 0
    assert "189.5" in capsys.readouterr().out
    assert main(["modes", "emps"]) == 0
    assert "nothing is elastic" in capsys.readouterr().out


@pytest.mark.parametrize(
    ("place", "told"),
    [("2 m", "outside the stroke"), ("250", "bare number"), ("1 kg", "does not measure a length")],
)
def test_modes_at_an_impossible_place(place: str, told: str, capsys: pytest.CaptureFixture[str]) -> None:
    assert main(["modes", "kimm_testbed", "--at", place]) == 2
    assert told in capsys.readouterr().err


@pytest.mark.parametrize("name", ["kimm_testbed", "hsr_axis", "vertical_axis", "bench_axis", "emps"])
def test_check_of_shipped_machines(name: str, capsys: pytest.CaptureFixture[str]) -> None:
    assert main(["check", name]) == 0
    shown = capsys.readouterr()
    assert "no warnings" in shown.out and shown.err == ""


def test_check_tells_value_limit_and_source(capsys: pytest.CaptureFixture[str]) -> None:
    assert main(["check", "vertical_axis", "--position-gain", "300 1/s", "--json"]) == 0
    content = json.loads(capsys.readouterr().out)
    assert content["warnings"] == 1
    rules = {rule["rule"]: rule for rule in content["rules"]}
    gain = rules["first natural frequency in Hz, position gain in 1/s"]
    assert gain["verdict"] == "warning" and gain["limit"] == 300 and gain["sense"] == "at_least"
    dn = rules["DN: ball circle times speed"]
    # 41.2 mm at 24 m/min over 10 mm.
    assert dn["value"] == pytest.approx(0.0412 * 0.4 / 0.01 * 2 * 3.141592653589793, rel=1e-9)


@pytest.mark.parametrize(
    ("old", "new", "rule"),
    [
        ('max_velocity = "24 m/min"', 'max_velocity = "40 m/min"', "DN"),
        ('holding_torque = "14 N m"', 'holding_torque = "0.5 N m"', "torque of the weight"),
        ('max_acceleration = "5 m/s^2"', 'max_acceleration = "20 m/s^2"', "motor torque"),
        ('static_rating = "95 kN"', 'static_rating = "9.5 kN"', "static safety of the ball screw"),
        ('value = 0.02, source = "assumed: steel', 'value = 0.2, source = "assumed: steel', "damping ratio"),
    ],
)
def test_check_warns(old: str, new: str, rule: str, tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    assert main(["check", _edited(tmp_path, "vertical_axis", (old, new)), "--json"]) == 0
    rules = json.loads(capsys.readouterr().out)["rules"]
    assert any(found["rule"].startswith(rule) and found["verdict"] == "warning" for found in rules)


SLIPS = {
    "lead in metres": ('lead = "20 mm"', 'lead = "20 m"', ["ball_screw.lead", "not possible", "0.1 mm", "500 mm"]),
    "diameter in metres": ('diameter = "40 mm"', 'diameter = "40 m"', ["ball_screw.diameter", "not possible"]),
    "nut in N/m": ('"1499 N/µm"', '"1499 N/m"', ["nut.axial_stiffness", "not possible", "0.1 N/µm"]),
    "bearing in N/mm": ('"780 N/µm"', '"780 N/mm"', ["bearing, near.axial_stiffness", "unusual", "10 N/µm"]),
    "mass in grams": ('mass = "134 kg"', 'mass = "134 g"', ["table.mass", "unusual", "0.2 kg"]),
    "coupling as a torque": ('"27000 N m/rad"', '"27000 N m"', ["coupling.torsional_stiffness", "N m/rad"]),
    "ratio as a number in per cent": ("value = 0.03", "value = 3", ["damping.ratio", "0 to 1"]),
    "unknown support": ('"fixed-supported"', '"fixed-suported"', ["support.kind", 'did you mean "fixed-supported"']),
    "far bearing missing": ('"fixed-supported"', '"fixed-fixed"', ["fixed-fixed needs a bearing at the far end"]),
    "unknown part key": ("shaft_stiffness", "shaft_stifness", ["motor", 'did you mean "shaft_stiffness"']),
    "no coupling section": ("[coupling]", "[couplings]", ['"couplings"', 'did you mean "coupling"']),
    "stroke off the screw": ('"1000 mm"]', '"1100 mm"]', ["table.stroke", "not on the screw", "1100 mm"]),
    "stroke reversed": ('["0 mm", "1000 mm"]', '["1000 mm", "0 mm"]', ["table.stroke", "ascending"]),
    "root above nominal": ('diameter = "40 mm"', 'diameter = "40 mm"\nroot_diameter = "44 mm"', ["exceeds"]),
    "three elements": ("density =", "elements = 3\ndensity =", ["ball_screw.elements", "elements = 1"]),
    "belt and gear": ("[support]", "[belt]\n[gear]\n[support]", ["belt and gear", "keep the one"]),
    "unknown nut key": ("[nut]", "[nut]\nsource2 = 1", ["nut", "source2"]),
}


@pytest.mark.parametrize(("old", "new", "told"), SLIPS.values(), ids=SLIPS)
def test_slips_are_refused_or_flagged_in_one_line(
    old: str, new: str, told: list[str], tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    path = _edited(tmp_path, "kimm_testbed", (old, new))
    status = main(["check", path])
    shown = capsys.readouterr().err
    assert shown.startswith(("error: ", "warning: ")) and (status == 2) == shown.startswith("error: ")
    assert path in shown
    assert status == 0 or shown.count("\n") == 1
    for words in told:
        assert words in shown


def test_show_tells_what_is_computed_and_what_is_declared(capsys: pytest.CaptureFixture[str]) -> None:
    assert main(["show", "kimm_testbed", "--at", "464mm"]) == 0
    shown = capsys.readouterr().out
    for words in ("computed from motor shaft, coupling", "assumed", "Parts as declared", "table at 464 mm", "185.6 Hz"):
        assert words in shown


@pytest.mark.parametrize(
    ("name", "block", "told"),
    [
        ("emps", '[nut]\naxial_stiffness = "900 N/µm"', "rigid machine has neither springs"),
        ("emps", "[damping]\nratio = 0.02", "rigid machine has neither springs"),
        ("bench_axis", '[support]\nkind = "fixed-fixed"', "ball_screw"),
        ("bench_axis", "[damping]\nratios = 0.02", 'did you mean "ratio"'),
        ("kimm_testbed", "[belt]\nratio = 2", "torsional_stiffness"),
        ("kimm_testbed", '[guide]\ncarriage = "HSR-30R"\ncarriages = 4', "guide and guide_friction"),
        ("hsr_axis", '[brake]\nholding_torque = "20 N m"', "brake.stiffness: is missing"),
    ],
)
def test_sections_that_cannot_be(
    name: str, block: str, told: str, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    text = (plants_folder() / f"{name}.toml").read_text(encoding="utf-8")
    path = tmp_path / "machine.toml"
    path.write_text(f"{text}\n{block}\n", encoding="utf-8")
    assert main(["show", str(path)]) == 2
    shown = capsys.readouterr().err
    assert shown.startswith(f"error: {path}") and shown.count("\n") == 1 and told in shown


def test_check_lists_what_is_missing_alone(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    given = _edited(tmp_path, "bench_axis", ("[table]", '[table]\nmax_velocity = "20 m/min"'))
    assert main(["check", given, "--json"]) == 0
    rules = {rule["rule"]: rule["source"] for rule in json.loads(capsys.readouterr().out)["rules"]}
    assert rules["motor speed"] == "needs motor.max_speed"
    assert rules["DN: ball circle times speed"] == "needs ball_screw.ball_circle"
    assert rules["screw speed, 0.8 of whirling"] == "needs the parts of the screw ([support], [bearing.near], [nut])"


def test_shapes_are_over_what_is_shown_and_a_closed_brake_is_called_so(capsys: pytest.CaptureFixture[str]) -> None:
    assert main(["show", "vertical_axis"]) == 0
    shown = capsys.readouterr().out
    rows = [line for line in shown.splitlines() if line.startswith(("│ braked ", "│ free ")) and " Hz " in line]
    assert rows and "│ held " not in shown and "motor held by its brake" in shown
    for row in rows:
        shape = [float(cell) for cell in row.strip("│").split("│")[3:]]
        assert max(shape) == 1.0  # the largest that is shown, waves inside the screw are not


def test_lumped_springs_are_named_once(capsys: pytest.CaptureFixture[str]) -> None:
    assert main(["show", "bench_axis"]) == 0
    shown = capsys.readouterr().out
    assert "│ torsional " in shown and "torsion, torsional" not in shown and "axial, axial" not in shown
