"""The findings of the report as HTML: verdict, errors, effects, calibrated values, numbers measured beside."""

from __future__ import annotations

import math

from feeddrive.diagnosis.calibration.calibrated_result import CalibratedResult
from feeddrive.diagnosis.judging.result import ChannelResult, Diagnosis, EffectResult, ErrorFigures, error_without
from feeddrive.diagnosis.numbers.number_rows import NumberResult
from feeddrive.report.pages.markup import (
    Cell,
    effect_name,
    paragraph,
    section,
    table,
    text,
    verdict,
)
from feeddrive.report.pages.section_records import used_sentence
from feeddrive.report.words.number_text import (
    DASH,
    SPACE,
    Scale,
    band_text,
    scale_for_error,
    share_text,
    significant,
    times_text,
    with_unit,
)
from feeddrive.report.words.parameters import parameter_text
from feeddrive.report.words.verdict import is_noise, verdict_sentences
from feeddrive.report.words.words import effect_words, plain
from feeddrive.units.quantity import format_quantity, percent


def verdict_section(diagnosis: Diagnosis) -> str:
    """The verdict in a box, the main finding in bold; calm only where nothing was found and nothing is left."""
    noise = diagnosis.channels and all(is_noise(diagnosis, channel) for channel in diagnosis.channels)
    clean = noise and diagnosis.nothing_missing and not diagnosis.changes.changes
    note = paragraph(used_sentence(diagnosis), "note")
    return f"{verdict(verdict_sentences(diagnosis), bool(clean), note)}\n"


def error_section(diagnosis: Diagnosis) -> str:
    """Error before and after for each channel."""
    if not diagnosis.channels:
        return ""
    heads = ["Channel", "Band", "Prediction"]
    heads += [f"#{one}" for one in ("rms", "largest", "relative", "sensor noise", "rms / noise")]
    rows = [row for channel in diagnosis.channels for row in _error_rows(channel, diagnosis.nothing_missing)]
    note = (
        "Taken on data that were not fitted, inside the band. Relative: rms error over rms of the measured signal; for "
        "the table position, over the rms of its difference from lead × motor angle; of a "
        "temperature in °C, so that its size depends on the zero of that scale."
    )
    return section("Error before and after", table(heads, rows, "pairs"), paragraph(note, "note"))


def _error_rows(channel: ChannelResult, nothing_missing: bool) -> list[list[str | Cell]]:
    """One row before and one after, only one where both are the same plant."""
    scale = scale_for_error(channel.unit)
    band = band_text(channel.band_hz).replace(" ", SPACE)
    name = Cell(f"<b>{text(plain(channel.name))}</b>")
    if nothing_missing:
        return [[name, band, "declared plant", *_errors(channel, channel.before, scale)]]
    gain = channel.before.rms / channel.after.rms if channel.after.rms > 0.0 else math.nan
    better = f", {significant(gain, 2)} times smaller" if gain >= 1.05 else ""
    return [
        [name, band, "before", *_errors(channel, channel.before, scale)],
        [name, band, f"after{better}", *_errors(channel, channel.after, scale)],
    ]


def _errors(channel: ChannelResult, figures: ErrorFigures, scale: Scale) -> list[str | Cell]:
    """The figures of one row."""
    noise = channel.noise_rms if channel.noise_rms > 0.0 else math.nan
    shown = [with_unit(significant(one * scale.factor), scale.unit) for one in (figures.rms, figures.max)]
    noise_text = with_unit(significant(noise * scale.factor), scale.unit) if math.isfinite(noise) else DASH
    return [
        *shown,
        share_text(figures.relative),
        noise_text,
        significant(figures.rms / noise),
    ]


def effects_section(diagnosis: Diagnosis) -> str:
    """Each effect with parameters, what it explains, whether it carries, evidence and reading."""
    if not diagnosis.effects:
        return section("Effects found", paragraph("None: no effect was added to the declared plant."))
    channels = [channel.name for channel in diagnosis.channels]
    heads = ["Effect", "Parameter", "#value", "#95 % interval", "Error without it", "Carries over"]
    rows = [row for effect in diagnosis.effects for row in _effect_rows(effect, channels)]
    stories = "".join(_story(effect) for effect in diagnosis.effects)
    note = paragraph(
        "Error without it: how many times larger the rms error on data not fitted is when this effect alone is left "
        "out and the others are fitted again. Carries over: it lowers that error.",
        "note",
    )
    return section("Effects found", table(heads, rows, "effects"), note, f"<dl>{stories}</dl>" if stories else "")


