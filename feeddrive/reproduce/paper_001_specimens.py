"""Paper 001, sections 2 and 4: the life test, its Weibull line and what the figures allow together."""

from __future__ import annotations

import math

import numpy as np
from scipy.special import gamma
from scipy.stats import beta

from feeddrive.parts.life.life_exponents import BALL_BEARING, BALL_SCREW
from feeddrive.parts.life.weibull import WeibullLaw, complete_slope_interval, line_fit
from feeddrive.reproduce.row import Paper, Row, claim, not_possible, number
from feeddrive.reproduce.specimen_001 import (
    FIRST_FAILURE,
    FIRST_OPENED,
    LAST_FAILURE,
    OPENED_EVERY,
    RATED_LIFE,
    SPECIMENS,
    double_nut_rating,
    single_nut_rating,
)

_LIFE = Paper.LIFE
_THOUSAND = 1e3
_STANDARD_GRAVITY = 9.80665


def specimen_rows() -> tuple[Row, ...]:
    """Rows of the life test."""
    return (*_conditions(), *_weibull(), *_consistency(), *_not_printed())


def _conditions() -> tuple[Row, ...]:
    force = 1350.0 * _STANDARD_GRAVITY / _THOUSAND
    steps = [(life - FIRST_OPENED) / OPENED_EVERY for life in (FIRST_FAILURE, LAST_FAILURE)]
    return (
        number(_LIFE, "conclusion 5, table 1", "test load of 1350 kgf", "kN", "13.5", force,
               law=None, otherwise="1350 kgf and the 13.5 kN of table 1 differ by 2 %"),
        claim(_LIFE, "sec. 2.1", "first and last failure lie on the grid of inspections",
              "opened at 200 000, then every 30 000 rev", f"steps {steps[0]:g} and {steps[1]:g}",
              all(step == round(step) for step in steps), law=None),
    )  # fmt: skip


def _weibull() -> tuple[Row, ...]:
    ends = _line_through_ends()
    interval = complete_slope_interval(BALL_SCREW.slope, SPECIMENS)
    scatter = [_variation(exponents.slope) for exponents in (BALL_SCREW, BALL_BEARING)]
    per_cent, fraction = _ordinate(50.0), _ordinate(0.5)
    return (
        not_possible(_LIFE, "sec. 2.2, Fig. 2", "Weibull slope", "", "3.6",
                     "the lives of the ten specimens are not printed; the line through first and last alone has "
                     f"{ends.slope:.1f}"),
        claim(_LIFE, "sec. 2.2", "slope of ball screws above the 10/9 of ball bearings", "3.6 against 1.11",
              f"90 % interval {interval.low:.2f} to {interval.high:.2f}", interval.low > BALL_BEARING.slope,
              law=complete_slope_interval, assumption="all ten failed, and the slope is that of maximum likelihood"),
        claim(_LIFE, "sec. 2.2", "lives of screws scatter less than those of bearings", "smaller",
              f"standard deviation over mean {scatter[0]:.2f} against {scatter[1]:.2f}", scatter[0] < scatter[1],
              law=None, assumption="Weibull's law with the two printed slopes"),
        claim(_LIFE, "eq. (1), sec. 2.2", "F in per cent", "F (%)",
              f"ln ln(1/(1 - F)) of one half is {fraction:.3f}, of 50 {_or_none(per_cent)}",
              math.isfinite(per_cent),
              law=None, otherwise="F must be a fraction: in per cent the logarithm does not exist"),
    )  # fmt: skip


def _consistency() -> tuple[Row, ...]:
    """What L10, slope and the range of failures say of one another."""
    law = WeibullLaw.through(RATED_LIFE, 0.1, BALL_SCREW.slope)
    all_failed = law.failure(LAST_FAILURE) ** SPECIMENS
    twenty = WeibullLaw.through(FIRST_FAILURE, float(beta.ppf(0.5, 1, 2 * SPECIMENS)), BALL_SCREW.slope).life()
    return (
        number(_LIFE, "conclusion 5", "rated life L10, greatest of ten lives from 230 000 to 500 000 with slope 3.6",
               "thousand rev", "300", greatest_rated_life() / _THOUSAND, law=None, within=0.01,
               otherwise="no ten such lives give 300; with the first failure as the first of twenty single nuts it "
               f"would be {twenty / _THOUSAND:.0f}"),
        claim(_LIFE, "sec. 2.2, conclusion 5", "L10 of 300 000, slope 3.6 and all ten failed by 500 000 rev",
              "all three", f"chance of it {all_failed:.1e}", all_failed > 0.05, law=WeibullLaw.failure,
              otherwise=f"with them the last of ten fails at {_median_last(law) / _THOUSAND:.0f} 000 rev; it agrees if "
              "half of the nuts were suspended, or if twenty single nuts are counted"),
    )  # fmt: skip


def greatest_rated_life() -> float:
    """Greatest L10 [rev] of a line of slope 3.6 through ten lives from the printed first to the printed last.

    The line of least squares passes through the means, and their mean of ln L is greatest with nine lives at the end.
    """
    ranks = np.arange(1.0, SPECIMENS + 1.0)
    ordinate = np.log(-np.log1p(-beta.ppf(0.5, ranks, SPECIMENS + 1.0 - ranks))).mean()
    mean = (math.log(FIRST_FAILURE) + (SPECIMENS - 1) * math.log(LAST_FAILURE)) / SPECIMENS
    return math.exp(mean + (_ordinate(0.1) - float(ordinate)) / BALL_SCREW.slope)


def _not_printed() -> tuple[Row, ...]:
    double, single = double_nut_rating() / _THOUSAND, single_nut_rating() / _THOUSAND
    return (
        not_possible(_LIFE, "Fig. 2", "lives of the ten specimens", "rev", "points of the chart",
                     "no values in the available text"),
        not_possible(_LIFE, "Figs. 7, 8", "basic dynamic rating of the specimen", "kN", "curves",
                     f"no values in the available text; 13.5 kN and 300 000 rev give {double:.2f} kN for the double "
                     f"nut and {single:.2f} kN for a single one"),
        not_possible(_LIFE, "sec. 2.2, conclusion 2", "first pits near the return tube", "", "near the tube",
                     "the blow of the balls that enter is in no model of the paper"),
        not_possible(_LIFE, "sec. 2.1", "change of preload torque at failure", "N m", "used as detector",
                     "no torque is printed"),
    )  # fmt: skip


def _line_through_ends() -> WeibullLaw:
    """Line through first and last failure at the median ranks of ten."""
    ranks = np.array([1.0, SPECIMENS])
    return line_fit(np.array([FIRST_FAILURE, LAST_FAILURE]), beta.ppf(0.5, ranks, SPECIMENS + 1 - ranks))


def _median_last(law: WeibullLaw) -> float:
    """Median life of the last of the specimens [rev]."""
    return law.life(0.5 ** (1.0 / SPECIMENS))


def _ordinate(failed: float) -> float:
    """ln ln(1/(1 - F)); not a number where it does not exist."""
    with np.errstate(invalid="ignore"):
        return float(np.log(-np.log1p(-np.float64(failed))))


def _or_none(value: float) -> str:
    return f"{value:.3f}" if math.isfinite(value) else "not a number"


def _variation(slope: float) -> float:
    """Standard deviation over mean of a Weibull law [1]."""
    return math.sqrt(gamma(1 + 2 / slope) / gamma(1 + 1 / slope) ** 2 - 1)
