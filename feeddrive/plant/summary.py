"""The figures by which a servo engineer knows an axis: inertias, combined stiffness, friction over speed, modes.

    k_total = 1 / (1/k_XS + r^2/k_TS),   r = lead / 2 pi

Source: paper 004, eqs. (5) and (8): axial and torsional spring chain act in series on the table.
"""

from __future__ import annotations

from dataclasses import dataclass

from feeddrive.plant.linear import steady_motion
from feeddrive.plant.modes import Modes, braked_modes, free_modes
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
class StiffnessBudget:
    """Static stiffness at the table with the motor held, and whose compliance it is.

    Attributes:
        axial: k_XS [N/m].
        torsional: k_TS converted to the table [N/m].
        total: both in series [N/m].
        axial_share, torsional_share: of the compliance [1].
    """

    axial: float
    torsional: float
    total: float
    axial_share: float
    torsional_share: float


@dataclass(frozen=True)
class Summary:
    """Figures of a plant, SI.

    Attributes:
        inertia_at_motor: everything that moves, seen at the motor [kg m^2].
        mass_at_table: the same, seen at the table [kg].
        stiffness: None where the structure is rigid.
        friction: at `SPEEDS`, table at 0.
        braked, free: modes with the motor held and free.
    """

    inertia_at_motor: float
    mass_at_table: float
    stiffness: StiffnessBudget | None
    friction: tuple[FrictionRow, ...]
    braked: Modes
    free: Modes


def summarise(plant: Plant) -> Summary:
    """The figures of a plant.

    Raises:
        InputError: no steady motion is found at one of `SPEEDS`.
    """
    values, r = plant.chain_values(), plant.chain.radius
    shafts = values["motor_inertia"] + values["screw_inertia"]
    return Summary(
        inertia_at_motor=shafts + values["table_mass"] * r**2,
        mass_at_table=values["table_mass"] + shafts / r**2,
        stiffness=stiffness_budget(plant) if plant.chain.elastic else None,
        friction=tuple(_friction(plant, speed) for speed in SPEEDS),
        braked=braked_modes(plant),
        free=free_modes(plant),
    )


def stiffness_budget(plant: Plant) -> StiffnessBudget:
    """Axial and torsional stiffness in series, for an elastic structure."""
    values, r = plant.chain_values(), plant.chain.radius
    axial, torsional = values["axial_stiffness"], values["torsional_stiffness"] / r**2
    total = 1 / (1 / axial + 1 / torsional)
    return StiffnessBudget(axial, torsional, total, total / axial, total / torsional)


def _friction(plant: Plant, speed: float) -> FrictionRow:
    r = plant.chain.radius
    forward, backward = steady_motion(plant, speed).torque, steady_motion(plant, -speed).torque
    return FrictionRow(speed, forward / r, backward / r, forward, backward)
