"""Filters and rates of the servo: frequency response, prewarping, refusals, against scipy and closed forms."""

from __future__ import annotations

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from scipy import signal

from feeddrive.errors import InputError
from feeddrive.servo.cascade import divider
from feeddrive.servo.filters import Filter, biquad, notch, pt1, pt2

TICK = 125e-6
FILTERS = (pt1(500.0), pt2(800.0, 0.7), notch(400.0, 100.0, 40.0), biquad(300.0, 0.1, 450.0, 0.7))


def discrete_response(item: Filter, frequency: float) -> complex:
    c = item.discrete(TICK)
    _, response = signal.freqz([c[0], c[1], c[2]], [1.0, c[3], c[4]], [frequency], fs=1 / TICK)
    return complex(response[0])


@pytest.mark.parametrize("item", FILTERS, ids=lambda item: item.kind)
def test_discrete_filter_is_exact_at_its_frequency_and_at_rest(item: Filter) -> None:
    # rounding of the coefficients: 1e-12 of the gain, more where a notch leaves little
    assert discrete_response(item, item.frequency) == pytest.approx(
        complex(item.response([item.frequency])[0]), abs=1e-11
    )
    assert discrete_response(item, 0.0) == pytest.approx(1.0, abs=1e-11)


def test_pt2_has_the_textbook_response() -> None:
    # at the natural frequency the gain of a PT2 is 1 / (2 D), its phase -90 degrees
    assert complex(pt2(800.0, 0.7).response(np.array([800.0]))[0]) == pytest.approx(-1j / 1.4, abs=1e-12)
    assert abs(pt1(500.0).response(np.array([500.0]))[0]) == pytest.approx(2**-0.5, rel=1e-12)


def test_notch_has_its_depth_and_bandwidth() -> None:
    item = notch(400.0, 100.0, 80.0)
    assert abs(item.response(np.array([400.0]))[0]) == pytest.approx(1e-4, rel=1e-9)
    low = 0.5 * (np.sqrt(100.0**2 + 4 * 400.0**2) - 100.0)  # edges of the band lie geometrically about the notch
    for edge in (low, low + 100.0):
        assert abs(item.response(np.array([edge]))[0]) == pytest.approx(2**-0.5, rel=1e-3)  # -80 dB are left


@given(frequency=st.floats(10.0, 3500.0), damping=st.floats(0.1, 2.0))
def test_every_discrete_filter_is_stable(frequency: float, damping: float) -> None:
    c = pt2(frequency, damping).discrete(TICK)
    assert np.all(np.abs(np.roots([1.0, c[3], c[4]])) < 1.0)


def test_filters_that_do_not_fit_are_refused() -> None:
    with pytest.raises(InputError, match="does not fit a sample rate of 8000 Hz; choose a frequency below 3600 Hz"):
        pt1(3900.0).discrete(TICK)
    with pytest.raises(InputError, match="bandwidth 0 is not above zero"):
        notch(400.0, 0.0, 40.0)


def test_rates_that_are_no_integer_multiples_are_refused() -> None:
    assert divider(8000.0, 2000.0, "controller") == 4
    with pytest.raises(InputError, match=r"8000 Hz is no integer multiple of 3000 Hz; write 2666\.66666667 Hz"):
        divider(8000.0, 3000.0, "controller")
    assert divider(8000.0, 2666.66666667, "controller") == 3  # what the message says to write
    with pytest.raises(InputError, match="2000 Hz is no integer multiple of 8000 Hz"):
        divider(2000.0, 8000.0, "controller")
