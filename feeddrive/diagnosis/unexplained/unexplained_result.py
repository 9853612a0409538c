"""What no named effect explains: the records behind the report, their keys in `diagnosis.json`, their sentences."""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from typing import Any

from feeddrive.effects.tabulated import Tabulated
from feeddrive.units.quantity import format_quantity, percent

ABOVE = 3.0
"""Standard errors by which the rms must stand above the floor for something to be left."""

MATERIAL = 0.03
"""Share of the squared rms below which what is left is not worth a word: a percent and a half of the rms."""

CHANGE = 0.01
"""Share of the rms by which an error must change to be mentioned."""

WORDS = {
    "motor_angle": "the motor angle",
    "predicted_torque": "the torque that the plant predicts",
    "travel_since_reversal": "the travel since the last reversal",
    "direction": "the direction",
    "time": "time",
}
"""Variables in a sentence."""


@dataclass(frozen=True)
class Table:
    """A function as numbers, SI.

    Attributes:
        breakpoints: (k,).
        breakpoint_unit: unit of the variable.
        values: (k,); linear between the breakpoints, constant outside.
        errors: standard errors of the values, blocks of time taken as independent, (k,); empty where not known.
        unit: of the values.
        period: of the variable after which the table repeats; 0 where it does not.
    """

    breakpoints: tuple[float, ...]
    breakpoint_unit: str
    values: tuple[float, ...]
    errors: tuple[float, ...]
    unit: str
    period: float = 0.0

    def record(self) -> dict[str, Any]:
        """Its keys in `diagnosis.json`."""
        return {
            "breakpoints": list(self.breakpoints), "breakpoint_unit": self.breakpoint_unit,
            "values": list(self.values), "unit": self.unit,
            **({"standard_errors": list(self.errors)} if self.errors else {}),
            **({"period": self.period} if self.period else {}),
        }  # fmt: skip


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

    @property
    def words(self) -> str:
        """The term in a sentence: its variable, the second one, its period."""
        name = _in_words(self.variable) + (f" and {_in_words(self.times)} together" if self.times else "")
        return f"{name}, period {self.period}" if self.period else name

    def record(self) -> dict[str, Any]:
        """Its keys in `diagnosis.json`."""
        record: dict[str, Any] = {"variable": self.variable, "share": self.share}
        if self.times:
            record["times"] = self.times
        if self.period:
            record |= {"period": self.period, "order": self.order}
        if self.table is not None:
            record |= {"form": self.form, "shape": self.statement, "amplitude": self.amplitude}
            record |= {"table": self.table.record(), "share_judged": self.judged_share, "confirmed": self.confirmed}
        return record | ({"cannot_be_told_from": list(self.alike)} if self.alike else {})


def _in_words(variable: str) -> str:
    return WORDS.get(variable, f"the {variable.replace('_', ' ')}")


@dataclass(frozen=True)
class Carried:
    """A term as a tabulated effect of the plant, on the judged data.

    Attributes:
        channel: where the term was found.
        effect: with its values.
        explains: channel to 1 - (rms with / rms without)^2.
        before: channel to the rms without it, SI.
        after: channel to the rms with it, SI.
        pays: whether it lowers the error by as much as is asked of a named effect, and harms no channel.
        curve_of: name of the law that has another form than ours, whose curve it is; empty for a term of no name.
    """

    channel: str
    effect: Tabulated
    explains: dict[str, float]
    before: dict[str, float]
    after: dict[str, float]
    pays: bool
    curve_of: str = ""

    @property
    def name(self) -> str:
        """The effect's, as "tabulated_force"."""
        return self.effect.name

    @property
    def variable(self) -> str:
        """Variable of the table, as the plant file names it."""
        return self.effect.place

    @property
    def table(self) -> Table:
        """What stands there."""
        one, values = self.effect, self.effect.tables[0]
        units = [one.parameter(key).unit for key in (one.breakpoint_key, values)]
        return Table(one.breakpoints, units[0], one.table(values), (), units[1], one.period)

    @property
    def remark(self) -> str:
        """What it explains, beside it in the plant file."""
        shares = ", ".join(f"{percent(share, 1)} of {name}" for name, share in self.explains.items() if share > 0.001)
        word = self.variable.replace("periodic_", "the period of the ").replace("_", " ")
        what = (
            f"What {self.curve_of} leaves, whose form is another"
            if self.curve_of
            else "Of no known name: what was left"
        )
        return f"{what}, as a table over {word}. Explains {shares} on data not fitted."

    def record(self) -> dict[str, Any]:
        """Its keys in `diagnosis.json`."""
        return {
            "name": self.name, "port": str(self.effect.port), "variable": self.variable, **self.table.record(),
            "explains": self.explains, "rms_without": self.before, "rms_with": self.after,
            **({"curve_of": self.curve_of} if self.curve_of else {}),
        }  # fmt: skip


