"""One case: recorded, diagnosed, and set beside the truth, as a record that is kept."""

from __future__ import annotations

import time
import traceback
from collections.abc import Sequence
from dataclasses import asdict
from typing import Any, cast

from feeddrive.diagnosis.diagnose import diagnose
from feeddrive.diagnosis.judging.result import Diagnosis
from feeddrive.effects.base import Effect as PackageEffect
from feeddrive.recording import Recording
from tests.generator.axis import AXES
from tests.generator.effects import Effect
from tests.recovery.suite import rivals
from tests.recovery.suite.bound import bounds
from tests.recovery.suite.cases import Case
from tests.recovery.suite.heat import HeatEffect, heat_recordings
from tests.recovery.suite.motion import motion_recordings, twins_without_effects
from tests.recovery.suite.planting import declared, in_the_package, is_warm_up, values_of
from tests.recovery.suite.truth import Prepared, prepare_pair

Record = dict[str, Any]
"""What is kept of a case, as JSON."""


def run(case: Case, with_rivals: bool = True) -> Record:
    """Do one case. What the diagnosis raises is kept as its result; nothing else may go wrong."""
    clock = _Clock()
    fitted, judged = recorded(case)
    clock.lap("recording")
    record: Record = {
        "label": case.label,
        "kind": case.kind,
        "machine": case.machine,
        "noise": case.noise,
        "size": case.size,
        "off": case.off,
        "planted": case.planted,
    }
    try:
        record |= found(case, *diagnose(declared(case.machine), [fitted], [judged]))
    except Exception:
        record |= {"raised": traceback.format_exc(), "found": [], "ambiguous": [], "after": {}}
    clock.lap("diagnosis")
    pair = prepare_pair(declared(case.machine), fitted, judged)
    record |= beside_the_truth(case, pair)
    clock.lap("truth")
    if with_rivals and rivals.installed():
        axis = AXES.get(case.machine)
        record["sparse"] = asdict(rivals.sparse(pair, axis))
        clock.lap("sparse regression")
        record["black box"] = {"after": rivals.black_box(pair, axis)}
        clock.lap("black box")
    return record | {"cpu": clock.laps}


def recorded(case: Case) -> tuple[Recording, Recording]:
    """The recordings to fit and to judge."""
    if is_warm_up(case.machine):
        return heat_recordings(case.machine, cast(tuple[HeatEffect, ...], case.effects), case.noise, case.seeds)
    effects = cast(tuple[Effect, ...], case.effects)
    return motion_recordings(case.machine, effects, case.noise, case.seeds, case.seconds, case.off)


def found(case: Case, result: Diagnosis, effects: Sequence[PackageEffect]) -> Record:
    """What the diagnosis says, and why it refused what was planted."""
    return {
        "refused": {refused.name: refused.reason for refused in result.refused if refused.name in case.planted},
        "found": [
            {
                "name": one.name,
                "place": effect.place or str(effect.port),
                "parameters": {k: {"value": p.value, "ci95": p.ci95} for k, p in one.parameters.items()},
            }
            for one, effect in zip(result.effects, effects, strict=False)
        ],
        # After the named ones stand tables of what no name explains.
        "tables": [effect.name for effect in effects[len(result.effects) :]],
        "ambiguous": [list(names) for names in result.ambiguous],
        "after": {channel.name: channel.after.rms for channel in result.channels},
    }


def beside_the_truth(case: Case, pair: Prepared) -> Record:
    """Errors of the declared and the true plant, and the bounds of the parameters.

    The floor is the true plant's error. Where the package cannot hold an effect, it is that of the same motion with
    nothing planted; where numbers are off, the true plant is the declared one with the true numbers, so again that.
    """
    true = [in_the_package(case.machine, effect.name, values_of(effect)) for effect in case.effects]
    known = [effect for effect in true if effect is not None]
    before, floor = pair.errors(known)
    if len(known) == len(case.effects) and not case.off:
        limits = bounds(pair.problem, known) if known else []
        named = {effect.name: limit for effect, limit in zip(known, limits, strict=True)}
        return {"before": before, "floor": floor, "floor of": "true plant", "bounds": named}
    effects = cast(tuple[Effect, ...], case.effects)
    twins = twins_without_effects(case.machine, effects, case.noise, case.seeds, case.seconds)
    floor = prepare_pair(declared(case.machine), *twins).errors(())[0]
    return {"before": before, "floor": floor, "floor of": "nothing planted", "bounds": {}}


class _Clock:
    """CPU seconds of this process, all its threads, by part."""

    def __init__(self) -> None:
        self.laps: dict[str, float] = {}
        self._last = time.process_time()

    def lap(self, name: str) -> None:
        """End a part."""
        now = time.process_time()
        self.laps[name] = round(now - self._last, 3)
        self._last = now
