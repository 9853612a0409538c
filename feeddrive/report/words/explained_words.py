"""Verdicts on measured numbers and on a measured frequency response, in sentences."""

from __future__ import annotations

import math

from feeddrive.diagnosis.numbers.declared_values import DeclaredValue
from feeddrive.diagnosis.numbers.numbers_result import Beyond, NumbersResult
from feeddrive.diagnosis.responses.response_result import Found, Parameter, ResponseResult
from feeddrive.report.words.words import joined
from feeddrive.units.quantity import format_quantity

_ALSO_MEETS = 5
"""Single causes named in a sentence; the table has all."""


def numbers_verdict(result: NumbersResult) -> list[str]:
    """The verdict in plain text, the main finding first."""
    return [sentence for sentence in (_main(result), _fit(result), _open(result), _next(result)) if sentence]


def value_text(value: DeclaredValue, number: float | None) -> str:
    """A value with its unit; of a missing part that adds nothing: rigid."""
    return "rigid" if number is None or math.isinf(number) else format_quantity(number, value.unit)


def odds_text(probability: float) -> str:
    """A probability as odds, as people say them."""
    if probability >= 0.999:
        return "more than 999 to 1"
    if probability <= 0.001:
        return "less than 1 to 999"
    odds = probability / (1 - probability)
    shown = max(odds, 1 / odds)
    digits = f"{shown:.2g}" if shown < 100 else f"{shown:.0f}"
    return f"{digits} to 1" if odds >= 1 else f"1 to {digits}"


def _main(result: NumbersResult) -> str:
    names = ", ".join(one.value.words for one in result.suspects)
    if result.beyond:
        found = f"Other than declared: {'; '.join(map(_finding, result.beyond))}."
        more = f" So is one more value, and these numbers cannot tell which: {names}." if names else ""
        return found + more
    if names:
        return f"A value is beyond its tolerance, and these numbers cannot tell which: {names}."
    return (
        "The declared values explain the numbers within their tolerances: nothing has to be other than declared "
        f"(odds {odds_text(result.within)})."
    )


def _finding(one: Beyond) -> str:
    low, high = (value_text(one.value, end) for end in one.interval)
    declared = "rigid" if one.value.missing else format_quantity(one.value.value, one.value.unit)
    now = value_text(one.value, one.now)
    return f"{one.value.words} {now} [{low}, {high}], declared {declared} (odds {odds_text(one.probability)})"


def _fit(result: NumbersResult) -> str:
    parts = []
    for one, *values in zip(result.problem.measured, result.declared, result.after, strict=True):
        measured, declared, after = (format_quantity(float(value), one.kind.unit) for value in (one.value, *values))
        name = one.name.replace("_", " ")
        parts.append(f"{name} {measured} measured, {declared} declared, {after} at the most likely values")
    tail = "" if result.explained else " More is left than the tolerances of the numbers allow."
    return f"{'; '.join(parts)}.{tail}"


def _open(result: NumbersResult) -> str:
    meeting = [one for one in result.singles if one.meets]
    if result.beyond:
        return ""
    if not meeting:
        return "No single value meets all numbers with the others exactly as declared; several move within tolerance."
    shown = "; ".join(
        f"{one.value.words} {value_text(one.value, one.value.number(one.coordinate))}" for one in meeting[:_ALSO_MEETS]
    )
    return f"Each of these alone would meet all numbers: {shown}."


def _next(result: NumbersResult) -> str:
    if not result.further:
        return ""
    best = result.further[0]
    how = f": {best.how}" if best.how else ""
    return f"Most would be learnt from {best.name.replace('_', ' ')}{how} ({best.information:.1f} bit)."


def response_verdict(result: ResponseResult) -> list[str]:
    """The verdict in plain text, the main finding first."""
    return [sentence for sentence in (_main_of_response(result), _possible(result), _errors(result)) if sentence]


def found_text(one: Found) -> str:
    """What was found with its values, intervals and odds."""
    values = ", ".join(_value(number, one) for number in one.parameters)
    declared = f", declared {one.declared}" if one.declared else ""
    probability = 1 / (1 + math.exp(-min(one.log_odds, 700.0)))
    return f"{one.words} {values}{declared} (odds {odds_text(probability)})"


def _value(number: Parameter, one: Found) -> str:
    low, high = (format_quantity(end, number.unit) for end in number.interval)
    name = f"{number.key} " if len(one.parameters) > 1 else ""
    return f"{name}{format_quantity(number.value, number.unit)} [{low}, {high}]"


def _main_of_response(result: ResponseResult) -> str:
    if result.asserted:
        return f"Other than declared: {'; '.join(map(found_text, result.asserted))}."
    if result.found:
        return "The declared values nearly explain the response within their tolerances; no name is asserted."
    return "The declared values explain the response within their tolerances: nothing has to be other than declared."


def _possible(result: ResponseResult) -> str:
    texts = [f"Possible: {found_text(one)}." for one in result.found if not one.asserted]
    texts += [
        f"{one.words.capitalize()} cannot be told from {joined(list(one.rivals[:2]))} by this response."
        for one in result.found
        if one.rivals
    ]
    return " ".join(texts)


def _errors(result: ResponseResult) -> str:
    return (
        f"Error of the response, weighted by coherence: {100 * result.error_before:.3g} % as declared, "
        f"{100 * result.error_calibrated:.3g} % within tolerances, {100 * result.error_after:.3g} % as found; its own "
        f"scatter is {100 * result.scatter:.2g} %."
    )
