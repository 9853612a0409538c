"""All figures of a diagnosis in the order of the report, and those of effects and of what the named effects leave."""

from __future__ import annotations

import math
from collections.abc import Iterator
from pathlib import Path
from typing import TYPE_CHECKING

import numpy as np

from feeddrive.diagnosis.judging.result import ChannelResult, Diagnosis, EffectResult, Trial
from feeddrive.diagnosis.unexplained.unexplained_result import Dependence
from feeddrive.files import write_bytes_atomically
from feeddrive.report.figures.drawing import (
    AFTER,
    MEASURED,
    NOISE,
    RenderedFigure,
    ReportFigure,
    dress,
    legend_above,
    new_figure,
    render,
)
from feeddrive.report.figures.figure_dependence import dependence_figure
from feeddrive.report.figures.figure_series import series_figure
from feeddrive.report.figures.figure_spectrum import spectrum_figure
from feeddrive.report.figures.selection import detailed_channels, drawn_series, stem_of
from feeddrive.report.words.number_text import (
    axis_label,
    fixed,
    scale_for_difference,
    scale_for_signal,
    scale_for_value,
    share_text,
)
from feeddrive.report.words.words import effect_words, figure_text, plain, variable_words

if TYPE_CHECKING:
    from matplotlib.axes import Axes


def report_figures(diagnosis: Diagnosis) -> Iterator[ReportFigure]:
    """The figures that the diagnosis has data for, one at a time so that few are in memory at once."""
    effects = explains_figure(diagnosis)
    if effects is not None:
        yield effects
    yield from curve_figures(diagnosis)
    for number, recording, channel, series in drawn_series(diagnosis):
        yield series_figure(diagnosis, number, recording, channel, series)
    for channel in detailed_channels(diagnosis):
        for figure in (dependence_figure(diagnosis, channel), spectrum_figure(diagnosis, channel)):
            if figure is not None:
                yield figure
    yield from unexplained_figures(diagnosis)
    tried = trials_figure(diagnosis)
    if tried is not None:
        yield tried


def render_figures(diagnosis: Diagnosis) -> tuple[RenderedFigure, ...]:
    """All figures as PNG; give the result to `write_report` and `save_figures` to draw only once."""
    return tuple(render(entry) for entry in report_figures(diagnosis))


def save_figures(diagnosis: Diagnosis, folder: Path, rendered: tuple[RenderedFigure, ...] | None = None) -> list[Path]:
    """Write every figure as PNG into `folder`, made if need be, drawn here if not given; the files in order."""
    figures = render_figures(diagnosis) if rendered is None else rendered
    paths = [folder / f"{figure.stem}.png" for figure in figures]
    for path, figure in zip(paths, figures, strict=True):
        write_bytes_atomically(path, figure.png)
    return paths


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


STEM = "left_over"
"""How the file names of these figures begin."""

_COLUMNS = 2


def unexplained_figures(diagnosis: Diagnosis) -> list[ReportFigure]:
    """A figure for each channel of which something is left that follows a variable."""
    found = [_channel_figure(diagnosis, channel) for channel in diagnosis.channels]
    return [figure for figure in found if figure is not None]


def _channel_figure(diagnosis: Diagnosis, channel: ChannelResult) -> ReportFigure | None:
    left = diagnosis.unexplained.get(channel.name)
    drawn = [one for one in left.depends_on if one.table is not None and one.seen is not None] if left else []
    if not drawn:
        return None
    columns = min(_COLUMNS, len(drawn))
    lines = -(-len(drawn) // columns)
    figure = new_figure(2.7 * lines)
    panels = figure.subplots(lines, columns, squeeze=False).ravel()
    for axes in panels[len(drawn) :]:
        axes.remove()
    for axes, one in zip(panels, drawn, strict=False):
        _panel(axes, one)
    title = f"What is left of {plain(channel.name)}, over what it follows"
    caption = (
        "Points: mean over the judged data of what the named effects leave, other terms taken out, with its standard "
        "error. Line: the term as it was fitted on the other data, with its standard error as a band. Points that "
        "leave the line are a shape that the term lacks."
    )
    return ReportFigure(f"{STEM}_{stem_of(channel.name)}", title, caption, figure)


def _panel(axes: Axes, one: Dependence) -> None:
    """One variable: points with errors and the term."""
    table, seen = one.table, one.seen
    assert table is not None and seen is not None
    at, values, errors = (np.array(numbers) for numbers in (table.breakpoints, table.values, table.errors))
    centre, mean, spread = (np.array(numbers) for numbers in (seen.centre, seen.mean, seen.error))
    if table.period:
        at, values, errors = np.append(at, table.period), np.append(values, values[0]), np.append(errors, errors[0])
    elif len(centre):  # constant outside the breakpoints
        ends = np.array([min(at[0], centre.min()), max(at[-1], centre.max())])
        at, values, errors = (np.concatenate([a, b, c]) for a, b, c in _held(ends, at, values, errors))
    over = scale_for_signal(one.variable, float(np.abs(at).max()), table.breakpoint_unit)
    up = scale_for_difference(float(np.abs([*values, *mean]).max()), table.unit)
    axes.fill_between(
        over.factor * at, up.factor * (values - errors), up.factor * (values + errors), color=AFTER, alpha=0.2, lw=0
    )
    axes.plot(over.factor * at, up.factor * values, color=AFTER, lw=1.6, label="term")
    axes.errorbar(
        over.factor * centre,
        up.factor * mean,
        yerr=up.factor * spread,
        fmt=".",
        color=MEASURED,
        ecolor=NOISE,
        ms=4.5,
        elinewidth=0.8,
        label="judged data",
    )
    if _spreads(one):
        axes.set_xscale("symlog", linthresh=float(over.factor * max(centre[0], 1e-9)))
    dress(axes, axis_label(_over(one), over.unit), axis_label(_of(one), up.unit))
    legend_above(axes)


def _held(ends: np.ndarray, at: np.ndarray, values: np.ndarray, errors: np.ndarray) -> list[tuple[np.ndarray, ...]]:
    """Breakpoints, values and errors, each with its ends held to the ends of the data."""
    first, last = ends[:1], ends[1:]
    return [(first, at, last), (values[:1], values, values[-1:]), (errors[:1], errors, errors[-1:])]


def _spreads(one: Dependence) -> bool:
    """Whether a variable is shown over decades."""
    return one.variable == "travel_since_reversal" and one.seen is not None and len(one.seen.centre) > 1


def _over(one: Dependence) -> str:
    return f"{variable_words(one.variable)}{' in one period' if one.table is not None and one.table.period else ''}"


def _of(one: Dependence) -> str:
    """What is drawn: the residual, or its part with the direction or per velocity; the title names the channel."""
    return "left" + {"direction": ", against the motion", "table_velocity": ", per velocity"}.get(one.times, "")
