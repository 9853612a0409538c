"""How sure a diagnosis is: records of correlations, of effects that look alike, of experiments worth running."""

from __future__ import annotations

from dataclasses import dataclass


@dataclass(frozen=True)
class Correlation:
    """Correlations of the fitted numbers.

    Attributes:
        names: `effect.key`, or `effect.key[i]` in a tabulated curve.
        matrix: correlations, symmetric, one on the diagonal.
        condition: condition number of the slopes, each of length one; infinite where a number does not show at all.
        remarks: sentences about pairs that are known only together.
    """

    names: tuple[str, ...]
    matrix: tuple[tuple[float, ...], ...]
    condition: float
    remarks: tuple[str, ...]


@dataclass(frozen=True)
class Ambiguity:
    """Effects that explain the same.

    Attributes:
        names: at most three, the one taken first.
        distances: of each of the others from the one taken, both fitted: difference of the predictions in standard
            deviations of the noise, all samples together.
        reason: in words: how alike, and what each follows.
    """

    names: tuple[str, ...]
    distances: tuple[float, ...]
    reason: str


@dataclass(frozen=True)
class NextExperiment:
    """A scenario that would settle a question.

    Attributes:
        question: effects to tell apart, or the parameter `effect.key` to know better.
        scenario: name of a shipped scenario; empty where none settles it.
        figure: to tell apart: standard deviations of the noise between the predictions, the rival refitted; to know
            better: half width of the 95 % interval after it over that before.
        sentence: for a person.
        ranking: scenario to its figure, the best first.
    """

    question: tuple[str, ...]
    scenario: str
    figure: float
    sentence: str
    ranking: tuple[tuple[str, float], ...]
