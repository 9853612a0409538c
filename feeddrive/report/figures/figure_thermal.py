"""Figures of a machine that warms up: temperatures and growth over time, and the field in shaft and nut."""

from __future__ import annotations

import math
from collections.abc import Sequence
from typing import TYPE_CHECKING

import numpy as np

from feeddrive.report.figures.drawing import (
    AFTER,
    BEFORE,
    MEASURED,
    NOISE,
    ReportFigure,
    dress,
    legend_above,
    new_figure,
)
from feeddrive.simulate.warm.warm_up_result import WarmUpRun
from feeddrive.thermal.full.full_model import FRONT, NUT, REAR, SHAFT, discretise
from feeddrive.thermal.full.grid import Cylinder
from feeddrive.thermal.run.study import ThermalStudy
from feeddrive.thermal.run.warm_up import channel_of
from feeddrive.typing import FloatArray
from feeddrive.units.quantity import format_quantity

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.collections import QuadMesh


HOURS_FROM = 4 * 3600.0
"""Duration from which time is drawn in hours [s]."""

_MAP, _SHADES = "YlOrRd", 14
_NAMES = {NUT: "nut", SHAFT: "shaft, mean over the travel", FRONT: "front bearing", REAR: "rear bearing"}
_COLOURS = {NUT: BEFORE, SHAFT: AFTER, FRONT: "#009e73", REAR: "#cc79a7"}


def thermal_figures(found: ThermalStudy) -> tuple[ReportFigure, ReportFigure]:
    """Warm-up over time, and the field at the end."""
    return warm_up_figure(found), field_figure(found)


def time_axis(duration: float) -> tuple[float, str]:
    """Factor from seconds and label of an axis of time: minutes, or hours for long runs."""
    return (1 / 3600, "time [h]") if duration >= HOURS_FROM else (1 / 60, "time [min]")


def warm_up_figure(found: ThermalStudy) -> ReportFigure:
    """Temperatures, growth at the table and, where it changes, the speed, over time."""
    duty = found.duty
    factor, label = time_axis(duty.duration)
    time = factor * np.concatenate([[0.0], duty.times])
    moving = not duty.is_constant
    figure = new_figure(7.0 if moving else 5.8)
    panels = figure.subplots(3 if moving else 2, 1, sharex=True, height_ratios=(3, 3, 1.3)[: 3 if moving else 2])
    _temperatures(panels[0], found, time)
    _growths(panels[1], found, time, factor)
    if moving:
        panels[2].step(time, 30 / math.pi * np.concatenate([duty.speeds[:1], duty.speeds]), where="pre", color=MEASURED)
        dress(panels[2], "", "speed [rev/min]", "speed of the screw")
    panels[-1].set_xlabel(label, fontsize=9)
    panels[-1].set_xlim(0, time[-1])
    return ReportFigure("thermal_warm_up", "Warm-up", _caption(found), figure)


def _temperatures(axes: Axes, found: ThermalStudy, time: FloatArray) -> None:
    first = float(found.duty.ambient[0])
    for name in _drawn(found):
        values = np.concatenate([[first], found.series[channel_of(name)]])
        axes.plot(
            time,
            values,
            color=_COLOURS.get(name),
            label=_NAMES.get(name, name.replace("_", " ")),
            ls="--" if name == REAR else "-",
        )
    axes.plot(time, np.concatenate([[first], found.duty.ambient]), color=NOISE, ls=":", label="air")
    dress(axes, "", "temperature [°C]")
    legend_above(axes, 5)


def _drawn(found: ThermalStudy) -> Sequence[str]:
    bodies = [body.name for body in found.heat.bodies]
    return [NUT, SHAFT, FRONT, REAR, *bodies]


