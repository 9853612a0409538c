"""`feeddrive diagnose PLANT FILE` where FILE is no recording over time: measured numbers, or a frequency response."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path

from rich.console import Console

from feeddrive.cli.output import table, warnings_as_lines, working
from feeddrive.diagnosis.numbers.measured_file import holds_measured_numbers
from feeddrive.errors import InputError, printable
from feeddrive.interface.axis import load
from feeddrive.interface.explaining import explain, read_response_file
from feeddrive.output_folder import output_folder, refuse_unusable
from feeddrive.plant.file.entries import read_toml


def are_no_recordings(names: Sequence[str]) -> bool:
    """Whether what stands behind the plant is a file of measured numbers, or a frequency response.

    Raises:
        InputError: such a file beside others.
    """
    found = [name for name in names if Path(name).is_file() and _is_no_recording(Path(name))]
    if found and len(names) > 1:
        raise InputError("is no recording over time, and others stand beside it", found[0], "diagnose it by itself")
    return bool(found)


def _is_no_recording(path: Path) -> bool:
    if path.suffix.lower() == ".toml":
        return holds_measured_numbers(read_toml(path, "file"))
    try:
        return read_response_file(path) is not None
    except InputError:
        return False  # told where it is read as a recording


def explain_and_tell(
    plant: str, measured: str, at: str, controller: str | None, out: Path | None, as_json: bool
) -> None:
    """Trace the measurement to the plant file, write the files, and print the summary or the JSON.

    Raises:
        InputError: an input that cannot be used; nothing is written then.
    """
    if out is None:
        raise InputError("--out is missing", "", "give a folder for the report, such as --out report")
    refuse_unusable(out)
    with warnings_as_lines(), working("reading") as said:
        found = explain(load(plant), Path(measured), at=at, controller=controller, progress=said)
        with output_folder(out) as folder:
            found.save(folder)
    if as_json:
        print((out / "diagnosis.json").read_text(encoding="utf-8"), end="")
        return
    console = Console(soft_wrap=True, highlight=False)
    console.print(printable(found.verdict), markup=False)
    listing = found.listing()
    if listing.rows:
        console.print(table(listing.title, listing.headings, listing.rows), markup=False)
    console.print(f"report: {printable(str((out / 'report.html').resolve()))}", markup=False)
