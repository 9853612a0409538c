"""`feeddrive diagnose`: find what a machine's model lacks."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path
from typing import Annotated

import typer
from rich.console import Console

from feeddrive.cli.output import escaped, table, warnings_as_lines, working
from feeddrive.diagnosis.numbers.measured_file import holds_measured_numbers
from feeddrive.errors import InputError, printable
from feeddrive.interface.axis import load
from feeddrive.interface.measured.diagnosed import Diagnosed
from feeddrive.interface.measured.diagnosis_run import Job, Options, continued_job, diagnose_files, first_job
from feeddrive.interface.measured.reading import read_response_file
from feeddrive.output_folder import output_folder, refuse_unusable
from feeddrive.schema.toml_text import read_toml


def command(
    arguments: Annotated[
        list[str],
        typer.Argument(
            metavar="PLANT REC...",
            help="Plant file, or the name of a shipped plant; then the recordings that are fitted, oldest first, or "
            "one TOML file of measured numbers, or one frequency response. With --continue the plant may be left out.",
        ),
    ],
    out: Annotated[
        Path | None, typer.Option("--out", help="Folder for the report and its files; that of --continue if left out.")
    ] = None,
    validate: Annotated[
        list[Path] | None, typer.Option("--validate", help="Recording to judge on; may be given again.")
    ] = None,
    earlier: Annotated[
        Path | None, typer.Option("--continue", help="Folder of an earlier diagnosis that the recordings are added to.")
    ] = None,
    split: Annotated[
        float | None, typer.Option("--split", help="Share fitted where no --validate is given; 0.75 if left out.")
    ] = None,
    measured: Annotated[
        Path | None, typer.Option("--measured", help="File of numbers that were measured beside the recordings.")
    ] = None,
    mapping: Annotated[Path | None, typer.Option("--map", help="Mapping of a foreign file to channels.")] = None,
    decimal: Annotated[str | None, typer.Option("--decimal", help="Decimal sign of CSV files: '.' or ','.")] = None,
    simulate: Annotated[
        bool, typer.Option("--simulate", help="Simulate the closed loop where a controller is declared, and refine.")
    ] = False,
    at: Annotated[
        str, typer.Option("--at", help='Operating point of a frequency response, "x=200 mm,v=3 m/min".')
    ] = "",
    controller: Annotated[
        str | None, typer.Option("--controller", help="Controller file of a frequency response of the speed loop.")
    ] = None,
    budget: Annotated[
        str | None,
        typer.Option("--budget", help='Time that it may take, "60 s"; it ends with the best found so far.'),
    ] = None,
    as_json: Annotated[bool, typer.Option("--json", help="Print diagnosis.json instead of the summary.")] = False,
) -> None:
    """Find what a machine's model lacks, from recordings of it, and report the error before and after."""
    if earlier is None and _are_no_recordings(arguments[1:]):
        if measured is not None:
            raise InputError("is for numbers beside recordings", "--measured", "name the file behind the plant")
        _explain(arguments[0], arguments[1], at, controller, out, as_json)
        return
    if controller is not None:
        what = "is for a frequency response, and recordings over time are given"
        raise InputError(what, "--controller", "leave it out; declare the controller in the plant file for --simulate")
    options = Options(out, tuple(validate or ()), split, mapping, decimal, simulate, measured, budget)
    job = first_job(arguments, options) if earlier is None else continued_job(arguments, earlier, options)
    diagnose_and_print(job, as_json)


def diagnose_and_print(job: Job, as_json: bool = False) -> None:
    """Diagnose, write the files, and print the summary or the JSON.

    Raises:
        InputError: an input that cannot be used; nothing is written then.
    """
    with working("reading") as progress:
        found = diagnose_files(job, progress)
    if as_json:
        typer.echo(escaped(found.json()), nl=False)
    else:
        _print_summary(found, job.out / "report.html")


def _print_summary(found: Diagnosed, report: Path) -> None:
    console = Console(soft_wrap=True, highlight=False, markup=False, emoji=False)
    for sentence in found.sentences:
        console.print(printable(sentence))
    errors = found.errors.listing()
    console.print(table("on data not fitted, before → after", errors.headings, errors.rows))
    for line in (*found.remarks, f"report: {report.resolve()}"):
        console.print(printable(line))


def _are_no_recordings(names: Sequence[str]) -> bool:
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
        return False  # reported where it is read as a recording


def _explain(plant: str, measured: str, at: str, controller: str | None, out: Path | None, as_json: bool) -> None:
    """Trace the measurement to the plant file, write the files, and print the summary or the JSON.

    Raises:
        InputError: an input that cannot be used; nothing is written then.
    """
    from feeddrive.interface.measured.explaining import explain  # late: recordings over time do without

    if out is None:
        raise InputError("--out is missing", "", "give a folder for the report, such as --out report")
    refuse_unusable(out)
    with warnings_as_lines(), working("reading") as progress:
        found = explain(load(plant), Path(measured), at=at, controller=controller, progress=progress)
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
