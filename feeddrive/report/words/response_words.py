"""The verdict on a measured frequency response, in sentences."""

from __future__ import annotations

import math

from feeddrive.diagnosis.responses.response_result import Found, Parameter, ResponseResult
from feeddrive.report.words.numbers_words import odds_text
from feeddrive.report.words.words import joined
from feeddrive.units.quantity import format_quantity


def response_verdict(result: ResponseResult) -> list[str]:
    """The verdict in plain text, the main finding first."""
    return [sentence for sentence in (_main(result), _possible(result), _errors(result)) if sentence]


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


def _main(result: ResponseResult) -> str:
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
