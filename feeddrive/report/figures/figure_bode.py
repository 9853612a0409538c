"""Bode plot of a family of responses: Hz, dB, degrees; resonances, anti-resonances and margins marked."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import numpy as np

from feeddrive.metrology.response import Response as Measured
from feeddrive.report.figures.drawing import AFTER, MEASURED, ReportFigure, dress, new_figure
from feeddrive.servo.mechanics_response import Case, decibel, degrees
from feeddrive.servo.resonances import Kind
from feeddrive.servo.response_family import Curve, Family
from feeddrive.typing import ComplexArray, FloatArray
from feeddrive.units.quantity import format_quantity

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure

_MARKS = {Kind.RESONANCE: ("^", 6.0, "bottom"), Kind.ANTI_RESONANCE: ("v", -6.0, "top")}
_LABELLED = 3
"""Curves up to which resonances carry their frequency."""
_STYLES = ("-", "--", "-.")
"""Of curves that are few, or of motions: one that lies on another lets it be seen."""
_INSIDE = 4
"""Entries of a legend up to which it stands inside a panel."""
_COHERENT = 0.8


def magnitude_unit(unit: str) -> tuple[str, float]:
    """The unit in which a magnitude is shown, and what it adds in dB: lengths in µm."""
    return (f"µ{unit}", 120.0) if unit.startswith("m/") else (unit, 0.0)


def bode_figure(family: Family, measured: Measured | None = None) -> ReportFigure:
    """Magnitude and phase over frequency; with a measurement its coherence below.

    Args:
        family: responses of one pair of signals.
        measured: of the same pair, laid over them.
    """
    figure = new_figure(6.4 if measured else 5.4)
    heights = [3, 2, 1] if measured else [3, 2]
    panels = list(figure.subplots(len(heights), 1, sharex=True, height_ratios=heights))
    if measured is not None:
        _draw_measured(panels, measured, magnitude_unit(family.curves[0].response.unit)[1])
    for curve, colour, style in zip(family.curves, *_looks(family), strict=True):
        _draw(panels[0], panels[1], curve, colour, style, _label(curve.case, family))
        if len(family.curves) <= _LABELLED and curve.margins is None and curve.closed is None:
            _mark(panels[0], curve, colour, len(family.curves) == 1)
    _reference_lines(panels[0], panels[1], family)
    unit, _ = magnitude_unit(family.curves[0].response.unit)
    dress(panels[0], "", "magnitude [dB]" if unit == "1" else f"magnitude [dB, {unit}]", family.title)
    dress(panels[1], "", "phase [°]")
    panels[1].set_ylim(-190, 190)
    panels[1].set_yticks([-180, -90, 0, 90, 180])
    _logarithmic(panels[-1], family)
    panels[-1].set_xlabel("frequency [Hz]", fontsize=9)
    if len(family.curves) > 1 or measured is not None:
        _legend(figure, panels[0], len(family.curves) + (measured is not None))
    figure.align_ylabels(panels)
    return ReportFigure(f"bode_{family.stem}", f"Bode plot: {family.title}", _caption(family, measured), figure)


def _draw(top: Axes, bottom: Axes, curve: Curve, colour: Any, style: str, label: str) -> None:
    response = curve.response
    shown = response.decibel + magnitude_unit(response.unit)[1]
    top.plot(response.frequency, shown, style, color=colour, linewidth=1.4, label=label)
    bottom.plot(*_broken(response.frequency, response.values), style, color=colour, linewidth=1.4)


def _broken(frequency: FloatArray, values: ComplexArray) -> tuple[FloatArray, FloatArray]:
    """Frequency and phase [deg] with a gap where the phase is wrapped."""
    phase = degrees(values)
    jumps = np.flatnonzero(np.abs(np.diff(phase)) > 180) + 1
    return np.insert(frequency, jumps, frequency[jumps]), np.insert(phase, jumps, np.nan)


def _mark(axes: Axes, curve: Curve, colour: Any, labelled: bool) -> None:
    for one in curve.seen:
        marker, shift, side = _MARKS[one.kind]
        height = one.decibel + magnitude_unit(curve.response.unit)[1]
        axes.plot(one.frequency, height, marker=marker, color=colour, markersize=5, linestyle="none")
        if labelled:
            axes.annotate(
                f"{one.frequency:.4g} Hz",
                (one.frequency, height),
                xytext=(0, shift),
                fontsize=8,
                textcoords="offset points",
                ha="center",
                va=side,
            )
    if labelled and curve.seen:
        axes.margins(y=0.14)


def _reference_lines(top: Axes, bottom: Axes, family: Family) -> None:
    """0 dB, -180 deg and the least margins over the cases, where the loop is open; 0 and -3 dB where it is closed."""
    if family.curves[0].closed is not None:
        for level in (0.0, -3.0):
            top.axhline(level, color="#888888", linewidth=0.8, linestyle="--")
    opened = [curve for curve in family.curves if curve.margins is not None]
    if not opened:
        return
    top.axhline(0.0, color="#888888", linewidth=0.8, linestyle="--")
    bottom.axhline(-180.0, color="#888888", linewidth=0.8, linestyle="--")
    _gain_margin(top, min(opened, key=_gain))
    _phase_margin(bottom, min(opened, key=_phase))


def _gain(curve: Curve) -> float:
    return curve.margins.gain if curve.margins else np.inf


def _phase(curve: Curve) -> float:
    return curve.margins.phase if curve.margins else np.inf


def _gain_margin(axes: Axes, curve: Curve) -> None:
    margins = curve.margins
    if margins is None or not np.isfinite(margins.gain_frequency):
        return
    axes.plot([margins.gain_frequency] * 2, [0.0, -margins.gain], color=MEASURED, linewidth=1.6)
    axes.annotate(
        f"{margins.gain:.1f} dB",
        (margins.gain_frequency, 0.0),
        xytext=(4, 3),
        fontsize=8,
        textcoords="offset points",
        ha="left",
        va="bottom",
    )


def _phase_margin(axes: Axes, curve: Curve) -> None:
    margins = curve.margins
    if margins is None or not np.isfinite(margins.phase_frequency):
        return
    phase = float(np.interp(margins.phase_frequency, curve.response.frequency, curve.response.degrees))
    edge = -180.0 if phase <= 0 else 180.0
    end = edge + (margins.phase if phase <= 0 else -margins.phase)
    axes.plot([margins.phase_frequency] * 2, [edge, end], color=MEASURED, linewidth=1.6)
    axes.annotate(
        f"{margins.phase:.0f}° at {margins.phase_frequency:.0f} Hz",
        (margins.phase_frequency, end),
        xytext=(0, 4),
        fontsize=8,
        textcoords="offset points",
        ha="center",
        va="bottom",
        zorder=5,
        bbox={"facecolor": "white", "edgecolor": "none", "pad": 1.0, "alpha": 0.85},
    )


def _draw_measured(panels: list[Axes], measured: Measured, more: float) -> None:
    """What is measured, faint where its coherence says that it means little."""
    good = ~(measured.coherence < _COHERENT)
    options: dict[str, Any] = {"color": MEASURED, "linestyle": "none", "marker": ".", "markersize": 2.6}
    for chosen, alpha, label in ((good, 0.9, "measured"), (~good, 0.15, "")):
        frequency, values = measured.frequency[chosen], measured.response[chosen].astype(np.complex128)
        panels[0].plot(frequency, more + decibel(values), alpha=alpha, label=label or None, **options)
        panels[1].plot(frequency, degrees(values), alpha=alpha, **options)
    panels[2].plot(measured.frequency, measured.coherence, color=MEASURED, linewidth=0.8)
    panels[2].set_ylim(0, 1.05)
    dress(panels[2], "", "coherence")


def _looks(family: Family) -> tuple[list[Any], list[str]]:
    """Colour and style of every curve: with many a colour for a position and payload, a style for a motion."""
    cases = [curve.case for curve in family.curves]
    if len(cases) <= len(_STYLES):
        return _colours(len(cases)), list(_STYLES[: len(cases)])
    places = list(dict.fromkeys((case.position, case.payload) for case in cases))
    motions = list(dict.fromkeys(case.motion for case in cases))
    colours = _colours(len(places))
    return (
        [colours[places.index((case.position, case.payload))] for case in cases],
        [_STYLES[motions.index(case.motion) % len(_STYLES)] for case in cases],
    )


def _colours(count: int) -> list[Any]:
    if count == 1:
        return [AFTER]
    from matplotlib import colormaps

    return list(colormaps["viridis"](np.linspace(0.0, 0.85, count)))


def _label(case: Case, family: Family) -> str:
    """What distinguishes a curve from the others."""
    cases = [curve.case for curve in family.curves]
    parts = []
    if len({one.position for one in cases}) > 1:
        parts.append(f"x = {format_quantity(case.position, 'm')}")
    if len({one.payload for one in cases}) > 1:
        parts.append(f"{case.payload:+g} kg")
    if len({one.motion for one in cases}) > 1:
        parts.append(case.motion)
    return ", ".join(parts) or "linear"


def _legend(figure: Figure, axes: Axes, count: int) -> None:
    """Inside the panel where it is short; below all of them where it would lie over the curves."""
    options: dict[str, Any] = {"fontsize": 8, "frameon": False, "handlelength": 2.4}
    if count <= _INSIDE:
        axes.legend(loc="lower left", **options)
    else:
        figure.legend(*axes.get_legend_handles_labels(), loc="outside lower center", ncols=3, **options)


def _logarithmic(axes: Axes, family: Family) -> None:
    from matplotlib.ticker import FuncFormatter, NullFormatter

    axes.set_xscale("log")
    axes.set_xlim(float(family.curves[0].response.frequency[0]), float(family.curves[0].response.frequency[-1]))
    axes.xaxis.set_major_formatter(FuncFormatter(lambda value, _: f"{value:g}"))
    axes.xaxis.set_minor_formatter(NullFormatter())


def _caption(family: Family, measured: Measured | None) -> str:
    velocities = {curve.case.velocity for curve in family.curves}
    moving = ", ".join(format_quantity(velocity, "m/s") for velocity in sorted(velocities) if velocity)
    about = [f"motion at {moving}"] if moving else []
    about += ["rest, where friction holds"] if 0.0 in velocities else []
    sentences = [
        f"Linear about {' and '.join(about)}{'.' if 0.0 in velocities else '; friction at rest is not in it.'}"
    ]
    if family.curves[0].margins is not None:
        sentences.append("Marked are the least gain margin and the least phase margin of the curves.")
    if measured is not None:
        averages = f", {measured.averages} averages" if measured.averages else ""  # a file of a control does not say
        sentences.append(f"Points are measured{averages}, faint below a coherence of {_COHERENT:g}.")
    return " ".join(sentences)
