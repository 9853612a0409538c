"""Back to the control: tables against lead errors, backlash and heat, with what they will bring."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass, replace
from pathlib import Path
from typing import TYPE_CHECKING, Any, TypeAlias

from feeddrive.compensation import sheet
from feeddrive.compensation.actions import unsure_of_play
from feeddrive.compensation.compensate import Compensated, Wishes, compensate_plant, compensate_recording
from feeddrive.compensation.deviations import recorded_deviations
from feeddrive.compensation.forms.all_forms import FORMS, HEAT
from feeddrive.compensation.forms.control import checked_axis
from feeddrive.compensation.heat import heat_sheet
from feeddrive.compensation.temperature import HeatTable, heat_table, recorded_heat_table
from feeddrive.errors import InputError
from feeddrive.files import shipped_plants, write_text_atomically
from feeddrive.interface.axis import Axis, load
from feeddrive.interface.measured.reading import as_recording, diagnosis_content
from feeddrive.interface.quantities import Quantity, positive, quantities, si
from feeddrive.interface.servo import Servo, cascade_for
from feeddrive.interface.shown import Listing, Shown
from feeddrive.recording.recording import Recording
from feeddrive.schema.toml_text import nearest
from feeddrive.servo.cascade import Cascade
from feeddrive.units.quantity import format_quantity

if TYPE_CHECKING:
    from feeddrive.interface.measured.diagnosed import Diagnosed
    from feeddrive.report.figures.drawing import ReportFigure

Source: TypeAlias = "Axis | Diagnosed | Recording | str | Path"


@dataclass(frozen=True, repr=False, eq=False)
class Compensation(Shown):
    """A compensation: the file for the control, and the sheet that belongs to it.

    Attributes:
        done: table, prediction and values beside it, SI; of heat the table over the sensor.
        axis: name of the axis in the control.
    """

    done: Compensated | HeatTable
    axis: str

    @property
    def text(self) -> str:
        """The file for the control."""
        return heat_sheet.heat_text(self.done, self.axis) if isinstance(self.done, HeatTable) else sheet.text(self.done)

    @property
    def sheet_text(self) -> str:
        """Sign rule with its source, check of one point, loading, prediction, what is left, other values."""
        return sheet.sheet_text(self._sections())

    @property
    def left(self) -> tuple[str, ...]:
        """What no table takes away, and why."""
        return tuple(next(lines for title, lines in self._sections() if title == "What is left"))

    @property
    def files(self) -> dict[str, str]:
        """Ending of a file's name to its text, in the order in which they are written; "" is the file itself."""
        found = {".txt": self.sheet_text}
        if isinstance(self.done, Compensated) and self.done.cogging is not None:
            found["_cogging.csv"] = self.done.cogging.text
        return found | {"": self.text}

    def record(self) -> dict[str, Any]:
        """Everything as plain values, SI."""
        if isinstance(self.done, HeatTable):
            return heat_sheet.heat_record(self.done, self.axis)
        return sheet.record(self.done)

    def save(self, path: str | Path) -> Path:
        """Write the file, its sheet beside it (name + ".txt"), and a cogging map where there is one.

        Raises:
            InputError: a file cannot be written; the file for the control comes last, so that it never stands alone.
        """
        target = Path(path)
        if target.name in ("", ".", ".."):
            raise InputError("is no name of a file", str(path), "write a name such as enc_comp.ini")
        for ending, text in self.files.items():
            write_text_atomically(target.with_name(target.name + ending), text)
        return target

    def listing(self) -> Listing:
        """Predicted figures before, after repair and after compensation; of a recording the table."""
        if isinstance(self.done, HeatTable):
            return _heat_listing(self.done)
        rows = sheet.predicted_rows(self.done)
        if rows:
            shown = [
                [name, *("" if one is None else format_quantity(one, "m") for one in values)] for name, values in rows
            ]
            records = [
                dict(
                    zip(
                        ("figure", "before [m]", "after repair [m]", "after compensation [m]"),
                        [name, *values],
                        strict=True,
                    )
                )
                for name, values in rows
            ]
            headings = ("predicted", "before", "after repair", "after compensation")
            return Listing(f"{self.done.name}: {self.done.control.title}", headings, shown, records)
        table = self.done.table
        points = list(zip(table.positions.tolist(), table.forward.tolist(), table.reverse.tolist(), strict=True))
        return Listing(
            f"{self.done.name}: {self.done.control.title}",
            ("position", "along +", "along -"),
            [[format_quantity(one, "m") for one in point] for point in points],
            [dict(zip(("position [m]", "forward [m]", "reverse [m]"), point, strict=True)) for point in points],
        )

    def __repr__(self) -> str:
        """The table and what is left."""
        return "\n".join([self.listing().text(), *(f"left: {line}" for line in self.left)])

    def _sections(self) -> Sequence[sheet.Section]:
        if isinstance(self.done, HeatTable):
            return heat_sheet.heat_sections(self.done, self.axis)
        return sheet.sections(self.done)

    def _figures(self) -> Sequence[ReportFigure]:
        from feeddrive.report.figures.figure_compensation import compensation_figures, heat_figure

        return [heat_figure(self.done)] if isinstance(self.done, HeatTable) else list(compensation_figures(self.done))


