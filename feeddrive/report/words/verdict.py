"""The verdict: what the declared plant lacks, how well the mended one predicts, and what stays open, in sentences."""

from __future__ import annotations

import math

from feeddrive.diagnosis.judging.result import ChannelResult, Diagnosis
from feeddrive.diagnosis.unexplained.unexplained_result import Carried
from feeddrive.effects.tabulated import PERIODIC
from feeddrive.report.words.explained_words import odds_text
from feeddrive.report.words.number_text import error_text, share_text, significant
from feeddrive.report.words.parameters import effect_sentence
from feeddrive.report.words.words import effect_words, joined, plain, variable_words
from feeddrive.units.quantity import percent

_NOISE_REACHED = 1.5
"""An error up to this multiple of the sensor noise counts as noise: the noise itself is only estimated."""

_NOISE_KNOWN = 1.25
"""Multiple of the sensor noise above which it is told: a level that is read from a recording is known to a fifth."""

_TELLS = {
    "motor_torque": "friction, masses and ripples of the torque",
    "table_position": "free play, stiffness and errors of the lead",
}
"""Channel of a motion to what it alone tells."""


def verdict_sentences(diagnosis: Diagnosis) -> list[str]:
    """The verdict in plain text, the main finding first."""
    tables = _tables(diagnosis) if diagnosis.effects else ""
    beside = f"Beside these it carries what no named effect explains: {tables}." if tables else ""
    curves = [
        f"{effect_words(one.curve_of)}, as {effect_words(one.name)} over {_over(one.variable)}"
        for one in _carried(diagnosis)
        if one.curve_of
    ]
    another = f"It carries what the catalogue's form misses of {'; '.join(curves)}." if curves else ""
    stated = [one.statement for one in diagnosis.changes.changes]
    changed = f"Between the recordings changed: {'; '.join(stated)}." if stated else ""
    found = [_main_finding(diagnosis), diagnosis.untried, *_not_judged(diagnosis), another, beside, changed]
    sentences = [*found, _errors(diagnosis), *_above_noise(diagnosis)]
    return [sentence for sentence in sentences + _beyond(diagnosis) + _doubts(diagnosis) if sentence]


def _over(variable: str) -> str:
    """The variable of a table in words."""
    within = variable.removeprefix(PERIODIC)
    return f"one period of the {plain(within)}" if within != variable else plain(variable)


def noise_multiple(channel: ChannelResult) -> float:
    """Error after over sensor noise; NaN where no noise is known."""
    return channel.after.rms / channel.noise_rms if channel.noise_rms > 0.0 else math.nan


def is_noise(diagnosis: Diagnosis, channel: ChannelResult) -> bool:
    """Whether what is left of a channel is no more than noise.

    What an encoder's steps may hold, and the model itself may miss, is noise as well (`noise_floor`): behind steps
    of ten nanometres a table at rest is off by one rounding as long as it rests.
    """
    known = diagnosis.unexplained.get(channel.name)
    return noise_multiple(channel) <= _NOISE_REACHED or bool(known and known.above and not known.above.is_left)


def _main_finding(diagnosis: Diagnosis) -> str:
    """What is missing, or that nothing is."""
    if not diagnosis.channels:
        return "No channel could be judged."
    if diagnosis.effects:
        found = "; ".join(effect_sentence(effect) for effect in diagnosis.effects)
        return f"The declared plant lacks: {found}."
    if tables := _tables(diagnosis):
        return f"The declared plant lacks something of no known name: {tables}."
    if diagnosis.changes.changes:
        return "No effect is missing in every recording, but the recordings differ."
    all_within = " within their tolerances" if not any(one.is_beyond for one in diagnosis.calibrated) else ""
    within = f", its values calibrated{all_within}," if diagnosis.calibrated else ""
    if diagnosis.untried:
        return "Nothing was found that the declared plant lacks, as far as was tried."
    if all(is_noise(diagnosis, channel) for channel in diagnosis.channels):
        most = max((noise_multiple(channel) for channel in diagnosis.channels), default=1.0)
        down_to = f"{significant(most, 2)} times the sensor noise" if most > _NOISE_KNOWN else "sensor noise"
        down_to = down_to if most <= _NOISE_REACHED else "the noise and the steps of its sensors"
        return f"Nothing is missing: the declared plant{within} explains the recording down to {down_to}."
    return "No known effect was found that the declared plant lacks, but it does not explain the recording fully."


def _not_judged(diagnosis: Diagnosis) -> list[str]:
    """What a motion does not tell because one of its two channels was not recorded."""
    judged = {channel.name for channel in diagnosis.channels}
    lacking = [name for name in _TELLS if name not in judged] if judged & set(_TELLS) else []
    return [f"No {plain(name)} was compared, which is what shows {_TELLS[name]}." for name in lacking]


def _tables(diagnosis: Diagnosis) -> str:
    """What the plant carries as tables because no named effect explains it."""
    carried = [one for one in _carried(diagnosis) if not one.curve_of]
    return "; ".join(f"{effect_words(one.name)} over {_over(one.variable)}" for one in carried)


