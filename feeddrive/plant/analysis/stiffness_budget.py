"""Static stiffness at the table with the motor held, and whose compliance it is.

    1/k_total = sum_i k_i s_i^2 / F^2        s_i: stretch of spring i under a force F on the table

Every spring's part is twice its strain energy under a unit force, so that the parts add up for series and parallel
springs alike. Where the machine is described by its parts and none of their values is replaced by a measured one, the
springs are listed part by part (`feeddrive.parts.combined_stiffness`), the brake included.
Source: paper 004, eqs. (5) to (8): axial and torsional spring chain act in series on the table.
"""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np

from feeddrive.parts.combined_stiffness import Deformation, combined_stiffness
from feeddrive.plant.chain.drive_values import without_brake
from feeddrive.plant.chain.linear_chain import Spring, is_travel
from feeddrive.plant.plant import Plant
from feeddrive.typing import FloatArray

_SAME = 1e-6  # relative: parts and chain agree, no value was replaced


@dataclass(frozen=True)
class PartCompliance:
    """What one part adds to the compliance at the table.

    Attributes:
        part: name.
        deformation: "axial" or "torsional".
        compliance: at the table [m/N].
        share: of the whole compliance [1].
    """

    part: str
    deformation: str
    compliance: float
    share: float


@dataclass(frozen=True)
class StiffnessBudget:
    """Static stiffness at the table with the motor held, and whose compliance it is.

    Attributes:
        axial: of the axial chain [N/m]; k_XS.
        torsional: of the torsional chain, converted to the table [N/m]; k_TS / r^2.
        total: both in series [N/m].
        axial_share, torsional_share: of the compliance [1].
        parts: of the compliance, from the table to the motor.
    """

    axial: float
    torsional: float
    total: float
    axial_share: float
    torsional_share: float
    parts: tuple[PartCompliance, ...]


def stiffness_budget(plant: Plant, position: float = 0.0) -> StiffnessBudget:
    """The budget of an elastic structure with the table at `position` [m].

    Raises:
        InputError: the nut would not be on the screw.
    """
    plant.chain.refuse_off_screw(position, plant.name)
    found = _of_parts(plant, position) or _of_springs(plant, position)
    whole = sum(compliance for _, _, compliance in found)
    parts = tuple(PartCompliance(part, kind, compliance, compliance / whole) for part, kind, compliance in found)
    axial, torsional = (
        sum(one.compliance for one in parts if one.deformation == kind.value)
        for kind in (Deformation.AXIAL, Deformation.TORSIONAL)
    )
    return StiffnessBudget(1 / axial, 1 / torsional, 1 / whole, axial / whole, torsional / whole, parts)


def static_shape(plant: Plant, position: float) -> FloatArray:
    """Coordinates under a unit force on the table, motor held, shape (n,) [m/N, rad/N]."""
    values = plant.chain_values()
    K = np.array(plant.chain.stiffness(values, position), dtype=float)
    size = 1 / np.sqrt(np.diag(K)[1:])  # of the coordinates: the matrix spans nine decades
    load = np.zeros(len(size))
    load[-1] = size[-1]
    scaled = size[:, None] * K[1:, 1:] * size
    return np.concatenate([[0.0], size * np.linalg.solve(scaled, load)])


def static_stiffness(plant: Plant, position: float) -> float:
    """Force per travel of the table with the motor held ideally [N/m]; infinite in a rigid structure."""
    return float(1 / static_shape(plant, position)[-1]) if plant.chain.elastic else float("inf")


def participation(plant: Plant, key: str, position: float) -> float:
    """Share of a chain value in the compliance at the table, motor held ideally: -d ln(1/k) / d ln(value) [1]."""
    step = 1e-4
    values = {**plant.chain.values, key: plant.chain.values[key] * (1 + step)}
    stiffer = plant.with_chain_values(values)
    ratio = static_stiffness(stiffer, position) / static_stiffness(plant, position)
    return math.log(ratio) / math.log(1 + step)


def nut_stiffness(plant: Plant) -> float:
    """Stiffness of the spring on which gap and laws of the transmission act, of an elastic structure [N/m]."""
    return float(plant.chain.nut(plant.chain_values()).stiffness)


def _of_springs(plant: Plant, position: float) -> list[tuple[str, str, float]]:
    """Part, deformation and compliance of the chain's springs, from the table to the motor."""
    shape = static_shape(plant, position)
    found: dict[str, tuple[str, float]] = {}
    for spring in reversed(plant.chain.springs(plant.chain_values(), position)):
        stretch = float(np.array(spring.row, dtype=float) @ shape)
        kind, before = found.get(spring.name, (_deformation(plant, spring), 0.0))
        found[spring.name] = kind, before + float(spring.stiffness) * stretch**2
    whole = sum(compliance for _, compliance in found.values())
    return [(name.replace("_", " "), *entry) for name, entry in found.items() if entry[1] > 1e-12 * whole]


def _deformation(plant: Plant, spring: Spring) -> str:
    touched = (name for name, entry in zip(plant.chain.coordinates, spring.row, strict=True) if entry != 0)
    return str(Deformation.AXIAL.value if any(map(is_travel, touched)) else Deformation.TORSIONAL.value)


def _of_parts(plant: Plant, position: float) -> list[tuple[str, str, float]]:
    """Compliances part by part; none where there are no parts, or the chain differs from them."""
    if plant.drive is None or not plant.chain.varies:
        return []
    place = plant.chain.nut_at_zero + position
    held = combined_stiffness(without_brake(plant.drive), place)
    if abs(held.total * static_shape(plant, position)[-1] - 1) > _SAME:
        return []
    known = combined_stiffness(plant.drive, place).contributions
    return [(one.part, str(one.deformation.value), one.compliance) for one in known]
