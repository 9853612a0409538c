"""The sheet that belongs to a table: sign rule, loading, check of one point, prediction, what is left, other values."""

from __future__ import annotations

import math
from collections.abc import Callable, Sequence
from typing import Any

import numpy as np

from feeddrive import __version__
from feeddrive.compensation.compensate import Compensated
from feeddrive.compensation.deviations import difference_words
from feeddrive.compensation.forms.control import checked_axis, plain_line
from feeddrive.compensation.lost_motion import CURE, NOTICED, flank_words, wind_up_words
from feeddrive.compensation.points import POINTS_PER_PERIOD
from feeddrive.compensation.predicted_accuracy import Figures
from feeddrive.metrology.circular import Circular
from feeddrive.units.quantity import format_quantity

Section = tuple[str, Sequence[str]]

_THROWN = 0.25
"""Share of the play by which a quadrant may go inwards before it is reported."""

_OTHER = 0.1
"""Share of the play that may be lacking in a simulated reversal before it is reported."""


def micrometres(value: float) -> str:
    """A small length with two digits behind the point, or as many as say something."""
    return f"{1e6 * value + 0.0:.2f} um" if abs(value) < 1e-3 else f"{1e3 * value:.3f} mm"


def head(done: Compensated) -> list[str]:
    """Lines for the comments of the file: what it is, sign rule with its source, check of one point."""
    return [
        f"{done.control.title}, axis {done.wishes.axis} of {plain_line(done.name)}, feeddrive {__version__}",
        f"Sign: {done.control.sign_rule}",
        f"Source: {done.control.source}",
        *check_of_one_point(done),
        *done.control.loading(done.table, done.wishes.axis),
    ]


def text(done: Compensated) -> str:
    """The file for the control."""
    axis = checked_axis(done.wishes.axis)
    return done.control.write(done.table, head(done), axis)


def check_of_one_point(done: Compensated) -> list[str]:
    """One measurement on the machine that shows whether the sign is right."""
    table = done.table
    # from a point that can be approached from below, and not to the last one, which has no overrun behind it
    inner = np.arange(1, len(table) - 1) if len(table) > 3 else np.arange(len(table))
    base = int(inner[np.argmin(np.abs(table.positions[inner] - table.reference))])
    forward = table.forward - table.forward[base]
    place = int(inner[np.argmax(np.abs(forward[inner]))])
    where, reference = (f"{1e3 * one:.3f} mm" for one in table.positions[[place, base]].tolist())
    lines, enough = [], max(3 * done.control.resolution, 1e-7)
    if abs(forward[place]) > enough:
        lines.append(
            f"Check: reference the axis, come to {reference} and then to {where}, both moving to +, and measure the "
            f"way between. Without the table it is {micrometres(float(forward[place]))} off (+: too far); with it "
            "nearly nothing. Twice as much means that the sign is wrong."
        )
    if table.play > enough:
        lines.append(
            f"Check: come to {where} moving to +, then moving to -. Without compensation the second stands "
            f"{micrometres(table.play)} further to +; with it nearly at the same place. Twice as much: wrong sign."
        )
    return lines


