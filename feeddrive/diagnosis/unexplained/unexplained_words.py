"""What is left of a channel, in sentences."""

from __future__ import annotations

from collections.abc import Mapping, Sequence

from feeddrive.diagnosis.judging.result import ChannelResult
from feeddrive.diagnosis.unexplained.unexplained_result import Above, Dependence, Instead, Unexplained
from feeddrive.units.quantity import format_quantity

WORDS = {
    "motor_angle": "the motor angle",
    "predicted_torque": "the torque that the plant predicts",
    "travel_since_reversal": "the travel since the last reversal",
    "direction": "the direction",
    "time": "time",
}
"""Variables in a sentence."""

CHANGE = 0.01
"""Share of the rms by which an error must change to be mentioned."""


def variable_in_words(name: str) -> str:
    """A variable in a sentence."""
    return WORDS.get(name, f"the {name.replace('_', ' ')}")


def term_in_words(one: Dependence) -> str:
    """A dependence in a sentence: its variable, the second one, its period."""
    name = variable_in_words(one.variable)
    if one.times:
        name = f"{name} and {variable_in_words(one.times)} together"
    return f"{name}, period {one.period}" if one.period else name


def no_effect() -> str:
    """There is no tabulated effect over these variables."""
    return "not carried, since no tabulated effect stands for it"


def no_gain(explains: Mapping[str, float]) -> str:
    """The effect does not pay on the judged data."""
    shares = ", ".join(f"{share:.1%} of {name}" for name, share in explains.items())
    return f"not carried, since a table of it does not lower the error on data not fitted enough ({shares})"


def rest_in_words(channel: ChannelResult, rest: Unexplained, lost: Sequence[Dependence], after: float | None) -> str:
    """Everything about what is left of a channel.

    Args:
        channel: with the named effects.
        rest: figures of what is left.
        lost: dependences that the judged data do not confirm.
        after: rms with what is carried; None where nothing is.
    """
    assert rest.above is not None
    sentences = [_level(rest.above, channel.unit)]
    if rest.depends_on:
        phrases = [_followed(one) for one in rest.depends_on]
        sentences.append(f"It follows {'; '.join(phrases)}.")
    elif rest.above.is_left:
        sentences.append("It follows none of the measured variables.")
    if lost:
        phrases = [term_in_words(one) for one in lost]
        sentences.append(f"Seen on the fitted data and not confirmed on the judged: {'; '.join(phrases)}.")
    if after is not None and abs(after - rest.above.rms) > CHANGE * rest.above.rms:
        change = f"{_shown(rest.above.rms, channel.unit)} → {_shown(after, channel.unit)} rms"
        sentences.append(f"With what the plant carries as tables: {change}.")
    if rest.instead is not None:
        sentences.append(_instead(rest.instead))
    return " ".join([*sentences, *(f"{reason[:1].upper()}{reason[1:]}." for reason in rest.not_carried)])


def _instead(one: Instead) -> str:
    over = one.carried.variable.replace("periodic_", "one period of the ").replace("_", " ")
    period = (
        f" ({_shown(one.carried.table.period, one.carried.table.breakpoint_unit)})" if one.carried.table.period else ""
    )
    names = " and ".join(one.names)
    return (
        f"One {one.carried.name.replace('_', ' ')} over {over}{period} does as well on the judged data as {names} "
        "together: these names may stand in for one effect that has none."
    )


def _level(above: Above, unit: str) -> str:
    rms, floor = _shown(above.rms, unit), _shown(above.floor, unit)
    share = f"{above.share:.0%} ± {2 * above.standard_error:.0%} of its square"
    if above.is_left:
        return f"Left on the judged data: {rms} rms, noise floor {floor} rms; {share} is above the noise."
    return f"Nothing is left above the noise: {rms} rms on the judged data, noise floor {floor} rms ({share} above it)."


def _followed(one: Dependence) -> str:
    also = f" (or {', '.join(one.alike)}: these recordings cannot tell)" if one.alike else ""
    seen = "" if one.confirmed else ", not confirmed on the judged data"
    return f"{term_in_words(one)} ({one.share:.0%} of it: {one.statement}{seen}){also}"


def _shown(value: float, unit: str) -> str:
    return format_quantity(value, unit)
