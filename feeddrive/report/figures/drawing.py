"""The look that all figures share: sizes, colours, axes, and the way to PNG. Matplotlib is imported on use."""

from __future__ import annotations

import io
import logging
import re
from dataclasses import dataclass
from functools import cache
from typing import TYPE_CHECKING, Any

from feeddrive.report.words.number_text import RAISED
from feeddrive.report.words.words import figure_text

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.axis import Axis
    from matplotlib.figure import Figure

MEASURED = "#222222"
BEFORE = "#d55e00"
AFTER = "#0072b2"
NOISE = "#8a8a8a"
LEFT_OUT = "#ececec"
WIDTH = 8.6
"""Width of a figure [inch]; at 100 dots per inch it fills the page's text width."""

_DOTS_PER_INCH = 150
_COLOURS = 128


@dataclass(frozen=True)
class ReportFigure:
    """A figure with its file stem, heading and the caption that says what to look at (plain text)."""

    stem: str
    title: str
    caption: str
    figure: Figure


@dataclass(frozen=True)
class RenderedFigure:
    """A figure as PNG bytes, with its file stem, heading and caption (plain text)."""

    stem: str
    title: str
    caption: str
    png: bytes


def new_figure(height: float) -> Figure:
    """An empty white figure of the report's width; height in inch. It belongs to no window and is never shown."""
    logging.getLogger("matplotlib").setLevel(logging.ERROR)  # where a person has no home it warns of its own cache
    from matplotlib.figure import Figure

    return Figure(figsize=(WIDTH, height), facecolor="white", layout="constrained")


def dress(axes: Axes, x_label: str, y_label: str, title: str = "") -> None:
    """Labels, light grid and two spines; every figure's axes pass here so that they look alike."""
    axes.set_xlabel(figure_text(x_label), fontsize=9)
    axes.set_ylabel(figure_text(y_label), fontsize=9)
    if title:
        axes.set_title(figure_text(title), fontsize=9, loc="left", color="#333333")
    axes.tick_params(labelsize=8.5, color="#888888")
    axes.spines[["top", "right"]].set_visible(False)
    axes.spines[["left", "bottom"]].set_color("#888888")
    for one in (axes.xaxis, axes.yaxis):
        written = one.get_major_formatter()
        if hasattr(written, "set_useOffset"):  # a number of a scale is read off as it stands
            written.set_useOffset(False)
        if one.get_scale() == "log":
            _with_plain_powers(one)
    axes.grid(True, color="#e4e4e4", linewidth=0.6)
    axes.set_axisbelow(True)


def _with_plain_powers(axis: Axis) -> None:
    """Write the powers of ten of an axis as plain letters: to parse a formula takes as long as to draw a panel."""
    usual, plain = _power_formatters()
    if type(axis.get_major_formatter()) is usual:
        axis.set_major_formatter(plain())
    if type(axis.get_minor_formatter()) is usual:
        axis.set_minor_formatter(plain())


@cache
def _power_formatters() -> tuple[type[Any], type[Any]]:
    """Matplotlib's own formatter of a logarithmic axis, and one that says the same in plain letters."""
    from matplotlib.ticker import LogFormatterSciNotation

    class PlainPowers(LogFormatterSciNotation):
        def __call__(self, x: float, pos: int | None = None) -> str:
            return without_formula(super().__call__(x, pos))

    return LogFormatterSciNotation, PlainPowers


def without_formula(label: str) -> str:
    """A power of ten that is written as a formula, such as $\\mathdefault{6\\times10^{-4}}$, in plain letters."""
    inner = re.sub(r"^\$\\mathdefault\{(.*)\}\$$", r"\1", label).replace(r"\times", " × ")
    return re.sub(r"\^\{(.*?)\}", lambda power: power[1].translate(RAISED), inner)


def legend_above(axes: Axes, columns: int = 4) -> None:
    """One line of legend over the axes at the right, clear of the data."""
    axes.legend(
        loc="lower right",
        bbox_to_anchor=(1.0, 1.0),
        ncols=columns,
        fontsize=8.5,
        frameon=False,
        borderaxespad=0.1,
        handlelength=1.6,
        columnspacing=1.4,
    )


def render(entry: ReportFigure) -> RenderedFigure:
    """The figure as a PNG with a palette, a third of the size of full colour at no loss to the eye."""
    from matplotlib.backends.backend_agg import FigureCanvasAgg
    from PIL import Image

    entry.figure.set_dpi(_DOTS_PER_INCH)
    canvas: Any = FigureCanvasAgg(entry.figure)  # its drawing methods ship no types
    canvas.draw()
    picture = Image.frombytes("RGBA", canvas.get_width_height(), bytes(canvas.buffer_rgba())).convert("RGB")
    # An octree keeps rare colours: with a median cut an orange line between many blue points turns brown.
    small = picture.quantize(_COLOURS, method=Image.Quantize.FASTOCTREE, dither=Image.Dither.NONE)
    # The octree's white is 254; the page's is 255.
    small.putpalette([255 if level >= 253 else level for level in small.getpalette() or []])
    file = io.BytesIO()
    small.save(file, format="PNG")
    return RenderedFigure(entry.stem, entry.title, entry.caption, file.getvalue())