def left(done: Compensated) -> list[str]:
    """What no table takes away, and why."""
    lines = [*done.refused]
    if done.measured is not None:
        lines.append(difference_words(done.measured))
        lines.append(f"Single samples scatter by {micrometres(done.measured.scatter)} about what is known.")
    seen, asked = done.wishes.recorded, done.wishes.stroke
    if seen and asked and max(seen[0] - asked[0], asked[1] - seen[1]) > done.table.step:
        ends = " to ".join(format_quantity(end, "m") for end in seen)
        lines.append(f"Recorded was {ends} alone: beyond it the table goes on as was found there, measured by nobody.")
    most = micrometres(done.left_by_table)
    most = f"up to {most}" if done.left_by_table >= 5e-9 else "less than 0.01 um"
    lines.append(f"By its points and its rounding the table leaves {most} of the map.")
    if done.control.stepwise:
        jump = max(float(np.max(np.abs(np.diff(one)))) for one in (done.table.forward, done.table.reverse))
        if jump > 4 * done.control.resolution:
            cause = (
                f"the distance of the points, {format_quantity(done.table.step, 'm')} ({done.control.most_points - 1} "
                "stretches are all there are): a shorter stroke, or less lead error, leaves less"
            )
        else:
            cause = "its detection unit: a finer one leaves less"
        lines.append(f"The control puts its values out in jumps, of {micrometres(jump)} at most here, from {cause}.")
    if done.table.step > done.shortest / 4:
        lines.append(
            f"Points every {format_quantity(done.table.step, 'm')} do not hold the periodic error of period "
            f"{format_quantity(done.shortest, 'm')}; {POINTS_PER_PERIOD} a period would. It stays as it is."
        )
    if done.of_time:
        names = ", ".join(done.of_time)
        lines.append(f"{names} changes with time and is in no table of positions: see --form sinumerik-temp.")
    lost = done.lost
    if lost is not None and abs(lost.wind_up) >= NOTICED:
        lines.append(f"{wind_up_words(lost)}. It is in no table: {CURE}.")
    if lost is not None and done.table.play > 0 and flank_words(lost):
        lines.append(flank_words(lost))
    both = done.prediction
    if both is not None and lost is not None and done.table.play > 0:
        stopped = abs(both.before.positioning.mean_reversal)
        if stopped < (1 - _OTHER) * lost.play:
            lines.append(
                f"In the simulated stops the reversal is {micrometres(stopped)} and not the play of "
                f"{micrometres(lost.play)}: the axis overshoots or the table coasts while it stops, and the value is "
                "too large there. A calmer position loop makes it less."
            )
    if both is not None and _thrown(done):
        worst = min(both.after.circular.glitch)
        lines.append(
            f"On reversal the value goes over so fast that the table is thrown across the play, {micrometres(-worst)} "
            f"inwards on the circle (largest contour error {micrometres(both.before.contour)} before, "
            f"{micrometres(both.after.contour)} after). Renewing the preload cures it."
        )
    if both is not None and both.usual_contour is not None:
        lines.append(_reversal_words(done, both.usual_contour))
    return lines


def _reversal_words(done: Compensated, usual: float) -> str:
    """Why the play goes over within the time stated, and what it is worth."""
    assert done.prediction is not None and done.prediction.circle is not None
    circle, reversal = done.prediction.circle, done.control.reversal
    within = f"{reversal.cycles} cycles" if reversal.cycles else f"{1e3 * reversal.spread:.1f} ms"
    return (
        f"The play goes over within {within}: chosen for the least contour error on the circle of "
        f"{1e3 * circle.radius:.3g} mm at {60 * circle.limits.velocity:.3g} m/min, "
        f"{micrometres(done.prediction.after.contour)} in place of {micrometres(usual)}. Quicker throws the table "
        "across, slower leaves it behind; the best time goes with the square root of play and of radius, and with 1 / "
        "feed."
    )


def _thrown(done: Compensated) -> bool:
    """Whether a quadrant goes inwards by a share of the play, and further than it did before."""
    both = done.prediction
    if both is None or done.table.play <= 0:
        return False
    before, after = (min(one.circular.glitch) for one in (both.before, both.after))
    return after < before and after < -_THROWN * done.table.play


def predicted_rows(done: Compensated) -> list[tuple[str, list[float | None]]]:
    """Figure to its value before, after repair (None where nothing is worn), after compensation [m]."""
    if done.prediction is None:
        return []
    kinds = (done.prediction.before, done.prediction.repaired, done.prediction.after)
    names: dict[str, Callable[[Figures], float]] = {
        "ISO 230-2 bidirectional accuracy A": lambda one: one.positioning.accuracy,
        "ISO 230-2 systematic deviation E": lambda one: one.positioning.systematic,
        "ISO 230-2 mean deviation M": lambda one: one.positioning.mean_range,
        "ISO 230-2 reversal value B": lambda one: one.positioning.reversal_value,
        "ISO 230-4 circular deviation G": lambda one: one.circular.deviation,
        "largest contour error of the circle": lambda one: one.contour,
    }
    return [(name, [None if one is None else float(of(one)) for one in kinds]) for name, of in names.items()]


