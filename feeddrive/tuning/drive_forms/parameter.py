"""A parameter of a drive: its name, unit and resolution, and how a value in SI becomes one that can be typed in."""

from __future__ import annotations

import math
from dataclasses import dataclass, replace

from feeddrive.errors import InputError
from feeddrive.servo.cascade import Cascade
from feeddrive.servo.filters import Filter
from feeddrive.tuning.filter_choice import FilterChoice


@dataclass(frozen=True)
class LoopSettings:
    """What a drive form carries of a cascade, SI.

    Attributes:
        velocity_gain: K_p [N m s/rad].
        reset_time: T_n [s]; infinite without integrator.
        position_gain: K_v [1/s].
        filters: of the torque command.
    """

    velocity_gain: float
    reset_time: float
    position_gain: float
    filters: tuple[FilterChoice, ...] = ()

    def on(self, cascade: Cascade) -> Cascade:
        """The cascade with these settings; its rates, delays, limits and feed-forward stay."""
        made: tuple[Filter, ...] = tuple(choice.filter for choice in self.filters)
        return replace(
            cascade,
            velocity_gain=self.velocity_gain,
            reset_time=self.reset_time,
            tracking_time=self.reset_time,
            position_gain=self.position_gain,
            torque_filters=made,
        )


@dataclass(frozen=True)
class Facts:
    """What a form needs to know of the axis.

    Attributes:
        radius: table travel per motor angle [m/rad].
        torque_constant: [N m/A], None where it is not declared.
        velocity_rate, position_rate: of the loops [Hz].
    """

    radius: float
    torque_constant: float | None
    velocity_rate: float
    position_rate: float


@dataclass(frozen=True)
class Parameter:
    """A parameter as its maker defines it.

    Attributes:
        name: of it.
        unit: as it is typed in; empty where it has none.
        meaning: in a few words.
        per_si: its value for 1 in SI.
        decimals: after the point.
        lowest, highest: what may be typed in.
        source: document and page.
    """

    name: str
    unit: str
    meaning: str
    per_si: float
    decimals: int
    lowest: float
    highest: float
    source: str

    @property
    def resolution(self) -> float:
        """Least difference of two values, in its unit."""
        return float(10.0**-self.decimals)

    def line(self, value: float, away: int = 0) -> Line:
        """The parameter set to a value in SI, rounded down (`away` -1), up (1) or to the nearest (0).

        Raises InputError where it lies outside what the drive takes.
        """
        number = value * self.per_si / self.resolution
        whole = {-1: math.floor(number + 1e-6), 0: round(number), 1: math.ceil(number - 1e-6)}[away]
        typed = round(whole * self.resolution, self.decimals)
        if not self.lowest <= typed <= self.highest:
            what = (
                f"{self.name} would be {typed:g} {self.unit}, and the drive takes {self.lowest:g} to {self.highest:g}"
            )
            raise InputError(what, self.name, "ask for other margins or another form")
        return Line(self, typed)


@dataclass(frozen=True)
class Line:
    """A parameter and the number typed in."""

    parameter: Parameter
    typed: float

    @property
    def value(self) -> float:
        """SI."""
        return self.typed / self.parameter.per_si

    @property
    def text(self) -> str:
        """The number as typed."""
        return f"{self.typed:.{self.parameter.decimals}f}"


@dataclass(frozen=True)
class DriveForm:
    """How a drive names the settings of a cascade.

    Attributes:
        name: for `--form`.
        title: of drive and control.
        where: what the lines are and where they are typed in.
        sources: of the form as a whole.
    """

    name: str
    title: str
    where: str
    sources: tuple[str, ...]


def wanted(values: dict[str, float], name: str, form: str) -> float:
    """A value of a file that must be there.

    Raises:
        InputError: it is not.
    """
    if name not in values:
        raise InputError(f"{name} is missing", form, f"write a line {name} = ...")
    return values[name]
