"""Paper 003: its numbers, and those recomputed independently from its corrected equations, to the digits written here.

Margins are those of `printed` unless a comment says otherwise.
"""

from __future__ import annotations

import math
from dataclasses import replace

import numpy as np
import pytest

from feeddrive.parts.guide.guide_carriage import carriage_friction
from feeddrive.parts.guide.guide_coefficients import SET_A, SET_B
from feeddrive.parts.guide.guide_equilibrium import (
    guide_equilibrium,
    preload_force,
    unloading_force,
)
from feeddrive.parts.guide.guide_film import Oil, film_thickness
from feeddrive.parts.guide.guide_geometry import HSR_20R, HSR_30R, BallGuide
from feeddrive.reproduce.paper_003 import ACCURACY, rows
from feeddrive.reproduce.paper_003_equations import accuracy, printed_balance
from feeddrive.reproduce.paper_003_loads import OneContact, preload_rate
from feeddrive.reproduce.paper_003_shares import (
    crossover,
    dominance_load,
    largest_slip,
    share_at,
    shares,
    unloaded_region,
)
from feeddrive.reproduce.row import Paper, Status, last_digit

GUIDES = {"20R": HSR_20R, "30R": HSR_30R}
SETS = {"A": SET_A, "B": SET_B}
M_PER_MIN = 1.0 / 60.0


def printed(text: str):
    """A printed number: half a unit of its last digit and of the next, for some were rounded twice (46.849 to 46.9)."""
    return pytest.approx(float(text), abs=0.55 * last_digit(text))


CONTACT = """
20R  0.52329  1.4317e-4  2.8633e-4  0.15876
30R  0.37382  1.2798e-4  2.5596e-4  0.22224
"""


@pytest.mark.parametrize("line", CONTACT.strip().splitlines())
def test_geometry_and_hertz_constant(line: str) -> None:
    name, total, one, both, distance = line.split()
    guide = GUIDES[name]
    assert 1e-3 * guide.contacts[0].curvatures.total == printed(total)  # 1/mm
    assert 1e3 * guide.contacts[0].constant == printed(one)  # mm/N^(2/3)
    assert 1e3 * guide.hertz_constant == printed(both)
    assert 1e3 * guide.centre_distance == printed(distance)


def test_hertz_numbers() -> None:
    contact = HSR_20R.contacts[0]
    assert contact.curvatures.difference == printed("0.92593")
    assert contact.numbers.approach == printed("0.6341")
    assert contact.numbers.semi_major == printed("3.5061")
    assert contact.numbers.semi_minor == printed("0.4309")
    assert contact.numbers.ellipticity == printed("8.1363")
    assert 1e-6 * 2.0 / contact.compliance == printed("226154")  # E' in N/mm2


UNLOADED = """
20R  42.7  725   2131  2.94  5.01  446
30R  86.3  1465  4309  2.94  7.15  631
"""


@pytest.mark.parametrize("line", UNLOADED.strip().splitlines())
def test_preload_and_its_loss(line: str) -> None:
    name, ball, preload, force, ratio, displacement, stiffness = line.split()
    guide = GUIDES[name]
    assert guide_equilibrium(guide, 0.0).ball_load == printed(ball)
    assert preload_force(guide) == printed(preload)
    assert unloading_force(guide) == printed(force)
    assert unloading_force(guide) / preload_force(guide) == printed(ratio)
    assert 1e6 * guide_equilibrium(guide, unloading_force(guide)).displacement[0] == printed(displacement)
    K = guide_equilibrium(guide, 0.0).stiffness
    assert 1e-6 * (K[0, 0] - K[0, 1] ** 2 / K[1, 1]) == printed(stiffness)  # N/µm


BALL_LOADS = """
20R 0   42.7   42.7  45.0  45.0
20R 1   75.3   17.3  45.6  44.4
20R 3   171.4  0     46.8  -
20R 6   334.4  0     48.4  -
20R 12  647.5  0     50.6  -
20R 24  1245.2 0     53.4  -
30R 0   86.3   86.3  45.0  45.0
30R 1   117.1  59.0  45.3  44.7
30R 3   189.5  15.8  45.9  44.1
30R 6   342.7  0     46.9  -
30R 12  668.4  0     48.4  -
30R 24  1293.9 0     50.6  -
"""


