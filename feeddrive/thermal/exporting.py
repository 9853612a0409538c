"""A reduced heat model in the forms of other tools: `control.StateSpace`, CasADi functions."""

from __future__ import annotations

import casadi as ca
import control
import numpy as np

from feeddrive.plant.symbolic_turn import SYMBOLS
from feeddrive.thermal.model import AMBIENT, HeatModel, Path
from feeddrive.thermal.rig import refuse_unless
from feeddrive.thermal.system import HeatSystem


def state_space(system: HeatSystem) -> control.StateSpace:
    """dx/dt = A x + B u, y = L x; u in W and K, y in K and m, named.

    Raises:
        InputError: a sparse system; reduce it first.
    """
    _refuse_sparse(system.is_sparse)
    A, B = -system.conductance / system.capacity[:, None], system.gains / system.capacity[:, None]
    return control.ss(A, B, system.rows, 0, inputs=list(system.input_names), outputs=list(system.output_names))


@SYMBOLS.taken()
def casadi_system(system: HeatSystem, name: str = "thermal") -> ca.Function:
    """Function (x, u) -> (dx/dt, y) at one operating point.

    Raises:
        InputError: a sparse system; reduce it first.
    """
    _refuse_sparse(system.is_sparse)
    x, u = ca.SX.sym("x", system.order), ca.SX.sym("u", len(system.input_names))
    rate = (-ca.DM(system.conductance) @ x + ca.DM(system.gains) @ u) / ca.DM(system.capacity)
    shown = ca.DM(system.rows) @ x
    return ca.Function(name, [x, u], [rate, shown], ["x", "u"], ["rate", "y"])


@SYMBOLS.taken()
def casadi_model(model: HeatModel, name: str = "thermal") -> ca.Function:
    """Function (x, g, u) -> (dx/dt, y) with the conductances g in the order of `model.ways` as inputs.

    Raises:
        InputError: a full model; reduce it first.
    """
    _refuse_sparse(not isinstance(model.conduction, np.ndarray))
    x, g = ca.SX.sym("x", model.order), ca.SX.sym("g", len(model.ways))
    u = ca.SX.sym("u", len(model.input_names))
    given = dict(zip(model.input_names, ca.vertsplit(u), strict=True))
    flow = -ca.DM(model.conduction) @ x + ca.DM(model.air) * given[AMBIENT]
    for name_of_heat, vector in model.heats.items():
        flow += ca.DM(vector) * given[name_of_heat]
    for i, way in enumerate(model.ways.values()):
        flow -= g[i] * (ca.DM(way.matrix) @ x)
        if way.source:
            flow += g[i] * ca.DM(way.facing) * given[way.source]
    shown = ca.DM(np.vstack(list(model.readings.values()))) @ x
    return ca.Function(name, [x, g, u], [flow / ca.DM(model.capacity), shown], ["x", "g", "u"], ["rate", "y"])


def conductance_order(model: HeatModel) -> tuple[Path, ...]:
    """Paths in the order of the input g of `casadi_model`."""
    return tuple(model.ways)


def _refuse_sparse(is_full: bool) -> None:
    refuse_unless(not is_full, "a full model is too large to export", "thermal", "reduce it first")
