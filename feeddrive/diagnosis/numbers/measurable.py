"""What can be measured as one number, and what a plant gives for it.

| quantity | meaning | unit |
|---|---|---|
| axial_stiffness | force on the table over its displacement, motor held | N/m |
| natural_frequency | of the `mode`-th mode, motor `held` or `free` | Hz |
| drag_torque | half the difference of the motor torque between + and - at constant `velocity` | N m |
| lost_motion | travel by which the table stays behind the motor's encoder after a reversal at `velocity` | m |
| inertia_at_motor | everything that moves, seen at the motor | kg m^2 |

The natural frequency counts a declared brake as what holds the motor. Lost motion is backlash and the wind-up by all
declared friction together; the table stands still when it is read on both sides, as ISO 230-2 reads it.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass

import numpy as np

from feeddrive.errors import InputError
from feeddrive.plant.analysis.steady import steady_motions
from feeddrive.plant.analysis.stiffness_budget import stiffness_budget
from feeddrive.plant.analysis.summary import summarise
from feeddrive.plant.chain.resolution import FIRST, resolved_modes
from feeddrive.plant.plant import Plant

HELD, FREE = "held", "free"


@dataclass(frozen=True)
class Setting:
    """How a number was measured.

    Attributes:
        at: table position [m].
        motor: `HELD` or `FREE`; of natural frequencies.
        mode: counted from 1; of natural frequencies.
        velocity: of the table [m/s]; of drag torque and lost motion.
    """

    at: float
    motor: str = HELD
    mode: int = 1
    velocity: float = 1e-3


@dataclass(frozen=True)
class Measurable:
    """A quantity that can be measured as one number.

    Attributes:
        unit: SI unit.
        words: for sentences.
        keys: of `Setting` that matter beside the position.
        tolerance: usual uncertainty of one careful measurement, as a share; two standard deviations.
        of: what a plant gives.
    """

    unit: str
    words: str
    keys: tuple[str, ...]
    tolerance: float
    of: Callable[[Plant, Setting], float]


def _stiffness(plant: Plant, setting: Setting) -> float:
    if not plant.chain.elastic:
        raise InputError("nothing is elastic in a rigid machine", plant.name, "declare another structure")
    return stiffness_budget(plant, setting.at).total


def _frequency(plant: Plant, setting: Setting) -> float:
    resolved = resolved_modes(plant, setting.at, max(setting.mode, FIRST))
    modes = resolved.braked if setting.motor == HELD else resolved.free
    found = modes.frequencies[modes.frequencies > 0]
    if setting.mode > len(found):
        what = f"mode {setting.mode} with the motor {setting.motor}"
        raise InputError(f"there is no {what}", plant.name, f"the declared chain has {len(found)}")
    return float(found[setting.mode - 1])


def _drag(plant: Plant, setting: Setting) -> float:
    forward, backward = steady_motions(plant, (setting.velocity, -setting.velocity), setting.at)
    return 0.5 * (forward.torque - backward.torque)


def _lost_motion(plant: Plant, setting: Setting) -> float:
    forward, backward = steady_motions(plant, (setting.velocity, -setting.velocity), setting.at)
    row = np.array(plant.chain.motor(plant.chain_values()), dtype=float)
    coordinates = len(row)
    angle = float(row @ (forward.state - backward.state)[:coordinates])
    return plant.chain.motor_radius * angle


def _inertia(plant: Plant, setting: Setting) -> float:
    return summarise(plant, setting.at).inertia_at_motor


MEASURABLE: Mapping[str, Measurable] = {
    "axial_stiffness": Measurable("N/m", "static stiffness at the table, motor held", (), 0.03, _stiffness),
    "natural_frequency": Measurable("Hz", "natural frequency", ("motor", "mode"), 0.01, _frequency),
    "drag_torque": Measurable("N m", "drag torque", ("velocity",), 0.05, _drag),
    "lost_motion": Measurable("m", "lost motion", ("velocity",), 0.10, _lost_motion),
    "inertia_at_motor": Measurable("kg m^2", "inertia at the motor", (), 0.03, _inertia),
}
"""Quantity to what it is. The usual uncertainties: a straight line through force and displacement of a gauge of 1 µm, a
hammer's spectrum of 1 Hz at 100 Hz, a drive's torque display, a dial gauge, a torque over an acceleration."""
