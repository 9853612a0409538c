"""A change between recordings in words: what is other, by how much, and what it means on a machine."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass

from scipy.special import chdtri

from feeddrive.diagnosis.calibration.known import NORMAL_95
from feeddrive.diagnosis.likelihood.tolerances import SURE
from feeddrive.diagnosis.recordings.change_result import Measure
from feeddrive.effects.base import Port
from feeddrive.units.quantity import format_quantity, shown_unit

ONE_COMPONENT = SURE / NORMAL_95
"""Deviations from none from which a size is told, over those of an interval: those of a value beyond its tolerance."""

TWO_COMPONENTS = math.sqrt(float(chdtri(2, math.erfc(SURE / math.sqrt(2))))) / NORMAL_95
"""Length that two normal components have as seldom by chance, over that interval."""

EXPANSION = 11.7e-6
"""Expansion of steel [1/K], by which a change of lead is read as a temperature."""

WORDS = {
    ("friction_deviation", Port.TABLE, "coulomb_factor"): "guide Coulomb level",
    ("friction_deviation", Port.TABLE, "viscous_factor"): "guide viscous drag",
    ("friction_deviation", Port.SCREW, "coulomb_factor"): "Coulomb level of nut and bearings",
    ("friction_deviation", Port.SCREW, "viscous_factor"): "speed-dependent drag of nut and bearings",
    ("constant_force", Port.TABLE, "force"): "constant force",
    ("payload", Port.TABLE, "mass"): "moving mass",
    ("lead_error_cumulative", Port.TRANSMISSION, "slope"): "travel per length of the screw",
    ("stiffness_deviation", Port.TRANSMISSION, "factor"): "axial stiffness",
}
"""What a parameter is called in a sentence about a change; others by their own names."""

SIZES = {("backlash", "width"): "free play", ("preload_loss", "force"): "force up to which preload is lost"}
"""Parameters that grow and shrink: both values are stated, in one unit."""

FACTORS = ("coulomb_factor", "viscous_factor", "factor")
"""Parameters whose change is stated in per cent."""


STRAINS = (("lead_error_cumulative", "slope"), ("thermal_growth", "strain"))
"""Effects and parameters whose change is read as a temperature."""

_MASS = "Another workpiece or fixture, or a mass that was added."
_FORCE = "Another weight or counterbalance, a cable that pulls, or an offset of the drive."
_PHASE = "At the same amplitude: the encoder counts from another zero."

READINGS = {
    ("backlash", "width"): ("The play grew: wear of the nut, or a fixing that loosened.", "The play shrank."),
    ("payload", "mass"): (_MASS, _MASS),
    ("stiffness_deviation", "factor"): (
        "The transmission became stiffer: preload set anew.",
        "The transmission became softer: preload lost, or a bearing or fixing that loosened.",
    ),
    ("constant_force", "force"): (_FORCE, _FORCE),
    ("torque_ripple", "phase"): (_PHASE, _PHASE),
    ("ball_pass_ripple", "phase"): (_PHASE, _PHASE),
    ("lead_error_periodic", "phase"): (_PHASE, _PHASE),
}
"""Effect and parameter to the reading of a change to more, and to less."""


@dataclass(frozen=True)
class Moved:
    """One parameter in one recording, in another, and the difference of the first from the second."""

    effect: str
    port: Port
    key: str
    unit: str
    here: Measure
    there: Measure
    difference: Measure

    @property
    def by(self) -> float:
        """The difference, SI."""
        return self.difference.value

    @property
    def clear(self) -> bool:
        """Whether the interval of the difference leaves zero out."""
        return abs(self.by) > self.difference.half

    def is_told(self, value: Measure, none: float = 0.0) -> bool:
        """Whether one of its values is `SURE` deviations from none; an amplitude, of two components, never is below."""
        return abs(value.value - none) > value.half * (TWO_COMPONENTS if self.key == "amplitude" else ONE_COMPONENT)


def change_statement(moved: Moved, recording: str, against: str) -> str:
    """The change in one sentence."""
    name = WORDS.get((moved.effect, moved.port, moved.key))
    subject = name or f"{moved.effect.replace('_', ' ')} {moved.key.replace('_', ' ')}"
    way = "higher" if moved.by > 0 else "lower"
    places = f"in {recording} than in {against}"
    if moved.key in FACTORS and moved.there.value > 0:
        percent = _percent(abs(moved.by) / moved.there.value, moved.difference.half / moved.there.value)
        return f"{subject} {percent} {way} {places}"
    if (moved.effect, moved.key) in SIZES:
        grown = "grew" if moved.by > 0 else "shrank"
        values = from_to(_told(moved, moved.there), _told(moved, moved.here), moved.unit)
        spread = _short(moved.difference.half, moved.unit)
        return f"{SIZES[moved.effect, moved.key]} {grown} {values} (± {spread}): {against}, then {recording}"
    size, spread = _short(abs(moved.by), moved.unit), _short(moved.difference.half, moved.unit)
    # a level counts from what is declared, so that its values alone would say nothing
    here, there = (_short(_told(moved, one), moved.unit) for one in (moved.here, moved.there))
    values = "" if name else f": {here} after {there}"
    return f"{subject} {size} (± {spread}) {way} {places}{values}"


def from_to(first: float, last: float, unit: str) -> str:
    """Two values in the unit of the smaller that is not zero; in that of the larger, where it is beyond four digits."""
    small, large = sorted((abs(first), abs(last)))
    factor, _, label = shown_unit(small if small > 1e-4 * large else large, unit)
    a, b = (f"{value * factor:.4g}" for value in (first, last))
    return f"from {a} to {b} {label}".rstrip()


def _told(moved: Moved, value: Measure) -> float:
    """A value as it is said; 0 where it is not told from that."""
    return value.value if moved.is_told(value) else 0.0


def _short(value: float, unit: str) -> str:
    return format_quantity(float(f"{value:.3g}"), unit)


def _percent(size: float, spread: float) -> str:
    decimals = 0 if spread > 0.005 else 1
    return f"{100 * size:.{decimals}f} % (± {max(100 * spread, 0.1):.1f} %)"


def change_reading(moved: Moved, together: Sequence[Moved]) -> str:
    """What the change means on a machine; friction is read from its two parts together."""
    if moved.effect == "friction_deviation":
        return _friction(moved, together)
    if (moved.effect, moved.key) in STRAINS:
        kelvin = moved.by / EXPANSION
        return f"The screw is about {abs(kelvin):.2g} K {'warmer' if kelvin > 0 else 'colder'}, if it is of steel."
    more, less = READINGS.get((moved.effect, moved.key), ("", ""))
    return more if moved.by > 0 else less


def _friction(moved: Moved, together: Sequence[Moved]) -> str:
    parts = {m.key: m.by for m in together if (m.effect, m.port) == (moved.effect, moved.port) and m.clear}
    level, viscous = parts.get("coulomb_factor", 0.0), parts.get("viscous_factor", 0.0)
    if level and not viscous:
        return (
            "The level rose at the same viscous drag: more preload, wear, dirt or a lubricant that failed."
            if level > 0
            else "The level fell at the same viscous drag: run in, preload lost, or lubricated anew."
        )
    if viscous and not level:
        return (
            "The viscous drag fell at the same level: the lubricant is warmer or thinner."
            if viscous < 0
            else "The viscous drag rose at the same level: the lubricant is colder, fresh or of a thicker kind."
        )
    if level < 0 and viscous < 0:
        return "Level and viscous drag fell together: warmed up, or lubricated with less or thinner grease."
    if level > 0 and viscous > 0:
        return "Level and viscous drag rose together: colder, or greased anew."
    return (
        "Level and viscous drag moved apart: the shape of the friction over speed changed, as with another lubricant."
    )
