"""The search and the data of the report as HTML: what was tried, notes on the recordings, reproducibility."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from feeddrive import __version__
from feeddrive.diagnosis.judging.result import ChannelSeries, Diagnosis, FileStamp, JudgedRecording, Trial
from feeddrive.diagnosis.suspicion.quality import quality_lines
from feeddrive.report.pages.markup import Cell, bullets, catalogue_name, effect_name, paragraph, section, table, text
from feeddrive.report.words.number_text import fixed, share_text, significant, with_unit
from feeddrive.report.words.words import plain
from feeddrive.typing import BoolArray

_MOST_TRIALS = 8


@dataclass(frozen=True)
class Occasion:
    """When and how a diagnosis was made; empty where it is not known.

    Attributes:
        command: line that makes it again.
        date: of the report.
    """

    command: str = ""
    date: str = ""


UNKNOWN = Occasion()


def form_section(diagnosis: Diagnosis, occasion: Occasion) -> str:
    """What a report is filed under: the machine and the date, and lines to write on."""
    fields = {"Machine": diagnosis.plant, "Serial number": "", "Recorded on": "", "Report of": occasion.date}
    cells = "".join(f"<div><dt>{text(key)}</dt><dd>{text(value)}</dd></div>" for key, value in fields.items())
    return f'<dl class="form">{cells}</dl>\n'


def tried_section(diagnosis: Diagnosis, pictures: str) -> str:
    """What was refused and why, and the gains of each round."""
    return section("What was tried and not taken", _refused(diagnosis), pictures, _trials(diagnosis.trials))


def _refused(diagnosis: Diagnosis) -> str:
    """Refused candidates with their reasons."""
    rows: list[list[str | Cell]] = [[effect_name(one.name), one.reason] for one in diagnosis.refused]
    return table(["Effect", "Why not"], rows) if rows else ""


def _trials(trials: tuple[Trial, ...]) -> str:
    """Gains of the best candidates of each round."""
    if not trials:
        return ""
    heads = ["#Round", "Candidate", "#gain", "#standard error", "result"]
    rows = [
        [str(one.round), Cell(catalogue_name(one.name)), _percent(one.gain),
         _percent(one.standard_error), "taken" if one.taken else ""]
        for kept in _best_by_round(trials)
        for one in kept
    ]  # fmt: skip
    note = f"The {_MOST_TRIALS} best candidates of each round; the figure says what the gain is."
    return table(heads, rows, "dense") + paragraph(note, "note")


def _best_by_round(trials: tuple[Trial, ...]) -> list[list[Trial]]:
    """The best candidates of each round, the one taken first."""
    rounds = sorted({trial.round for trial in trials})
    ranked = sorted(trials, key=lambda one: (not one.taken, -one.gain if np.isfinite(one.gain) else np.inf))
    return [[one for one in ranked if one.round == number][:_MOST_TRIALS] for number in rounds]


def _percent(share: float) -> str:
    """A gain with two decimals, so that a column of gains lines up."""
    return with_unit(fixed(100.0 * share, 2), "%")


def recordings_section(diagnosis: Diagnosis) -> str:
    """The judged recordings with what was left out, notes and re-homed effects."""
    heads = ["Judged recording", "#duration", "#samples", "Channels, part used"]
    rows = [_recording_row(recording) for recording in diagnosis.recordings]
    remarks = (*quality_lines(diagnosis.quality), *diagnosis.notes)
    notes = bullets(remarks) if remarks else ""
    return section("The recordings", table(heads, rows) if rows else "", notes, _rehomed(diagnosis.rehomed))


def used_sentence(diagnosis: Diagnosis) -> str:
    """Which part of the judged recordings the errors are of; empty where there is none."""
    shares = {}
    for channel in diagnosis.channels:
        usable = [_usable(one) for recording in diagnosis.recordings for one in recording.channels
                  if one.name == channel.name and one.measured.size]  # fmt: skip
        if usable:
            shares[channel.name] = float(np.mean(np.concatenate(usable)))
    if not shares:
        return ""
    if not any(share < 1.0 for share in shares.values()):
        return "Every sample of the judged recordings is used."
    listed = ", ".join(f"{share_text(1.0 - share)} of {plain(name)}" for name, share in shares.items())
    return f"Not used of the judged recordings: {listed} (the cut ends, flawed rows, and what cannot be predicted)."


def _usable(one: ChannelSeries) -> BoolArray:
    return np.isfinite(one.measured - one.before)


def _recording_row(recording: JudgedRecording) -> list[str | Cell]:
    """Length of a recording and the part of it that was used."""
    duration = float(recording.time[-1] - recording.time[0]) if recording.time.size else 0.0
    used = [
        f"{plain(one.name)} {share_text(float(np.mean(_usable(one))))}"
        for one in recording.channels
        if one.measured.size
    ]
    return [recording.name, with_unit(significant(duration), "s"), str(recording.time.size),
            ", ".join(used)]  # fmt: skip


def _rehomed(names: tuple[str, ...]) -> str:
    """What was re-homed, in a sentence."""
    if not names:
        return ""
    return paragraph(
        f"Re-homed on the first 15 % of a recording whose encoder zero differs: {', '.join(names)}. "
        "Errors are taken on the rest."
    )


def stamp_section(diagnosis: Diagnosis, occasion: Occasion) -> str:
    """Version, plant, command and files, so that the result can be had again."""
    who = paragraph(f"feeddrive {__version__}, plant {diagnosis.plant}.")
    who += f"<pre>{text(occasion.command)}</pre>\n" if occasion.command else ""
    heads = ["Use", "File", "SHA-256"]
    rows = [_stamp_row("fitted", one) for one in diagnosis.fit]
    rows += [_stamp_row("judged", one) for one in diagnosis.validate]
    alone = "" if diagnosis.validate else paragraph("Judged on the last part of each fitted file.", "note")
    return section("To reproduce this", who, table(heads, rows, "dense") if rows else "", alone)


def _stamp_row(use: str, stamp: FileStamp) -> list[str | Cell]:
    """One file."""
    return [use, stamp.file, Cell(f'<code class="hash">{text(stamp.sha256)}</code>')]
