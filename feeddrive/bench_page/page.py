"""The bench as one HTML file: equations, numbers, script and style in it, nothing fetched, nothing sent."""

from __future__ import annotations

import json
import math
from collections.abc import Sequence
from dataclasses import dataclass, replace
from html import escape
from pathlib import Path
from typing import Any

import numpy as np

from feeddrive.bench_page.page_equations import bench_equations
from feeddrive.compensation.compensate import cascade_of
from feeddrive.diagnosis.judging.result import Diagnosis
from feeddrive.effects.base import Effect
from feeddrive.effects.chain.payload import Payload
from feeddrive.errors import InputError, printable
from feeddrive.metrology.circular import GLITCH_SPAN
from feeddrive.metrology.response import SETTLED_BY
from feeddrive.plant.analysis.modes import inertia_at_motor
from feeddrive.plant.analysis.steady import MOVING
from feeddrive.plant.plant import Plant
from feeddrive.plant.structure import parameter_names, parameter_values
from feeddrive.servo.cascade import Cascade
from feeddrive.servo.filters import Filter, notch
from feeddrive.servo.loop_response import refuse_unstable_case
from feeddrive.servo.margins import GROWTH
from feeddrive.servo.mechanics_response import Case, grid
from feeddrive.simulate.setpoints.trial_motions import HEIGHT, RADIUS, STEP_AT, Trial, circle_about, step_at
from feeddrive.tuning.reasons import current_loop_lines
from feeddrive.units.quantity import shown_unit

_SCRIPTS = ("linear.js", "loop.js", "engine.js", "bench.js", "drawing.js", "page.js")
_LOWEST, _HIGHEST = 1.0, 4000.0
FILTERS = 3
"""Torque filters that can be moved; more of the given cascade stay as they are."""
_FIXED_KEYS = ("order", "phase", "port", "at_torque")
_FOLDER = Path(__file__).parent


@dataclass(frozen=True)
class BenchPage:
    """What a page shows.

    Attributes:
        plant: the machine.
        cascade: settings at the start.
        payload: largest that can be chosen [kg].
        found: names of the effects that a diagnosis found, first in the list of sliders.
    """

    plant: Plant
    cascade: Cascade
    payload: float
    found: tuple[str, ...] = ()


def bench_page(bench: BenchPage) -> str:
    """The page as text.

    Raises:
        InputError: a rigid plant.
    """
    data = bench_data(bench)
    functions = data.pop("functions")
    title = escape(printable(bench.plant.name))
    style = (_FOLDER / "page.css").read_text(encoding="utf-8")
    body = (_FOLDER / "page.html").read_text(encoding="utf-8").replace("TITLE", title)
    scripts = "\n".join((_FOLDER / name).read_text(encoding="utf-8") for name in _SCRIPTS)
    return (
        '<!DOCTYPE html>\n<html lang="en">\n<head>\n<meta charset="utf-8">\n'
        '<meta name="viewport" content="width=device-width, initial-scale=1">\n'
        "<meta http-equiv=\"Content-Security-Policy\" content=\"default-src 'none'; script-src 'unsafe-inline'; "
        "style-src 'unsafe-inline'; img-src data: blob:\">\n"
        f"<title>Bench: {title}</title>\n<style>{style}</style>\n</head>\n<body>\n{body}\n"
        f'<script type="application/json" id="data">{_json(data)}</script>\n'
        f"<script>\n{functions}\n{scripts}\n</script>\n</body>\n</html>\n"
    )


def _json(data: Any) -> str:
    """JSON that ends no script element, whatever a name holds."""
    text = json.dumps(_finite(data), ensure_ascii=True, allow_nan=False, separators=(",", ":"))
    return text.replace("<", "\\u003c").replace(">", "\\u003e").replace("&", "\\u0026")


def _finite(value: Any) -> Any:
    """Infinite numbers as the largest one, which JSON can hold and no limit reaches."""
    if isinstance(value, dict):
        return {key: _finite(item) for key, item in value.items()}
    if isinstance(value, list | tuple):
        return [_finite(item) for item in value]
    if isinstance(value, float) and not math.isfinite(value):
        return None if math.isnan(value) else math.copysign(1e300, value)
    return value


