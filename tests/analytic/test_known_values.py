"""What recordings leave of declared values that are alike: two springs in series of which only the sum is measured."""

from __future__ import annotations

import math
from dataclasses import replace

import numpy as np
import pytest

from feeddrive.diagnosis.calibration.declared import CalibratedValue
from feeddrive.diagnosis.calibration.known import Known

SHARE = 0.20
"""Tolerance of either spring."""
DEVIATION = 0.5 * math.log1p(SHARE)
NUT, BEARING = 1.5e9, 0.8e9
SURE_TO = 0.002
"""Standard deviation of the measured compliance, of the declared one's."""


def known(measured: float, at: float = 0.0) -> Known:
    """Two springs whose compliance is `measured` times that declared, the slopes taken at c = `at`."""
    values = tuple(
        CalibratedValue(key, key, "N/m", stiffness, DEVIATION, "stiffness_deviation", key.partition("_")[0])
        for key, stiffness in (("nut_stiffness", NUT), ("bearing_stiffness", BEARING))
    )
    compliance = np.array([1 / NUT, 1 / BEARING])
    there, whole = compliance * math.exp(-DEVIATION * at), compliance.sum()
    # compliance = there * (1 - deviation * (u - at)), over its standard deviation
    row, noise = -there * DEVIATION, SURE_TO * whole
    told = (measured * whole - (there * (1 + DEVIATION * at)).sum()) / noise
    return Known(values, np.full(2, at), np.array([row / noise, [0.0, 0.0]]), np.array([told, 0.0]))


def of(nut: float, bearing: float) -> float:
    """Compliance over that declared."""
    return (1 / (nut * NUT) + 1 / (bearing * BEARING)) / (1 / NUT + 1 / BEARING)


@pytest.mark.parametrize("at", [0.0, -1.0])
def test_within_both_tolerances_nothing_is_beyond(at: float) -> None:
    assert known(of(0.84, 1.0), at).least() == pytest.approx(0.0, abs=1e-6)
    assert known(of(0.84, 0.84), at).least() == pytest.approx(0.0, abs=1e-6)


def test_beyond_both_tolerances_either_may_be() -> None:
    found = known(of(0.5, 1.0))
    most = of(1 / (1 + SHARE), 1 / (1 + SHARE))
    assert found.least() == pytest.approx(((of(0.5, 1.0) - most) / SURE_TO) ** 2, rel=1e-6)
    assert found.least(0) == pytest.approx(0.0, abs=1e-6)
    assert found.least(1) == pytest.approx(0.0, abs=1e-6)


@pytest.mark.parametrize("at", [0.0, -1.0])
@pytest.mark.parametrize(("nut", "bearing"), [(0.5, 1.0), (0.8, 1.0), (1.0, 0.9), (0.84, 0.84)])
def test_an_interval_is_what_the_others_tolerance_leaves(nut: float, bearing: float, at: float) -> None:
    """Ends in closed form: the other spring at an end of its tolerance, the sum 1.96 deviations away."""
    found = known(of(nut, bearing), at)
    for place, declared, other, beside in ((0, NUT, BEARING, bearing), (1, BEARING, NUT, nut)):
        ends = [found.values[place].factor(c) for c in found.interval(place)]
        whole = 1 / NUT + 1 / BEARING
        expected = [
            1 / (declared * ((of(nut, bearing) + way * 1.96 * SURE_TO) * whole - 1 / (1 + way * SHARE) / other))
            for way in (1, -1)
        ]
        # the search for an end stops within a thousandth of a deviation
        np.testing.assert_allclose(ends, expected, rtol=3e-4)
        # the truth is in it while the other keeps its tolerance
        assert ends[0] < (nut, bearing)[place] < ends[1] or beside == 0.5


def test_the_likeliest_machine_leaves_the_others_as_declared() -> None:
    found = known(of(0.5, 1.0))
    u, _ = found.likeliest({0: 10.0})
    assert found.values[0].factor(found.c(0, float(u[0]))) == pytest.approx(0.5, rel=0.03)
    assert abs(u[1]) < 0.2


def test_coordinates_go_there_and_back() -> None:
    found = known(1.0, -1.0)
    for c in (-3.0, -1.0, 0.0, 2.0):
        assert found.c(0, found.u(0, c)) == pytest.approx(c, abs=1e-12)


@pytest.mark.parametrize("seed", [78, 143, 172])
def test_an_interval_is_there_however_poorly_values_are_told(seed: int) -> None:
    """Eight stiffnesses whose slopes are of sizes far apart, ten tolerances off: bounds are met and left many times."""
    random = np.random.default_rng(seed)
    values = tuple(
        CalibratedValue(f"k{i}_stiffness", "k", "N/m", 1e8, DEVIATION, "stiffness_deviation", "") for i in range(8)
    )
    rows, columns = 10.0 ** random.uniform(-2, 3, 8), random.normal(0, 1, (8, 8))
    slopes = rows[:, None] * columns * 10.0 ** random.uniform(-1, 1, 8)
    found = Known(values, np.zeros(8), slopes, slopes @ random.uniform(-20, 20, 8) + random.normal(0, 30, 8))
    for place in range(8):
        low, high = found.interval(place)
        assert np.isfinite([low, high]).all() and low <= high


def test_a_value_beyond_its_tolerance_holds_no_other() -> None:
    """Where one spring is fitted beyond its tolerance, the other's interval does not lean on that tolerance."""
    found = known(of(0.5, 1.0))
    beyond = replace(found, at=np.array([2 * math.log(0.5) / math.log1p(SHARE), 0.0]))
    assert found.interval(1)[0] > beyond.interval(1)[0] + 1.0


@pytest.mark.parametrize("coordinate", [-1.5, 0.0, 2.5])
def test_a_value_is_inside_its_interval(coordinate: float) -> None:
    """However far from what the slopes at hand say: by 1.96 of its deviations, beside all that they say."""
    found = known(of(0.84, 1.0))
    half = 1.96 * math.sqrt(found.covariance[0, 0])
    low, high = found.interval(0)
    ends = found.interval_about(0, coordinate)
    assert ends[0] <= min(low, found.c(0, found.u(0, coordinate) - half)) < coordinate
    assert ends[1] >= max(high, found.c(0, found.u(0, coordinate) + half)) > coordinate
    assert min(abs(ends[0] - low), abs(ends[1] - high)) < 1e-12  # one end is the recordings' own


def test_intervals_hold_the_truth_as_often_as_they_say() -> None:
    """Six values that six numbers tell, true ones anywhere within their tolerances: 95 % and more, and not all."""
    random, inside, asked = np.random.default_rng(3), 0, 0
    deviation = 0.5 * math.log1p(0.05)
    values = tuple(CalibratedValue(f"m{i}", "m", "kg", 1.0, deviation, "", "") for i in range(6))
    for _ in range(60):
        slopes = random.normal(0.0, 1.0, (6, 6)) * 10.0 ** random.uniform(-0.5, 1.0, 6)
        true = random.uniform(-2.0, 2.0, 6)
        found = Known(values, np.zeros(6), slopes, slopes @ true + random.normal(0.0, 1.0, 6))
        likeliest = found.covariance @ (slopes.T @ found.right_side)
        for place in range(6):
            low, high = found.interval_about(place, found.c(place, float(likeliest[place])))
            inside += found.u(place, low) <= true[place] <= found.u(place, high)
            asked += 1
    assert 0.94 < inside / asked < 1.0
