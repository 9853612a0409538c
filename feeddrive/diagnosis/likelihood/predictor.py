"""What the search needs to know of a kind of machine: how recordings are predicted, and which effects are tried.

Two kinds are known: motion and torque (`prediction`) and temperatures and growth (`heat.prediction`). Search, fit,
cross-validation and judging are the same for both.
"""

from __future__ import annotations

from abc import ABC, abstractmethod
from collections.abc import Sequence
from typing import TYPE_CHECKING, ClassVar, Generic, Protocol, TypeVar

from feeddrive.diagnosis.likelihood.evidence import Evidence
from feeddrive.effects.base import Effect
from feeddrive.typing import BoolArray, FloatArray

if TYPE_CHECKING:
    from feeddrive.diagnosis.finding.scene import Candidate, Scene
    from feeddrive.diagnosis.likelihood.fit import Problem

CHANCE = 30.0
"""Degrees of freedom of the noise that the luckiest wrong candidate takes away: 2 ln K for the best of K = 10^4 trials
(orders, places, velocities) and two for each of its three parameters, and a fifth more."""


class Machine(Protocol):
    """A declared plant, of motion or of heat."""

    @property
    def name(self) -> str:
        """What it is called."""

    @property
    def effects(self) -> tuple[Effect, ...]:
        """What it holds, labelled; those added come last."""

    def with_effects(self, *effects: Effect) -> Machine:
        """The machine with further effects."""


M = TypeVar("M", bound=Machine)
E = TypeVar("E", bound=Evidence)


class Predictor(ABC, Generic[M, E]):
    """Predicts recordings of one kind of machine."""

    chance: ClassVar[float] = CHANCE
    """Degrees of freedom of the noise that the luckiest wrong candidate takes away."""

    @property
    @abstractmethod
    def candidates(self) -> tuple[Candidate, ...]:
        """Effects that are tried."""

    @abstractmethod
    def predict(self, plant: M, evidence: E) -> dict[str, FloatArray]:
        """Channel to its prediction, as it is compared, (n,), SI; not finite where it cannot be simulated."""

    def slopes(self, plant: M, evidence: E, numbers: Sequence[str]) -> dict[str, FloatArray] | None:
        """Channel to the exact slopes of its prediction, (n, k), with numbers of effects, (k,), as `label.key[i]`.

        None where slopes are taken by differences of predictions.
        """
        return None

    @abstractmethod
    def scene(self, problem: Problem, found: Sequence[Effect]) -> Scene:
        """What starts of candidates are read from, after the effects found so far."""

    @abstractmethod
    def variables(self, plant: M, evidence: E) -> dict[str, FloatArray]:
        """Variables that a residual may depend on, (n,) each, SI."""

    @abstractmethod
    def reference(self, name: str, plant: M, evidence: E) -> FloatArray:
        """Series of a channel whose rms a relative error refers to, over the judged samples."""

    @abstractmethod
    def is_material(self, effect: Effect, plant: M) -> bool:
        """Whether an effect is of a size that matters on this machine."""

    def told(self, before: M, after: M) -> tuple[str, ...]:
        """What is to be said of this way to predict, with the declared plant and with what was found."""
        return ()

    def smooth(self, plant: M) -> bool:
        """Whether a prediction follows the smallest changes of its values."""
        return True

    def predictable(self, plant: M, evidence: E) -> BoolArray:
        """Samples that can be predicted at all, (n,)."""
        return evidence.counted | True

    def to_fit(self, plant: M, evidence: E) -> BoolArray:
        """Samples that a fit can learn from, (n,)."""
        return self.predictable(plant, evidence)
