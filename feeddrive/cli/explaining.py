"""`feeddrive diagnose PLANT NUMBERS.toml`: measured numbers in place of recordings."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path

from rich.console import Console

from feeddrive.cli.output import table, warnings_as_lines
from feeddrive.diagnose.numbers.measured_file import holds_measured_numbers
from feeddrive.diagnose.numbers.numbers_result import numbers_json
from feeddrive.errors import InputError
from feeddrive.interface.axis import load
from feeddrive.interface.numbers import explain
from feeddrive.plant.entries import read_toml


def are_measured_numbers(names: Sequence[str]) -> bool:
    """Whether what stands behind the plant is a file of measured numbers.

    Raises:
        InputError: measured numbers beside recordings.
    """
    holding = [name for name in names if Path(name).suffix.lower() == ".toml" and Path(name).is_file()]
    holding = [name for name in holding if holds_measured_numbers(read_toml(Path(name), "file"))]
    if holding and len(names) > 1:
        raise InputError(
            "measured numbers stand beside other files", holding[0], "diagnose them by themselves, in one file"
        )
    return bool(holding)


def run_numbers(plant: str, numbers: str, out: Path | None, as_json: bool) -> None:
    """Trace measured numbers to declared values, write the files, and print the summary or the JSON.

    Raises:
        InputError: an input that cannot be used; nothing is written then.
    """
    if out is None:
        raise InputError("--out is missing", "", "give a folder for the report, such as --out report")
    if out.exists() and not out.is_dir():
        raise InputError("--out is a file", str(out), "give a folder")
    with warnings_as_lines(), Console(stderr=True).status("reading") as status:
        found = explain(load(plant), Path(numbers), progress=status.update)
        found.save(out)
    if as_json:
        print(numbers_json(found.result), end="")
        return
    console = Console(soft_wrap=True, highlight=False)
    console.print(found.verdict, markup=False)
    listing = found.listing()
    console.print(table(listing.title, listing.headings, listing.rows), markup=False)
    console.print(f"report: {(out / 'report.html').resolve()}", markup=False)
