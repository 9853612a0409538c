"""The straight line that CNCs accept for thermal errors, tabulated over one temperature.

    K(x) = K₀(T) + tan β(T) · (x - P₀)

| symbol | meaning | unit shown |
|---|---|---|
| K | compensation value | µm |
| P₀ | reference position of the axis | mm |
| K₀ | part that does not depend on the position | µm |
| tan β | slope | µm/m |
| T | reading of one sensor | degC |

Also known as: MD32750 (type), SD43900 K₀, SD43910 tan β, SD43920 P₀; temp_comp_offset_0, temp_comp_coefficient,
temp_comp_position_0. Inside K is the measured error, actual minus commanded position. Whether a control wants that or
what it is to add to the set-point (its negative) is stated by `Convention`; controls of one maker differ by release,
so move the axis by hand with a large K₀ and look before trusting either.

Two uses: the line through the estimate of model or observer, sent every minute (`straight_line`), leaves only the
curvature of the error. A fixed table over one temperature (`line_table`) leaves in addition what one temperature does
not tell: screw and nut warm and cool along different ways.
"""

from __future__ import annotations

from dataclasses import dataclass
from enum import Enum

import numpy as np

from feeddrive.errors import InputError
from feeddrive.metrology.finite import refuse_unknown
from feeddrive.thermal.rig import refuse_unless
from feeddrive.typing import FloatArray


class Convention(Enum):
    """What a control understands by K: the factor on the measured error."""

    MEASURED_ERROR = 1
    """Actual minus commanded position; the control moves the other way."""
    ADD_TO_SETPOINT = -1
    """What is added to the commanded position."""


@dataclass(frozen=True, eq=False)
class StraightLine:
    """Lines through errors along the stroke.

    Attributes:
        reference: P₀ [m].
        offset: K₀, measured error at P₀, (k,) [m].
        slope: tan β, (k,) [m/m].
    """

    reference: float
    offset: FloatArray
    slope: FloatArray

    def at(self, positions: FloatArray) -> FloatArray:
        """K at positions (p,) [m], measured error, (k, p) [m]."""
        return np.asarray(self.offset[:, None] + np.multiply.outer(self.slope, positions - self.reference))


def straight_line(error: FloatArray, positions: FloatArray, reference: float) -> StraightLine:
    """The lines of least squares through errors (k, p) [m] at two or more positions (p,), about P₀, `reference` [m]."""
    _refuse_misfit(error, positions)
    design = np.column_stack([np.ones(len(positions)), positions - reference])
    offset, slope = np.linalg.lstsq(design, error.T, rcond=None)[0]
    return StraightLine(reference, offset, slope)


@dataclass(frozen=True, eq=False)
class LineTable:
    """K₀ and tan β over breakpoints of one temperature, linear in between and constant beyond.

    Attributes:
        reference: P₀ [m].
        temperatures: breakpoints, ascending, (b,) [degC].
        offsets: K₀, measured error, (b,) [m].
        slopes: tan β, (b,) [m/m].
    """

    reference: float
    temperatures: FloatArray
    offsets: FloatArray
    slopes: FloatArray

    def line(self, temperatures: FloatArray) -> StraightLine:
        """The line at readings (k,) [degC]."""
        offset = np.interp(temperatures, self.temperatures, self.offsets)
        return StraightLine(self.reference, offset, np.interp(temperatures, self.temperatures, self.slopes))

    def text(self, convention: Convention) -> str:
        """The table as CSV in the units of controls, its convention and P₀ in lines that begin with #.

        Args:
            convention: what the control understands by K.
        """
        says = {
            Convention.MEASURED_ERROR: "K is the measured error, actual minus commanded position",
            Convention.ADD_TO_SETPOINT: "K is added to the commanded position",
        }
        head = [
            "# K(x) = K0(T) + tan_beta(T) * (x - P0)",
            f"# {says[convention]}",
            f"# P0 = {self.reference * 1e3:.3f} mm",
            "temperature [degC],K0 [um],tan_beta [um/m]",
        ]
        rows = np.column_stack([self.temperatures, convention.value * np.column_stack([self.offsets, self.slopes])])
        # + 0.0: no minus before a zero.
        return "\n".join([*head, *(f"{T:.2f},{K * 1e6 + 0.0:.2f},{b * 1e6 + 0.0:.2f}" for T, K, b in rows)]) + "\n"


def line_table(
    readings: FloatArray, error: FloatArray, positions: FloatArray, reference: float, count: int = 6
) -> LineTable:
    """The table of least squares over runs of the machine or of its model.

    Args:
        readings: of the sensor, (k,) [degC].
        error: at the same times, (k, p) [m].
        positions: at least two, (p,) [m].
        reference: P₀ [m].
        count: of breakpoints, evenly between the lowest and the highest reading.

    Raises:
        InputError: shapes that do not fit, fewer than two positions or breakpoints, a temperature that hardly moves.
    """
    refuse_unless(count >= 2, f"{count} breakpoints make no table", "count", "write at least 2")
    line = straight_line(error, positions, reference)
    if len(readings) != len(error):
        raise InputError(f"{len(readings)} readings for {len(error)} rows", "readings", "give one a row")
    refuse_unknown("readings", readings=readings)
    low, high = float(np.min(readings)), float(np.max(readings))
    moves = high - low > 0.5
    refuse_unless(moves, f"the sensor moves by {high - low:.2g} K only", "readings", "take a run that warms it")
    temperatures = np.linspace(low, high, count)
    hats = np.column_stack([np.interp(readings, temperatures, one) for one in np.eye(count)])
    # Where a breakpoint has no rows, the least change of slope decides; elsewhere it weighs a thousandth.
    bend = 1e-3 * np.sqrt(len(readings)) * np.diff(np.eye(count), n=2, axis=0)
    found = np.linalg.lstsq(
        np.vstack([hats, bend]),
        np.vstack([np.column_stack([line.offset, line.slope]), np.zeros((len(bend), 2))]),
        rcond=None,
    )[0]
    return LineTable(reference, temperatures, found[:, 0], found[:, 1])


def _refuse_misfit(error: FloatArray, positions: FloatArray) -> None:
    fits = np.ndim(error) == 2 and np.shape(error)[1:] == np.shape(positions) and len(positions) >= 2
    what = f"errors of shape {np.shape(error)} at {np.size(positions)} positions"
    refuse_unless(fits, what, "error", "give a row a time with one error a position, two positions at least")
    refuse_unknown("error", error=error, positions=positions)
