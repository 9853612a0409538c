"""What a ledger keeps of one run beyond its diagnosis: every trial, and the fitted values with their covariance."""

from __future__ import annotations

from dataclasses import dataclass, field

from feeddrive.effects.base import Value


@dataclass(frozen=True)
class Tried:
    """One effect in one round.

    Attributes:
        round: 1 for the first effect searched.
        effect: name.
        port: where it acts.
        place: the word that says where, or an empty text.
        values: of the trial after its start was refined, SI.
        gain: share of the squared error on blocks left out.
        standard_error: of the gain.
        least: gain that was asked for.
        taken: whether it was taken.
        reason: why, or why not.
    """

    round: int
    effect: str
    port: str
    place: str
    values: dict[str, Value]
    gain: float
    standard_error: float
    least: float
    taken: bool
    reason: str


@dataclass(frozen=True)
class Covariance:
    """Covariance of fitted values: names as `effect.key`, and the matrix in SI units."""

    names: tuple[str, ...] = ()
    matrix: tuple[tuple[float, ...], ...] = ()


@dataclass(frozen=True)
class Kept:
    """What the ledger keeps of a run.

    Attributes:
        tried: every effect tried.
        covariance: of what was fitted.
        since: what changed since the run that was continued, in sentences.
    """

    tried: tuple[Tried, ...] = ()
    covariance: Covariance = field(default_factory=Covariance)
    since: tuple[str, ...] = ()
