"""Natural frequencies, damping ratios and mode shapes of the linear chain.

    (K - w^2 M) a = 0,   zeta = a' C a / (2 w a' M a)

All coordinates are counted in table travel (angles times r = lead / 2 pi), so that a shape compares motor, screw and
table. Friction is not in it: at rest its slope would swamp everything.

Everything that moves with the motor, seen there, and how far the table stays behind when it is accelerated.

    J = r_m^2 G' M G,    q = G x where nothing is stretched
    s = -[K_f^-1 (M G)_f r_m] at the table: x = r_m theta + s theta'' where the motor moves slowly

| symbol | meaning | unit |
|---|---|---|
| M, K, G | mass and stiffness matrix; column of the rigid motion | |
| f | all coordinates but the motor's | |
| r_m | table travel per motor angle | m/rad |
"""

from __future__ import annotations

import math
from dataclasses import dataclass, replace

import numpy as np
from scipy.linalg import eigh, null_space

from feeddrive.parts.screw.screw_drive import BallScrewDrive
from feeddrive.plant.chain.distributed_screw import DistributedScrew
from feeddrive.plant.chain.drive_values import distributed_values
from feeddrive.plant.plant import Plant
from feeddrive.typing import FloatArray


@dataclass(frozen=True)
class Modes:
    """Modes in ascending order of frequency.

    Attributes:
        frequencies: undamped natural frequencies [Hz], shape (k,); 0 where the whole axis moves freely.
        damping: damping ratios of the chain's dampers, from the undamped shapes [1], shape (k,); 0 for a free motion.
        shapes: columns are modes, rows coordinates of the chain as table travel, largest entry 1, shape (n, k).
        poles: exact poles of the damped chain with positive imaginary part, and real ones [1/s], ascending in size.
    """

    frequencies: FloatArray
    damping: FloatArray
    shapes: FloatArray
    poles: tuple[complex, ...]


def free_modes(plant: Plant, position: float = 0.0) -> Modes:
    """Modes with the motor free to turn and the table at `position` [m]; the first is the motion of the whole axis."""
    return _modes(plant, np.eye(len(plant.chain.coordinates)), position)


def braked_modes(plant: Plant, position: float = 0.0) -> Modes:
    """Modes with the motor held; none where the structure is rigid. Arguments and errors as `free_modes`.

    A declared brake holds it by its stiffness; without one it is held ideally and its coordinate removed.
    """
    motor = np.array([plant.chain.motor(plant.chain_values())], dtype=float)
    brake = plant.drive.motor.brake if plant.drive is not None else None
    if brake is None:
        return _modes(plant, null_space(motor), position)
    return _modes(plant, np.eye(motor.shape[1]), position, brake.stiffness * motor.T @ motor)


def held_modes(plant: Plant, position: float = 0.0) -> Modes:
    """Modes with the motor held ideally, as a servo holds it, whatever its brake; else as `braked_modes`."""
    return braked_modes(replace(plant, drive=None), position)


def screw_frequency(plant: Plant, position: float = 0.0) -> float:
    """The lowest natural frequency of the screw alone [Hz]: motor held, nut open at `position` [m]; infinite if rigid.

    Above it the screw has a motion of its own between motor and table. With three inertias it is sqrt(k_TS / J_s) / 2
    pi.
    """
    plant.chain.refuse_off_screw(position, plant.name)
    chain, values = plant.chain.without_modes, plant.chain_values()
    if not chain.elastic:
        return math.inf
    screw = slice(1, -1)  # between the motor and the table
    M, K = (np.array(matrix(values, position), dtype=float) for matrix in (chain.mass, chain.stiffness))
    nut = chain.nut(values)
    row = np.array(nut.row, dtype=float)
    opened = K - float(nut.stiffness) * np.outer(row, row)
    return float(np.sqrt(np.min(eigh(opened[screw, screw], M[screw, screw], eigvals_only=True)))) / (2 * math.pi)


