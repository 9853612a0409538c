"""What `diagnose` and `demo` share: read, diagnose with a progress display, write, and say what was found."""

from __future__ import annotations

import hashlib
import os
import shlex
import time
from collections.abc import Sequence
from dataclasses import dataclass, replace
from pathlib import Path

import typer
from rich.console import Console
from rich.table import Table

from feeddrive.cli.machine import read_machine
from feeddrive.cli.output import escaped, working
from feeddrive.compensation.actions import actions
from feeddrive.diagnosis.diagnose import diagnose
from feeddrive.diagnosis.judging.result import Diagnosis
from feeddrive.diagnosis.ledger.continued import Earlier, changed_since
from feeddrive.diagnosis.ledger.ledger import FileUse, RunFiles, runs_of, write_ledger, written_earlier
from feeddrive.diagnosis.likelihood.outputs import diagnosis_json, write_outputs
from feeddrive.diagnosis.suspicion.quality import quality_lines
from feeddrive.effects.base import Effect
from feeddrive.errors import InputError, printable
from feeddrive.files import shipped_plants
from feeddrive.output_folder import output_folder, refuse_unusable, take_away
from feeddrive.recording import Recording, read_recording
from feeddrive.report.certainty import experiment_sentences
from feeddrive.report.figures.figures import render_figures, save_figures
from feeddrive.report.pages.html import write_report
from feeddrive.report.pages.section_calibrated import calibrated_lines
from feeddrive.report.records import Occasion, used_sentence
from feeddrive.report.simulated import simulation_lines
from feeddrive.report.words.people import error_text, share_text
from feeddrive.report.words.verdict import verdict_sentences

DECIMAL_SIGNS = (None, ".", ",")


@dataclass(frozen=True)
class Options:
    """What was typed beside the files."""

    out: Path | None
    validate: tuple[Path, ...] = ()
    split: float | None = None
    mapping: Path | None = None
    decimal: str | None = None
    simulate: bool = False


@dataclass(frozen=True)
class Source:
    """A recording file and how it is read."""

    path: Path
    mapping: Path | None = None
    decimal: str | None = None


@dataclass(frozen=True)
class Job:
    """One run of the main job: files and options, and the earlier diagnosis that it takes up."""

    plant: Path
    recordings: tuple[Source, ...]
    validation: tuple[Source, ...]
    out: Path
    split: float = 0.75
    simulate: bool = False
    start: tuple[Effect, ...] = ()
    earlier: Earlier | None = None


def run_job(job: Job, as_json: bool = False) -> Diagnosis:
    """Run the main job, write its files, and print the summary or the JSON.

    Raises:
        InputError: an input that cannot be used; nothing is written then.
    """
    for source in (*job.recordings, *job.validation):
        if source.decimal not in DECIMAL_SIGNS:
            raise InputError(f"--decimal is {source.decimal!r}", "", "use '.' or ','")
    refuse_unusable(job.out)
    runs_of(job.out)  # refused now if it cannot be read, and not when all is done
    declared = _bytes(job.plant)
    read_machine(job.plant)  # refused before the recordings are read
    fitted, judged = ([_read(source) for source in sources] for sources in (job.recordings, job.validation))
    plant = read_machine(job.plant, fitted)  # a file may declare motion and heat
    if _bytes(job.plant) != declared:
        raise InputError("was changed while it was read", str(job.plant), "diagnose again")
    with working("reading") as said:
        result, effects = diagnose(plant, fitted, judged, job.split, job.simulate, said, job.start)
        result = _since(result, job)
        said("predicting what a repair and a compensation bring")
        todo = actions(result, plant.with_effects(*effects))
        said("writing the report")
        pictures = render_figures(result)
        with output_folder(job.out) as folder:
            write_outputs(result, effects, declared.decode("utf-8").replace("\r\n", "\n"), folder)
            save_figures(result, folder, pictures)
            occasion = Occasion(_command(job), _today())
            write_report(result, folder / "report.html", pictures, occasion, todo)
            # Read now: another diagnosis may have written here meanwhile.
            there = runs_of(job.out)
            take_away(folder, written_earlier(there))  # a figure that this run has no reason to draw
            before = there or (job.earlier.runs if job.earlier is not None else [])
            write_ledger(folder, before, result, effects, _files(job, declared, fitted, judged, before))
    if as_json:
        typer.echo(escaped(diagnosis_json(result)), nl=False)
    else:
        _print_summary(result, job.out / "report.html")
    return result