def _carried(diagnosis: Diagnosis) -> list[Carried]:
    """Every table that the plant carries."""
    return [one for left in diagnosis.unexplained.values() for one in left.carried]


def _errors(diagnosis: Diagnosis) -> str:
    """The rms error of each channel."""
    if not diagnosis.channels:
        return ""
    listed = ", ".join(_error(channel, diagnosis.nothing_missing) for channel in diagnosis.channels)
    edges = {channel.band_hz[1] for channel in diagnosis.channels}
    band = f" up to {significant(max(edges), 3)} Hz" if len(edges) == 1 and max(edges) > 1 else ""
    return f"Error on data not fitted{band}: {listed}."


def _error(channel: ChannelResult, nothing_missing: bool) -> str:
    """One channel of the sentence about errors."""
    before, after = (error_text(figures.rms, channel.unit) for figures in (channel.before, channel.after))
    change = after if nothing_missing else f"{before} → {after}"
    noise = f" (sensor noise {error_text(channel.noise_rms, channel.unit)})" if channel.noise_rms > 0.0 else ""
    return f"{plain(channel.name)} {change} rms{noise}"


def _above_noise(diagnosis: Diagnosis) -> list[str]:
    """Channels whose error stays above noise, and channels that became worse."""
    sentences = []
    for channel in diagnosis.channels:
        if channel.after.rms > 1.02 * channel.before.rms:
            than = "the effects than without" if diagnosis.effects else "the calibrated values than with the declared"
            sentences.append(f"{_begin(plain(channel.name))} is predicted worse with {than}.")
        if _left_multiple(diagnosis, channel) > _NOISE_REACHED and not is_noise(diagnosis, channel):
            sentences.append(_left(diagnosis, channel))
    return sentences


def _left_multiple(diagnosis: Diagnosis, channel: ChannelResult) -> float:
    """`noise_multiple` without what the changes between the recordings explain of the error."""
    return noise_multiple(channel) * math.sqrt(
        1 - min(max(diagnosis.changes.explains.get(channel.name, 0.0), 0.0), 1.0)
    )


def _left(diagnosis: Diagnosis, channel: ChannelResult) -> str:
    """How much of a channel is left above noise and what it depends on."""
    multiple = significant(_left_multiple(diagnosis, channel), 2)
    beside = "beside what changed, " if diagnosis.changes.explains.get(channel.name, 0.0) > 0.0 else ""
    left = f"Still unexplained: {beside}the error of {plain(channel.name)} is {multiple} times the sensor noise"
    known = diagnosis.unexplained.get(channel.name)
    if known is None or not known.depends_on:
        return f"{left}."
    return f"{left}; it depends on {joined([variable_words(one.variable) for one in known.depends_on])}."


def _doubts(diagnosis: Diagnosis) -> list[str]:
    """Effects that do not carry over, ambiguous sets and the simulated loop."""
    sentences = [
        f"These data cannot tell apart: {joined([effect_words(name) for name in names])}."
        for names in diagnosis.ambiguous
    ]
    sentences += _possible(diagnosis)
    idle = [effect_words(effect.name) for effect in diagnosis.effects if not effect.carries]
    if idle:
        sentences.append(f"Not confirmed on data not fitted: {joined(idle)}.")
    if diagnosis.simulation is not None:
        run = diagnosis.simulation
        change = f"{share_text(run.before)} → {share_text(run.after)}"
        sentences.append(f"Closed-loop simulation error of {plain(run.channel)}, relative: {change}.")
    return sentences


def _beyond(diagnosis: Diagnosis) -> list[str]:
    """Values that were calibrated beyond their tolerances, and are not asserted to be there."""
    beyond = [
        f"{one.words} {percent(one.value / one.declared)} of the declared (tolerance {percent(one.tolerance)})"
        for one in diagnosis.calibrated
        if one.is_beyond and one.key != "torque_constant"  # the recorder's: told with its mend under `quality`
    ]
    if not beyond:
        return []
    return [
        f"Calibrated beyond tolerance, which these recordings do not settle: {joined(beyond)}. Check what is declared."
    ]


def _possible(diagnosis: Diagnosis) -> list[str]:
    """Names that are not asserted, with their odds; what settles one, where it is one."""
    alone = [one for one in diagnosis.possible if not one.instead_of]
    if not alone:
        return []
    names = [f"{effect_words(one.name)} (odds {odds_text(one.odds / (1 + one.odds))})" for one in alone]
    beside = "Possible beside these" if diagnosis.effects else "Possible, and not asserted"
    settled = f"; {alone[0].settles} settles it" if len(alone) == 1 else "; diagnosis.json says what settles each"
    return [f"{beside}: {joined(names)}{settled}."]


def _begin(text: str) -> str:
    """A sentence's beginning."""
    return text[:1].upper() + text[1:]
