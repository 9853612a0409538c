"""All figures of a diagnosis, in the order of the report."""

from __future__ import annotations

from collections.abc import Iterator
from pathlib import Path

from feeddrive.diagnosis.judging.result import Diagnosis
from feeddrive.files import write_bytes_atomically
from feeddrive.report.figures.drawing import RenderedFigure, ReportFigure, render
from feeddrive.report.figures.figure_dependence import dependence_figure
from feeddrive.report.figures.figure_effects import curve_figures, explains_figure, trials_figure
from feeddrive.report.figures.figure_series import series_figure
from feeddrive.report.figures.figure_spectrum import spectrum_figure
from feeddrive.report.figures.figure_unexplained import unexplained_figures
from feeddrive.report.selection import detailed_channels, drawn_series


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
    """Write every figure as a PNG of its own into `folder`, which is made if need be.

    Args:
        diagnosis: what was found.
        folder: where to.
        rendered: figures drawn before; drawn here if left away.

    Returns:
        The files, in the order of the report.

    Raises:
        InputError: the folder cannot be written.
    """
    figures = render_figures(diagnosis) if rendered is None else rendered
    paths = [folder / f"{figure.stem}.png" for figure in figures]
    for path, figure in zip(paths, figures, strict=True):
        write_bytes_atomically(path, figure.png)
    return paths
