"""What happened to the machine: changes of quantities at the same time are one event, named by what they share."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from scipy.special import logsumexp

from feeddrive.trend.atoms import JUMP, ODD, SETTLING, SLOPE
from feeddrive.trend.change_points import ASSERTED, Found, most_likely
from feeddrive.trend.quantities import Quantity
from feeddrive.typing import FloatArray


@dataclass(frozen=True)
class Change:
    """A course of one quantity."""

    quantity: Quantity
    found: Found


@dataclass(frozen=True)
class Event:
    """Changes that began together.

    Attributes:
        kind: "jump", "slope" or "settling".
        changes: the surest first.
        dates: interval of days that holds the date with 95 %, by all of these quantities together.
        day: in the middle of its probability: as likely earlier as later.
        causes: effects that move all of these quantities, or what most of them share, the likeliest first.
    """

    kind: str
    changes: tuple[Change, ...]
    dates: tuple[float, float]
    day: float
    causes: tuple[str, ...]


def events_of(changes: Sequence[Change]) -> tuple[Event, ...]:
    """Group changes of a kind whose dates may be the same, by date; odd recordings are no events."""
    groups: list[list[Change]] = []
    told = [one for one in changes if one.found.atom.kind != ODD]
    for one in sorted(told, key=lambda change: change.found.dates[1] - change.found.dates[0]):
        group = next((group for group in groups if _together(group[0].found, one.found)), None)
        if group is None:
            groups.append([one])
        else:
            group.append(one)
    return tuple(sorted(map(_event, groups), key=lambda event: event.day))


def _together(one: Found, other: Found) -> bool:
    """Whether two changes of a kind (slow or sudden) may have begun together: two are told at odds of 100 as well.

    Odds of one date against two: sum over d of p(d) q(d), times the dates that a second event could have.
    """
    if (one.atom.kind == JUMP) != (other.atom.kind == JUMP):
        return False
    dates = other.posterior[0]
    both = np.maximum(np.interp(dates, *one.posterior, left=LEAST, right=LEAST), LEAST) + other.posterior[1]
    return float(logsumexp(both)) + float(np.log(len(dates))) > -float(np.log(ASSERTED))


def _event(group: list[Change]) -> Event:
    ordered = tuple(sorted(group, key=lambda change: -change.found.odds))
    kind = JUMP
    if group[0].found.atom.kind != JUMP:  # one kind of wear or warming moves all of these quantities
        kind = SETTLING if sum(change.found.settles for change in group) > 0 else SLOPE
    dates, logs = _together_dated([change.found for change in group])
    return Event(
        kind,
        ordered,
        most_likely(dates, logs),
        float(dates[int(np.searchsorted(np.cumsum(np.exp(logs)), 0.5))]),
        _causes(ordered, kind),
    )


LEAST = -20.0
"""Log probability of a date that a quantity leaves to others: its own law of change is never exactly the machine's."""


def _together_dated(found: Sequence[Found]) -> tuple[FloatArray, FloatArray]:
    """Possible dates of one beginning, and the log of their probability by all quantities that it shows in."""
    dates = np.unique(np.concatenate([one.posterior[0] for one in found]))
    logs = np.zeros(len(dates))
    for one in found:
        own = np.interp(dates, *one.posterior, left=LEAST, right=LEAST)
        logs += np.maximum(own, LEAST)
    return dates, logs - float(logsumexp(logs))


def _causes(changes: Sequence[Change], kind: str) -> tuple[str, ...]:
    """Effects by how many of the quantities they move; a sudden play is play and not a loss of preload."""
    count: dict[str, float] = {}
    for change in changes:
        for place, effect in enumerate(change.quantity.effects):
            weight = 1.0 - 0.01 * place
            if effect == "preload_loss":
                weight = _as_preload(change) if kind in (SLOPE, SETTLING) else 0.2
            count[effect] = count.get(effect, 0.0) + weight
    best = max(count.values(), default=0.0)
    return tuple(sorted((name for name, value in count.items() if value > 0.7 * best), key=lambda name: -count[name]))


def _as_preload(change: Change) -> float:
    """How a slow change speaks for a loss of preload: friction and stiffness fall with it, lost motion rises."""
    rises = change.found.size > 0
    expected = change.quantity.name == "play"
    return 1.05 if rises == expected else -1.0
