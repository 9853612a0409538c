"""Which columns of a table of readings make which test.

| part | columns | remarks |
|---|---|---|
| -2 | `target`, `direction` (+1, -1), `deviation` or `position`; runs in their order, or numbered by `run` | |
| -2 | `target`, `up 1`, `down 1`, `up 2`, ... : deviations, or positions | `# readings = positions` |
| -3 | `time`, `target`, `deviation` | `# stop = 240 min`, when the axis stops |
| -3 | `time`, `at 0 mm`, `at 250 mm`, ... : deviations | `# stop = 240 min` |
| -4 | `angle`, `radius` or `radial` (radius less nominal), perhaps `direction` (+1 counter-clockwise) | `# radius` |
| -4 | `x`, `y`, perhaps `direction` | `# radius = 150 mm` |

Deviations are actual minus target. Every column but direction and run has its unit in brackets. Angles count from +x to
+y. Rows of a circle stand in their order in time.
"""

from __future__ import annotations

import re

import numpy as np

from feeddrive.errors import InputError
from feeddrive.metrology.measured.measurements import CircleTest, DriftTest, LinearTest
from feeddrive.metrology.measured.readings import Readings
from feeddrive.typing import FloatArray
from feeddrive.units.quantity import parse

_RUN = re.compile(r"(up|down) ?(\d+)")
_PLACE = re.compile(r"(?:deviation |error )?at (.+)")
STEEPEST = 0.1
"""Deviations over the travel that an axis has at most: as a table of compensation, a hundred times a poor screw's."""

SAME_TARGET = 1e-7
"""Targets that are nearer than this are one [m]: a tenth of what the finest control writes."""


def part_of(readings: Readings) -> int:
    """Which part of ISO 230 a table is for: 2, 3 or 4.

    Raises:
        InputError: none of the forms above.
    """
    names = set(readings.columns)
    if {"angle", "radius"} <= names or {"angle", "radial"} <= names or {"x", "y"} <= names:
        return 4
    if "time" in names and ("target" in names or any(_PLACE.fullmatch(name) for name in names)):
        return 3
    if "target" in names:
        return 2
    held = ", ".join(sorted(names))
    mend = "give target with up 1, down 1, ..., or time with at 0 mm, ..., or angle with radius; see docs/iso230.md"
    raise InputError(f"columns {held} make no test of ISO 230", readings.where, mend)


def linear_test(readings: Readings) -> LinearTest:
    """The readings of a positioning test.

    Raises:
        InputError: targets that were not approached alike, or fewer than two approaches.
    """
    targets = readings.si("target", "m")
    found: dict[tuple[float, int], list[float]] = {}
    runs = [(match, name) for name in readings.columns if (match := _RUN.fullmatch(name))]
    if runs:
        less = targets if readings.remarks.get("readings", "deviations").startswith("position") else np.zeros(1)
        for match, name in sorted(runs, key=lambda one: int(one[0][2])):
            side = 1 if match[1] == "up" else -1
            for target, deviation in zip(targets, readings.si(name, "m") - less, strict=True):
                found.setdefault((float(target), side), []).append(float(deviation))
    else:
        for target, side, deviation in zip(targets, *_long_form(readings, targets), strict=True):
            found.setdefault((_same(float(target), found), int(side)), []).append(float(deviation))
    return linear_test_of(found, readings.where)


def linear_test_of(found: dict[tuple[float, int], list[float]], where: str) -> LinearTest:
    """A positioning test of deviations by target and direction, approached alike.

    Raises:
        InputError: targets that were not approached alike.
    """
    sides = sorted({side for _, side in found}, reverse=True)
    targets = sorted({target for target, _ in found})
    counts = {len(found.get((target, side), [])) for target in targets for side in sides}
    if counts == {1}:
        mend = "approach every target twice at least: one reading of each tells nothing of how they scatter"
        raise InputError("every target is approached once", where, mend)
    if len(counts) != 1 or min(counts) < 2:
        most = max(counts, default=0)
        odd = next((t for t in targets for s in sides if len(found.get((t, s), [])) < max(2, most)), 0.0)
        what = f"targets are not approached alike: {1e3 * odd:g} mm less often than others"
        raise InputError(what, where, "approach every target as often, twice at least, from one side or from both")
    columns = {side: np.array([found[target, side] for target in targets]) for side in sides}
    means = np.array([float(np.mean([columns[side][i] for side in sides])) for i in range(len(targets))])
    if (span := float(np.ptp(means))) > STEEPEST * float(np.ptp(targets)):
        what = f"the deviations span {1e3 * span:.4g} mm over {1e3 * float(np.ptp(targets)):.4g} mm of travel"
        raise InputError(what, where, 'correct their unit; if they are positions, write "# readings = positions" above')
    return LinearTest(np.array(targets), columns.get(1), columns.get(-1))


