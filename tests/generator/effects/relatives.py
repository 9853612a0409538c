"""Laws that are relatives of those in the effect table: the same cause, another curve."""

from __future__ import annotations

import dataclasses
from collections.abc import Mapping
from dataclasses import dataclass, field
from typing import Self

from tests.generator.constants import Constants
from tests.generator.effects.base import Effect


@dataclass(frozen=True)
class Relative(Effect):
    """An effect of the table whose law is changed by numbers of the equations.

    base: whose name and size it has. law: what is other, in words. changes: numbers of `Constants`. lengths: those of
    them that grow with the effect.
    """

    base: Effect
    law: str
    changes: Mapping[str, float]
    lengths: tuple[str, ...] = field(default=())

    @property
    def name(self) -> str:  # type: ignore[override]
        """Return the name of the effect whose relative it is."""
        return self.base.name

    def planted(self, constants: Constants) -> Constants:
        """Return `constants` with this effect in them."""
        return self.base.planted(constants)._replace(**self.changes)

    def scaled(self, factor: float) -> Self:
        """Return the effect `factor` times as large."""
        changes = {key: value * (factor if key in self.lengths else 1.0) for key, value in self.changes.items()}
        return dataclasses.replace(self, base=self.base.scaled(factor), changes=changes)
