"""ISG kernel and TwinCAT CNC: compensation value list of an axis (`achskw*.lis`), bilateral, points as they are.

Values and positions are whole tenths of a micrometre (`unit 1`), value = measured - programmed: programmed 19866.7 um,
measured 19856.5 um along + and 19874.7 um along -, gives pos -102 and neg 80. Straight between, constant beyond; on
reversal the value goes over within `lr_param.n_backlash_cyc` cycles, fewer than 20, by sin^2.

Source: ISG kernel documentation, example of a compensation value list (113439115) and leadscrew error compensation
(308687883); Beckhoff TF5200, axis compensation (308695435), P-AXIS-00243 (308693899).
"""

from __future__ import annotations

from collections.abc import Sequence

from feeddrive.compensation.forms.control import Control, Reversal, comments, steps
from feeddrive.compensation.table import CompensationTable

_UNIT = 1e-7
_CYCLES, _MOST_CYCLES = 10, 19


def _write(table: CompensationTable, head: Sequence[str], axis: str) -> str:
    def line(key: str, value: object) -> str:
        return f"{key:<36} {value}"

    rows = [steps(float(one), _UNIT) for one in table.positions]
    pos, neg = ([steps(float(one), _UNIT) for one in way] for way in (table.forward, table.reverse))
    lines = [
        *comments(head),
        line("kopf.log_achs_name", axis),
        line("kw.ssfk.interval", 0),
        line("kw.ssfk.kw_startpos", rows[0]),
        line("kw.ssfk.kw_nr_max", len(rows)),
        line("kw.ssfk.unit", 1),
        line("kw.ssfk.bilateral", 1),
        *(line(f"kw.ssfk.table[{i}].setpoint", one) for i, one in enumerate(rows)),
        *(line(f"kw.ssfk.table[{i}].pos", one) for i, one in enumerate(pos)),
        *(line(f"kw.ssfk.table[{i}].neg", one) for i, one in enumerate(neg)),
    ]
    return "\n".join(lines) + "\n"


def _load(_: CompensationTable, axis: str) -> tuple[str, ...]:
    return (
        f"Write kopf.achs_nr with the logical number of axis {axis} in front, as in the list of your start-up.",
        "In the axis parameter list: lr_param.ssfk 1; no backlash beside it.",
    )


def _setting(_: CompensationTable, __: str, reversal: Reversal) -> str:
    return f"lr_param.n_backlash_cyc {reversal.cycles}: position cycles over which the play goes over on reversal."


ISG = Control(
    name="isg",
    title="ISG kernel / TwinCAT CNC (ssfk, bilateral)",
    sign_rule="value = measured - programmed (actual - target), 0.1 um; the control takes it off the set-point",
    source="ISG kernel 113439115 and 308687883, worked example; Beckhoff TF5200 308695435",
    resolution=_UNIT,
    most_points=1500,
    usual_points=1500,
    reversal=Reversal(cycles=_CYCLES, smooth=True, longest=1.0, most_cycles=_MOST_CYCLES, setting=_setting),
    load=_load,
    write=_write,
)
