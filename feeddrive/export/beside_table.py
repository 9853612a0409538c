"""Equations of motion in states beside the table, so that a solver's relative tolerance meets springs and not turns.

    q_i = y_i + G_i x,     y_i' likewise,     x and the bristles as they are

A shaft that stands at 30 rad, integrated to 1e-6 of that, leaves its springs uncertain by 0.1 µm, tens of newtons; the
angle by which it stands beside the table, microradians, is integrated to 1e-6 of itself.

| symbol | meaning | unit |
|---|---|---|
| q, x | coordinates of the chain, and its last one, the table position | rad, m |
| G | motion of the chain where nothing is stretched, per travel of the table | rad/m, 1 |
| y | what a coordinate has beyond G x | rad, m |
"""

from __future__ import annotations

from dataclasses import replace

import casadi as ca
import numpy as np

from feeddrive.export.nonlinear_model import Model
from feeddrive.plant.equations import chain_symbols, parameter_symbols
from feeddrive.symbolic_turn import SYMBOLS
from feeddrive.typing import Expression

BESIDE = "beside_table"
"""Ends the name of a state that is given beside the table."""


@SYMBOLS.taken()
def beside_table(model: Model) -> Model:
    """The model with its states, their start and its equations beside the table; results and parameters as they are.

    A heat network has no table, and stays as it is.
    """
    plant = model.plant
    if plant is None:
        return model
    n = len(plant.chain.coordinates)
    symbols = parameter_symbols(plant)
    rigid = plant.chain.rigid_motion(chain_symbols(plant, symbols))
    motion = ca.Function("motion", [symbols.vector], [ca.vertcat(*map(ca.SX, rigid))])
    time, y, u, p = (ca.SX.sym(name, model.function.size1_in(name)) for name in model.function.name_in())
    column = motion(p)
    xdot, shown = model.function(time, _changed(y, column, n, 1), u, p)
    function = ca.Function("ode", [time, y, u, p], [_changed(xdot, column, n, -1), shown],
                           model.function.name_in(), model.function.name_out())  # fmt: skip
    values = ca.DM([row.value for row in model.parameters])
    start = np.array(_changed(ca.DM([row.value for row in model.states]), motion(values), n, -1))[:, 0]
    rows = [
        replace(row, value=float(value), name=f"{row.name}_{BESIDE}" if i < 2 * n and i % n != n - 1 else row.name)
        for i, (row, value) in enumerate(zip(model.states, start, strict=True))
    ]
    return replace(model, states=tuple(rows), function=function)


def _changed(x: Expression, motion: Expression, n: int, sign: int) -> Expression:
    """States with G x of the table added to, or taken from, the other coordinates and their rates."""
    if n == 1:
        return x
    others = motion[: n - 1]
    first, rates = x[: n - 1] + sign * others * x[n - 1], x[n : 2 * n - 1] + sign * others * x[2 * n - 1]
    return ca.vertcat(first, x[n - 1], rates, x[2 * n - 1], x[2 * n :])
