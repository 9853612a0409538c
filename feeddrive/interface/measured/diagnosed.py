"""The main job from a script: what an axis lacks, found from recordings."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING, Any, cast

from feeddrive.bench_page.page import bench_of_diagnosis
from feeddrive.compensation.actions import Actions, actions
from feeddrive.diagnosis.budget import Budget
from feeddrive.diagnosis.diagnose import diagnose as find_what_lacks
from feeddrive.diagnosis.judging.result import Diagnosis
from feeddrive.diagnosis.likelihood.outputs import diagnosis_json, diagnosis_record, write_outputs
from feeddrive.diagnosis.numbers.measured_file import read_measured_numbers
from feeddrive.diagnosis.plant_text import with_calibrated_values
from feeddrive.diagnosis.preparation import informative
from feeddrive.diagnosis.suspicion.quality import is_recorders, quality_lines
from feeddrive.effects.base import Effect
from feeddrive.errors import InputError, quoted
from feeddrive.interface.axis import Axis, axis_of, axis_of_text
from feeddrive.interface.measured.first_look import play_seen
from feeddrive.interface.measured.reading import as_recording
from feeddrive.interface.shown import Listing, Shown
from feeddrive.plant.file.lumped_text import plant_text_with_effects
from feeddrive.recording.recording import Recording
from feeddrive.report.pages.section_certainty import experiment_sentences, simulation_lines
from feeddrive.report.pages.section_records import used_sentence
from feeddrive.report.pages.sections import calibrated_lines, measured_lines
from feeddrive.report.words.number_text import error_text, share_text
from feeddrive.report.words.parameters import parameter_text
from feeddrive.report.words.verdict import verdict_sentences
from feeddrive.units.quantity import parse

if TYPE_CHECKING:
    from feeddrive.interface.compensating import Compensation
    from feeddrive.report.figures.drawing import ReportFigure

Given = Recording | str | Path


class Effects(Shown):
    """The effects that were found, in order; empty where the declared axis is enough."""

    def __init__(self, diagnosis: Diagnosis) -> None:
        self._diagnosis = diagnosis

    def __len__(self) -> int:
        return len(self._diagnosis.effects)

    def __iter__(self) -> Any:
        """Each as `EffectResult`: name, parameters with value, unit and ci95, explains, evidence, reading."""
        return iter(self._diagnosis.effects)

    def __getitem__(self, place: int) -> Any:
        return self._diagnosis.effects[place]

    def listing(self) -> Listing:
        """One row per value."""
        records, rows = [], []
        for one in self._diagnosis.effects:
            for key, parameter in one.parameters.items():
                shown = parameter_text(key, parameter)
                rows.append([one.name, shown.name, shown.value, shown.interval])
                records.append(
                    {
                        "effect": one.name,
                        "parameter": key,
                        "value": parameter.value,
                        "unit": parameter.unit,
                        "ci95": parameter.ci95,
                    }
                )
        title = "Effects that the axis lacks" if rows else "No effect is missing"
        return Listing(title, ("effect", "value of", "value", "95 % interval"), rows, records)


def _changed(before: str, after: str) -> str:
    """A figure before and after, its unit once; one where they are alike."""
    if before == after:
        return after
    number, _, unit = before.partition(" ")
    return f"{number} → {after}" if after.endswith(unit) else f"{before} → {after}"


class Errors(Shown):
    """Errors of each channel on data not fitted, before and after."""

    def __init__(self, diagnosis: Diagnosis) -> None:
        self._diagnosis = diagnosis

    def listing(self) -> Listing:
        """One row per channel."""
        rows = [
            [
                one.name,
                _changed(*(error_text(rms, one.unit) for rms in (one.before.rms, one.after.rms))),
                _changed(*(share_text(share) for share in (one.before.relative, one.after.relative))),
                error_text(one.noise_rms, one.unit),
            ]
            for one in self._diagnosis.channels
        ]
        records = [
            {
                "channel": one.name,
                "unit": one.unit,
                "before rms": one.before.rms,
                "after rms": one.after.rms,
                "before relative": one.before.relative,
                "after relative": one.after.relative,
                "noise rms": one.noise_rms,
            }
            for one in self._diagnosis.channels
        ]
        headings = ("channel", "error", "relative", "sensor noise")
        return Listing("Errors on data not fitted", headings, rows, records)


@dataclass(frozen=True, repr=False, eq=False)
class Diagnosed(Shown):
    """What a diagnosis found.

    Attributes:
        axis: as it was declared.
        diagnosis: everything, plain values, SI.
        found: the effects as the plant takes them.
    """

    axis: Axis
    diagnosis: Diagnosis
    found: tuple[Effect, ...]

    @property
    def verdict(self) -> str:
        """What is missing, how well the mended plant predicts, what stays open."""
        return " ".join(self.sentences)

    @property
    def sentences(self) -> tuple[str, ...]:
        """The verdict, sentence by sentence."""
        return tuple(verdict_sentences(self.diagnosis))

    def __repr__(self) -> str:
        """The verdict."""
        return self.verdict

    @property
    def remarks(self) -> tuple[str, ...]:
        """Sentences on the data used, each effect, what is alike, and what to record next."""
        found = self.diagnosis
        lines = [used_sentence(found)]
        lines += [f"{one.name}: {one.evidence} {one.reading}" for one in found.effects]
        lines += [*quality_lines(found.quality), *calibrated_lines(found), *measured_lines(found)]
        lines += [f"since the earlier diagnosis: {sentence}" for sentence in found.kept.since]
        lines += [
            f"cannot be told apart by these recordings: {', '.join(one.names)}: {one.reason}" for one in found.alike
        ]
        lines += experiment_sentences(found)
        lines += found.correlation.remarks if found.correlation is not None else ()
        lines += simulation_lines(found.simulation) if found.simulation is not None else ()
        return tuple(lines)

    @property
    def effects(self) -> Effects:
        """The effects that were found."""
        return Effects(self.diagnosis)

    @property
    def errors(self) -> Errors:
        """Errors of each channel on data not fitted, before and after."""
        return Errors(self.diagnosis)

    @property
    def plant(self) -> Axis:
        """The axis with its declared values as calibrated, and with what was found."""
        text = with_calibrated_values(self.axis.text, self.diagnosis.calibrated)
        own = [effect for effect in self.found if not is_recorders(effect)]
        axis = axis_of_text(plant_text_with_effects(text, (*self.axis.added, *own)), self.axis.path)
        return axis.with_values(dict(self.axis.values)) if self.axis.values else axis

    def record(self) -> dict[str, Any]:
        """The content of `diagnosis.json`."""
        return diagnosis_record(self.diagnosis)

    def json(self) -> str:
        """The text of `diagnosis.json`."""
        return diagnosis_json(self.diagnosis)

    def report(self, path: str | Path) -> Path:
        """Write the report, one HTML file.

        Raises:
            InputError: the file cannot be written.
        """
        from feeddrive.report.pages.html import write_report

        write_report(self.diagnosis, Path(path), todo=self._actions(), bench=self._bench())
        return Path(path)

    def compensation(self, form: str = "csv", **options: Any) -> Compensation:
        """What was found as a table that a control reads.

        Args:
            form: of the control, see `compensate`.
            **options: as of `compensate`, such as every="10 mm".

        Raises:
            InputError: nothing that a table may hold, or as `compensate`.
        """
        from feeddrive.interface.compensating import compensate

        return compensate(self, form, **options)

    def save(self, folder: str | Path) -> Path:
        """Write `diagnosis.json`, `prediction.csv`, `plant_after.toml`, `report.html` and the figures.

        Raises:
            InputError: the folder cannot be written.
        """
        from feeddrive.report.figures.figures import render_figures, save_figures
        from feeddrive.report.pages.html import write_report

        place = Path(folder)
        pictures = render_figures(self.diagnosis)
        write_outputs(self.diagnosis, self.found, self.axis.text, place)
        save_figures(self.diagnosis, place, pictures)
        write_report(self.diagnosis, place / "report.html", pictures, todo=self._actions(), bench=self._bench())
        return place

    def _actions(self) -> Actions:
        """What to do, with a prediction where a table helps."""
        return actions(self.diagnosis, self.plant.plant)

    def _bench(self) -> str:
        """The page for the tab of the report."""
        return bench_of_diagnosis(self.plant.plant, self.diagnosis)

    def listing(self) -> Listing:
        """The effects, or where there are none the errors."""
        return self.effects.listing() if len(self.effects) else self.errors.listing()

    def _figures(self) -> Sequence[ReportFigure]:
        from feeddrive.report.figures.figures import report_figures

        return list(report_figures(self.diagnosis))


def diagnose(
    axis: Axis | str | Path,
    recording: Given | Sequence[Given],
    *,
    validate: Given | Sequence[Given] | None = None,
    split: float = 0.75,
    simulate: bool = False,
    measured: str | Path | None = None,
    budget: str | None = None,
    progress: Callable[[str], None] | None = None,
) -> Diagnosed:
    """Find what an axis lacks.

    Args:
        axis: as declared; or what `load` takes.
        recording: that is fitted, or several, the oldest first; a recording or the path of a file.
        validate: to judge on; the last part of each fitted one if left out.
        split: share that is fitted then.
        simulate: also simulate the closed loop where a controller is declared.
        measured: TOML file of numbers that were measured beside, `[[measured]]`: a stiffness, a natural frequency.
        budget: time that it may take, such as "60 s"; it ends with the best found so far and says what was not tried.
        progress: called with a word for what is being done.

    Raises:
        InputError: a recording that cannot be used, or an axis that does not declare what it holds.
    """
    axis = axis_of(axis)
    allowed = budget_of(budget, "budget")
    fitted, judged = _several(recording, "recording"), _several(validate, "validate")
    if not fitted:
        raise InputError("no recording is given", "recording", "give fd.read(...), or the path of a file")
    numbers = read_measured_numbers(Path(measured), axis.plant) if measured is not None else ()
    report = progress or (lambda _: None)
    fitted = list(informative(axis.plant, fitted, 1.0 if judged else split))
    start = play_seen(axis.plant, fitted)
    result, effects = find_what_lacks(axis.plant, fitted, judged, split, simulate, report, start, numbers, allowed)
    return Diagnosed(axis, result, tuple(effects))


def budget_of(text: str | None, where: str) -> Budget:
    """The time that a diagnosis may take from now on, such as "60 s" or "2 min"; None for as long as it takes."""
    if text is None:
        return Budget()
    seconds = parse(text, "s", where)
    if seconds <= 0:
        raise InputError(f"{quoted(text)} leaves no time", where, 'write a time such as "60 s"')
    return Budget(seconds)


def _several(given: Given | Sequence[Given] | None, where: str) -> list[Recording]:
    if given is None:
        return []
    if isinstance(given, list | tuple):
        return [as_recording(one, where) for one in given]
    return [as_recording(cast(Given, given), where)]
