"""What `diagnose` and `demo` share: read, diagnose with a progress display, write, and say what was found."""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path

from rich.console import Console
from rich.table import Table

from feeddrive.cli.machine import read_machine
from feeddrive.diagnose.diagnosis import diagnose
from feeddrive.diagnose.outputs import diagnosis_json, write_outputs
from feeddrive.diagnose.result import Diagnosis
from feeddrive.errors import InputError
from feeddrive.recording import Recording, read_recording
from feeddrive.report.figures import render_figures, save_figures
from feeddrive.report.html import write_report
from feeddrive.report.people import error_text, share_text
from feeddrive.report.verdict import verdict_sentences

DECIMAL_SIGNS = (None, ".", ",")


@dataclass(frozen=True)
class Job:
    """One run of the main job: files, and the options of `feeddrive diagnose`."""

    plant: Path
    recordings: tuple[Path, ...]
    validation: tuple[Path, ...]
    out: Path
    split: float = 0.75
    mapping: Path | None = None
    decimal: str | None = None
    simulate: bool = False


def run_job(job: Job, as_json: bool = False) -> Diagnosis:
    """Run the main job, write its files, and print the summary or the JSON.

    Raises:
        InputError: an input that cannot be used; nothing is written then.
    """
    if job.decimal not in DECIMAL_SIGNS:
        raise InputError(f"--decimal is {job.decimal!r}", "", "use '.' or ','")
    if job.out.exists() and not job.out.is_dir():
        raise InputError("--out is a file", str(job.out), "give a folder")
    plant = read_machine(job.plant)
    fitted, judged = ([_read(path, job) for path in paths] for paths in (job.recordings, job.validation))
    if any("screw_speed" in recording for recording in fitted):
        plant = read_machine(job.plant, fitted)  # a file may declare motion and heat
    with Console(stderr=True).status("reading") as status:
        said = status.update
        result, effects = diagnose(plant, fitted, judged, job.split, job.simulate, said)
        said("writing the report")
        write_outputs(result, effects, job.plant.read_text(encoding="utf-8"), job.out)
        pictures = render_figures(result)
        save_figures(result, job.out, pictures)
        write_report(result, job.out / "report.html", pictures)
    if as_json:
        print(diagnosis_json(result), end="")
    else:
        _print_summary(result, job.out / "report.html")
    return result


def _read(path: Path, job: Job) -> Recording:
    return read_recording(path, job.mapping, decimal=job.decimal)


def _print_summary(result: Diagnosis, report: Path) -> None:
    console = Console(soft_wrap=True, highlight=False)
    for sentence in verdict_sentences(result):
        console.print(sentence, markup=False)
    table = Table(
        "channel", "error before", "after", "relative before", "after", "sensor noise", title="on data not fitted"
    )
    for channel in result.channels:
        errors = [error_text(rms, channel.unit) for rms in (channel.before.rms, channel.after.rms, channel.noise_rms)]
        shares = [share_text(figures.relative) for figures in (channel.before, channel.after)]
        table.add_row(channel.name, errors[0], errors[1], *shares, errors[2])
    console.print(table)
    for effect in result.effects:
        console.print(f"{effect.name}: {effect.evidence} {effect.reading}", markup=False)
    for names in result.ambiguous:
        console.print(f"cannot be told apart by these recordings: {', '.join(names)}", markup=False)
    if result.simulation is not None:
        before, after = (share_text(e) for e in (result.simulation.before, result.simulation.after))
        console.print(
            f"closed-loop simulation, {result.simulation.channel}, unfiltered: {before} before, {after} after"
        )
    console.print(f"report: {report.resolve()}", markup=False)
