"""The sheet, the file and the plain values of a temperature compensation."""

from __future__ import annotations

from typing import Any

import numpy as np

from feeddrive import __version__
from feeddrive.compensation.forms import sinumerik_temp
from feeddrive.compensation.forms.control import checked_axis, plain_line
from feeddrive.compensation.sheet import Section, micrometres
from feeddrive.compensation.temperature import HeatTable
from feeddrive.units.quantity import percent


def heat_sections(done: HeatTable, axis: str) -> list[Section]:
    """The sheet of a temperature compensation."""
    one = done.left
    ranked = ", ".join(f"{name} {percent(share)}" for name, share in done.ranking.items())
    steepest = float(np.max(np.abs(done.table.slopes)))
    recorded = done.sensor.endswith("_temperature")
    counted = "the recording" if recorded else "[thermal] of the plant file"
    return [
        ("Table", [
            f"SINUMERIK temperature compensation, axis {axis} of {plain_line(done.name)}, over {done.sensor}; "
            f"tan beta up to {1e6 * steepest:.3g} um/m.",
            f"Positions count as in {counted}; P0 = {1e3 * done.table.reference:.6g} mm.",
        ]),
        ("Sign", [sinumerik_temp.SIGN_RULE, f"Source: {sinumerik_temp.SOURCE}"]),
        ("Check of one point", heat_check(axis)),
        ("Load", sinumerik_temp.load(axis, done.sensor, done.table.reference)),
        ("Predicted from the recording" if recorded else "Predicted by simulation", [
            f"{done.judged}: rms {micrometres(one.rms_before)} to {micrometres(one.rms_after)}, largest "
            f"{micrometres(one.largest_before)} to {micrometres(one.largest_after)}.",
        ]),
        ("What is left", [
            f"Share of the rms error that a table over each sensor leaves: {ranked}.",
            "What one temperature does not tell: screw and nut warm and cool along different ways.",
        ]),
    ]  # fmt: skip


def heat_check(axis: str) -> list[str]:
    """One measurement that shows the sign."""
    return [
        f"Check: with tan beta 0 write SD43900 $SA_TEMP_COMP_ABS_VALUE[{axis}] = 0.1 by hand: the axis must move by "
        "0.1 mm to -. If it moves to +, the sign of all values is the other one."
    ]


def heat_text(done: HeatTable, axis: str) -> str:
    """The file for PLC and control."""
    name = checked_axis(axis)
    lines = [
        f"SINUMERIK temperature compensation, axis {name} of {plain_line(done.name)}, feeddrive {__version__}",
        f"Sign: {sinumerik_temp.SIGN_RULE}",
        f"Source: {sinumerik_temp.SOURCE}",
        *heat_check(name),
        *sinumerik_temp.load(name, done.sensor, done.table.reference),
    ]
    return sinumerik_temp.text(done.table, lines)


def heat_record(done: HeatTable, axis: str) -> dict[str, Any]:
    """Everything of a temperature compensation as plain values, SI, for JSON."""
    table, one = done.table, done.left
    return {
        "form": "sinumerik-temp", "axis": axis, "machine": done.name, "sensor": done.sensor,
        "reference": table.reference, "temperatures": table.temperatures.tolist(), "K0": table.offsets.tolist(),
        "tan_beta": table.slopes.tolist(), "judged": done.judged, "ranking": dict(done.ranking),
        "predicted": {"rms_before": one.rms_before, "rms_after": one.rms_after,
                      "largest_before": one.largest_before, "largest_after": one.largest_after},
    }  # fmt: skip
