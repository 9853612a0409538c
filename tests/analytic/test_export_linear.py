"""Linear models written for other tools and read back by them: the same matrices, poles, names and units."""

from __future__ import annotations

import json
import runpy
import shutil
import subprocess
from pathlib import Path

import numpy as np
import pytest
from scipy.io import loadmat

from feeddrive.errors import InputError
from feeddrive.export.exported_plant import Form, write_export
from feeddrive.export.linear_model import linear_model_of
from feeddrive.export.nonlinear_model import identifier_of, parameters
from feeddrive.export.point import Point, export_point
from feeddrive.plant.analysis.linear import state_space
from feeddrive.plant.analysis.modes import free_modes
from feeddrive.plant.analysis.ode import INPUTS, OUTPUTS, ode_parameters, state_names
from feeddrive.plant.chain.chain import CHAINS
from feeddrive.plant.plant import Plant
from tests.analytic.export_cases import BENCH, PLANTS, TESTBED
from tests.claims.book import CLAIMS

POINT = Point(0.1)


def written(plant: Plant, form: Form, folder: Path, point: Point = POINT) -> Path:
    return write_export(plant, form, point, folder)[0]


def poles_of(A: object) -> np.ndarray:
    return np.sort_complex(np.linalg.eigvals(np.array(A, dtype=float)))


def assert_same_poles(A: object, plant: Plant, point: Point = POINT) -> None:
    wanted = np.sort_complex(state_space(plant, point.linearised_at, point.position).poles())
    # Numbers are written without loss, so that this is met by far; poles at zero count a thousandth of the fastest.
    sizes = np.maximum(np.abs(wanted), 1e-3 * np.max(np.abs(wanted)))
    CLAIMS["export.poles"].check(float(np.max(np.abs(poles_of(A) - wanted) / sizes)))


@pytest.mark.parametrize("name", PLANTS)
def test_json_gives_back_every_bit(name: str, tmp_path: Path) -> None:
    plant = PLANTS[name]
    content = json.loads(written(plant, Form.JSON, tmp_path).read_text(encoding="utf-8"))
    system = state_space(plant, position=0.1)
    for key in "ABCD":
        assert np.array_equal(content["linear"][key], getattr(system, key))
    assert_same_poles(content["linear"]["A"], plant)
    assert [row["name"] for row in content["linear"]["states"]] == list(state_names(plant))
    assert [row["name"] for row in content["linear"]["inputs"]] == list(INPUTS)
    assert [row["unit"] for row in content["linear"]["outputs"]] == ["rad", "rad/s", "m", "m/s"]
    assert {row["name"]: row["value"] for row in content["parameters"]} == ode_parameters(plant)
    assert all(row["unit"] for row in content["parameters"])


def test_json_holds_chain_and_modes_at_the_point(tmp_path: Path) -> None:
    content = json.loads(written(TESTBED, Form.JSON, tmp_path, Point(0.464)).read_text(encoding="utf-8"))
    values = TESTBED.chain_values()
    assert np.array_equal(content["chain"]["mass"], TESTBED.chain.mass(values, 0.464))
    assert np.array_equal(content["chain"]["stiffness"], TESTBED.chain.stiffness(values, 0.464))
    assert content["modes"]["free"]["frequencies"] == free_modes(TESTBED, 0.464).frequencies.tolist()
    assert [row["unit"] for row in content["chain"]["coordinates"]] == ["rad", "rad", "rad", "rad", "m", "m"]
    assert content["stroke"] == [0.0, 1.0]


@pytest.mark.parametrize("name", PLANTS)
def test_mat_read_by_scipy(name: str, tmp_path: Path) -> None:
    plant = PLANTS[name]
    content = loadmat(written(plant, Form.MAT, tmp_path), simplify_cells=True)
    system = state_space(plant, position=0.1)
    for key in "ABCD":
        assert np.array_equal(content[key], getattr(system, key))
    assert_same_poles(content["A"], plant)
    assert list(content["state_names"]) == list(state_names(plant))
    assert list(content["output_names"]) == list(OUTPUTS)
    assert list(content["input_units"]) == ["N m", "N"]
    assert content["point"] == {"table_position": 0.1, "table_velocity": 0.05}
    assert dict(zip(content["parameter_names"], content["parameter_values"], strict=True)) == ode_parameters(plant)


