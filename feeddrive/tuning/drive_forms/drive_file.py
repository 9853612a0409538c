"""Files of drive parameters: one line for each, what it is behind it; written, and read back by the same definitions.

p1460[0] = 3.9800      # N m s/rad, speed controller P gain
setp pid.position.Pgain 160.000      # 1/s, K_v            (LinuxCNC)
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from pathlib import Path

from feeddrive.errors import InputError, printable
from feeddrive.schema.toml_text import nearest
from feeddrive.tuning.drive_forms import ax5000, heidenhain, linuxcnc, sinamics
from feeddrive.tuning.drive_forms.parameter import DriveForm, Facts, Line, LoopSettings, Parameter
from feeddrive.tuning.filter_choice import FilterChoice, FilterLimits

MOST_BYTES = 1_000_000
"""A file of a few lines; a larger one is something else."""


@dataclass(frozen=True)
class Writer:
    """A form with what writes and reads it."""

    form: DriveForm
    limits: FilterLimits
    lines: Callable[[LoopSettings, Facts], list[Line]]
    known: Callable[[], tuple[Parameter, ...]]
    settings: Callable[[dict[str, float], Facts], LoopSettings]


_MODULES = (sinamics, ax5000, heidenhain, linuxcnc)
WRITERS: dict[str, Writer] = {
    one.FORM.name: Writer(one.FORM, one.LIMITS, one.lines, one.known, one.settings) for one in _MODULES
}
UNPUBLISHED = {
    "fanuc": "FANUC sets the velocity gain as a share of a standard value of each motor (B-65270EN), and that value, "
    "like the filters, stands in no public page that could be read",
}
"""Forms that are asked for and cannot be written, with the reason."""


def writer_of(name: str, where: str = "form") -> Writer:
    """What writes and reads a form.

    Raises:
        InputError: an unknown form, or one whose units are not published.
    """
    if name in UNPUBLISHED:
        raise InputError(UNPUBLISHED[name], where, "take K_v, K_p, T_n and the filters from controller.toml")
    if name not in WRITERS:
        raise InputError(f'"{name}" is not possible', where, nearest(name, [*WRITERS, *UNPUBLISHED]))
    return WRITERS[name]


def fits(filters: Sequence[FilterChoice], limits: FilterLimits) -> bool:
    """Whether a drive has these filters."""
    return len(filters) <= limits.most and all(
        (limits.notch if one.kind == "notch" else limits.low_pass)
        and limits.frequency[0] <= one.frequency <= limits.frequency[1]
        and limits.damping[0] <= one.damping <= limits.damping[1]
        and (one.kind == "PT2" or limits.depth[0] <= one.depth <= limits.depth[1])
        and (not limits.whole_hertz or one.frequency == round(one.frequency))
        for one in filters
    )


def drive_text(form: DriveForm, lines: Sequence[Line], remarks: Sequence[str]) -> str:
    """The file: what it is, remarks, sources, and the lines."""
    head = [f"{form.title}: {form.where}", *remarks, *(f"source: {source}" for source in form.sources)]
    comments = [f"# {printable(text)}" for text in head]
    return "\n".join([*comments, "", *(_written(form, line) for line in lines)]) + "\n"


def _written(form: DriveForm, line: Line) -> str:
    one = line.parameter
    comment = ", ".join(part for part in (one.unit, one.meaning) if part)
    if form.name == "linuxcnc":
        return f"setp {one.name} {line.text}    # {comment}"
    return f"{one.name} = {line.text}    # {comment}"


def read_drive_file(path: Path, name: str, facts: Facts) -> LoopSettings:
    """The loop that a file of drive parameters of a form sets; its comments begin with # or ;

    Raises InputError: not readable, a line that is none, an unknown parameter, one twice, a value that is no number.
    """
    writer = writer_of(name, str(path))
    ranges = {one.name: one for one in writer.known()}
    values: dict[str, float] = {}
    for number, line in enumerate(_lines_of(path), 1):
        content = line.split("#")[0].split(";")[0].strip().removeprefix("setp ")
        if not content:
            continue
        where = f"{path}, line {number}"
        key, _, written = content.replace("=", " ", 1).strip().partition(" ")
        if key not in ranges:
            raise InputError(f'unknown parameter "{printable(key)}"', where, nearest(key, list(ranges)))
        if key in values:
            raise InputError(f"{key} is set twice", where, "keep one of them")
        values[key] = _number(written.strip(), ranges[key], where)
    return writer.settings(values, facts)


def _lines_of(path: Path) -> list[str]:
    try:
        if path.stat().st_size > MOST_BYTES:
            raise InputError("is too large for a file of drive parameters", str(path), "give the lines alone")
        return path.read_text(encoding="utf-8").splitlines()
    except (OSError, UnicodeDecodeError) as error:
        raise InputError(f"cannot be read: {type(error).__name__}", str(path), "give a text file") from None


def _number(written: str, parameter: Parameter, where: str) -> float:
    try:
        value = float(written)
    except ValueError:
        mend = f"write a number in {parameter.unit}" if parameter.unit else "write a number"
        raise InputError(f'"{printable(written)}" is no number', where, mend) from None
    if not parameter.lowest <= value <= parameter.highest:
        what = f"{parameter.name} = {value:g} is outside {parameter.lowest:g} to {parameter.highest:g} {parameter.unit}"
        raise InputError(what.strip(), where, "check its unit")
    return value