@pytest.mark.parametrize("line", BALL_LOADS.strip().splitlines())
def test_ball_loads(line: str) -> None:
    name, load, ball_a, ball_b, angle_a, angle_b = line.split()
    found = guide_equilibrium(GUIDES[name], 1e3 * float(load))
    assert found.ball_load[2] == found.ball_load[3] == printed(ball_a)
    assert found.ball_load[0] == found.ball_load[1] == (printed(ball_b) if ball_b != "0" else 0.0)
    assert math.degrees(found.contact_angle[2]) == printed(angle_a)
    if angle_b != "-":
        assert math.degrees(found.contact_angle[0]) == printed(angle_b)


@pytest.mark.parametrize(
    ("name", "load", "pressure"), [("20R", 0, "1.28"), ("20R", 24, "3.94"), ("30R", 0, "1.29"), ("30R", 24, "3.19")]
)
def test_largest_pressure(name: str, load: float, pressure: str) -> None:
    ball = float(guide_equilibrium(GUIDES[name], 1e3 * load).ball_load[2])
    assert 1e-9 * GUIDES[name].contacts[0].maximum_pressure(ball) == printed(pressure)


@pytest.mark.parametrize(("speed", "film"), [(0.06, "2.2"), (100.0, "324")])
def test_film_without_load(speed: float, film: str) -> None:
    ball = guide_equilibrium(HSR_20R, 0.0).ball_load[:1]
    h = film_thickness(HSR_20R.contacts[0], HSR_20R.ball_diameter, Oil(0.15, 2e-8), np.array(speed * M_PER_MIN), ball)
    assert 1e9 * h == printed(film)


@pytest.mark.parametrize(
    ("size", "rate", "at_12"), [(0, "58.0", "658"), (4, "31.5", "666"), (5, "30.7", "668"), (7, "29.9", "673")]
)
def test_preload_slows_the_rise_and_is_forgotten(size: float, rate: str, at_12: str) -> None:
    assert 1e3 * preload_rate(1e-6 * size) == printed(rate)  # N/kN
    guide = replace(HSR_30R, preload_oversize=1e-6 * size)
    assert guide_equilibrium(guide, 12e3).ball_load[2] == printed(at_12)


def test_printed_balance_moves_sideways() -> None:
    dx, dy = printed_balance(1e3)
    assert 1e6 * dx == printed("26")
    assert 1e6 * dy == printed("-24")


SHARES = """
0.06 0   A  63/33/4   66/30/4
0.06 0   B  61/34/6   63/31/6
100  0   A  15/85/1   16/83/1
100  0   B  14/85/1   15/84/1
0.06 24  A  55/12/33  62/14/24
0.06 24  B  47/11/43  55/13/32
100  24  A  25/60/15  26/65/10
100  24  B  22/58/20  23/63/13
2    0   A  37/61     40/58
2    0   B  35/62     38/59
2    6   A  46/43     46/47
2    6   B  42/43     43/47
"""


@pytest.mark.parametrize("line", SHARES.strip().splitlines())
def test_shares(line: str) -> None:
    speed, load, name, *both = line.split()
    for guide, text in zip(GUIDES.values(), both, strict=True):
        found = shares(guide, SETS[name], float(speed) * M_PER_MIN, 1e3 * float(load))
        for share, number in zip(found, text.split("/"), strict=False):
            # Set B was rounded to three digits after its shares were written down: 0.1 points.
            assert share == pytest.approx(float(number), abs=0.6), number


CARRIAGE = """
20R 0   .91  1.69 2.31 3.99
20R 6   3.49 5.26 6.65 10.5
20R 24  15.3 19.9 23.6 33.7
30R 0   1.78 3.18 4.28 7.30
30R 6   3.43 5.35 6.87 11.0
30R 24  14.1 19.2 23.3 34.4
"""


@pytest.mark.parametrize("line", CARRIAGE.strip().splitlines())
def test_friction_of_a_carriage(line: str) -> None:
    name, load, *numbers = line.split()
    found = carriage_friction(GUIDES[name], SET_A, np.array([0.06, 3.0, 12.0, 100.0]) * M_PER_MIN, 1e3 * float(load))
    for force, number in zip(found.total, numbers, strict=True):
        # The coefficients stand with three digits: 0.3 % of the force.
        assert force == pytest.approx(float(number), abs=0.5 * last_digit(number) + 3e-3 * float(number))


