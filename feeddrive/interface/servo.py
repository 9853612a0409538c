"""Controllers: the recommended cascade of an axis, with the why of each setting."""

from __future__ import annotations

import math
import tomllib
from collections.abc import Mapping, Sequence
from dataclasses import asdict, dataclass, replace
from pathlib import Path
from typing import TYPE_CHECKING, Any

from feeddrive import __version__
from feeddrive.errors import InputError
from feeddrive.files import find_scenario_or_controller, write_text_atomically
from feeddrive.interface.plants import plant_of
from feeddrive.interface.quantities import Quantities, Quantity, positive, quantities, si
from feeddrive.interface.retuning import Retuned, compare, read_present
from feeddrive.interface.shown import Listing, Shown, finite, write_figures, write_json
from feeddrive.plant.plant import Plant
from feeddrive.schema.toml_text import nearest
from feeddrive.servo.cascade import KV_UNIT, Cascade, Feedback
from feeddrive.servo.loop_response import loops_of
from feeddrive.servo.margins import Margins
from feeddrive.servo.response_family import margins_content, open_family
from feeddrive.simulate.scenario.scenario_controller import read_controller
from feeddrive.tuning.bare_drive import bare_drive
from feeddrive.tuning.demand import Demand, operating_points
from feeddrive.tuning.drive_settings import DriveSettings, drive_settings
from feeddrive.tuning.reasons import Setting, controller_text, describe, rules, settings
from feeddrive.tuning.reasons import operating_points as operating_points_text
from feeddrive.tuning.recommendation import Recommendation, recommend
from feeddrive.units.quantity import format_quantity

if TYPE_CHECKING:
    from feeddrive.interface.axis import Axis
    from feeddrive.report.figures.drawing import ReportFigure


LOWEST, HIGHEST = 1.0, 4000.0
"""Frequencies of the figure of the open loops [Hz]."""


@dataclass(frozen=True, repr=False, eq=False)
class Servo(Shown):
    """A recommended cascade.

    Attributes:
        plant: that it is for.
        recommendation: settings, demand, and the margins reached in every case.
    """

    plant: Plant
    recommendation: Recommendation

    @property
    def cascade(self) -> Cascade:
        """The settings, SI."""
        return self.recommendation.cascade

    @property
    def position_gain(self) -> float:
        """K_v [1/s]."""
        return self.cascade.position_gain

    @property
    def velocity_gain(self) -> float:
        """K_p [N m s/rad]."""
        return self.cascade.velocity_gain

    @property
    def reset_time(self) -> float:
        """T_n [s]."""
        return self.cascade.reset_time

    @property
    def why(self) -> dict[str, str]:
        """Setting to the sentence that says why it is so."""
        found = {one.symbol: one.why for one in self.settings}
        return found | {f"rule {i}": text for i, text in enumerate(rules(self.plant, self.recommendation), 1)}

    @property
    def settings(self) -> tuple[Setting, ...]:
        """Every setting, as shown, with its why."""
        return settings(self.plant, self.recommendation)

    @property
    def text(self) -> str:
        """The controller file."""
        return controller_text(self.recommendation, f"recommended for {self.plant.name}")

    def save(self, path: str | Path) -> Path:
        """Write the controller file, which scenarios name.

        Raises:
            InputError: the file cannot be written.
        """
        target = Path(path)
        write_text_atomically(target, self.text)
        return target

    def to_drive(self, form: str) -> DriveSettings:
        """What to type into a drive: names, units and resolution of the form, within the filters that it has.

        Args:
            form: "sinamics", "twincat", "heidenhain" or "linuxcnc".

        Raises:
            InputError: an unknown form, a value that the drive does not take, margins that it cannot keep.

        >>> import feeddrive as fd
        >>> print(fd.tune(fd.load("bench_axis")).to_drive("sinamics").lines[0].parameter.name)
        p1460[0]
        """
        return drive_settings(self.plant, self.recommendation, form)

    def compare(self, present: str | Path, form: str = "") -> Retuned:
        """What the recommendation would change and bring beside the present settings.

        Args:
            present: controller file, or a file of drive parameters.
            form: of the parameters; what is recommended is then what that drive would have.

        Raises:
            InputError: a file that cannot be read, or as `to_drive`.
        """
        path = Path(present)
        wanted = self.to_drive(form).cascade if form else self.cascade
        cases = [one.case for one in self.recommendation.reached]
        return compare(self.plant, read_present(path, form, self.plant, self.cascade), wanted, cases)

    def listing(self) -> Listing:
        """One row per setting."""
        rows = [[one.symbol, one.shown, one.why] for one in self.settings]
        records = [
            {"setting": "position_gain [1/s]", "value": self.position_gain},
            {"setting": "position_gain [(m/min)/mm]", "value": self.position_gain / KV_UNIT},
            {"setting": "velocity_gain [N m s/rad]", "value": self.velocity_gain},
            {"setting": "reset_time [s]", "value": self.reset_time},
        ]
        return Listing(f"{self.plant.name}: recommended cascade", ("setting", "value", "why"), rows, records)

    def _figures(self) -> Sequence[ReportFigure]:
        from feeddrive.report.figures.figure_bode import bode_figure

        cases = [one.case for one in self.recommendation.reached]
        loops = loops_of(self.cascade)
        return [bode_figure(open_family(self.plant, self.cascade, one, cases, LOWEST, HIGHEST)) for one in loops]


