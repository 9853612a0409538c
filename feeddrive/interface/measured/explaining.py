"""Measurements other than recordings over time, against an axis: numbers, or a frequency response."""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path

from feeddrive.diagnosis.numbers.measured_file import read_measured_numbers
from feeddrive.diagnosis.numbers.numbers_result import diagnose_numbers
from feeddrive.diagnosis.responses.response_result import diagnose_response
from feeddrive.errors import InputError
from feeddrive.export.point import export_point
from feeddrive.interface.axis import Axis
from feeddrive.interface.measured.numbers import Explained
from feeddrive.interface.measured.reading import read_response_file
from feeddrive.interface.measured.responses import ExplainedResponse
from feeddrive.interface.servo import Servo, cascade_for
from feeddrive.plant.file.named_parts import with_named_parts
from feeddrive.recording.frequency_response import FrequencyResponse
from feeddrive.servo.frequency_response import Case


def explain(
    axis: Axis,
    measured: str | Path | FrequencyResponse,
    *,
    at: str = "",
    controller: Servo | str | Path | None = None,
    progress: Callable[[str], None] | None = None,
) -> Explained | ExplainedResponse:
    """Trace the difference of measured numbers, or of a measured frequency response, from an axis.

    Args:
        axis: as declared, without effects or values that were put in.
        measured: TOML file with `[[measured]]` tables, or a frequency response or its file.
        at: operating point of a frequency response, "x=200 mm, v=3 m/min"; the middle of the stroke in slow motion.
        controller: of `tune`, or a controller or scenario file, under which a response of the speed loop was measured.
        progress: called with a word for what is being done.

    Raises:
        InputError: a file that cannot be used, or a number that this axis cannot give.

    >>> import feeddrive as fd
    >>> found = fd.explain(fd.load("kimm_testbed"), "scenarios/measured/kimm_testbed.toml")
    >>> len(found.result.beyond)
    0
    """
    entries = with_named_parts(axis.entries, str(axis.path))
    if axis.values or axis.added:
        raise InputError("the axis was changed after it was loaded", axis.name, "save it, and load the file")
    said = progress or (lambda _: None)
    if not isinstance(measured, FrequencyResponse) and Path(measured).suffix.lower() == ".toml":
        numbers = read_measured_numbers(Path(measured), axis.plant)
        return Explained(axis, diagnose_numbers(entries, axis.path, axis.plant, numbers, said))
    response = measured if isinstance(measured, FrequencyResponse) else read_response_file(Path(measured))
    if response is None:
        what = "is neither measured numbers nor a frequency response"
        raise InputError(what, str(measured), "give recordings over time to diagnose")
    point = export_point(axis.plant, at, "at")
    case = Case(point.position, point.linearised_at)
    cascade = None if controller is None else cascade_for(axis.plant, controller)
    found = diagnose_response(entries, axis.path, axis.plant, response, case, said, cascade)
    return ExplainedResponse(axis, found)
