"""Trace files written by hand from the layouts of their makers, of one axis whose motion and laws are known.

Position x [mm], speed, and a current from inertia and friction: enough for every relation that a reader may use.
"""

from __future__ import annotations

import json

import numpy as np

from feeddrive.typing import FloatArray

TORQUE_CONSTANT = 1.25
"""[N m/A]."""


def motion(time: FloatArray) -> tuple[FloatArray, FloatArray, FloatArray]:
    """Return position [mm], speed [mm/s] and acceleration [mm/s^2] at times, (n,) each: strokes that reverse."""
    slow, fast = 2.0 * np.pi * 0.5, 2.0 * np.pi * 1.7
    place = 40.0 * np.sin(slow * time) + 5.0 * np.sin(fast * time)
    speed = 40.0 * slow * np.cos(slow * time) + 5.0 * fast * np.cos(fast * time)
    acceleration = -40.0 * slow**2 * np.sin(slow * time) - 5.0 * fast**2 * np.sin(fast * time)
    return place, speed, acceleration


def current(time: FloatArray) -> FloatArray:
    """Return a current [A] of inertia and friction, (n,)."""
    _, speed, acceleration = motion(time)
    return 2e-3 * acceleration + 1.5 * np.tanh(speed / 5.0)


def resting(time: FloatArray) -> FloatArray:
    """Tell when the axis of `sinumerik_trace` rests, (n,): a step to the next value, not a ramp."""
    return (time >= 0.4) & (time < 0.7)


def warped(time: FloatArray) -> FloatArray:
    """Return the time of the motion with a rest in it, (n,) [s]."""
    return np.where(time < 0.4, time, np.maximum(0.4, time - 0.3))


def twincat(separator: str = "\t", decimal: str = ".", rows: int = 400) -> str:
    """A TwinCAT Scope export with two time columns, 1 ms and 4 ms."""
    time = np.arange(rows) * 1e-3
    place, speed, _ = motion(time)
    columns = [time * 1e3, place, speed, current(time)]
    slow = np.arange(0, rows, 4)
    head = [("Name", "ActPos", "ActVelo", "ActCurrent", "Temp"), ("SymbolComment", "", "", "", ""),
            ("Data-Type", "REAL64", "REAL64", "REAL64", "REAL64"), ("SampleTime[ms]", "1", "1", "1", "4"),
            ("SymbolName", *(f"Axes.Axis 1.{name}" for name in ("ActPos", "ActVelo", "ActCurrent")), "MAIN.temp"),
            ("Offset", "0", "0", "0", "0"), ("ScaleFactor", "1", "1", "1", "1"),
            ("Unit", "mm (Length)", "mm/s (Velocity)", "A (Current)", "(None)"),
            ("Unit ScaleFactor", "1", "1", "1", "1"), ("Unit Offset", "0", "0", "0", "0")]  # fmt: skip
    lines = [separator.join(("Name", "test")), separator.join(("File", "test.csv")),
             separator.join(("Starttime of export", "132959733843760000", "Montag", "15:56:24.376")),
             separator.join(("Endtime of export", "132959733853750000", "Montag", "15:56:25.375")), "", ""]  # fmt: skip
    lines += [separator.join((row[0], *row[1:4], row[0], row[4])) for row in head]
    lines.append("")
    for i in range(rows):
        cells = [repr(float(column[i])) for column in columns]
        if i < slow.size:
            cells += [repr(float(slow[i])), "20.5"]
        lines.append(separator.join(cells).replace(".", decimal))
    return "\n".join([*lines, ""])


