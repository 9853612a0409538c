"""Summary of a machine: values with their sources, inertias, stiffness, friction, modes, life."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import asdict, dataclass, replace
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np

from feeddrive.interface.machine.check import RATED, Life, UsedLife
from feeddrive.interface.machine.heat_summary import HeatSummary
from feeddrive.interface.shown import Listing, Shown, finite, write_figures, write_json
from feeddrive.parts.guide.guide_rating import Carriages
from feeddrive.plant.analysis.modes import Modes
from feeddrive.plant.analysis.rated_life import LifeRow
from feeddrive.plant.analysis.stiffness_budget import StiffnessBudget
from feeddrive.plant.analysis.summary import Summary as Figures
from feeddrive.plant.plant import Plant
from feeddrive.report.words.words import chain_remark
from feeddrive.typing import FloatArray
from feeddrive.units.quantity import format_quantity, percent

if TYPE_CHECKING:
    from feeddrive.report.figures.drawing import ReportFigure

_KNOWN = ("motor", "screw", "axial", "table")
"""Coordinates of the modes that people know; `record` has all."""


@dataclass(frozen=True, repr=False, eq=False)
class Stiffness(Shown):
    """Static stiffness at the table with the motor held, and whose compliance it is.

    Attributes:
        axis_name: of the machine.
        position: of the table [m].
        budget: everything that was computed, SI.
        plant: of which it is the answer; drawn where it is described by parts.
    """

    axis_name: str
    position: float
    budget: StiffnessBudget
    plant: Plant

    def __float__(self) -> float:
        """Combined stiffness [N/m]."""
        return self.budget.total

    @property
    def total(self) -> float:
        """Combined stiffness, motor held [N/m]."""
        return self.budget.total

    @property
    def held(self) -> str:
        """What holds the motor, in words."""
        drive = self.plant.drive
        return "motor held by its brake" if drive is not None and drive.motor.brake is not None else "motor held"

    def listing(self) -> Listing:
        """One row per part, then axial, torsional and combined."""
        budget = self.budget
        found = [(one.part, one.deformation, 1 / one.compliance, one.share) for one in budget.parts]
        found = [one for one in found if not one[1].startswith(one[0])]  # the springs of a lumped chain are the sums
        found += [
            ("axial stiffness", "", budget.axial, budget.axial_share),
            ("torsional stiffness at the table", "", budget.torsional, budget.torsional_share),
            (f"combined stiffness, {self.held}", "", budget.total, 1.0),
        ]
        rows = [
            [f"{part}, {how}" if how else part, format_quantity(k, "N/m"), percent(share, 1) if how else percent(share)]
            for part, how, k, share in found
        ]
        names = ("part", "deformation", "stiffness [N/m]", "share")
        records = [dict(zip(names, one, strict=True)) for one in found]
        at = f", table at {format_quantity(self.position, 'm')}" if self.plant.chain.varies else ""
        title = f"{self.axis_name}: stiffness, {self.held}{at}"
        return Listing(title, ("part", "felt at the table", "share of compliance"), rows, records)

    def _figures(self) -> Sequence[ReportFigure]:
        from feeddrive.report.figures.figure_stiffness import stiffness_figures

        return stiffness_figures(self.plant, self.position)


@dataclass(frozen=True, repr=False, eq=False)
class Summary(Shown):
    """Values with their sources, inertias, stiffness budget, friction, modes and rated life of a machine, and its heat.

    Attributes:
        plant: the machine.
        figures: everything that was computed, SI.
        life: rows of the rated life.
        carriages: of its guide, where declared.
        used: what a recording takes of the life, where one was given.
    """

    plant: Plant
    figures: Figures
    life: Sequence[LifeRow]
    carriages: Carriages | None = None
    used: UsedLife | None = None

    def listing(self) -> Listing:
        """The declared values."""
        return self.tables()[0]

    def tables(self) -> tuple[Listing, ...]:
        """Every table; those without rows are left out."""
        plant, found = self.plant, self.figures
        at = f", table at {format_quantity(found.position, 'm')}" if plant.chain.varies else ""
        values = [
            [key, ", ".join(format_quantity(one, unit) for one in _several(value)), source]
            for key, value, unit, source in self._values()
        ]
        records = [{"value": key, "quantity": v, "unit": unit, "source": s} for key, v, unit, s in self._values()]
        parts = [[key, format_quantity(one.value, one.unit), self._source(key)] for key, one in plant.data.items()]
        tables = [
            Listing(f"{plant.name}, {plant.chain.structure}", ("quantity", "value", "source"), values, records),
            Listing("Parts as declared", ("part", "value", "source"), parts),
            Listing(f"Inertia{at}", ("moves with", "at the motor", "at the table", "share"), self._inertias()),
            Listing(
                "What constant motion takes in + and in − direction; signs are those of the axis",
                ("speed", "force +", "force −", "torque +", "torque −"),
                self._friction(),
            ),
            self._modes(at),
            replace(Life(plant.name, self.life, plant).listing(), title=RATED.capitalize()),
        ]
        if found.stiffness is not None:
            stiffness = Stiffness(plant.name, found.position, found.stiffness, plant)
            tables.insert(3, replace(stiffness.listing(), title=f"Stiffness, {stiffness.held}{at}"))
        if self.used is not None:
            tables.append(self.used.listing())
        heat = HeatSummary(plant.heat).tables() if plant.has_heat else ()
        return (*(one for one in tables if one.rows), *heat)

    def record(self) -> dict[str, Any]:
        """Everything as plain values, SI; what is declared about heat under `heat`."""
        plant, found = self.plant, self.figures
        return {
            "format": "feeddrive-show/1",
            "name": plant.name,
            "structure": plant.chain.structure,
            "values": {
                key: {"value": value, "unit": unit, "source": source} for key, value, unit, source in self._values()
            },
            "parts": {
                key: {"value": one.value, "unit": one.unit, "source": self._source(key)}
                for key, one in plant.data.items()
            },
            "position": found.position,
            "inertia_at_motor": found.inertia_at_motor,
            "mass_at_table": found.mass_at_table,
            "inertias": [asdict(row) for row in found.inertias],
            "stiffness": asdict(found.stiffness) if found.stiffness else None,
            "friction": [asdict(row) for row in found.friction],
            "life": [asdict(row) for row in self.life],
            **({"used_life": self.used.record()} if self.used is not None else {}),
            "modes": {
                "coordinates": list(found.modes.coordinates),
                "braked": _modes_record(found.modes.braked),
                "free": _modes_record(found.modes.free),
                "chain_valid_to": finite(found.modes.chain_valid_to),
            },
            **({"heat": HeatSummary(plant.heat).declared()} if plant.has_heat else {}),
        }

    def save(self, folder: str | Path) -> Path:
        """Write `show.json` and the figures that the declared values allow; `not_drawn` says which are left out.

        Raises:
            InputError: the folder cannot be written.
        """
        place = Path(folder)
        write_json(self.record(), place / "show.json")
        write_figures(self._figures(), place)
        return place

    @property
    def not_drawn(self) -> tuple[str, ...]:
        """A line for each figure that is left out, with what to declare for it."""
        from feeddrive.report.figures.figure_parts import figures_left_out

        stiffness = "stiffness along the stroke: describe a distributed screw by its parts"
        return (*(() if self._has_places else (stiffness,)), *figures_left_out(self.plant, self.carriages))

    @property
    def _has_places(self) -> bool:
        """Whether the stiffness follows the nut along a screw that is described by its parts."""
        return self.plant.drive is not None and self.plant.chain.varies

    def _figures(self) -> Sequence[ReportFigure]:
        from feeddrive.report.figures.figure_parts import parts_figures
        from feeddrive.report.figures.figure_stiffness import stiffness_figures

        drawn = stiffness_figures(self.plant, self.figures.position) if self._has_places else ()
        used = self.used._figures() if self.used is not None else ()
        return (*drawn, *parts_figures(self.plant, self.carriages), *used)

    def _source(self, key: str) -> str:
        return self.plant.origins.get(key, "")

    def _values(self) -> list[tuple[str, Any, str, str]]:
        """Key, SI value, unit and source of every value of chain and effects."""
        plant = self.plant
        rows: list[tuple[str, Any, str, str]] = [
            (f"{one.section}.{one.section_key}", plant.chain.values[one.key], one.unit, self._source(one.key))
            for one in plant.chain.known_values
        ]
        if math.isfinite(plant.torque_limit):
            rows.append(("motor.torque_limit", plant.torque_limit, "N m", self._source("torque_limit")))
        for effect in plant.motion_effects:
            for parameter in (one for one in effect.parameters if one.key in effect.values):
                key = f"{effect.label}.{parameter.key}"
                rows.append((key, effect.values[parameter.key], parameter.unit, self._source(key)))
        return rows

    def _inertias(self) -> list[list[str]]:
        found = self.figures
        shown = [(one.coordinate.replace("_", " "), one.at_motor, one.at_table, one.share) for one in found.inertias]
        shown.append(("all", found.inertia_at_motor, found.mass_at_table, 1.0))
        return [
            [name, format_quantity(motor, "kg m^2"), format_quantity(table, "kg"), percent(share)]
            for name, motor, table, share in shown
        ]

    def _friction(self) -> list[list[str]]:
        units = ("m/s", "N", "N", "N m", "N m")
        return [
            [
                format_quantity(value, unit)
                for value, unit in zip(
                    (row.speed, row.force_forward, row.force_backward, row.torque_forward, row.torque_backward),
                    units,
                    strict=True,
                )
            ]
            for row in self.figures.friction
        ]

    def _modes(self, at: str) -> Listing:
        """Modes by the coordinates that people know, the largest of these 1."""
        found, drive = self.figures.modes, self.plant.drive
        kept = [i for i, name in enumerate(found.coordinates) if name in _KNOWN]
        held = "braked" if drive is not None and drive.motor.brake is not None else "held"
        rows = [
            [motor, format_quantity(frequency, "Hz"), percent(damping, 2), *(f"{part:+.2f}" for part in _scaled(shape))]
            for motor, modes in ((held, found.braked), ("free", found.free))
            for frequency, damping, shape in zip(
                modes.frequencies, modes.damping, modes.shapes.T[:, kept], strict=False
            )
        ]
        headings = ("motor is", "frequency", "damping", *(found.coordinates[i] for i in kept))
        return Listing(f"Modes, in table travel{at}", headings, rows, caption=chain_remark(found.chain_valid_to))


def _scaled(shape: FloatArray) -> FloatArray:
    """A shape over its largest entry; what rounding leaves of one that moves nothing here stays as it is."""
    largest = shape[np.argmax(np.abs(shape))]
    return (shape / largest if abs(largest) > 1e-6 else shape) + 0.0


def _modes_record(modes: Modes) -> dict[str, Any]:
    return {
        "frequencies": modes.frequencies.tolist(),
        "damping": modes.damping.tolist(),
        "shapes": modes.shapes.T.tolist(),
    }


def _several(value: Any) -> tuple[float, ...]:
    return value if isinstance(value, tuple) else (value,)
