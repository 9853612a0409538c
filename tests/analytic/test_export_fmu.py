"""The FMU, validated and run by FMPy beside the simulation engine."""

from __future__ import annotations

import zipfile
from functools import cache
from pathlib import Path
from typing import Any
from xml.etree import ElementTree as Tree

import numpy as np
import pytest

from feeddrive.compiler import find_compiler
from feeddrive.export.fmu import binary_platform, fmu_bytes
from feeddrive.export.fmu_units import exponents
from feeddrive.export.model import model_of
from feeddrive.export.point import Point
from feeddrive.plant.linear import ode_parameters, state_names, state_space
from feeddrive.plant.plant import Plant
from feeddrive.simulate.held_torque import initial_state, simulate_torque
from tests.analytic.export_cases import BENCH, PLANTS, TESTBED

fmpy = pytest.importorskip("fmpy", reason="FMPy is not installed")
if find_compiler() is None:
    pytest.skip("no C compiler here for the FMU's binary", allow_module_level=True)

SAMPLE = 0.5e-3
TIME = SAMPLE * np.arange(401)
START = 0.1

AGREEMENT = 5e-9
"""Of table positions [m], over travels of 0.7 to 4 mm: the engine's steps, a few thousand, may err by 1e-11 m each, and
the FMU's solver is asked for 1e-10. Measured: 1.3 nm at most; both go to one motion as their tolerances go to 0."""


@cache
def data_of(name: str) -> bytes:
    """The FMU of a plant that starts in motion, compiled once for all tests."""
    return fmu_bytes(model_of(PLANTS[name], Point(START, 0.05)), find_compiler())


def made(name: str, folder: Path) -> Path:
    path = folder / "model.fmu"
    path.write_bytes(data_of(name))
    return path


def torque_of(plant: Plant) -> np.ndarray:
    """Forth, back and forth again, so that friction turns and free play is crossed."""
    size = 0.02 if not plant.chain.elastic else 1.0
    return size * np.where(TIME < 0.05, 2.0, np.where(TIME < 0.12, -1.5, 0.8))


def simulated(path: Path, plant: Plant, torque: np.ndarray, **values: float) -> Any:
    """What FMPy makes of the FMU under a held torque from a table at rest, its springs without force."""
    start = {f"state.{name}": 0.0 for name in state_names(plant)}  # bristles without deflection
    start |= dict(zip(start, initial_state(plant, START, 0.0), strict=False))
    jumps = [i for i in range(1, len(TIME)) if torque[i] != torque[i - 1]]
    rows = [(0.0, torque[0]), *((TIME[i], torque[k]) for i in jumps for k in (i - 1, i)), (TIME[-1], torque[-1])]
    given = np.array([(*row, 0.0) for row in rows], [(n, float) for n in ("time", "motor_torque", "cutting_force")])
    wanted = ["motor_angle", "table_position", "table_velocity"]
    result = fmpy.simulate_fmu(
        str(path), start_values={**start, **values}, input=given, output=wanted, stop_time=TIME[-1],
        output_interval=SAMPLE, relative_tolerance=1e-10,
    )  # fmt: skip
    return result[[int(np.argmin(np.abs(result["time"] - t))) for t in TIME]]


@pytest.mark.parametrize("name", [name for name in PLANTS if name != "rigid"])
def test_fmu_is_valid_and_moves_as_the_engine_says(name: str, tmp_path: Path) -> None:
    from fmpy.validation import validate_fmu

    plant = PLANTS[name]
    path = made(name, tmp_path)
    assert validate_fmu(str(path)) == []
    effects = tuple(effect for effect in plant.effects if effect.name != "drive_delay")  # left out, as the notes say
    engine = simulate_torque(Plant(plant.name, plant.chain, effects), TIME, torque_of(plant), START)
    result = simulated(path, plant, torque_of(plant))
    assert np.ptp(engine.position) > 5e-4
    assert np.max(np.abs(result["table_position"] - engine.position)) < AGREEMENT
    # The same error at the shaft, which turns 1 / r times as far.
    assert np.max(np.abs(result["motor_angle"] - engine.motor_angle)) < AGREEMENT / plant.chain.motor_radius


