"""Accuracy of an axis after ISO 230, measured: tables of a laser or ball-bar, or recordings with a scale."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import asdict, dataclass
from pathlib import Path
from typing import TYPE_CHECKING, Any, cast

from feeddrive.errors import InputError
from feeddrive.interface.axis import Axis, axis_of
from feeddrive.interface.measured.reading import read
from feeddrive.interface.quantities import Quantity, si
from feeddrive.interface.shown import Listing, Shown, finite
from feeddrive.metrology.circular import Circular, circular
from feeddrive.metrology.measured.forms import circle_test, drift_test, linear_test, part_of
from feeddrive.metrology.measured.measurements import CircleTest, DriftTest, LinearTest, refuse_radius
from feeddrive.metrology.measured.plant_share import PlantShare, plant_share
from feeddrive.metrology.measured.readings import Readings, is_laser_file, read_readings
from feeddrive.metrology.measured.standing import (
    believed,
    circle_angle,
    circle_test_from,
    drift_test_from,
    linear_test_from,
    part_of_recording,
)
from feeddrive.metrology.positioning import EDITION
from feeddrive.recording import Recording
from feeddrive.recording.channels import CHANNEL_UNITS
from feeddrive.recording.files.opening import first_bytes, head_of
from feeddrive.recording.traces.opened import could_be_trace
from feeddrive.report.words.number_text import fixed
from feeddrive.units.quantity import format_quantity, percent

if TYPE_CHECKING:
    from feeddrive.report.figures.drawing import ReportFigure

Test = LinearTest | DriftTest | CircleTest | Circular
Given = Recording | str | Path

_FEWEST, _LONG = 5, 2.0
"""Targets in all and in a metre, and approaches of each from a side; length of the axes that are tested so [m]."""

STANDARDS = {2: EDITION, 3: "ISO 230-3:2020", 4: "ISO 230-4:2022"}


@dataclass(frozen=True, repr=False, eq=False)
class Iso230(Shown):
    """Figures of a measured test.

    Attributes:
        name: of what was measured.
        part: of the standard, 2, 3 or 4.
        test: what was measured; for one axis of a circle its figures.
        share: what a plant explains of a positioning test; None without a plant.
    """

    name: str
    part: int
    test: Test
    share: PlantShare | None = None

    def figures_si(self) -> dict[str, float]:
        """Symbol of the standard to value, SI, in the order in which a report gives them."""
        if isinstance(self.test, LinearTest):
            return _linear_figures(self.test)
        if isinstance(self.test, DriftTest):
            return _drift_figures(self.test)
        return _circle_figures(self.test)

    def listing(self) -> Listing:
        """One row per figure."""
        found = self.figures_si()
        records = [{"figure": key, "value": value, "unit": unit_of(key)} for key, value in found.items()]
        rows = [[key, format_quantity(value, unit_of(key))] for key, value in found.items()]
        return Listing(f"{self.name}: {STANDARDS[self.part]}", ("figure", "value"), rows, records)

    def tables(self) -> tuple[Listing, ...]:
        """The figures, and with a plant what it explains of the mean deviations."""
        fewer = self._fewer_than_asked()
        short = (Listing("Fewer than ISO 230-2 asks for", ("", "found", "asked for"), fewer),) if fewer else ()
        if self.share is None:
            return (self.listing(), *short)
        one = self.share
        named = {"measured": (one.measured, ""), "the plant alone": (one.predicted, "")}
        named["left"] = (one.left, percent(one.left.explains, 1))
        named |= {f"left without {key}": (left, percent(left.explains, 1)) for key, left in one.without.items()}
        rows = [
            [name, *(f"{fixed(1e6 * v, 3)} µm" for v in (left.systematic, left.mean_range, left.reversal)), explains]
            for name, (left, explains) in named.items()
        ]
        title = "What the plant explains of the mean deviations"
        return (self.listing(), *short, Listing(title, ("", "E", "M", "B", "explains"), rows))

    def _fewer_than_asked(self) -> list[list[str]]:
        """What a positioning test has fewer of than ISO 230-2:2014, 5.3.2, asks for on an axis of up to 2 m."""
        if not isinstance(self.test, LinearTest):
            return []
        test, length = self.test, float(self.test.target[-1] - self.test.target[0])
        if length > _LONG:
            return []
        runs = min(side.shape[1] for side in (test.up, test.down) if side is not None)
        asked = max(_FEWEST, math.ceil(_FEWEST * length - 1e-9))
        found = (("targets", len(test.target), asked), ("approaches of each from one side", runs, _FEWEST))
        return [[what, str(n), str(least)] for what, n, least in found if n < least]

    def record(self) -> dict[str, Any]:
        """Plain values for JSON, SI."""
        content: dict[str, Any] = {
            "format": "feeddrive-iso230/1",
            "name": self.name,
            "standard": STANDARDS[self.part],
            "figures": {key: {"value": finite(v), "unit": unit_of(key)} for key, v in self.figures_si().items()},
        }
        if isinstance(self.test, LinearTest):
            content["targets"] = _target_records(self.test)
            content["fewer_than_asked"] = self._fewer_than_asked()
        if self.share is not None:
            shares = {"measured": self.share.measured, "plant": self.share.predicted, "left": self.share.left}
            content["plant"] = {name: asdict(one) for name, one in shares.items()}
            content["plant"]["left_without"] = {name: asdict(one) for name, one in self.share.without.items()}
        return content

    def save(self, folder: str | Path) -> Path:
        """Write `iso230.json`, `report.html` and the figures.

        Raises:
            InputError: the folder cannot be written.
        """
        from feeddrive.report.pages.iso230_page import Evaluated230, write_iso230

        shown = self.listing()
        found = Evaluated230(self.name, self.part, shown.title, shown.rows, self.test, self.share, self.record())
        return write_iso230(found, Path(folder))

    def _figures(self) -> Sequence[ReportFigure]:
        from feeddrive.report.figures.figure_iso230 import iso230_figures

        return iso230_figures(self.test, self.share)


def iso230(
    measured: Given | Sequence[Given],
    *,
    plant: Axis | str | Path | None = None,
    part: int | None = None,
    radius: Quantity | None = None,
    stop: Quantity | None = None,
    map: str | Path | None = None,
    decimal: str | None = None,
) -> Iso230:
    """Evaluate a measured test after ISO 230-2, -3 or -4.

    Args:
        measured: a table of readings, or a recording with `table_position`; for a circle of two axes two recordings.
        plant: an axis; says what of E, M and B it explains, and knows the lead where a recording has no set-point.
        part: 2 positioning, 3 drift of an axis that warms itself, 4 circle; identified from the columns if left out.
        radius: nominal, of a circle.
        stop: when the axis stops, of a test of drift.
        map: mapping file of a recording in a foreign format.
        decimal: "." or ",", where the file leaves it open.

    Raises:
        InputError: what is given makes no such test; one line with the remedy.
    """
    several = isinstance(measured, Sequence) and not isinstance(measured, str)
    given = cast(list[Given], list(measured) if several else [measured])  # type: ignore[arg-type]
    if not given or len(given) > 2:
        raise InputError(f"{len(given)} measurements", "iso230", "give one, or the two axes of a circle")
    plant = None if plant is None else axis_of(plant)
    if part not in (None, 2, 3, 4):
        raise InputError(f"no part {part}", "part", "write 2 (positioning), 3 (drift) or 4 (circle)")
    wishes = _Wishes(
        part, None if radius is None else si(radius, "m", "radius"), None if stop is None else si(stop, "s", "stop")
    )
    refuse_radius(wishes.radius)
    path = given[0]
    if len(given) == 1 and isinstance(path, str | Path) and map is None:
        readings = _table(Path(path), decimal)
        if readings is not None:
            return _of_table(readings, wishes, plant)
    recordings = [one if isinstance(one, Recording) else read(one, map, decimal) for one in given]
    return _of_recordings(recordings, wishes, plant)


@dataclass(frozen=True)
class _Wishes:
    part: int | None
    radius: float | None
    stop: float | None


def _table(path: Path, decimal: str | None) -> Readings | None:
    """The table of a file; None where it holds channels over time, or is no table of numbers at all."""
    start = first_bytes(path) if path.is_file() else b""
    if is_laser_file(head_of(start)):
        return read_readings(path, decimal)
    if could_be_trace(start) or path.suffix.lower() not in (".csv", ".gz", ".txt", ""):
        return None  # its own reader knows it
    try:
        readings = read_readings(path, decimal)
    except InputError:
        if path.is_file() and not _looks_like_table(path):
            return None  # a trace, which its own reader knows
        raise
    channels = {name.replace("_", " ") for name in CHANNEL_UNITS} - {"time"}
    return None if channels & set(readings.columns) else readings


def _looks_like_table(path: Path) -> bool:
    """Whether the first line that is no remark names columns of a table of readings."""
    lines = (line for line in head_of(first_bytes(path)).split("\n") if line.strip() and not line.startswith("#"))
    head = next(lines, "").lower()
    return any(
        word in head
        for word in ("target", "nominal", "soll", "zielposition", "angle [", "winkel", "radial", "at 0", "x [")
    )


def _of_table(readings: Readings, wishes: _Wishes, plant: Axis | None) -> Iso230:
    part = wishes.part or part_of(readings)
    name = Path(readings.where).name
    if part == 2:
        test = linear_test(readings)
        return Iso230(name, 2, test, None if plant is None else plant_share(test, plant.plant))
    if part == 3:
        drift = drift_test(readings, wishes.stop)
        _ = drift.heating
        return Iso230(name, 3, drift)
    circle = circle_test(readings, wishes.radius)
    _ = circle.circles
    return Iso230(name, 4, circle)


def _of_recordings(recordings: Sequence[Recording], wishes: _Wishes, plant: Axis | None) -> Iso230:
    first = recordings[0]
    target = believed(first, None if plant is None else plant.plant.chain.motor_radius)
    part = wishes.part or (4 if len(recordings) == 2 else part_of_recording(first, target))
    if len(recordings) == 2:
        if part != 4:
            raise InputError(f"two recordings for part {part}", "iso230", "give one; two are the axes of a circle")
        circle = circle_test_from(first, recordings[1], wishes.radius)
        _ = circle.circles
        return Iso230(f"{first.name}, {recordings[1].name}", 4, circle)
    if part == 2:
        test = linear_test_from(first, target)
        return Iso230(first.name, 2, test, None if plant is None else plant_share(test, plant.plant))
    if part == 3:
        drift = drift_test_from(first, target, wishes.stop)
        _ = drift.heating
        return Iso230(first.name, 3, drift)
    found = circle_angle(first, target)
    if found is None:
        raise InputError("the set-point is no sine", first.name, "record a circle, or say --part 2")
    angle, scale = found.angle, first["table_position"][found.rows]
    turns = math.floor((angle[-1] - angle[0]) / (2 * math.pi) + 1e-9)
    whole = angle > angle[-1] - 2 * math.pi * max(1, turns)
    return Iso230(first.name, 4, circular(angle[whole], scale[whole], wishes.radius or found.radius))


def unit_of(key: str) -> str:
    """SI unit of a figure."""
    if key.startswith("slope"):
        return "m/m"
    if key.startswith(("settled", "heating")):
        return "s"
    return "rad" if key == "lag" else "1" if key == "gain" else "m"


def _linear_figures(test: LinearTest) -> dict[str, float]:
    both = test.both
    found: dict[str, float] = {}
    if both is not None:
        found = {
            "A": both.accuracy,
            "E": both.systematic,
            "M": both.mean_range,
            "R": both.repeatability,
            "B": both.reversal_value,
            "mean B": both.mean_reversal,
        }
    for name, side in test.sides.items():
        arrow = "↑" if name == "up" else "↓"
        found |= {f"A{arrow}": side.accuracy, f"E{arrow}": side.systematic, f"R{arrow}": side.repeatability}
    return found


def _drift_figures(test: DriftTest) -> dict[str, float]:
    heating = test.heating
    found = {"heating until": test.stop}  # the end of the readings where no stop is given
    for one in heating.targets:
        at = format_quantity(one.position, "m")
        found |= {
            f"range at {at}, first hour": one.first_hour,
            f"range at {at}, heating": one.heating,
            f"range at {at}, whole test": one.whole,
            f"largest at {at}": one.largest,
            f"settled at {at} after": one.settling,
        }
    return {**found, "slope at the stop": heating.slope}


def _circle_figures(test: CircleTest | Circular) -> dict[str, float]:
    if isinstance(test, Circular):
        return {
            "G": test.deviation,
            "F max": test.radial_maximum,
            "F min": test.radial_minimum,
            "gain": test.gain,
            "lag": test.lag,
            "glitch at +": test.glitch[0],
            "glitch at -": test.glitch[1],
        }
    found: dict[str, float] = {}
    both = test.bidirectional
    if both is not None:
        found["G(b)"] = both
    for one in test.circles:
        sign = "+" if one.direction > 0 else "-"
        found |= {f"G {sign}": one.deviation, f"F max {sign}": one.radial_maximum, f"F min {sign}": one.radial_minimum}
        found |= {f"glitch {sign} at {90 * i}°": value for i, value in enumerate(one.glitches)}
    return found


def _target_records(test: LinearTest) -> list[dict[str, Any]]:
    records: list[dict[str, Any]] = [{"target [m]": float(place)} for place in test.target]
    for name, side in test.sides.items():
        for record, mean, deviation in zip(records, side.mean, side.deviation, strict=True):
            record |= {f"mean {name} [m]": float(mean), f"s {name} [m]": float(deviation)}
    both = test.both
    if both is not None:
        for record, reversal in zip(records, both.reversal, strict=True):
            record["B [m]"] = float(reversal)
    return records
