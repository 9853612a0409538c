"""Equations of motion written as a CasADi function and as C: the numbers and slopes of the plant itself."""

from __future__ import annotations

import ctypes
import json
import math
import subprocess
import sys
from pathlib import Path

import casadi as ca
import numpy as np
import pytest

from feeddrive.compiler import find_compiler
from feeddrive.effects.base import Value
from feeddrive.effects.catalogue import EFFECTS
from feeddrive.export.c_source import source_text
from feeddrive.export.casadi_file import casadi_function
from feeddrive.export.exported_plant import Form, write_export
from feeddrive.export.nonlinear_model import Model, model_of
from feeddrive.export.notes import changes_with_time, left_out
from feeddrive.export.point import Point
from feeddrive.plant.analysis.linear import state_space
from feeddrive.plant.analysis.ode import ode_parameters, timed_ode
from feeddrive.plant.plant import Plant
from tests.analytic.export_cases import BENCH, EMPS, LEAD_ERROR, MANY, PLANTS, TESTBED
from tests.analytic.test_effects import NEUTRAL, PLACES

MOVING = Point(0.1, 0.05)


@pytest.fixture
def compiler() -> str:
    found = find_compiler()
    if found is None:
        pytest.skip("no C compiler here")
    return found


def assert_same_poles(A: np.ndarray, plant: Plant) -> None:
    wanted = np.sort_complex(state_space(plant, 0.05, 0.1).poles())
    # The same operations in another program: rounding of the slopes (1e-16) times the condition of the poles (1e5).
    assert np.sort_complex(np.linalg.eigvals(A)) == pytest.approx(wanted, rel=1e-9, abs=1e-12 * np.max(np.abs(wanted)))


def start_of(model: Model) -> np.ndarray:
    return np.array([row.value for row in model.states])


@pytest.mark.parametrize("name", PLANTS)
def test_casadi_function_is_the_plant(name: str, tmp_path: Path) -> None:
    plant = PLANTS[name]
    paths = write_export(plant, Form.CASADI, MOVING, tmp_path)
    function, model = ca.Function.load(str(paths[0])), model_of(plant, MOVING)
    x = start_of(model) * 1.001
    given = function(time=0.3, x=x, motor_torque=1.5, cutting_force=-20.0)
    xdot, y = timed_ode(plant)(0.3, x, [1.5, -20.0], list(ode_parameters(plant).values()))
    assert np.array_equal(given["xdot"].full(), xdot.full())  # the same operations in the same order
    assert [float(given[row.name]) for row in model.outputs] == y.full()[:, 0].tolist()
    notes = json.loads(paths[1].read_text(encoding="utf-8"))
    assert notes["casadi"] == ca.__version__
    assert [row["name"] for row in notes["inputs"]] == function.name_in()[2:]
    assert [row["value"] for row in notes["inputs"]] == [function.default_in(i) for i in range(2, function.n_in())]


@pytest.mark.parametrize("name", PLANTS)
def test_casadi_function_has_the_poles_of_the_plant(name: str) -> None:
    plant = PLANTS[name]
    model = model_of(plant, MOVING)
    function, x = casadi_function(model), ca.SX.sym("x", len(model.states))
    xdot = function(x=x, motor_torque=model.inputs[0].value)["xdot"]
    A = ca.Function("A", [x], [ca.jacobian(xdot, x)])(start_of(model))
    assert_same_poles(A.full(), plant)


def test_casadi_file_loads_without_feeddrive(tmp_path: Path) -> None:
    write_export(BENCH, Form.CASADI, MOVING, tmp_path)
    program = """
import sys; sys.modules["feeddrive"] = None
import casadi
f = casadi.Function.load("bench_axis.casadi")
print(float(f(x=0, motor_torque=2.6)["xdot"][3]))
print(float(f(x=0, cutting_force=6.7, table_mass=67)["xdot"][5]))
"""
    done = subprocess.run([sys.executable, "-c", program], cwd=tmp_path, capture_output=True, text=True, check=True)
    motor, table = (float(number) for number in done.stdout.split())
    # 2.6 N m on 2.6e-3 kg m^2, 6.7 N on 67 kg; two divisions.
    assert motor == pytest.approx(1000.0, rel=1e-14)
    assert table == pytest.approx(0.1, rel=1e-14)


VALUES: dict[str, dict[str, Value]] = {
    "presliding": {"stiffness": 5e6},
    "structural_mode": {"mass": 8.0, "frequency": 70.0, "damping": 0.03},
}
"""Of effects that have no values at which they are not there."""


