"""The part of the report that says what to do: which part first, which value to set, which file to load."""

from __future__ import annotations

from feeddrive.compensation.actions import FORM, Actions
from feeddrive.compensation.cures import COMPENSATE, REPAIR, SET, cure
from feeddrive.compensation.sheet import left, predicted_rows
from feeddrive.diagnosis.judging.result import Diagnosis, EffectResult
from feeddrive.report.pages.markup import bullets, paragraph, section, table
from feeddrive.report.pages.section_certainty import experiment_sentences
from feeddrive.report.words.number_text import DASH, error_text
from feeddrive.report.words.parameters import effect_sentence

_KINDS = {REPAIR: "Look at", SET: "Set", COMPENSATE: "Compensate", "watch": "Watch"}
_FILES = {
    "table": "feeddrive compensate FOLDER (of this report) --form linuxcnc|sinumerik-enc|sinumerik-cec|isg|"
             "heidenhain-csv|fanuc-parameters|csv --out FILE",
    "heat": "feeddrive compensate FOLDER --form sinumerik-temp --out FILE",
    "friction": "the sheet of feeddrive compensate, friction at reversals",
    "cogging": "feeddrive compensate FOLDER --out FILE, which writes FILE_cogging.csv",
}  # fmt: skip

_CHECK = (
    "Load the table, measure the check of one point on its sheet, then record the same motion again and diagnose it: "
    "the errors should be those predicted after compensation."
)


def actions_section(diagnosis: Diagnosis, found: Actions | None) -> str:
    """What to do, in order, and what it brings; nothing where nothing was found."""
    if found is None or (not found.effects and found.predicted is None):
        return ""
    by_name = {one.name: one for one in diagnosis.effects}
    heads = ["First to last", "What", "Found", "Value to set", "File"]
    rows = [
        [f"{i}. {_KINDS[cure(name).kind]}", cure(name).look_at, _found(by_name[name]),
         found.set_to.get(name, DASH), _FILES.get(cure(name).form, DASH)]
        for i, name in enumerate(found.effects, 1)
    ]  # fmt: skip
    experiments = experiment_sentences(diagnosis)
    if not experiments and found.predicted is not None:
        experiments = [_CHECK]
    after = paragraph("Next experiment:") + bullets(experiments) if experiments else ""
    listed = table(heads, rows) if rows else ""
    return section("What to do", listed, _predicted(found), after)


def _found(effect: EffectResult) -> str:
    sentence = effect_sentence(effect)
    return sentence if effect.carries else f"{sentence} (not confirmed on data not fitted)"


def _predicted(found: Actions) -> str:
    if found.predicted is None:
        return paragraph(f"Not predicted: {found.why_not}.", "note") if found.why_not else ""
    heads = ["Predicted", "#before", "#after repair", "#after compensation"]
    rows = [
        [name, *(DASH if one is None else error_text(one, "m") for one in values)]
        for name, values in predicted_rows(found.predicted)
    ]
    ends = [1e3 * one for one in found.predicted.wishes.stroke or found.predicted.table.positions[[0, -1]].tolist()]
    note = (
        f"Simulated from {ends[0]:.4g} mm to {ends[1]:.4g} mm with the position loop closed at the motor, in slow "
        "motion; one approach per direction, so that nothing scatters. Repair renews preload; compensation is a table "
        f"of --form {FORM} with {len(found.predicted.table.positions)} points. The form of a control may round and "
        "space it otherwise: feeddrive compensate says what that one brings."
    )
    rest = [line.replace(" um", " \N{MICRO SIGN}m").replace("^2", "²") for line in left(found.predicted)]
    return table(heads, rows) + bullets(rest) + paragraph(note, "note")
