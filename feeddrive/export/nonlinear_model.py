"""The nonlinear equations of motion of a plant, ready to be written in another form.

    x' = f(t, x, u, p),   y = g(t, x, p)

f and g are those that the plant itself is linearised from (`feeddrive.plant.analysis.ode.timed_ode`).
"""

from __future__ import annotations

import re
from collections.abc import Sequence
from dataclasses import dataclass

import casadi as ca
import numpy as np

from feeddrive import __version__
from feeddrive.export.notes import included, left_out
from feeddrive.export.point import Point
from feeddrive.plant.analysis.ode import INPUTS, OUTPUTS, ode_parameters, state_names, timed_ode
from feeddrive.plant.analysis.steady import steady_motion
from feeddrive.plant.plant import Plant
from feeddrive.symbolic_turn import SYMBOLS
from feeddrive.typing import FloatArray

INPUT_UNITS = ("N m", "N")
OUTPUT_UNITS = ("rad", "rad/s", "m", "m/s")
_INPUT_COMMENTS = ("torque of the motor on its rotor", "force on the table, along + motion")
_OUTPUT_COMMENTS = ("of the rotor", "of the rotor", "of the table", "of the table")
_STATE_UNITS = {"angle": "rad", "speed": "rad/s", "position": "m", "velocity": "m/s"}


@dataclass(frozen=True)
class Quantity:
    """One row: a state, an input, an output or a parameter.

    Attributes:
        name: of the row.
        unit: SI unit; "1" for none.
        value: at the start, or of the parameter [unit].
        comment: remarks: what it is, or the source of a value.
        of_chain: whether it is a parameter of inertias and springs, and not of an effect.
    """

    name: str
    unit: str
    value: float = 0.0
    comment: str = ""
    of_chain: bool = False


def states(plant: Plant, values: Sequence[float]) -> tuple[Quantity, ...]:
    """States with the values [SI] given; bristle deflections are in m."""
    named = zip(state_names(plant), values, strict=True)
    return tuple(Quantity(name, _STATE_UNITS.get(name.rsplit("_", 1)[-1], "m"), float(value)) for name, value in named)


def inputs(torque: float) -> tuple[Quantity, ...]:
    """Inputs; the motor torque has the value given [N m]."""
    rows = zip(INPUTS, INPUT_UNITS, (torque, 0.0), _INPUT_COMMENTS, strict=True)
    return tuple(Quantity(*row) for row in rows)


def outputs() -> tuple[Quantity, ...]:
    """Outputs."""
    rows = zip(OUTPUTS, OUTPUT_UNITS, _OUTPUT_COMMENTS, strict=True)
    return tuple(Quantity(name, unit, comment=comment) for name, unit, comment in rows)


def parameters(plant: Plant) -> tuple[Quantity, ...]:
    """Parameters with values and sources, in the order of `ode_parameters`."""
    units = {value.key: value.unit for value in plant.chain.known_values}
    units |= {f"{effect.label}.{p.key}": p.unit for effect in plant.motion_effects for p in effect.parameters}
    rows = []
    for name, value in ode_parameters(plant).items():
        key = name.partition("[")[0]
        rows.append(Quantity(name, units[key], value, plant.origins.get(key, ""), key in plant.chain.values))
    return tuple(rows)


_LONGEST = 60
"""Letters of an identifier: C99 tells 63 apart, and file names have ends of their own."""

_TAKEN = ("null", "jac", "hess")
"""Words that CasADi keeps for itself as names of functions."""


@dataclass(frozen=True)
class Model:
    """Equations with their names, units and start.

    Attributes:
        plant: the machine; None for its heat.
        name: of the machine.
        subject: what the equations are of.
        notes: what they include, and what they leave out.
        nominal: typical size of every state of a heat network; empty for a motion (`feeddrive.export.nonlinear_model`).
        identifier: its name as a C identifier, for files and functions.
        point: where a motion starts; a steady motion, or at rest. Heat starts cold.
        states, inputs: with values at the start.
        outputs: in the order of y.
        parameters: with their values.
        function: (time, x, u, p) -> (xdot, y), SI columns.
    """

    plant: Plant | None
    name: str
    identifier: str
    point: Point
    subject: str
    notes: tuple[tuple[str, ...], tuple[str, ...]]
    states: tuple[Quantity, ...]
    inputs: tuple[Quantity, ...]
    outputs: tuple[Quantity, ...]
    parameters: tuple[Quantity, ...]
    function: ca.Function
    nominal: tuple[float, ...] = ()

    @property
    def heading(self) -> tuple[str, ...]:
        """What stands at the head of every file made of it."""
        held, lacking = self.notes
        lines = [f"{self.name}: {self.subject}, made by feeddrive {__version__}. SI units.", "Included:"]
        return (*lines, *(f"  {line}" for line in held), "Left out:", *(f"  {line}" for line in lacking))


def model_of(plant: Plant, point: Point) -> Model:
    """The equations of motion of a plant, starting at a point: in steady motion, or at rest with its springs loaded.

    Raises InputError: a point outside the stroke, or where no steady motion is found.
    """
    plant.refuse_off_stroke(point.position, plant.name)
    start = steady_motion(plant, point.starts_at, point.position)
    rows = states(plant, start.state.tolist()), inputs(start.torque), outputs(), parameters(plant)
    notes = included(plant), left_out(plant)
    return Model(plant, plant.name, identifier_of(plant.name), point, "equations of motion", notes, *rows,
                 timed_ode(plant))  # fmt: skip


@SYMBOLS.taken()
def slopes_of(model: Model, name: str) -> ca.Function:
    """(time, x, u, p) -> (A, B, C, D) of the equations, dense, each transposed: C reads the columns as rows.

    A = df/dx, B = df/du, C = dg/dx, D = dg/du.
    """
    arguments = [ca.SX.sym(of, model.function.size1_in(of)) for of in model.function.name_in()]
    _, x, u, _ = arguments
    xdot, y = model.function(*arguments)
    slopes = [ca.densify(ca.jacobian(of, to).T) for of in (xdot, y) for to in (x, u)]
    return ca.Function(name, arguments, slopes, model.function.name_in(), ["A", "B", "C", "D"])


def identifier_of(name: str) -> str:
    """The name in small letters of ASCII, digits and single underscores, beginning with a letter; 60 at most."""
    plain = re.sub(r"[^a-z0-9]+", "_", name.lower()).strip("_")[:_LONGEST].strip("_")
    return plain if plain[:1].isalpha() and plain not in _TAKEN else f"plant_{plain}".rstrip("_")


_TRAVEL, _VELOCITY = 1e-3, 0.1
"""Nominal travel [m] and velocity [m/s] of the table."""

_STRETCH, _STRETCH_RATE = 1e-6, 1e-3
"""Nominal stretch and bristle deflection [m], and rate of a stretch [m/s]; those of shafts are in proportion."""


def nominals(model: Model) -> FloatArray:
    """Typical size of every state of a model beside the table, from which a solver takes its absolute tolerance, (nx,).

    Args:
        model: as `feeddrive.export.fmu.beside_table` makes it.
    """
    if model.plant is None:
        return np.array(model.nominal)
    motion = np.abs(np.array(model.plant.chain.rigid_motion(model.plant.chain_values()), dtype=float))
    turning = np.where(motion == 0, 1.0, motion)
    positions, rates = _STRETCH * turning, _STRETCH_RATE * turning
    positions[-1], rates[-1] = _TRAVEL, _VELOCITY
    return np.concatenate([positions, rates, np.full(len(model.states) - 2 * len(motion), _STRETCH)])
