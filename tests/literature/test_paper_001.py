"""Paper 001 (life of ball screws): its printed numbers, and what was recomputed from them.

Kim, Cha, Park, Lee, Park, "A study on the life of ball screws". Recomputed numbers come from an independent calculation
that shares no code with the package, at a ball-centre circle of 25.5 mm, 206 GPa and a nut of 40 mm (not printed in the
paper). Tolerance throughout, where nothing else is said: half a unit of the last digit written.
"""

from __future__ import annotations

import math

import numpy as np
import pytest
from scipy.stats import beta

from feeddrive.parts.life.consumed_life import consumed_life
from feeddrive.parts.life.life import rated_revolutions, rating_of_test, survival
from feeddrive.parts.life.life_exponents import BALL_BEARING, BALL_SCREW, diameter_exponent, load_exponent
from feeddrive.parts.life.rating import (
    combined_rating,
    double_nut_share,
    load_integrals,
    material_constant_of_test,
    rating,
    rating_along_screw,
)
from feeddrive.parts.life.stress_cycles import (
    ball_travel_share,
    nut_cycles,
    nut_groove_per_turn,
    screw_cycles,
    screw_groove_per_turn,
    stressed_nut_groove,
    stressed_screw_groove,
    stroke_ratio,
)
from feeddrive.parts.life.subsurface_shear import greatest_shear_on_axis, greatest_shear_under_line
from feeddrive.parts.life.weibull import WeibullLaw, complete_slope_interval, line_fit
from feeddrive.parts.screw.double_nut import OPENING, stiffness_share
from feeddrive.parts.screw.load_distribution import load_distribution, nut_body
from feeddrive.parts.screw.screw_contact import BallTrack, nut_contact, screw_contact
from feeddrive.reproduce.paper_001 import rows
from feeddrive.reproduce.row import Paper, Status

TRACK = BallTrack(3.175e-3, 25.5e-3, 0.55, math.radians(45), 6e-3, 2.5)
PRELOAD, STROKE, LENGTH = 13.5e3, 0.288, 0.015
GRID = np.arange(230e3, 501e3, 30e3)


def printed(text: str) -> object:
    """A number as it is written, to half a unit of its last digit."""
    return pytest.approx(float(text), abs=0.5000001 * 10.0 ** -len(text.partition(".")[2]))


def _at_rank(life: float, rank: float, count: int) -> float:
    """L10 of the line of slope 3.6 through one life at its median rank, in 10^3 rev."""
    return WeibullLaw.through(life, float(beta.ppf(0.5, rank, count + 1 - rank)), 3.6).life() / 1e3


def test_exponents_of_table_2() -> None:
    assert load_exponent(31.4, 3.6) == printed("3.000")
    assert load_exponent(31 / 3, 10 / 9) == printed("3.40")
    assert load_exponent(31 / 3, 10 / 9, depth=7 / 3) == printed("3.000")
    assert diameter_exponent(31.4) == printed("1.8148")
    assert diameter_exponent(31 / 3) == pytest.approx(1.4704, abs=2e-4)  # printed from c cut to 10.33
    assert diameter_exponent(31 / 3, depth=7 / 3) == printed("1.80")
    assert (BALL_SCREW.stress, BALL_SCREW.product, BALL_BEARING.stress) == pytest.approx((31.4, 10.8, 9.0), rel=1e-12)


def test_double_nut() -> None:
    assert double_nut_share() == printed("0.93784")
    assert 2 ** (-1 / BALL_SCREW.slope) == printed("0.8249")
    assert combined_rating((8.0, 10.0)) == printed("7.93654")


def test_ratings_from_the_test() -> None:
    double = rating_of_test(PRELOAD, 300e3)
    assert double / 1e3 == printed("9.037")
    assert double / double_nut_share() / 1e3 == printed("9.636")
    assert PRELOAD / double == printed("1.49")
    force = 1350 * 9.80665
    assert force / 1e3 == printed("13.24")
    assert rating_of_test(force, 300e3) / 1e3 == printed("8.863")
    assert rating_of_test(force, 300e3) / double_nut_share() / 1e3 == printed("9.450")


