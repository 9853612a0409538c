"""Numbers of a test after ISO 230-3: heating by moving a linear axis, then cooling down.

At targets near both ends of the travel (and in between) the error is logged while the axis goes to and fro, and after.

| number | meaning |
|---|---|
| first hour | range of the error within the first 60 min |
| heating | range of the error until the axis stops |
| whole | range of the error over the whole test |
| largest | error of the largest magnitude, with its sign |
| settling | time after which the error stays within 5 % of its range while heating, of the value at the stop |
| slope | difference of the errors of last and first target at the stop, over their distance |

The standard's 2020 edition asks for the changes and the diagrams; the 5 % of `settling` are this program's choice.
Source of the procedure: ISO 230-3:2020, test of moving linear axes; no text of the standard is used.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from feeddrive.errors import InputError
from feeddrive.metrology.finite import refuse_unknown
from feeddrive.typing import FloatArray

_BAND = 0.05
_HOUR = 3600.0


@dataclass(frozen=True)
class TargetHeating:
    """Numbers of one target.

    Attributes:
        position: of the target [m].
        first_hour, heating, whole: ranges of the error [m].
        largest: error of the largest magnitude, signed [m].
        settling: [s]; the stop where it only settles there.
    """

    position: float
    first_hour: float
    heating: float
    whole: float
    largest: float
    settling: float


@dataclass(frozen=True)
class AxisHeating:
    """Numbers of a test.

    Attributes:
        targets: of each target.
        slope: at the stop [m/m].
    """

    targets: tuple[TargetHeating, ...]
    slope: float


def axis_heating(times: FloatArray, error: FloatArray, positions: FloatArray, stop: float) -> AxisHeating:
    """Evaluate a test: errors (k, p) [m] at ascending times (k,) [s] and two or more ascending positions (p,) [m].

    The error at time 0 counts as zero; the axis stops at `stop` [s]. Raises InputError: shapes that do not fit, times
    that do not ascend, or a stop before an hour or after the last time.
    """
    fits = np.shape(error) == (len(times), len(positions)) and len(positions) >= 2
    if not fits or np.any(np.diff(times) <= 0) or np.any(np.diff(positions) <= 0):
        what = f"errors of shape {np.shape(error)} at {len(times)} times and {len(positions)} positions"
        raise InputError(what, "error", "give a row a time and a column a target, times and targets ascending")
    refuse_unknown("axis heating", times=times, error=error, positions=positions)
    if not _HOUR <= stop <= times[-1]:
        what = f"the axis stops after {stop / 60:.4g} min of {times[-1] / 60:.4g} min"
        raise InputError(what, "stop", "heat for an hour at least, within the test")
    targets = tuple(_target(times, column, float(x), stop) for column, x in zip(error.T, positions, strict=True))
    last = error[np.searchsorted(times, stop * (1 + 1e-12), side="right") - 1]
    return AxisHeating(targets, float((last[-1] - last[0]) / (positions[-1] - positions[0])))


def _target(times: FloatArray, error: FloatArray, position: float, stop: float) -> TargetHeating:
    times, error = np.append(0.0, times), np.append(0.0, error)
    heated, first = times <= stop * (1 + 1e-12), times <= _HOUR * (1 + 1e-12)
    heating = float(np.ptp(error[heated]))
    last = error[heated][-1]
    outside = np.flatnonzero(np.abs(error[heated] - last) > _BAND * heating)
    settling = float(times[outside[-1] + 1]) if len(outside) else 0.0
    largest = float(error[np.argmax(np.abs(error))])
    return TargetHeating(position, float(np.ptp(error[first])), heating, float(np.ptp(error)), largest, settling)
