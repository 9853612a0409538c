"""The FMU, validated and run by FMPy beside the simulation engine."""

from __future__ import annotations

import zipfile
from functools import cache
from pathlib import Path
from typing import Any
from xml.etree import ElementTree as Tree

import casadi as ca
import numpy as np
import pytest

from feeddrive.compiler import find_compiler
from feeddrive.effects.catalogue import EFFECTS
from feeddrive.export.fmu import beside_table, binary_platform, fmu_bytes
from feeddrive.export.fmu_description import exponents
from feeddrive.export.kinks import kinks_of
from feeddrive.export.nonlinear_model import model_of, nominals
from feeddrive.export.point import Point
from feeddrive.plant.analysis.linear import state_space
from feeddrive.plant.analysis.ode import ode_parameters, state_names
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


def start_values(plant: Plant) -> dict[str, float]:
    """A table at rest, springs without force, bristles without deflection; shafts are told beside the table."""
    n = len(plant.chain.coordinates)
    state = np.zeros(len(state_names(plant)))
    state[: 2 * n] = initial_state(plant, START, 0.0)
    state[: n - 1] -= START * np.array(plant.chain.rigid_motion(plant.chain_values()), dtype=float)[:-1]
    beside = [name if i % n == n - 1 or i >= 2 * n else f"{name}_beside_table" for i, name in
              enumerate(state_names(plant))]  # fmt: skip
    return {f"state.{name}": float(value) for name, value in zip(beside, state, strict=True)}


def simulated(path: Path, plant: Plant, torque: np.ndarray, tolerance: float = 1e-10, **values: float) -> Any:
    """What FMPy makes of the FMU under a held torque from a table at rest, its springs without force."""
    start = start_values(plant)
    jumps = [i for i in range(1, len(TIME)) if torque[i] != torque[i - 1]]
    rows = [(0.0, torque[0]), *((TIME[i], torque[k]) for i in jumps for k in (i - 1, i)), (TIME[-1], torque[-1])]
    given = np.array([(*row, 0.0) for row in rows], [(n, float) for n in ("time", "motor_torque", "cutting_force")])
    wanted = ["motor_angle", "table_position", "table_velocity"]
    result = fmpy.simulate_fmu(
        str(path), start_values={**start, **values}, input=given, output=wanted, stop_time=TIME[-1],
        output_interval=SAMPLE, relative_tolerance=tolerance,
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
    # Rounding of the slopes, taken beside the table, times the condition of the poles, below 1e5; measured 1.4e-12.
    assert found == pytest.approx(wanted, rel=1e-9, abs=1e-11 * np.max(np.abs(wanted)))


def test_variables_carry_units_and_start_values(tmp_path: Path) -> None:
    path, model = made("along the screw", tmp_path), model_of(TESTBED, Point(START, 0.05))
    description = fmpy.read_model_description(str(path))
    by_name = {variable.name: variable for variable in description.modelVariables}
    units = {"motor_torque": "N m", "cutting_force": "N", "motor_angle": "rad", "table_velocity": "m/s"}
    assert {name: by_name[name].unit for name in units} == units
    assert by_name["der(state.motor_speed_beside_table)"].unit == "rad/s^2"
    for name, value in ode_parameters(TESTBED).items():
        assert float(by_name[name].start) == value
        assert by_name[name].variability == ("tunable" if "." in name else "fixed")
        assert by_name[name].unit or name == "ratio"
    assert by_name["lead"].description == TESTBED.origins["lead"]
    assert float(by_name["state.table_position"].start) == START
    names = [f"der(state.{row.name})" for row in beside_table(model).states]
    assert [state.variable.name for state in description.derivatives] == names
    # At 50 mm/s nothing but the table moves: shafts turn with it.
    assert float(by_name["state.table_velocity"].start) == 0.05
    assert float(by_name["state.motor_speed_beside_table"].start) == pytest.approx(0.0, abs=1e-12)


WITH_KINKS = {
    "free play": BENCH.with_effects(EFFECTS["backlash"].of(width=20e-6)),
    "bristle": BENCH.with_effects(EFFECTS["presliding"].of(stiffness=2e7, damping=1e3, break_away=0.8)),
}


@pytest.mark.parametrize(
    ("name", "tolerance", "most"),
    [
        # Before there were events and states beside the table: 4525 nm and 46 nm, 165 nm and 2 nm.
        ("free play", 1e-6, 1000e-9),
        ("free play", 1e-10, 15e-9),
        ("bristle", 1e-6, 60e-9),
        ("bristle", 1e-10, 2e-9),
    ],
)
def test_solver_stops_at_kinks(name: str, tolerance: float, most: float, tmp_path: Path) -> None:
    """CVode at a coarse and a fine tolerance against the engine at a hundredth of its own, itself 8 nm right."""
    plant = WITH_KINKS[name]
    path = tmp_path / "model.fmu"
    path.write_bytes(fmu_bytes(model_of(plant, Point(START, 0.05)), find_compiler()))
    engine = simulate_torque(plant, TIME, torque_of(plant), START, tolerance=1e-13)
    result = simulated(path, plant, torque_of(plant), tolerance)
    assert np.max(np.abs(result["table_position"] - engine.position)) < most


def test_every_kink_has_an_indicator() -> None:
    """Held equations are the plant's own where the branches are taken, and smooth: no kink is left in them."""
    model = beside_table(
        model_of(WITH_KINKS["free play"].with_effects(*WITH_KINKS["bristle"].effects[-1:]), Point(START))
    )
    kinks = kinks_of(model)
    assert kinks.count >= 4  # two flanks, the direction of the bristle, its break-away
    codes = {kinks.held.instruction_id(k) for k in range(kinks.held.n_instructions())}
    assert not codes & {ca.OP_FABS, ca.OP_SIGN, ca.OP_FMAX, ca.OP_FMIN}
    generator = np.random.default_rng(3)
    p = [row.value for row in model.parameters]
    for _ in range(50):
        x = np.array([row.value for row in model.states]) + nominals(model) * generator.normal(size=len(model.states))
        u = [generator.normal(), 10 * generator.normal()]
        branches = (np.array(kinks.indicators(0.0, x, u, p)) > 0).astype(float)
        held, true = kinks.held(0.0, x, u, p, branches), model.function(0.0, x, u, p)
        for one, other in zip(held, true, strict=True):
            # Rounding of forces of 1e4 N on the smallest inertia.
            np.testing.assert_allclose(np.array(one), np.array(other), rtol=1e-9, atol=1e-6)


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
    assert listed == {"bench_axis.c", "bench_axis_events.c", "fmi2_model_exchange.c"}
    assert {f"sources/{name}" for name in listed} <= names


def test_without_a_compiler_the_sources_alone(tmp_path: Path) -> None:
    from fmpy.validation import validate_fmu

    path = tmp_path / "sources.fmu"
    path.write_bytes(fmu_bytes(model_of(BENCH, Point(START)), None))
    assert validate_fmu(str(path)) == []
    with zipfile.ZipFile(path) as archive:
        assert not any(name.startswith("binaries") for name in archive.namelist())