def test_life_at_constant_load() -> None:
    double = rating_of_test(PRELOAD, 300e3)
    assert rated_revolutions(double, 4.5e3) / 1e6 == printed("8.10")
    assert rated_revolutions(double, 4.5e3) * 6e-6 == printed("48.6")  # km
    assert rated_revolutions(double, 2e3) / 1e6 == printed("92.3")
    assert rated_revolutions(double, 2e3) * 6e-6 == printed("554")


def test_two_equal_nuts_reach_nine_tenths_together() -> None:
    """D_j = 2^(-1/e) in both nuts: L = (C_d/F)^3."""
    single, force = 9636.0, 4.5e3
    revolutions = rated_revolutions(single * double_nut_share(), force)
    angle = np.array([0.0, 2 * math.pi * revolutions])
    used = consumed_life(angle, np.full((2, 2), force), single)
    assert used.total == pytest.approx([2 ** (-1 / 3.6)] * 2, rel=1e-12)


def test_shear_under_an_ellipse() -> None:
    """T = tau / p_max and z/b over b/a, from an integration of point loads; nu = 0.3."""
    ratios = (0.02, 0.05, 0.1, 0.15, 0.2, 0.221, 0.25, 0.3, 0.5, 1.0)
    stresses = ("0.3039", "0.3085", "0.3144", "0.3186", "0.3215", "0.3224", "0.3234", "0.3246", "0.3241", "0.3100")
    depths = ("0.785", "0.782", "0.771", "0.757", "0.740", "0.733", "0.723", "0.704", "0.631", "0.481")
    for ratio, stress, depth in zip(ratios, stresses, depths, strict=True):
        peak = greatest_shear_on_axis(ratio)
        # A unit of the last digit: 0.30851, 0.78154 and 0.74049 lie at the edge of their rounding.
        assert peak.relative_stress == pytest.approx(float(stress), abs=1e-4), ratio
        assert peak.relative_depth == pytest.approx(float(depth), abs=1e-3), ratio


def test_shear_with_traction() -> None:
    for friction, stress, depth in (
        (0.0, "0.3003", "0.786"), (0.034, "0.3008", "0.780"), (0.05, "0.3014", "0.774"),
        (0.1, "0.305", "0.738"), (0.2, "0.319", "0.60"), (0.3, "0.345", "0.38"),
    ):  # fmt: skip
        peak = greatest_shear_under_line(friction)
        assert peak.relative_stress == printed(stress)
        # The greatest stress is flat over the depth: a thousandth of it moves the depth by several hundredths.
        assert peak.relative_depth == pytest.approx(float(depth), abs=2e-3)


@pytest.mark.parametrize(
    ("contact", "expected"),
    [
        (screw_contact(TRACK),
         ("0.84688", "0.74800", "0.1975", "2.5774", "0.50915", "0.74795", "0.4517", "0.0892", "3599", "8.59")),
        (nut_contact(TRACK),
         ("0.81998", "0.63622", "0.2207", "2.4010", "0.52995", "0.77446", "0.4441", "0.0980", "3332", "8.43")),
    ],
    ids=["screw", "nut"],
)  # fmt: skip
def test_hertz_values_of_the_specimen(contact: object, expected: tuple[str, ...]) -> None:
    load = TRACK.mean_ball_load(PRELOAD)
    assert load == printed("303.9")
    a, b = contact.semi_axes(load)  # type: ignore[attr-defined]
    numbers, curvatures = contact.numbers, contact.curvatures  # type: ignore[attr-defined]
    found = (
        curvatures.difference, curvatures.total / 1e3, b / a, numbers.semi_major, numbers.semi_minor, numbers.approach,
        a * 1e3, b * 1e3, contact.maximum_pressure(load) / 1e6, contact.approach(load) * 1e6,  # type: ignore[attr-defined]
    )  # fmt: skip
    for value, text in zip(found, expected, strict=True):
        assert value == printed(text)