def bench_data(bench: BenchPage) -> dict[str, Any]:
    """Numbers of the page, SI, and under `functions` the equations as JavaScript."""
    _refuse_unmovable(bench.cascade, bench.plant.name)
    plant = bench.plant.with_effects(Payload.of(mass=0.0))
    cascade = _with_slots(bench.cascade)
    functions, numbers = bench_equations(plant, cascade)
    names = list(parameter_names(plant))
    payload = plant.effects[-1]
    stroke = None if plant.stroke is None else list(plant.stroke)
    periods = (cascade.sample_time, cascade.sample_time * cascade.position_divider)
    start = replace(bench.cascade, torque_filters=bench.cascade.torque_filters[:FILTERS])
    return {
        "functions": functions,
        **numbers,
        "name": printable(plant.name),
        "payload": names.index(f"{payload.label}.mass"),
        "most_payload": bench.payload,
        "stroke": stroke,
        "middle": plant.middle,
        "position_matters": plant.chain.varies or bool(stroke),
        "inertia": cascade.feed_forward.inertia or inertia_at_motor(bench.plant),
        "velocity": MOVING,
        "growth": GROWTH,
        "settled_by": SETTLED_BY,
        "frequency": [grid(_LOWEST, min(_HIGHEST, 0.5 / period)).tolist() for period in periods],
        "circle": _circle(plant, cascade),
        "step": _motion(step_at(plant, plant.middle), cascade, plant.middle) | {"height": HEIGHT, "at": STEP_AT},
        "start": settings_of(start, plant.middle),
        "effects": _effects(plant, names, bench.found),
        "tracking": 0.0 if cascade.tracking_time == cascade.reset_time else cascade.tracking_time,
        "controller": _controller_head(bench.cascade),
        "feed_forward": _feed_forward(bench.cascade),
    }


def _refuse_unmovable(cascade: Cascade, name: str) -> None:
    """Refuse a controller that the page would not carry as it is.

    Raises:
        InputError: more filters than the page has, or other ones.
    """
    kinds = [one.kind for one in cascade.torque_filters]
    if cascade.speed_filters or len(kinds) > FILTERS or not set(kinds) <= {"notch", "PT2"}:
        what = f"the page has {FILTERS} filters of the torque, notch or PT2, and the controller has others"
        raise InputError(what, name, "leave them out of the controller file, or let `feeddrive tune` choose")


def settings_of(cascade: Cascade, position: float, payload: float = 0.0) -> dict[str, Any]:
    """Settings of the page for a cascade, SI."""
    filters = [_filter(one) for one in cascade.torque_filters]
    filters += [{"kind": "none", "frequency": 500.0, "damping": 0.125, "depth": 15.0}] * (FILTERS - len(filters))
    return {
        "position": position, "payload": payload, "velocity_gain": cascade.velocity_gain,
        "reset_time": cascade.reset_time, "position_gain": cascade.position_gain, "filters": filters,
        "speed_share": cascade.feed_forward.speed, "torque_share": cascade.feed_forward.torque, "values": {},
    }  # fmt: skip


def _filter(one: Filter) -> dict[str, Any]:
    if one.kind == "notch":
        frequency, damping = one.frequency, one.denominator[1] / (4 * math.pi * one.frequency)
        depth = 20 * math.log10(one.denominator[1] / one.numerator[1]) if one.numerator[1] else 200.0
        return {"kind": "notch", "frequency": frequency, "damping": damping, "depth": depth}
    damping = math.pi * one.frequency * one.denominator[1]
    return {"kind": "PT2", "frequency": one.frequency, "damping": damping, "depth": 15.0}


def _with_slots(cascade: Cascade) -> Cascade:
    """As many torque filters as the page has places: which they are, the page says."""
    spare = notch(0.1 / cascade.sample_time, 0.01 / cascade.sample_time, 10.0)
    filters = (*cascade.torque_filters[:FILTERS], *(spare,) * FILTERS)[:FILTERS]
    return replace(cascade, torque_filters=filters)


