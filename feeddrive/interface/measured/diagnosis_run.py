"""A diagnosis of files into a folder: a first one, or one that takes up an earlier one; with its ledger."""

from __future__ import annotations

import hashlib
import os
import shlex
import time
from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace
from pathlib import Path

from feeddrive.bench_page.page import bench_of_diagnosis
from feeddrive.compensation.actions import actions
from feeddrive.diagnosis.diagnose import diagnose
from feeddrive.diagnosis.ledger.ledger import (
    Earlier,
    FileUse,
    RunFiles,
    changed_since,
    checksum,
    earlier_run,
    runs_of,
    write_ledger,
    written_earlier,
)
from feeddrive.diagnosis.likelihood.outputs import write_outputs
from feeddrive.diagnosis.numbers.measured_file import read_measured_numbers
from feeddrive.diagnosis.preparation import informative
from feeddrive.effects.base import Effect
from feeddrive.effects.tabulated import Tabulated
from feeddrive.errors import InputError
from feeddrive.files import find_plant, shipped_plants
from feeddrive.interface.axis import load
from feeddrive.interface.measured.diagnosed import Diagnosed, budget_of
from feeddrive.interface.measured.first_look import play_seen
from feeddrive.output_folder import finish_interrupted, output_folder, refuse_unusable, take_away
from feeddrive.recording import Recording, read_recording
from feeddrive.report.figures.figures import render_figures, save_figures
from feeddrive.report.pages.html import write_report
from feeddrive.report.pages.section_records import Occasion

DECIMAL_SIGNS = (None, ".", ",")

SPLIT = 0.75
"""Share that is fitted where nothing else is given."""


@dataclass(frozen=True)
class Options:
    """Options beside the files; None where they are left out."""

    out: Path | None
    validate: tuple[Path, ...] = ()
    split: float | None = None
    mapping: Path | None = None
    decimal: str | None = None
    simulate: bool = False
    measured: Path | None = None
    budget: str | None = None


@dataclass(frozen=True)
class Source:
    """A recording file and how it is read."""

    path: Path
    mapping: Path | None = None
    decimal: str | None = None


@dataclass(frozen=True)
class Job:
    """Files and options of a diagnosis, and the earlier one that it takes up."""

    plant: Path
    recordings: tuple[Source, ...]
    validation: tuple[Source, ...]
    out: Path
    split: float = SPLIT
    simulate: bool = False
    start: tuple[Effect, ...] = ()
    earlier: Earlier | None = None
    measured: Path | None = None
    budget: str | None = None


def first_job(arguments: Sequence[str], options: Options) -> Job:
    """A diagnosis of its own: a plant and its recordings.

    Raises:
        InputError: no recording, or no folder.
    """
    if len(arguments) < 2:
        raise InputError("no recording is given", "", "write: feeddrive diagnose PLANT REC --out DIR")
    if options.out is None:
        raise InputError("--out is missing", "", "give a folder for the report, such as --out report")
    split = SPLIT if options.split is None else options.split
    fitted = tuple(_source(Path(name), options) for name in arguments[1:])
    judged = tuple(_source(path, options) for path in options.validate)
    plant = find_plant(arguments[0])
    return Job(
        plant, fitted, judged, options.out, split, options.simulate, measured=options.measured, budget=options.budget
    )


def continued_job(arguments: Sequence[str], folder: Path, options: Options) -> Job:
    """An earlier diagnosis with recordings added to its own.

    Raises:
        InputError: an earlier diagnosis that cannot be taken up, another plant than its, or a recording it has already.
    """
    finish_interrupted(folder)  # an earlier diagnosis may have been killed at its very end
    earlier = earlier_run(folder)
    names = list(arguments)
    plant = _plant(names[0])
    if plant is not None:
        names = names[1:]
        if checksum(plant) != checksum(earlier.plant):
            mend = "leave the plant out, or diagnose anew"
            raise InputError(
                f"another plant than that of the earlier diagnosis, {earlier.plant.name}", str(plant), mend
            )
    new = tuple(_source(Path(name), options) for name in names)
    if not new and not options.validate:
        raise InputError("no recording to add", str(folder), "name one more recording")
    judged = tuple(_source(path, options) for path in options.validate)
    _refuse_known(earlier, [*new, *judged])
    return Job(
        earlier.plant,
        (*(_known(use) for use in earlier.fit), *new),
        (*(_known(use) for use in earlier.validate), *judged),
        options.out or folder,
        earlier.split if options.split is None else options.split,
        options.simulate,
        tuple(effect for effect in earlier.effects if not isinstance(effect, Tabulated)),
        earlier,
        options.measured or (earlier.measured.path if earlier.measured is not None else None),
        options.budget,
    )


