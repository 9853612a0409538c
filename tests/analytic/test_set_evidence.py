"""Evidence of sets of effects: against an integral, on chance alone, and on effects that hide or imitate each other."""

from __future__ import annotations

import math
from collections.abc import Callable, Sequence
from dataclasses import dataclass, field
from types import SimpleNamespace
from typing import Any

import numpy as np
import pytest
from scipy.integrate import quad
from scipy.ndimage import uniform_filter1d

from feeddrive.diagnosis.calibration.calibration import whitener
from feeddrive.diagnosis.certainty.rival_odds import Residuals, odds_and_distance
from feeddrive.diagnosis.finding.attempt import Attempt
from feeddrive.diagnosis.finding.columns import Neighbour, not_told
from feeddrive.diagnosis.finding.sets import members_weighed, neighbours
from feeddrive.diagnosis.likelihood.cross_validation import Comparison
from feeddrive.diagnosis.likelihood.fit import Fit, linear_step
from feeddrive.diagnosis.likelihood.set_evidence import (
    DISCREPANCY,
    LEVEL_KNOWN,
    declared_cost,
    discrepancy,
    log_odds,
    log_prior_of_size,
    log_volume,
    variance_along,
)
from feeddrive.diagnosis.likelihood.standing import Standing, declining, gain_between, odds_between
from feeddrive.diagnosis.likelihood.tolerances import BEYOND
from feeddrive.diagnosis.numbers.number_rows import MeasuredRows
from feeddrive.effects.base import Effect
from feeddrive.effects.chain.payload import Payload
from feeddrive.effects.source.constant_force import ConstantForce
from feeddrive.effects.travel.lead_error_cumulative import LeadErrorCumulative
from feeddrive.plant.plant import Plant
from feeddrive.recording import Recording
from feeddrive.typing import FloatArray
from tests.convergence.test_simulate import BENCH

ROWS = 6000
PLANT = Plant("axis", BENCH)
FIRST, SECOND, THIRD = Payload.of(mass=0.0), ConstantForce.of(force=0.0), LeadErrorCumulative.of(slope=0.0)
COUNT = 25

RECORDING = Recording.from_arrays(time=0.01 * np.arange(ROWS), motor_angle=np.zeros(ROWS), motor_torque=np.zeros(ROWS))
"""One in which nothing moves."""


def by_channel(residual: FloatArray) -> list[dict[str, FloatArray]]:
    """All rows of the one channel."""
    return [{"a": residual}]


def problem(columns: dict[str, FloatArray], measured: FloatArray) -> Any:
    """Recordings in which an effect of size one is its column."""
    evidence = SimpleNamespace(
        channels=("a",), fit_rows=np.ones(ROWS, dtype=bool), recording=RECORDING, block=0.5, left={}, kept={},
        thinning=1, floating=(), model_error={}, noise={}, thinned=lambda rows: rows, at_draws=(),
    )  # fmt: skip

    def residual(effects: Sequence[Effect]) -> FloatArray:
        return measured - sum((columns[e.name] * coordinate(e) for e in effects), np.zeros(ROWS))

    predictor = SimpleNamespace(of_motion=True)
    return SimpleNamespace(
        evidence=(evidence,), plant=PLANT, residual=residual, numbers=MeasuredRows(), predictor=predictor,
        by_channel=by_channel, whitener=None, noise_square=float(ROWS),
    )  # fmt: skip


def coordinate(effect: Effect) -> float:
    """The one coordinate of an effect of these."""
    (parameter,) = effect.parameters
    value = effect.values[parameter.key]
    assert isinstance(value, float)
    return value / parameter.size


def fitted(effects: Sequence[Effect], columns: dict[str, FloatArray], measured: FloatArray) -> Fit:
    """A set fitted to a series."""
    slopes = np.column_stack([np.zeros((ROWS, 0)), *(columns[e.name] for e in effects)])
    step = linear_step(slopes, measured)
    placed = tuple(
        e.with_values(**{e.parameters[0].key: e.parameters[0].size * float(c)})
        for e, c in zip(effects, step, strict=True)
    )
    return Fit(placed, measured - slopes @ step, slopes, step)


def attempt(effect: Effect, columns: dict[str, FloatArray], found: Fit, made: Any) -> Attempt:
    """A candidate at its start, beside a set that stays as it is."""
    slopes, held = columns[effect.name][:, None], len(found.effects)
    start = Fit((*found.effects, effect), found.residual, slopes, np.zeros(1), held)
    nothing = Comparison(0.0, 0.0, 0.0)
    return Attempt(effect.name, start, nothing, made, nothing)


