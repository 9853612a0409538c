"""Which further number would tell most of the values that are still open.

    I = ½ log2((J_m C J_m' + s²) / (J_u C_u J_u' + s²))     [bit]

| symbol | meaning |
|---|---|
| C | covariance of all values, given what was measured, over all sets: within and between them |
| C_u | that of the values that no measured number sees; they blur the further number and are not asked for |
| J_m, J_u | slope of the further number with all values, and with those |
| s | its usual standard deviation |

Source: Lindley, Ann. Math. Statist. 27 (1956) 986 (information of an experiment).
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from feeddrive.diagnosis.numbers.explanations import Explanation, NumbersProblem
from feeddrive.diagnosis.numbers.measured_file import FREE, HELD, MEASURABLE, MeasuredNumber, Setting
from feeddrive.errors import InputError
from feeddrive.plant.plant import Plant
from feeddrive.typing import FloatArray


@dataclass(frozen=True)
class NextNumber:
    """A further measurement.

    Attributes:
        name: quantity and where; or, of one part, its words.
        how: what to do at the machine; empty where the name says it.
        information: [bit].
        expected: value and standard deviation as it is expected now [unit].
        unit: SI.
    """

    name: str
    how: str
    information: float
    expected: tuple[float, float]
    unit: str


def next_numbers(problem: NumbersProblem, found: Sequence[Explanation]) -> tuple[NextNumber, ...]:
    """Further measurements, the one that tells most first: numbers along the stroke, and each part by itself."""
    mean, covariance = mixed(found)
    rows = [_of_part(problem, place, mean, covariance) for place in problem.seen]
    unseen = [place for place in range(len(problem.values)) if place not in problem.seen]
    numbers = _numbers(problem)
    if numbers:
        expected, slopes = problem.predicted(mean, numbers), problem.slopes(mean, numbers)
        for number, value, slope in zip(numbers, expected, slopes, strict=True):
            spread = float(slope @ covariance @ slope)
            blur = float(slope[unseen] @ covariance[np.ix_(unseen, unseen)] @ slope[unseen])
            noise = math.hypot(0.5 * number.kind.tolerance * value, math.sqrt(max(blur, 0.0)))
            about = (float(value), math.sqrt(spread))
            rows.append(NextNumber(number.name, "", _bits(spread - blur, noise), about, number.kind.unit))
    return tuple(sorted(rows, key=lambda one: -one.information))


def mixed(found: Sequence[Explanation]) -> tuple[FloatArray, FloatArray]:
    """Mean and covariance of the coordinates over all sets, (k,) and (k, k)."""
    weights = np.array([one.probability for one in found])
    means = np.array([one.coordinates for one in found])
    mean = weights @ means
    inside = np.einsum("s,sij->ij", weights, np.array([one.covariance for one in found]))
    return mean, inside + (means - mean).T @ (weights[:, None] * (means - mean))


def _bits(spread: float, noise: float) -> float:
    return 0.5 * math.log2(1 + max(spread, 0.0) / noise**2)


def _of_part(problem: NumbersProblem, place: int, mean: FloatArray, covariance: FloatArray) -> NextNumber:
    """One value measured by itself, to 5 %: a gauge of 1 µm over some 20 µm."""
    value = problem.values[place]
    spread = float(covariance[place, place])
    now = value.number(float(mean[place]))
    deviation = math.sqrt(spread) * (now if now is not None else math.inf)
    expected = (now, deviation) if now is not None else (math.inf, math.inf)
    return NextNumber(value.words, value.settled_by, _bits(spread, 0.025), expected, value.unit)


def _numbers(problem: NumbersProblem) -> list[MeasuredNumber]:
    """Numbers that could be measured beside those that were, where the plant gives them."""
    plant = problem.plant
    ends = plant.stroke or (plant.middle, plant.middle)
    places = sorted({ends[0], plant.middle, ends[1]}) if plant.chain.varies else [plant.middle]
    settings = [("axial_stiffness", Setting(at)) for at in places]
    settings += [
        ("natural_frequency", Setting(at, motor, mode)) for at in places for motor in (HELD, FREE) for mode in (1, 2)
    ]
    settings += [("drag_torque", Setting(plant.middle, velocity=v)) for v in (1e-3, 0.1)]
    settings += [(name, Setting(plant.middle)) for name in ("lost_motion", "inertia_at_motor")]
    known = {one.name for one in problem.measured}
    found = [MeasuredNumber(name, 1.0, 1.0, setting, "") for name, setting in settings]
    return [one for one in found if one.name not in known and _is_given(plant, one)]


def _is_given(plant: Plant, number: MeasuredNumber) -> bool:
    try:
        return MEASURABLE[number.quantity].of(plant, number.setting) > 0
    except InputError:
        return False
