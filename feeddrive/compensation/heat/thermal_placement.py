"""Where to mount one, two, three temperature sensors: the error that is left in the steady state of the filter.

    P = F (P - P Cᵀ (C P Cᵀ + R)⁻¹ C P) Fᵀ + W        (before a reading; scipy.linalg.solve_discrete_are)

The measure of observability is the table's: the standard deviation of its error along the stroke at constant speed,
after the best use of the readings, all unknowns as stated. At a constant speed it depends on nothing that was measured.
There are few places, so that all sets are compared. F is taken at the temperatures at which the axis settles.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from itertools import combinations

import numpy as np
import scipy.linalg

from feeddrive.compensation.heat.thermal_error import TableError
from feeddrive.compensation.heat.thermal_observer import ThermalObserver, thermal_observer
from feeddrive.compensation.heat.thermal_sensors import Sensor, mountable_places
from feeddrive.compensation.heat.thermal_unknowns import Unknowns
from feeddrive.errors import InputError
from feeddrive.thermal.machine_heat import Heat
from feeddrive.thermal.reduced.parametric_model import HeatModel
from feeddrive.typing import FloatArray


@dataclass(frozen=True)
class Placement:
    """A set of sensors and the error to be expected with it.

    Attributes:
        places: of the sensors.
        rms: over the stroke and the speeds that were looked at, one standard deviation [m].
        largest: at the worst place and speed, one standard deviation [m].
    """

    places: tuple[str, ...]
    rms: float
    largest: float


def placements(
    heat: Heat,
    model: HeatModel,
    error: TableError,
    count: int,
    speeds: Sequence[float],
    unknowns: Unknowns | None = None,
) -> tuple[Placement, ...]:
    """All sets of `count` mountable places, the best first.

    Args:
        heat: the machine.
        model: reduced.
        error: of the table, of this model.
        count: of sensors; 0 for the model alone.
        speeds: of the screw, at each of which the axis has settled [rad/s].
        unknowns: as of the observer.

    Raises:
        InputError: more sensors than places, or no speeds.
    """
    places = mountable_places(heat)
    if not 0 <= count <= len(places) or not len(speeds):
        what = f"{count} sensors at {len(speeds)} speeds"
        raise InputError(what, "placement", f"give at least one speed, and sensors up to the {len(places)} places")
    found = []
    for chosen in combinations(places, count):
        sensors = [Sensor(place) for place in chosen]
        observer = thermal_observer(heat, model, error, sensors, unknowns)
        spread = np.array([expected_deviation(observer, speed) for speed in speeds])
        found.append(Placement(chosen, float(np.sqrt(np.mean(spread**2))), float(spread.max())))
    return tuple(sorted(found, key=lambda one: one.rms))


def expected_deviation(observer: ThermalObserver, speed: float) -> FloatArray:
    """Standard deviation of the table's error along the stroke, settled at a speed [rad/s], (p,) [m]."""
    system, n = observer.system, observer.system.model.order
    (row,), (transition,) = observer.rows(np.array([speed]), np.array([observer.heat.ambient]))
    z = np.zeros(system.size)
    z[:n] = np.linalg.solve(np.eye(n) - transition.propagator[:n, :n], transition.spread[:n] @ row.heat)
    _, F = system.predicted(z, row, transition)
    W, C = system.wandering(), system.reading
    if len(C) == 0:
        P = scipy.linalg.solve_discrete_lyapunov(F, W)
    else:
        R = np.diag([sensor.noise**2 for sensor in system.sensors])
        before = scipy.linalg.solve_discrete_are(F.T, C.T, W, R)
        P = before - before @ C.T @ np.linalg.solve(C @ before @ C.T + R, C @ before)
    rows = observer.error.rows
    return np.asarray(np.sqrt(np.clip(np.einsum("pn,nm,pm->p", rows, P[:n, :n], rows), 0.0, None)))