def tune(
    axis: Axis | str | Path,
    *,
    phase: Quantity = "45 deg",
    gain: Quantity = "8 dB",
    positions: Quantities = None,
    payload: Quantities = None,
    velocity: Quantity = "3 m/min",
    drive: str | Path | None = None,
    velocity_rate: Quantity = "8 kHz",
    position_rate: Quantity = "2 kHz",
    current_bandwidth: Quantity = "1 kHz",
    dead_time: Quantity = "125 us",
    feedback: str | None = None,
) -> Servo:
    """Recommend K_p, T_n, filters and K_v that keep margins over positions and payloads, in motion and at rest.

    Args:
        axis: the machine.
        phase, gain: least margins of either loop.
        positions: of the table at which they must hold; along the stroke if left out.
        payload: masses on the table with which they must hold.
        velocity: of the table in motion, about which is linearised.
        drive: scenario or controller file of the drive; gives rates, delays and limits in place of what follows.
        velocity_rate, position_rate, current_bandwidth, dead_time: of the drive.
        feedback: "motor" or "table", what the position loop reads; a scale if declared.

    Raises:
        InputError: margins that cannot be met, or a value that cannot be used.
    """
    plant = plant_of(axis)
    place = feedback_of(feedback)
    if drive is not None:
        read = cascade_for(plant, drive)
        bare = replace(read, feedback=place or read.feedback, torque_filters=(), speed_filters=())
    else:
        late = si(dead_time, "s", "dead_time")
        if late < 0:
            raise InputError(f"{dead_time} is negative", "dead_time", "write zero or more")
        bare = bare_drive(
            plant,
            positive(velocity_rate, "Hz", "velocity_rate", "8 kHz"),
            positive(position_rate, "Hz", "position_rate", "2 kHz"),
            positive(current_bandwidth, "Hz", "current_bandwidth", "1 kHz"),
            late,
            place,
        )
    demand = Demand(phase=round(math.degrees(si(phase, "rad", "phase")), 9), gain=si(gain, "dB", "gain"))
    places, loads = quantities(positions, "m", "positions"), quantities(payload, "kg", "payload")
    cases = operating_points(plant, places, loads, si(velocity, "m/s", "velocity"))
    return Servo(plant, recommend(plant, bare, cases, demand))


def cascade_for(plant: Plant, controller: Servo | str | Path) -> Cascade:
    """The cascade of a tuned servo, or of a controller or scenario file.

    Raises:
        InputError: none of them, or a controller that cannot be read.
    """
    if isinstance(controller, Servo):
        return controller.cascade
    if isinstance(controller, str | Path):
        return read_controller(find_scenario_or_controller(str(controller)), plant)
    what = f"{type(controller).__name__} is no controller"
    raise InputError(what, "controller", "give fd.tune(...), or a controller or scenario file")


def controller_entries(controller: Servo | str | Path) -> Mapping[str, Any]:
    """The controller as a scenario holds it.

    Raises:
        InputError: a file that cannot be read.
    """
    if isinstance(controller, Servo):
        return tomllib.loads(controller.text)
    return {"file": str(Path(controller).resolve())}


def feedback_of(written: str | None) -> Feedback | None:
    """What the position loop reads, by its word. Raises InputError: another word."""
    allowed = [str(place) for place in Feedback]
    if written is not None and written not in allowed:
        raise InputError(f'"{written}" is not possible', "feedback", nearest(written, allowed))
    return None if written is None else Feedback(written)


