"""SINUMERIK temperature compensation: the three numbers over a sensor, and the text that writes them.

    dK(x, T) = K0(T) + tan beta(T) (x - P0)       SD43900 [mm], SD43910 [1], SD43920 [mm]

dK is the error, actual minus target: the manual's worked form makes tan beta of a growing machine positive. The NC has
no temperature; the text is a function block in Structured Text (IEC 61131-3) that a PLC runs once a second and whose
outputs it writes to the setting data. Straight between the temperatures, constant beyond.

Source: SINUMERIK Extended Functions 6FC5397-1BP40-3BA1, pages 228 to 230; 808D Advanced, page 252.
"""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from feeddrive.compensation.forms.control import millimetres, plain_line
from feeddrive.compensation.heat.thermal_line import LineTable
from feeddrive.errors import InputError
from feeddrive.typing import FloatArray

STEEPEST = 0.01
"""MD32760 COMP_ADD_VELO_FACTOR, 1 % of the axis' velocity, also limits tan beta."""

SIGN_RULE = "dK = actual - target; a positive dK makes the axis move to -"
SOURCE = "6FC5397-1BP40-3BA1 p. 228-230; 808D Advanced p. 252"


def load(axis: str, sensor: str, reference: float) -> tuple[str, ...]:
    """What to set."""
    return (
        f"MD32750 $MA_TEMP_COMP_TYPE[{axis}] = 3 (bit 0: K0, bit 1: tan beta).",
        f"SD43920 $SA_TEMP_COMP_REF_POSITION[{axis}] = {millimetres(reference, 4)} (P0).",
        f"The PLC reads the sensor ({plain_line(sensor)}), calls the block once a second, and writes K0 to SD43900 "
        f"$SA_TEMP_COMP_ABS_VALUE[{axis}] and TanBeta to SD43910 $SA_TEMP_COMP_SLOPE[{axis}].",
        "MD32760 $MA_COMP_ADD_VELO_FACTOR limits the rate at which a new value is worked off, and tan beta.",
    )


def text(table: LineTable, head: Sequence[str]) -> str:
    """The function block, `head` in its comment; a slope that the control limits raises InputError."""
    steepest = float(np.max(np.abs(table.slopes)))
    if steepest > STEEPEST:
        what = f"tan beta of {1e3 * steepest:.3g} mm/m is beyond {1e3 * STEEPEST:g} mm/m, to which MD32760 limits it"
        raise InputError(what, "sinumerik-temp", "check the expansion and the temperatures")
    count = len(table.temperatures)
    comment = [f"(* {plain_line(line).replace('*)', '* )').replace('(*', '( *')} *)" for line in head]
    lines = [
        *comment, "FUNCTION_BLOCK FD_TempComp", "VAR_INPUT", "  T : REAL;  (* reading, degC *)", "END_VAR",
        "VAR_OUTPUT", "  K0 : REAL;  (* mm *)", "  TanBeta : REAL;  (* 1 *)",
        f"  P0 : REAL := {millimetres(table.reference, 4)};  (* mm *)", "END_VAR", "VAR",
        _array("Temperatures", table.temperatures, "{:.2f}"),
        _array("Offsets", 1e3 * table.offsets, "{:.5f}"),
        _array("Slopes", table.slopes, "{:.9f}"),
        "  i : INT;", "  share : REAL;", "END_VAR",
        "i := 1;",
        f"WHILE i < {count - 1} AND T > Temperatures[i + 1] DO",
        "  i := i + 1;", "END_WHILE;",
        "share := LIMIT(0.0, (T - Temperatures[i]) / (Temperatures[i + 1] - Temperatures[i]), 1.0);",
        "K0 := Offsets[i] + share * (Offsets[i + 1] - Offsets[i]);",
        "TanBeta := Slopes[i] + share * (Slopes[i + 1] - Slopes[i]);",
        "END_FUNCTION_BLOCK",
    ]  # fmt: skip
    return "\n".join(lines) + "\n"


def _array(name: str, values: FloatArray, form: str) -> str:
    written = ", ".join(form.format(one + 0.0) for one in values.tolist())
    return f"  {name} : ARRAY[1..{len(values)}] OF REAL := [{written}];"
