"""The drive in general solvers: scipy's Radau and CasADi's cvodes, called sample by sample as a controller must."""

from __future__ import annotations

import casadi as ca
import numpy as np
from _drive import LAG, SAMPLE, controller, drive
from _hand import RungeKutta
from scipy.integrate import solve_ivp

from feeddrive.plant.equations import parameter_values
from feeddrive.plant.linear import ode
from feeddrive.typing import FloatArray


def radau(hand: RungeKutta, wanted: FloatArray, tolerance: float) -> FloatArray:
    """Table position [m]; the right-hand side is the compiled one, the torque steps are the solver's restarts."""
    state, kept, control = np.zeros(12), np.zeros(2), controller()
    table = np.empty(len(wanted))
    for k, reference in enumerate(wanted):
        table[k] = state[4]
        kept, torque, _ = (
            np.array(out).ravel()
            for out in control.function(kept, reference, [state[4], state[5]], k, control.parameters)
        )
        found = solve_ivp(
            lambda _, y, u=float(torque[0]): hand.slopes(y, u), (0.0, SAMPLE), state, method="Radau", rtol=tolerance,
            atol=tolerance * 1e-3,
        )  # fmt: skip
        state = found.y[:, -1]
    return table


def cvodes(wanted: FloatArray, tolerance: float) -> FloatArray:
    """Table position [m]; integrator and controller in one graph, mapped over the samples."""
    plant, control = drive(), controller()
    equations, values = ode(plant), parameter_values(plant)
    y, u = ca.SX.sym("y", 12), ca.SX.sym("u")
    slopes, _ = equations(ca.vertcat(y[:10], y[11]), ca.vertcat(y[10], 0), values)
    problem = {"x": y, "p": u, "ode": ca.vertcat(slopes[:10], (u - y[10]) / LAG, slopes[10])}
    options = {"reltol": tolerance, "abstol": tolerance * 1e-3}
    integrate = ca.integrator("integrate", "cvodes", problem, 0.0, SAMPLE, options)
    state, fed = ca.MX.sym("state", 14), ca.MX.sym("fed", 2)
    kept, torque, _ = control.function(
        state[12:], fed[0], ca.vertcat(state[4], state[5]), fed[1], ca.DM(control.parameters)
    )
    after = ca.vertcat(integrate(x0=state[:12], p=torque)["xf"], kept)
    step = ca.Function("step", [state, fed], [after, state[4]])
    many = step.mapaccum("many", len(wanted))
    _, table = many(np.zeros(14), np.vstack([wanted, np.arange(len(wanted))]))
    return np.array(table).ravel()