FORMAT = "feeddrive-tune/1"


def tuned_record(servo: Servo, typed: DriveSettings | None, retuned: Retuned | None) -> dict[str, Any]:
    """Settings, margins, parameters of a drive and what they change as plain values, SI."""
    found, cascade = servo.recommendation, servo.cascade
    cases = [one.case for one in found.reached]
    content: dict[str, Any] = {
        "format": FORMAT,
        "version": __version__,
        "name": servo.plant.name,
        "asked": {"phase_deg": found.demand.phase, "gain_db": found.demand.gain},
        "operating_points": {
            "text": operating_points_text(found),
            "position [m]": sorted({one.position for one in cases}),
            "velocity [m/s]": sorted({one.velocity for one in cases}),
            "payload [kg]": sorted({one.payload for one in cases}),
        },
        "velocity_gain": {"N m s/rad": cascade.velocity_gain},
        "reset_time": {"s": cascade.reset_time},
        "position_gain": {"1/s": cascade.position_gain, "(m/min)/mm": cascade.position_gain / KV_UNIT},
        "position_feedback": str(cascade.feedback),
        "filters": [
            {"kind": one.kind, "frequency": one.frequency, "damping": one.damping,
             "depth_db": finite(one.depth),
             "resonance": None if one.resonance is None else list(one.resonance), "brings": one.brings}
            for one in found.velocity.filters
        ],
        "settings": [asdict(one) for one in servo.settings],
        "rules": list(rules(servo.plant, found)),
        "reached": [
            {**asdict(one.case), "velocity_loop": margins_content(one.velocity),
             "position_loop": margins_content(one.position), "slowest_growth 1/s": one.growth}
            for one in found.reached
        ],
        "controller": servo.text,
    }  # fmt: skip
    if typed is not None:
        content["drive"] = {
            "form": typed.form,
            "remarks": list(typed.remarks),
            "parameters": [
                {"name": one.parameter.name, "value": one.typed, "unit": one.parameter.unit,
                 "resolution": one.parameter.resolution, "meaning": one.parameter.meaning,
                 "source": one.parameter.source}
                for one in typed.lines
            ],
            "file": typed.text,
        }  # fmt: skip
    if retuned is not None:
        changes = [{"setting": name, "present": old, "recommended": new} for name, old, new in retuned.changes]
        content["present"] = {"changes": changes, "remarks": list(retuned.remarks), "brings": retuned.brings}
    return content


def save_tuned(servo: Servo, typed: DriveSettings | None, retuned: Retuned | None, folder: Path) -> None:
    """Write controller.toml, tune.json, the open loops, the drive's file, and step and circle of a comparison.

    Raises:
        InputError: a file cannot be written.
    """
    compared = retuned.figures() if retuned is not None else ()
    write_figures([*servo._figures(), *(one for one in compared if one.stem.startswith("retuned"))], folder)
    if typed is not None:
        ending = "hal" if typed.form == "linuxcnc" else "txt"
        write_text_atomically(folder / f"{typed.form}.{ending}", typed.text)
    write_json(tuned_record(servo, typed, retuned), folder / "tune.json")
    servo.save(folder / "controller.toml")


def reached_rows(servo: Servo) -> list[list[str]]:
    """Case, margins of the velocity and of the position loop, peaks of both sensitivities."""
    return [
        [describe(one.case), _margins(one.velocity), _margins(one.position),
         f"{one.velocity.sensitivity:.2f}, {one.position.sensitivity:.2f}"]
        for one in servo.recommendation.reached
    ]  # fmt: skip


def _margins(found: Margins) -> str:
    phase, gain = (
        f"{value:.1f}{unit}" if math.isfinite(value) else "no limit"
        for value, unit in ((found.phase, "°"), (found.gain, " dB"))
    )
    return f"{phase}, {gain}"


def drive_words(cascade: Cascade) -> str:
    """Rates, feedback and delays of a cascade in a sentence."""
    fast, slow = (1e-3 / (cascade.sample_time * ticks) for ticks in (1, cascade.position_divider))
    lag = f"{1 / (2 * math.pi * cascade.current_lag):.4g} Hz" if cascade.current_lag else "without lag"
    return (
        f"{fast:g} kHz velocity loop, {slow:g} kHz position loop reading the {cascade.feedback}, current loop {lag}, "
        f"dead time {format_quantity(cascade.dead_time, 's')}"
    )
