"""The figure of a sweep: a curve over one parameter, a map over two, small multiples over more or over random ones."""

from __future__ import annotations

import math
from collections.abc import Callable, Sequence
from textwrap import wrap
from typing import TYPE_CHECKING

import numpy as np

from feeddrive.report.figures.drawing import AFTER, BEFORE, MEASURED, NOISE, ReportFigure, dress, new_figure
from feeddrive.report.words.words import figure_text, plain
from feeddrive.simulate.sweep.sweep_table import SweepRow, SweepTable
from feeddrive.simulate.sweep.sweep_values import Parameter
from feeddrive.typing import FloatArray
from feeddrive.units.quantity import shown_unit

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.colors import Normalize
    from matplotlib.figure import Figure

_MOST_COLUMNS = 4
"""Parameters side by side; the figure names those that have no place."""

_DECADE = 10.0
_LETTERS = 115
"""Letters of a line of the title."""

_MANY_WORDS = 6
_RUNS_OF_A_SCATTER = 400
"""Runs up to which points are drawn full."""


def sweep_figure(name: str, table: SweepTable, metrics: Sequence[str]) -> ReportFigure:
    """One figure of a sweep.

    Args:
        name: of the scenario.
        table: with at least one finished run.
        metrics: names out of `table.units`, one to four.
    """
    drawn = any(one.random for one in table.parameters)
    count = len(table.parameters)
    draw: Callable[[SweepTable, Sequence[str]], Figure]
    draw = _maps if count == 2 and not drawn else _curves if count == 1 else _multiples
    text = _caption(table, metrics, bars=draw is _multiples)
    figure = draw(table, metrics)
    title = "\n".join(wrap(figure_text(f"{name}: {text}"), _LETTERS))
    figure.suptitle(title, fontsize=9.5, x=0.01, ha="left")
    return ReportFigure("sweep", "Metrics over the varied values", text, figure)


def _caption(table: SweepTable, metrics: Sequence[str], bars: bool) -> str:
    failed = len(table.rows) - len(table.finished)
    text = f"{len(table.rows)} runs"
    if failed:
        text += f", {failed} failed (orange crosses; the reasons are in the table)"
    if any(row.metrics.get(name) is None for row in table.finished for name in metrics):
        text += "; nothing drawn, or grey: never reached"
    if bars and not all(one.random for one in table.parameters):
        text += "; bar: mean over all other values"
    left_out = [one.key for one in table.parameters[_MOST_COLUMNS:]] if bars else []
    return f"{text}; not shown: {', '.join(left_out)}" if left_out else text


def _scaled(table: SweepTable, name: str) -> tuple[FloatArray, str]:
    """A metric of every run as people are used to it, NaN where there is none, and its label."""
    values = np.array([_number(row.metrics.get(name)) for row in table.rows])
    largest = float(np.nanmax(np.abs(values))) if np.isfinite(values).any() else 0.0
    factor, _, unit = shown_unit(largest, table.units[name])
    label = plain(name.replace(".", " ", 1))
    return factor * values, f"{label}\n[{unit or '1'}]"


def _number(value: float | None) -> float:
    return math.nan if value is None else value


def _failed(table: SweepTable) -> list[bool]:
    return [bool(row.reason) for row in table.rows]


def _places(one: Parameter, rows: Sequence[SweepRow], column: int) -> FloatArray:
    """Where a parameter's values stand on an axis: numbers as they are, words one after the other."""
    values = [row.values[column] for row in rows]
    if one.unit:
        return np.array([float(value) for value in values])
    return np.array([float(one.values.index(value)) for value in values])


def _name(one: Parameter, between: str = " ") -> str:
    """The last two words of a key and the unit."""
    words = between.join(plain(word) for word in one.key.split(".")[-2:])
    return f"{words} [{one.unit}]" if one.unit not in ("", "1") else words


def _word_ticks(axes: Axes, one: Parameter, vertical: bool = False) -> None:
    if one.unit:
        return
    words = [word if len(str(word)) < 16 else f"{str(word)[:13]}..." for word in one.values]
    axis = axes.yaxis if vertical else axes.xaxis
    axis.set_ticks(range(len(words)), [str(word) for word in words])
    if not vertical:
        axes.set_xlim(-0.5, len(words) - 0.5)
        if len(words) > _MANY_WORDS:
            axes.tick_params(axis="x", rotation=60)


def _labelled(axes: Axes, x_label: str, y_label: str, title: str = "") -> None:
    """The look of all figures, with labels of two lines."""
    dress(axes, "", "", title)
    across, up = ("\n".join(figure_text(line) for line in label.split("\n")) for label in (x_label, y_label))
    axes.set_xlabel(across, fontsize=9)
    axes.set_ylabel(up, fontsize=9)


def _curves(table: SweepTable, metrics: Sequence[str]) -> Figure:
    (one,) = table.parameters
    figure = new_figure(1.0 + 1.8 * len(metrics))
    places = _places(one, table.rows, 0)
    order, mark = np.argsort(places, kind="stable"), "o" if len(places) <= 60 else ""
    line = "" if one.random or not one.unit else "-"
    panels = figure.subplots(len(metrics), 1, sharex=True, squeeze=False)[:, 0]
    for axes, name in zip(panels, metrics, strict=True):
        values, label = _scaled(table, name)
        axes.plot(
            places[order],
            values[order],
            marker=mark or ("." if not line else ""),
            ls=line,
            color=AFTER,
            ms=4,
            clip_on=False,
        )
        _crosses(axes, places[_failed(table)])
        _labelled(axes, _name(one) if axes is panels[-1] else "", label)
        _from_zero(axes, values)
    _word_ticks(panels[-1], one)
    return figure


