"""Figures about the effects themselves: what each explains, what the search tried, and fitted curves."""

from __future__ import annotations

import math
from typing import TYPE_CHECKING

from feeddrive.diagnosis.judging.result import Diagnosis, EffectResult, Trial
from feeddrive.report.figures.drawing import AFTER, NOISE, ReportFigure, dress, new_figure
from feeddrive.report.selection import stem_of
from feeddrive.report.words.people import axis_label, fixed, scale_for_value, share_text
from feeddrive.report.words.words import effect_words, figure_text, plain

if TYPE_CHECKING:
    from matplotlib.axes import Axes

_MOST_ROUNDS = 6
_MOST_COLUMNS = 3
_MOST_TRIALS = 6
_MOST_CURVES = 2
_LONGEST_NAME = 46


def explains_figure(diagnosis: Diagnosis) -> ReportFigure | None:
    """Bars of what each effect explains in each channel; None where nothing was found."""
    channels = [one.name for one in diagnosis.channels if any(one.name in e.explains for e in diagnosis.effects)]
    if not diagnosis.effects or not channels:
        return None
    columns = min(_MOST_COLUMNS, len(channels))
    lines = -(-len(channels) // columns)
    figure = new_figure(lines * (0.8 + 0.34 * len(diagnosis.effects)))
    panels = figure.subplots(lines, columns, sharey=True, squeeze=False).ravel()
    for axes in panels[len(channels) :]:
        axes.remove()
    for i, (axes, channel) in enumerate(zip(panels, channels, strict=False)):
        _explains_panel(axes, channel, diagnosis.effects, first=i % columns == 0)
    caption = (
        "Each effect is left out by itself and all others are fitted again: the share of the squared error on data "
        "not fitted that is there only because it is missing. Effects overlap, so the bars do not add up. "
        "A long bar is an effect that nothing else can replace; the table gives the same as a factor."
    )
    return ReportFigure("explains", "What each effect alone can explain", caption, figure)


def _explains_panel(axes: Axes, channel: str, effects: tuple[EffectResult, ...], first: bool) -> None:
    """Bars of one channel, each with its number."""
    shares = [100.0 * effect.explains.get(channel, math.nan) for effect in effects]
    places = list(range(len(effects)))
    _bars(axes, places, shares, [AFTER] * len(shares), [0.0] * len(shares))
    axes.set_xlim(min(0.0, axes.get_xlim()[0]), 125.0)
    axes.set_xticks(range(0, 101, 20))
    dress(axes, "share of squared error [%]", "", plain(channel))
    _names_at_left(axes, places, [effect.name for effect in effects], shown=first)


def _bars(axes: Axes, places: list[int], percents: list[float], colours: list[str], errors: list[float]) -> None:
    """Horizontal bars with their numbers behind them; a bar that is not a number is left away."""
    finite = [value if math.isfinite(value) else 0.0 for value in percents]
    axes.barh(places, finite, color=colours, height=0.62)
    if any(errors):
        axes.errorbar(finite, places, xerr=errors, fmt="none", ecolor="#333333", elinewidth=0.9, capsize=2)
    left = min([0.0, *(value - error for value, error in zip(finite, errors, strict=True))])
    right = max([1e-9, *(value + error for value, error in zip(finite, errors, strict=True))])
    span = right - left
    for place, value, error in zip(places, percents, errors, strict=True):
        if math.isfinite(value):
            end = max(value + error, 0.0) + 0.02 * span
            axes.text(end, place, share_text(value / 100.0), va="center", fontsize=8.5)
    axes.set_xlim(left - 0.03 * span * (left < 0.0), right + 0.3 * span)


def _names_at_left(axes: Axes, places: list[int], names: list[str], shown: bool) -> None:
    """Effect names instead of numbers on the vertical axis, the first on top."""
    texts = [figure_text(plain(name))[:_LONGEST_NAME] for name in names]
    axes.set_yticks(places, texts, fontsize=8.5, color="#222222")
    axes.tick_params(axis="y", length=0, labelleft=shown)
    axes.grid(False, axis="y")
    axes.set_ylim(len(names) - 0.45, -0.55)


def trials_figure(diagnosis: Diagnosis) -> ReportFigure | None:
    """Bars of the gain of the best candidates in each round of the search; None where no trial was kept."""
    rounds = sorted({trial.round for trial in diagnosis.trials})[:_MOST_ROUNDS]
    if not rounds:
        return None
    columns = min(2, len(rounds))
    lines = -(-len(rounds) // columns)
    figure = new_figure(1.9 * lines + 0.2)
    panels = figure.subplots(lines, columns, squeeze=False).ravel()
    for axes in panels[len(rounds) :]:
        axes.remove()
    for axes, number in zip(panels, rounds, strict=False):
        _round_panel(axes, number, [trial for trial in diagnosis.trials if trial.round == number])
    return ReportFigure("tried", "Candidates in each round of the search", _trials_caption(diagnosis, rounds), figure)


def _round_panel(axes: Axes, number: int, trials: list[Trial]) -> None:
    """The best candidates of one round with their standard errors, the one taken in blue."""
    best = sorted(trials, key=lambda trial: (not trial.taken, -_finite(trial.gain)))[:_MOST_TRIALS]
    places = list(range(len(best)))
    colours = [AFTER if trial.taken else NOISE for trial in best]
    errors = [100.0 * max(0.0, _finite(trial.standard_error)) for trial in best]
    _bars(axes, places, [100.0 * trial.gain for trial in best], colours, errors)
    ending = "" if any(trial.taken for trial in best) else ", none taken"
    dress(axes, "gain [%]", "", f"round {number}{ending}")
    _names_at_left(axes, places, [trial.name for trial in best], shown=True)


def _finite(number: float) -> float:
    """The number, or zero where it is none."""
    return number if math.isfinite(number) else 0.0


def _trials_caption(diagnosis: Diagnosis, rounds: list[int]) -> str:
    """What to look at, and whether rounds are missing from the figure."""
    caption = (
        "Gain: the share of the cross-validated squared error, each channel weighted by its noise, that a candidate "
        "takes away, with its standard error. Blue: taken. The scale differs from round to round; the search ends "
        "where no candidate gains enough."
    )
    all_rounds = {trial.round for trial in diagnosis.trials}
    return f"{caption} Rounds shown: {len(rounds)} of {len(all_rounds)}." if len(all_rounds) > len(rounds) else caption


def curve_figures(diagnosis: Diagnosis) -> list[ReportFigure]:
    """A figure for each effect whose parameters are a tabulated curve: two lists of the same length."""
    found = [figure for effect in diagnosis.effects if (figure := _curve_figure(effect)) is not None]
    return found[:_MOST_CURVES]


def _curve_figure(effect: EffectResult) -> ReportFigure | None:
    """The second list of an effect over its first, with its interval where there is one."""
    lists = [(key, one) for key, one in effect.parameters.items() if isinstance(one.value, list)]
    if len(lists) != 2:
        return None
    (x_key, x), (y_key, y) = lists
    assert isinstance(x.value, list) and isinstance(y.value, list)
    if len(x.value) != len(y.value) or not x.value:
        return None
    x_scale = scale_for_value(max(map(abs, x.value)), x.unit)
    y_scale = scale_for_value(max(map(abs, y.value)), y.unit)
    figure = new_figure(2.8)
    axes = figure.subplots()
    places = [value * x_scale.factor for value in x.value]
    axes.plot(places, [value * y_scale.factor for value in y.value], "o-", color=AFTER, ms=3.5, lw=1.4)
    band = ""
    if isinstance(y.ci95, list) and len(y.ci95) == len(y.value):
        low, high = ([pair[end] * y_scale.factor for pair in y.ci95] for end in (0, 1))
        axes.fill_between(places, low, high, color=AFTER, alpha=0.2, lw=0.0)
        band = "; the band is the 95 % interval"
    dress(axes, axis_label(plain(x_key), x_scale.unit), axis_label(plain(y_key), y_scale.unit))
    words = effect_words(effect.name)
    ends = ", ".join(fixed(places[end], 0) for end in (0, -1))
    caption = f"Fitted curve from {ends.replace(', ', ' to ')} {x_scale.unit}{band}."
    return ReportFigure(f"curve_{stem_of(effect.name)}", f"Fitted curve: {words}", caption, figure)
