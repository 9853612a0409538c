"""What `feeddrive iso230` does: evaluate, write the files, print the figures."""

from __future__ import annotations

import json
from dataclasses import dataclass
from pathlib import Path

from rich.table import Table

from feeddrive.cli.output import deliver, escaped, table, tell_written, warnings_as_lines
from feeddrive.interface.axis import load
from feeddrive.interface.iso230 import Iso230, iso230
from feeddrive.metrology.measured.plant_share import PlantShare, Share
from feeddrive.output_folder import output_folder, refuse_unusable
from feeddrive.units.quantity import format_quantity


@dataclass(frozen=True)
class Asked:
    """What was typed, as typed; empty where nothing was."""

    files: tuple[Path, ...]
    plant: str
    part: int
    radius: str
    stop: str
    mapping: Path | None
    decimal: str


def evaluate_and_tell(asked: Asked, as_json: bool, out: Path | None) -> None:
    """Evaluate the test, write the report where a folder is named, and print the figures.

    Raises:
        InputError: what is given makes no test of the standard; nothing is written then.
    """
    if out is not None:
        refuse_unusable(out)
    with warnings_as_lines():
        found = iso230(
            list(asked.files), plant=load(asked.plant) if asked.plant else None, part=asked.part or None,
            radius=asked.radius or None, stop=asked.stop or None, map=asked.mapping, decimal=asked.decimal or None,
        )  # fmt: skip
        if out is not None:
            with output_folder(out) as folder:
                found.save(folder)
    if as_json:
        print(escaped(json.dumps(found.record(), indent=2, ensure_ascii=False)))
        return
    deliver({}, _tables(found), False, None)
    tell_written(out, as_json)


def _tables(found: Iso230) -> list[Table]:
    listing = found.listing()
    shown = [table(listing.title, listing.headings, listing.rows)]
    if found.share is not None:
        shown.append(_share_table(found.share))
    return shown


def _share_table(share: PlantShare) -> Table:
    rows = [
        _row("measured", share.measured, ""), _row("the plant alone", share.predicted, ""),
        _row("left", share.left, f"{100 * share.left.explains:.1f} %"),
        *(_row(f"left without {name}", one, f"{100 * one.explains:.1f} %") for name, one in share.without.items()),
    ]  # fmt: skip
    return table("What the plant explains of the mean deviations", ("", "E", "M", "B", "explains"), rows)


def _row(name: str, one: Share, explains: str) -> list[str]:
    lengths = (one.systematic, one.mean_range, one.reversal)
    return [name, *(format_quantity(value, "m") for value in lengths), explains]