def drawn(seed: int, *sizes: float, likeness: float = 0.0) -> tuple[dict[str, FloatArray], FloatArray]:
    """Columns, the second like the first by so much, and a series that holds so many deviations of each in noise."""
    generator = np.random.default_rng(seed)
    a, b, c, noise = generator.standard_normal((4, ROWS))
    b = likeness * a + np.sqrt(1 - likeness**2) * b
    columns = {"payload": a, "constant_force": b, "lead_error_cumulative": c}
    told = [size / np.sqrt(ROWS) * column for size, column in zip(sizes, columns.values(), strict=False)]
    return columns, noise + sum(told, np.zeros(ROWS))


def named(one: Neighbour, effects: Sequence[Effect]) -> set[str]:
    """Names that a set adds."""
    return {effects[i].name for i in one.added}


def test_volume_is_that_of_the_integral_over_the_prior() -> None:
    """One coordinate, told to a twentieth of its prior: Laplace's formula is exact to the bend of the prior there."""
    deviation, at = 0.05, 0.7
    effect = SECOND.with_values(force=at * 10.0)

    def density(theta: float) -> float:
        return float(np.exp(-0.5 * ((theta - at) / deviation) ** 2) / (np.pi * (1 + theta**2)))

    exact = np.log(quad(density, at - 8 * deviation, at + 8 * deviation)[0])
    found = log_volume((effect,), PLANT, np.array([at]), np.array([[1.0]]), deviation**2)
    assert found == pytest.approx(exact, abs=deviation**2)  # the second order of the prior over its width


def test_a_declared_value_that_is_other_is_as_likely_as_any_miss_whatever_its_size() -> None:
    """A mass over the declared one is lognormal, of the width of any value's miss; in kilograms that is no size."""
    declared, size = PLANT.chain.values["table_mass"], Payload.parameter("mass").size
    at = 0.4 * declared / size
    deviation = 0.01 * at

    def density(theta: float) -> float:
        share = 1 + theta * size / declared
        lognormal = math.exp(-0.5 * (math.log(share) / BEYOND) ** 2) / (math.sqrt(2 * math.pi) * BEYOND * share)
        return math.exp(-0.5 * ((theta - at) / deviation) ** 2) * lognormal * size / declared

    exact = np.log(quad(density, at - 8 * deviation, at + 8 * deviation)[0])
    effect = FIRST.with_values(mass=at * size)
    found = log_volume((effect,), PLANT, np.array([at]), np.array([[1.0]]), deviation**2)
    assert found == pytest.approx(exact, abs=1e-3)  # the second order of the prior over its width, 0.01 of the value


def test_prior_of_all_sets_of_a_size_falls_as_candidates_grow() -> None:
    """One effect of K is expected half as often as none, whichever it is: p(one) K / p(none) is a half at large K."""
    for count in (10, 100, 1000):
        ratio = np.exp(log_prior_of_size(1, count) - log_prior_of_size(0, count))
        assert count * ratio == pytest.approx(0.5, rel=1 / count)


def test_chance_gives_no_effect_and_its_odds_are_small() -> None:
    odds = []
    for seed in range(40):
        columns, measured = drawn(seed)
        nothing, one = fitted((), columns, measured), fitted((FIRST,), columns, measured)
        odds.append(log_odds(problem(columns, measured), nothing, one, COUNT))
    assert max(odds) < 0


def test_effect_of_eight_deviations_is_in_and_one_of_two_is_not() -> None:
    """The price of 25 candidates is 4 nats, of a size known to a seventieth of its prior 4.4: 4.1 deviations."""
    for size, wanted in ((8.0, True), (2.0, False)):
        columns, measured = drawn(3, size)
        found = fitted((FIRST,), columns, measured)
        assert (members_weighed(problem(columns, measured), found, COUNT)[0].gain < 0) is wanted


def test_declared_values_cost_their_deviations_whatever_the_noise() -> None:
    """One set leaves a value three deviations off, the other none: 4.5 nats, also where a row is worth little."""
    generator = np.random.default_rng(11)
    slopes, noise = 50.0 * generator.standard_normal((ROWS, 1)) / np.sqrt(ROWS), generator.standard_normal(ROWS)
    for level in (1.0, 5.0):
        columns, left = drawn(11)[0], level * noise
        made = problem(columns, left)
        made.whitener = whitener(slopes, np.zeros(1), level**2)
        residual = left - slopes @ np.linalg.lstsq(slopes, left, rcond=None)[0]
        # most likely values: a row that asks for 3 / s of a deviation more than the prior leaves of it
        asked = residual + slopes[:, 0] * 3.0 * (50.0**2 + level**2) / 50.0**2
        sets = [Fit((), made.whitener.applied(rows), np.zeros((ROWS, 0)), np.zeros(0)) for rows in (asked, residual)]
        assert made.whitener.most_likely(asked)[0] == pytest.approx(3.0, rel=0.05)  # of 50 columns of chance length
        assert declared_cost(made, sets[0].residual).nats == pytest.approx(4.5, rel=0.1)
        assert declared_cost(made, sets[1].residual).nats == pytest.approx(0.0, abs=1e-12)
        whole = sets[0].squared_error - sets[1].squared_error
        of_rows = whole - declared_cost(made, sets[0].residual).square
        variance = variance_along(made, sets[1], *sets)
        assert log_odds(made, *sets, COUNT) == pytest.approx(4.5 + 0.5 * of_rows / variance, rel=0.1)


