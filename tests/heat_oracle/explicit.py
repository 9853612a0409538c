"""The explicit scheme with the nut moving cell by cell: the oracle that everything faster is measured against.

    θ' = θ + Δt C⁻¹ (b - K_p θ)        (paper 002, equations (7), (10), (13))

with the matrix K_p of the place p where the nut stands. It is stable, and free of overshoot, while every node keeps a
non-negative share of its own temperature, Δt ≤ min C/K_ii (equation (14)). The heat lost to the air is summed step by
step, so that the energy is audited in every run. The steps are taken by `marching`: 180 min on the paper's own grid,
2.2 million steps of 4400 nodes, in a fraction of a minute where there is a C compiler, else in minutes.
"""

from __future__ import annotations

import math
from collections.abc import Mapping
from dataclasses import dataclass

import numpy as np
import scipy.sparse as sparse

from feeddrive.errors import InputError
from feeddrive.thermal.full.full_model import Discretisation, model_of
from feeddrive.thermal.full.grid import Cells, places_of
from feeddrive.thermal.reduced.parametric_model import HeatModel, Path
from feeddrive.thermal.reduced.system import HeatSystem
from feeddrive.thermal.rig import Rig, Travel, refuse_unless, refuse_unless_positive
from feeddrive.typing import FloatArray
from tests.heat_oracle.marching import March, Progressing, Step, march_of


@dataclass(frozen=True, eq=False)
class ExplicitRun:
    """Outcome of an explicit run.

    Attributes:
        times: middles of the periods that were averaged, (k,) [s].
        outputs: means over these periods, (k, p) [K, m].
        output_names: p names.
        profile: mean rise of the shaft's cross-sections over the last period, (axial,) [K].
        steps: how many were taken.
        step: Δt [s].
        heat_in, heat_out, heat_stored: by the heats, through the air, in the steel [J].
    """

    times: FloatArray
    outputs: FloatArray
    output_names: tuple[str, ...]
    profile: FloatArray
    steps: int
    step: float
    heat_in: float
    heat_out: float
    heat_stored: float

    @property
    def imbalance(self) -> float:
        """|in - out - stored| / in."""
        return abs(self.heat_in - self.heat_out - self.heat_stored) / max(abs(self.heat_in), 1e-300)


def paper_cells(rig: Rig) -> Cells:
    """Grid of paper 002: cells of 2.5 mm by 0.5 mm."""
    along, across, wall = 2.5e-3, 0.5e-3, rig.nut.outer_radius - rig.radius
    return Cells(
        round(rig.length / along), round(rig.radius / across), round(rig.nut.length / along), round(wall / across)
    )


def stability_limit(system: HeatSystem) -> float:
    """Longest explicit step [s]: every node keeps a non-negative share of itself (equation (14))."""
    return float(np.min(system.capacity / system.conductance.diagonal()))


def run_explicitly(
    parts: Discretisation, conductances: Mapping[Path, float], heats: Mapping[str, float], feed: float,
    duration: float, *, step: float | None = None, reports: int = 18, travel: Travel | None = None,
) -> ExplicitRun:  # fmt: skip
    """Run from rest, the nut moving to and fro, and average over whole periods.

    Args:
        parts: the rig in finite volumes.
        conductances: path to g.
        heats: input name to its constant value [W, K].
        feed: speed of the nut along the shaft [m/s].
        duration: at least one period, rounded down to whole ones [s].
        step: Δt [s]; None for the longest that is stable and divides the time in a cell.
        reports: how many periods are averaged, evenly over the run, the last one among them.
        travel: in place of the rig's.

    Raises:
        InputError: a step that is not stable, a nut that leaves the shaft, an unknown heat, a negative conductance.
    """
    refuse_unless_positive(feed, "m/s", "feed")
    refuse_unless_positive(duration, "s", "duration")
    refuse_unless(reports >= 1, f"{reports} reports are none", "reports", "write at least 1")
    travel = travel or parts.rig.travel
    parts.rig.refuse_travel(travel)
    places, _ = places_of(travel, parts.nut.spacing)
    systems = [model_of(parts, Travel(place, place)).at(conductances) for place in places]
    limit = min(stability_limit(system) for system in systems)
    dwell = _dwell(places, feed, limit)
    Δt, in_cell = _step(step, limit, dwell)
    march = march_of([_explicit_step(system, heats, Δt) for system in systems])
    there_and_back = [*range(len(systems)), *range(len(systems) - 2, 0, -1)]
    averaged = model_of(parts, travel)
    return _march(march, there_and_back, averaged, averaged.at(conductances), heats, Δt, in_cell, duration, reports)


def _dwell(places: FloatArray, feed: float, limit: float) -> float:
    """Time at one place on one pass [s]."""
    return float(places[1] - places[0]) / feed if len(places) > 1 else limit


def _step(wanted: float | None, limit: float, dwell: float) -> tuple[float, int]:
    """The step and how many there are at one place."""
    if wanted is not None:
        refuse_unless_positive(wanted, "s", "step")
        if wanted > limit * (1 + 1e-12):
            what = f"a step of {wanted * 1e3:.4g} ms is not stable"
            raise InputError(what, "step", f"write at most {limit * 1e3:.4g} ms")
    count = max(math.ceil(dwell / (wanted or limit) - 1e-9), 1)
    return dwell / count, count


def _explicit_step(system: HeatSystem, heats: Mapping[str, float], Δt: float) -> Step:
    given = np.zeros(len(system.input_names))
    for name, value in heats.items():
        given[system.column(name)] = value
    n, rate = system.order, Δt / system.capacity
    inner = sparse.eye_array(n) - sparse.diags_array(rate) @ system.conductance
    # What the columns of K do not return to other nodes goes to the air.
    leak = np.asarray(system.conductance.sum(axis=0)).ravel()
    surroundings = np.array([name in ("ambient", "coolant") for name in system.input_names])
    gained = float(np.sum(system.gains[:, surroundings] @ given[surroundings]))
    leak[np.abs(leak) < 1e-12 * system.conductance.diagonal()] = 0.0
    return Step(inner.tocsr(), rate * (system.gains @ given), Δt * leak, Δt * gained)


def _march(
    march: March, there_and_back: list[int], model: HeatModel, system: HeatSystem, heats: Mapping[str, float],
    Δt: float, in_cell: int, duration: float, reports: int,
) -> ExplicitRun:  # fmt: skip
    in_period = len(there_and_back) * in_cell
    period_time = in_period * Δt
    periods = int(duration / period_time + 1e-9)
    short = f"{duration:g} s is less than a period of the nut"
    refuse_unless(periods >= 1, short, "duration", f"write at least {period_time:.4g} s")
    reported = set(np.linspace(0, periods, min(reports, periods) + 1).astype(int)[1:] - 1)
    state = Progressing(np.zeros(system.order))
    means: list[FloatArray] = []
    times: list[float] = []
    for period in range(periods):
        total = np.zeros(system.order) if period in reported else None
        for place in there_and_back:
            march(place, in_cell, state, total)
        if total is not None:
            means.append(total / in_period)
            times.append((period + 0.5) * in_period * Δt)
    duration = periods * in_period * Δt
    heat_in = duration * sum(value for name, value in heats.items() if name not in ("ambient", "coolant"))
    return ExplicitRun(
        np.array(times), system.outputs(np.array(means)), system.output_names,
        np.asarray(model.profile @ means[-1]),
        periods * in_period, Δt, heat_in, state.lost, float(system.capacity @ state.rises),
    )  # fmt: skip