def _motion(trial: Trial, cascade: Cascade, origin: float) -> dict[str, Any]:
    """Set-point at the position ticks, the position from an origin [m], and the ticks of the run."""
    ticks = math.ceil(trial.trajectory.duration / cascade.sample_time - 1e-6)
    time = np.arange(0, ticks, cascade.position_divider, dtype=np.float64) * cascade.sample_time
    motion = trial.trajectory.at(time)
    ref = {
        "position": (motion.position - origin).tolist(),
        "velocity": motion.velocity.tolist(),
        "acceleration": motion.acceleration.tolist(),
    }
    return {"ref": ref, "ticks": ticks}


def _circle(plant: Plant, cascade: Cascade) -> dict[str, Any]:
    """The circle, and the ticks of its last whole turn at constant feed, as `metrology.evaluate` takes them."""
    from feeddrive.metrology.evaluate import steady_turn

    trial = circle_about(plant, plant.middle)
    content = _motion(trial, cascade, trial.trajectory.centre)  # type: ignore[attr-defined]
    time = np.arange(content["ticks"]) * cascade.sample_time
    angle = trial.trajectory.angle(time)  # type: ignore[attr-defined]
    chosen = steady_turn(angle, time)
    turn = {"angle": angle[chosen].tolist(), "first": int(chosen[0]), "radius": RADIUS, "span": GLITCH_SPAN}
    return content | turn


def _effects(plant: Plant, names: Sequence[str], found: Sequence[str]) -> list[dict[str, Any]]:
    """Sliders of the effects: those that were found first."""
    values = parameter_values(plant)
    made = []
    for effect in plant.effects[:-1]:
        sliders = []
        for one in effect.parameters:
            name = f"{effect.label}.{one.key}"
            if one.key in _FIXED_KEYS or name not in names or not values[names.index(name)]:
                continue
            per, _, unit = shown_unit(values[names.index(name)], one.unit)
            sliders.append({"place": names.index(name), "key": one.key, "unit": unit, "per": per})
        if sliders:
            made.append(
                {"name": effect.name, "label": _label(effect), "found": effect.name in found, "sliders": sliders}
            )
    return sorted(made, key=lambda one: not one["found"])


def _label(effect: Effect) -> str:
    return printable(effect.label.replace("_", " "))


def _controller_head(cascade: Cascade) -> list[str]:
    """Lines of the controller file that the page does not move."""
    lines = [
        f'velocity_rate = "{1 / cascade.sample_time!r} Hz"',
        f'position_rate = "{1 / (cascade.sample_time * cascade.position_divider)!r} Hz"',
        f'position_feedback = "{cascade.feedback}"',
        *current_loop_lines(cascade),
    ]
    if cascade.balancing_time:
        lines.append(f'balancing_time = "{cascade.balancing_time!r} s"')
    if cascade.tracking_time != cascade.reset_time and math.isfinite(cascade.tracking_time):
        lines.append(f'tracking_time = "{cascade.tracking_time!r} s"')
    return lines


def _feed_forward(cascade: Cascade) -> list[str]:
    """Friction in the feed-forward, which the page does not move."""
    forward = cascade.feed_forward
    if not (forward.coulomb or forward.viscous):
        return []
    return [
        f'coulomb = "{forward.coulomb!r} N m"',
        f'smoothing_speed = "{forward.smoothing_speed!r} rad/s"',
        f'viscous = "{forward.viscous!r} N m s/rad"',
    ]


def bench_of_diagnosis(after: Plant, diagnosis: Diagnosis) -> str:
    """The page for the tab of a report: the machine as diagnosed, at its declared or a recommended cascade.

    Empty where there is nothing to play on: no effect was found, a machine without elastic chain or that declares heat
    alone, or one whose loop cannot be made or shown.
    """
    if not after.has_motion or not after.chain.elastic or not diagnosis.effects:
        return ""
    try:
        cascade = cascade_of(after, None)
        refuse_unstable_case(after, cascade, Case(after.middle), "controller")
        names = tuple(one.name for one in diagnosis.effects)
        return bench_page(BenchPage(after, cascade, max(100.0, after.chain_values()["table_mass"]), names))
    except InputError:
        return ""
