"""From a machine to what is loaded into its control: table, prediction, what is left, and what no table may hold."""

from __future__ import annotations

import math
from dataclasses import dataclass, replace

import numpy as np

from feeddrive.compensation.applied import AxisLimits
from feeddrive.compensation.cogging import CoggingMap, cogging_map
from feeddrive.compensation.cures import repaired
from feeddrive.compensation.deviations import RecordedDeviations, plant_deviations
from feeddrive.compensation.forms.all_forms import as_held, control
from feeddrive.compensation.forms.control import Control
from feeddrive.compensation.friction_values import FrictionValues, friction_values
from feeddrive.compensation.lost_motion import LostMotion, lost_motion, refuse_wind_up, resting_words, without_play
from feeddrive.compensation.points import table_for
from feeddrive.compensation.predicted_accuracy import Applied, Figures, best_reversal, figures, motions, sticking
from feeddrive.compensation.table import CompensationTable, Deviations, fitted
from feeddrive.errors import InputError
from feeddrive.plant.plant import DeclaredCascade, Plant
from feeddrive.schema.table import Origins, Table
from feeddrive.servo.cascade import Cascade, Feedback
from feeddrive.simulate.scenario.scenario_controller import read_cascade
from feeddrive.simulate.setpoints.trajectories import Circle
from feeddrive.tuning.bare_drive import bare_drive
from feeddrive.tuning.demand import Demand, cases_of
from feeddrive.tuning.recommendation import recommend
from feeddrive.units.quantity import format_quantity

_USUAL_RATE, _POSITION_RATE, _BANDWIDTH, _DEAD_TIME = 8000.0, 2000.0, 1000.0, 125e-6
"""Rates, bandwidth and dead time of a drive that nobody has declared: those of `feeddrive tune`."""


@dataclass(frozen=True)
class Wishes:
    """What was asked for.

    Attributes:
        form: of the table.
        every: distance of its points [m]; chosen if None.
        reference: where the axis is referenced [m]; 0, or the end of the stroke that is nearest to it, if None.
        stroke: [m]; that of the machine if None.
        axis: its name in the control.
        resolution: of a value [m]; that of the form if None.
        recorded: what a diagnosis has seen of the stroke [m]; None where that is not known.
    """

    form: str
    every: float | None = None
    reference: float | None = None
    stroke: tuple[float, float] | None = None
    axis: str = "X"
    resolution: float | None = None
    recorded: tuple[float, float] | None = None


@dataclass(frozen=True, eq=False)
class Prediction:
    """Figures of the machine as it is, after repair (None where nothing is worn), and with the table.

    Attributes:
        circle: that was driven; None where it is not known.
        usual_contour: with the table at the usual reversal of the control, where another one was found better [m].
    """

    before: Figures
    repaired: Figures | None
    after: Figures
    circle: Circle | None = None
    usual_contour: float | None = None


@dataclass(frozen=True, eq=False)
class Compensated:
    """A table and all that belongs to it.

    Attributes:
        name: of the machine or recording.
        wishes: what was asked for.
        control: that reads the table.
        table: as the control holds it.
        known: deviations it was made of, zero at the reference.
        lost: lost motion; None of a recording.
        of_time: travel errors that change with time, which are in no table.
        refused: what is left out of the table, and why.
        prediction: None of a recording.
        friction, cogging: values beside the table, where the plant has them.
        shortest: period of a lead error along the stroke [m]; infinite where none is known.
        measured: of a recording.
    """

    name: str
    wishes: Wishes
    control: Control
    table: CompensationTable
    known: Deviations
    lost: LostMotion | None = None
    of_time: tuple[str, ...] = ()
    refused: tuple[str, ...] = ()
    shortest: float = math.inf
    prediction: Prediction | None = None
    friction: FrictionValues | None = None
    cogging: CoggingMap | None = None
    measured: RecordedDeviations | None = None

    @property
    def left_by_table(self) -> float:
        """Largest part of what is known that the table leaves, by its points and its rounding [m]."""
        inside = (self.known.positions >= self.table.positions[0]) & (self.known.positions <= self.table.positions[-1])
        places = self.known.positions[inside]
        rest = [
            one[inside] - self.table.at(places, reverse, self.control.stepwise)
            for one, reverse in ((self.known.forward, False), (self.known.reverse, True))
        ]
        return float(max(np.max(np.abs(one)) for one in rest))


