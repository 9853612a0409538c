"""`feeddrive check PLANT`: rules of plausibility, each with value, limit, verdict and source."""

from __future__ import annotations

from typing import Annotated

import typer

from feeddrive.cli.output import JsonOption, OutOption, deliver, tables_of, warnings_as_lines
from feeddrive.interface.axis import load


def command(
    plant: Annotated[str, typer.Argument(help="Plant file, or the name of a shipped machine.")],
    position_gain: Annotated[
        str, typer.Option(help="Position gain of the controller, such as '50 1/s'; the declared one if left out.")
    ] = "",
    as_json: JsonOption = False,
    out: OutOption = None,
) -> None:
    """Check a machine against rules of plausibility; warnings do not change the exit status."""
    with warnings_as_lines():
        found = load(plant).check(position_gain or None)
    tables = tables_of([found.listing()])
    tables[0].columns[0].min_width = 14  # no word of a rule is longer; more would leave 80 letters too few for the rest
    deliver(found.record(), tables, as_json, out)
