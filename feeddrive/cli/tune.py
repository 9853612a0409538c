"""`feeddrive tune PLANT`: recommended gains and filters of the cascade, each with its why and the margins reached."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated

import typer

from feeddrive.cli.output import JsonOption


def command(
    plant: Annotated[str, typer.Argument(help="Plant file, folder of a diagnosis, or the name of a shipped machine.")],
    margin_phase: Annotated[str, typer.Option(help="Least phase margin of either loop.")] = "45deg",
    margin_gain: Annotated[str, typer.Option(help="Least gain margin of either loop.")] = "8dB",
    positions: Annotated[str, typer.Option(help="Table positions it must hold at; along the stroke if left out.")] = "",
    payload: Annotated[str, typer.Option(help='Masses on the table it must hold with, "0 kg,100 kg".')] = "",
    velocity: Annotated[str, typer.Option(help="Table velocity about which is linearised.")] = "3 m/min",
    scenario: Annotated[
        str, typer.Option(help="Scenario or controller file of the drive: rates, delays, limits.")
    ] = "",
    velocity_rate: Annotated[str, typer.Option(help="Rate of the velocity loop, without --scenario.")] = "8 kHz",
    position_rate: Annotated[str, typer.Option(help="Rate of the position loop, without --scenario.")] = "2 kHz",
    current_bandwidth: Annotated[str, typer.Option(help="-3 dB of the current loop, without --scenario.")] = "1 kHz",
    dead_time: Annotated[str, typer.Option(help="Dead time of the torque, without --scenario.")] = "125 us",
    feedback: Annotated[
        str, typer.Option(help="motor or table: what the position loop reads; a scale if declared.")
    ] = "",
    form: Annotated[
        str, typer.Option(help="sinamics, twincat, heidenhain or linuxcnc: parameters of the drive, written and read.")
    ] = "",
    present: Annotated[
        Path | None, typer.Option(help="Present settings: a controller file, or parameters in the form of --form.")
    ] = None,
    as_json: JsonOption = False,
    out: Annotated[
        Path | None, typer.Option("--out", help="Folder for controller.toml, tune.json, figures and the drive's file.")
    ] = None,
) -> None:
    """Recommend K_p, T_n, filters and K_v that keep margins over all positions and payloads, and say why."""
    from feeddrive.cli.tuning import Wanted, run

    asked = {
        "phase": margin_phase, "gain": margin_gain, "velocity": velocity, "drive": scenario,
        "velocity_rate": velocity_rate, "position_rate": position_rate, "current_bandwidth": current_bandwidth,
        "dead_time": dead_time, "feedback": feedback,
    }  # fmt: skip
    run(Wanted(plant, asked, positions, payload, form, present), as_json, out)
