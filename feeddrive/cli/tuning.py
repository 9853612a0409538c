"""What `feeddrive tune` does: read the request, recommend, write and tell."""

from __future__ import annotations

import json
import math
from dataclasses import asdict, dataclass, replace
from pathlib import Path
from typing import Any

from rich.table import Table

from feeddrive import __version__
from feeddrive.cli.output import deliver, quantities, table, tell_written, warnings_as_lines, working
from feeddrive.cli.tuning_drive import drive_content, drive_tables, write_drive
from feeddrive.errors import InputError
from feeddrive.files import find_plant, find_scenario_or_controller, write_bytes_atomically, write_text_atomically
from feeddrive.interface.servo import Servo
from feeddrive.output_folder import output_folder, refuse_unusable
from feeddrive.plant.file.entries import nearest
from feeddrive.plant.file.files import read_plant
from feeddrive.plant.plant import Plant
from feeddrive.servo.cascade import KV_UNIT, Cascade, Feedback
from feeddrive.servo.loop_response import loops_of
from feeddrive.servo.response_family import open_family
from feeddrive.servo.response_json import margins_content
from feeddrive.simulate.controlled.controller_file import read_controller
from feeddrive.tuning.bare_drive import bare_drive
from feeddrive.tuning.demand import Demand, operating_points
from feeddrive.tuning.drive_forms.drive_file import writer_of
from feeddrive.tuning.reasons import controller_text, describe, rules, settings
from feeddrive.tuning.reasons import operating_points as points_in_words
from feeddrive.tuning.recommendation import Recommendation, recommend
from feeddrive.units.quantity import format_quantity, parse

FORMAT = "feeddrive-tune/1"


@dataclass(frozen=True)
class Drive:
    """What was typed of the drive; a scenario settles the rest."""

    scenario: str
    velocity_rate: str
    position_rate: str
    current_bandwidth: str
    dead_time: str
    feedback: str


@dataclass(frozen=True)
class Wanted:
    """What was typed."""

    plant: str
    margin_phase: str
    margin_gain: str
    positions: str
    payload: str
    velocity: str
    drive: Drive
    form: str = ""
    present: Path | None = None


def run(wanted: Wanted, as_json: bool, out: Path | None) -> None:
    """Recommend, write and tell.

    Raises:
        InputError: anything in the request that cannot be used, or margins that cannot be met.
    """
    refuse_unusable(out)
    if wanted.form:
        writer_of(wanted.form, "--form")
    with warnings_as_lines():
        plant = read_plant(find_plant(wanted.plant))
        phase = math.degrees(parse(wanted.margin_phase, "rad", "--margin-phase"))
        demand = Demand(phase=round(phase, 9), gain=parse(wanted.margin_gain, "dB", "--margin-gain"))
        drive = drive_of(plant, wanted.drive)
        places = quantities(wanted.positions, "m", "--positions")
        loads = quantities(wanted.payload, "kg", "--payload")
        cases = operating_points(plant, places, loads, parse(wanted.velocity, "m/s", "--velocity"))
        with working(f"tuning {plant.name}: velocity loop, filters, position loop at {len(cases)} operating points"):
            servo = Servo(plant, recommend(plant, drive, cases, demand))
        typed = servo.to_drive(wanted.form) if wanted.form else None
        retuned = servo.compare(wanted.present, wanted.form) if wanted.present is not None else None
    found = servo.recommendation
    content = _content(plant, found) | drive_content(typed, retuned)
    if out is not None:
        with output_folder(out) as folder:
            _write(plant, found, content, folder)
            write_drive(typed, retuned, folder)
    shown = [] if as_json else [*_tables(plant, found), *drive_tables(typed, retuned)]
    deliver(content, shown, as_json, None)
    tell_written(out, as_json)


