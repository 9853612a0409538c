"""A ball-screw drive as finite elements: the truth that the closed forms and the plant's chain are held against.

It shares no code with feeddrive. The screw is a bar and a torsion rod of `elements` linear elements with consistent
mass. The nut is a spring on x - u - (L / 2 pi) phi between table and the screw's node at the nut, so that axial and
torsional motion act in series on the table.

    hub -- stub -- bearing ----- main span ----- nut ---- overhang ---- far end (bearing where `far_bearing` > 0)
    z = -stub      0                             position               length

The coupling (stiffness k_c, inertia half at either hub) and the motor shaft (k_M) join the stub's end to the rotor.
Held itself against the closed forms and the refinement of its elements in test_stiffness_fem.py.
"""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray
from scipy.linalg import eigh

Array = NDArray[np.float64]


@dataclass(frozen=True)
class ScrewDrive:
    """A drive in SI; the defaults are those of paper 004, with the values it does not print assumed as marked.

    Attributes:
        diameter: of the solid screw [m].
        lead: table travel per screw revolution [m].
        length: fixed bearing to the screw's free end [m]; assumed.
        stub: fixed bearing to the coupling [m].
        young, shear, density: of the screw [Pa, Pa, kg/m^3]; the moduli follow from the printed stiffnesses.
        nut, bearing: axial stiffness [N/m].
        far_bearing: axial stiffness at the far end [N/m]; 0 where it slides.
        coupling, motor_shaft: torsional stiffness [N m/rad]; only their sum in series is printed.
        coupling_inertia, rotor_inertia: [kg m^2]; assumed.
        table: mass [kg].
        axial_mass, rotary_mass: whether the screw's mass and its rotary inertia are counted; the coupling's always is.
        elements: of the whole screw.
    """

    diameter: float = 0.040
    lead: float = 0.020
    length: float = 1.2
    stub: float = 0.106
    young: float = 210e9
    shear: float = 83.0e9
    density: float = 7850.0
    nut: float = 1499e6
    bearing: float = 780e6
    far_bearing: float = 0.0
    coupling: float = 27_000.0
    motor_shaft: float = 69_930.0
    coupling_inertia: float = 3e-3
    rotor_inertia: float = 6e-3
    table: float = 134.0
    axial_mass: bool = True
    rotary_mass: bool = True
    elements: int = 60


def nodes(drive: ScrewDrive, position: float) -> Array:
    """Places of the nodes from the coupling to the screw's end [m]; bearing and nut lie on nodes."""
    spans = [(-drive.stub, 0.0), (0.0, position), (position, drive.length)]
    whole = drive.stub + drive.length
    places = [np.array([-drive.stub])]
    for begin, end in spans:
        if end > begin:
            count = max(2, round(drive.elements * (end - begin) / whole))
            places.append(np.linspace(begin, end, count + 1)[1:])
    return np.concatenate(places)


def matrices(drive: ScrewDrive, position: float) -> tuple[Array, Array]:
    """Mass and stiffness matrix; unknowns [axial nodes | angular nodes | second hub, rotor | table].

    Args:
        drive: the drive.
        position: nut from the fixed bearing [m].
    """
    z = nodes(drive, position)
    count = z.size
    area = math.pi * drive.diameter**2 / 4.0
    polar = math.pi * drive.diameter**4 / 32.0
    size = 2 * count + 3
    M, K = np.zeros((size, size)), np.zeros((size, size))
    for i, step in enumerate(np.diff(z)):
        axial, angular = [i, i + 1], [count + i, count + i + 1]
        K[np.ix_(axial, axial)] += drive.young * area / step * np.array([[1, -1], [-1, 1]])
        K[np.ix_(angular, angular)] += drive.shear * polar / step * np.array([[1, -1], [-1, 1]])
        consistent = drive.density * step / 6.0 * np.array([[2, 1], [1, 2]])
        if drive.axial_mass:
            M[np.ix_(axial, axial)] += area * consistent
        if drive.rotary_mass:
            M[np.ix_(angular, angular)] += polar * consistent
    at_bearing, at_nut = int(np.argmin(abs(z))), int(np.argmin(abs(z - position)))
    hub, rotor, table = 2 * count, 2 * count + 1, 2 * count + 2
    K[at_bearing, at_bearing] += drive.bearing
    K[count - 1, count - 1] += drive.far_bearing
    _spring(K, drive.coupling, {count: 1.0, hub: -1.0})
    _spring(K, drive.motor_shaft, {hub: 1.0, rotor: -1.0})
    _spring(K, drive.nut, {table: 1.0, at_nut: -1.0, count + at_nut: -drive.lead / (2.0 * math.pi)})
    M[table, table] = drive.table
    M[rotor, rotor] = drive.rotor_inertia
    for end in (count, hub):
        M[end, end] += drive.coupling_inertia / 2.0
    return M, K


def _spring(K: Array, stiffness: float, stretch: dict[int, float]) -> None:
    """Add a spring whose stretch is the given linear combination of unknowns."""
    for i, a in stretch.items():
        for j, b in stretch.items():
            K[i, j] += stiffness * a * b


def static_stiffness(drive: ScrewDrive, position: float) -> float:
    """Force on the table per table displacement, rotor braked [N/m]."""
    _, K = matrices(drive, position)
    kept = [i for i in range(K.shape[0]) if i != K.shape[0] - 2]
    load = np.zeros(len(kept))
    load[-1] = 1.0
    return float(1.0 / np.linalg.solve(K[np.ix_(kept, kept)], load)[-1])


def frequencies(drive: ScrewDrive, position: float, *, braked: bool = True, count: int = 3) -> Array:
    """The lowest natural frequencies [Hz], shape (count,); without the rigid-body motion of a free rotor."""
    M, K = matrices(drive, position)
    rotor = M.shape[0] - 2
    kept = [i for i in range(M.shape[0]) if not (braked and i == rotor)]
    M, K = M[np.ix_(kept, kept)], K[np.ix_(kept, kept)]
    # Unknowns without mass (axial or rotary left out) are condensed; they follow the others statically.
    heavy = np.flatnonzero(M.diagonal() > 0.0)
    light = np.flatnonzero(M.diagonal() == 0.0)
    M = M[np.ix_(heavy, heavy)]
    if light.size:
        K = K[np.ix_(heavy, heavy)] - K[np.ix_(heavy, light)] @ np.linalg.solve(
            K[np.ix_(light, light)], K[np.ix_(light, heavy)]
        )
    else:
        K = K[np.ix_(heavy, heavy)]
    first = 0 if braked else 1
    squared = eigh(K, M, eigvals_only=True)[first : first + count]
    return np.asarray(np.sqrt(squared) / (2.0 * math.pi))
