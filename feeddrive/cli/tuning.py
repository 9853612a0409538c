"""What `feeddrive tune` does: call the public interface, write, and tell."""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path
from typing import Any

from rich.table import Table

from feeddrive.cli.output import deliver, table, tell_written, warnings_as_lines, working
from feeddrive.files import find_plant
from feeddrive.interface.axis import load
from feeddrive.interface.retuning import Retuned
from feeddrive.interface.servo import Servo, drive_words, reached_rows, save_tuned, tune, tuned_record
from feeddrive.output_folder import output_folder, refuse_unusable
from feeddrive.tuning.drive_forms.drive_file import writer_of
from feeddrive.tuning.drive_settings import DriveSettings
from feeddrive.tuning.reasons import operating_points, rules


@dataclass(frozen=True)
class Wanted:
    """What was typed.

    Attributes:
        plant: file, folder or name.
        asked: keywords of `feeddrive.tune`, as text; empty where nothing was typed.
        positions, payload: values between commas.
        form: of a drive's parameters; empty for none.
        present: file of present settings.
    """

    plant: str
    asked: dict[str, str]
    positions: str
    payload: str
    form: str = ""
    present: Path | None = None


def run(wanted: Wanted, as_json: bool, out: Path | None) -> None:
    """Recommend, write and tell.

    Raises:
        InputError: anything in the request that cannot be used, or margins that cannot be met.
    """
    refuse_unusable(out)
    if wanted.form:
        writer_of(wanted.form, "--form")
    asked: dict[str, Any] = {key: text for key, text in wanted.asked.items() if text}
    with warnings_as_lines():
        axis = load(find_plant(wanted.plant))
        with working(f"tuning {axis.name}: velocity loop, filters, position loop at every operating point"):
            servo = tune(axis, positions=_listed(wanted.positions), payload=_listed(wanted.payload), **asked)
        typed = servo.to_drive(wanted.form) if wanted.form else None
        retuned = servo.compare(wanted.present, wanted.form) if wanted.present is not None else None
    if out is not None:
        with output_folder(out) as folder:
            save_tuned(servo, typed, retuned, folder)
    shown = [] if as_json else [*_recommended(servo), *_compared(retuned), *_typed(typed)]
    deliver(tuned_record(servo, typed, retuned), shown, as_json, None)
    tell_written(out, as_json)


def _listed(text: str) -> list[str] | None:
    return [part.strip() for part in text.split(",")] if text.strip() else None


def _recommended(servo: Servo) -> list[Table | str]:
    found, listing = servo.recommendation, servo.listing()
    return [
        table(listing.title, listing.headings, listing.rows),
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
    found = retuned.listing()
    return [
        table("What would change", ("setting", "present", "recommended"), [list(row) for row in retuned.changes]),
        table(found.title, found.headings, [list(row) for row in found.rows]),
        *(f"Note: {text}." for text in retuned.remarks),
    ]


def _typed(typed: DriveSettings | None) -> list[Table | str]:
    if typed is None:
        return []
    return [f"\nParameters of the drive, checked again in its resolution:\n\n{typed.text}"]
