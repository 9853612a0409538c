"""What the search needs to know of a kind of recording: how it is predicted, and which effects are tried.

Three kinds are known: motion and torque (`prediction`), temperatures and growth (`heat_prediction`), and logs of hours
with both (`heat.warm`). Search, fit, cross-validation and judging are the same for all of them.
"""

from __future__ import annotations

from abc import ABC, abstractmethod
from collections.abc import Sequence
from typing import TYPE_CHECKING, ClassVar, Generic, TypeVar

from feeddrive.diagnosis.likelihood.evidence import Evidence
from feeddrive.plant.plant import Plant
from feeddrive.simulate.driven import LoadMotion
from feeddrive.typing import BoolArray, FloatArray

if TYPE_CHECKING:
    from feeddrive.diagnosis.finding.scene import Candidate

CHANCE = 30.0
"""Degrees of freedom of the noise that the luckiest wrong candidate takes away: 2 ln K for the best of K = 10^4 trials
(orders, places, velocities) and two for each of its three parameters, and a fifth more."""


E = TypeVar("E", bound=Evidence)


class Predictor(ABC, Generic[E]):
    """Predicts recordings of one kind."""

    chance: ClassVar[float] = CHANCE
    """Degrees of freedom of the noise that the luckiest wrong candidate takes away."""

    @property
    def of_motion(self) -> bool:
        """Whether a motion is predicted sample by sample.

        Levels are compared between recordings then, what no name explains is carried as tables, and a closed loop can
        be simulated.
        """
        return False

    @property
    def answers_chain(self) -> bool:
        """Whether predictions depend on values of the chain and its friction: those are fitted within tolerances."""
        return self.of_motion

    @property
    @abstractmethod
    def candidates(self) -> tuple[Candidate, ...]:
        """Effects that are tried."""

    @abstractmethod
    def predict(self, plant: Plant, evidence: E) -> dict[str, FloatArray]:
        """Channel to its prediction, as it is compared, (n,), SI; not finite where it cannot be simulated."""

    def slopes(self, plant: Plant, evidence: E, numbers: Sequence[str]) -> dict[str, FloatArray] | None:
        """Channel to the exact slopes of its prediction, (n, k), with numbers of effects, (k,), as `label.key[i]`.

        None where slopes are taken by differences of predictions.
        """
        return None

    def load_motion(self, plant: Plant, evidence: E) -> LoadMotion | None:
        """Motion of the load side, where one is predicted."""
        return None

    @abstractmethod
    def variables(self, plant: Plant, evidence: E) -> dict[str, FloatArray]:
        """Variables that a residual may depend on, (n,) each, SI."""

    @abstractmethod
    def reference(self, name: str, plant: Plant, evidence: E) -> FloatArray:
        """Series of a channel whose rms a relative error refers to, over the judged samples."""

    def remarks(self, before: Plant, after: Plant) -> tuple[str, ...]:
        """Remarks on this way to predict, with the declared plant and with what was found."""
        return ()

    def smooth(self, plant: Plant) -> bool:
        """Whether a prediction follows the smallest changes of its values."""
        return True

    def predictable(self, plant: Plant, evidence: E) -> BoolArray:
        """Samples that can be predicted at all, (n,)."""
        return evidence.counted | True

    def to_fit(self, plant: Plant, evidence: E) -> BoolArray | FloatArray:
        """Samples that a fit can learn from, or their weights, (n,)."""
        return self.predictable(plant, evidence)