def test_mat_read_by_octave(tmp_path: Path) -> None:
    octave = shutil.which("octave-cli") or shutil.which("octave")
    if octave is None:
        pytest.skip("no Octave here")
    written(BENCH, Form.MAT, tmp_path)
    script = "load bench_axis.mat; printf('%.17g\\n', A); printf('%s\\n', state_names{1}, input_units{1});"
    done = subprocess.run([octave, "--eval", script], cwd=tmp_path, capture_output=True, text=True, check=True)
    *numbers, name, unit = done.stdout.splitlines()
    assert np.array_equal(np.array(numbers, float).reshape(6, 6).T, state_space(BENCH, position=0.1).A)
    assert (name, unit) == ("motor_angle", "N m")


@pytest.mark.parametrize("name", PLANTS)
def test_module_needs_only_python_control(name: str, tmp_path: Path) -> None:
    plant = PLANTS[name]
    path = written(plant, Form.SS, tmp_path)
    assert "feeddrive" not in "".join(line for line in path.read_text().splitlines() if not line.startswith("#"))
    module = runpy.run_path(str(path))
    system = module["system"]
    assert np.array_equal(system.A, state_space(plant, position=0.1).A)
    assert_same_poles(system.A, plant)
    assert system.state_labels == list(state_names(plant))
    assert [row[:2] for row in module["INPUTS"]] == [("motor_torque", "N m"), ("cutting_force", "N")]


def test_same_plant_gives_the_same_file(tmp_path: Path) -> None:
    first, second = (written(BENCH, Form.MAT, tmp_path / name).read_bytes() for name in ("first", "second"))
    assert first == second


def test_point_is_where_it_is_asked_for(tmp_path: Path) -> None:
    point = export_point(TESTBED, "x=800 mm, v=6 m/min")
    model = linear_model_of(TESTBED, point)
    assert (model.position, model.velocity) == (0.8, 0.1)
    at_point = {row.name: row.value for row in model.states}
    assert at_point["table_position"] == 0.8
    assert at_point["table_velocity"] == 0.1
    assert_same_poles(model.system.A, TESTBED, point)
    assert not np.array_equal(model.stiffness, linear_model_of(TESTBED, POINT).stiffness)


def test_default_point_moves_in_the_middle_of_the_stroke() -> None:
    point = export_point(TESTBED)
    assert (point.position, point.linearised_at, point.starts_at) == (0.5, 0.05, 0.0)
    assert export_point(BENCH).position == 0.0


@pytest.mark.parametrize(
    ("text", "said"),
    [
        ("x=0.2", "bare number"),
        ("x=200 mm,v=0.05", "bare number"),
        ("x=200 s", "length"),
        ("y=1 mm", "neither"),
        ("x=1 mm,x=2 mm", "twice"),
        ("x=0,2 m", "decimal comma"),
        ("x=1.2 m", "outside the stroke"),
        ("x=-1 mm", "outside the stroke"),
    ],
)
def test_unusable_point_is_refused(text: str, said: str) -> None:
    with pytest.raises(InputError, match=said) as refusal:
        export_point(TESTBED, text)
    assert refusal.value.mend


def test_every_parameter_of_every_plant_has_a_unit() -> None:
    for plant in PLANTS.values():
        assert [row.name for row in parameters(plant)] == list(ode_parameters(plant))
    known = {value.unit for chain in CHAINS.values() for value in chain.required}
    assert {row.unit for row in parameters(TESTBED) if row.of_chain} <= known


@pytest.mark.parametrize(
    ("name", "identifier"),
    [("bench axis", "bench_axis"), ("Achse 3 (X)", "achse_3_x"), ("3 axes", "plant_3_axes"), ("轴", "plant")],
)
def test_names_become_identifiers(name: str, identifier: str) -> None:
    assert identifier_of(name) == identifier


def test_torque_at_the_point_is_that_of_constant_motion() -> None:
    r, v = BENCH.chain.radius, 0.05
    friction = r * (60 + 300 * v) + 0.35 + 0.02 * (v / r) ** (2 / 3)  # of the plant file
    # The lubricant torque is smoothed at 0.01 rad/s: (0.01 / 16)^2 / 6 of it.
    assert linear_model_of(BENCH, POINT).inputs[0].value == pytest.approx(friction, rel=1e-6)