def tncscope(magnitude: bool = False, rows: int = 600, swapped: bool = False) -> str:
    """A TNCscope trace: time in µs, three-digit exponents, a separator at the end of each row, CRLF."""
    time = np.arange(rows) * 3e-3
    place, speed, _ = motion(time)
    flow = np.abs(current(time)) if magnitude else current(time)
    curves = [("s ist", "mm", place, 3000), ("s soll", "mm", place + speed / 50.0, 3000),
              ("v ist", "mm/min", 60.0 * speed, 3000), ("I ist", "Ampere", flow, 100)]  # fmt: skip
    lines = ["%TNCscopeNT data file", "%[GLOBAL]", "%VERSION=2.0", "%CONTROL=iTNC530", "%NCVERSION=606420 03 SP4",
             "%TIME=1648048946", "%TRIGGERTIME_US=0", "%DIFFTIMEUTC=3600", "%SAMPLING=3000", "% "]  # fmt: skip
    order = list(range(len(curves)))[::-1] if swapped else list(range(len(curves)))
    for number, (name, unit, _, cycle) in enumerate(curves, start=1):
        column = order.index(number - 1) + 1
        lines += [f"%[CURVE{number}]", f"%NAME={name}/Y", f"%CHANNELTYPE={name}", f"%CHANNELID={number}", "%AXISTYPE=Y",
                  f"%DIMENSION={unit}", f"%COUNT={rows}", "%SAMPLING=3000", f"%CYCLETIME={cycle}", f"%COLUMN={column}",
                  "%METRIC=1", "% "]  # fmt: skip
    lines.append("%[DATA]")
    for i in range(rows):
        cells = [time[i] * 1e6, *(curves[k][2][i] for k in order)]
        lines.append(" " + "; ".join(_three_digits(cell) for cell in cells) + "; ")
    return "\r\n".join([*lines, ""])


def _three_digits(value: float) -> str:
    text = f"{value:.9e}"
    mantissa, exponent = text.split("e")
    return f"{mantissa}e{exponent[0]}{int(exponent[1:]):03d}"