def _effect_rows(effect: EffectResult, channels: list[str]) -> list[list[str | Cell]]:
    """One row per parameter; the name and the shares stand in the first."""
    texts = [parameter_text(key, parameter) for key, parameter in effect.parameters.items()]
    cells: list[list[str | Cell]] = [[one.name, one.value, one.interval or DASH] for one in texts]
    cells = cells or [[DASH, "", ""]]
    name = effect_name(effect.name, bold=True)
    ordered = sorted(effect.explains, key=lambda one: channels.index(one) if one in channels else len(channels))
    shares = [f"{text(plain(one))} {text(times_text(error_without(effect.explains[one])))}" for one in ordered]
    first = [name, *cells[0], Cell("<br>".join(shares) or DASH), "yes" if effect.carries else "no"]
    return [first, *[["", *row, "", ""] for row in cells[1:]]]


def _story(effect: EffectResult) -> str:
    """Evidence and physical reading of an effect."""
    if not (effect.evidence or effect.reading):
        return ""
    reading = f" <i>{text(effect.reading)}</i>" if effect.reading else ""
    return f"<dt>{text(effect_words(effect.name))}</dt><dd>{text(effect.evidence)}{reading}</dd>\n"


_NOTE = (
    "Nobody knows these values exactly. They were fitted within their tolerances before anything was named; each is "
    "what the recordings say of it alone, so that intervals of values that the recordings see only together are wide. "
    "They stand in plant_after.toml, and are no finding."
)


def calibrated_section(diagnosis: Diagnosis) -> str:
    """A table of the calibrated values; nothing where all were taken as exact."""
    heads = ["Declared value", "#declared", "#tolerance", "#calibrated", "#95 % interval"]
    rows = [[shown[0], *shown[1:]] for shown in map(_shown, diagnosis.calibrated)]
    return section("Declared values, calibrated", table(heads, rows), paragraph(_NOTE, "note")) if rows else ""


def calibrated_lines(diagnosis: Diagnosis) -> list[str]:
    """A line for every calibrated value."""
    lines = []
    for one in diagnosis.calibrated:
        name, declared, tolerance, value, interval = _shown(one)
        was = "declared" if one.unit == "1" else f"declared {declared}"
        lines.append(f"calibrated: {name} {value} [{interval}] ({was} ± {tolerance})")
    return lines


def _shown(one: CalibratedResult) -> list[str]:
    """Name, declared value, tolerance, value and interval; those of a factor as shares of what is declared."""
    scale, unit = (100.0 / one.declared, "%") if one.unit == "1" else (1.0, one.unit)
    low, high = (_text(scale * end, unit) for end in one.ci95)
    declared, value = (_text(scale * size, unit) for size in (one.declared, one.value))
    return [one.words, declared, percent(one.tolerance), value, f"{low} {DASH} {high}"]


def _text(value: float, unit: str) -> str:
    return f"{value:.4g} %" if unit == "%" else format_quantity(value, unit)


_MEASURED_NOTE = (
    "These numbers were fitted together with the recordings, each by its own tolerance; a plant that meets them lies "
    "within. What is not met after the diagnosis contradicts the recordings, or what the plant can be. A number that "
    "is likelier to be wrong than whatever would explain it is not fitted."
)


def measured_section(diagnosis: Diagnosis) -> str:
    """A table of the measured numbers; nothing where none were given."""
    heads = ["Measured beside the recordings", "#measured", "#tolerance", "#declared plant",
             "#with what was found", "met"]  # fmt: skip
    rows = [[one.number.name.replace("_", " "), *_texts(one), _met(one, "yes", "no")] for one in diagnosis.measured]
    return section("Measured numbers", table(heads, rows), paragraph(_MEASURED_NOTE, "note")) if rows else ""


def measured_lines(diagnosis: Diagnosis) -> list[str]:
    """A line for every measured number."""
    lines = []
    for one in diagnosis.measured:
        measured, tolerance, before, after = _texts(one)
        met = _met(one, "met", "not met")
        name = one.number.name.replace("_", " ")
        lines.append(f"measured: {name} {measured} ± {tolerance}, declared {before}, now {after}: {met}")
    return lines


def _met(one: NumberResult, yes: str, no: str) -> str:
    return (yes if one.met else no) if one.fitted else f"{no}, not fitted as it contradicts all else"


def _texts(one: NumberResult) -> list[str]:
    unit = one.number.kind.unit
    return [format_quantity(v, unit) for v in (one.number.value, 2 * one.number.deviation, one.before, one.after)]