def _command(job: Job) -> str:
    """The line that makes a diagnosis again; none for one that takes up an earlier one, whose ledger tells its runs."""
    if job.earlier is not None:
        return ""
    words = ["feeddrive", "diagnose", job.plant.stem if job.plant in shipped_plants() else str(job.plant)]
    words += [str(source.path) for source in job.recordings]
    for source in job.validation:
        words += ["--validate", str(source.path)]
    first = job.recordings[0]  # files typed together are read alike
    words += ["--map", str(first.mapping)] if first.mapping is not None else []
    words += ["--decimal", first.decimal] if first.decimal is not None else []
    words += [] if job.validation else ["--split", f"{job.split:g}"]
    return shlex.join([*words, *(["--simulate"] if job.simulate else []), "--out", str(job.out)])


def _today() -> str:
    """The day, or that of SOURCE_DATE_EPOCH, so that a report can be made again as it was."""
    given = os.environ.get("SOURCE_DATE_EPOCH", "")
    return time.strftime("%Y-%m-%d", time.gmtime(int(given)) if given.isdigit() else time.localtime())


def _bytes(plant: Path) -> bytes:
    """The plant file as it is now; what is said and written of it at the end is of these bytes."""
    try:
        return plant.read_bytes()
    except OSError as error:
        raise InputError(f"cannot be read ({error.strerror})", str(plant), "put the plant file back") from None


def _read(source: Source) -> Recording:
    return read_recording(source.path, source.mapping, decimal=source.decimal)


def _since(result: Diagnosis, job: Job) -> Diagnosis:
    """The diagnosis with what it says otherwise than the one that it takes up."""
    if job.earlier is None:
        return result
    return replace(result, kept=replace(result.kept, since=changed_since(job.earlier.told, result.effects)))


def _files(
    job: Job, declared: bytes, fitted: Sequence[Recording], judged: Sequence[Recording], before: Sequence[object]
) -> RunFiles:
    continues = len(before) if job.earlier is not None else None
    uses = (_uses(job.recordings, fitted), _uses(job.validation, judged))
    plant = FileUse(job.plant.resolve(), hashlib.sha256(declared).hexdigest())
    return RunFiles(plant, uses[0], uses[1], job.split, continues)


def _uses(sources: Sequence[Source], recordings: Sequence[Recording]) -> tuple[FileUse, ...]:
    return tuple(
        FileUse(source.path.resolve(), recording.sha256, source.mapping and source.mapping.resolve(), source.decimal)
        for source, recording in zip(sources, recordings, strict=True)
    )


def _print_summary(result: Diagnosis, report: Path) -> None:
    console = Console(soft_wrap=True, highlight=False, markup=False, emoji=False)

    def say(sentence: str) -> None:
        console.print(printable(sentence))

    for sentence in verdict_sentences(result):
        say(sentence)
    table = Table(
        "channel", "error before", "after", "relative before", "after", "sensor noise", title="on data not fitted"
    )
    for channel in result.channels:
        errors = [error_text(rms, channel.unit) for rms in (channel.before.rms, channel.after.rms, channel.noise_rms)]
        shares = [share_text(figures.relative) for figures in (channel.before, channel.after)]
        table.add_row(channel.name, errors[0], errors[1], *shares, errors[2])
    console.print(table)
    say(used_sentence(result))
    for effect in result.effects:
        say(f"{effect.name}: {effect.evidence} {effect.reading}")
    for line in quality_lines(result.quality):
        say(line)
    for line in calibrated_lines(result):
        say(line)
    for sentence in result.kept.since:
        say(f"since the earlier diagnosis: {sentence}")
    for one in result.alike:
        say(f"cannot be told apart by these recordings: {', '.join(one.names)}: {one.reason}")
    for sentence in experiment_sentences(result):
        say(sentence)
    for pair in result.correlation.told if result.correlation is not None else ():
        say(pair)
    if result.simulation is not None:
        for line in simulation_lines(result.simulation):
            say(line)
    say(f"report: {report.resolve()}")
