"""The figures that a scenario asks for (settling, circular deviation, ...), each as a table."""

from __future__ import annotations

from typing import Any

from feeddrive.interface.shown import Listing
from feeddrive.simulate.scenario.scenario_result import SERIES
from feeddrive.units.quantity import format_quantity

_LISTS = ("frequency", "magnitude", "phase", "coherence")
_SHOWN_POINTS = 12

_UNITS = {
    "m": "target overshoot deviation width displacement window rms maximum mean glitch radial_maximum radial_minimum "
    "stroke reversal",
    "s": "time rise settling average start end period at skip segment",
    "N m": "torque spread friction offset",
    "m/s": "velocity",
    "N": "force",
    "N/m": "stiffness",
    "J": "work",
    "rad": "lag",
}
"""SI unit to the keys that have it; others have none."""

_UNIT_OF = {key: unit for unit, keys in _UNITS.items() for key in keys.split()}


def figure_listing(one: dict[str, Any]) -> Listing:
    """The table of a figure.

    Args:
        one: plain values, as `feeddrive.metrology.evaluate.as_json` gives them.
    """
    title = one["kind"].replace("_", " ")
    if one["kind"] == "positioning":
        lengths = {key: value for key, value in one.items() if isinstance(value, float) and key != "average"}
        rows = [[key.replace("_", " "), format_quantity(value, "m")] for key, value in lengths.items()]
        return Listing(f"{title}, {one['standard']}", ("figure", "quantity"), rows)
    if "points" in one:
        keys = list(one["points"][0])
        rows = [[_shown(key, point[key]) for key in keys] for point in one["points"]]
        more = [["…"] + [""] * (len(keys) - 1)] if len(rows) > _SHOWN_POINTS else []
        return Listing(title, keys, rows[:_SHOWN_POINTS] + more)
    shown = {key: value for key, value in one.items() if key not in ("kind", *_LISTS)}
    rows = [[key.replace("_", " "), _shown(key, value, one)] for key, value in shown.items()]
    return Listing(title, ("figure", "quantity"), rows)


def _shown(key: str, value: Any, one: dict[str, Any] | None = None) -> str:
    if value is None:
        return {"time": "never", "settling": "not settled"}.get(key, "–")
    if isinstance(value, list):
        return ", ".join(_shown(key, item, one) for item in value)
    if isinstance(value, float):
        unit = SERIES[one["channel"]] if one is not None and key == "final" else _UNIT_OF.get(key, "1")
        if one is not None and one["kind"] == "step" and key == "overshoot":
            return f"{100 * value:.3g} %"
        return format_quantity(value, unit) if unit != "1" else f"{value:.5g}"
    return f"{value:+d}" if key == "direction" else str(value)
