"""What is watched: quantities in the user's terms, each with the effects that move it, from the pooled terms."""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass

import numpy as np

from feeddrive.plant.analysis.modes import inertia_at_motor
from feeddrive.plant.analysis.stiffness_budget import stiffness_budget
from feeddrive.plant.plant import Plant
from feeddrive.trend.pooling import Pooled
from feeddrive.trend.regressors import TERMS, Grid
from feeddrive.typing import FloatArray

TOLD = 5.0
"""An amplitude is watched where it is so many times its scatter: below it is the length of a random arrow, and skew."""

LOOSEST = 4.0
"""Prior widths of friction, forces and masses over the declared ones: whatever a machine still moves with."""

POSITIVE = ("stiffness", "elastic_lost_motion", "mass", "coulomb")
"""Quantities that no machine has none of: recordings that say so do not show them, such as a compliance beside play in
one slow stroke under one force."""

WORST_LEAD = 1e-3
"""Lead error of a rolled screw of the lowest grade [m/m]: 0.21 mm over 300 mm (ISO 3408-3, T10), and what heat adds."""

WORST_WOBBLE = 1e-4
"""Lead error once per revolution of such a screw [m]; grade 5 of ISO 3408-3 allows a tenth of it."""


@dataclass(frozen=True, eq=False)
class Quantity:
    """One quantity over the recordings.

    Attributes:
        name: key in tables and JSON.
        words: for people.
        unit: SI.
        values: (n,), not a number where a recording does not show it.
        variance: relative, (n,).
        effects: names of effects that move it.
        declared: key of a plant file whose tolerance is its limit; empty where there is none.
        watched: whether changes are looked for; a derived one is only shown.
    """

    name: str
    words: str
    unit: str
    values: FloatArray
    variance: FloatArray
    effects: tuple[str, ...] = ()
    declared: str = ""
    watched: bool = True


def prior_widths(plant: Plant) -> dict[str, float]:
    """Widths of the priors of the terms, SI: so wide that they weigh only where a recording shows nothing."""
    radius = plant.chain.motor_radius
    mass = inertia_at_motor(plant) / radius**2
    force = LOOSEST * max(mass * 1.0, 100.0)  # N: the declared mass at 1 m/s^2
    compliance = 1.0 / _stiffness(plant) if plant.chain.elastic else 1e-8
    wobble = LOOSEST * WORST_WOBBLE
    return {
        "offset": 1e6, "slope": LOOSEST * WORST_LEAD, "play": 1e-2, "compliance": LOOSEST * compliance, "delay": 0.1,
        "lead_sine": wobble, "lead_cosine": wobble, "mass": LOOSEST * mass, "coulomb": force, "viscous": force / 0.1,
        "force": force, "ripple_sine": force, "ripple_cosine": force,
    }  # fmt: skip


def _stiffness(plant: Plant) -> float:
    return stiffness_budget(plant, plant.middle).total


def quantities_of(
    pooled: Mapping[str, tuple[Pooled, FloatArray]], plant: Plant, grid: Grid, count: int, absolute: bool
) -> tuple[Quantity, ...]:
    """The quantities of channels that were pooled: their terms and the numbers of the recordings, (k,), of `count`.

    `absolute` is whether the zero of the table against the motor is kept from recording to recording.
    """
    found: list[Quantity] = []
    if "table_position" in pooled:
        found += _travel(_Terms(*pooled["table_position"], count), plant, grid, absolute)
    if "motor_torque" in pooled:
        found += _forces(_Terms(*pooled["motor_torque"], count), plant)
    return tuple(one for one in found if np.isfinite(one.values).any() and (one.name not in POSITIVE or _is_some(one)))


def _is_some(quantity: Quantity) -> bool:
    """Whether values are more than none by 1.96 times what they scatter by from recording to recording.

    The scatter is by the median of the steps, 0.95 of it for normal ones: a jump of wear is none.
    """
    known = quantity.values[np.isfinite(quantity.values)]
    known = 1 / known if quantity.name == "stiffness" else known  # what is seen is a compliance
    scatter = float(np.median(np.abs(np.diff(known)))) / 0.95 if len(known) > 2 else 0.0
    return float(np.median(known)) > 1.96 * scatter


