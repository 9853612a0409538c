"""A machine of parts as the three inertias nearest to it at a table position."""

from __future__ import annotations

from dataclasses import asdict, dataclass
from pathlib import Path
from typing import Any

from feeddrive.files import write_text_atomically
from feeddrive.interface.shown import Listing, Shown
from feeddrive.plant.analysis.lumping import Lumped as Found
from feeddrive.units.quantity import format_quantity


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
        return (Listing(title, ("value", "quantity"), values), self.listing(), *([left] if left.rows else []))

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
