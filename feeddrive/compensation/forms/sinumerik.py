"""SINUMERIK: leadscrew error compensation (ENC_COMP) and compensation per direction (CEC).

ENC_COMP holds one value a position, straight between the points and constant beyond; it is added to the actual value
of the encoder. "A positive compensation value causes the corresponding machine axis to move in the negative direction":
value = actual - target. The axis must be referenced; the value at the reference point should be 0. Play is a value of
its own: MD32450 BACKLASH goes over at once, MD32456 BACKLASH_DYN, half of it with the sign of the direction, by a ramp
of the velocity MD32457 (per cent of MD32000) while the PLC asks for it (DB31 DBX25.0).

CEC acts on the set-point: table 0 in positive, table 1 in negative direction, straight between, constant beyond. Its
sign stands in no page at hand; two public generators write target - actual, which is what the set-point lacks. The
check of one point decides.

Source: SINUMERIK Extended Functions 6FC5397-1BP40-3BA1, pages 242 (ENC_COMP), 234 (BACKLASH_DYN), 248, 249, 264 (CEC);
SINUMERIK 808D Function Manual 01/2017, page 106 (sign); 808D ADVANCED Parameter Manual 08/2013, page 229 (MD32457).
"""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from feeddrive.compensation.forms.control import Control, Reversal, Side, comments, millimetres
from feeddrive.compensation.table import CompensationTable
from feeddrive.typing import FloatArray

_DIGITS = 4
_ENCODER = 0
"""Index of the measuring system; 0 is the first, the motor's where there are two."""


def _number(value: float) -> str:
    """A position in mm as short as it is exact."""
    text = millimetres(value, 6).rstrip("0")
    return f"{text}0" if text.endswith(".") else text


def _write_encoder(table: CompensationTable, head: Sequence[str], axis: str) -> str:
    values = [f"$AA_ENC_COMP[{_ENCODER},{i},{axis}]={millimetres(one, _DIGITS)}" for i, one in enumerate(table.mean)]
    lines = [
        "%_N_AX_EEC_INI",
        *comments(head, ";"),
        "CHANDATA(1)",
        *values,
        f"$AA_ENC_COMP_STEP[{_ENCODER},{axis}]={_number(table.step)}",
        f"$AA_ENC_COMP_MIN[{_ENCODER},{axis}]={_number(float(table.positions[0]))}",
        f"$AA_ENC_COMP_MAX[{_ENCODER},{axis}]={_number(float(table.positions[-1]))}",
        f"$AA_ENC_COMP_IS_MODULO[{_ENCODER},{axis}]=0",
        "M17",
    ]
    return "\n".join(lines) + "\n"


def _write_cec(table: CompensationTable, head: Sequence[str], axis: str) -> str:
    blocks = [
        _cec_block(table, values, axis, number, way)
        for number, (values, way) in enumerate(((table.forward, 1), (table.reverse, -1)))
    ]
    lines = ["%_N_NC_CEC_INI", *comments(head, ";"), "CHANDATA(1)", *blocks[0], *blocks[1], "M17"]
    return "\n".join(lines) + "\n"


def _cec_block(table: CompensationTable, values: FloatArray, axis: str, number: int, direction: int) -> list[str]:
    written = np.negative(values)
    return [
        *(f"$AN_CEC[{number},{i}]={millimetres(float(one), _DIGITS)}" for i, one in enumerate(written)),
        f"$AN_CEC_INPUT_AXIS[{number}]=({axis})",
        f"$AN_CEC_OUTPUT_AXIS[{number}]=({axis})",
        f"$AN_CEC_STEP[{number}]={_number(table.step)}",
        f"$AN_CEC_MIN[{number}]={_number(float(table.positions[0]))}",
        f"$AN_CEC_MAX[{number}]={_number(float(table.positions[-1]))}",
        f"$AN_CEC_DIRECTION[{number}]={direction}",
        f"$AN_CEC_MULT_BY_TABLE[{number}]=0",
        f"$AN_CEC_IS_MODULO[{number}]=0",
    ]


def _load_encoder(table: CompensationTable, axis: str) -> tuple[str, ...]:
    return (
        f"MD38000 $MA_MM_ENC_COMP_MAX_POINTS[{_ENCODER},{axis}] must be {len(table)} or more (8 bytes a point; an 808D "
        "has 200); it reorganises the memory, so set it first and save.",
        f"MD32700 $MA_ENC_COMP_ENABLE[{_ENCODER},{axis}] = 0 while loading, then 1; reference the axis.",
    )


def _setting_encoder(table: CompensationTable, axis: str, reversal: Reversal) -> str:
    play, place = millimetres(table.play, _DIGITS), f"[{_ENCODER},{axis}]"
    if not reversal.spread:
        return f"MD32450 $MA_BACKLASH{place} = {play} mm, set by hand: the play."
    speed = 60e3 * table.play / reversal.spread
    return (
        f"The play, set by hand: MD32456 $MA_BACKLASH_DYN{place} = {play} mm, which goes over by a ramp, MD32457 "
        f"$MA_BACKLASH_DYN_MAX_VELO = {speed:.3g} mm/min as a percentage of MD32000 (within "
        f"{1e3 * reversal.spread:.1f} ms), DB31 DBX25.0 = 1, MD32450 = 0. A control without MD32456 takes MD32450 = "
        f"{play} mm, which goes over at once."
    )


def _load_cec(table: CompensationTable, axis: str) -> tuple[str, ...]:
    return (
        f"MD18342 $MN_MM_CEC_MAX_POINTS[0] and [1] must be {len(table)} or more (828D 200, 802D sl 350 a table).",
        f"$SN_CEC_TABLE_ENABLE[0] and [1] = 0 while loading, then 1; MD32710 $MA_CEC_ENABLE[{axis}] = 1; reference.",
        f"MD32450 $MA_BACKLASH of {axis} must be 0: the two tables hold the play.",
    )


SINUMERIK_ENC = Control(
    name="sinumerik-enc",
    title="SINUMERIK leadscrew error compensation (ENC_COMP)",
    sign_rule="value = actual - target; it is added to the actual value, so that a positive one moves the axis to -",
    source="6FC5397-1BP40-3BA1 p. 242; 808D Function Manual 01/2017 p. 106",
    resolution=1e-7,
    most_points=5000,
    usual_points=801,  # as in the manual's example; an 808D has 200, which the sheet says
    steepest=0.01,  # MD32760 COMP_ADD_VELO_FACTOR, 1 % of the axis' velocity
    side=Side.ACTUAL,
    reversal=Reversal(longest=1.0, setting=_setting_encoder),
    directions=False,
    load=_load_encoder,
    write=_write_encoder,
)

SINUMERIK_CEC = Control(
    name="sinumerik-cec",
    title="SINUMERIK compensation per direction (CEC)",
    sign_rule="value = target - actual, added to the set-point; the manual's pages do not tell the sign: check it",
    source="6FC5397-1BP40-3BA1 p. 248, 249, 264; 802D sl Function Manual p. 222",
    resolution=1e-7,
    most_points=350,
    usual_points=200,
    steepest=0.01,
    load=_load_cec,
    write=_write_cec,
)
