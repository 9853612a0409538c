"""Numbers and spectra behind the report: digits and units for people, bins, envelopes, spectra."""

from __future__ import annotations

import math

import numpy as np
import pytest

from feeddrive.diagnosis.judging.result import EffectResult, JudgedRecording, ParameterResult
from feeddrive.report.figures.figure_spectrum import density_spectrum, order_spectrum
from feeddrive.report.figures.thinning import balanced, binned, envelope, left_out_stretches
from feeddrive.report.words.number_text import (
    fixed,
    scale_for_difference,
    scale_for_error,
    scale_for_value,
    share_text,
    significant,
)
from feeddrive.report.words.parameters import effect_sentence, parameter_text


def plain(text: str) -> str:
    """Text with common spaces, so that a test reads like the page."""
    return text.replace("\N{NO-BREAK SPACE}", " ")


@pytest.mark.parametrize(
    ("key", "value", "unit", "ci95", "shown"),
    [
        ("width", 7.52e-6, "m", (7.40e-6, 7.68e-6), "7.52 µm [7.40, 7.68]"),
        ("frequency", 71.34, "Hz", (70.9, 71.9), "71.3 Hz [70.9, 71.9]"),
        ("mass", 12.0, "kg", None, "12.0 kg"),
        ("stiffness", 5.0e7, "N/m", (4.0e7, 6.0e7), "50 N/µm [40, 60]"),
        ("share", 0.31, "1", (0.28, 0.34), "31 % [28, 34]"),
        ("ratio", 0.4, "1", (0.35, 0.45), "0.40 [0.35, 0.45]"),
        ("phase", math.pi / 2.0, "rad", None, "90.0°"),
        ("time_constant", 1200.0, "s", (1080.0, 1320.0), "20.0 min [18.0, 22.0]"),
        ("inertia", 1.2e-4, "kg m^2", None, "1.20 kg cm²"),
        ("growth", 0.0, "m", (-2e-6, 2e-6), "0.0 µm [−2.0, 2.0]"),
        ("strain", 2.4e-5, "m/m", None, "24.0 µm/m"),
        ("where", "motor_end", "1", None, "motor end"),
        ("position", [0.0, 0.1, 0.2], "m", None, "0, 100, 200 mm"),
        ("position", [0.01 * i for i in range(20)], "m", None, "20 points, 0 to 190 mm"),
        ("empty", [], "m", None, "mm"),
    ],
)
def test_parameters_are_shown_as_people_know_them(
    key: str, value: float | list[float] | str, unit: str, ci95: tuple[float, float] | None, shown: str
) -> None:
    assert plain(parameter_text(key, ParameterResult(value, unit, ci95)).sentence).strip() == shown


def test_effect_without_parameters_is_still_named() -> None:
    assert effect_sentence(EffectResult("unknown_thing", {}, {}, True, "")) == "unknown thing"


@pytest.mark.parametrize(
    ("number", "text"),
    [(0.99996, "1.00"), (1234.6, "1230"), (0.0, "0"), (-0.0123, "−0.0123"), (1e-9, "1.00·10⁻⁹"), (math.inf, "–")],
)
def test_three_significant_digits(number: float, text: str) -> None:
    assert significant(number) == text


def test_shares_and_errors() -> None:
    assert [plain(share_text(one)) for one in (1.0, 0.1234, 0.00042)] == ["100 %", "12.3 %", "0.042 %"]
    assert fixed(-0.0001, 2) == "0.00"
    assert scale_for_error("m").unit == "µm"


def test_envelope_keeps_peaks_and_gaps() -> None:
    times = np.arange(60_000.0)
    values = np.zeros(60_000)
    values[12_345], values[30_000:40_000] = 5.0, np.nan
    thinned_time, thinned = envelope(times, values)
    assert thinned.size <= 1400
    assert np.nanmax(thinned) == 5.0
    assert np.all(np.isnan(thinned[(thinned_time > 30_100) & (thinned_time < 39_900)]))
    assert left_out_stretches(times, values, 1.0) == [(30_000.0, 39_999.0)]
    assert left_out_stretches(times, values, 20_000.0) == []


def test_bins_explain_a_curve_and_not_noise() -> None:
    noise = np.random.default_rng(3)
    variable = noise.uniform(0.0, 1.0, 20_000)
    edges = np.linspace(0.0, 1.0, 41)
    assert binned(variable, np.sin(6.0 * variable), edges).share > 0.99  # within a bin of 1/40 the curve is flat
    # The medians of 40 bins of 500 samples take away about 40/20 000 * pi/2 of white noise.
    assert binned(variable, noise.normal(size=20_000), edges).share < 0.01


def test_direction_balanced_line_is_flat_for_backlash() -> None:
    """Free play is ± half its width by direction; against position it says nothing, however long each way took."""
    noise = np.random.default_rng(4)
    variable = noise.uniform(0.0, 1.0, 20_000)
    forward = noise.uniform(size=20_000) < 0.3 + 0.4 * variable
    bins = balanced(variable, np.where(forward, 1.0, -1.0), forward, np.linspace(0.0, 1.0, 41))
    assert np.nanmax(np.abs(bins.median)) == 0.0


def test_density_of_white_noise_is_rms_over_root_of_the_band() -> None:
    step, rms = 1e-3, 0.012
    values = np.random.default_rng(1).normal(0.0, rms, 60_000)
    values[20_000:20_500] = np.nan
    record = JudgedRecording("noise.csv", np.arange(60_000) * step, ())
    spectrum = density_spectrum([(record, values)])
    assert spectrum is not None
    inner = (spectrum.abscissa > 5.0) & (spectrum.abscissa < 495.0)
    # About 2000 bins of 27 averages each: the mean square is known to better than 1 %; 3 % allows for the ends.
    assert np.sqrt(np.mean(spectrum.amplitude[inner] ** 2)) == pytest.approx(rms / math.sqrt(500.0), rel=0.03)


def test_order_spectrum_finds_order_and_amplitude_under_reversals() -> None:
    moment = np.arange(60_000) * 1e-3
    angle = 60.0 * np.sin(2.0 * np.pi * moment / 9.7)
    ripple = 0.12 * np.sin(7.0 * angle + 0.4) + 0.3 * np.sign(np.cos(2.0 * np.pi * moment / 9.7))
    spectrum = order_spectrum([(angle, ripple)])
    assert spectrum is not None
    clear = spectrum.abscissa > 5.0
    best = int(np.argmax(np.where(clear, spectrum.amplitude, 0.0)))
    # 19 revolutions under a Hann window resolve 2/19 of an order; the peak lies much nearer.
    assert spectrum.abscissa[best] == pytest.approx(7.0, abs=0.05)
    # Averaging over bins of 1/160 revolution takes sinc(7/160), 0.3 %; 3 % allows for the turning points.
    assert spectrum.amplitude[best] == pytest.approx(0.12, rel=0.03)
    assert order_spectrum([(0.1 * angle, ripple)]) is None  # fewer than three revolutions


def test_a_difference_of_temperatures_is_in_kelvin() -> None:
    assert scale_for_difference(0.3, "degC").unit == "K" and scale_for_difference(0.3, "degC").factor == 1.0
    assert scale_for_difference(2e-4, "N m") == scale_for_value(2e-4, "N m")