def _crosses(axes: Axes, places: FloatArray) -> None:
    """Failed runs at the foot of the axes."""
    if len(places):
        bottom = np.full(len(places), 0.03)
        axes.plot(places, bottom, "x", color=BEFORE, ms=5, transform=axes.get_xaxis_transform(), clip_on=False)


def _from_zero(axes: Axes, values: FloatArray) -> None:
    """Quantities of one sign that vary by more than a third are drawn from zero on."""
    known = values[np.isfinite(values)]
    if len(known) and known.min() >= 0 and known.min() < 0.67 * known.max():
        axes.set_ylim(bottom=0)


def _maps(table: SweepTable, metrics: Sequence[str]) -> Figure:
    across, up = table.parameters
    columns = 1 if len(metrics) == 1 else 2
    lines = -(-len(metrics) // columns)
    figure = new_figure(0.6 + 3.0 * lines)
    panels = figure.subplots(lines, columns, squeeze=False).ravel()
    for axes, name in zip(panels, metrics, strict=False):
        _map(figure, axes, table, name)
        _labelled(axes, _name(across), _name(up))
        axes.grid(False)
        _word_ticks(axes, across)
        _word_ticks(axes, up, vertical=True)
    for axes in panels[len(metrics) :]:
        axes.remove()
    return figure


def _map(figure: Figure, axes: Axes, table: SweepTable, name: str) -> None:
    """One metric over two parameters, a field for each run."""
    from matplotlib.colors import LogNorm
    from matplotlib.ticker import FuncFormatter, LogLocator, NullFormatter

    values, label = _scaled(table, name)
    places = [_places(one, table.rows, column) for column, one in enumerate(table.parameters)]
    levels = [np.unique(place) for place in places]
    grid = np.full((len(levels[1]), len(levels[0])), np.nan)
    at = [np.searchsorted(level, place) for level, place in zip(levels, places, strict=True)]
    grid[at[1], at[0]] = values
    edges = [_edges(level) for level in levels]
    axes.set_facecolor("#dddddd")
    known = np.ma.masked_invalid(grid)
    fields = axes.pcolormesh(edges[0], edges[1], known, cmap="viridis", norm=_shading(values), rasterized=True)
    bar = figure.colorbar(fields, ax=axes)
    bar.set_label(figure_text(label.replace("\n", " ")), fontsize=9)
    bar.ax.tick_params(labelsize=8, which="both")
    if isinstance(fields.norm, LogNorm):
        bar.ax.yaxis.set_major_locator(LogLocator(subs=(1, 2, 5)))
    bar.ax.yaxis.set_major_formatter(FuncFormatter(lambda value, _: f"{value:g}"))
    bar.ax.yaxis.set_minor_formatter(NullFormatter())
    failed = _failed(table)
    axes.plot(places[0][failed], places[1][failed], "x", color=BEFORE, ms=5)


def _shading(values: FloatArray) -> Normalize:
    """Logarithmic where the values are positive over more than a decade."""
    from matplotlib.colors import LogNorm, Normalize

    known = values[np.isfinite(values)]
    if len(known) and known.min() > 0 and known.max() > _DECADE * known.min():
        return LogNorm(known.min(), known.max())
    return Normalize(known.min(), known.max()) if len(known) else Normalize(0, 1)


def _edges(levels: FloatArray) -> FloatArray:
    """Borders of fields about the levels."""
    middle = 0.5 * (levels[1:] + levels[:-1])
    return np.array([2 * levels[0] - middle[0], *middle, 2 * levels[-1] - middle[-1]])


def _multiples(table: SweepTable, metrics: Sequence[str]) -> Figure:
    shown = table.parameters[:_MOST_COLUMNS]
    figure = new_figure(0.9 + 1.9 * len(metrics))
    panels = figure.subplots(len(metrics), len(shown), sharey="row", sharex="col", squeeze=False)
    for line, name in enumerate(metrics):
        values, label = _scaled(table, name)
        for column, one in enumerate(shown):
            axes = panels[line, column]
            places, random = _places(one, table.rows, column), one.random
            size = 3.0 if len(values) <= _RUNS_OF_A_SCATTER else 1.5
            axes.plot(places, values, "o", color=NOISE if not random else AFTER, ms=size, alpha=0.6, mew=0)
            _crosses(axes, places[_failed(table)])
            title = _rank_text(places, values) if random else ""
            last = line == len(metrics) - 1
            _labelled(axes, _name(one, between="\n") if last else "", label if column == 0 else "", title)
            if not random:
                _level_means(axes, places, values)
            _word_ticks(axes, one)
        _from_zero(panels[line, 0], values)
    return figure


def _level_means(axes: Axes, places: FloatArray, values: FloatArray) -> None:
    """The mean of the runs at each level; failed ones have no part in it."""
    levels = np.unique(places)
    width = 0.3 * float(np.diff(levels).min()) if len(levels) > 1 else 0.3
    for level in levels:
        known = values[(places == level) & np.isfinite(values)]
        if len(known):
            axes.plot([level - width, level + width], [known.mean()] * 2, color=MEASURED, lw=1.8)


def _rank_text(places: FloatArray, values: FloatArray) -> str:
    """Spearman's rank correlation of a random value and a metric."""
    from scipy.stats import spearmanr

    known = np.isfinite(values)
    if known.sum() < 3 or len(np.unique(values[known])) < 2:
        return ""
    return f"rank correlation {spearmanr(places[known], values[known]).statistic:+.2f}"