def friction_lines(done: Compensated) -> list[str]:
    """Values for reversals, and what they bring."""
    found = done.friction
    if found is None:
        return []

    def glitch(one: Circular) -> str:
        return micrometres(max(one.glitch, key=abs))

    helps = max(map(abs, found.forward.glitch)) < max(map(abs, found.before.glitch))
    lines = [
        f"Friction feed-forward: {found.torque:.3g} N m at the motor with the sign of the set velocity, turning within "
        f"{found.turning:.3g} rad/s. Largest quadrant glitch, simulated with the table: {glitch(found.before)} before, "
        f"{glitch(found.forward)} with it{'' if helps else ': leave it off here'}.",
    ]
    if not found.share:
        return [*lines, "No pulse on the speed set-point makes the quadrants better."]
    pulse = f"{60e3 * found.pulse:.3g} mm/min, decaying with {1e3 * found.time:.3g} ms"
    lines.append(
        f"Or a pulse at each reversal on the speed set-point: {pulse}. Glitch with it: {glitch(found.pulsed)}."
    )
    if done.control.name.startswith("sinumerik"):
        axis = done.wishes.axis
        lines.append(
            f"MD32500 $MA_FRICT_COMP_ENABLE[{axis}] = 1, MD32510 FRICT_COMP_ADAPT_ENABLE = 0, MD32520 "
            f"FRICT_COMP_CONST_MAX = {60e3 * found.pulse:.3g} mm/min, MD32540 FRICT_COMP_TIME = {found.time:.3g} s "
            "(from experience: check the units of your release)."
        )
    return lines


def sections(done: Compensated) -> list[Section]:
    """The sheet, heading by heading."""
    step = f"every {format_quantity(done.table.step, 'm')}" if done.table.step else "as measured"
    ends = " to ".join(f"{1e3 * one:.6g} mm" for one in done.table.positions[[0, -1]])
    what = [
        f"{done.control.title}, axis {done.wishes.axis} of {plain_line(done.name)}.",
        f"{len(done.table)} points {step}, {ends}; 0 at {1e3 * done.table.reference:.6g} mm; steps of "
        f"{1e6 * done.control.resolution:g} um; play {micrometres(done.table.play)}.",
    ]
    found: list[Section] = [
        ("Table", what),
        ("Sign", [done.control.sign_rule, f"Source: {done.control.source}"]),
        ("Check of one point", check_of_one_point(done)),
        ("Load", done.control.loading(done.table, done.wishes.axis)),
    ]
    rows = predicted_rows(done)
    if rows:
        shown = [
            f"{name}: "
            + ", ".join(_shown(label, value) for label, value in zip(_LABELS, values, strict=True) if value is not None)
            for name, values in rows
        ]
        found.append(("Predicted by simulation, the table applied as this control does", shown))
    found.append(("What is left", left(done)))
    if friction_lines(done):
        found.append(("Friction at reversals", friction_lines(done)))
    if done.cogging is not None:
        before, after = (f"{1e9 * one:.3g} nm" for one in (done.cogging.before, done.cogging.after))
        line = f"The map beside this sheet takes the ripple of the position from {before} to {after} rms at 60 rev/min."
        found.append(("Cogging", [line]))
    return found


_LABELS = ("before", "after repair", "after compensation")


def _shown(label: str, value: float) -> str:
    return f"{label} {micrometres(value)}"


def sheet_text(found: Sequence[Section]) -> str:
    """The sheet as plain text."""
    blocks = ["\n".join([title, "-" * len(title), *(f"* {line}" for line in lines)]) for title, lines in found]
    return "\n\n".join(blocks) + "\n"


def record(done: Compensated) -> dict[str, Any]:
    """Everything as plain values, SI, for JSON."""
    table, lost, friction = done.table, done.lost, done.friction
    content: dict[str, Any] = {
        "form": done.control.name, "axis": done.wishes.axis, "machine": done.name,
        "reference": table.reference, "step": table.step or None, "resolution": done.control.resolution,
        "positions": table.positions.tolist(), "forward": table.forward.tolist(), "reverse": table.reverse.tolist(),
        "play": table.play, "sign_rule": done.control.sign_rule, "source": done.control.source,
        "check": check_of_one_point(done), "left": left(done), "left_by_table": done.left_by_table,
        "predicted": [
            dict(zip(("figure", "before", "repaired", "after"), [name, *values], strict=True))
            for name, values in predicted_rows(done)
        ],
    }  # fmt: skip
    if lost is not None:
        content["lost_motion"] = {
            "play": lost.play,
            "wind_up": lost.wind_up,
            "friction_force": lost.force,
            "weight": lost.weight,
            "friction_torque": lost.torque,
            "holding": lost.holding if math.isfinite(lost.holding) else None,
        }
    if friction is not None:
        content["friction"] = {
            "torque": friction.torque,
            "turning_speed": friction.turning,
            "pulse": friction.pulse,
            "pulse_time": friction.time,
            "share": friction.share,
        }
    return content
