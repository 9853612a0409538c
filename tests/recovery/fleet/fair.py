"""Whether a planted effect can be told: from nothing, from declared values within tolerance, from another effect.

    python -m tests.recovery.fleet.fair SEED ...

The change that an effect makes in torque and position under the recorded motion, over the density of what the true
plant misses when it is led by the recorded angle, is regressed on the changes that declared values within their
tolerance make (one tolerance is one standard deviation), and then on that of one other effect beside, its size free.
What is left is in standard deviations: below about five, no method can tell the one from the other.
"""

from __future__ import annotations

import math
import sys
from dataclasses import dataclass

import numpy as np

from tests.generator.drawn_effects import MAKERS, are_possible, drawn_effect
from tests.generator.effects import Effect
from tests.generator.machines import Machine
from tests.generator.runs import Run, changes
from tests.generator.telling import distance, missed, simulated_calibration, whitened
from tests.recovery.fleet.case import Case, case

BY_ORDER = ("torque_ripple", "ball_pass_ripple", "lead_error_periodic")
"""Effects whose order tells them from all others."""

VARIANTS = {"stribeck": 3, "presliding": 2, "structural_mode": 3, "friction_vs_position": 4, "backlash": 2}
"""How many of a kind with a shape of its own are tried."""


@dataclass(frozen=True)
class Told:
    """How far a planted effect is from nothing, from declared values that are off, and from its nearest rival.

    All in standard deviations of the noise. rival: name.
    """

    name: str
    from_nothing: float
    from_declared: float
    from_rival: float
    rival: str


def told_apart(drawn: Case) -> list[Told]:
    """Return it for every planted effect of a case, on the recording that is fitted."""
    run, machine = drawn.runs[0], drawn.true
    effects = run.effects
    floor = missed(run, drawn.seed)
    base = simulated_calibration(run, floor)
    found = []
    for one in drawn.planted:
        without = tuple(other for other in effects if other.name != one.effect.name)
        target = whitened(floor, *changes(run, without))
        least, nearest = math.inf, ""
        for rival in rivals(machine, {planted.name for planted in effects}, drawn.seed, run):
            if not are_possible([rival], machine):
                continue
            with_rival = changes(run, (*without, rival))
            column = target - whitened(floor, *with_rival)
            left = distance(target, np.column_stack([base, column]), free=1)
            if left < least:
                least, nearest = left, rival.name
        found.append(
            Told(one.effect.name, float(np.linalg.norm(target)), distance(target, base, free=0), least, nearest)
        )
    return found


def rivals(machine: Machine, names: set[str], seed: int, run: Run) -> list[Effect]:
    """Return effects of other names, some in several shapes."""
    random = np.random.default_rng([seed, 17])
    seconds = len(run.torque) * machine.axis.sample_time
    result = []
    for other in MAKERS:
        if other in names or other in BY_ORDER:
            continue
        for _ in range(VARIANTS.get(other, 1)):
            drawn = drawn_effect(other, machine, random, seconds, False)
            assert drawn is not None
            result.append(drawn.effect)
    return result


def main() -> int:
    """Print a line for every planted effect of some seeds."""
    for text in sys.argv[1:]:
        for told in told_apart(case(int(text))):
            print(
                f"{text}: {told.name} {told.from_nothing:.0f} sigma from nothing, {told.from_declared:.0f} from "
                f"declared values within tolerance, {told.from_rival:.1f} from {told.rival}",
                flush=True,
            )
    return 0


if __name__ == "__main__":
    sys.exit(main())
