"""Present settings of a drive beside the recommended ones: what would change, and what it would bring."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING, Any

from feeddrive.interface.shown import Listing, Shown
from feeddrive.metrology.loop_trial import LoopTrial, deviation, glitch, overshoot, settling, try_loop
from feeddrive.plant.plant import Plant
from feeddrive.servo.cascade import KV_UNIT, Cascade
from feeddrive.servo.filters import Filter
from feeddrive.servo.loop_response import loops_of
from feeddrive.servo.response_family import open_family
from feeddrive.simulate.scenario.scenario_controller import read_controller
from feeddrive.tuning.drive_forms.drive_file import read_drive_file
from feeddrive.tuning.drive_settings import facts_of
from feeddrive.tuning.filter_choice import is_low_pass
from feeddrive.tuning.reasons import describe
from feeddrive.units.quantity import format_quantity

if TYPE_CHECKING:
    from feeddrive.report.figures.drawing import ReportFigure

LOWEST, HIGHEST = 1.0, 4000.0
"""Frequencies of the figures [Hz]."""


@dataclass(frozen=True, repr=False, eq=False)
class Retuned(Shown):
    """What the recommended settings would change and bring, on the plant.

    Attributes:
        plant: the machine, as diagnosed where a diagnosis was given.
        present, recommended: the two loops.
        before, after: what they do, in the same cases.
        remarks: what is odd in the present settings.
    """

    plant: Plant
    present: Cascade
    recommended: Cascade
    before: tuple[LoopTrial, ...]
    after: tuple[LoopTrial, ...]
    remarks: tuple[str, ...]

    @property
    def changes(self) -> list[tuple[str, str, str]]:
        """Setting, present value, recommended value, as shown."""
        old, new = self.present, self.recommended
        rows = [
            ("K_p", f"{old.velocity_gain:.4g} N m s/rad", f"{new.velocity_gain:.4g} N m s/rad"),
            ("T_n", _time(old.reset_time), _time(new.reset_time)),
            ("K_p/T_n", f"{_integral(old):.4g} N m/rad", f"{_integral(new):.4g} N m/rad"),
            ("K_v", f"{old.position_gain / KV_UNIT:.4g} (m/min)/mm", f"{new.position_gain / KV_UNIT:.4g} (m/min)/mm"),
        ]
        count = max(len(old.torque_filters), len(new.torque_filters))
        for place in range(count):
            before, after = (
                _filter(some[place]) if place < len(some) else "none"
                for some in (old.torque_filters, new.torque_filters)
            )
            rows.append((f"filter {place + 1}", before, after))
        return [row for row in rows if row[1] != row[2]]

    @property
    def brings(self) -> list[dict[str, Any]]:
        """One row per case: margins, bandwidths [Hz], step and circle [s, m], before and after."""
        return [
            {"case": describe(old.reached.case), "before": _figures_of(old), "after": _figures_of(new)}
            for old, new in zip(self.before, self.after, strict=True)
        ]

    def listing(self) -> Listing:
        """One row per case and figure."""
        rows, records = [], []
        for one in self.brings:
            for key, unit in _FIGURES.items():
                old, new = one["before"][key], one["after"][key]
                if old is None and new is None:
                    continue
                rows.append([one["case"], key, _shown(old, unit), _shown(new, unit)])
                records.append({"case": one["case"], "figure": f"{key} [{unit}]", "before": old, "after": new})
        title = f"{self.plant.name}: what the recommended settings bring"
        return Listing(title, ("case", "figure", "before", "after"), rows, records)

    def figures(self) -> Sequence[ReportFigure]:
        """Step, circle, and the open loops of the present settings."""
        return self._figures()

    def _figures(self) -> Sequence[ReportFigure]:
        from feeddrive.report.figures.figure_bode import bode_figure
        from feeddrive.report.figures.figure_scenario import retuned_circle_figure, retuned_step_figure

        cases = [one.reached.case for one in self.before]
        drawn = [retuned_step_figure(self.before, self.after), retuned_circle_figure(self.before, self.after)]
        for loop in loops_of(self.present):
            family = open_family(self.plant, self.present, loop, cases, LOWEST, HIGHEST)
            drawn.append(bode_figure(family))
        return [one for one in drawn if one is not None]


_FIGURES = {
    "velocity loop, phase margin": "deg",
    "velocity loop, gain margin": "dB",
    "position loop, phase margin": "deg",
    "position loop, gain margin": "dB",
    "velocity loop, bandwidth": "Hz",
    "position loop, bandwidth": "Hz",
    "step, overshoot": "1",
    "step, settling to 2 %": "s",
    "circle, deviation": "m",
    "circle, largest glitch": "m",
}


def compare(plant: Plant, present: Cascade, recommended: Cascade, trials: Sequence[Any]) -> Retuned:
    """Both loops in the same cases of position, payload and velocity; refuses one that cannot be linearised there."""
    before, after = (tuple(try_loop(plant, one, case) for case in trials) for one in (present, recommended))
    wide = [one for one in present.torque_filters if one.kind == "notch" and is_low_pass(*_notch(one))]
    remarks = [
        f"present: a notch at {_notch(one)[0]:.4g} Hz that is {_notch(one)[1]:.4g} Hz wide is a low-pass"
        for one in wide
    ]
    remarks += [f"present: unstable with the {describe(one.reached.case)}" for one in before if not one.stable]
    return Retuned(plant, present, recommended, before, after, tuple(remarks))


def read_present(path: Path, form: str, plant: Plant, drive: Cascade) -> Cascade:
    """The loop of a file of present settings: a controller file (`.toml`), or the parameters of a drive in a form.

    `drive` gives rates, delays, limits and feed-forward where the file holds parameters alone.
    """
    if path.suffix.lower() == ".toml":
        return read_controller(path, plant)
    loop = read_drive_file(path, form or "sinamics", facts_of(plant, drive))
    return loop.on(drive)


def _notch(one: Filter) -> tuple[float, float]:
    """Frequency and bandwidth of a notch [Hz]."""
    return one.frequency, one.denominator[1] / (2 * math.pi)


def _integral(cascade: Cascade) -> float:
    return cascade.velocity_gain / cascade.reset_time


def _time(value: float) -> str:
    return format_quantity(value, "s") if math.isfinite(value) else "none"


def _filter(one: Filter) -> str:
    if one.kind == "notch":
        frequency, bandwidth = _notch(one)
        numerator = one.numerator[1]
        depth = f"{20 * math.log10(one.denominator[1] / numerator):.3g} dB" if numerator else "complete"
        return f"notch {frequency:.4g} Hz, {bandwidth:.3g} Hz wide, {depth}"
    return f"{one.kind} {one.frequency:.4g} Hz"


def _figures_of(one: LoopTrial) -> dict[str, float | None]:
    velocity, position = one.reached.velocity, one.reached.position
    values = (
        velocity.phase,
        velocity.gain,
        position.phase,
        position.gain,
        *one.bandwidths,
        overshoot(one.step),
        settling(one.step),
        deviation(one.circle),
        glitch(one.circle),
    )
    kept = values if one.stable else (math.nan,) * len(values)
    return {key: float(value) if math.isfinite(value) else None for key, value in zip(_FIGURES, kept, strict=True)}


def _shown(value: float | None, unit: str) -> str:
    if value is None:
        return "-"
    if unit == "1":
        return f"{100 * value:.1f} %"
    return (
        f"{value:.1f} {'°' if unit == 'deg' else unit}" if unit in ("deg", "dB", "Hz") else format_quantity(value, unit)
    )