def _growths(axes: Axes, found: ThermalStudy, time: FloatArray, factor: float) -> None:
    names = [name for name in found.warm_up if name != "growth_end"]
    shades = [AFTER, BEFORE, "#009e73", "#cc79a7", MEASURED]
    for name, colour in zip(names, shades * len(names), strict=False):
        values = 1e6 * np.concatenate([[0.0], found.series[f"table_{name}"]])
        warm = found.warm_up[name]
        axes.plot(time, values, color=colour, label=f"nut at {name.removeprefix('growth_').replace('mm', ' mm')}")
        axes.axhspan(
            1e6 * (warm.final - found.within), 1e6 * (warm.final + found.within), color=colour, alpha=0.12, lw=0
        )
        if factor * warm.time <= time[-1]:
            axes.plot(factor * warm.time, np.interp(factor * warm.time, time, values), "o", color=colour, ms=5)
    band = format_quantity(found.within, "m")
    dress(axes, "", "error at the table [µm]", f"growth from the fixed end; band: ± {band} about its final value")
    legend_above(axes, 4)


def _caption(found: ThermalStudy) -> str:
    name, slowest = max(((n, w) for n, w in found.warm_up.items() if n != "growth_end"), key=lambda pair: pair[1].time)
    place = name.removeprefix("growth_").replace("mm", " mm")
    end = format_quantity(slowest.final, "m")
    if not math.isfinite(slowest.time):
        return f"With the nut at {place} the error at the table reaches {end}."
    when = f"{slowest.time / 60:.0f} min"
    band = format_quantity(found.within, "m")
    return f"With the nut at {place} the error at the table stays within {band} of its final {end} from {when} on."


def field_figure(found: ThermalStudy) -> ReportFigure:
    """Temperature over length and radius of shaft and nut at the end of the run, the nut in mid-travel."""
    parts = discretise(found.heat.rig, found.heat.cells)
    start, state = float(found.duty.ambient[0]), found.states[-1]
    shaft = start + state[: parts.shaft.nodes].reshape(-1, parts.shaft.axial)
    nut = start + state[parts.shaft.nodes : parts.nodes].reshape(-1, parts.nut.axial)
    span = float(min(shaft.min(), nut.min())), float(max(shaft.max(), nut.max()))
    figure = new_figure(3.8)
    axes = figure.subplots()
    travel = found.heat.rig.travel
    at = (travel.low + travel.high - found.heat.rig.nut.length) / 2
    mesh = _cylinder(axes, parts.shaft, shaft, 0.0, span)
    _cylinder(axes, parts.nut, nut, at, span)
    bar = figure.colorbar(mesh, ax=axes, pad=0.02)
    bar.set_label("temperature [°C]", fontsize=9)
    bar.ax.tick_params(labelsize=8.5)
    _travel(axes, found)
    axes.set_ylim(0, 1.18e3 * found.heat.rig.nut.outer_radius)
    factor, label = time_axis(found.duty.duration)
    when = f"{factor * found.duty.duration:.4g} {label[6:-1]}"
    dress(
        axes,
        "distance from the front (fixed) end [mm]",
        "radius [mm]",
        f"after {when}; hottest {span[1]:.1f} °C, coldest {span[0]:.1f} °C; radii are stretched",
    )
    axes.grid(False)
    caption = f"Field after {when}, from {span[0]:.1f} to {span[1]:.1f} °C, the nut averaged over its travel."
    return ReportFigure("thermal_field", "Temperature in shaft and nut", caption, figure)


def _cylinder(axes: Axes, body: Cylinder, values: FloatArray, at: float, span: tuple[float, float]) -> QuadMesh:
    """Temperatures at the nodes, (radial + 1, axial), as a map of some shades, whose borders are isotherms."""
    from matplotlib import colormaps

    middle = (body.edges[1:] + body.edges[:-1]) / 2
    places = 1e3 * (at + np.concatenate([body.edges[:1], middle, body.edges[-1:]]))
    wide = np.column_stack([values[:, :1], values, values[:, -1:]])
    shades = colormaps[_MAP].resampled(_SHADES)
    mesh = axes.pcolormesh(places, 1e3 * body.radii, wide, shading="gouraud", cmap=shades, vmin=span[0], vmax=span[1])
    low, high = 1e3 * body.radii[0], 1e3 * body.radii[-1]
    axes.plot(
        [places[0], places[-1], places[-1], places[0], places[0]], [low, low, high, high, low], color="#555555", lw=0.8
    )
    return mesh


