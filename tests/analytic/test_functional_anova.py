"""Functional analysis of variance on made-up residuals: known functions are found, coloured noise is left alone."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
import pytest

from feeddrive.diagnosis.unexplained import functional_anova
from feeddrive.diagnosis.unexplained.functional_anova import Found, Sample, Sums, decompose
from feeddrive.diagnosis.unexplained.terms import Form, Term, hats
from feeddrive.diagnosis.unexplained.view import Floor, excess, travel_since_reversal
from feeddrive.typing import FloatArray

RATE, SECONDS, BLOCK = 200.0, 24.0, 0.5
TIME = np.arange(int(RATE * SECONDS)) / RATE
# two tones of no common period: no cycle of the motion comes again
POSITION = 0.2 + 0.1 * np.sin(0.9 * TIME) + 0.05 * np.sin(2.3 * TIME + 1.0)
VELOCITY = np.gradient(POSITION, TIME)
VALUES = {"position": POSITION, "velocity": VELOCITY, "time": TIME, "direction": np.sign(VELOCITY)}
NODES = tuple(np.linspace(POSITION.min(), POSITION.max(), 9).tolist())
TERMS = [
    Term(Form.CURVE, "position", "", NODES),
    Term(Form.CURVE, "position", "direction", NODES),
    Term(Form.CURVE, "velocity", "", tuple(np.linspace(VELOCITY.min(), VELOCITY.max(), 9).tolist())),
    Term(Form.CURVE, "time", "", tuple(np.linspace(0, SECONDS, 7).tolist())),
    Term(Form.LEVEL, "direction"),
    *(Term(Form.STEP, "time", times, (t,)) for t in np.arange(1.0, 24.0) for times in ("", "direction")),
]


def coloured(generator: np.random.Generator, correlation: float) -> FloatArray:
    """Noise of rms 1 whose neighbours are correlated by `correlation`, (n,)."""
    noise = generator.standard_normal(len(TIME))
    for i in range(1, len(noise)):
        noise[i] = correlation * noise[i - 1] + np.sqrt(1 - correlation**2) * noise[i]
    return np.asarray(noise, dtype=np.float64)


def taken_apart(residual: FloatArray, terms: Sequence[Term] = TERMS) -> tuple[Found, ...]:
    """The decomposition of a residual."""
    blocks = (TIME / BLOCK).astype(np.int64)
    offsets = np.ones((len(TIME), 1))
    sample = Sample(residual, blocks, offsets, lambda term: term.columns(VALUES), 1.0, 0.005)
    return decompose(sample, terms, lambda left: [], lambda term: [])


@pytest.mark.parametrize("seed", range(6))
@pytest.mark.parametrize("correlation", [0.0, 0.8])
def test_noise_is_left_alone(seed: int, correlation: float) -> None:
    """White noise, and noise whose correlation reaches over 0.02 s: far under a block, far over a sample."""
    assert taken_apart(coloured(np.random.default_rng(seed), correlation)) == ()


def test_terms_that_take_each_others_place_come_to_an_end(
    generator: np.random.Generator, monkeypatch: pytest.MonkeyPatch
) -> None:
    """Each of two terms pays beside the other, and each is said to need no other beside it."""
    monkeypatch.setattr(functional_anova, "_needed", lambda sums, chosen, new: [])
    rounds = iter(range(10))

    def proposed(left: FloatArray) -> list[Term]:
        assert next(rounds, None) is not None, "it goes on and on"
        return []

    residual = 3.0 * VALUES["direction"] + 20.0 * (POSITION - 0.2) + coloured(generator, 0.5)
    blocks, offsets = (TIME / BLOCK).astype(np.int64), np.ones((len(TIME), 1))
    sample = Sample(residual, blocks, offsets, lambda term: term.columns(VALUES), 1.0, 0.005)
    assert len(decompose(sample, TERMS, proposed, lambda term: [])) == 1


def test_an_additive_function_is_found_with_its_values(generator: np.random.Generator) -> None:
    residual = 40.0 * (POSITION - 0.2) ** 2 / 0.15**2 + coloured(generator, 0.5)
    (found,) = taken_apart(residual)
    assert (found.term.variable, found.term.times) == ("position", "")
    wanted = 40.0 * (np.array(NODES) - 0.2) ** 2 / 0.15**2
    miss = found.values - wanted
    # about the mean, which belongs to the offset; a chord of this parabola leaves 0.6 between nodes, noise 0.1 a node
    assert miss - miss.mean() == pytest.approx(np.zeros(9), abs=0.9)


def test_a_product_is_not_taken_for_a_function_of_one_variable(generator: np.random.Generator) -> None:
    residual = np.interp(POSITION, NODES, 4 * np.sin(np.arange(9))) * VALUES["direction"] + coloured(generator, 0.5)
    (found,) = taken_apart(residual)
    assert (found.term.variable, found.term.times) == ("position", "direction")
    assert found.values == pytest.approx(4 * np.sin(np.arange(9)), abs=5 * max(found.errors))


def test_a_level_is_preferred_to_a_curve_that_does_as_well(generator: np.random.Generator) -> None:
    (found,) = taken_apart(3.0 * VALUES["direction"] + coloured(generator, 0.5))
    assert found.term == Term(Form.LEVEL, "direction")
    assert found.values[0] == pytest.approx(3.0, abs=0.15)  # three standard errors of 4800 values correlated by 0.5


def test_a_step_with_the_direction_is_found_at_its_time(generator: np.random.Generator) -> None:
    (found,) = taken_apart(2.0 * (TIME >= 9.0) * VALUES["direction"] + coloured(generator, 0.5))
    assert (found.term.form, found.term.times, found.term.nodes) == (Form.STEP, "direction", (9.0,))


def test_a_product_has_no_level_that_a_function_of_the_velocity_holds(generator: np.random.Generator) -> None:
    """A shape near rest that the breakpoints miss is a level less a curve: 3 and -3, where 0.5 is left elsewhere."""
    values, fastest = {**VALUES, "table_velocity": VELOCITY}, float(np.abs(VELOCITY).max())
    speeds = (-fastest, -0.2 * fastest, 0.0, 0.2 * fastest, fastest)
    curve = 0.5 * np.sin(np.arange(9))
    near_rest = VALUES["direction"] - hats(VELOCITY, speeds) @ np.sign(speeds)
    residual = np.interp(POSITION, NODES, curve) * VALUES["direction"] + 3 * near_rest
    product, velocity = Term(Form.CURVE, "position", "direction", NODES), Term(Form.CURVE, "table_velocity", "", speeds)
    columns = [term.columns(values) for term in (product, velocity)]
    alone = np.linalg.lstsq(np.hstack(columns), residual, rcond=None)[0]
    assert alone[:9].mean() > 2
    blocks = (TIME / BLOCK).astype(np.int64)
    noisy = residual + 0.1 * coloured(generator, 0.5)
    sums = Sums(Sample(noisy, blocks, np.ones((len(TIME), 1)), lambda term: term.columns(values), 0.01, 0.005))
    sums.add([product, velocity])
    found, errors = sums.coefficients([product, velocity])
    contribution = columns[0] @ found[product]
    assert contribution @ VALUES["direction"] == pytest.approx(0.0, abs=1e-6 * len(TIME))
    # rest is met at the ends of a swing alone: what is left there goes into the curve's outer parts, not into a level
    assert np.abs(found[product]).max() < 1.5 and np.abs(found[velocity]).max() < 1.5
    assert np.all(np.isfinite(errors[product])) and np.all(np.isfinite(errors[velocity]))


def test_two_functions_are_told_apart(generator: np.random.Generator) -> None:
    residual = 20 * (POSITION - 0.2) / 0.15 + 1.5 * np.cos(2 * np.pi * TIME / 12.0) + coloured(generator, 0.5)
    found = taken_apart(residual)
    assert [one.term.variable for one in found] == ["position", "time"]


def test_standard_errors_are_those_of_repeated_noise() -> None:
    """The scatter of a node over 30 draws of correlated noise is what one draw says of it, within a third."""
    truth = np.interp(POSITION, NODES, 10 * np.sin(np.arange(9)))
    draws = [taken_apart(truth + coloured(np.random.default_rng(seed), 0.7), TERMS[:1])[0] for seed in range(30)]
    scatter = np.std([draw.values - draw.values.mean() for draw in draws], axis=0, ddof=1)[2:7]
    told = np.mean([draw.errors for draw in draws], axis=0)[2:7]
    # 30 draws know a scatter to 13 %; 48 blocks an error to 10 %, and the offset shares a little of either
    assert np.median(scatter / told) == pytest.approx(1.0, abs=0.33)


def test_hats_add_up_to_one_and_meet_their_nodes() -> None:
    at = np.linspace(-1.0, 2.0, 301)
    assert hats(at, (0.0, 0.3, 1.0)).sum(axis=1) == pytest.approx(np.ones(301))
    assert hats(np.array([0.0, 0.3, 1.0]), (0.0, 0.3, 1.0)) == pytest.approx(np.eye(3))


def test_excess_of_white_noise_is_none_and_of_twice_the_noise_three_quarters(generator: np.random.Generator) -> None:
    noise, blocks = coloured(generator, 0.0), (TIME / BLOCK).astype(np.int64)
    plain, twice = (excess([k * noise], [blocks], [Floor(1.0, 0.02)]) for k in (1.0, 2.0))
    assert not plain.is_left and abs(plain.share) < 3 * plain.standard_error
    assert twice.is_left and twice.share == pytest.approx(0.75, abs=3 * twice.standard_error)
    # 4800 values: sqrt(2 / 4800) = 0.02 of the square, and twice the 2 % of the floor
    assert plain.standard_error == pytest.approx(np.hypot(0.0204, 0.04), rel=0.3)


def test_travel_counts_from_the_last_reversal() -> None:
    position = np.array([0.0, 1.0, 2.0, 2.5, 2.0, 1.0, 1.0, 0.0, 1.0])
    direction = np.array([1.0, 1.0, 1.0, 1.0, -1.0, -1.0, 0.0, -1.0, 1.0])
    assert travel_since_reversal(position, direction).tolist() == [0.0, 1.0, 2.0, 2.5, 0.0, 1.0, 1.0, 2.0, 0.0]
