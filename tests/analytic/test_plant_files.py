"""Plant files: the shipped ones hold the numbers they claim, and what is appended is read back identically."""

from __future__ import annotations

import math
from pathlib import Path

import pytest
from hypothesis import given
from hypothesis import strategies as st

from feeddrive.effects.catalogue import EFFECTS
from feeddrive.errors import InputError, ValidityWarning
from feeddrive.files import plants_folder, shipped_plants
from feeddrive.plant.file.lumped_text import plant_text_with_effects
from feeddrive.plant.file.plant_file import read_plant
from tests.generator.axis import AXES, AxisParameters

BENCH = plants_folder() / "bench_axis.toml"


def _read(text: str, folder: Path):
    path = folder / "plant.toml"
    path.write_text(text, encoding="utf-8")
    return read_plant(path)


@pytest.mark.parametrize("path", [p for p in shipped_plants() if p.stem != "thermal_bench"], ids=lambda path: path.stem)
def test_every_value_of_a_shipped_plant_has_a_source(path: Path) -> None:
    plant = read_plant(path)
    for value in plant.chain.required:
        assert value.key in plant.origins or (value.may_be_zero and plant.chain.values[value.key] == 0)


@pytest.mark.parametrize("name", AXES)
def test_axes_are_those_of_the_generator(name: str) -> None:
    plant, axis = read_plant(plants_folder() / f"{name}_axis.toml"), AXES[name]
    assert plant.chain.values == {key: getattr(axis, key) for key in plant.chain.values}
    assert plant.torque_limit == axis.controller.torque_limit
    assert _friction(plant) == _friction_of(axis)


def _friction(plant) -> dict[str, float]:
    return {key: float(value) for key, value in plant.effect_values().items()}


def _friction_of(axis: AxisParameters) -> dict[str, float]:
    return {
        "guide_friction.coulomb": axis.guide_coulomb,
        "guide_friction.smoothing_velocity": axis.guide_velocity,
        "guide_friction.viscous": axis.guide_viscous,
        "nut_drag.coulomb": axis.nut_coulomb,
        "nut_drag.smoothing_speed": axis.drag_speed,
        "nut_drag.viscous": axis.nut_power,
        "bearing_drag.coulomb": axis.bearing_coulomb,
        "bearing_drag.smoothing_speed": axis.drag_speed,
        "bearing_drag.viscous": 0.0,
    }


def test_emps_holds_the_published_model() -> None:
    plant = read_plant(plants_folder() / "emps.toml")
    assert plant.chain.values == {"lead": 0.0025, "motor_inertia": 0, "screw_inertia": 0, "table_mass": 95.1089}
    assert plant.effect_values()["constant_force.force"] == -3.1648
    assert plant.controller is not None
    # The last digit of the product of gain and lead / 2 pi.
    assert plant.controller.torque_per_output == pytest.approx(35.15065188 * 0.0025 / (2 * math.pi), rel=1e-14)


def test_value_with_source_and_tolerance(tmp_path: Path) -> None:
    text = BENCH.read_text(encoding="utf-8").replace(
        'mass = "134 kg"', 'mass = { value = "134 kg", source = "weighed", tolerance = "5 %" }'
    )
    plant = _read(text, tmp_path)
    assert plant.chain.values["table_mass"] == 134
    assert plant.origins["table_mass"] == "weighed, ± 5 %"


def test_byte_order_mark_and_windows_line_ends(tmp_path: Path) -> None:
    path = tmp_path / "plant.toml"
    path.write_bytes(b"\xef\xbb\xbf" + BENCH.read_text(encoding="utf-8").replace("\n", "\r\n").encode())
    assert read_plant(path).chain.values == read_plant(BENCH).chain.values


def test_unusual_value_is_told(tmp_path: Path) -> None:
    text = BENCH.read_text(encoding="utf-8").replace('"20 mm"', '"20 m"')
    with pytest.warns(ValidityWarning, match=r"ball_screw\.lead: 20 m is unusual"):
        _read(text, tmp_path)


def test_appended_effects_are_read_back_identically(tmp_path: Path) -> None:
    added = [
        EFFECTS["torque_ripple"].of(amplitude=0.1 + 0.2, order=1 / 3, phase=-math.pi),
        EFFECTS["torque_ripple"].of(amplitude=1e-300, order=8.0, phase=0.0),
        EFFECTS["friction_vs_position"].of(position=(0.0, 0.1, 1 / 7), delta_force=(1e-7, -2 / 3, 5.0)),
        EFFECTS["constant_force"].of(force=0.0123456789),
        EFFECTS["backlash"].of(width=7.54113e-06),
    ]
    remarks = ["found in motor_torque\nat 8 per revolution \x00", "", "a # remark", "a counterbalance", "ü"]
    original = BENCH.read_text(encoding="utf-8").rstrip("\n")
    text = plant_text_with_effects(original, added, remarks)
    assert text.startswith(original)
    assert "# found in motor_torque at 8 per revolution\n" in text
    expected = read_plant(BENCH).with_effects(*added)
    assert _read(text, tmp_path).effects == expected.effects


def test_appending_nothing_changes_nothing() -> None:
    assert plant_text_with_effects("x = 1", []) == "x = 1"


def test_inline_effects_cannot_be_appended_to() -> None:
    with pytest.raises(InputError, match=r"write the effects of the plant as \[\[effect\]\]"):
        plant_text_with_effects("effect = []\n", [EFFECTS["payload"].of(mass=1.0)])


@given(st.floats(min_value=-1e12, max_value=1e12), st.text(max_size=40))
def test_any_value_and_remark_survive(tmp_path_factory: pytest.TempPathFactory, force: float, remark: str) -> None:
    effect = EFFECTS["constant_force"].of(force=force)
    text = plant_text_with_effects(BENCH.read_text(encoding="utf-8"), [effect], [remark])
    plant = _read(text, tmp_path_factory.mktemp("plant"))
    assert plant.effects[-1].values["force"] == force