@dataclass(frozen=True)
class Instead:
    """One table in the declared plant against all named effects together, on the judged data.

    Attributes:
        carried: the table; before: errors of the declared plant, after: with the table alone.
        names: of the effects.
        as_good: whether the judged data do not speak for the named effects.
        better: whether they speak for the table by as much as is asked of an effect.
        mostly: whether the named effects take more than half of what the table takes of the squared error.
    """

    carried: Carried
    names: tuple[str, ...]
    as_good: bool
    better: bool
    mostly: bool


@dataclass(frozen=True)
class Above:
    """What is left of a channel on the judged data beside the noise.

    Attributes:
        share: of the squared rms above the noise floor; negative where the rms lies below it.
        standard_error: of the share.
        rms: of what is left, SI unit of the channel.
        floor: rms of the noise, SI unit of the channel.
    """

    share: float
    standard_error: float
    rms: float
    floor: float

    @property
    def is_left(self) -> bool:
        """Whether something is left above the noise."""
        return bool(self.share > max(ABOVE * self.standard_error, MATERIAL))


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
    not_carried: tuple[str, ...] = ()
    share_after: float | None = None
    instead: Instead | None = None

    def record(self) -> dict[str, Any]:
        """Its keys in `diagnosis.json`."""
        record: dict[str, Any] = {"share": self.share, "depends_on": [one.record() for one in self.depends_on]}
        if self.above is not None:
            above = self.above
            record["above_noise"] = {
                "share_of_rest": above.share, "standard_error": above.standard_error, "rms": above.rms,
                "noise_floor": above.floor, "is_left": above.is_left,
            }  # fmt: skip
        record |= {"statement": self.statement, "carried": [one.record() for one in self.carried]}
        if self.not_carried:
            record["not_carried"] = list(self.not_carried)
        if self.share_after is not None:
            record["share_after"] = self.share_after
        if self.instead is not None:
            record["instead"] = {"of": list(self.instead.names), **self.instead.carried.record()}
        return record


def no_gain(explains: Mapping[str, float]) -> str:
    """Why a tabulated effect is not carried that does not pay on the judged data."""
    shares = ", ".join(
        f"{percent(share, 1)} of {name}"
        if share > -1
        else f"with it {name} is missed {math.sqrt(1 - share):.2g} times as far"
        for name, share in explains.items()
    )
    return f"not carried, since a table of it does not lower the error on data not fitted enough ({shares})"


def beside_changes(left: Mapping[str, Unexplained]) -> dict[str, Unexplained]:
    """What is left of judged recordings with what differs in them allowed for, said so."""
    said = "What differs in the judged recordings is allowed for here."
    return {name: replace(one, statement=f"{said} {one.statement}") for name, one in left.items()}


def rest_in_words(unit: str, rest: Unexplained, lost: Sequence[Dependence], after: float | None) -> str:
    """Everything about what is left of a channel.

    Args:
        unit: of the channel.
        rest: figures of what is left.
        lost: dependences that the judged data do not confirm.
        after: rms with what is carried; None where nothing is.
    """
    above = rest.above
    assert above is not None
    rms, floor = format_quantity(above.rms, unit), format_quantity(above.floor, unit)
    share = f"{percent(above.share)} ± {percent(2 * above.standard_error)} of its square"
    if above.is_left:
        sentences = [f"Left on the judged data: {rms} rms, noise floor {floor} rms; {share} is above the noise."]
    else:
        surely = "surely " if above.share > 2 * above.standard_error else ""
        sentences = [f"Nothing is left {surely}above the noise: {rms} rms on the judged data, noise floor {floor} rms "
                     f"({share} above it)."]  # fmt: skip
    if rest.depends_on:
        sentences.append(f"It follows {'; '.join(_followed(one) for one in rest.depends_on)}.")
    elif above.is_left:
        sentences.append("It follows none of the measured variables.")
    if lost:
        names = "; ".join(one.words for one in lost)
        sentences.append(f"Seen on the fitted data and not confirmed on the judged: {names}.")
    if after is not None and abs(after - above.rms) > CHANGE * above.rms:
        sentences.append(f"With what the plant carries as tables: {rms} → {format_quantity(after, unit)} rms.")
    if rest.instead is not None:
        sentences.append(_instead(rest.instead))
    return " ".join([*sentences, *(f"{reason[:1].upper()}{reason[1:]}." for reason in rest.not_carried)])


def _followed(one: Dependence) -> str:
    also = f" (or {', '.join(one.alike)}: these recordings cannot tell)" if one.alike else ""
    seen = "" if one.confirmed else ", not confirmed on the judged data"
    return f"{one.words} ({percent(one.share)} of it: {one.statement}{seen}){also}"


def _instead(one: Instead) -> str:
    table = one.carried.table
    over = one.carried.variable.replace("periodic_", "one period of the ").replace("_", " ")
    period = f" ({format_quantity(table.period, table.breakpoint_unit)})" if table.period else ""
    return (
        f"One {one.carried.name.replace('_', ' ')} over {over}{period} does as well on the judged data as "
        f"{' and '.join(one.names)} together: these names may stand in for one effect that has none."
    )
