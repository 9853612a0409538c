"""The part of the report on several recordings: what changed between them, and what an earlier diagnosis said."""

from __future__ import annotations

from feeddrive.diagnosis.judging.result import Diagnosis, ParameterResult
from feeddrive.diagnosis.recordings.change_result import CommonTrial, Measure, ParameterChange, PerRecording
from feeddrive.report.pages.markup import bullets, paragraph, section, table
from feeddrive.report.words.number_text import fixed, share_text, with_unit
from feeddrive.report.words.parameters import parameter_text
from feeddrive.report.words.words import effect_words, joined, plain

_MOST_TRIALS = 8


def changes_section(diagnosis: Diagnosis) -> str:
    """What is other from one recording to the next; nothing where there was nothing to compare."""
    known = diagnosis.changes
    if not known.trials:
        return ""
    if not known.changes:
        note = "Nothing differs between the recordings: one set of values meets all of them."
        return section("What changed between the recordings", paragraph(note), _tried(known.trials))
    lines = [f"{_begin(one.statement)}. {one.reading}{_where(one)}" for one in known.changes]
    return section(
        "What changed between the recordings",
        bullets(lines),
        _values(known.per_recording),
        _explained(diagnosis),
        _tried(known.trials),
    )


def since_section(diagnosis: Diagnosis) -> str:
    """What is other than in the diagnosis that was taken up again."""
    if not diagnosis.kept.since:
        return ""
    note = "All runs, with every effect tried and why it was kept or refused, are in ledger.json."
    return section("Since the earlier diagnosis", bullets(diagnosis.kept.since), paragraph(note, "note"))


def _where(one: ParameterChange) -> str:
    return "" if one.fitted else " This recording was not fitted; its errors are taken without this change."


def _values(own: tuple[PerRecording, ...]) -> str:
    if not own:
        return ""
    rows = []
    for one in own:
        for position, (name, value) in enumerate(one.values.items()):
            shown = _text(one, value)
            label = f"{effect_words(one.effect)} ({one.port}): {plain(one.parameter)}" if position == 0 else ""
            rows.append([label, name, shown[0], shown[1]])
    heads = ["Parameter", "Recording", "#value", "#95 % interval"]
    return table(heads, rows)


def _text(one: PerRecording, value: Measure) -> tuple[str, str]:
    shown = parameter_text(one.parameter, ParameterResult(value.value, one.unit, value.ci95))
    return shown.value, shown.interval


def _explained(diagnosis: Diagnosis) -> str:
    shares = diagnosis.changes.explains
    if not shares:
        return ""
    listed = joined([f"{share_text(share)} of {plain(name)}" for name, share in shares.items()])
    return paragraph(f"Of the squared error left on the judged data, the changes there are {listed}.", "note")


def _tried(trials: tuple[CommonTrial, ...]) -> str:
    """Which parameters were asked for a value of their own, the best first."""
    heads = ["Asked for a value of its own", "in", "#gain", "#standard error", "result"]
    rows = [
        [
            f"{effect_words(one.effect)} ({one.port}): {plain(one.parameter)}",
            "judged recordings" if one.judged else "fitted recordings",
            with_unit(fixed(100 * one.gain, 2), "%"),
            with_unit(fixed(100 * one.standard_error, 2), "%"),
            "differs" if one.taken else "in common",
        ]
        for one in sorted(trials, key=lambda one: (not one.taken, -one.gain))[:_MOST_TRIALS]
    ]
    note = "Gain: share of the squared error on blocks of time left out of the fit."
    return table(heads, rows, "dense") + paragraph(note, "note")


def _begin(sentence: str) -> str:
    return sentence[:1].upper() + sentence[1:]
