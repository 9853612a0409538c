"""The section on what no named effect explains: how much, on what it depends, and what the plant carries for it."""

from __future__ import annotations

from feeddrive.diagnosis.judging.result import ChannelResult, Diagnosis
from feeddrive.diagnosis.unexplained.unexplained_result import Carried, Dependence, Unexplained
from feeddrive.report.pages.markup import Cell, bullets, catalogue_name, paragraph, section, table
from feeddrive.report.words.number_text import DASH, error_text, fixed, share_text
from feeddrive.report.words.words import joined, plain, variable_words


def unexplained_section(diagnosis: Diagnosis, pictures: str = "") -> str:
    """What is left above noise, on what it depends, and which tables the plant carries for it."""
    if not diagnosis.unexplained:
        return section("What is unexplained", paragraph("Nothing above the sensor noise."))
    channels = {channel.name: channel for channel in diagnosis.channels}
    heads = [
        "Channel",
        "#share of the signal's square",
        "#left",
        "#noise floor",
        "#of it above the noise",
        "Depends on",
    ]
    rows = [_row(name, one, channels.get(name)) for name, one in diagnosis.unexplained.items()]
    statements = [f"{plain(name)}: {one.statement}" for name, one in diagnosis.unexplained.items() if one.statement]
    note = (
        "Taken on data that were not fitted, with the named effects and without the tables. The noise floor is "
        "estimated from the recording; ± is twice the standard error. The share in brackets is the part of the "
        "unexplained square that a curve over this variable takes away."
    )
    return section(
        "What is unexplained",
        table(heads, rows),
        bullets(statements) if statements else "",
        pictures,
        _carried(diagnosis),
        paragraph(note, "note"),
    )


def _row(name: str, one: Unexplained, channel: ChannelResult | None) -> list[str | Cell]:
    levels = [DASH, DASH, DASH]
    if one.above is not None and channel is not None:
        rms, floor = (error_text(level, channel.unit) for level in (one.above.rms, one.above.floor))
        percent, doubt = 100 * one.above.share, 200 * one.above.standard_error
        levels = [rms, floor, f"{fixed(percent, 0)} ± {fixed(doubt, 0)} %"]
    depends = _dependences(one)
    return [plain(name), share_text(one.share), *levels, depends]


def _dependences(unexplained: Unexplained) -> str:
    """The variables that what is left depends on."""
    texts = [_dependence(one) for one in unexplained.depends_on]
    if not texts and unexplained.above is not None and not unexplained.above.is_left:
        return "nothing is left above the noise"
    return joined(texts) or "none of the measured variables"


def _dependence(one: Dependence) -> str:
    period = f", period {one.period}" if one.period else ""
    times = f" with {variable_words(one.times)}" if one.times else ""
    return f"{variable_words(one.variable)}{times} ({share_text(one.share)}{period})"


def _carried(diagnosis: Diagnosis) -> str:
    """A table of the terms that the plant carries, with the errors with and without each."""
    units = {channel.name: channel.unit for channel in diagnosis.channels}
    found = [one for left in diagnosis.unexplained.values() for one in left.carried]
    if not found:
        return ""
    heads = ["Carried in plant_after.toml", "Over", "Channel", "#explains", "#rms without it", "#with it"]
    rows = [row for one in found for row in _carried_rows(one, units)]
    return table(heads, rows) + paragraph(
        "These are tables of what was seen, not laws: they hold over the range "
        "that was recorded and are constant outside it.",
        "note",
    )


def _carried_rows(one: Carried, units: dict[str, str]) -> list[list[str | Cell]]:
    rows = []
    for place, (name, share) in enumerate(one.explains.items()):
        first = [Cell(catalogue_name(one.name)), plain(one.variable)] if place == 0 else ["", ""]
        errors = [error_text(errors[name], units[name]) for errors in (one.before, one.after)]
        rows.append([*first, plain(name), share_text(share), *errors])
    return rows
