"""What belongs to a tuned cascade beside its settings: margins as rows, everything as plain values, its files."""

from __future__ import annotations

import json
import math
from dataclasses import asdict
from pathlib import Path
from typing import Any

from feeddrive import __version__
from feeddrive.files import write_bytes_atomically, write_text_atomically
from feeddrive.interface.retuning import Retuned
from feeddrive.interface.servo import HIGHEST, LOWEST, Servo
from feeddrive.servo.cascade import KV_UNIT, Cascade
from feeddrive.servo.loop_response import loops_of
from feeddrive.servo.margins import Margins
from feeddrive.servo.response_family import margins_content, open_family
from feeddrive.tuning.drive_settings import DriveSettings
from feeddrive.tuning.reasons import describe, operating_points, rules
from feeddrive.units.quantity import format_quantity

FORMAT = "feeddrive-tune/1"


def tuned_record(servo: Servo, typed: DriveSettings | None, retuned: Retuned | None) -> dict[str, Any]:
    """Settings, margins, parameters of a drive and what they change as plain values, SI."""
    found, cascade = servo.recommendation, servo.cascade
    cases = [one.case for one in found.reached]
    content: dict[str, Any] = {
        "format": FORMAT,
        "version": __version__,
        "name": servo.plant.name,
        "asked": {"phase_deg": found.demand.phase, "gain_db": found.demand.gain},
        "operating_points": {
            "text": operating_points(found),
            "position [m]": sorted({one.position for one in cases}),
            "velocity [m/s]": sorted({one.velocity for one in cases}),
            "payload [kg]": sorted({one.payload for one in cases}),
        },
        "velocity_gain": {"N m s/rad": cascade.velocity_gain},
        "reset_time": {"s": cascade.reset_time},
        "position_gain": {"1/s": cascade.position_gain, "(m/min)/mm": cascade.position_gain / KV_UNIT},
        "position_feedback": str(cascade.feedback),
        "filters": [
            {"kind": one.kind, "frequency": one.frequency, "damping": one.damping,
             "depth_db": one.depth if math.isfinite(one.depth) else None,
             "resonance": None if one.resonance is None else list(one.resonance), "brings": one.brings}
            for one in found.velocity.filters
        ],
        "settings": [asdict(one) for one in servo.settings],
        "rules": list(rules(servo.plant, found)),
        "reached": [
            {**asdict(one.case), "velocity_loop": margins_content(one.velocity),
             "position_loop": margins_content(one.position), "slowest_growth 1/s": one.growth}
            for one in found.reached
        ],
        "controller": servo.text,
    }  # fmt: skip
    if typed is not None:
        content["drive"] = {
            "form": typed.form,
            "remarks": list(typed.remarks),
            "parameters": [
                {"name": one.parameter.name, "value": one.typed, "unit": one.parameter.unit,
                 "resolution": one.parameter.resolution, "meaning": one.parameter.meaning,
                 "source": one.parameter.source}
                for one in typed.lines
            ],
            "file": typed.text,
        }  # fmt: skip
    if retuned is not None:
        changes = [{"setting": name, "present": old, "recommended": new} for name, old, new in retuned.changes]
        content["present"] = {"changes": changes, "remarks": list(retuned.remarks), "brings": retuned.brings}
    return content


def save_tuned(servo: Servo, typed: DriveSettings | None, retuned: Retuned | None, folder: Path) -> None:
    """Write controller.toml, tune.json, the open loops, the drive's file, and step and circle of a comparison.

    Raises:
        InputError: a file cannot be written.
    """
    from feeddrive.report.figures.drawing import render
    from feeddrive.report.figures.figure_bode import bode_figure

    cases = [one.case for one in servo.recommendation.reached]
    figures = [
        bode_figure(open_family(servo.plant, servo.cascade, loop, cases, LOWEST, HIGHEST))
        for loop in loops_of(servo.cascade)
    ]
    if retuned is not None:
        figures += [one for one in retuned.figures() if one.stem.startswith("retuned")]
    for one in figures:
        write_bytes_atomically(folder / f"{one.stem}.png", render(one).png)
    if typed is not None:
        ending = "hal" if typed.form == "linuxcnc" else "txt"
        write_text_atomically(folder / f"{typed.form}.{ending}", typed.text)
    content = json.dumps(tuned_record(servo, typed, retuned), indent=2, ensure_ascii=False, allow_nan=False)
    write_text_atomically(folder / "tune.json", content + "\n")
    servo.save(folder / "controller.toml")


def reached_rows(servo: Servo) -> list[list[str]]:
    """Case, margins of the velocity and of the position loop, peaks of both sensitivities."""
    return [
        [describe(one.case), _margins(one.velocity), _margins(one.position),
         f"{one.velocity.sensitivity:.2f}, {one.position.sensitivity:.2f}"]
        for one in servo.recommendation.reached
    ]  # fmt: skip


def _margins(found: Margins) -> str:
    phase, gain = (
        f"{value:.1f}{unit}" if math.isfinite(value) else "no limit"
        for value, unit in ((found.phase, "°"), (found.gain, " dB"))
    )
    return f"{phase}, {gain}"


def drive_words(cascade: Cascade) -> str:
    """Rates, feedback and delays of a cascade in a sentence."""
    fast, slow = (1e-3 / (cascade.sample_time * ticks) for ticks in (1, cascade.position_divider))
    lag = f"{1 / (2 * math.pi * cascade.current_lag):.4g} Hz" if cascade.current_lag else "without lag"
    return (
        f"{fast:g} kHz velocity loop, {slow:g} kHz position loop reading the {cascade.feedback}, current loop {lag}, "
        f"dead time {format_quantity(cascade.dead_time, 's')}"
    )