def drive_of(plant: Plant, written: Drive) -> Cascade:
    """Rates, delays and limits of the drive; of a scenario, its gains and filters are to be replaced.

    Raises:
        InputError: values that cannot be used.
    """
    if written.feedback:
        allowed = [str(place) for place in Feedback]
        if written.feedback not in allowed:
            raise InputError(f'"{written.feedback}" is not possible', "--feedback", nearest(written.feedback, allowed))
    if written.scenario:
        read = read_controller(find_scenario_or_controller(written.scenario), plant)
        place = Feedback(written.feedback) if written.feedback else read.feedback
        return replace(read, feedback=place, torque_filters=(), speed_filters=())
    fast = _positive(written.velocity_rate, "Hz", "--velocity-rate")
    slow = _positive(written.position_rate, "Hz", "--position-rate")
    dead = parse(written.dead_time, "s", "--dead-time")
    if dead < 0:
        raise InputError(f"{written.dead_time} is negative", "--dead-time", "write zero or more")
    bandwidth = _positive(written.current_bandwidth, "Hz", "--current-bandwidth")
    reads = Feedback(written.feedback) if written.feedback else None
    return bare_drive(plant, fast, slow, bandwidth, dead, reads, "--position-rate")


def _positive(text: str, unit: str, where: str) -> float:
    value = parse(text, unit, where)
    if not value > 0:
        raise InputError(f"{text} is not above zero", where, "write a positive value")
    return value


def _content(plant: Plant, found: Recommendation) -> dict[str, Any]:
    """Everything, SI."""
    cascade = found.cascade
    return {
        "format": FORMAT,
        "version": __version__,
        "name": plant.name,
        "asked": {"phase_deg": found.demand.phase, "gain_db": found.demand.gain},
        "operating_points": {
            "text": points_in_words(found),
            "position [m]": sorted({one.case.position for one in found.reached}),
            "velocity [m/s]": sorted({one.case.velocity for one in found.reached}),
            "payload [kg]": sorted({one.case.payload for one in found.reached}),
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
        "settings": [asdict(one) for one in settings(plant, found)],
        "rules": list(rules(plant, found)),
        "reached": [
            {**asdict(one.case), "velocity_loop": margins_content(one.velocity),
             "position_loop": margins_content(one.position), "slowest_growth 1/s": one.growth}
            for one in found.reached
        ],
        "controller": controller_text(found, _name(plant)),
    }  # fmt: skip


def _name(plant: Plant) -> str:
    return f"recommended for {plant.name}"


def _write(plant: Plant, found: Recommendation, content: dict[str, Any], out: Path) -> None:
    from feeddrive.report.figures.drawing import render
    from feeddrive.report.figures.figure_bode import bode_figure

    cases = [one.case for one in found.reached]
    for loop in loops_of(found.cascade):
        drawn = render(bode_figure(open_family(plant, found.cascade, loop, cases, 1.0, 4000.0)))
        write_bytes_atomically(out / f"{drawn.stem}.png", drawn.png)
    write_text_atomically(out / "tune.json", json.dumps(content, indent=2, ensure_ascii=False, allow_nan=False) + "\n")
    write_text_atomically(out / "controller.toml", controller_text(found, _name(plant)))


def _tables(plant: Plant, found: Recommendation) -> list[Table | str]:
    rows = [[f"{one.symbol}", one.shown, one.why] for one in settings(plant, found)]
    return [
        table(f"{plant.name}: recommended cascade", ("setting", "value", "why"), rows),
        table("Margins reached", ("case", "velocity loop", "position loop", "peaks of sensitivity"), _reached(found)),
        f"Margins hold at these operating points: {points_in_words(found)}. Between them they are not looked at.",
        f"Drive: {_drive(found.cascade)}.",
        *(f"Rule: {text}." for text in rules(plant, found)),
        "\nController file:\n\n" + controller_text(found, _name(plant)),
    ]


def _drive(cascade: Cascade) -> str:
    fast, slow = (1e-3 / (cascade.sample_time * ticks) for ticks in (1, cascade.position_divider))
    lag = f"{1 / (2 * math.pi * cascade.current_lag):.4g} Hz" if cascade.current_lag else "without lag"
    late = format_quantity(cascade.dead_time, "s")
    return (
        f"{fast:g} kHz velocity loop, {slow:g} kHz position loop reading the {cascade.feedback}, current loop {lag}, "
        f"dead time {late}"
    )


def _reached(found: Recommendation) -> list[list[str]]:
    return [
        [describe(one.case), f"{one.velocity.phase:.1f}°, {one.velocity.gain:.1f} dB",
         f"{one.position.phase:.1f}°, {one.position.gain:.1f} dB",
         f"{one.velocity.sensitivity:.2f}, {one.position.sensitivity:.2f}"]
        for one in found.reached
    ]  # fmt: skip
