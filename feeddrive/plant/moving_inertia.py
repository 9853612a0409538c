"""Everything that moves with the motor, seen there.

    J = r_m^2 G' M G,    q = G x where nothing is stretched

| symbol | meaning | unit |
|---|---|---|
| M, G | mass matrix; column of the rigid motion | |
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