@dataclass(frozen=True, eq=False)
class _Terms:
    pooled: Pooled
    numbers: FloatArray
    count: int

    def __getitem__(self, name: str) -> tuple[FloatArray, FloatArray]:
        """Values and relative variances of a term over all recordings, (n,); not a number where there is none."""
        column = TERMS[self.pooled.channel].index(name)
        values, variance = np.full(self.count, np.nan), np.ones(self.count)
        values[self.numbers] = self.pooled.values[:, column]
        variance[self.numbers] = self.pooled.variance[:, column]
        return values, variance

    def declared(self, name: str) -> float:
        return float(self.pooled.declared[TERMS[self.pooled.channel].index(name)])

    def amplitude(self, stem: str) -> tuple[FloatArray, FloatArray] | None:
        """Length of a sine and cosine part, (n,); None where it is not distinguished from none."""
        (sine, variance), (cosine, _) = self[f"{stem}_sine"], self[f"{stem}_cosine"]
        known, size = np.isfinite(sine) & np.isfinite(cosine), np.hypot(sine, cosine)
        if np.count_nonzero(known) < 3:
            return None
        scatter = np.hypot(np.std(np.diff(sine[known])), np.std(np.diff(cosine[known]))) / 2
        return (size, variance) if np.median(size[known]) > TOLD * scatter else None


def _travel(terms: _Terms, plant: Plant, grid: Grid, absolute: bool) -> list[Quantity]:
    """Quantities of the table against the motor."""
    offset, slope, play, more = terms["offset"], terms["slope"], terms["play"], terms["compliance"]
    found = []
    if absolute:
        zero = offset[0] - slope[0] * grid.middle
        found.append(Quantity("offset", "table against motor at position 0", "m", zero - zero[np.isfinite(zero)][0],
                              offset[1], ("structure_growth",)))  # fmt: skip
    found.append(Quantity("slope", "travel per length beyond the lead", "m/m", slope[0], slope[1],
                          ("thermal_growth", "lead_error_cumulative"),
                          "effect.lead_error_cumulative.slope"))  # fmt: skip
    found.append(Quantity("play", "backlash (play of the transmission)", "m", play[0], play[1],
                          ("backlash", "preload_loss"), "effect.backlash.width"))  # fmt: skip
    if plant.chain.elastic:
        compliance = 1 / _stiffness(plant) + more[0]
        elastic = 2 * terms.pooled.slow_force * compliance
        found.append(Quantity("stiffness", "stiffness at the table", "N/m", 1 / compliance, more[1],
                              ("stiffness_deviation", "preload_loss"), "transmission.axial_stiffness"))  # fmt: skip
        found.append(Quantity("elastic_lost_motion", "elastic part of the lost motion in slow motion", "m", elastic,
                              more[1], watched=False))  # fmt: skip
        found.append(Quantity("lost_motion", "lost motion in slow motion, play and elastic", "m", play[0] + elastic,
                              play[1], watched=False))  # fmt: skip
    found.append(Quantity("delay", "table read later than the motor", "s", *terms["delay"], ("channel_delay",)))
    periodic = terms.amplitude("lead")
    if periodic is not None:
        found.append(
            Quantity("lead_ripple", "lead error once per motor revolution", "m", *periodic, ("lead_error_periodic",))
        )
    return found


def _forces(terms: _Terms, plant: Plant) -> list[Quantity]:
    """Quantities of the torque, as forces and masses at the table."""

    def whole(name: str) -> tuple[FloatArray, FloatArray]:
        values, variance = terms[name]
        return values + terms.declared(name), variance

    radius = plant.chain.motor_radius
    found = [
        Quantity("coulomb", "Coulomb friction, all of it as a force at the table", "N", *whole("coulomb"),
                 ("friction_deviation", "preload_loss"), "effect.guide_friction.coulomb"),
        Quantity("viscous", "viscous friction at the table", "N s/m", *whole("viscous"), ("friction_deviation",),
                 "effect.guide_friction.viscous"),
        Quantity("mass", "moving mass at the table, inertias included", "kg", *whole("mass"),
                 ("payload", "inertia_deviation"), "table.mass"),
        Quantity("force", "constant force along the axis", "N", *whole("force"), ("constant_force",),
                 "effect.constant_force.force"),
    ]  # fmt: skip
    ripple = terms.amplitude("ripple")
    if ripple is not None:
        found.append(Quantity("torque_ripple", "torque once per motor revolution", "N m", radius * ripple[0],
                              ripple[1], ("torque_ripple",)))  # fmt: skip
    return found


def means_of(means: Sequence[Mapping[str, float]]) -> tuple[Quantity, ...]:
    """Means of temperatures and growths over the recordings; shown, not searched: they follow the day."""
    names = sorted({name for one in means for name in one})
    return tuple(
        Quantity(name, name.replace("_", " "), "degC" if name.endswith("temperature") else "m",
                 np.array([one.get(name, math.nan) for one in means]), np.ones(len(means)), watched=False)
        for name in names
    )  # fmt: skip