@pytest.mark.parametrize(("circle", "screw", "nut"), [(25.0, "3622", "3348"), (26.0, "3578", "3317")])
def test_pressures_at_the_ends_of_the_assumption(circle: float, screw: str, nut: str) -> None:
    track = BallTrack(3.175e-3, circle * 1e-3, 0.55, math.radians(45), 6e-3, 2.5)
    load = TRACK.mean_ball_load(PRELOAD) * TRACK.balls / track.balls * TRACK.axial_part / track.axial_part
    assert screw_contact(track).maximum_pressure(load) / 1e6 == printed(screw)
    assert nut_contact(track).maximum_pressure(load) / 1e6 == printed(nut)


def test_weibull_law_of_the_printed_figures() -> None:
    law = WeibullLaw.through(300e3, 0.1, 3.6)
    assert law.scale / 1e3 == printed("560.5")
    assert law.life(0.5) / 1e3 == printed("506")
    assert 100 * law.failure(230e3) == printed("4.0")
    assert 100 * law.failure(500e3) == printed("48.5")
    assert law.life(1 - 0.5**0.1) / 1e3 == printed("267")
    assert law.life(0.5**0.1) / 1e3 == printed("739")
    assert law.failure(500e3) ** 10 == pytest.approx(7e-4, abs=0.5e-4)
    assert survival(300e3, 300e3) == pytest.approx(0.9)


def test_weibull_lines_through_the_ends() -> None:
    ends, ranks = np.array([230e3, 500e3]), np.array([1.0, 10.0])
    fitted = line_fit(ends, beta.ppf(0.5, ranks, 11 - ranks))
    # The recomputation took Benard's approximate ranks (i - 0.3)/(n + 0.4), 0.2 % away from the exact ones used here.
    assert fitted.slope == pytest.approx(4.71, rel=3e-3)
    assert fitted.life() / 1e3 == printed("251")
    assert _at_rank(230e3, 1, 10) == printed("258")
    assert _at_rank(500e3, 10, 10) == printed("203")
    assert _at_rank(500e3, 5, 10) == printed("308")  # five failed, the rest suspended
    twenty = line_fit(ends, beta.ppf(0.5, ranks, 21 - ranks))
    assert twenty.slope == pytest.approx(3.76, rel=3e-3)
    assert _at_rank(230e3, 1, 20) == pytest.approx(313, rel=3e-3)
    assert _at_rank(500e3, 10, 20) == printed("302")


def test_confidence_of_the_slope() -> None:
    """90 % interval of a slope of 3.6 from ten complete lives; both calculations draw samples, good to about 1 %."""
    interval = complete_slope_interval(3.6, 10)
    assert (interval.low, interval.high) == pytest.approx((1.95, 4.92), rel=0.02)
    # The double-nut factor 2^(-1/(3 e)) changes by ln 2 / (3 e) = 0.12 of the relative change of the slope, 2 %.
    assert 2 ** (-1 / (3 * interval.low)) == pytest.approx(0.888, abs=2.4e-3)
    assert 2 ** (-1 / (3 * interval.high)) == printed("0.954")


def test_geometry_and_cycles_of_the_specimen() -> None:
    assert (TRACK.screw_diameter * 1e3, TRACK.nut_diameter * 1e3) == (printed("23.255"), printed("27.745"))
    angles = [
        math.degrees(TRACK.lead_angle(d)) for d in (TRACK.screw_diameter, TRACK.nut_diameter, TRACK.pitch_diameter)
    ]
    assert angles == [printed("4.695"), printed("3.938"), printed("4.283")]
    assert ball_travel_share(TRACK) == printed("0.45622")
    assert screw_groove_per_turn(TRACK) * 1e3 == pytest.approx(73.304, abs=1.1e-3)  # 73.3035, rounded up
    assert nut_groove_per_turn(TRACK) * 1e3 == printed("87.370")
    assert TRACK.balls == 63
    assert stroke_ratio(TRACK, STROKE) == printed("19.2")
    revolutions = STROKE / TRACK.lead
    screw, nut = screw_cycles(TRACK, STROKE) / revolutions, nut_cycles(TRACK, STROKE) / revolutions
    assert (nut, screw) == (printed("11.50"), printed("0.714"))
    assert nut / screw == printed("16")
    assert (nut * 300e3 / 1e6, screw * 300e3 / 1e5) == (printed("3.45"), printed("2.14"))


