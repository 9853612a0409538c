"""Figure of the spectra of a residual: over frequency, and over orders per revolution."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from feeddrive.diagnosis.judging.result import ChannelResult, Diagnosis
from feeddrive.report.figures.drawing import NOISE, ReportFigure, dress, legend_above, new_figure
from feeddrive.report.figures.spectra import Spectrum, density_spectrum, order_spectrum
from feeddrive.report.selection import residuals, series_of, stem_of, with_variable
from feeddrive.report.words.people import axis_label, scale_for_error, significant, with_unit
from feeddrive.report.words.words import plain
from feeddrive.typing import FloatArray

if TYPE_CHECKING:
    from matplotlib.axes import Axes

_ORDER_TICKS = (0.5, 1, 2, 5, 10, 20, 40)
_SLOWEST_BAND = 0.1
"""Upper edge [Hz] of a band below which no spectrum is drawn."""

Curve = tuple[str, str, Spectrum]
"""Label, colour and spectrum in shown units."""


def spectrum_figure(diagnosis: Diagnosis, channel: ChannelResult) -> ReportFigure | None:
    """Amplitude spectral density and, where the motor angle is known, amplitude per order; None without enough data."""
    if channel.band_hz[1] < _SLOWEST_BAND:
        return None  # minutes and hours: what is left shows over time, not over frequency
    density = _density_curves(diagnosis, channel)
    orders = _order_curves(diagnosis, channel)
    if not density:
        return None
    figure = new_figure(5.8 if orders else 3.2)
    panels = figure.subplots(2 if orders else 1, 1, squeeze=False)[:, 0]
    _density_panel(panels[0], channel, density)
    if orders:
        _order_panel(panels[1], channel, orders)
    title = f"Spectrum of the residual of {plain(channel.name)}"
    caption = _caption(channel, orders)
    return ReportFigure(f"spectrum_{stem_of(channel.name)}", title, caption, figure)


def _scaled(spectrum: Spectrum, factor: float) -> Spectrum:
    """A spectrum in shown units."""
    return Spectrum(spectrum.abscissa, spectrum.amplitude * factor)


def _density_curves(diagnosis: Diagnosis, channel: ChannelResult) -> list[Curve]:
    """Density of each prediction's residual over all judged recordings."""
    found = [(one, series) for one in diagnosis.recordings if (series := series_of(one, channel.name)) is not None]
    factor = scale_for_error(channel.unit).factor
    curves: list[Curve] = []
    for index in range(1 if diagnosis.nothing_missing else 2):
        drawn = [(recording, residuals(diagnosis, series)[index]) for recording, series in found]
        spectrum = density_spectrum([(recording, values) for recording, (_, _, values) in drawn])
        if spectrum is not None:
            curves.append((*drawn[0][1][:2], _scaled(spectrum, factor)))
    return curves


def _order_curves(diagnosis: Diagnosis, channel: ChannelResult) -> list[Curve]:
    """Amplitude per order of each prediction's residual."""
    found = with_variable(diagnosis, channel.name, "motor_angle")
    factor = scale_for_error(channel.unit).factor
    curves: list[Curve] = []
    for index in range(1 if diagnosis.nothing_missing else 2):
        pairs: list[tuple[FloatArray, FloatArray]] = []
        labels = [("", "")]
        for _, series, angle in found:
            label, colour, values = residuals(diagnosis, series)[index]
            pairs.append((angle, values))
            labels.append((label, colour))
        spectrum = order_spectrum(pairs)
        if spectrum is not None:
            curves.append((*labels[-1], _scaled(spectrum, factor)))
    return curves


def _density_panel(axes: Axes, channel: ChannelResult, curves: list[Curve]) -> None:
    """Density over frequency up to a little above the band, and the level of white noise of the declared size."""
    unit = scale_for_error(channel.unit)
    low, high = channel.band_hz
    for label, colour, spectrum in curves:
        inside = spectrum.abscissa <= (1.5 * high if high > 0.0 else np.inf)
        axes.loglog(spectrum.abscissa[inside], spectrum.amplitude[inside], color=colour, lw=1.1, label=label)
    if channel.noise_rms > 0.0 and np.isfinite(high) and high > low:
        level = channel.noise_rms * unit.factor / np.sqrt(high - low)
        axes.axhline(level, color=NOISE, lw=1.1, ls="--", label="sensor noise")
        _keep_above(axes, 0.1 * level)
    if np.isfinite(high) and high > 0.0:
        axes.axvline(high, color=NOISE, lw=0.9, ls=":", label="edge of the band")
    dress(axes, "frequency [Hz]", f"density [{unit.unit or '1'}/√Hz]")
    legend_above(axes)


def _keep_above(axes: Axes, floor: float) -> None:
    """Do not let the filter's roll-off stretch the scale far under the noise."""
    bottom, top = axes.get_ylim()
    if bottom < floor < top:
        axes.set_ylim(bottom=floor)


def _order_panel(axes: Axes, channel: ChannelResult, curves: list[Curve]) -> None:
    """Amplitude over orders, the strongest one named."""
    unit = scale_for_error(channel.unit).unit
    for label, colour, spectrum in curves:
        axes.loglog(spectrum.abscissa, spectrum.amplitude, color=colour, lw=1.1, label=label)
    peak = _peak(curves[0][2])
    if peak is not None:
        axes.annotate(f"order {significant(peak[0])}", peak, xytext=(6, 2), textcoords="offset points", fontsize=8.5)
    ticks = [tick for tick in _ORDER_TICKS if tick >= curves[0][2].abscissa[0]]
    axes.set_xticks(ticks, [f"{tick:g}" for tick in ticks])
    axes.set_xticks([], minor=True)
    top = max(float(np.max(spectrum.amplitude)) for _, _, spectrum in curves)
    if top > 0.0:
        _keep_above(axes, 1e-4 * top)
    dress(axes, "order [1/rev]", axis_label("amplitude", unit))
    legend_above(axes)


def _peak(spectrum: Spectrum) -> tuple[float, float] | None:
    """Order and amplitude of a line that stands clear of its surroundings, from order 0.7 on."""
    kept = spectrum.abscissa >= 0.7
    orders, amplitude = spectrum.abscissa[kept], spectrum.amplitude[kept]
    best = int(np.argmax(amplitude))
    near = (orders > orders[best] / 1.6) & (orders < orders[best] * 1.6)
    inside = 0 < best < orders.size - 1
    if not inside or amplitude[best] < 5.0 * float(np.median(amplitude[near])):
        return None
    return float(orders[best]), float(amplitude[best])


def _caption(channel: ChannelResult, orders: list[Curve]) -> str:
    """What to look at, with the strongest order before and after."""
    first = "A resonance or a periodic force stands out as a peak; a residual on the dashed line is sensor noise."
    if not orders:
        return first
    second = "Lower panel: the part of the residual that repeats with the motor angle, in orders per revolution."
    peak = _peak(orders[0][2])
    if peak is None:
        return f"{first} {second} No order stands out."
    unit = scale_for_error(channel.unit).unit
    sizes = [with_unit(significant(_height(curve[2], peak[0])), unit) for curve in orders]
    return f"{first} {second} Order {significant(peak[0])} stands out: amplitude {' → '.join(sizes)}."


def _height(spectrum: Spectrum, order: float) -> float:
    """Amplitude at an order."""
    return float(np.interp(order, spectrum.abscissa, spectrum.amplitude))