def test_parameters_act(tmp_path: Path) -> None:
    """An FMU with 22 kg more on the table and without Coulomb friction moves as such a plant does."""
    from feeddrive.effects.catalogue import EFFECTS

    path = made("three inertias", tmp_path)
    loose = tuple(e.with_values(coulomb=0.0) if e.name == "guide_friction" else e for e in BENCH.effects)
    other = Plant("other", BENCH.chain, (*loose, EFFECTS["payload"].of(mass=22.0)))
    engine = simulate_torque(other, TIME, torque_of(BENCH), START)
    result = simulated(path, BENCH, torque_of(BENCH), **{"table_mass": 156.0, "guide_friction.coulomb": 0.0})
    assert np.max(np.abs(result["table_position"] - engine.position)) < AGREEMENT


@pytest.mark.parametrize("name", ["along the screw", "many effects"])
def test_directional_derivatives_have_the_poles_of_the_plant(name: str, tmp_path: Path) -> None:
    plant = PLANTS[name]
    path, n = made(name, tmp_path), len(state_names(plant))
    folder = fmpy.extract(str(path), str(tmp_path / "unpacked"))
    description = fmpy.read_model_description(folder)
    fmu = fmpy.instantiate_fmu(folder, description, "ModelExchange")
    fmu.setupExperiment(startTime=0.0)
    fmu.enterInitializationMode()
    columns = [fmu.getDirectionalDerivative(list(range(n, 2 * n)), [column], [1.0]) for column in range(n)]
    fmu.exitInitializationMode()
    with pytest.raises(Exception, match="fmi2SetReal"):  # masses are fixed once it runs
        fmu.setReal(
            [variable.valueReference for variable in description.modelVariables if variable.name == "lead"], [1]
        )
    fmu.terminate()
    fmu.freeInstance()
    wanted = np.sort_complex(state_space(plant, 0.05, START).poles())
    found = np.sort_complex(np.linalg.eigvals(np.array(columns).T))
    # Rounding of the slopes times the condition of the poles, below 1e5.
    assert found == pytest.approx(wanted, rel=1e-9, abs=1e-12 * np.max(np.abs(wanted)))


def test_variables_carry_units_and_start_values(tmp_path: Path) -> None:
    path, model = made("along the screw", tmp_path), model_of(TESTBED, Point(START, 0.05))
    description = fmpy.read_model_description(str(path))
    by_name = {variable.name: variable for variable in description.modelVariables}
    units = {"motor_torque": "N m", "cutting_force": "N", "motor_angle": "rad", "table_velocity": "m/s"}
    assert {name: by_name[name].unit for name in units} == units
    assert by_name["der(state.motor_speed)"].unit == "rad/s^2"
    for name, value in ode_parameters(TESTBED).items():
        assert float(by_name[name].start) == value
        assert by_name[name].variability == ("tunable" if "." in name else "fixed")
        assert by_name[name].unit or name == "ratio"
    assert by_name["lead"].description == TESTBED.origins["lead"]
    assert float(by_name["state.table_position"].start) == START
    assert [state.variable.name for state in description.derivatives] == [f"der(state.{r.name})" for r in model.states]


def test_units_in_base_units() -> None:
    assert exponents("N m s/rad") == {"kg": 1, "m": 2, "s": -1, "rad": -1}
    assert exponents("kg m^2") == {"kg": 1, "m": 2}
    assert exponents("N/m") == {"kg": 1, "s": -2}
    assert exponents("W/(m K)") == {"kg": 1, "m": 1, "s": -3, "K": -1}
    assert exponents("m/m") == exponents("1") == {}
    assert exponents("N m/(rad/s)^(2/3)") is None  # FMI knows whole exponents alone


def test_fmu_needs_no_python_and_brings_its_sources(tmp_path: Path) -> None:
    path = made("three inertias", tmp_path)
    folder, suffix = binary_platform()
    with zipfile.ZipFile(path) as archive:
        binary = archive.read(f"binaries/{folder}/bench_axis{suffix}")
        names = set(archive.namelist())
        root = Tree.fromstring(archive.read("modelDescription.xml"))
    assert b"python" not in binary.lower() and b"casadi.so" not in binary.lower()
    listed = {element.get("name") for element in root.iter("File")}
    assert listed == {"bench_axis.c", "fmi2_model_exchange.c"}
    assert {f"sources/{name}" for name in listed} <= names


def test_without_a_compiler_the_sources_alone(tmp_path: Path) -> None:
    from fmpy.validation import validate_fmu

    path = tmp_path / "sources.fmu"
    path.write_bytes(fmu_bytes(model_of(BENCH, Point(START)), None))
    assert validate_fmu(str(path)) == []
    with zipfile.ZipFile(path) as archive:
        assert not any(name.startswith("binaries") for name in archive.namelist())