def _travel(axes: Axes, found: ThermalStudy) -> None:
    """The stretch that the nut sweeps, as an arrow above it."""
    rig = found.heat.rig
    half, height = rig.nut.length / 2, 1.08e3 * rig.nut.outer_radius
    ends = 1e3 * (rig.travel.low - half), 1e3 * (rig.travel.high + half)
    axes.annotate("", (ends[0], height), (ends[1], height), arrowprops={"arrowstyle": "<->", "color": "#555555"})
    axes.text(ends[1] + 6, height, "swept by the nut", fontsize=8.5, color="#333333", va="center")


_GREEN, _PINK = "#009e73", "#cc79a7"
_PARTS = {
    NUT: ("nut", BEFORE),
    SHAFT: ("shaft at the nut", AFTER),
    FRONT: ("front bearing", _GREEN),
    REAR: ("rear bearing", _PINK),
}


def warm_axis_figure(run: WarmUpRun) -> ReportFigure:
    """Four panels over the run's time."""
    factor, label = time_axis(float(run.time[-1]))
    time = factor * run.time
    figure = new_figure(9.4)
    heat, error, torque, preload = figure.subplots(4, 1, sharex=True, height_ratios=(3, 3, 2.6, 1.8))
    _node_temperatures(heat, run, time)
    _errors(error, run, time)
    _torques(torque, run, time)
    preload.plot(time, 1e-3 * run.figure_of_cycle("preload"), ".-", color=MEASURED)
    dress(preload, label, "preload [kN]", "preload of the nut; the marks are the cycles that were simulated")
    preload.set_xlim(0, time[-1])
    return ReportFigure("warm_axis", "An axis that warms up", _warm_caption(run), figure)


def _node_temperatures(axes: Axes, run: WarmUpRun, time: FloatArray) -> None:
    for name, (words, colour) in _PARTS.items():
        axes.plot(time, run.temperature(name), color=colour, label=words)
    shades = (NOISE, "#5c5c5c", "#b08d57", "#7f7f00")
    for body, shade in zip(run.thermal.bodies, shades * len(run.thermal.bodies), strict=False):
        axes.plot(time, run.temperature(body.name), color=shade, ls="--", label=body.name.replace("_", " "))
    dress(axes, "", "temperature [°C]")
    legend_above(axes, 4)


def _errors(axes: Axes, run: WarmUpRun, time: FloatArray) -> None:
    for i, colour in zip(np.argsort(run.stops), (AFTER, BEFORE, _GREEN, _PINK) * len(run.stops), strict=False):
        axes.plot(time, 1e6 * run.stop_errors[:, i], color=colour, label=f"table at {1e3 * run.stops[i]:.4g} mm")
    dress(axes, "", "position error [µm]", "table position less target, at rest")
    legend_above(axes, 4)


def _torques(axes: Axes, run: WarmUpRun, time: FloatArray) -> None:
    axes.plot(time, run.figure_of_cycle("nut_torque"), color=BEFORE, label="nut")
    axes.plot(time, run.figure_of_cycle("bearing_torque"), color=_GREEN, label="bearings")
    axes.set_ylim(0, None)
    dress(axes, "", "drag torque [N m]", "at the screw, mean over the way of a cycle")
    legend_above(axes, 4)


def _warm_caption(run: WarmUpRun) -> str:
    nut, errors = run.figure_of_cycle("nut_torque"), run.stop_errors
    worst = int(np.argmax(np.abs(errors[-1])))
    return (
        f"After {run.time[-1] / 3600:.3g} h the table is {1e6 * errors[-1, worst]:.1f} µm off at "
        f"{1e3 * run.stops[worst]:.4g} mm, and the nut drags with {nut[-1]:.3g} in place of {nut[0]:.3g} N m. "
        f"{run.cycles} cycles of {run.cycle_duration:.3g} s were simulated; of the work in "
        f"{100 * abs(run.energy.imbalance):.2g} % is not accounted for."
    )
