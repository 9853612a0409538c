"""Everything that moves with the motor, seen there, and how far the table stays behind when it is accelerated.

    J = r_m^2 G' M G,    q = G x where nothing is stretched
    s = -[K_f^-1 (M G)_f r_m] at the table: x = r_m theta + s theta'' where the motor moves slowly

| symbol | meaning | unit |
|---|---|---|
| M, K, G | mass and stiffness matrix; column of the rigid motion | |
| f | all coordinates but the motor's | |
| r_m | table travel per motor angle | m/rad |
"""

from __future__ import annotations

import numpy as np

from feeddrive.plant.plant import Plant


def inertia_at_motor(plant: Plant, position: float | None = None) -> float:
    """Inertia of everything that moves with the motor, seen there [kg m^2].

    Args:
        plant: the machine, with what it carries.
        position: of the table [m]; the middle of the stroke if not given.
    """
    values = plant.chain_values()
    rigid = np.array(plant.chain.rigid_motion(values), dtype=float)
    mass = np.array(plant.chain.mass(values, plant.middle if position is None else position), dtype=float)
    return float(rigid @ mass @ rigid) * plant.chain.motor_radius**2


def lag_per_acceleration(plant: Plant, position: float | None = None) -> float:
    """How far the table stays behind, per acceleration of the motor [m s^2/rad]; 0 in a rigid structure.

    Args:
        plant: the machine, with what it carries.
        position: of the table [m]; the middle of the stroke if not given.
    """
    chain, values = plant.chain, plant.chain_values()
    if not chain.elastic:
        return 0.0
    at = plant.middle if position is None else position
    rigid = np.array(chain.rigid_motion(values), dtype=float) * chain.motor_radius
    M, K = (np.array(matrix(values, at), dtype=float) for matrix in (chain.mass, chain.stiffness))
    size = 1 / np.sqrt(np.diag(K)[1:])  # of the coordinates: the matrix spans nine decades
    load = size * (M @ rigid)[1:]
    return float((size * np.linalg.solve(size[:, None] * K[1:, 1:] * size, load))[-1])
