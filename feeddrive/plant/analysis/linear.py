"""The plant linearised exactly about a moving point.

    A = df/dx, B = df/du, C = dg/dx, D = 0

of the equations of `feeddrive.plant.analysis.ode`. At rest the slope of tanh (level over smoothing velocity) is many
thousand times that of sliding friction and swamps everything, so the point moves unless asked otherwise.
"""

from __future__ import annotations

from typing import TYPE_CHECKING

import casadi as ca
import numpy as np

from feeddrive.plant.analysis.ode import INPUTS, OUTPUTS, ode, state_names
from feeddrive.plant.analysis.steady import MOVING, steady_motion
from feeddrive.plant.plant import Plant
from feeddrive.plant.structure import parameter_values, per_structure
from feeddrive.typing import FloatArray

if TYPE_CHECKING:
    import control


def state_space(plant: Plant, velocity: float = MOVING, position: float = 0.0) -> control.StateSpace:
    """The plant linearised exactly about a steady motion: velocity [m/s] and position [m] of the table.

    By default the point moves: at rest the slope of the friction swamps everything (see the module). States, inputs
    (`INPUTS`) and outputs (`OUTPUTS`) are named, SI. A declared delay (`drive_delay`) is not in the result, since it is
    no finite state space. Raises InputError where no steady motion is found.
    """
    import control  # takes half a second, with the plotting that it brings

    matrices = linear_matrices(plant, velocity, position)
    return control.ss(*matrices, states=list(state_names(plant)), inputs=list(INPUTS), outputs=list(OUTPUTS))


def linear_matrices(plant: Plant, velocity: float = MOVING, position: float = 0.0) -> tuple[FloatArray, ...]:
    """A, B, C, D of `state_space`, shapes (n, n), (n, m), (p, n), (p, m).

    Raises:
        InputError: as `state_space`.
    """
    point = steady_motion(plant, velocity, position)
    at = jacobians(plant)(point.state, [point.torque, 0.0], parameter_values(plant))
    return tuple(np.array(matrix.full()) for matrix in at)


@per_structure
def jacobians(plant: Plant) -> ca.Function:
    """A, B, C, D as a function (x, u, p)."""
    function = ode(plant)
    x, u, p = (ca.SX.sym(name, function.size1_in(name)) for name in ("x", "u", "p"))
    xdot, y = function(x, u, p)
    pairs = [(xdot, x), (xdot, u), (y, x), (y, u)]
    return ca.Function("jacobians", [x, u, p], [ca.jacobian(of, to) for of, to in pairs])
