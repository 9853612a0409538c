"""Heidenhain: the columns of a compensation value table (*.COM) as CSV, to be typed or imported into the control.

AXISPOS counts from the machine datum; the column of the axis holds values of positive, BACKLASH those of negative
traverse [mm]. A value may change by 1/64 of the distance of two points. The byte layout of the control's own table
file and the sign of its values stand in no page at hand: this is no *.COM file, and the check of one point decides.

Source: MANUALplus 620 Technical Manual, pages 708, 716 to 718; TNC 407 Technical Manual, pages 153 to 156 and 622
(256 entries a table); iTNC 530 HSCI, page 650 (backlash spread over MP752, 0 to 1000 ms, 15 ms in its example).
"""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from feeddrive.compensation.forms.control import Control, Reversal, comments, millimetres
from feeddrive.compensation.table import CompensationTable


def _write(table: CompensationTable, head: Sequence[str], axis: str) -> str:
    rows = np.column_stack([table.positions, table.reverse, table.forward])
    lines = [*comments(head), f"AXISPOS,BACKLASH,{axis}"]
    lines += [",".join(millimetres(float(one), 4) for one in row) for row in rows]
    return "\n".join(lines) + "\n"


def _load(_: CompensationTable, axis: str) -> tuple[str, ...]:
    return (
        f"Make a table *.COM of these columns in the control's table editor, and enter it in column {axis} of "
        "config.CMA; mark that line ACTIVE with *. An old TNC also needs MP730, and points a power of two apart.",
        "Backlash in MP750 must be 0 where BACKLASH is filled; leave that column out if the control has none.",
    )


def _setting(_: CompensationTable, __: str, reversal: Reversal) -> str:
    return f"MP752 (MP_filterTime) = {1e3 * reversal.spread:.1f} ms: time over which the backlash goes over."


HEIDENHAIN = Control(
    name="heidenhain-csv",
    title="Heidenhain *.COM table (as CSV)",
    sign_rule="value = actual - target; the manual's pages do not say the sign: check one point, and turn all if wrong",
    source="MANUALplus 620 Technical Manual p. 716-718; TNC 407 Technical Manual p. 153-156, 622",
    resolution=1e-7,
    most_points=256,
    usual_points=256,
    steepest=1 / 64,
    reversal=Reversal(spread=0.015, longest=1.0, setting=_setting),
    load=_load,
    write=_write,
)
