"""The plant linearised about a point, with its matrices, names, units and modes.

    x' = A x + B u,  y = C x + D u     deviations from the point

Mass, damping and stiffness matrix are those of the chain at the point, friction apart.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

from feeddrive.export.equation_quantities import Quantity, inputs, outputs, states
from feeddrive.export.nonlinear_model import identifier_of
from feeddrive.export.point import Point, refuse_outside
from feeddrive.plant.analysis.linear import state_space, steady_motion
from feeddrive.plant.plant import Plant
from feeddrive.typing import FloatArray

if TYPE_CHECKING:
    import control


@dataclass(frozen=True)
class LinearModel:
    """A state space and where it comes from.

    Attributes:
        plant: the machine.
        identifier: its name, for files.
        position, velocity: of the table at the point [m, m/s].
        system: A, B, C, D with names.
        states, inputs: with values at the point; outputs in the order of y.
        outputs: see above.
        mass, damping, stiffness: M, C, K of the chain, shape (n, n) [kg, N s/m, N/m, and with angles].
    """

    plant: Plant
    identifier: str
    position: float
    velocity: float
    system: control.StateSpace
    states: tuple[Quantity, ...]
    inputs: tuple[Quantity, ...]
    outputs: tuple[Quantity, ...]
    mass: FloatArray
    damping: FloatArray
    stiffness: FloatArray


def linear_model_of(plant: Plant, point: Point) -> LinearModel:
    """The plant linearised about the steady motion at a point.

    Args:
        plant: the machine.
        point: without a velocity the table moves at `feeddrive.plant.analysis.linear.MOVING`.

    Raises:
        InputError: a point outside the stroke, or where no steady motion is found.
    """
    refuse_outside(plant, point, plant.name)
    position, velocity = point.position, point.linearised_at
    at = steady_motion(plant, velocity, position)
    values = plant.chain_values()
    chain = (plant.chain.mass, plant.chain.damping, plant.chain.stiffness)
    matrices = (np.array(matrix(values, position), dtype=float) for matrix in chain)
    rows = states(plant, at.state.tolist()), inputs(at.torque), outputs()
    system = state_space(plant, velocity, position)
    return LinearModel(plant, identifier_of(plant.name), position, velocity, system, *rows, *matrices)
