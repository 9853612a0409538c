"""Declared values as nuisance coordinates: the marginal likelihood, tolerances, and the plant with other values."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest

from feeddrive.diagnosis.calibration.calibration import Calibration, whitener
from feeddrive.diagnosis.calibration.declared import CalibratedValue, as_effect, calibrated_values, with_values
from feeddrive.diagnosis.calibration.stated import given_back, is_within_tolerance, said_by_effects
from feeddrive.diagnosis.likelihood.problem import Problem
from feeddrive.diagnosis.likelihood.tolerances import MASS, deviation_of
from feeddrive.diagnosis.motion.prediction import AxisPredictor
from feeddrive.diagnosis.motion.preparing import prepare
from feeddrive.effects.base import Port
from feeddrive.effects.chain.payload import Payload
from feeddrive.effects.chain.stiffness_deviation import StiffnessDeviation
from feeddrive.effects.friction.friction_deviation import FrictionDeviation
from feeddrive.effects.source.constant_force import ConstantForce
from feeddrive.files import plants_folder
from feeddrive.plant.file.plant_file import read_plant
from feeddrive.plant.plant import Plant
from tests.generator.drawn_drives import drawn_drive
from tests.recovery.rigid_runs import MASS as RIGID_MASS
from tests.recovery.rigid_runs import PLANT, Truth, rigid_run

RANDOM = np.random.default_rng(3)


def test_whitened_square_is_that_of_the_marginal_likelihood() -> None:
    columns, rows, variance = RANDOM.standard_normal((40, 3)) * [1.0, 30.0, 0.01], RANDOM.standard_normal(40), 1.7
    known = whitener(columns, np.zeros(3), variance)
    covariance = np.eye(40) + columns @ columns.T / variance
    white = known.applied(rows)
    assert white @ white == pytest.approx(rows @ np.linalg.solve(covariance, rows), rel=1e-9)


def test_most_likely_values_do_not_depend_on_where_the_slopes_were_taken() -> None:
    columns, truth = RANDOM.standard_normal((200, 2)), np.array([0.4, -1.1])
    measured = columns @ truth
    for start in (np.zeros(2), np.array([2.0, 1.0])):
        known = whitener(columns, start, 1e-6)
        found = known.most_likely(measured - columns @ start)
        assert found == pytest.approx(truth, abs=1e-6)  # a prior of 1e-6 of the information of 200 rows moves no more


@pytest.mark.parametrize(
    ("source", "share"),
    [("catalogue", 0.05), ("assumed: steel", 0.30), ("measured by weighing", 0.02), ("simulated axis", 0.0)],
)
def test_tolerance_of_a_mass_by_its_source(source: str, share: float) -> None:
    assert MASS.usual(source) == share


def plant_of(text: str, folder: Path):  # type: ignore[no-untyped-def]
    path = folder / "plant.toml"
    path.write_text(text, encoding="utf-8")
    return read_plant(path)


def test_simulated_plants_are_exact(tmp_path: Path) -> None:
    assert calibrated_values(read_plant(plants_folder() / "bench_axis.toml")) == ()


def test_written_tolerances_come_first(tmp_path: Path) -> None:
    text = PLANT.replace(f'mass = "{RIGID_MASS} kg"', f'mass = {{ value = "{RIGID_MASS} kg", tolerance = "6 kg" }}')
    known = {value.key: value for value in calibrated_values(plant_of(text, tmp_path))}
    assert known["table_mass"].deviation == pytest.approx(deviation_of(6 / RIGID_MASS))
    assert known["table.coulomb"].tolerance == pytest.approx(0.30)


def test_every_value_of_a_machine_of_parts_is_moved_alone(tmp_path: Path) -> None:
    plant = plant_of(drawn_drive(5), tmp_path)
    values = calibrated_values(plant)
    for place, value in enumerate(values):
        coordinates = np.zeros(len(values))
        coordinates[place] = 1.0
        moved = with_values(plant, values, coordinates)
        chain = {key for key, number in moved.chain.values.items() if number != plant.chain.values[key]}
        effects = [one for one, was in zip(moved.effects, plant.effects, strict=False) if one.values != was.values]
        assert chain == ({value.key} & set(plant.chain.values))
        assert bool(effects) == ("." in value.key)
        assert (len(moved.effects) > len(plant.effects)) == (value.key == "torque_constant")


def test_the_effect_that_names_a_value_does_the_same(tmp_path: Path) -> None:
    plant = plant_of(drawn_drive(5), tmp_path)
    named: list[CalibratedValue] = [value for value in calibrated_values(plant) if value.name]
    assert {value.name for value in named} >= {"payload", "inertia_deviation", "stiffness_deviation"}
    for value in named:
        if value.name == "friction_deviation":
            continue  # another effect on top, not another value of the chain
        named_plant = plant.with_effects(as_effect(plant, value, 2.0))
        moved = with_values(plant, [value], np.array([2.0]))
        assert named_plant.chain_values()[value.key] == pytest.approx(moved.chain.values[value.key], rel=1e-12)


def beside(plant: Plant, coordinates: np.ndarray) -> Problem:
    """A problem of no recording, its declared values at these coordinates."""
    return Problem(plant, (), AxisPredictor(), Calibration(calibrated_values(plant), coordinates, {}, 1.0))


def test_a_declared_value_that_an_effect_says_is_fitted_by_it_alone_and_the_machine_stays(tmp_path: Path) -> None:
    plant = plant_of(PLANT, tmp_path)
    problem = beside(plant, RANDOM.standard_normal(len(calibrated_values(plant))))
    before = problem.machine((FrictionDeviation.of(Port.TABLE, viscous_factor=0.8), Payload.of(mass=3.0)))
    left, effects = said_by_effects(
        problem, [FrictionDeviation.of(Port.TABLE, viscous_factor=0.8), Payload.of(mass=3.0)]
    )
    assert left.calibration is not None
    assert {one.key for one in left.calibration.values} == {"table.smoothing_velocity", "torque_constant"}
    after = left.machine(effects)
    recorded = prepare(rigid_run("a", Truth(), seconds=6.0), plant, 1.0)
    torques = [AxisPredictor().predict(one, recorded)["motor_torque"] for one in (before, after)]
    assert torques[1] == pytest.approx(torques[0], rel=1e-9, abs=1e-9)


def test_a_value_given_back_is_as_declared_and_the_others_stay(tmp_path: Path) -> None:
    plant = plant_of(drawn_drive(5), tmp_path)
    problem = beside(plant, RANDOM.standard_normal(len(calibrated_values(plant))))
    assert problem.calibration is not None
    was = dict(zip((one.key for one in problem.calibration.values), problem.calibration.coordinates, strict=True))
    nut = StiffnessDeviation.of(None, "nut", factor=0.5)
    without, _ = said_by_effects(problem, [nut])
    again = given_back(without, nut).calibration
    assert again is not None
    now = dict(zip((one.key for one in again.values), again.coordinates, strict=True))
    assert now == {**was, "nut_stiffness": 0.0}


def test_an_effect_within_the_tolerance_of_a_declared_value_is_no_lack_of_the_plant(tmp_path: Path) -> None:
    plant = plant_of(PLANT, tmp_path)
    friction, mass = 1.30, 0.05 * RIGID_MASS  # tolerances of a catalogue
    assert is_within_tolerance(FrictionDeviation.of(Port.TABLE, viscous_factor=0.99 * friction), plant)
    assert not is_within_tolerance(FrictionDeviation.of(Port.TABLE, viscous_factor=1.01 * friction), plant)
    assert is_within_tolerance(Payload.of(mass=0.99 * mass), plant)
    assert not is_within_tolerance(Payload.of(mass=1.01 * mass), plant)
    assert not is_within_tolerance(Payload.of(mass=-RIGID_MASS), plant)
    assert is_within_tolerance(ConstantForce.of(force=1.0), plant) is None


def test_a_deviation_joined_with_a_declared_value_stays_in_its_range(tmp_path: Path) -> None:
    """Both may be within theirs, and their product is not: a stiffness of 18 times the declared, which is 1.3 times."""
    plant = plant_of(drawn_drive(5), tmp_path)
    values = calibrated_values(plant)
    stiffer = [np.log(1.3) / one.deviation if one.place == "nut" else 0.0 for one in values]
    nut = StiffnessDeviation.of(None, "nut", factor=18.0)
    problem, (joined,) = said_by_effects(beside(plant, np.array(stiffer)), [nut])
    assert joined.values["factor"] == StiffnessDeviation.parameter("factor").maximum
    problem.machine([joined])  # is a machine
