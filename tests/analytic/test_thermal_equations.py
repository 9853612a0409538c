"""Heat as equations in time: the rows of a run, linearised, in C and as an FMU, all from one definition."""

from __future__ import annotations

import subprocess
from functools import cache
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from scipy.integrate import solve_ivp

from feeddrive.compiler import find_compiler
from feeddrive.effects.catalogue import THERMAL_EFFECTS
from feeddrive.errors import InputError
from feeddrive.interface.axis import load
from feeddrive.thermal.heat_equations import heat_equations, linear_heat
from feeddrive.thermal.reduced.parametric_model import HeatModel
from feeddrive.thermal.reduced.reduction import reduce_model
from feeddrive.thermal.run.warm_up import simulate
from tests.analytic.thermal_cases import BENCH, RPM, with_effects

EFFECTS = (
    THERMAL_EFFECTS["preload_growth"].of(coefficient=0.02),
    THERMAL_EFFECTS["heat_sink"].of(conductance=0.1, capacity=300.0),
    THERMAL_EFFECTS["motor_heat"].of(power=0.5, at_speed=750 * RPM, share_at_rest=0.3),
    THERMAL_EFFECTS["structure_growth"].of(growth=1e-6, time_constant=1800.0),
    THERMAL_EFFECTS["sensor_lag"].of(place="nut_temperature", time_constant=90.0),
)
PLANT = with_effects(*EFFECTS)
SPEED, HOUR = 500 * RPM, 3600.0


@cache
def reduced() -> HeatModel:
    """The bench, reduced, without what effects attach."""
    return reduce_model([BENCH.full_model()], BENCH.limits())[0]


def test_integrated_they_are_the_rows() -> None:
    equations = heat_equations(PLANT, reduced())
    given, p = np.array([SPEED, 23.0]), equations.values

    def rate(time: float, x: np.ndarray) -> np.ndarray:
        return np.asarray(equations.function(time, x, given, p)[0].full()[:, 0])

    start = np.zeros(len(equations.states))
    solved = solve_ivp(rate, (0, HOUR), start, "BDF", rtol=1e-9, atol=1e-9)
    shown = equations.function(HOUR, solved.y[:, -1], given, p)[1].full()[:, 0]
    model = reduced()
    for body in PLANT.attached:
        model = model.with_body(body)
    step = 2.0
    rows = simulate(PLANT, model, step, np.full(1800, SPEED), np.full(1800, 23.0))
    for channel, value in zip(equations.outputs, shown, strict=True):
        # Rows take the nut's heat and the sensor straight over 2 s: 0.05 mK; the growths follow it, 11.7e-6 a kelvin.
        assert value == pytest.approx(rows[channel][-1], abs=1e-9 if "growth" in channel else 2e-4), channel


def test_linearised_they_have_the_gain_of_the_network() -> None:
    system = linear_heat(BENCH, SPEED, reduced())
    held = reduced().at(BENCH.at_speed(SPEED))
    gain = held.gain()[[held.row("nut"), held.row("front")], held.column("ambient")]
    names = [system.output_labels.index(f"{name}_temperature") for name in ("nut", "front_bearing")]
    np.testing.assert_allclose(system.dcgain()[names, 1], gain, rtol=1e-9)  # the same matrices
    assert system.poles().real.max() < 0


def test_a_full_model_is_refused() -> None:
    with pytest.raises(InputError, match="too large"):
        heat_equations(BENCH, BENCH.full_model())


@pytest.mark.skipif(find_compiler() is None, reason="no C compiler: the exported C is not run")
@pytest.mark.slow
def test_exported_c_gives_the_same_numbers(tmp_path: Path) -> None:
    axis = load("thermal_bench")
    _, source, test = axis.export("c", tmp_path)
    program = tmp_path / "selftest"
    command = [str(find_compiler()), "-Wall", "-ffp-contract=off", "-o", str(program), str(source), str(test), "-lm"]
    subprocess.run(command, check=True)
    done = subprocess.run([str(program)], check=False, capture_output=True, text=True)
    assert done.returncode == 0, done.stdout


@pytest.mark.skipif(find_compiler() is None, reason="no C compiler: the FMU has no binary")
@pytest.mark.slow
def test_exported_fmu_runs_as_the_rows(tmp_path: Path) -> None:
    fmpy: Any = pytest.importorskip("fmpy")
    (path,) = load("thermal_bench").export("fmu", tmp_path)
    result = fmpy.simulate_fmu(
        str(path), stop_time=HOUR, output_interval=600.0, relative_tolerance=1e-8,
        start_values={"screw_speed": SPEED, "ambient_temperature": 23.0}, output=["nut_temperature"],
    )  # fmt: skip
    rows = simulate(BENCH, reduced(), 600.0, np.full(6, SPEED), np.full(6, 23.0))
    np.testing.assert_allclose(result["nut_temperature"][1:], rows["nut_temperature"], atol=1e-3)


def test_state_space_module_is_the_linear_heat(tmp_path: Path) -> None:
    (path,) = load("thermal_bench").export("ss", tmp_path, at="v=6 m/min")
    names: dict[str, Any] = {}
    exec(path.read_text(encoding="utf-8"), names)
    wanted = linear_heat(BENCH, 0.1 / BENCH.lead)
    np.testing.assert_array_equal(names["system"].A, wanted.A)
    assert names["system"].output_labels == wanted.output_labels
    with pytest.raises(InputError, match="not written as mat"):
        load("warm_axis").export("mat", tmp_path, heat=True)
