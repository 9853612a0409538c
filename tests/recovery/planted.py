"""The planted pairs of recordings, how a diagnosis of one is judged against the truth, and a line about it."""

from __future__ import annotations

import math
import tomllib
from collections.abc import Sequence
from dataclasses import dataclass
from functools import cache
from pathlib import Path
from typing import Any

from feeddrive.diagnosis.diagnose import diagnose
from feeddrive.diagnosis.judging.judge import channel_results, prepared_for_judging
from feeddrive.diagnosis.judging.result import ChannelResult, Diagnosis, EffectResult
from feeddrive.diagnosis.likelihood.problem import Problem
from feeddrive.diagnosis.motion.prediction import AxisPredictor
from feeddrive.diagnosis.motion.preparing import prepare
from feeddrive.effects.base import Effect
from feeddrive.files import plants_folder
from feeddrive.plant.file.plant_file import read_plant
from feeddrive.plant.plant import Plant
from feeddrive.recording import Recording, read_recording
from tests.recovery.suite.planting import in_the_package

DATA = Path(__file__).resolve().parents[1] / "data"

Truth = dict[str, dict[str, dict[str, dict[str, Any]]]]

TRUTH: Truth = tomllib.loads((DATA / "truth.toml").read_text(encoding="utf-8"))
"""Axis, case, effect, parameter: what was planted (SI)."""

# Not a parameter of the law in the contract: where the bristle begins to slide; a tenth of it hardly shows.
NOT_COMPARED = ("break_away",)

# What the task asks for: sizes to a tenth, an order half a percent, a phase 0.15 rad.
SIZE, ORDER, PHASE = 0.10, 0.005, 0.15

# A position to a twentieth of the stroke, which is 16 revolutions of 20 mm in every bench recording.
POSITION = 0.05 * 0.32

# After the effects the error is that of the true plant, or of a recording with nothing planted, but for a fifth: the
# motion differs by case.
WORSE_THAN_NULL = 1.2

LARGEST_SET = 3


@dataclass(frozen=True)
class Verdict:
    """A diagnosis beside the truth.

    Attributes:
        result: the diagnosis.
        planted: effect to its parameters (SI); empty for a null.
        null: channel to the error of the true plant, or of the axis with nothing planted.
    """

    result: Diagnosis
    planted: dict[str, dict[str, Any]]
    null: dict[str, ChannelResult]

    @property
    def found(self) -> list[str]:
        """Names in the order found."""
        return [effect.name for effect in self.result.effects]

    @property
    def misses(self) -> list[str]:
        """What is wrong, in words; empty where the diagnosis holds."""
        return [*self._name_misses(), *self._parameter_misses(), *self._error_misses()]

    def _name_misses(self) -> list[str]:
        wanted = list(self.planted)
        if self.found == wanted:
            return []
        named_with_others = any(wanted[0] in names for names in self._sets()) if wanted else False
        if len(self.found) == len(wanted) and named_with_others:
            return []
        return [f"found {self.found or 'nothing'}, planted {wanted or 'nothing'}"]

    def _sets(self) -> list[tuple[str, ...]]:
        return [names for names in self.result.ambiguous if len(names) <= LARGEST_SET and names[0] in self.found]

    def _parameter_misses(self) -> list[str]:
        misses = []
        for effect in self.result.effects:
            for key, value in self.planted.get(effect.name, {}).items():
                if key not in NOT_COMPARED and not close(key, effect.parameters[key].value, value):
                    misses.append(f"{key} {effect.parameters[key].value:.5g} for {value:.5g}")
        return misses

    def _error_misses(self) -> list[str]:
        ratios = self.error_ratios()
        return [f"{name} error {ratio:.2f} x null's" for name, ratio in ratios.items() if ratio > WORSE_THAN_NULL]

    def error_ratios(self) -> dict[str, float]:
        """Channel to its error after the effects (rms) over that of the null."""
        return {c.name: c.after.rms / self.null[c.name].after.rms for c in self.result.channels}

    def line(self, case: str) -> str:
        """One row of the table of results."""
        effects = "; ".join(self._in_words(effect) for effect in self.result.effects) or "nothing"
        ratios = ", ".join(f"{name.split('_')[0]} {ratio:.2f}" for name, ratio in self.error_ratios().items())
        also = f" | ambiguous {self.result.ambiguous}" if self.result.ambiguous else ""
        return f"{case:28s} | {effects} | error/null {ratios}{also} | {'; '.join(self.misses) or 'held'}"

    def _in_words(self, effect: EffectResult) -> str:
        truth = self.planted.get(effect.name)
        if truth is None:
            return f"{effect.name} (not planted)"
        pairs = [f"{key} {shown(effect.parameters[key].value)}/{shown(value)}" for key, value in truth.items()]
        return f"{effect.name} {', '.join(pairs)}"


def shown(value: Any) -> str:
    """A parameter as the table shows it."""
    return f"{value:.4g}" if isinstance(value, (int, float)) else str(value)


def close(key: str, found: Any, planted: Any) -> bool:
    """Whether a parameter is found as nearly as is asked for."""
    if isinstance(planted, str):
        return bool(found == planted)
    difference: float = float(found) - float(planted)
    if key == "phase":
        return abs(math.remainder(difference, 2 * math.pi)) <= PHASE
    if key == "order":
        return abs(difference) <= ORDER * float(planted)
    if key == "centre":
        return abs(difference) <= POSITION
    return abs(difference) <= SIZE * abs(float(planted))


def pair(axis: str, case: str) -> tuple[Recording, Recording]:
    """The recordings to fit and to judge."""
    fitted, judged = (read_recording(DATA / axis / f"{case}_{part}.csv.gz") for part in ("train", "validate"))
    return fitted, judged


def axis_plant(axis: str) -> Plant:
    """The declared plant of an axis."""
    return read_plant(plants_folder() / f"{axis}_axis.toml")


@cache
def null_errors(axis: str) -> dict[str, ChannelResult]:
    """Error of the declared plant on the recording with nothing planted, without a search."""
    plant, (_, judged) = axis_plant(axis), pair(axis, "null")
    return declared_errors(plant, judged)


def declared_errors(plant: Plant, recording: Recording, planted: Sequence[Effect] = ()) -> dict[str, ChannelResult]:
    """Error per channel of a plant on all of a recording: as declared, or with what was planted."""
    evidence = prepare(recording, plant, 0.0)
    problem = Problem(plant, (evidence,), AxisPredictor())
    true = plant.with_effects(*planted)
    results = channel_results(problem, [prepared_for_judging(problem, evidence, plant, true)])
    return {result.name: result for result in results}


def true_errors(axis: str, case: str) -> dict[str, ChannelResult]:
    """Error of the plant with what was planted: play magnifies the encoder's noise, which no diagnosis can undo."""
    effects = [in_the_package(axis, name, values) for name, values in TRUTH[axis][case].items()]
    assert None not in effects
    return declared_errors(axis_plant(axis), pair(axis, case)[1], [effect for effect in effects if effect is not None])


def verdict(axis: str, case: str) -> Verdict:
    """Diagnose a planted pair."""
    fitted, judged = pair(axis, case)
    result, _ = diagnose(axis_plant(axis), [fitted], [judged])
    return Verdict(result, TRUTH[axis][case], true_errors(axis, case))