def compensate(
    source: Source,
    form: str = "csv",
    *,
    every: Quantity | None = None,
    reference: Quantity | None = None,
    stroke: Sequence[Quantity] | None = None,
    axis: str = "X",
    controller: Servo | str | Path | None = None,
    lead: Quantity | None = None,
    resolution: Quantity | None = None,
) -> Compensation:
    """Write what is known of an axis as a table that its control reads, and predict what it brings.

    Args:
        source: a diagnosis (its folder, or what `diagnose` gave), an axis or plant file with lead errors, backlash or
            heat, or a recording with a scale.
        form: "linuxcnc", "sinumerik-enc", "sinumerik-cec", "sinumerik-temp", "isg", "heidenhain-csv",
            "fanuc-parameters" or "csv".
        every: distance of the points; chosen by the shortest period and the control's limits if left out.
        reference: position at which the axis is referenced, where the table is 0; of "sinumerik-temp" P0.
        stroke: least and greatest position of the table; that of the machine, else of what was recorded, if left out.
        axis: name of the axis in the control.
        controller: with which the prediction runs, closed at the motor; the declared or a recommended one if left out.
        lead: nominal travel per revolution of the motor, for recordings of a motor angle.
        resolution: of a value in the control, where it is other than usual.

    Raises:
        InputError: nothing that a table may hold (wind-up is no play), limits of the control, or a source that cannot
            be used; one line with the remedy.

    >>> import feeddrive as fd
    >>> try:
    ...     fd.compensate("kimm_testbed", "linuxcnc")  # friction and compliance, no play
    ... except fd.InputError as refused:
    ...     "wind-up, not play" in str(refused)
    True
    """
    if form not in FORMS:
        raise InputError(f'no form "{form}"', "form", nearest(str(form), FORMS))
    wishes = Wishes(
        form,
        None if every is None else positive(every, "m", "every", "10 mm"),
        None if reference is None else si(reference, "m", "reference"),
        _ends(stroke),
        checked_axis(axis),
        None if resolution is None else positive(resolution, "m", "resolution", "0.1 um"),
    )
    travel = None if lead is None else positive(lead, "m", "lead", "10 mm")
    found, unsure, where, recorded = _opened(source)
    if isinstance(found, Recording):
        if form == HEAT:
            return Compensation(recorded_heat_table(found, wishes.reference), axis)
        radius = None if travel is None else travel / (2 * math.pi)
        measured = recorded_deviations(found, radius, travel)
        return Compensation(compensate_recording(found.name, measured, wishes, travel or math.inf), axis)
    if form == HEAT:
        if not found.has_heat:
            raise InputError("declares no heat", where or found.name, "declare [thermal], or give a warm recording")
        return Compensation(heat_table(found.heat, wishes.reference), axis)
    if not found.has_motion:
        raise InputError("declares heat alone", where or found.name, "write --form sinumerik-temp")
    loop: Cascade | None = None if controller is None else cascade_for(found.plant, controller)
    wishes = replace(wishes, recorded=recorded, stroke=wishes.stroke or found.plant.stroke or recorded)
    return Compensation(compensate_plant(found.plant, wishes, loop, unsure, where), axis)


def _ends(stroke: Sequence[Quantity] | None) -> tuple[float, float] | None:
    if stroke is None:
        return None
    found = quantities(stroke, "m", "stroke (--from, --to)")
    if len(found) != 2 or not found[0] < found[1]:
        raise InputError("is not two ascending positions", "stroke (--from, --to)", "write the least position first")
    return found[0], found[1]


def _opened(source: Source) -> tuple[Axis | Recording, str, str, tuple[float, float] | None]:
    """The axis or recording of a source, why its backlash is not sure, its name for messages, the recorded stroke."""
    if not isinstance(source, Axis | Recording | str | Path) and hasattr(source, "diagnosis"):
        return source.plant, _unsure(source.record()), source.axis.name, source.diagnosis.recorded_stroke
    if isinstance(source, Axis | Recording):
        return source, "", "", None
    if not isinstance(source, str | Path):
        raise InputError(f"{type(source).__name__} is no source", "compensate", "give a diagnosis, an axis or a file")
    path = Path(source)
    if path.is_dir():
        content = diagnosis_content(path)
        return load(path / "plant_after.toml"), _unsure(content), str(path), _recorded(content)
    if path.suffix.lower() == ".toml" or (not path.is_file() and _is_shipped(str(source))):
        return load(source), "", str(path), None
    return as_recording(path, "source"), "", str(path), None


def _recorded(content: dict[str, Any]) -> tuple[float, float] | None:
    """The stroke that a diagnosis was made of [m], where its file has one."""
    ends = content.get("recorded_stroke")
    if not isinstance(ends, list) or len(ends) != 2 or not all(isinstance(one, int | float) for one in ends):
        return None
    return (float(ends[0]), float(ends[1])) if -math.inf < ends[0] < ends[1] < math.inf else None


def _is_shipped(name: str) -> bool:
    return name in {path.stem for path in shipped_plants()}


def _unsure(content: dict[str, Any]) -> str:
    found = [
        (one.get("name", ""), one.get("carries", True)) for one in content.get("effects", []) if isinstance(one, dict)
    ]
    return unsure_of_play(found, [one for one in content.get("ambiguous", []) if isinstance(one, list)])


def _heat_listing(done: HeatTable) -> Listing:
    table = done.table
    points = list(zip(table.temperatures.tolist(), table.offsets.tolist(), table.slopes.tolist(), strict=True))
    rows = [[f"{t:.2f} degC", format_quantity(k, "m"), f"{1e6 * b:.2f} um/m"] for t, k, b in points]
    records = [dict(zip(("temperature [degC]", "K0 [m]", "tan_beta [m/m]"), point, strict=True)) for point in points]
    title = f"{done.name}: temperature compensation over {done.sensor}, P0 = {format_quantity(table.reference, 'm')}"
    return Listing(title, ("temperature", "K0", "tan beta"), rows, records)