@pytest.mark.parametrize("name", EFFECTS)
def test_every_effect_is_exported(name: str) -> None:
    if name in {effect.name for effect in BENCH.effects}:
        plant = BENCH
    else:
        plant = BENCH.with_effects(
            EFFECTS[name].of(place=PLACES.get(name, ""), **VALUES.get(name, NEUTRAL.get(name, {})))
        )
    model = model_of(plant, Point(0.1))
    assert casadi_function(model).n_in() == 2 + 2 + len(ode_parameters(plant))
    assert f"{model.identifier}_ode(" in source_text(model)


@pytest.mark.parametrize("name", ["rigid with lead error", "along the screw", "free play", "many effects"])
def test_c_compiles_without_warning_and_agrees_with_python(name: str, tmp_path: Path, compiler: str) -> None:
    plant = PLANTS[name]
    header, source, test = write_export(plant, Form.C, MOVING, tmp_path)
    program = tmp_path / "selftest"
    command = [compiler, "-std=c99", "-Wall", "-Werror", "-O0", "-ffp-contract=off", "-o", program, source, test, "-lm"]
    subprocess.run(command, check=True)
    done = subprocess.run([program], capture_output=True, text=True)
    assert (done.returncode, done.stderr) == (0, "")
    assert "passed" in done.stdout
    for row in model_of(plant, MOVING).parameters:
        assert f" {row.name} = {row.value!r} [{row.unit}]" in header.read_text(encoding="utf-8")


def test_c_selftest_finds_a_wrong_number(tmp_path: Path, compiler: str) -> None:
    _, source, test = write_export(BENCH, Form.C, MOVING, tmp_path)
    text = source.read_text(encoding="utf-8")
    wrong = text.replace("bench_axis_function_ode(arg, res, iw, w, 0)", "(arg[2] = arg[1], 0)")
    wrong = text.replace("arg[2] = u;", "arg[2] = x;", 1)  # one argument mixed up with another
    assert wrong != text
    source.write_text(wrong, encoding="utf-8")
    program = tmp_path / "selftest"
    subprocess.run([compiler, "-o", program, source, test, "-lm"], check=True)
    done = subprocess.run([program], capture_output=True, text=True)
    assert done.returncode == 1
    assert "FAILED" in done.stdout


@pytest.mark.parametrize("name", ["three inertias", "along the screw"])
def test_slopes_in_c_have_the_poles_of_the_plant(name: str, tmp_path: Path, compiler: str) -> None:
    plant = PLANTS[name]
    _, source, _ = write_export(plant, Form.C, MOVING, tmp_path)
    model, library = model_of(plant, MOVING), tmp_path / "model.so"
    flags = ["-O0", "-ffp-contract=off", "-fPIC", "-shared"]
    subprocess.run([compiler, *flags, "-o", library, source, "-lm"], check=True)
    slopes = getattr(ctypes.CDLL(str(library)), f"{model.identifier}_slopes")
    x, u = start_of(model), np.array([row.value for row in model.inputs])
    p, A = np.array([row.value for row in model.parameters]), np.zeros((len(x), len(x)))
    pointers = [ctypes.c_void_p(array.ctypes.data) for array in (x, u, p, A)]
    assert slopes(ctypes.c_double(0.0), *pointers, None, None, None) == 0
    assert_same_poles(A, plant)


def test_header_says_what_is_left_out(tmp_path: Path) -> None:
    header = write_export(PLANTS["many effects"], Form.C, MOVING, tmp_path)[0].read_text(encoding="utf-8")
    assert "drive_delay: the motor torque acts 0.3 ms late" in header
    assert "torque limit of 30 N m" in header
    assert "effect presliding at port table" in header
    assert "effect drive_delay" not in header


def test_what_is_left_out_is_what_the_plant_has() -> None:
    assert not any("delay" in line or "limit" in line for line in left_out(EMPS))
    assert any("controller" in line for line in left_out(EMPS))


def test_time_is_followed() -> None:
    assert changes_with_time(BENCH.with_effects(*MANY))
    assert not changes_with_time(TESTBED)


def test_rigid_table_stands_where_its_travel_error_puts_it() -> None:
    plant = EMPS.with_effects(LEAD_ERROR)
    function, p = timed_ode(plant), list(ode_parameters(plant).values())
    r, x, v = EMPS.chain.radius, 0.1, 0.02
    _, y = function(0.0, [x, v], [0.0, 0.0], p)
    phase = x / r + 0.3
    assert float(y[2]) == pytest.approx(x + 2e-6 * math.sin(phase), rel=1e-14)
    assert float(y[3]) == pytest.approx(v * (1 + 2e-6 / r * math.cos(phase)), rel=1e-14)
