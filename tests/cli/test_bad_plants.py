"""Unusable plant files: one line that says file, key and mend; exit status 2; never a traceback."""

from __future__ import annotations

from pathlib import Path

import pytest

from feeddrive.cli.main import main
from feeddrive.files import plants_folder

BENCH = (plants_folder() / "bench_axis.toml").read_text(encoding="utf-8")

BAD = {
    "no unit": ('"20 mm"', "20", ["ball_screw.lead", "bare number", '"20 mm"']),
    "wrong dimension": ('"134 kg"', '"134 N"', ["table.mass", "does not measure a mass", "kg"]),
    "unknown unit": ('"20 mm"', '"20 mmm"', ["ball_screw.lead", "mmm", "mm"]),
    "unknown key": ('\nmass = "134', '\nmas = "134', ["table", '"mas"', 'did you mean "mass"']),
    "unknown section": ("[ball_screw]", "[ballscrew]", ['"ballscrew"', 'did you mean "ball_screw"']),
    "missing value": ('mass = "134 kg"', "", ["table.mass", "missing", 'mass = "']),
    "negative mass": ('"134 kg"', '"-134 kg"', ["table.mass", "negative", "above zero"]),
    "negative damping": ('"8650 N', '"-8650 N', ["transmission.axial_damping", "negative"]),
    "zero lead": ('"20 mm"', '"0 mm"', ["ball_screw.lead", "zero"]),
    "zero stiffness": ('"244.7 N/µm"', '"0 N/µm"', ["transmission.axial_stiffness", "zero"]),
    "unknown structure": ("three_inertias", "four_inertias", ["structure", 'did you mean "three_inertias"']),
    "unknown effect": ('"nut_drag"', '"nutdrag"', ["effect 2", 'did you mean "nut_drag"']),
    "unknown effect key": ("smoothing_velocity", "smoothing", ["guide_friction", "smoothing", "did you mean"]),
    "missing effect key": ('coulomb = "60 N"', "", ["guide_friction", "coulomb", "missing"]),
    "effect out of range": ('"60 N"', '"-60 N"', ["guide_friction", "outside its range"]),
    "impossible port": ('port = "table"', 'port = "motor"', ["guide_friction", "port", "table"]),
    "unknown channel": ('"motor_angle"', '"motor_angel"', ["sensor 2", 'did you mean "motor_angle"']),
    "sensor twice": ('"motor_torque"', '"motor_angle"', ["sensor 2", "declared twice"]),
    "broken toml": ('lead = "20 mm"', 'lead "20 mm"', ["not TOML", "line 12"]),
    "other format": ("feeddrive-plant/1", "feeddrive-plant/9", ["format", "feeddrive-plant/1"]),
    "controller": ("feeddrive-plant/1", "feeddrive-controller/1", ["is a controller file, not a plant file"]),
    "list for a value": ('"134 kg"', '["134 kg"]', ["table.mass", "list"]),
    "not a quantity": ('"134 kg"', "true", ["table.mass", "not a quantity"]),
    "not finite": ('"134 kg"', '"nan kg"', ["table.mass", "number"]),
    "value table without value": ('"134 kg"', '{ source = "x" }', ["table.mass", "no value"]),
    "bad tolerance": ('"134 kg"', '{ value = "1 kg", tolerance = "5 m" }', ["table.mass.tolerance"]),
    "section is a value": ('[table]\nmass = "134 kg"', "", ["table.mass", "missing"]),
    "effect is a table": ("[[effect]]", "[effect]", ["TOML"]),
    "rigid with stiffness": ("three_inertias", "rigid", ["transmission", "torsional_stiffness", "three_inertias"]),
    "decimal comma": ('"134 kg"', '"134,5 kg"', ["table.mass", "decimal comma", '"134.5 kg"']),
    "two commas": ('"134 kg"', '"1,134,5 kg"', ["table.mass", "decimal comma", "nothing between thousands"]),
}


@pytest.mark.parametrize(("old", "new", "told"), BAD.values(), ids=BAD)
def test_one_line_that_says_where_and_how_to_mend(
    old: str, new: str, told: list[str], tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    assert old in BENCH
    path = tmp_path / "machine.toml"
    path.write_text(BENCH.replace(old, new), encoding="utf-8")
    _refused(path, told, capsys)


@pytest.mark.parametrize(
    ("block", "told"),
    [
        (
            '[[effect]]\nname = "friction_vs_position"\nposition = ["0 mm", "1 mm"]\ndelta_force = ["1 N"]',
            ["equal length"],
        ),
        (
            '[[effect]]\nname = "friction_vs_position"\nposition = ["1 mm", "0 mm"]\ndelta_force = ["1 N", "1 N"]',
            ["ascend"],
        ),
        ('[[effect]]\nport = "table"', ["effect 4", "name", "missing"]),
        ('[[effect]]\nname = "friction_deviation"\nport = "motor"', ["port", "table, screw"]),
        ('[controller]\nkind = "pid"', ["controller", "kind", "position_velocity"]),
        ('[controller]\nkind = "position_velocity"', ["controller", "position_gain", "missing"]),
    ],
)
def test_bad_block_at_the_end(block: str, told: list[str], tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    path = tmp_path / "machine.toml"
    path.write_text(f"{BENCH}\n{block}\n", encoding="utf-8")
    _refused(path, told, capsys)


def test_friction_effect_without_declared_friction(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    path = tmp_path / "machine.toml"
    head = BENCH[: BENCH.index("[[effect]]")]
    block = '[[effect]]\nname = "stribeck"\ndelta_force = "5 N"\nvelocity = "5 mm/s"\n'
    path.write_text(head + block, encoding="utf-8")
    _refused(path, ["stribeck", "declares none", "guide_friction"], capsys)


@pytest.mark.parametrize("content", [b"\xff\xfe\x00", b"", b"[" * 5000, b"x = " + b"9" * 5000, b"\x00"])
def test_what_is_no_plant_file(content: bytes, tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    path = tmp_path / "machine.toml"
    path.write_bytes(content)
    _refused(path, [], capsys)


def _refused(path: Path, told: list[str], capsys: pytest.CaptureFixture[str]) -> None:
    assert main(["show", str(path)]) == 2
    shown = capsys.readouterr()
    assert shown.out == ""
    assert shown.err.startswith(f"error: {path}")
    assert shown.err.count("\n") == 1
    for words in told:
        assert words in shown.err
