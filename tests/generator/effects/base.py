"""What every effect that can be planted answers."""

from __future__ import annotations

import dataclasses
from dataclasses import dataclass
from typing import ClassVar, Self

from tests.generator.constants import Constants


@dataclass(frozen=True)
class Effect:
    """One effect, named and parametrised as the project's effect table says, SI units.

    name: that of the table. size_keys: the parameters that make it larger. neutral: their value where it is absent.
    Friction and forces are positive when they resist positive motion. Impossible parameters raise ValueError.
    """

    name: ClassVar[str]
    size_keys: ClassVar[tuple[str, ...]]
    neutral: ClassVar[float] = 0.0

    def planted(self, constants: Constants) -> Constants:
        """Return `constants` with this effect in them."""
        raise NotImplementedError

    def scaled(self, factor: float) -> Self:
        """Return the effect `factor` times as large; ValueError where it cannot be that large."""
        sizes = {key: self.neutral + factor * (getattr(self, key) - self.neutral) for key in self.size_keys}
        return dataclasses.replace(self, **sizes)


def require(holds: bool, effect: Effect, what: str) -> None:
    """Raise ValueError with the effect's name where a condition on its parameters does not hold."""
    if not holds:
        raise ValueError(f"{effect.name}: {what}")
