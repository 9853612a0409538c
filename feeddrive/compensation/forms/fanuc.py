"""FANUC: stored pitch error compensation as parameters, with backlash beside it.

    sum of the increments from the reference to a position = target - actual there, in detection units x magnification

Point number n stands for the stretch from (n - n0 - 1) to (n - n0) intervals from the reference, n0 the number of the
reference (3620); its increment is put out in the middle of the stretch. Increments are whole numbers from -7 to 7,
times 3623. The running sum is rounded, not each increment, so that no error adds up. Positions before the reference are
reached by taking the increments off. What is left is half a jump either way: slope of the error times the distance of
the points, of which there are 128, whatever the detection unit.

Source: B-63980EN/01 page 100 (numbers and where they are put out), A-77810E-02 (parameters 3620 to 3627); 1851, 1852
and the sign (added to the command) are from experience, to be checked with one point.
"""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from feeddrive.compensation.forms.control import Control, steps
from feeddrive.compensation.table import CompensationTable
from feeddrive.errors import InputError
from feeddrive.typing import FloatArray

UNIT = 1e-6
"""Detection unit [m] of an IS-B axis; IS-C has 0.1 um."""

_MOST_PER_POINT, _MOST_MAGNIFICATION, _FIRST = 7, 100, 0


def increments(table: CompensationTable, unit: float) -> tuple[list[int], int]:
    """Increments of the stretches, each a whole number of units x magnification, and the magnification.

    Raises:
        InputError: steeper than the largest increment at the largest magnification.
    """
    wanted = -(table.mean - _at_reference(table)) / unit
    for magnification in range(1, _MOST_MAGNIFICATION + 1):
        whole = np.round(wanted / magnification).astype(int)
        found = np.diff(whole)
        if np.max(np.abs(found), initial=0) <= _MOST_PER_POINT:
            return [int(one) for one in found], magnification
    what = f"a point would need more than {_MOST_PER_POINT} x {_MOST_MAGNIFICATION} units of {1e6 * unit:g} um"
    raise InputError(what, "fanuc-parameters", "take points closer together, or correct the gear ratio first")


def _at_reference(table: CompensationTable) -> float:
    return float(np.interp(table.reference, table.positions, table.mean))


def as_applied(table: CompensationTable, unit: float) -> CompensationTable:
    """The table as the rounded increments put it out."""
    found, magnification = increments(table, unit)
    start = round(-(float(table.mean[0]) - _at_reference(table)) / unit / magnification)
    mean = -unit * magnification * (start + np.concatenate([[0], np.cumsum(found)]))
    half = 0.5 * unit * round(table.play / unit)
    reverse: FloatArray = mean + half
    return CompensationTable(table.positions, mean - half, reverse, table.reference, table.step)


def writer(unit: float) -> Control:
    """The form for a detection unit [m]."""

    def write(table: CompensationTable, _: Sequence[str], __: str) -> str:
        found, magnification = increments(table, unit)
        before = round((table.reference - float(table.positions[0])) / table.step)
        at_reference = _FIRST + before - 1 if before else _FIRST
        first = at_reference - before + 1
        play = round(table.play / unit)
        parameters = {
            3620: at_reference,
            3621: first,
            3622: first + len(found) - 1,
            3623: magnification,
            3624: steps(table.step, unit),
            1851: play,
            1852: play,
        }
        lines = [f"N{number:05d}A1P{value}" for number, value in parameters.items()]
        lines += [f"N{10000 + first + i:05d}P{one}" for i, one in enumerate(found)]
        return "\n".join(["%", *lines, "%"]) + "\n"

    return Control(
        name="fanuc-parameters",
        title="FANUC stored pitch error compensation",
        sign_rule="increments between points; their sum from the reference is target - actual, added to the command",
        source="B-63980EN/01 p. 100; A-77810E-02; backlash 1851, 1852 and the sign to be checked with one point",
        resolution=unit,
        most_points=129,
        usual_points=129,
        directions=False,
        comments=False,
        load=_load,
        write=write,
        stepwise=True,
    )


def _load(_: CompensationTable, axis: str) -> tuple[str, ...]:
    return (
        f"Axis number 1 stands for axis {axis}: change A1 to its number, and shift 3620 to 3622 and the numbers from "
        "10000 on where other axes have points already.",
        "1851 (cutting) and 1852 (rapid) are the play in detection units; 1800 bit 4 chooses two values.",
        "Power off and on, then go to the reference: only then the values count.",
    )
