"""The internal table as CSV, for everything else: ISO 230-2's sign, both directions."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from feeddrive.compensation.forms.control import Control, Reversal, comments, millimetres
from feeddrive.compensation.table import CompensationTable


def _write(table: CompensationTable, head: Sequence[str], _: str) -> str:
    rows = np.column_stack([table.positions, 1e3 * table.forward, 1e3 * table.reverse])
    lines = [*comments(head), "position [mm],forward [um],reverse [um]"]
    lines += [f"{millimetres(x, 6)},{millimetres(a, 3)},{millimetres(b, 3)}" for x, a, b in rows.tolist()]
    return "\n".join(lines) + "\n"


def _load(_: CompensationTable, axis: str) -> tuple[str, ...]:
    return (f"A control that adds to the command of {axis} takes the negative; one that takes off takes it as it is.",)


def _setting(_: CompensationTable, __: str, reversal: Reversal) -> str:
    return f"On reversal go over from one column to the other within {1e3 * reversal.spread:.1f} ms."


CSV = Control(
    name="csv",
    title="a control that takes straight lines off its set-point, per direction",
    sign_rule="value = actual - target (ISO 230-2); forward: approached along +, reverse: along -",
    source="ISO 230-2:2014, clause 3, deviation of position",
    resolution=1e-9,
    most_points=20_000,
    usual_points=1000,
    reversal=Reversal(longest=1.0, setting=_setting),
    load=_load,
    write=_write,
)
