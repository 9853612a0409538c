"""Natural frequencies, damping ratios and mode shapes of the linear chain.

    (K - w^2 M) a = 0,   zeta = a' C a / (2 w a' M a)

All coordinates are counted in table travel (angles times r = lead / 2 pi), so that a shape compares motor, screw and
table. Friction is not in it: at rest its slope would swamp everything.
"""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np
from scipy.linalg import eigh, null_space

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
    """Modes with the motor free to turn; the first is the motion of the whole axis.

    Args:
        plant: the machine.
        position: of the table [m]; of no effect where the chain does not depend on it.

    Raises:
        InputError: the nut would not be on the screw.
    """
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


def screw_frequency(plant: Plant, position: float = 0.0) -> float:
    """The lowest natural frequency of the screw alone [Hz]: motor held, nut open; infinite in a rigid structure.

    Above it the screw has a motion of its own between motor and table. With three inertias it is
    sqrt(k_TS / J_s) / 2 pi.

    Args:
        plant: the machine.
        position: of the table [m].

    Raises:
        InputError: the nut would not be on the screw.
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
