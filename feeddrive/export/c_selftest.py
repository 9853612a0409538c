"""A program that compares the exported C with numbers that Python computed when it was exported.

    cc -Wall -ffp-contract=off -o selftest bench_axis.c bench_axis_selftest.c -lm && ./selftest

Every number may differ by 1e-12 of full scale: the largest value that its row (of the rates and outputs) or its matrix
(of the slopes) takes at the test points. The same operations in the same order give the same bits; what is left are
the last digits of another C library's tanh or exp.
"""

from __future__ import annotations

import casadi as ca
import numpy as np

from feeddrive.export.c_source import comment, numbers
from feeddrive.export.nonlinear_model import Model, slopes_of
from feeddrive.typing import FloatArray

ALLOWED = 1e-12
"""Error over full scale."""

POINTS = 8
_SEED = 7  # any number will do; the same export gives the same file
_TRAVEL, _STRETCH, _BRISTLE = 1e-3, 1e-4, 1e-6  # about the start [m]; at 0.1 mm the springs bear their peak forces
_VELOCITY, _STRETCH_RATE = 0.1, 1e-3  # [m/s]
_TORQUE, _FORCE = 5.0, 1000.0  # [N m, N]
_VARIED = 0.02  # of every parameter


def selftest_text(model: Model) -> str:
    """Source of the program: it prints the largest deviation and returns 0 where it is allowed, 1 where not."""
    name, upper = model.identifier, model.identifier.upper()
    times, states, inputs, parameters = _points(model)
    at = times[:, None], states, inputs, parameters
    functions = (model.function, slopes_of(model, "slopes"))
    expected = [result for function in functions for result in _evaluated(function, *at)]
    scale = [_full_scale(result, by_row=index < 2) for index, result in enumerate(expected)]
    tables = {"times": times, "states": states, "inputs": inputs, "parameters": parameters}
    tables |= dict(zip(("rate", "y", "a", "b", "c", "d"), expected, strict=True))
    tables |= dict(zip(("rate_scale", "y_scale", "a_scale", "b_scale", "c_scale", "d_scale"), scale, strict=True))
    lines = [
        *comment((f"Self-test of {name}.c: deviation from what feeddrive computed, in units of full scale.",)),
        f'#include "{name}.h"',
        "#include <math.h>",
        "#include <stdio.h>",
        *(f"static const double {key}[] = {numbers(np.ravel(table).tolist())};" for key, table in tables.items()),
        f"enum {{N = {upper}_STATES, NU = {upper}_INPUTS, NY = {upper}_OUTPUTS, NP = {upper}_PARAMETERS}};",
        _PROGRAM.replace("NAME", name).replace("COUNT", str(POINTS)).replace("ALLOWED", repr(ALLOWED)),
    ]
    return "\n".join(lines)


_PROGRAM = """
static double worst = 0;

static void compare(const double *got, const double *wanted, const double *scale, int count) {
  int i;
  for (i = 0; i < count; ++i) {
    double deviation = fabs(got[i] - wanted[i]) / scale[i];
    if (!(deviation <= worst)) worst = deviation; /* also where it is not a number */
  }
}

int main(void) {
  static double r[N], o[NY], sa[N * N], sb[N * NU], sc[NY * N], sd[NY * NU];
  int k, failed = 0;
  for (k = 0; k < COUNT; ++k) {
    const double *px = states + k * N, *pu = inputs + k * NU, *pp = parameters + k * NP;
    failed |= NAME_ode(times[k], px, pu, pp, r, o);
    failed |= NAME_slopes(times[k], px, pu, pp, sa, sb, sc, sd);
    compare(r, rate + k * N, rate_scale, N);
    compare(o, y + k * NY, y_scale, NY);
    compare(sa, a + k * N * N, a_scale, N * N);
    compare(sb, b + k * N * NU, b_scale, N * NU);
    compare(sc, c + k * NY * N, c_scale, NY * N);
    compare(sd, d + k * NY * NU, d_scale, NY * NU);
  }
  failed |= !(worst <= ALLOWED);
  printf("NAME: %s, largest deviation %.1e of full scale at %d points, allowed %.0e\\n",
         failed ? "FAILED" : "passed", worst, COUNT, ALLOWED);
  return failed ? 1 : 0;
}
"""


def _points(model: Model) -> tuple[FloatArray, FloatArray, FloatArray, FloatArray]:
    """Times, states, inputs and parameters about the start, a row for each point; the first has the defaults."""
    random = np.random.default_rng(_SEED)
    plant = model.plant
    if plant is None:
        return _heat_points(model, random)
    motion = np.array(plant.chain.rigid_motion(plant.chain_values()), dtype=float)
    n, start = len(motion), np.array([row.value for row in model.states])
    scale = np.where(motion == 0, 1.0, motion)

    def about(size: float, *shape: int) -> FloatArray:
        return size * random.uniform(-1, 1, shape)

    states = np.tile(start, (POINTS, 1))
    states[:, :n] += about(_TRAVEL, POINTS, 1) * motion + about(_STRETCH, POINTS, n) * scale
    states[:, n : 2 * n] += about(_VELOCITY, POINTS, 1) * motion + about(_STRETCH_RATE, POINTS, n) * scale
    states[:, 2 * n :] += about(_BRISTLE, POINTS, len(start) - 2 * n)
    inputs = np.column_stack([about(_TORQUE, POINTS), about(_FORCE, POINTS)])
    values = np.array([row.value for row in model.parameters])
    parameters = values * (1 + about(_VARIED, POINTS, len(values)))
    parameters[0] = values
    return np.linspace(0.0, 100.0, POINTS), states, inputs, parameters


def _heat_points(model: Model, random: np.random.Generator) -> tuple[FloatArray, FloatArray, FloatArray, FloatArray]:
    """Points of a heat network: some kelvin about the start, speeds of both signs and rest, an hour's times."""
    states = np.array(model.nominal) * random.uniform(-1, 1, (POINTS, len(model.states)))
    inputs = np.array([row.value for row in model.inputs]) + random.uniform(-1, 1, (POINTS, 2)) * (100.0, 5.0)
    inputs[0, 0] = 0.0
    values = np.array([row.value for row in model.parameters])
    parameters = values * (1 + _VARIED * random.uniform(-1, 1, (POINTS, len(values))))
    parameters[0] = values
    return np.linspace(0.0, 3600.0, POINTS), states, inputs, parameters


def _evaluated(function: ca.Function, *arguments: FloatArray) -> list[FloatArray]:
    """Results at the points, each shape (points, entries) with the entries column by column."""
    results = [function(*row) for row in zip(*arguments, strict=True)]
    return [np.array([np.ravel(point[i].full(), order="F") for point in results]) for i in range(function.n_out())]


def _full_scale(values: FloatArray, by_row: bool) -> FloatArray:
    """Largest size per entry, or of the whole matrix; 1 where all is zero."""
    size = np.max(np.abs(values), axis=0) if by_row else np.full(values.shape[1], np.max(np.abs(values), initial=0.0))
    return np.where(size == 0, 1.0, size)
