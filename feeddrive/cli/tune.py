"""`feeddrive tune PLANT`: recommended gains and filters of the cascade, each with its why and the margins reached."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated, Any

import typer
from rich.table import Table

from feeddrive.cli.output import (
    JsonOption,
    deliver,
    parts_of,
    print_written,
    table,
    tables_of,
    warnings_as_lines,
    working,
)  # fmt: skip
from feeddrive.files import find_plant
from feeddrive.interface.axis import load
from feeddrive.interface.retuning import Retuned
from feeddrive.interface.servo import Servo, drive_words, reached_rows, save_tuned, tune, tuned_record
from feeddrive.output_folder import output_folder, refuse_unusable
from feeddrive.tuning.drive_forms.drive_file import writer_of
from feeddrive.tuning.drive_settings import DriveSettings
from feeddrive.tuning.reasons import operating_points, rules


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
    refuse_unusable(out)
    if form:
        writer_of(form, "--form")
    asked: dict[str, Any] = {
        "phase": margin_phase, "gain": margin_gain, "velocity": velocity, "drive": scenario,
        "velocity_rate": velocity_rate, "position_rate": position_rate, "current_bandwidth": current_bandwidth,
        "dead_time": dead_time, "feedback": feedback, "positions": parts_of(positions), "payload": parts_of(payload),
    }  # fmt: skip
    with warnings_as_lines():
        axis = load(find_plant(plant))
        with working(f"tuning {axis.name}: velocity loop, filters, position loop at every operating point"):
            servo = tune(axis, **{key: given for key, given in asked.items() if given})
        typed = servo.to_drive(form) if form else None
        retuned = servo.compare(present, form) if present is not None else None
    if out is not None:
        with output_folder(out) as folder:
            save_tuned(servo, typed, retuned, folder)
    shown = [] if as_json else [*_recommended(servo), *_compared(retuned), *_typed(typed)]
    deliver(tuned_record(servo, typed, retuned), shown, as_json, None)
    print_written(out, as_json)


def _recommended(servo: Servo) -> list[Table | str]:
    found = servo.recommendation
    return [
        *tables_of([servo.listing()]),
        table("Margins reached", ("case", "velocity loop", "position loop", "peaks of sensitivity"),
              reached_rows(servo)),
        f"Margins hold at these operating points: {operating_points(found)}. Between them they are not looked at.",
        f"Drive: {drive_words(servo.cascade)}.",
        *(f"Rule: {text}." for text in rules(servo.plant, found)),
        "\nController file:\n\n" + servo.text,
    ]  # fmt: skip


def _compared(retuned: Retuned | None) -> list[Table | str]:
    if retuned is None:
        return []
    return [
        table("What would change", ("setting", "present", "recommended"), retuned.changes),
        *tables_of([retuned.listing()]),
        *(f"Note: {text}." for text in retuned.remarks),
    ]


def _typed(typed: DriveSettings | None) -> list[Table | str]:
    if typed is None:
        return []
    return [f"\nParameters of the drive, checked again in its resolution:\n\n{typed.text}"]