def test_cycles_of_other_assumptions() -> None:
    """60 balls in place of 63, and other circles of ball centres: the ratio of balls and K alone."""
    assert nut_cycles(TRACK, STROKE) * 60 / 63 == printed("525.6")
    # Half a unit of 32.63 and the rounding of 34.2578 * 60 / 63.
    assert screw_cycles(TRACK, STROKE) * 60 / 63 == printed("32.63")
    for circle, nut, screw in ((25.0, "542.1", "33.77"), (26.0, "561.6", "34.75")):
        track = BallTrack(3.175e-3, circle * 1e-3, 0.55, math.radians(45), 6e-3, 2.5)
        assert nut_cycles(track, STROKE) == printed(nut)
        assert screw_cycles(track, STROKE) == printed(screw)


@pytest.mark.parametrize(
    ("ratio", "length", "screw", "nut"),
    [
        (0.25, "229.1", "8.56", "7.19"),
        (0.5, "274.9", "17.13", "14.37"),
        (1, "366.5", "34.26", "28.74"),
        (2, "549.8", "34.26", "57.48"),
        (4, "916.3", "34.26", "114.97"),
        (10, "2015.9", "34.26", "287.42"),
        (19.2, "3701.8", "34.26", "551.85"),
    ],
)
def test_cycles_against_stroke(ratio: float, length: str, screw: str, nut: str) -> None:
    stroke = ratio * LENGTH
    # 2015.846 was rounded to 2015.9: a unit of the last digit.
    assert stressed_screw_groove(TRACK, stroke) * 1e3 == pytest.approx(float(length), abs=0.06)
    assert stressed_nut_groove(TRACK) * 1e3 == printed("218.4")
    assert screw_cycles(TRACK, stroke) == printed(screw)
    assert nut_cycles(TRACK, stroke) == printed(nut)


def test_load_distribution_of_the_specimen() -> None:
    body = nut_body(TRACK, 0.04)
    loads = load_distribution(body, PRELOAD).relative
    assert (loads.max(), loads.min()) == (printed("1.0807"), printed("0.9596"))
    for value, text in zip(loads[::9], ("1.081", "1.047", "1.020", "0.998", "0.981", "0.969", "0.962"), strict=True):
        assert value == printed(text)
    for diameter, text in ((0.036, "1.098"), (0.05, "1.065")):
        assert load_distribution(nut_body(TRACK, diameter), PRELOAD).relative.max() == printed(text)


@pytest.mark.parametrize(("turns", "text"), [(5.0, "1.32"), (7.5, "1.70"), (12.5, "2.76")])
def test_load_distribution_of_longer_nuts(turns: float, text: str) -> None:
    track = BallTrack(3.175e-3, 25.5e-3, 0.55, math.radians(45), 6e-3, turns)
    loads = load_distribution(nut_body(track, 0.04), PRELOAD * turns / 2.5).relative
    assert loads.max() == printed(text)


def test_load_integrals() -> None:
    found = load_integrals(TRACK, load_distribution(nut_body(TRACK, 0.04), PRELOAD))
    assert found == (printed("0.6525"), printed("0.9265"), printed("0.9317"))


