"""Members of a set: the name of an effect, and where it acts."""

from __future__ import annotations

from collections.abc import Sequence

from feeddrive.effects.base import Effect

Member = tuple[str, str, str]


def members_of(effects: Sequence[Effect]) -> tuple[Member, ...]:
    """Names of a set, and where they act, in the order of the alphabet."""
    return tuple(sorted(map(member, effects)))


def member(effect: Effect) -> Member:
    """Name, port and place of an effect."""
    return effect.name, str(effect.port), effect.place


def rest_of(effects: Sequence[Effect], gone: Sequence[Effect]) -> list[Effect]:
    """Effects of a set but for some of them."""
    return [one for one in effects if not any(one is other for other in gone)]
