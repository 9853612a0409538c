"""The figures by which a servo engineer knows an axis: inertias, combined stiffness, friction over speed, modes.

The stiffness budget is that of `feeddrive.plant.analysis.stiffness_budget`, the modes those of
`feeddrive.plant.chain.resolution`.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from feeddrive.plant.analysis.modes import inertia_at_motor
from feeddrive.plant.analysis.steady import steady_motions
from feeddrive.plant.analysis.stiffness_budget import StiffnessBudget, stiffness_budget
from feeddrive.plant.chain.resolution import ResolvedModes, resolved_modes
from feeddrive.plant.plant import Plant

SPEEDS = (0.001, 0.01, 0.05, 0.1, 0.3)
"""Table speeds of the friction table [m/s]."""


@dataclass(frozen=True)
class FrictionRow:
    """What constant motion needs: table speed [m/s], then force at the table [N] and motor torque [N m] each way.

    Forces and torques are along + motion, so those of the way back are negative where friction alone acts.
    """

    speed: float
    force_forward: float
    force_backward: float
    torque_forward: float
    torque_backward: float


@dataclass(frozen=True)
class InertiaRow:
    """What turns or moves with one coordinate: seen at the motor [kg m^2], at the table [kg], its share [1]."""

    coordinate: str
    at_motor: float
    at_table: float
    share: float


@dataclass(frozen=True)
class Summary:
    """Figures of a plant, SI.

    Attributes:
        position: of the table, for which stiffness and modes hold [m].
        inertia_at_motor: everything that moves, seen at the motor [kg m^2].
        mass_at_table: the same, seen at the table [kg].
        inertias: its parts by coordinate.
        stiffness: None where the structure is rigid.
        friction: at `SPEEDS`.
        modes: with the motor held and free.
    """

    position: float
    inertia_at_motor: float
    mass_at_table: float
    inertias: tuple[InertiaRow, ...]
    stiffness: StiffnessBudget | None
    friction: tuple[FrictionRow, ...]
    modes: ResolvedModes


def summarise(plant: Plant, position: float | None = None) -> Summary:
    """The figures of a plant with the table at `position` [m], or in the middle of the stroke.

    Raises InputError where no steady motion is found at one of `SPEEDS`, or the nut is off the screw.
    """
    at = plant.middle if position is None else position
    inertias = _inertias(plant, at)
    return Summary(
        position=at,
        inertia_at_motor=inertia_at_motor(plant, at),
        mass_at_table=sum(row.at_table for row in inertias),
        inertias=inertias,
        stiffness=stiffness_budget(plant, at) if plant.chain.elastic else None,
        friction=_friction(plant, at),
        modes=resolved_modes(plant, at),
    )


def _inertias(plant: Plant, position: float) -> tuple[InertiaRow, ...]:
    values = plant.chain_values()
    rigid = np.array(plant.chain.rigid_motion(values), dtype=float)
    M = np.array(plant.chain.mass(values, position), dtype=float)
    at_table = rigid * (M @ rigid)
    names = [name for name, moved in zip(plant.chain.coordinates, rigid, strict=True) if moved]
    masses = [float(mass) for mass in at_table[rigid != 0]]
    whole, r = sum(masses), plant.chain.motor_radius
    return tuple(InertiaRow(name, mass * r**2, mass, mass / whole) for name, mass in zip(names, masses, strict=True))


def _friction(plant: Plant, position: float) -> tuple[FrictionRow, ...]:
    r = plant.chain.motor_radius
    signed = [sign * speed for speed in SPEEDS for sign in (1, -1)]
    torques = [motion.torque for motion in steady_motions(plant, signed, position)]
    return tuple(
        FrictionRow(speed, forward / r, backward / r, forward, backward)
        for speed, forward, backward in zip(SPEEDS, torques[::2], torques[1::2], strict=True)
    )