def plant_table(
    plant: Plant, wishes: Wishes, cascade: Cascade | None = None, unsure_of_play: str = "", where: str = ""
) -> Compensated:
    """The table of a plant, nothing simulated.

    Args:
        plant: with what was found.
        wishes: form, points, reference, stroke.
        cascade: its controller; the declared one if None.
        unsure_of_play: why its backlash must not be taken for play; empty where it may.
        where: file, for messages.

    Raises:
        InputError: nothing that a table may hold, limits of the control, no stroke, a loop that reads the scale.
    """
    place, wanted = where or plant.name, control(wishes.form, wishes.resolution)
    stroke = _stroke(plant, wishes, place)
    reference = _reference(wishes, stroke)
    _refuse_scale(plant, cascade, place)
    lost = lost_motion(plant, 0.5 * (stroke[0] + stroke[1]))
    found = plant_deviations(plant, (min(stroke[0], reference), max(stroke[1], reference)))
    known, refused = found.known, []
    if unsure_of_play and lost.play > 0:
        refused.append(unsure_of_play)
        known = Deviations(known.positions, known.mean, known.mean)
    if lost.width > 0 and lost.rests:
        refused.append(resting_words(lost))
        known = Deviations(known.positions, known.mean, known.mean)
    has_lead = float(np.ptp(known.mean)) >= wanted.resolution
    if not has_lead and unsure_of_play and refused:
        raise InputError(f"no table is written: {unsure_of_play}", place, "record the experiment that tells them apart")
    if not has_lead:
        refuse_wind_up(lost, place, wanted.resolution)
    table = table_for(wanted, known, stroke, reference, wishes.every, found.shortest)
    return Compensated(
        plant.name, wishes, wanted, table, known.zeroed(reference), lost, found.of_time, tuple(refused), found.shortest
    )


def compensate_plant(
    plant: Plant,
    wishes: Wishes,
    cascade: Cascade | None = None,
    unsure_of_play: str = "",
    where: str = "",
    beside: bool = True,
) -> Compensated:
    """The table of a plant as `plant_table` gives it, with its prediction.

    Args:
        plant: with what was found.
        wishes: form, points, reference, stroke.
        cascade: its controller; the declared one, else a recommended one, if None.
        unsure_of_play: why its backlash must not be taken for play; empty where it may.
        where: file, for messages.
        beside: whether values for friction and cogging are wanted beside the table.

    Raises:
        InputError: as `plant_table`; no controller that keeps the usual margins.
    """
    made = plant_table(plant, wishes, cascade, unsure_of_play, where)
    lost = made.lost
    assert lost is not None
    loop = cascade_of(plant, cascade)
    test = motions(_stroke(plant, wishes, where), lost)
    moved = sticking(plant, lost)
    renewed = repaired(moved)
    applied, usual = best_reversal(moved, loop, test, Applied(made.control, made.table, _limits(plant)))
    made = replace(made, control=applied.control)
    prediction = Prediction(
        figures(moved, loop, test),
        None if renewed is None else figures(renewed, loop, test),
        figures(moved, loop, test, applied),
        test.circle,
        usual,
    )
    if not beside:
        return replace(made, prediction=prediction)
    friction = friction_values(moved, loop, test.circle, lost, applied) if lost.torque > 0 else None
    return replace(made, prediction=prediction, friction=friction, cogging=cogging_map(plant, loop))


