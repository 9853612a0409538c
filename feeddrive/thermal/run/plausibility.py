"""Rules by which the numbers of a thermal plant are judged at a glance; one that breaks is a warning, no error."""

from __future__ import annotations

import numpy as np

from feeddrive.plant.analysis.plausibility import Finding, Sense, Verdict
from feeddrive.thermal.plant import ThermalPlant
from feeddrive.thermal.run.summary import HeatRow, heat_rows

HOTTEST_RISE = 60.0
"""Settled rise at the highest speed beyond which grease and preload of a ball screw do not last [K]."""

LONGEST_WARM_UP = 6 * 3600.0
"""Slowest time constant of a screw alone [s]; a machine frame is slower, a screw is not."""

STEELS = {"conductivity": (10.0, 70.0, "W/(m K)"), "heat_capacity": (3e6, 4.5e6, "J/(m^3 K)")}
FILM = (2.0, 200.0)
"""Film coefficients of air [W/(m² K)]."""

CONTACT = (50.0, 20000.0)
"""Balls between nut and screw, per area [W/(m² K)]."""


def check_thermal_plant(plant: ThermalPlant) -> tuple[Finding, ...]:
    """Every rule's finding for a thermal plant."""
    rows = heat_rows(plant)
    return (
        *(f for key, (low, high, unit) in STEELS.items()
          for f in _between(key.replace("_", " "), getattr(plant.rig.steel, key), low, high, unit, "steels")),
        *_between("expansion", plant.rig.steel.expansion, 8e-6, 20e-6, "1/K", "steels"),
        *_between("smallest film coefficient", _films(rows)[0], *FILM, "W/(m^2 K)", "air, free to forced"),
        *_between("largest film coefficient", _films(rows)[1], *FILM, "W/(m^2 K)", "air, free to forced"),
        *_between("contact conductance", plant.contact, *CONTACT, "W/(m^2 K)", "paper 002, table 5, and ten times it"),
        _limit("settled rise of the nut at the highest speed", rows[-1].nut_rise, HOTTEST_RISE, "K", "grease, preload"),
        _limit("slowest time constant", rows[0].time_constants[0], LONGEST_WARM_UP, "s", "a screw without its frame"),
    )  # fmt: skip


def _films(rows: tuple[HeatRow, ...]) -> tuple[float, float]:
    values = np.array([(row.screw_film, row.nut_film) for row in rows])
    return float(values.min()), float(values.max())


def _between(rule: str, value: float, low: float, high: float, unit: str, source: str) -> list[Finding]:
    """The side that is broken, or the nearer one."""
    if value < np.sqrt(low * high):
        verdict = Verdict.KEPT if value >= low else Verdict.BROKEN
        return [Finding(rule, value, low, unit, Sense.AT_LEAST, verdict, source)]
    verdict = Verdict.KEPT if value <= high else Verdict.BROKEN
    return [Finding(rule, value, high, unit, Sense.AT_MOST, verdict, source)]


def _limit(rule: str, value: float, most: float, unit: str, source: str) -> Finding:
    return Finding(rule, value, most, unit, Sense.AT_MOST, Verdict.KEPT if value <= most else Verdict.BROKEN, source)