def _long_form(readings: Readings, targets: FloatArray) -> tuple[FloatArray, FloatArray]:
    """Direction and deviation of each row."""
    if "direction" not in readings:
        raise InputError('no column "direction"', readings.where, "add direction [1]: 1 from below, -1 from above")
    sides = readings.si("direction", "1")
    if not np.isin(sides, (1.0, -1.0)).all():
        raise InputError("a direction is neither 1 nor -1", readings.where, "write 1 from below, -1 from above")
    deviation = readings.si("deviation", "m") if "deviation" in readings else readings.si("position", "m") - targets
    if "run" in readings:
        order = np.argsort(readings.si("run", "1"), kind="stable")
        targets[:], sides, deviation = targets[order], sides[order], deviation[order]
    return sides, deviation


def _same(target: float, found: dict[tuple[float, int], list[float]]) -> float:
    return next((one for one, _ in found if abs(one - target) < SAME_TARGET), target)


def drift_test(readings: Readings, stop: float | None) -> DriftTest:
    """The readings of a test of heating by moving an axis, which stops at `stop` [s].

    None is the time in the table's remark, or the last one. Raises InputError for a target that is read at fewer than
    two times.
    """
    times = readings.si("time", "s")
    wide = [(match[1], name) for name in readings.columns if (match := _PLACE.fullmatch(name))]
    if wide:
        places = [parse(text.replace(" ", ""), "m", readings.where, may_vanish=True) for text, _ in wide]
        series = [(place, times, readings.si(name, "m")) for place, (_, name) in zip(places, wide, strict=True)]
    else:
        targets, deviation = readings.si("target", "m"), readings.si("deviation", "m")
        rows = [(place, np.abs(targets - place) < SAME_TARGET) for place in np.unique(np.round(targets, 9))]
        series = [(float(place), times[at], deviation[at]) for place, at in rows]
    chosen = readings.remark("stop", "s") if stop is None else stop
    warm = {name: readings.si(name, "degC") for name in readings.columns if "temperature" in name and wide}
    return drift_test_of(series, chosen, warm, readings.where)


def drift_test_of(
    series: list[tuple[float, FloatArray, FloatArray]], stop: float | None, warm: dict[str, FloatArray], where: str
) -> DriftTest:
    """A test of drift from place, times and deviations of every target, brought to the times of the first.

    Raises:
        InputError: fewer than two targets or times.
    """
    series = sorted(series, key=lambda one: one[0])
    for place, at, _ in series:
        if len(at) < 2 or np.any(np.diff(at) <= 0):
            what = f"{len(at)} readings at {1e3 * place:g} mm, or their times do not ascend"
            raise InputError(what, where, "read every target twice at least, later rows later")
    if len(series) < 2:
        raise InputError("one target only", where, "read the error at two targets at least, near the ends")
    begin = max(float(at[0]) for _, at, _ in series)
    end = min(float(at[-1]) for _, at, _ in series)
    times = series[0][1]
    times = times[(times >= begin) & (times <= end)]
    if len(times) < 2:
        raise InputError("the targets have no time in common", where, "read them one after the other, again and again")
    error = np.column_stack([np.interp(times, at, values) for _, at, values in series])
    places = np.array([place for place, _, _ in series])
    seen = {name: values for name, values in warm.items() if len(values) == len(times)}
    return DriftTest(times - times[0], error - error[0], places, (end if stop is None else stop) - times[0], seen)


def circle_test(readings: Readings, radius: float | None) -> CircleTest:
    """The readings of a circular test, one path or one in each direction, of a nominal radius [m].

    None is that of the table's remark; InputError where there is none and only differences are given.
    """
    nominal = readings.remark("radius", "m") if radius is None else radius
    if "x" in readings:
        x, y = readings.si("x", "m"), readings.si("y", "m")
    else:
        angle = readings.si("angle", "rad")
        if "radius" in readings:
            length = readings.si("radius", "m")
        elif nominal is None:
            raise InputError("no nominal radius", readings.where, 'write "# radius = 150 mm" above, or give --radius')
        else:
            length = nominal + readings.si("radial", "m")
        x, y = length * np.cos(angle), length * np.sin(angle)
    if "direction" in readings:
        sides = readings.si("direction", "1")
        if not np.isin(sides, (1.0, -1.0)).all():
            what = "a direction is neither 1 nor -1"
            raise InputError(what, readings.where, "write 1 counter-clockwise, -1 clockwise")
        paths = []
        for side in (1.0, -1.0):
            path = x[sides == side], y[sides == side]
            if len(path[0]) and side * _turns(*path) < 0.0:
                what = f"the rows of direction {side:g} turn the other way"
                raise InputError(what, readings.where, "list them in their order in time, or correct the direction")
            paths += [path] if len(path[0]) else []
    else:
        paths = [(x, y)]
    return CircleTest(tuple(paths), nominal)


def _turns(x: FloatArray, y: FloatArray) -> float:
    """Twice the area that a path goes round, (n,) points: positive counter-clockwise."""
    x, y = x - np.mean(x), y - np.mean(y)
    return float(np.sum(x[:-1] * y[1:] - x[1:] * y[:-1]))
