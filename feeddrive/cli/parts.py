"""`feeddrive parts [screw --diameter 32mm --lead 10mm]`: the parts catalogue."""

from __future__ import annotations

from typing import Annotated

import typer

from feeddrive.cli.output import JsonOption, OutOption, deliver, tables_of
from feeddrive.interface.machine.drafts import list_parts


def command(
    kind: Annotated[str, typer.Argument(help="screw, bearing, guide, coupling or motor; all if left out.")] = "",
    diameter: Annotated[str, typer.Option(help="Nominal diameter of a screw.")] = "",
    lead: Annotated[str, typer.Option(help="Lead of a screw.")] = "",
    bore: Annotated[str, typer.Option(help="Bore of a bearing.")] = "",
    rail: Annotated[str, typer.Option(help="Size of a guide's rail, such as 25.")] = "",
    torque: Annotated[str, typer.Option(help="Least rated torque of a coupling or a motor.")] = "",
    power: Annotated[str, typer.Option(help="Rated power of a motor.")] = "",
    as_json: JsonOption = False,
    out: OutOption = None,
) -> None:
    """List the parts catalogue; `part = "name"` in a plant file takes the values of a part."""
    given = {"diameter": diameter, "lead": lead, "bore": bore, "rail": rail, "torque": torque, "power": power}
    found = list_parts(kind, **{name: value for name, value in given.items() if value})
    listing = found.listing()
    deliver({"format": "feeddrive-parts/1", "parts": listing.records}, tables_of([listing]), as_json, out)