def compensate_recording(name: str, found: RecordedDeviations, wishes: Wishes, shortest: float) -> Compensated:
    """The table of a recording, by its name and what it tells.

    `shortest` is the period of the screw along the stroke [m], infinite where it is not known. Raises InputError:
    limits of the control, or a stroke beyond what was recorded.
    """
    wanted = control(wishes.form, wishes.resolution)
    stroke = wishes.stroke or found.ends
    if stroke[0] < found.ends[0] - 1e-9 or stroke[1] > found.ends[1] + 1e-9:
        ends = " to ".join(format_quantity(one, "m") for one in found.ends)
        raise InputError(f"only {ends} was recorded", name, "ask for a stroke inside, or record the whole of it")
    reference = _reference(wishes, stroke)
    every = wishes.every
    if every is None and not found.from_motor and _takes_uneven(wanted):
        inside = (found.known.positions >= stroke[0]) & (found.known.positions <= stroke[1])
        table = as_held(wanted, fitted(found.known, found.known.positions[inside], reference))
    else:
        table = table_for(wanted, found.known, stroke, reference, every, shortest)
    return Compensated(name, wishes, wanted, table, found.known.zeroed(reference), shortest=shortest, measured=found)


def _takes_uneven(wanted: Control) -> bool:
    return wanted.name in ("linuxcnc", "isg", "heidenhain-csv", "csv")


def cascade_of(plant: Plant, cascade: Cascade | None) -> Cascade:
    """The controller that a prediction runs: the given one, the declared one, or a recommended one; at the motor.

    Raises:
        InputError: none is declared, and none that keeps the margins is found.
    """
    if cascade is not None:
        return cascade
    if isinstance(plant.controller, DeclaredCascade):
        return read_cascade(Table(plant.controller.entries, plant.controller.where, Origins()), plant)[0]
    bare = bare_drive(plant, _USUAL_RATE, _POSITION_RATE, _BANDWIDTH, _DEAD_TIME, Feedback.MOTOR)
    # inside a play nothing is linear; the gains are those of the axis on its flanks
    clean = without_play(plant)
    return recommend(clean, bare, cases_of(clean), Demand()).cascade


def _refuse_scale(plant: Plant, cascade: Cascade | None, where: str) -> None:
    """Refuse an axis whose position loop sees the table: lead errors and play are no errors of it."""
    declared = plant.controller
    loop = cascade
    if loop is None and isinstance(declared, DeclaredCascade):
        loop = read_cascade(Table(declared.entries, declared.where, Origins()), plant)[0]
    if loop is not None and loop.feedback is Feedback.TABLE:
        what = "the position loop reads the scale, which sees lead errors and play; a table would put them in"
        raise InputError(what, where, 'give a controller with position_feedback = "motor" if that is how it runs')


def _stroke(plant: Plant, wishes: Wishes, where: str) -> tuple[float, float]:
    stroke = wishes.stroke or plant.stroke
    if stroke is None:
        raise InputError("no stroke is declared", where, 'write --from "0 mm" --to "500 mm", or stroke in [table]')
    if not stroke[0] < stroke[1]:
        raise InputError("the stroke does not ascend", where, "write the lower end first")
    for end in stroke:
        plant.chain.refuse_off_screw(end, where)
    return stroke


def _reference(wishes: Wishes, stroke: tuple[float, float]) -> float:
    if wishes.reference is not None:
        width = stroke[1] - stroke[0]
        if not stroke[0] - width <= wishes.reference <= stroke[1] + width:
            what = f"the reference at {format_quantity(wishes.reference, 'm')} is far off the stroke"
            raise InputError(what, "reference", "check its unit; it is a position of the axis")
        return wishes.reference
    return min(max(0.0, stroke[0]), stroke[1])


def _limits(plant: Plant) -> AxisLimits:
    usual = AxisLimits()
    found = [plant.data.get(f"table.{key}") for key in ("max_velocity", "max_acceleration")]
    velocity, acceleration = (None if one is None else one.value for one in found)
    return AxisLimits(velocity or usual.velocity, acceleration or usual.acceleration)
