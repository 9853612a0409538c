"""Fitted parameters as text: value, unit and 95 % interval, in one common unit."""

from __future__ import annotations

import math
from dataclasses import dataclass

from feeddrive.diagnosis.certainty.one_sided import OPEN
from feeddrive.diagnosis.judging.result import EffectResult, ParameterResult
from feeddrive.report.words.number_text import (
    Scale,
    decimals_for,
    fixed,
    scale_for_value,
    significant,
    unit_name,
    with_unit,
)
from feeddrive.report.words.words import effect_words, headline_parameters, plain

_LONGEST_LIST = 9
_HEADLINE_DIGITS = 4
_SIZES = {"width", "amplitude", "mass", "delay", "slope", "strain", "stiffness", "inertia", "power", "growth"}
_SPEAKING = _SIZES | {"force", "delta_force", "delta_viscous", "conductance"}
"""Keys that go without saying beside the effect's name."""


@dataclass(frozen=True)
class ParameterText:
    """One parameter as shown: name in words, value with unit, interval in the same unit (empty if there is none)."""

    name: str
    value: str
    interval: str

    @property
    def sentence(self) -> str:
        """Value and interval as in a sentence."""
        return f"{self.value} {self.interval}".strip()


def _scale(key: str, largest: float, unit: str) -> Scale:
    """Shares and damping ratios read as per cent, everything else by its unit."""
    if unit_name(unit) == "1" and (key.startswith("share") or key == "damping"):
        return Scale(100.0, "%")
    return scale_for_value(largest, unit)


def parameter_text(key: str, parameter: ParameterResult) -> ParameterText:
    """Text of a parameter that is a number, a list of numbers or a word."""
    if isinstance(parameter.value, str):
        return ParameterText(plain(key), plain(parameter.value), "")
    if isinstance(parameter.value, list):
        return _list_text(key, parameter.value, parameter.unit)
    return _number_text(key, parameter.value, parameter.unit, parameter.ci95)


def _number_text(key: str, value: float, unit: str, ci95: object, most_digits: int | None = None) -> ParameterText:
    """Value with as many digits as the interval supports, three significant ones where there is no interval.

    Of at most `most_digits` significant ones the interval is left out where both of its ends are then the value's.
    Where the interval is as good as open above, its lower end is all that is known.
    """
    ends = ci95 if isinstance(ci95, tuple) and len(ci95) == 2 and all(map(math.isfinite, ci95)) else None
    # A value of zero has no size of its own; the interval gives the unit.
    scale = _scale(key, value or max(map(abs, ends or (0.0,))), unit)
    shown = value * scale.factor
    if ends is None:
        return ParameterText(plain(key), with_unit(significant(shown), scale.unit), "")
    if ends[0] > 0 and ends[1] > OPEN * ends[0]:
        scale = _scale(key, ends[0], unit)
        return ParameterText(plain(key), f"at least {with_unit(significant(ends[0] * scale.factor), scale.unit)}", "")
    low, high = (end * scale.factor for end in ends)
    decimals = decimals_for(0.5 * abs(high - low))
    if most_digits is not None and shown:
        decimals = min(decimals, max(0, most_digits - 1 - math.floor(math.log10(abs(shown)))))
    ends_text = fixed(low, decimals), fixed(high, decimals)
    interval = "" if ends_text[0] == ends_text[1] else f"[{', '.join(ends_text)}]"
    return ParameterText(plain(key), with_unit(fixed(shown, decimals), scale.unit), interval)


def _list_text(key: str, values: list[float], unit: str) -> ParameterText:
    """A tabulated curve as its numbers; a long one by its length and range, since its figure shows the rest."""
    largest = max((abs(value) for value in values), default=0.0)
    scale = _scale(key, largest, unit)
    shown = [significant(value * scale.factor) for value in values]
    if len(shown) > _LONGEST_LIST:
        low, high = (significant(end * scale.factor) for end in (min(values), max(values)))
        return ParameterText(plain(key), with_unit(f"{len(shown)} points, {low} to {high}", scale.unit), "")
    return ParameterText(plain(key), with_unit(", ".join(shown), scale.unit), "")


def effect_sentence(effect: EffectResult) -> str:
    """An effect with its leading parameters, e.g. 'backlash 7.5 µm [7.4, 7.7]'."""
    words = [plain(one.value) for one in effect.parameters.values() if isinstance(one.value, str)]
    numbers = [key for key, one in effect.parameters.items() if not isinstance(one.value, str)]
    texts = [_named(key, effect.parameters[key]) for key in headline_parameters(effect.name, numbers)]
    where = f" ({', '.join(words)})" if words else ""
    colon = ":" if texts and texts[0][:1].isalpha() else ""
    return f"{effect_words(effect.name)}{where}{colon} {', '.join(texts)}".strip()


def _named(key: str, parameter: ParameterResult) -> str:
    """A parameter in a sentence; a size with a unit needs no name there unless it is one of several of its kind."""
    text = parameter_text(key, parameter)
    if isinstance(parameter.value, float | int):
        text = _number_text(key, parameter.value, parameter.unit, parameter.ci95, _HEADLINE_DIGITS)
    speaks = key in _SPEAKING and unit_name(parameter.unit) != "1"
    return text.sentence if speaks else f"{text.name} {text.sentence}"
