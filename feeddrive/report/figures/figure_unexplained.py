"""Figure of what the named effects leave, over the variables that it follows: means of the judged data and the term."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from feeddrive.diagnosis.judging.result import ChannelResult, Diagnosis
from feeddrive.diagnosis.unexplained.unexplained_result import Dependence
from feeddrive.report.figures.drawing import AFTER, MEASURED, NOISE, ReportFigure, dress, legend_above, new_figure
from feeddrive.report.selection import stem_of
from feeddrive.report.words.people import axis_label, scale_for_signal, scale_for_value
from feeddrive.report.words.words import plain, variable_words

if TYPE_CHECKING:
    from matplotlib.axes import Axes

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
    up = scale_for_value(float(np.abs([*values, *mean]).max()), table.unit)
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
