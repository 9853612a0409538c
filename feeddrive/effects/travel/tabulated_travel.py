"""A travel error of no known name, as a table over the table position or over time.

    delta = f(s),  s = x, x within a period, or t

| symbol | key | meaning | unit |
|---|---|---|---|
| s = x | position | breakpoints along the stroke | m |
| s = t | time | breakpoints from the start of the recording | s |
| delta | travel | at the breakpoints; positive moves the nut forward | m |
| P | period | of a periodic table | m |

Over position conservative: it changes the geometry, and its reaction on the screw is F d(delta)/d(phi); over time a
source.
Source: no law, what was left of a recording (`feeddrive.diagnosis.unexplained.unexplained`).
"""

from __future__ import annotations

from collections.abc import Mapping
from typing import ClassVar

from feeddrive.effects.base import Parameter, Port, Signature, TravelEffect
from feeddrive.effects.tabulated import Tabulated
from feeddrive.typing import Expression


class TabulatedTravel(Tabulated, TravelEffect):
    """Travel deviation over one variable."""

    name = "tabulated_travel"
    ports = (Port.TRANSMISSION,)
    places = ("position", "periodic_position", "time")
    breakpoint_keys: ClassVar[dict[str, str]] = {
        "position": "position",
        "periodic_position": "position",
        "time": "time",
    }
    value_keys = ("travel",)
    parameters = (
        Parameter("position", "m", size=0.1, default=0.0, table=True),
        Parameter("time", "s", size=1.0, default=0.0, table=True),
        Parameter("travel", "m", -0.01, 0.01, size=1e-6, default=0.0, table=True),
        Parameter("period", "m", 0.0, 10.0, size=0.01, default=0.0),
    )
    signature = Signature(("table_position",), "its own variable", ("lead_error_periodic", "lead_error_cumulative"))

    def travel(
        self, angle: Expression, position: Expression, time: Expression, p: Mapping[str, Expression]
    ) -> Expression:
        """Travel deviation [m]."""
        return self.read_off(time if self.breakpoint_key == "time" else position, p, "travel")
