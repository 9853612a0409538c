"""`feeddrive bode PLANT`: frequency response of the mechanics, or of the loops that a controller closes over them."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated

import typer

from feeddrive.cli.output import (
    JsonOption,
    deliver_saved,
    parts_of,
    warnings_as_lines,
)
from feeddrive.errors import InputError
from feeddrive.interface.axis import load
from feeddrive.interface.measured.reading import read, read_response_file
from feeddrive.output_folder import refuse_unusable


def command(
    plant: Annotated[str, typer.Argument(help="Plant file, or the name of a shipped machine.")],
    given: Annotated[
        str, typer.Option("--from", help="Input: motor_torque, cutting_force; of a loop also a set-point.")
    ] = "",
    output: Annotated[str, typer.Option("--to", help="Output: motor_speed, table_position, …")] = "",
    at: Annotated[str, typer.Option(help='Point about which is linearised, "x=200 mm,v=3 m/min".')] = "",
    positions: Annotated[str, typer.Option(help='Family over the table position, "0 mm,250 mm,500 mm".')] = "",
    payload: Annotated[str, typer.Option(help='Family over the mass on the table, "0 kg,100 kg".')] = "",
    loop: Annotated[str, typer.Option(help="open (with margins) or closed, with --scenario.")] = "",
    scenario: Annotated[str, typer.Option(help="Scenario or controller file whose controller closes the loops.")] = "",
    frequencies: Annotated[str, typer.Option("--range", help="Lowest and highest frequency.")] = "1 Hz,2 kHz",
    recording: Annotated[Path | None, typer.Option(help="Recording whose measured response is laid over.")] = None,
    mapping: Annotated[Path | None, typer.Option("--map", help="Mapping of a foreign recording to channels.")] = None,
    as_json: JsonOption = False,
    out: Annotated[Path | None, typer.Option("--out", help="Folder for bode.json and the figures.")] = None,
) -> None:
    """Frequency response in Hz, dB and degrees: resonances, margins, families over position and payload."""
    refuse_unusable(out)
    with warnings_as_lines():
        axis = load(plant)
        measured = None
        if recording is not None and (loop or scenario):
            raise InputError(
                "a recording is laid over the mechanics, not over loops", "--recording", "leave out --loop"
            )
        if recording is not None:
            measured = read_response_file(recording) or read(recording, mapping)
        found = axis.bode(
            given,
            output,
            at=at,
            positions=parts_of(positions),
            payload=parts_of(payload),
            controller=scenario or None,
            loop=loop,
            frequencies=parts_of(frequencies),
            measured=measured,
        )
        deliver_saved(found, as_json, out)