@pytest.mark.parametrize(
    ("ratio", "screw", "by_points", "pair", "share"),
    [
        (0.25, "7.33", "7.59", "7.30", "0.05"), (0.5, "7.21", "7.72", "7.18", "0.04"),
        (1.0, "7.02", "8.09", "7.00", "0.03"), (1.5, "7.87", "8.62", "7.80", "0.10"),
        (2.0, "8.52", "9.12", "8.34", "0.21"), (3.0, "9.50", "9.94", "8.97", "0.46"),
        (4.0, "10.24", "10.60", "9.27", "0.66"), (6.0, "11.36", "11.63", "9.50", "0.86"),
        (10.0, "12.92", "13.10", "9.61", "0.96"), (19.2, "15.18", "15.29", "9.64", "0.99"),
    ],
)  # fmt: skip
def test_rating_against_stroke(ratio: float, screw: str, by_points: str, pair: str, share: str) -> None:
    loads = load_distribution(nut_body(TRACK, 0.04), PRELOAD)
    tested = rating_of_test(PRELOAD, 300e3) / double_nut_share()
    constant = material_constant_of_test(TRACK, loads, STROKE, tested)
    assert constant == printed("206.8")
    found = rating(TRACK, loads, ratio * LENGTH, constant)
    assert found.screw / 1e3 == printed(screw)
    assert found.nut / 1e3 == printed("9.64")
    assert found.pair / 1e3 == printed(pair)
    # 0.8545 and 0.2080 lie at the edge of their rounding: a unit of the last digit.
    assert found.nut_share == pytest.approx(float(share), abs=0.0101)
    along = rating_along_screw(TRACK, loads, ratio * LENGTH, constant)
    assert along.screw / 1e3 == printed(by_points)


def test_preload_loss() -> None:
    """6 kN to 5 kN: stiffness x 0.941; opens at 2.828 F_0."""
    assert stiffness_share(5 / 6) == printed("0.941")
    assert printed("2.828") == OPENING


def test_rows_say_what_became_of_every_number() -> None:
    found = rows()
    assert len(found) >= 40
    assert {row.paper for row in found} == {Paper.LIFE}
    assert len({(row.place, row.quantity) for row in found}) == len(found)
    by_status = {status: sum(row.status is status for row in found) for status in Status}
    assert all(count >= 5 for status, count in by_status.items() if status is not Status.FITTED)


@pytest.mark.parametrize(
    ("quantity", "status"),
    [
        ("load-life exponent p of the screw", Status.REPRODUCED),
        ("exponent of the ball diameter of the screw", Status.REPRODUCED),
        ("rating of the double nut over that of the single one", Status.REPRODUCED),
        ("depth of the greatest shear over b, b/a of 0.1 to 0.3", Status.REPRODUCED),
        ("load-life exponent p of ball bearings", Status.CONTRADICTED),
        ("L10 of 300 000, slope 3.6 and all ten failed by 500 000 rev", Status.CONTRADICTED),
        ("f_s at which the nut takes over from the screw", Status.CONTRADICTED),
        ("Weibull slope", Status.NOT_POSSIBLE),
        ("life law from eqs. (1), (2)", Status.PAPER_ONLY),
        ("power of T_1 in the material constant", Status.PAPER_ONLY),
        ("exponent of the load, named b", Status.ASSUMPTION),
        ("two nuts loaded with C_d both survive 10^6 revolutions", Status.REPRODUCED),
        ("temperature of the nuts under forced air", Status.NOT_POSSIBLE),
    ],
)
def test_status_of_known_rows(quantity: str, status: Status) -> None:
    assert [row.status for row in rows() if row.quantity == quantity] == [status]


@pytest.mark.parametrize(
    ("quantity", "texts"),
    [
        ("F(b/a) is the difference of curvatures, screw and nut", ("0.84688", "0.81998")),
        ("power of T_1 in the material constant", ("-2.907",)),
    ],
)
def test_equations_give_what_was_found_by_hand(quantity: str, texts: tuple[str, ...]) -> None:
    (row,) = [row for row in rows() if row.quantity == quantity]
    assert all(text in row.computed for text in texts)


def test_angle_without_a_formula_cannot_be_compared() -> None:
    (row,) = [row for row in rows() if row.quantity.startswith("angle between the screw's groove")]
    assert row.status is Status.NOT_POSSIBLE
    assert "0.4562" in row.reason and "0.4506" in row.reason
