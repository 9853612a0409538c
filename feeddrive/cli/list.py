"""`feeddrive list`: the machines, scenarios and effects that come with feeddrive."""

from __future__ import annotations

from feeddrive.cli.output import JsonOption, OutOption, deliver, tables_of
from feeddrive.interface.shipped import shipped


def command(as_json: JsonOption = False, out: OutOption = None) -> None:
    """List the machines, scenarios and effects that come with feeddrive."""
    found = shipped()
    deliver(found.record(), tables_of(found.tables()), as_json, out)
