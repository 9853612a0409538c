"""Why each setting of a recommended cascade is what it is, in words, and the controller file that holds them."""

from __future__ import annotations

import json
import math
from dataclasses import dataclass

from feeddrive.errors import printable
from feeddrive.plant.analysis.modes import held_modes, inertia_at_motor
from feeddrive.plant.plant import Plant
from feeddrive.servo.cascade import KV_UNIT, Cascade
from feeddrive.servo.mechanics_response import Case
from feeddrive.tuning.filter_choice import FilterChoice
from feeddrive.tuning.largest_gain import GainLimit, Limit
from feeddrive.tuning.recommendation import Recommendation
from feeddrive.units.quantity import format_quantity

_COMPLETE = 200.0
"""Depth of a complete notch in a file [dB]: 1e-10, beyond every digit of a drive."""


@dataclass(frozen=True)
class Setting:
    """A setting with its why.

    Attributes:
        key: in a controller file.
        symbol: for people.
        shown: value with its units.
        why: one sentence.
    """

    key: str
    symbol: str
    shown: str
    why: str


def settings(plant: Plant, found: Recommendation) -> tuple[Setting, ...]:
    """Every recommended setting with its why."""
    cascade, demand = found.cascade, found.demand
    asked = f"{demand.phase:g}° and {demand.gain:g} dB in {_cases(len(found.reached))}"
    rows = [
        Setting(
            "velocity_gain",
            "K_p",
            f"{cascade.velocity_gain:.4g} N m s/rad",
            f"most K_p/T_n that keeps {asked}; held back by {_held_back(found, found.velocity.limit)}",
        ),
        Setting("reset_time", "T_n", format_quantity(cascade.reset_time, "s"), _why_reset(plant, found)),
        *(_filter_setting(choice) for choice in found.velocity.filters),
        Setting("position_gain", "K_v", f"{_kv(cascade)} = {cascade.position_gain:.4g} 1/s", _why_position(found)),
        Setting(
            "feed_forward",
            "k_s, k_a",
            "1, 1",
            f"without it the table lags {format_quantity(1 / 6 / cascade.position_gain, 'm')} at 10 m/min; "
            "changes no margin",
        ),
    ]
    return tuple(rows)


def rules(plant: Plant, found: Recommendation) -> tuple[str, ...]:
    """What rules of thumb say to the recommendation, one sentence each."""
    modes = [held_modes(one.case.on(plant), one.case.position).frequencies for one in found.reached]
    first = min((float(some[0]) for some in modes if len(some)), default=math.inf)
    if math.isinf(first):
        return ("the plant is declared rigid: no mode limits K_v here; on the machine one will",)
    gain = found.cascade.position_gain
    relation = "below" if gain <= first else "ABOVE"
    return (
        f"K_v in 1/s is {relation} the first natural frequency with the motor held, {gain:.3g} and {first:.3g} Hz "
        "(a rule of drive manuals: not above)",
    )


def controller_text(found: Recommendation, name: str) -> str:
    """The recommendation as a controller file, which a scenario names or holds as [controller].

    Args:
        found: the recommendation.
        name: of the controller.
    """
    cascade, (phase, gain) = found.cascade, found.worst
    worst = f"velocity loop {phase.velocity.phase:.0f}° and {min(one.velocity.gain for one in found.reached):.1f} dB"
    lines = [
        'format = "feeddrive-controller/1"',
        f"name = {json.dumps(printable(name), ensure_ascii=False)}",
        f"# least margins over {_cases(len(found.reached))}: {worst}, position loop {gain.position.gain:.1f} dB",
        f"# the cases: {operating_points(found)}",
        f'velocity_rate = "{_exact(1 / cascade.sample_time)} Hz"',
        f'position_rate = "{_exact(1 / (cascade.sample_time * cascade.position_divider))} Hz"',
        f'position_gain = "{_exact(cascade.position_gain)} 1/s"    # K_v, {_kv(cascade)}',
        f'velocity_gain = "{_exact(cascade.velocity_gain)} N m s/rad"    # K_p',
        f'reset_time = "{_exact(1e3 * cascade.reset_time)} ms"    # T_n',
        f'position_feedback = "{cascade.feedback}"',
        *current_loop_lines(cascade),
        "",
        "[feed_forward]",
        "speed = 1.0",
        "torque = 1.0    # of the plant's inertia",
        *(line for choice in found.velocity.filters for line in _filter_lines(choice)),
    ]
    return "\n".join(lines) + "\n"


def describe(case: Case) -> str:
    """A case in words."""
    load = f", payload {case.payload:g} kg" if case.payload else ""
    return f"table at {format_quantity(case.position, 'm')}{load}, {case.motion}"