def diagnose_files(job: Job, progress: Callable[[str], None] = lambda _: None) -> Diagnosed:
    """Diagnose, and write report, figures, plant and ledger into the folder of the job, all together.

    Args:
        job: files and options.
        progress: called with a word for what is being done.

    Raises:
        InputError: an input that cannot be used; nothing is written then.
    """
    for source in (*job.recordings, *job.validation):
        if source.decimal not in DECIMAL_SIGNS:
            raise InputError(f"--decimal is {source.decimal!r}", "", "use '.' or ','")
    budget = budget_of(job.budget, "--budget")
    refuse_unusable(job.out)
    runs_of(job.out)  # refused now if it cannot be read, and not when all is done
    declared = _bytes(job.plant)
    axis = load(job.plant)  # refused before the recordings are read
    paths = [source.path for source in (*job.recordings, *job.validation)]
    fitted, judged = (
        [called_apart(_read(source), source.path, paths) for source in sources]
        for sources in (job.recordings, job.validation)
    )
    fitted = list(informative(axis.plant, fitted, 1.0 if judged else job.split))  # the rest is given back
    judged = list(informative(axis.plant, judged))
    if _bytes(job.plant) != declared:
        raise InputError("was changed while it was read", str(job.plant), "diagnose again")
    plant = axis.plant
    numbers = read_measured_numbers(job.measured, plant) if job.measured is not None else ()
    as_read = checksum(job.measured) if job.measured is not None else ""
    start = job.start or play_seen(plant, fitted)
    asked = (job.split, job.simulate, progress, start, numbers, budget)
    result, effects = diagnose(plant, fitted, judged, *asked)
    if job.earlier is not None:
        since = changed_since(job.earlier.reported, result.effects)
        result = replace(result, kept=replace(result.kept, since=since))
    progress("predicting what a repair and a compensation bring")
    after = plant.with_effects(*effects)
    todo, bench = actions(result, after), bench_of_diagnosis(after, result)
    progress("writing the report")
    pictures = render_figures(result)
    with output_folder(job.out) as folder:
        write_outputs(result, effects, declared.decode("utf-8").replace("\r\n", "\n"), folder)
        save_figures(result, folder, pictures)
        write_report(result, folder / "report.html", pictures, Occasion(_command(job), _today()), todo, bench)
        # Read now: another diagnosis may have written here meanwhile.
        there = runs_of(job.out)
        take_away(folder, written_earlier(there))  # a figure that this run has no reason to draw
        before = there or (job.earlier.runs if job.earlier is not None else [])
        write_ledger(folder, before, result, effects, _files(job, declared, as_read, fitted, judged, before))
    return Diagnosed(axis, result, tuple(effects))


def _command(job: Job) -> str:
    """The line that makes a diagnosis again; none for one that takes up an earlier one, whose ledger lists its runs."""
    if job.earlier is not None:
        return ""
    words = ["feeddrive", "diagnose", job.plant.stem if job.plant in shipped_plants() else str(job.plant)]
    words += [str(source.path) for source in job.recordings]
    for source in job.validation:
        words += ["--validate", str(source.path)]
    first = job.recordings[0]  # files typed together are read alike
    words += ["--map", str(first.mapping)] if first.mapping is not None else []
    words += ["--decimal", first.decimal] if first.decimal is not None else []
    words += ["--measured", str(job.measured)] if job.measured is not None else []
    words += ["--budget", job.budget] if job.budget is not None else []
    words += [] if job.validation else ["--split", f"{job.split:g}"]
    return shlex.join([*words, *(["--simulate"] if job.simulate else []), "--out", str(job.out)])


def _today() -> str:
    """The day, or that of SOURCE_DATE_EPOCH, so that a report can be made again as it was."""
    given = os.environ.get("SOURCE_DATE_EPOCH", "")
    return time.strftime("%Y-%m-%d", time.gmtime(int(given)) if given.isdigit() else time.localtime())


def _bytes(plant: Path) -> bytes:
    """The plant file as it is now; what is reported and written of it at the end is of these bytes."""
    try:
        return plant.read_bytes()
    except OSError as error:
        raise InputError(f"cannot be read ({error.strerror})", str(plant), "put the plant file back") from None


def called_apart(recording: Recording, path: Path, paths: Sequence[Path]) -> Recording:
    """A recording that is called by its folder as well where another file has its name: every run writes the same."""
    if recording.name != path.name or sum(one.name == path.name for one in paths) < 2:
        return recording
    return replace(recording, name=f"{path.absolute().parent.name}/{path.name}")


def _read(source: Source) -> Recording:
    return read_recording(source.path, source.mapping, decimal=source.decimal)


def _files(
    job: Job,
    declared: bytes,
    numbers: str,
    fitted: Sequence[Recording],
    judged: Sequence[Recording],
    before: Sequence[object],
) -> RunFiles:
    continues = len(before) if job.earlier is not None else None
    uses = (_uses(job.recordings, fitted), _uses(job.validation, judged))
    plant = FileUse(job.plant.resolve(), hashlib.sha256(declared).hexdigest())
    measured = FileUse(job.measured.resolve(), numbers) if job.measured is not None else None
    return RunFiles(plant, uses[0], uses[1], job.split, continues, measured)


def _uses(sources: Sequence[Source], recordings: Sequence[Recording]) -> tuple[FileUse, ...]:
    return tuple(
        FileUse(source.path.resolve(), recording.sha256, source.mapping and source.mapping.resolve(), source.decimal)
        for source, recording in zip(sources, recordings, strict=True)
    )


def _plant(name: str) -> Path | None:
    """The plant that a word names, or None where it names a recording."""
    try:
        path = find_plant(name)
    except InputError:
        return None
    return path if path.suffix.lower() == ".toml" else None


def _source(path: Path, options: Options) -> Source:
    return Source(path, options.mapping, options.decimal)


def _known(use: FileUse) -> Source:
    return Source(use.path, use.mapping, use.decimal)


def _refuse_known(earlier: Earlier, added: Sequence[Source]) -> None:
    known = {use.sha256 for use in (*earlier.fit, *earlier.validate)}
    for source in added:
        if source.path.is_file() and checksum(source.path) in known:
            raise InputError("the earlier diagnosis has this recording already", str(source.path), "name another one")