def sinumerik_trace(dropouts: int = 0, rows: int = 1000) -> tuple[str, dict[str, FloatArray]]:
    """A SINUMERIK Operate trace and the full series that it stands for.

    Values are written only when they change; the positions (IPO cycle, 4 ms) lie at odd multiples of 2 ms, the current
    (servo cycle, 2 ms) at even ones.
    """
    servo, ipo = 2e-3 * np.arange(rows), 2e-3 + 4e-3 * np.arange(rows // 2 - 1)
    speed = np.where(resting(servo), 0.0, 60.0 * motion(warped(servo))[1])
    series = {"f1": np.round(np.where(resting(servo), 0.3, current(warped(servo))), 1),
              "f2": np.round(motion(warped(ipo))[0], 2), "f3": np.round(speed, 0)}  # fmt: skip
    signals = (("f1", 0.002, rows, "nckServoDataActCurr32 [u1, 7]", "current"),
               ("f2", 0.004, ipo.size, "nckServoDataMeasPos2 [u1, 7]", "posn"),
               ("f3", 0.002, rows, "nckServoDataActVelMotorSide64 [u1, 7]", "velo"))  # fmt: skip
    end = f"{servo[-1]:.6f}"
    lines = ['<?xml version="1.0" encoding="utf-8"?>', "<!-- XML file generated by SINUMERIK Solution Line Trace -->",
             '<traceSession version="01.00.03.02">', '<traceData dataFrames="1"><dataFrame>',
             f'<frameHeader startTime="2012-01-20T20:01:47.526Z" stopInc="{end}" dropOuts="{dropouts}"/>']  # fmt: skip
    for key, interval, count, name, kind in signals:
        lines.append(f'<dataSignal id="{key}" interval="{interval:.6f}" datapointCount="{count}" key="s1" '
                     f'name="/Nck/!SD/{name}" description="d" unitsType="{kind}" dataType="float"/>')  # fmt: skip
    stamps = {"f1": servo, "f2": ipo, "f3": servo}
    records: dict[int, list[str]] = {}
    for key, times in stamps.items():
        before = None
        for at, value in zip(times, series[key], strict=True):
            if value != before:
                records.setdefault(round(at * 1e6), []).append(f'{key}="{value:.6f}"')
            before = value
    lines += [f'<rec time="{at / 1e6:.6f}" {" ".join(values)}/>' for at, values in sorted(records.items())]
    lines += ["</dataFrame></traceData>", "</traceSession>"]
    return "\n".join([*lines, ""]), series


def edge_rows(rows: int = 900, lost: int = 250) -> tuple[list[str], list[list[float]]]:
    """Signals and rows of an Edge capture of axis X1, with a stretch lost behind row 300."""
    cycle = np.arange(rows) + np.where(np.arange(rows) >= 300, lost, 0)
    time = 2e-3 * cycle
    place, speed, _ = motion(time)
    flow = current(time)
    columns = {"CYCLE": cycle + 5_000.0, "ENC_POS|1": place, "DES_POS|1": place + speed / 80.0, "CURRENT|1": flow,
               "TORQUE|1": TORQUE_CONSTANT * flow, "VEL_FFW|1": 60.0 * speed}  # fmt: skip
    return list(columns), [[float(column[i]) for column in columns.values()] for i in range(rows)]


def edge_json(rows: int = 900, cycle_ms: object = 2) -> str:
    """An Edge capture in JSON."""
    names, table = edge_rows(rows)
    signals = [
        {"Name": name, "Type": "DOUBLE", "Axis": "X1" if "|" in name else "Cycle", "Address": name} for name in names
    ]
    payload = [{"HFData": table[i : i + 30]} for i in range(0, rows, 30)]
    payload.insert(2, {"HFBlockEvent": {"HFProbeCounter": 5010, "GCode": "G1"}})
    tree = {"Header": {"SignalListHFData": signals, "CycleTimeMs": cycle_ms}, "Payload": payload, "Footer": {}}
    return json.dumps(tree)


def edge_csv(rows: int = 900, separator: str = ",") -> str:
    """A table made of an Edge capture, with an index column in front."""
    names, table = edge_rows(rows)
    lines = [separator.join(["", *names])]
    lines += [separator.join([str(i), *map(repr, row)]) for i, row in enumerate(table)]
    return "\n".join([*lines, ""])


def halscope_old(comma: bool = True, rows: int = 500) -> str:
    """A halscope log to 2.9: names and values alternate, the decimal sign of the locale, 1 ms."""
    time = 1e-3 * np.arange(rows)
    place, speed, _ = motion(time)
    lines = ["Sampling period is 1000000 nSec ", ""]
    for i in range(rows):
        line = f"joint.0.pos-fb {place[i]:+.14f} joint.0.pos-cmd {place[i] + speed[i] / 50:+.14f} "
        lines.append(line.replace("0.pos", "0#pos").replace(".", ",").replace("joint,", "joint.").replace("#", ".")
                     if comma else line)  # fmt: skip
    return "\n".join([*lines, ""])


def halscope_new(rows: int = 500, extras: bool = True) -> str:
    """A halscope log of today."""
    time = 1e-3 * np.arange(rows)
    place, speed, _ = motion(time)
    lines = ["# Sampling period is 1000000 ns", "joint.0.pos-fb;joint.0.pos-cmd"]
    lines += ["# Position: 1.0;2.0", "# Scale: 0.5;0.5"] if extras else []
    lines += [f"{place[i]:.14f};{place[i] + speed[i] / 50:.14f}" for i in range(rows)]
    return "\n".join([*lines, ""])


def halsampler(numbered: bool = True, overrun: bool = True, rows: int = 600) -> str:
    """Output of halsampler, with a stretch of 40 samples lost behind the 200th."""
    index = np.arange(rows) + np.where((np.arange(rows) >= 200) & overrun, 40, 0)
    place, speed, _ = motion(1e-3 * index)
    lines = []
    for i in range(rows):
        if overrun and i == 200:
            lines.append("overrun")
        lines.append((f"{index[i]} " if numbered else "") + f"{place[i]:.6f} {speed[i]:.6f} ")
    return "\n".join([*lines, ""])
