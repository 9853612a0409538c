"""Recordings with something in them that no effect has a name for, and what is said of it."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from feeddrive.diagnosis.judging.judge import Judged, channel_results, prepared_for_judging
from feeddrive.diagnosis.judging.result import ChannelResult
from feeddrive.diagnosis.likelihood.problem import Problem
from feeddrive.diagnosis.motion.prediction import AxisPredictor
from feeddrive.diagnosis.motion.preparing import prepare
from feeddrive.diagnosis.unexplained.unexplained import Rest, explain_rest
from feeddrive.diagnosis.unexplained.unexplained_result import Dependence
from feeddrive.recording import Recording
from tests.generator.axis import AXES
from tests.generator.effects import Effect
from tests.generator.pair import Channels, recording_pair
from tests.recovery.planted import axis_plant

SECONDS = (8.0, 6.5)


@dataclass(frozen=True)
class Said:
    """What is said of a pair of recordings without a search for named effects.

    Attributes:
        rest: what is left of the declared plant.
        before, after: channel to its error without and with what is carried.
    """

    rest: Rest
    before: dict[str, ChannelResult]
    after: dict[str, ChannelResult]

    def first(self, channel: str) -> Dependence:
        """The strongest dependence of a channel."""
        return self.rest.unexplained[channel].depends_on[0]

    def over_floor(self, channel: str) -> float:
        """Error with what is carried over the noise floor."""
        above = self.rest.unexplained[channel].above
        assert above is not None
        return self.after[channel].after.rms / above.floor


def recording(channels: Channels, name: str) -> Recording:
    """What the generator made, as a recording."""
    rest = {key: series for key, series in channels.items() if key != "time"}
    return Recording(name, channels["time"], rest, float(channels["time"][1] - channels["time"][0]))


def said_of(
    axis: str, effects: Sequence[Effect], seeds: tuple[int, int], seconds: tuple[float, float] = SECONDS,
    noise_factor: float = 1.0,
) -> Said:  # fmt: skip
    """Make the recordings and take what the declared plant leaves apart."""
    pair = recording_pair(AXES[axis], effects, seeds, seconds, noise_factor)
    fitted, judged = (recording(one, name) for one, name in zip(pair, ("train", "validate"), strict=True))
    plant = axis_plant(axis)
    problem = Problem(plant, (prepare(fitted, plant, 1.0),), AxisPredictor())
    ready: list[Judged] = [prepared_for_judging(problem, prepare(judged, plant, 0.0), plant, plant)]
    before = channel_results(problem, ready)
    rest = explain_rest(problem, (), ready, before)
    after = channel_results(problem, rest.judged)
    return Said(rest, {one.name: one for one in before}, {one.name: one for one in after})


def curve(one: Dependence, at: np.ndarray) -> np.ndarray:
    """The table of a dependence at some values of its variable."""
    assert one.table is not None
    return np.interp(at, one.table.breakpoints, one.table.values)
