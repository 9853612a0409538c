"""The bench page of an axis: sliders for gains, filters, position, payload, effects; loops and motions follow."""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path

from feeddrive.bench_page.page import BenchPage, bench_page
from feeddrive.errors import InputError
from feeddrive.files import DIAGNOSED, write_text_atomically
from feeddrive.interface.axis import Axis, axis_of, load
from feeddrive.interface.measured.diagnosed import Diagnosed
from feeddrive.interface.measured.reading import diagnosis_content
from feeddrive.interface.quantities import Quantity, positive
from feeddrive.interface.servo import Servo, cascade_for, tune
from feeddrive.servo.loop_response import refuse_unstable_case
from feeddrive.servo.mechanics_response import Case


@dataclass(frozen=True)
class Bench:
    """A page on which an axis can be tried.

    Attributes:
        page: what it shows.
    """

    page: BenchPage

    @property
    def text(self) -> str:
        """The page as HTML; it holds everything and fetches nothing."""
        return bench_page(self.page)

    def save(self, path: str | Path) -> Path:
        """Write the page.

        Raises:
            InputError: the file cannot be written, or a plant without elastic chain.
        """
        target = Path(path)
        write_text_atomically(target, self.text)
        return target


def bench(
    axis: Axis | str | Path,
    *,
    controller: Servo | str | Path | None = None,
    diagnosis: Diagnosed | str | Path | None = None,
    payload: Quantity = "100 kg",
) -> Bench:
    """The bench page of an axis.

    Args:
        axis: the machine.
        controller: settings at the start: of `tune`, or a controller or scenario file; tuned if left out.
        diagnosis: of the axis, or its folder: the page has the plant as diagnosed, the effects found first.
        payload: largest mass on the table that can be chosen.

    Raises:
        InputError: a rigid axis, a controller that is unstable or cannot be read, a folder without diagnosis.

    >>> import feeddrive as fd
    >>> page = fd.bench(fd.load("bench_axis"), controller="step_position")
    >>> page.text.startswith("<!DOCTYPE html>")
    True
    """
    axis, found = _diagnosed(axis_of(axis), diagnosis)
    plant = axis.plant
    heaviest = positive(payload, "kg", "payload", "100 kg")
    cascade = cascade_for(plant, controller) if controller is not None else tune(axis).cascade
    refuse_unstable_case(plant, cascade, Case(plant.middle), "controller")
    return Bench(BenchPage(plant, cascade, heaviest, found))


def _diagnosed(axis: Axis, diagnosis: Diagnosed | str | Path | None) -> tuple[Axis, tuple[str, ...]]:
    """The axis, as diagnosed where there is a diagnosis, and the names of what was found."""
    if diagnosis is None:
        return axis, ()
    if isinstance(diagnosis, Diagnosed):
        return diagnosis.plant, tuple(one.name for one in diagnosis.diagnosis.effects)
    folder = Path(diagnosis)
    content = diagnosis_content(folder)
    if not str(content.get("format", "")).startswith("feeddrive-diagnosis/"):
        raise InputError("is no diagnosis of recordings", str(folder), "name a folder that holds one")
    named = [one.get("name") for one in content.get("effects", []) if isinstance(one, dict)]
    return load(folder / DIAGNOSED), tuple(str(name) for name in named if name)