def operating_points(found: Recommendation) -> str:
    """The operating points at which the margins hold, in words."""
    cases = [one.case for one in found.reached]
    places = list(dict.fromkeys(format_quantity(case.position, "m") for case in cases))
    loads = list(dict.fromkeys(f"{case.payload:g} kg" for case in cases))
    motions = list(dict.fromkeys(case.motion for case in cases))
    load = f", payloads {_listed(loads)}" if loads != ["0 kg"] else ""
    return f"table at {_listed(places)}{load}, {_listed(motions)}"


def _listed(words: list[str]) -> str:
    return words[0] if len(words) == 1 else f"{', '.join(words[:-1])} and {words[-1]}"


def _cases(count: int) -> str:
    return "one case" if count == 1 else f"{count} cases"


def _held_back(found: Recommendation, limit: GainLimit) -> str:
    return f"the {limit.limit} at {limit.frequency:.0f} Hz, {describe(found.reached[limit.case].case)}"


def _why_reset(plant: Plant, found: Recommendation) -> str:
    inertia = max(inertia_at_motor(one.case.on(plant)) for one in found.reached)
    times = found.cascade.reset_time * found.cascade.velocity_gain / inertia
    taken = math.degrees(math.atan(1 / times))
    return (
        f"searched with K_p at the margins; {times:.1f} J/K_p, the integrator takes {taken:.0f}° at the crossover of a "
        "rigid axis"
    )


def _why_position(found: Recommendation) -> str:
    limit = found.position
    if limit.limit is Limit.MAGNIFICATION:
        most = f"{found.demand.magnification:g} dB"
        return f"largest that magnifies no set-point by more than {most}; held back {_at(found, limit)}"
    return f"largest that keeps the margins; held back by {_held_back(found, limit)}"


def _at(found: Recommendation, limit: GainLimit) -> str:
    return f"at {limit.frequency:.0f} Hz, {describe(found.reached[limit.case].case)}"


def _filter_setting(choice: FilterChoice) -> Setting:
    brings = f"allows {choice.brings:.2g} times the K_p/T_n"
    if choice.kind == "PT2":
        return Setting("filter", "low-pass", f"{choice.frequency:g} Hz, damping {choice.damping:g}", brings)
    shown = f"{choice.frequency:g} Hz, {choice.bandwidth:.4g} Hz wide, {_depth(choice)}"
    if choice.resonance is None:
        return Setting("filter", "notch", shown, brings)
    low, high = choice.resonance
    where = f"{low:.0f} Hz" if high - low < 1 else f"{low:.0f} to {high:.0f} Hz over the cases"
    return Setting("filter", "notch", shown, f"resonance at {where}; {brings}")


def _depth(choice: FilterChoice) -> str:
    return f"{choice.depth:g} dB" if math.isfinite(choice.depth) else "complete"


def _filter_lines(choice: FilterChoice) -> list[str]:
    head = [
        "",
        "[[filter]]",
        'at = "torque"',
        f'kind = "{choice.kind}"',
        f'frequency = "{_exact(choice.frequency)} Hz"',
    ]
    if choice.kind == "PT2":
        return [*head, f'damping = "{_exact(choice.damping)}"']
    depth = f"{_exact(choice.depth)} dB" if math.isfinite(choice.depth) else f"{_COMPLETE:g} dB"
    return [*head, f'bandwidth = "{_exact(choice.bandwidth)} Hz"', f'depth = "{depth}"']


def current_loop_lines(cascade: Cascade) -> list[str]:
    """Lines of a controller file for lag, dead time and limits, those that are there."""
    lines = []
    if cascade.current_lag:
        lines.append(f'current_bandwidth = "{_exact(1 / (2 * math.pi * cascade.current_lag))} Hz"')
    if cascade.dead_time:
        lines.append(f'dead_time = "{_exact(1e6 * cascade.dead_time)} us"')
    if math.isfinite(cascade.torque_limit):
        lines.append(f'torque_limit = "{_exact(cascade.torque_limit)} N m"')
    if math.isfinite(cascade.speed_limit):
        lines.append(f'speed_limit = "{_exact(cascade.speed_limit)} rad/s"')
    if cascade.torque_offset:
        lines.append(f'torque_offset = "{_exact(cascade.torque_offset)} N m"')
    return lines


def _kv(cascade: Cascade) -> str:
    return f"{cascade.position_gain / KV_UNIT:.3g} (m/min)/mm"


def _exact(value: float) -> str:
    return f"{value:.14g}"