def test_a_rival_is_charged_for_its_declared_values_whatever_the_colour_of_the_noise() -> None:
    """A value three deviations off costs 9 of twice the logarithm, where a row is worth a fifth of what it says.

    What is as slow as the noise is seen 1 / c as well as in white noise; c is 5 for means of eight rows.
    """
    generator = np.random.default_rng(11)
    slow = uniform_filter1d(generator.standard_normal((2, ROWS)), 8, axis=1, mode="wrap")
    noise, slopes = slow[0] / np.std(slow[0]), 50.0 * (slow[1] / np.linalg.norm(slow[1]))[:, None]
    made = problem(drawn(11)[0], noise)
    made.whitener = whitener(slopes, np.zeros(1), 1.0)
    residual = noise - slopes @ np.linalg.lstsq(slopes, noise, rcond=None)[0]
    asked = made.whitener.applied(residual + slopes[:, 0] * 3.0 * (50.0**2 + 1.0) / 50.0**2)
    mine, its = (Residuals(rows, noise, 0, declared_cost(made, rows)) for rows in (residual, asked))
    beside = SimpleNamespace(evidence=SimpleNamespace(**vars(made.evidence[0]), judged_rows=np.ones(ROWS, bool)))
    twice, distance = odds_and_distance(made, [beside], mine, its)
    colour = (np.linalg.norm(its.fitted - mine.fitted) / distance) ** 2
    of_rows = float(its.fitted @ its.fitted - mine.fitted @ mine.fitted) - its.declared.square
    assert colour > 3
    assert twice == pytest.approx(9.0 + of_rows / colour, rel=0.01)


def test_two_effects_that_hide_each_other_are_found_together() -> None:
    columns, measured = drawn(4, 60.0, -60.0, likeness=0.98)
    made, nothing = problem(columns, measured), fitted((), columns, measured)
    effects = (FIRST, SECOND, THIRD)
    attempts = [attempt(effect, columns, nothing, made) for effect in effects]
    ranked = neighbours(made, nothing, attempts, COUNT)
    assert named(ranked[0], effects) == {"payload", "constant_force"}
    alone = [one for one in ranked if len(one.added) == 1]
    assert ranked[0].gain > 5 + max((one.gain for one in alone), default=-np.inf)


def test_effect_that_stands_in_for_another_is_swapped_and_one_that_no_longer_pays_is_dropped() -> None:
    columns, measured = drawn(5, 60.0, likeness=0.95)
    wrong = fitted((SECOND,), columns, measured)
    made = problem(columns, measured)
    (best, *_) = neighbours(made, wrong, [attempt(FIRST, columns, wrong, made)], COUNT)
    assert best.dropped == (0,) and named(best, (FIRST,)) == {"payload"}
    both = fitted((FIRST, SECOND), columns, measured)
    (best, *_) = neighbours(made, both, [], COUNT)
    assert best.dropped == (1,) and best.gain > 0


def test_what_one_block_alone_shows_is_no_effect() -> None:
    """Six deviations for one block of 120: by the spectrum alone it would be an effect, by the sums over blocks not."""
    columns, measured = drawn(6)
    for name in columns:
        columns[name] = np.sign(np.sin(2 * np.pi * np.arange(ROWS) / 700))
    measured = measured + np.where((np.arange(ROWS) >= 100) & (np.arange(ROWS) < 150), 6.0, 0.0)
    found = fitted((FIRST,), columns, measured)
    assert members_weighed(problem(columns, measured), found, COUNT)[0].gain > 0


def test_what_a_set_declines_to_predict_is_as_likely_as_a_normal_distribution_of_its_error() -> None:
    level, own = 0.7, 5.0 * np.random.default_rng(1).standard_normal(200)
    square, residual = float(np.mean(own**2)), declining(np.ones(200), own, level)
    by_residual = -0.5 * np.sum(residual**2 / level + np.log(level))
    by_its_error = -0.5 * np.sum(own**2 / square + np.log(square))
    assert by_residual == pytest.approx(by_its_error, rel=1e-12)
    better = declining(np.ones(200), 0.01 * own, level)  # it is believed no better there than elsewhere
    assert better == pytest.approx(np.full(200, np.sqrt(level)))


