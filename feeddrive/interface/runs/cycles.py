"""A servo cycle repeated for hours: what its heat does to position and torque."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING

from feeddrive.files import find_scenario
from feeddrive.interface.quantities import Quantity, positive
from feeddrive.interface.shown import Listing, Shown, write_figures
from feeddrive.simulate.scenario.scenario_file import read_scenario
from feeddrive.simulate.warm.warm_up_result import WarmUpPoint, WarmUpRun
from feeddrive.simulate.warm.warm_up_run import MacroSteps, run_warm_up
from feeddrive.thermal.full.full_model import NUT, SHAFT
from feeddrive.units.quantity import format_quantity

if TYPE_CHECKING:
    from feeddrive.report.figures.drawing import ReportFigure

_SHOWN = 10
"""Rows of the course; `to_pandas` has every macro step."""


@dataclass(frozen=True, repr=False, eq=False)
class Repeated(Shown):
    """Hours of a servo cycle: temperatures, drag, preload, and the error at each stop.

    Attributes:
        run: everything that was computed, SI; temperatures in degC.
    """

    run: WarmUpRun

    @property
    def imbalance(self) -> float:
        """Share of the work in that the balance of energy does not account for."""
        return self.run.energy.imbalance

    def listing(self) -> Listing:
        """The course in some rows."""
        points, stops = self.run.points, self.run.stops
        kept = points[:: -max(len(points) // _SHOWN, 1)][::-1]
        headings = ["time", "nut", "shaft", "nut drag", "bearings", "preload"]
        headings += [f"error at {format_quantity(stop, 'm')}" for stop in stops]
        title = f"{self.run.name}: {self.run.time[-1] / self.run.cycle_duration:.0f} cycles of "
        title += f"{format_quantity(self.run.cycle_duration, 's')}, {self.run.cycles} of them simulated"
        return Listing(title, headings, [_row(one) for one in kept], [self._record(one) for one in points])

    def tables(self) -> tuple[Listing, ...]:
        """The course, and the balance of energy."""
        energy = self.run.energy
        named = {
            "motor, mechanical": energy.motor,
            "its winding": energy.winding,
            "given to the air": energy.to_surroundings,
            "stored as heat": energy.stored,
            "left in the bed": energy.to_bed,
            "work out": energy.work_out,
        }
        rows = [[name, f"{value / 1e3:.1f} kJ"] for name, value in named.items()]
        rows.append(["not accounted for", f"{100 * self.imbalance:+.3f} % of the work in"])
        return self.listing(), Listing("Energy", ("", "energy"), rows)

    def save(self, folder: str | Path) -> Path:
        """Write the figure.

        Raises:
            InputError: the folder cannot be written.
        """
        write_figures(self._figures(), Path(folder))
        return Path(folder)

    def _record(self, point: WarmUpPoint) -> dict[str, float]:
        cycle = point.cycle
        errors = zip(self.run.stops, cycle.stop_errors, strict=True)
        return {
            "time [s]": point.time,
            **{f"{body} [degC]": value for body, value in point.temperatures.items()},
            "nut drag [N m]": cycle.nut_torque,
            "bearings [N m]": cycle.bearing_torque,
            "preload [N]": cycle.preload,
            **{f"error at {format_quantity(stop, 'm')} [m]": error for stop, error in errors},
        }

    def _figures(self) -> Sequence[ReportFigure]:
        from feeddrive.report.figures.figure_thermal import warm_axis_figure

        return (warm_axis_figure(self.run),)


def repeat(
    scenario: str | Path,
    duration: Quantity,
    *,
    set: Mapping[str, str] | None = None,
    tolerance: float = 0.05,
    progress: Callable[[float], None] | None = None,
) -> Repeated:
    """Repeat the cycle of a scenario for hours; it is simulated again whenever the temperatures have changed enough.

    Args:
        scenario: file or name of a shipped one: one cycle, from rest to rest where it began, of a machine that
            declares heat and how it is joined to the motion.
        duration: of the run, "4 h".
        set: key as of `--set` to a value with its unit.
        tolerance: error of the coupling of heat and motion in one step of the heat [K].
        progress: called with the share that is done.

    Raises:
        InputError: a scenario that is no cycle, a preload that is lost, a duration shorter than a cycle, a machine
            without heat.

    >>> import feeddrive as fd
    >>> warm = fd.repeat("warm_up_cycle", "10 min")
    >>> abs(warm.imbalance) < 1e-3
    True
    """
    lasting = positive(duration, "s", "duration", "4 h")
    read = read_scenario(find_scenario(str(scenario)), dict(set or {}))
    return Repeated(run_warm_up(read, lasting, MacroSteps(tolerance), progress))


def _row(point: WarmUpPoint) -> list[str]:
    cycle, at = point.cycle, point.temperatures
    return [
        f"{point.time / 60:.1f} min",
        f"{at[NUT]:.2f} °C",
        f"{at[SHAFT]:.2f} °C",
        f"{cycle.nut_torque:.3f} N m",
        f"{cycle.bearing_torque:.3f} N m",
        f"{cycle.preload:.0f} N",
        *(f"{1e6 * error:.2f} µm" for error in cycle.stop_errors),
    ]