def test_friction_over_load_is_that_of_a_catalogue() -> None:
    """.001 to .002 of slide units without seals at 6 kN. The .0018 noted for 12 m/min is that of 100 m/min."""
    for guide in GUIDES.values():
        slow, fast = carriage_friction(guide, SET_A, np.array([12.0, 100.0]) * M_PER_MIN, 6e3).total / 6e3
        assert 0.001 < slow < fast < 0.002
        assert slow == printed("0.0011")
        assert fast == pytest.approx(0.0018, abs=1e-4)  # .00175 and .00184


CROSSOVERS = """
20R .45 .54 1.37 2.36 4.03 6.84
30R .64 .67 .98 1.95 3.36 5.73
"""


@pytest.mark.parametrize("line", CROSSOVERS.strip().splitlines())
def test_speed_at_which_rolling_and_viscous_are_equal(line: str) -> None:
    name, *numbers = line.split()
    for load, number in zip((0.0, 1e3, 3e3, 6e3, 12e3, 24e3), numbers, strict=True):
        speed = crossover(GUIDES[name], SET_A, load) / M_PER_MIN
        # It goes with the cube of mu_t over viscosity: 0.3 % of the coefficients are 1 % here.
        assert speed == pytest.approx(float(number), abs=0.5 * last_digit(number) + 1e-2 * float(number))


@pytest.mark.parametrize(("name", "one", "load"), [("20R", "A", "4.9"), ("30R", "A", "6.2"), ("20R", "B", "6.6"),
                                                   ("30R", "B", "8.3")])  # fmt: skip
def test_load_above_which_rolling_dominates_below_2_m_per_min(name: str, one: str, load: str) -> None:
    assert 1e-3 * dominance_load(GUIDES[name], SETS[one]) == pytest.approx(float(load), rel=0.02)  # as the crossover


def test_ratios_of_the_sets() -> None:
    """X and Y: viscous multiplier at 0.1 Pa s and 2e-8 1/Pa over mu_t, and mu_s over mu_t."""
    for one, X, Y in ((SET_A, 3675, 33.5), (SET_B, 3966, 51.2)):
        viscous = (one.oil.viscosity / 0.1) ** 0.325 * (one.oil.pressure_viscosity / 2e-8) ** -0.51
        # Three digits of the coefficients, the second exponent between 0.49 and 0.53.
        assert viscous / one.rolling == pytest.approx(X, rel=5e-3)
        assert one.slip / one.rolling == pytest.approx(Y, rel=6e-3)


def test_region_of_the_ranges_without_load() -> None:
    """X 3125 to 3750 and Y 16.8 to 33.5 were found on a grid; the corners lie up to a grid step outside."""
    corners = unloaded_region().corners
    assert corners.min(axis=0) == pytest.approx([3125, 16.8], rel=0.02)
    assert corners.max(axis=0) == pytest.approx([3750, 33.5], rel=0.02)
    assert largest_slip() == printed("33")


def test_slip_of_45_percent_needs_6_percent_without_load() -> None:
    ratios = np.array([3966.0, 57.0])
    assert share_at(ratios, HSR_20R, 0.06 * M_PER_MIN, 24e3, 2) == pytest.approx(45, abs=1)
    assert share_at(ratios, HSR_20R, 0.06 * M_PER_MIN, 0.0, 2) == pytest.approx(6, abs=0.5)


def test_set_b_meets_every_range_within_two_and_a_half_points() -> None:
    slow, fast = 0.06 * M_PER_MIN, 100.0 * M_PER_MIN
    for speed, load, part, low, high in (
        (slow, 0.0, 0, 63, 71), (fast, 0.0, 1, 81, 85), (slow, 0.0, 2, 2, 4), (slow, 24e3, 2, 11, 45),
        (fast, 24e3, 2, 11, 45),
    ):  # fmt: skip
        for guide in GUIDES.values():
            share = shares(guide, SET_B, speed, load)[part]
            assert low - 2.55 <= share <= high + 2.55  # two and a half, to a digit
    assert shares(HSR_20R, SET_B, slow, 24e3)[2] >= 45 - 2.55
    assert shares(HSR_30R, SET_B, fast, 24e3)[2] <= 11 + 2.55