class Part:
    """Evidence of a series of which some samples count."""

    channels, recording, block = ("a",), RECORDING, 0.5
    left, kept = {}, {}  # type: ignore[var-annotated]
    thinning, floating, model_error, edge = 1, (), {}, 50.0  # type: ignore[var-annotated]
    motion_speed, noise = np.zeros(ROWS), {}  # type: ignore[var-annotated]
    at_draws = ()

    def __init__(self, counted: Any) -> None:
        self.counted = self.fit_rows = counted

    def thinned(self, rows: Any) -> Any:
        return rows

    def weighs_as(self, other: Part) -> bool:
        return True

    def within(self, other: Part) -> Part:
        return Part(self.counted & other.counted)


@dataclass
class Made:
    """A problem of one series."""

    evidence: tuple[Part, ...]
    residual: Callable[[Sequence[Effect]], FloatArray]
    plant: Plant = PLANT
    numbers: MeasuredRows = field(default_factory=MeasuredRows)
    predictor: Any = field(default_factory=lambda: SimpleNamespace(chance=0.0, of_motion=True))
    calibration: None = None
    whitener: None = None
    by_channel: Callable[[FloatArray], list[dict[str, FloatArray]]] = by_channel
    noise_square: float = float(ROWS)


def standing(fit: Fit, counted: Any, series: FloatArray) -> Standing:
    """A set on some samples, whose own error is a series, there and on others that are asked for."""
    made: Any = Made((Part(counted),), lambda effects: OWN[effects[0].name][counted])
    return Standing(made, Fit(fit.effects, series[counted], fit.jacobian[counted], fit.coordinates))


OWN: dict[str, FloatArray] = {}


def test_a_law_of_another_form_is_granted_a_share_of_what_is_above_the_noise() -> None:
    made = problem({}, np.zeros(ROWS))
    # a tenth of the noise at least, as its level is known to that
    for square in (0.5 * ROWS, 1.05 * ROWS):
        assert discrepancy(made, square) == pytest.approx(DISCREPANCY * LEVEL_KNOWN * ROWS)
    assert discrepancy(made, 8.0 * ROWS) == pytest.approx(DISCREPANCY * 7.0 * ROWS)


@pytest.mark.parametrize(("elsewhere", "wins"), [(1.0, False), (30.0, True)])
def test_set_that_declines_wins_where_the_other_does_worse_there_than_elsewhere(
    elsewhere: float, wins: bool, monkeypatch: pytest.MonkeyPatch
) -> None:
    """Two sets do alike on one half. On the other the first errs as elsewhere, or 30 times as much; the second declines
    there, its own error being 20 times that of the other half."""
    columns, _ = drawn(7)
    generator, half = np.random.default_rng(8), np.arange(ROWS) < ROWS // 2
    noise = generator.standard_normal(ROWS)
    one, other = fitted((FIRST,), columns, noise), fitted((SECOND,), columns, noise)
    OWN["payload"] = np.where(half, 1.0, elsewhere) * noise
    OWN["constant_force"] = np.where(half, 1.0, 20.0) * noise
    first = standing(one, np.ones(ROWS, dtype=bool), OWN["payload"])
    second = standing(other, half, OWN["constant_force"])

    def as_it_is(problem: Any, effects: Sequence[Effect], **_: Any) -> Fit:
        slopes = one if effects[0].name == "payload" else other
        return Fit(tuple(effects), slopes.residual[half], slopes.jacobian[half], slopes.coordinates)

    monkeypatch.setattr("feeddrive.diagnosis.likelihood.standing.fit", as_it_is)
    odds = odds_between(first, second, COUNT)
    assert (odds > 0) is wins
    assert odds_between(second, first, COUNT) == pytest.approx(-odds, rel=1e-6)
    assert gain_between(first, second, in_folds=False).pays is wins


def test_a_step_goes_no_further_than_a_size_where_it_gains_less_than_the_prior_takes() -> None:
    """Two columns that differ by noise alone: their sum is told, their difference is not."""
    generator = np.random.default_rng(11)
    told, noise = generator.standard_normal(ROWS), generator.standard_normal(ROWS)
    columns = np.column_stack([told, told + 1e-4 * generator.standard_normal(ROWS)])
    length = np.linalg.norm(columns, axis=0)
    normal = columns.T @ columns / np.outer(length, length)
    for true in (np.array([3.0, 3.0]), np.array([4000.0, -3994.0])):
        step = np.linalg.solve(normal, columns.T @ (columns @ true + noise) / length)
        kept = (step - not_told(normal, normal, step, length)) / length  # white noise of one
        assert kept.sum() == pytest.approx(6.0, abs=5 / np.sqrt(ROWS))  # five deviations of the sum's noise
        # a difference of 7994 makes 0.4 deviations a row, known to 2.3 % by ROWS of them: five deviations of that; one
        # of none is left where it was, but for what the columns' lengths differ by, 1e-6 of the sum
        assert kept[0] - kept[1] == pytest.approx(true[0] - true[1], rel=0.12, abs=1e-4)
