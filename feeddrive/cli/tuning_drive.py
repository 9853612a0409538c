"""What `feeddrive tune --form --present` writes and tells: parameters of a drive, and what they would change."""

from __future__ import annotations

from pathlib import Path
from typing import Any

from rich.table import Table

from feeddrive.cli.output import table
from feeddrive.files import write_bytes_atomically, write_text_atomically
from feeddrive.interface.retuning import Retuned
from feeddrive.tuning.drive_settings import DriveSettings


def drive_content(typed: DriveSettings | None, retuned: Retuned | None) -> dict[str, Any]:
    """The same for programs."""
    content: dict[str, Any] = {}
    if typed is not None:
        content["drive"] = {
            "form": typed.form,
            "remarks": list(typed.remarks),
            "parameters": [
                {
                    "name": one.parameter.name,
                    "value": one.typed,
                    "unit": one.parameter.unit,
                    "resolution": one.parameter.resolution,
                    "meaning": one.parameter.meaning,
                    "source": one.parameter.source,
                }
                for one in typed.lines
            ],
            "file": typed.text,
        }
    if retuned is not None:
        changes = [{"setting": name, "present": old, "recommended": new} for name, old, new in retuned.changes]
        content["present"] = {"changes": changes, "remarks": list(retuned.remarks), "brings": retuned.brings}
    return content


def write_drive(typed: DriveSettings | None, retuned: Retuned | None, out: Path) -> None:
    """The drive's file and the figures of the comparison."""
    if typed is not None:
        ending = "hal" if typed.form == "linuxcnc" else "txt"
        write_text_atomically(out / f"{typed.form}.{ending}", typed.text)
    if retuned is not None:
        from feeddrive.report.figures.drawing import render

        for one in retuned.figures():
            drawn = render(one)
            if drawn.stem.startswith("retuned"):
                write_bytes_atomically(out / f"{drawn.stem}.png", drawn.png)


def drive_tables(typed: DriveSettings | None, retuned: Retuned | None) -> list[Table | str]:
    """What is printed."""
    shown: list[Table | str] = []
    if retuned is not None:
        rows = [list(row) for row in retuned.changes]
        shown.append(table("What would change", ("setting", "present", "recommended"), rows))
        found = retuned.listing()
        shown.append(table(found.title, found.headings, [list(row) for row in found.rows]))
        shown += [f"Note: {text}." for text in retuned.remarks]
    if typed is not None:
        shown.append(f"\nParameters of the drive, checked again in its resolution:\n\n{typed.text}")
    return shown
