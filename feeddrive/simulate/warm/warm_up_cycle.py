"""One servo cycle at given temperatures: its losses as mean powers, its films, its errors where the table rests."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, replace

import numpy as np

from feeddrive.errors import InputError
from feeddrive.plant.plant import Plant
from feeddrive.plant.warmed import warmed
from feeddrive.servo.cascade import Feedback
from feeddrive.servo.cascade_function import cascade_controller
from feeddrive.simulate.controlled.controlled import (
    ControlledRun,
    ControlledState,
    TorqueLoop,
    resting_state,
    simulate_controlled,
)
from feeddrive.simulate.scenario.cycle_losses import CycleLosses, cycle_losses
from feeddrive.simulate.scenario.scenario import Scenario
from feeddrive.simulate.setpoints.cutting_force import held
from feeddrive.thermal.full.full_model import FRONT, NUT, REAR, SHAFT
from feeddrive.thermal.laws.expansion import growths
from feeddrive.thermal.laws.films import conductance_at_preload
from feeddrive.thermal.laws.laws import FOLLOWED, INPUTS, PATHS, laws_of, values_of
from feeddrive.thermal.machine_heat import Heat
from feeddrive.thermal.reduced.parametric_model import AMBIENT, HeatModel, Path
from feeddrive.thermal.rig import Travel
from feeddrive.thermal.thermal_coupling import Changes, Coupling, Temperatures
from feeddrive.typing import FloatArray

_MOTOR = "motor"
_TURNING = 1e-3
"""Share of the fastest speed below which a screw counts as at rest."""

_CLOSED = 1e-6
"""Distance within which a cycle must come back to where it began [m]."""


@dataclass(frozen=True)
class MeanPower:
    """Powers averaged over a cycle [W]; see `RunEnergy` for what they are."""

    motor: float
    winding: float
    into_network: float
    to_bed: float
    work_out: float
    kept_by_drive: float


@dataclass(frozen=True)
class Cycle:
    """A servo cycle at some temperatures.

    Attributes:
        changes: what the temperatures make of the drive.
        heats: input of the thermal model to its mean heat [W].
        conductances: means over the cycle.
        power: mean powers.
        losses: works of the cycle.
        nut_torque, bearing_torque: mean drag at the screw, power over mean speed [N m].
        motor_torque: rms [N m].
        preload: of the nut [N].
        growth: of the screw at the stops, (stops,) [m].
        stop_errors: table position less target at the stops, (stops,) [m].
    """

    changes: Changes
    heats: Mapping[str, float]
    conductances: Mapping[Path, float]
    power: MeanPower
    losses: CycleLosses
    nut_torque: float
    bearing_torque: float
    motor_torque: float
    preload: float
    growth: FloatArray
    stop_errors: FloatArray


class ServoCycle:
    """A scenario's motion, to be run again and again at other temperatures; it remembers where the drive stands."""

    def __init__(self, scenario: Scenario) -> None:
        thermal, coupling = scenario.plant.heat, scenario.plant.coupling
        self.scenario, self.coupling = scenario, coupling
        self.duration, self.count = scenario.duration, 0
        tick = scenario.cascade.sample_time
        time = np.arange(scenario.ticks, dtype=np.float64) * tick
        motion = scenario.trajectory.at(time)
        _refuse_open(scenario, motion.position, motion.velocity)
        nothing = np.zeros_like(time)
        self.reference = np.column_stack([motion.position, motion.velocity, motion.acceleration, nothing, nothing])
        self.load = held(scenario.force, 0, scenario.ticks, tick)
        self.loop = TorqueLoop(scenario.cascade.current_lag, scenario.cascade.dead_time)
        self.controller = cascade_controller(scenario.cascade)
        low, high = (coupling.nut_at_zero + float(end) for end in (motion.position.min(), motion.position.max()))
        thermal.rig.refuse_travel(Travel(low, high))
        self.thermal = replace(thermal, rig=replace(thermal.rig, travel=Travel(low, high)))
        _refuse_unknown_body(coupling, thermal)
        self.silent = self.thermal.joined(coupling)
        kept = [
            stop for stop in scenario.trajectory.stops if stop.direction != 0 and stop.leave <= self.duration + tick
        ]
        self.stops = tuple(stop.target for stop in kept)
        self._at_stops = np.array(
            [min(int(stop.leave / tick) - 1, scenario.ticks - 1) for stop in kept], dtype=np.int64
        )
        self._state: ControlledState | None = None

    def heat_model(self) -> HeatModel:
        """The full thermal model with the nut averaged over this cycle's travel."""
        return self.thermal.full_model()

    def at(self, model: HeatModel, state: FloatArray, time: float = 0.0) -> Cycle:
        """Run the cycle at the temperatures of a thermal state, (n,) [K over the start], `time` [s] after the start."""
        rig, start = self.thermal.rig, self.thermal.ambient
        nut, shaft, front, rear = (start + float(model.readings[name] @ state) for name in (NUT, SHAFT, FRONT, REAR))
        changes = self.coupling.changes(
            Temperatures(nut, shaft, front, rear), start, self.thermal.preload, 2 * rig.radius, rig.steel.expansion
        )
        for effect in self.thermal.effects:
            changes = replace(
                changes,
                preload=changes.preload * float(effect.load_factor(nut - start, effect.values)),
                nut_viscous=changes.nut_viscous * float(effect.viscous_factor(nut - start, effect.values)),
            )
        places = [self.coupling.nut_at_zero + stop for stop in self.stops]
        ends = rig.travel.low, rig.travel.high
        (grown,) = growths(rig, np.asarray(model.profile @ state), model.edges, np.array([*places, *ends]))
        growth, slope = grown[:-2], float(grown[-1] - grown[-2]) / rig.travel.stroke
        plant = warmed(self.scenario.plant, changes, slope, self.coupling.nut_stiffness)
        run = self._run(plant)
        frame = [sum(float(e.growth(place, time, e.values)) for e in self.thermal.effects) for place in places]
        cycle = self._result(model, changes, plant, run, growth, slope, time)
        return replace(cycle, stop_errors=cycle.stop_errors + np.array(frame))

    def _run(self, plant: Plant) -> ControlledRun:
        """From where the last cycle ended; the very first one is run twice, so that it begins as it ends."""
        if self._state is None:
            position = float(self.reference[0, 0])
            self._state = resting_state(plant, self.controller, self.loop, position)
            self._run(plant)
        run = simulate_controlled(plant, self.controller, self.reference, self.load, self.loop, self._state)
        self._state, self.count = replace(run.end, tick=0), self.count + 1
        return run

    def _result(
        self, model: HeatModel, changes: Changes, plant: Plant, run: ControlledRun, growth: FloatArray, slope: float,
        time: float,
    ) -> Cycle:  # fmt: skip
        losses = cycle_losses(plant, run, self.loop, self.load)
        preload = self.thermal.preload * changes.preload
        speeds = run.table_velocity / self.thermal.lead
        films, added = self._acting(speeds, preload, time)
        heats, power = self._shared(losses, model.input_names)
        more = sum(heat for name, heat in added.items() if name != AMBIENT)
        heats = {**heats, **{name: heats.get(name, 0.0) + heat for name, heat in added.items()}}
        power = replace(power, winding=power.winding + more, into_network=power.into_network + more)
        mean_speed = float(np.mean(np.abs(speeds)))
        return Cycle(
            changes, heats, films, power, losses,
            losses.nut / losses.duration / mean_speed, losses.bearings / losses.duration / mean_speed,
            (losses.squared_torque / losses.duration) ** 0.5, preload, growth, self._errors(run, growth, slope),
        )  # fmt: skip

    def _acting(self, speeds: FloatArray, preload: float, time: float) -> tuple[dict[Path, float], dict[str, float]]:
        """Mean conductances of a cycle, and what effects add: heats [W] and the rise of the surroundings [K]."""
        laws, values = laws_of(self.silent), values_of(self.silent)
        rest = np.zeros((len(FOLLOWED), len(speeds)))
        # a held table still trembles by what its loop leaves, and that is no turning
        turning = np.where(np.abs(speeds) > _TURNING * np.max(np.abs(speeds)), speeds, 0.0)
        g, u = laws.acting(turning[None, :], time, self.duration, 0.0, rest, self.thermal.ambient, values)
        films = dict(zip(PATHS, map(float, np.mean(g.full(), axis=1)), strict=True))
        films[Path.CONTACT] *= conductance_at_preload(1.0, preload, self.thermal.preload)
        return films, dict(zip(INPUTS, map(float, np.mean(u.full(), axis=1)), strict=True))

    def _errors(self, run: ControlledRun, growth: FloatArray, slope: float) -> FloatArray:
        """Table position less target at the stops; an encoder at the motor does not see where the screw has grown to.

        The run holds the growth's slope along the stroke; what it lacks is the rest of the growth.
        """
        stops = np.array(self.stops)
        found: FloatArray = run.table_position[self._at_stops] - stops
        return found + (growth - slope * stops) if self.scenario.cascade.feedback is Feedback.MOTOR else found

    def _shared(self, losses: CycleLosses, inputs: tuple[str, ...]) -> tuple[dict[str, float], MeanPower]:
        """Where the losses go: heats of the thermal model, and all mean powers [W]."""
        constant, rear = self.coupling.motor_constant, self.coupling.rear_share
        winding = 0.0 if constant is None else losses.squared_torque / constant**2
        heats = {NUT: losses.nut, FRONT: (1 - rear) * losses.bearings, REAR: rear * losses.bearings}
        to_bed = losses.damping
        for body, work in ((_MOTOR, winding + losses.motor_friction), (self.coupling.guide_heat_to, losses.guide)):
            if body in inputs:
                heats[body] = heats.get(body, 0.0) + work
            else:
                to_bed += work
        works = (losses.motor, winding, sum(heats.values()), to_bed, losses.sources + losses.load, losses.stored)
        mean = {name: work / losses.duration for name, work in heats.items()}
        return mean, MeanPower(*(work / losses.duration for work in works))


def _refuse_open(scenario: Scenario, position: FloatArray, velocity: FloatArray) -> None:
    """Refuse a motion that does not end where it began, at rest, or that does not move."""
    where, mend = scenario.name, "end the cycle where it begins, with a dwell"
    if abs(position[-1] - position[0]) > _CLOSED or abs(velocity[-1]) > 1e-9 or abs(velocity[0]) > 1e-9:
        raise InputError("the motion does not end where it begins, at rest", where, mend)
    if not np.ptp(position) > _CLOSED:
        raise InputError("the table does not move", where, "write a motion")
    if scenario.excitation is not None:
        raise InputError("an excitation is no part of a repeated cycle", where, "leave [excitation] out")


def _refuse_unknown_body(coupling: Coupling, thermal: Heat) -> None:
    """Refuse a body for the guide's heat that is not there."""
    bodies = [body.name for body in thermal.bodies]
    if coupling.guide_heat_to and coupling.guide_heat_to not in bodies:
        known = f"known are {', '.join(bodies)}" if bodies else "declare it as [[thermal.body]]"
        raise InputError(f'no body "{coupling.guide_heat_to}"', "thermal.coupling.guide_heat_to", known)
