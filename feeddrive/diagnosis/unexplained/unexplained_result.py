"""What is reported of the part that no named effect explains: plain records behind `diagnosis.json` and the report."""

from __future__ import annotations

from dataclasses import dataclass, field


@dataclass(frozen=True)
class Table:
    """A function as numbers, SI.

    Attributes:
        breakpoints: (k,).
        breakpoint_unit: unit of the variable.
        values: (k,); linear between the breakpoints, constant outside.
        errors: standard errors of the values, blocks of time taken as independent, (k,).
        unit: of the values.
        period: of the variable after which the table repeats; 0 where it does not.
    """

    breakpoints: tuple[float, ...]
    breakpoint_unit: str
    values: tuple[float, ...]
    errors: tuple[float, ...]
    unit: str
    period: float = 0.0


@dataclass(frozen=True)
class Seen:
    """What is left on the judged data over a variable, other terms taken out: means per bin, for the figure.

    Attributes:
        centre: of each bin, SI unit of the variable, (k,).
        mean: of what is left, SI unit of the table's values, (k,).
        error: standard error of the mean as if samples were independent, (k,).
    """

    centre: tuple[float, ...]
    mean: tuple[float, ...]
    error: tuple[float, ...]


@dataclass(frozen=True)
class Dependence:
    """A measured variable on which the unexplained part depends.

    Attributes:
        variable: name.
        share: of the squared residual of the fitted data that this term takes away on blocks not fitted.
        period: in words, where it is periodic.
        times: the second variable of a product, as "direction"; empty for a function of one variable.
        form: "curve", "periodic", "step" or "level".
        judged_share: of the squared residual of the judged data.
        confirmed: whether it lowers the error there.
        order: periods per motor revolution; 0 where it is not periodic.
        amplitude: half of what the table spans, unit of the table.
        statement: shape in words.
        table: shape in numbers.
        seen: for the figure.
        alike: other variables that these recordings cannot tell from it, products as "a x b".
    """

    variable: str
    share: float
    period: str | None = None
    times: str = ""
    form: str = ""
    judged_share: float | None = None
    confirmed: bool = True
    order: float = 0.0
    amplitude: float = 0.0
    statement: str = ""
    table: Table | None = None
    seen: Seen | None = None
    alike: tuple[str, ...] = ()


@dataclass(frozen=True)
class Carried:
    """A tabulated term that the plant carries.

    Attributes:
        name: of the effect, as "tabulated_force".
        port: where it acts.
        variable: of the table, as the plant file names it.
        table: what stands there.
        explains: channel to 1 - (rms with / rms without)^2 on the judged data.
        before: channel to the rms on the judged data without it, SI.
        after: channel to the rms with it, SI.
    """

    name: str
    port: str
    variable: str
    table: Table
    explains: dict[str, float]
    before: dict[str, float]
    after: dict[str, float]


@dataclass(frozen=True)
class Instead:
    """One table with which the declared plant does as well as with several named effects.

    Attributes:
        channel: where it was found.
        carried: the table; before: errors of the declared plant, after: with the table alone.
        names: of the effects that it takes the place of.
    """

    channel: str
    carried: Carried
    names: tuple[str, ...]


@dataclass(frozen=True)
class Above:
    """What the named effects leave on the judged data beside the noise.

    Attributes:
        share: of the squared rms above the noise floor; negative where the rms lies below it.
        standard_error: of the share.
        rms: of what is left, SI unit of the channel.
        floor: rms of the noise, SI unit of the channel.
        is_left: whether something is left.
    """

    share: float
    standard_error: float
    rms: float
    floor: float
    is_left: bool


@dataclass(frozen=True)
class Unexplained:
    """What is left of a channel above its noise.

    Attributes:
        share: of the measured signal's square, on the judged data.
        depends_on: variables, the strongest first.
        above: beside the noise.
        statement: all of it in words.
        carried: tabulated terms taken into the plant for it.
        not_carried: why terms that were found are not carried.
        share_after: share of the measured signal's square that is left with what is carried; None where nothing is.
        instead: one table that does as well as all named effects; None where there is none.
    """

    share: float
    depends_on: tuple[Dependence, ...] = ()
    above: Above | None = None
    statement: str = ""
    carried: tuple[Carried, ...] = ()
    not_carried: tuple[str, ...] = field(default=())
    share_after: float | None = None
    instead: Instead | None = None