def _modes(plant: Plant, basis: FloatArray, position: float, held: FloatArray | float = 0.0) -> Modes:
    """Modes of the motions q = S B eta, with S from table travel to coordinates, B a basis, `held` added to K."""
    plant.chain.refuse_off_screw(position, plant.name)
    values = plant.chain_values()
    rigid = np.array(plant.chain.rigid_motion(values), dtype=float)
    travel = np.diag(np.where(rigid == 0, 1.0, rigid))  # what a rigid motion leaves at rest is a position already
    into = travel @ basis
    matrices = (plant.chain.mass, plant.chain.damping, plant.chain.stiffness)
    M, C, K = (np.array(matrix(values, position), dtype=float) for matrix in matrices)
    M, C, K = (into.T @ matrix @ into for matrix in (M, C, K + held))
    if basis.shape[1] == 0:
        return Modes(np.zeros(0), np.zeros(0), np.zeros((basis.shape[0], 0)), ())
    squared, vectors = eigh(K, M)
    # What rounding leaves of a free motion: w^2 far below the largest one. Its shape is known without rounding.
    free = np.abs(squared) <= 1e-9 * np.max(np.abs(squared))
    squared[free], vectors[:, free] = 0.0, (basis.T @ (rigid != 0))[:, None]
    omega = np.sqrt(squared)
    dissipated = np.einsum("ik,ij,jk->k", vectors, C, vectors)  # eigh scales to a' M a = 1
    damping = np.divide(dissipated, 2 * omega, out=np.zeros_like(omega), where=omega > 0)
    shapes = basis @ vectors
    largest = shapes[np.argmax(np.abs(shapes), axis=0), np.arange(shapes.shape[1])]
    return Modes(omega / (2 * math.pi), damping, shapes / largest, _poles(M, C, K))


def _poles(M: FloatArray, C: FloatArray, K: FloatArray) -> tuple[complex, ...]:
    n = len(M)
    system = np.block([[np.zeros((n, n)), np.eye(n)], [-np.linalg.solve(M, K), -np.linalg.solve(M, C)]])
    poles = np.linalg.eigvals(system)
    poles[np.abs(poles) <= 1e-6 * np.max(np.abs(poles))] = 0.0  # a free motion's double pole, as rounding leaves it
    return tuple(sorted((complex(pole) for pole in poles if pole.imag >= 0), key=abs))


def inertia_at_motor(plant: Plant, position: float | None = None) -> float:
    """Inertia of all that moves with the motor, seen there [kg m^2]; the table in mid-stroke, or at `position` [m]."""
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


# They do not move an undamped frequency, and the table is at 0 where the nut is at the near bearing.
_WITHOUT = {"drive_damping": 0.0, "damping_time": 0.0, "nut_damping": 0.0, "first_nut_position": 0.0}


def held_frequency(drive: BallScrewDrive, position: float) -> float:
    """First natural frequency [Hz] with the motor held by its brake, or ideally where it has none.

    Within 0.15 % of finite elements on the drive of paper 004 from 0.1 to 1.1 m of 1.2 m. A screw held by one bearing
    at a time is taken in its softer direction. The position is that of the nut from the near bearing [m]; one off the
    screw or at its end raises InputError, and so does a drive in which nothing is elastic.
    """
    computed = distributed_values(drive, position)
    values = {key: entry.value for key, entry in computed.items()}
    chain = DistributedScrew(_WITHOUT | {"lead": drive.screw.lead} | values)
    chain.refuse_off_screw(position, "drive")
    M, K = (np.array(matrix(chain.values, position), dtype=float) for matrix in (chain.mass, chain.stiffness))
    if drive.motor.brake is not None:
        K[0, 0] += drive.motor.brake.stiffness
    else:
        M, K = M[1:, 1:], K[1:, 1:]  # the motor angle is the first coordinate
    squared = eigh(K, M, eigvals_only=True, subset_by_index=(0, 0))
    return float(np.sqrt(squared[0])) / (2.0 * math.pi)
