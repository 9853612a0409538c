"""Natural frequencies of a machine along its stroke, and the three inertias nearest to it at a position."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import asdict, dataclass
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np

from feeddrive.files import write_text_atomically
from feeddrive.interface.shown import Listing, Shown, finite, write_figures, write_json
from feeddrive.plant.analysis.lumping import Lumped as Found
from feeddrive.plant.analysis.mode_map import ModeMap
from feeddrive.plant.plant import Plant
from feeddrive.report.words.words import chain_remark
from feeddrive.typing import FloatArray
from feeddrive.units.quantity import format_quantity

if TYPE_CHECKING:
    from feeddrive.report.figures.drawing import ReportFigure


SHOWN = 3
"""Frequencies of each kind in the table; `map` has all."""


@dataclass(frozen=True, repr=False, eq=False)
class Modes(Shown):
    """Natural frequencies along the stroke.

    Attributes:
        axis_name: of the machine.
        map: everything that was computed, SI.
        plant: of which it is the answer; drawn along its stroke.
    """

    axis_name: str
    map: ModeMap
    plant: Plant

    @property
    def positions(self) -> FloatArray:
        """Table positions [m], shape (n,)."""
        return self.map.positions

    @property
    def held(self) -> FloatArray:
        """Natural frequencies with the motor held [Hz], shape (n, k); the first is the anti-resonance of the loop."""
        return self.map.held

    @property
    def free(self) -> FloatArray:
        """Natural frequencies with the motor free, without the free motion [Hz], shape (n, k)."""
        return self.map.free

    def listing(self) -> Listing:
        """One row per table position; of a rigid structure, which has no modes, a single row that says so."""
        found, plant = self.map, self.plant
        title = f"{self.axis_name}: natural frequencies along the stroke"
        if not plant.chain.elastic:
            return Listing(title, ("structure", "natural frequencies"), [["rigid", "none: nothing is elastic"]])
        brake = plant.drive is not None and plant.drive.motor.brake is not None
        shown = [("table [mm]", 1e3 * found.positions)]
        exact = {"position [m]": found.positions}
        if plant.chain.varies:
            shown.append(("nut [mm]", 1e3 * found.nut))
            exact["nut [m]"] = found.nut
        shown.append(("k [N/µm]", 1e-6 * found.stiffness))
        exact["stiffness [N/m]"] = found.stiffness
        for name, heading, values in (
            ("held", "braked" if brake else "held", found.held),
            ("free", "free", found.free),
        ):
            exact |= {f"{name} f{i} [Hz]": column for i, column in enumerate(values.T, 1)}
            shown += [(f"{heading} f{i} [Hz]", column) for i, column in enumerate(values.T[:SHOWN], 1)]
        rows = [[f"{column[i]:.1f}" for _, column in shown] for i in range(len(found.positions))]
        records = [{key: float(column[i]) for key, column in exact.items()} for i in range(len(found.positions))]
        caption = chain_remark(float(np.min(found.chain_valid_to)))
        return Listing(title, [name for name, _ in shown], rows, records, caption)

    def record(self) -> dict[str, Any]:
        """Everything as plain values, SI."""
        return {
            "format": "feeddrive-modes/1",
            "name": self.axis_name,
            "structure": self.plant.chain.structure,
            **{key: value.tolist() for key, value in asdict(self.map).items() if key != "chain_valid_to"},
            "chain_valid_to": [finite(value) for value in self.map.chain_valid_to.tolist()],
        }

    def save(self, folder: str | Path) -> Path:
        """Write `modes.json`, and `modes.png` where the modes change along the stroke.

        Raises:
            InputError: the folder cannot be written.
        """
        place = Path(folder)
        write_json(self.record(), place / "modes.json")
        write_figures(self._figures(), place)
        return place

    def _figures(self) -> Sequence[ReportFigure]:
        from feeddrive.report.figures.figure_stiffness import modes_figure

        drawn = self.plant.chain.varies and self.plant.stroke is not None
        return (modes_figure(self.plant),) if drawn else ()


@dataclass(frozen=True, repr=False, eq=False)
class Lumped(Shown):
    """The three inertias nearest to a machine of parts at a table position, and how near they are.

    Attributes:
        axis_name: of the machine.
        found: the lumped machine, and its figures beside those of the machine, SI.
    """

    axis_name: str
    found: Found

    @property
    def text(self) -> str:
        """The plant file."""
        return self.found.text

    def listing(self) -> Listing:
        """Figures of both machines."""
        rows = [
            [
                one.name,
                format_quantity(one.machine, one.unit),
                format_quantity(one.lumped, one.unit),
                f"{one.error:+.2%}",
            ]
            for one in self.found.compared
        ]
        records = [{**asdict(one), "error": one.error} for one in self.found.compared]
        return Listing("How near they are", ("figure", "machine", "three inertias", "error"), rows, records)

    def tables(self) -> tuple[Listing, ...]:
        """Values of the three inertias, how near they are, what they cannot hold."""
        chain = self.found.plant.chain
        values = [
            [f"{one.section}.{one.section_key}", format_quantity(chain.values[one.key], one.unit)]
            for one in chain.known_values
        ]
        at = format_quantity(self.found.position, "m")
        title = f"{self.axis_name} as three inertias, table at {at}"
        left = Listing("Not in three inertias", ("what",), [[line] for line in self.found.left_out])
        return (Listing(title, ("quantity", "value"), values), self.listing(), *([left] if left.rows else []))

    def record(self) -> dict[str, Any]:
        """Everything as plain values, SI."""
        return {
            "format": "feeddrive-lumped/1",
            "name": self.axis_name,
            "position": self.found.position,
            "values": dict(self.found.plant.chain.values),
            "compared": self.listing().records,
            "left_out": list(self.found.left_out),
            "text": self.text,
        }

    def save(self, path: str | Path) -> Path:
        """Write the plant file.

        Raises:
            InputError: the file cannot be written.
        """
        write_text_atomically(Path(path), self.text)
        return Path(path)