VARIANTS = """
sum     1  2.13 4.31  1.05 1.01  3.2 1.7
sum     2  1.07 2.15  1.19 1.04  5.7 3.0
single  2  3.01 6.09  1.03 1.01  2.4 1.3
single  1  6.03 12.2  1.01 1.00  1.3 1.07
"""


@pytest.mark.parametrize("line", VARIANTS.strip().splitlines())
def test_variants_of_the_balance(line: str) -> None:
    """Hertz constant of both contacts or of one; two rows a part, or one as (7) is printed, with twice the load."""
    constant, text, *numbers = line.split()
    factor = float(text)
    for (name, base), unload, light, heavy in zip(GUIDES.items(), numbers[:2], numbers[2:4], numbers[4:], strict=True):
        guide = base if constant == "sum" else OneContact(**vars(base))
        assert 1e-3 * unloading_force(guide) / factor == printed(unload), name
        none, one, six = (_at_3_m_per_min(guide, factor * load) for load in (0.0, 1e3, 6e3))
        # The coefficients of each variant were fitted to the shares anew and are not given; these are set A.
        assert one / none == pytest.approx(float(light), abs=0.02), name
        assert six / none == pytest.approx(float(heavy), rel=0.06), name


def _at_3_m_per_min(guide: BallGuide, load: float) -> float:
    return float(carriage_friction(guide, SET_A, 3.0 * M_PER_MIN, load).total)


def test_means_of_table_4() -> None:
    assert np.mean(ACCURACY["HSR-20R"]) == printed("94.11")
    assert np.mean(ACCURACY["HSR-30R"]) == printed("95.43")
    assert np.mean(list(ACCURACY.values())) == printed("94.77")


def test_signed_errors_cancel() -> None:
    assert accuracy(np.array([10.0, 10.0]), np.array([5.0, 15.0])) == 100.0
    assert accuracy(np.array([10.0, 10.0]), np.array([9.0, 9.0])) == pytest.approx(90.0)


def test_scaling_with_ball_load_and_oil() -> None:
    """F_v ~ eta_0^0.325 alpha_p^-0.51."""
    base = carriage_friction(HSR_20R, SET_A, 0.1).viscous
    thicker, stiffer = replace(SET_A.oil, viscosity=0.26), replace(SET_A.oil, pressure_viscosity=4.4e-8)
    for oil, power in ((thicker, 0.325), (stiffer, -0.51)):
        changed = carriage_friction(HSR_20R, replace(SET_A, oil=oil), 0.1).viscous
        # Mean of two powers that differ by 0.01 and 0.04.
        assert math.log2(changed / base) == pytest.approx(power, abs=0.005)


def test_rows_of_the_comparison() -> None:
    found = rows()
    assert len(found) >= 30
    assert all(row.paper is Paper.GUIDE for row in found)
    assert len({(row.place, row.quantity) for row in found}) == len(found)
    status = {(row.place, row.quantity): row.status for row in found}
    assert status["sec. 5.2", "cause: HSR-20R has the smaller Hertz constant"] is Status.CONTRADICTED
    assert status["sec. 4.2", "HSR-20R: load that takes the preload away, over the preload"] is Status.CONTRADICTED
    assert status["sec. 4.2", "the same with the contact angle fixed"] is Status.ASSUMPTION
    assert status["eq. 7", "HSR-20R, 1 kN vertical: no lateral displacement"] is Status.PAPER_ONLY
    assert status["table 4", "mean accuracy, both sizes"] is Status.PAPER_ONLY
    assert status["eqs. 10-12", "slip integral the same in mm and m"] is Status.PAPER_ONLY
    assert status["sec. 5.2", "rolling at 0.06 m/min, no load, set A"] is Status.FITTED
    assert status["eq. 9", "area in the viscous force"] is Status.PAPER_ONLY
    assert status["fig. 9", "friction parts over load and speed"] is Status.NOT_POSSIBLE
