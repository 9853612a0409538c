"""What every form says of its control: sign rule and source, limits, how a table is applied, and the writer."""

from __future__ import annotations

import math
import re
from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace
from enum import StrEnum

from feeddrive.compensation.table import STEEPEST, CompensationTable
from feeddrive.errors import InputError
from feeddrive.units.quantity import format_quantity


class Side(StrEnum):
    """Where a control puts the value in: into the set-point of the motor, or into the actual value that it reads."""

    SETPOINT = "set-point"
    ACTUAL = "actual value"


@dataclass(frozen=True)
class Reversal:
    """How a control goes from the values of one direction to those of the other.

    Attributes:
        spread: time over which it does so evenly [s].
        cycles: position cycles over which it does so evenly, in place of a time.
        ramped: whether the whole value follows with half of the axis' limits of velocity and acceleration.
        smooth: whether by sin^2 in place of evenly.
        longest: time to which it may be set [s]; 0 where the control has no such setting.
        most_cycles: to which it may be set, where it counts cycles.
        setting: table, name of the axis and this reversal to the line that says how to set it.
    """

    spread: float = 0.0
    cycles: int = 0
    ramped: bool = False
    smooth: bool = False
    longest: float = 0.0
    most_cycles: int = 0
    setting: Callable[[CompensationTable, str, Reversal], str] | None = None

    def over(self, time: float, cycle: float) -> Reversal:
        """Set to a time [s], at a position cycle [s]."""
        time = min(time, self.longest)
        if not self.cycles:
            return replace(self, spread=time)
        return replace(self, cycles=min(max(1, round(time / cycle)), self.most_cycles))


@dataclass(frozen=True)
class Control:
    """A form of table and the control that reads it.

    Attributes:
        name: as of `--form`.
        title: of the control and its function.
        sign_rule: what the values in the file mean, against actual minus target.
        source: of the sign rule and the layout.
        resolution: of a value [m].
        most_points: that the control takes.
        usual_points: that smaller controls of the family take, and that are chosen where nobody asks for more.
        load: what to do with the file, and which settings it needs.
        write: table, lines for the head and name of the axis to the text of the file.
        steepest: change of the value per length that the control allows [m/m].
        side: where the value is put in.
        reversal: how it changes direction.
        directions: whether the table holds both directions; else play is a value of its own.
        comments: whether the format allows them.
        stepwise: whether the value jumps in the middle between two points, in place of a straight line.
    """

    name: str
    title: str
    sign_rule: str
    source: str
    resolution: float
    most_points: int
    usual_points: int
    load: Callable[[CompensationTable, str], tuple[str, ...]]
    write: Callable[[CompensationTable, Sequence[str], str], str]
    steepest: float = STEEPEST
    side: Side = Side.SETPOINT
    reversal: Reversal = Reversal()
    directions: bool = True
    comments: bool = True
    stepwise: bool = False

    def loading(self, table: CompensationTable, axis: str) -> tuple[str, ...]:
        """What to do with the file, and which settings it needs, that of the reversal among them."""
        setting = self.reversal.setting
        play = () if setting is None or not table.directions_differ else (setting(table, axis, self.reversal),)
        return (*self.load(table, axis), *play)

    def refuse_beyond_limits(self, table: CompensationTable) -> None:
        """Refuse a table that the control does not take.

        Raises:
            InputError: too many points, or too steep; says the limit and the mend.
        """
        if len(table) > self.most_points:
            width = float(table.positions[-1] - table.positions[0])
            least = format_quantity(_up(width / (self.most_points - 1)), "m")
            what = f"{len(table)} points, and {self.title} takes {self.most_points}"
            raise InputError(what, self.name, f"write --every {least} or more, or a shorter stroke")
        if table.steepest > self.steepest:
            what = f"the value changes by {1e3 * table.steepest:.3g} mm/m, and {self.title} allows "
            mend = "correct the lead (gear ratio, pulses per mm) first, or take points further apart"
            raise InputError(f"{what}{1e3 * self.steepest:.3g} mm/m", self.name, mend)


def _up(length: float) -> float:
    """A length rounded up to two digits, which print whole."""
    scale = 10.0 ** (1 - math.floor(math.log10(length)))
    return math.ceil(length * scale - 1e-9) / scale


_AXIS = re.compile(r"[A-Za-z][A-Za-z0-9_]{0,31}")


def checked_axis(axis: str) -> str:
    """The name of an axis, which goes into files that controls execute.

    Raises:
        InputError: anything but a letter and up to 31 letters, digits and underscores.
    """
    if not _AXIS.fullmatch(axis):
        mend = "write a letter, then letters, digits or _, such as X1"
        raise InputError(f'"{axis}" is no name of an axis', "axis", mend)
    return axis


def plain_line(text: str) -> str:
    """A text as one line of a comment: printable ASCII alone, so that nothing in it ends the comment."""
    one = text.replace("\N{MICRO SIGN}", "u").replace("\N{GREEK SMALL LETTER MU}", "u")
    return "".join(letter if " " <= letter <= "~" else "?" for letter in " ".join(one.split()))


def comments(lines: Sequence[str], mark: str = "#") -> list[str]:
    """Lines of a comment behind the mark of a file's language."""
    return [f"{mark} {plain_line(one)}" for one in lines]


def millimetres(value: float, digits: int) -> str:
    """A length in mm with that many digits behind the point, and no minus before zero."""
    return f"{round(value * 1e3, digits) + 0.0:.{digits}f}"


def steps(value: float, unit: float) -> int:
    """A length in whole units of a control."""
    return round(value / unit)
