"""Files of measured numbers.

format = "feeddrive-measured/1"       # may be left out

[[measured]]
quantity = "axial_stiffness"          # see below
value = "191 N/µm"
at = "464 mm"                         # table position; the middle of the stroke if left out
tolerance = "3 %"                     # or in the unit of the value; two standard deviations; usual one if left out
source = "three repeats, line through force and displacement"

[[measured]]
quantity = "natural_frequency"
value = "185 Hz"
at = "464 mm"
motor = "held"                        # or "free"
mode = 1                              # may be left out

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
from pathlib import Path
from typing import Any

import numpy as np

from feeddrive.errors import InputError
from feeddrive.plant.analysis.steady import steady_motions
from feeddrive.plant.analysis.stiffness_budget import stiffness_budget
from feeddrive.plant.analysis.summary import summarise
from feeddrive.plant.chain.resolution import FIRST, resolved_modes
from feeddrive.plant.plant import Plant
from feeddrive.schema.measured import MEASURED
from feeddrive.schema.table import Table, whole_file
from feeddrive.schema.toml_text import read_toml
from feeddrive.units.quantity import format_quantity, parse, percent

HELD, FREE = "held", "free"


FORMAT = "feeddrive-measured/1"

_KEYS = ("quantity", "value", "at", "tolerance", "source")


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


@dataclass(frozen=True)
class MeasuredNumber:
    """One measured number.

    Attributes:
        quantity: name in `MEASURABLE`.
        value: [SI].
        deviation: standard deviation [SI], half of the tolerance.
        setting: how it was measured.
        source: who measured it, how; and whether its tolerance is a usual one.
    """

    quantity: str
    value: float
    deviation: float
    setting: Setting
    source: str

    @property
    def kind(self) -> Measurable:
        """What is measured."""
        return MEASURABLE[self.quantity]

    @property
    def name(self) -> str:
        """Quantity and where, as a channel is called: `natural_frequency_1_held at 464 mm`."""
        setting, parts = self.setting, [self.quantity]
        if "mode" in self.kind.keys:
            parts += [str(setting.mode), setting.motor]
        place = f" at {format_quantity(setting.at, 'm')}"
        speed = f", {format_quantity(setting.velocity, 'm/s')}" if "velocity" in self.kind.keys else ""
        return "_".join(parts) + place + speed


def holds_measured_numbers(entries: Mapping[str, Any]) -> bool:
    """Whether the entries of a TOML file are those of measured numbers."""
    return "measured" in entries or entries.get("format") == FORMAT


def read_measured_numbers(path: Path, plant: Plant) -> tuple[MeasuredNumber, ...]:
    """Read a file of measured numbers.

    Args:
        path: of the file.
        plant: gives the middle of the stroke, and refuses positions off it.

    Raises:
        InputError: not such a file, an unknown key or quantity, a value without unit, of another dimension or not
            positive, a position off the stroke.
    """
    entries = read_toml(path, "file of measured numbers")
    top = whole_file(entries, str(path), MEASURED)
    top.refuse_undeclared()
    for key in ("name", "description"):
        top.text(key, "")
    if "format" in entries and entries["format"] != FORMAT:
        raise InputError("is no file of measured numbers of this version", str(path), f'write format = "{FORMAT}"')
    tables = top.tables("measured")
    if not tables:
        raise InputError("holds no measured number", str(path), "write at least one [[measured]]")
    return tuple(_number(table, plant) for table in tables)


def _number(table: Table, plant: Plant) -> MeasuredNumber:
    quantity = table.choice("quantity", MEASURABLE)
    kind = MEASURABLE[quantity]
    table.refuse_unknown((*_KEYS, *kind.keys), {key: f"{quantity} has none" for key in ("motor", "mode", "velocity")})
    value = table.quantity("value", kind.unit, quantity)
    if not value > 0:
        shown = format_quantity(value, kind.unit)
        raise InputError(f"{shown} is not above zero", table.place("value"), "write what was measured")
    setting = Setting(
        at=_place(table, plant),
        motor=table.choice("motor", (HELD, FREE), HELD),
        mode=_mode(table),
        velocity=_velocity(table),
    )
    deviation, assumed = _deviation(table, value, kind)
    source = ", ".join(text for text in (table.text("source", table.source), assumed) if text)
    return MeasuredNumber(quantity, value, deviation, setting, source)


def _place(table: Table, plant: Plant) -> float:
    if "at" not in table.entries:
        return plant.middle
    at = table.quantity("at", "m", "at")
    if plant.stroke is not None and not plant.stroke[0] <= at <= plant.stroke[1]:
        ends = " to ".join(format_quantity(end, "m") for end in plant.stroke)
        raise InputError(f"{format_quantity(at, 'm')} is off the stroke", table.place("at"), f"choose from {ends}")
    plant.chain.refuse_off_screw(at, table.place("at"))
    return at


def _mode(table: Table) -> int:
    mode = table.entries.get("mode", 1)
    if isinstance(mode, bool) or not isinstance(mode, int) or not 1 <= mode <= 100:
        raise InputError(f"{mode!r} is no number of a mode", table.place("mode"), "count from 1")
    return mode


def _velocity(table: Table) -> float:
    if "velocity" not in table.entries:
        return Setting(0.0).velocity
    velocity = table.quantity("velocity", "m/s", "velocity")
    if not velocity > 0:
        raise InputError("a velocity that is not above zero", table.place("velocity"), "write its size")
    return velocity


def _deviation(table: Table, value: float, kind: Measurable) -> tuple[float, str]:
    """Standard deviation [SI], and what was assumed of it."""
    if "tolerance" not in table.entries:
        return 0.5 * kind.tolerance * value, f"tolerance {percent(kind.tolerance)} assumed"
    text = table.text("tolerance").removeprefix("±").strip()
    place = table.place("tolerance")
    try:
        size = parse(text, "1", place) * value
    except InputError:
        size = parse(text, kind.unit, place)
    if not size > 0:
        raise InputError(f"a tolerance of {text} is not above zero", place, 'write e.g. tolerance = "3 %"')
    return 0.5 * size, ""
