"""What an axis that is not level carries hangs with its weight: a payload, a mode's mass, a corrected declared mass."""

from __future__ import annotations

import casadi as ca
import pytest

from feeddrive.diagnosis.calibration.declared import calibrated_values, with_values
from feeddrive.effects.base import Motion, Port
from feeddrive.effects.catalogue import EFFECTS
from feeddrive.files import plants_folder
from feeddrive.plant.file.plant_file import read_plant
from feeddrive.plant.friction_law import source_force
from feeddrive.plant.plant import Plant
from feeddrive.plant.structure import parameter_symbols, parameter_values

FALL = 9.80665


def pull(plant: Plant) -> float:
    """Force of all sources on the table at rest [N]."""
    symbols = parameter_symbols(plant)
    force = source_force(plant, symbols, Port.TABLE, Motion(ca.SX(0.0), ca.SX(0.0)))
    return float(ca.Function("pull", [symbols.vector], [force])(parameter_values(plant)))


@pytest.fixture(name="upright", scope="module")
def upright_axis() -> Plant:
    """A vertical axis of 260 kg with 1800 N of counterbalance."""
    return read_plant(plants_folder() / "vertical_axis.toml")


def test_weight_is_that_of_everything_that_is_carried(upright: Plant) -> None:
    declared = 260.0 * FALL - 1800.0
    assert pull(upright) == pytest.approx(declared)
    payload = EFFECTS["payload"].of(mass=40.0)
    mode = EFFECTS["structural_mode"].of(mass=12.0, frequency=40.0, damping=0.05)
    assert pull(upright.with_effects(payload)) == pytest.approx(declared + 40.0 * FALL)
    assert pull(upright.with_effects(payload, mode)) == pytest.approx(declared + 52.0 * FALL)


def test_declared_mass_that_is_corrected_brings_its_weight(upright: Plant) -> None:
    values = calibrated_values(upright)
    (place,) = [i for i, one in enumerate(values) if one.key == "table_mass"]
    heavier = [0.0] * len(values)
    heavier[place] = 1.0
    there = with_values(upright, values, heavier)  # type: ignore[arg-type]
    beyond = 260.0 * (values[place].factor(1.0) - 1)
    assert pull(there) == pytest.approx(pull(upright) + beyond * FALL)


def test_level_axis_has_no_weight_along_it() -> None:
    level = read_plant(plants_folder() / "bench_axis.toml")
    assert pull(level.with_effects(EFFECTS["payload"].of(mass=40.0))) == pytest.approx(pull(level), abs=1e-12)
