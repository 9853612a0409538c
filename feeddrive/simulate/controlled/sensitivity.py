"""How a controlled run changes with the values of plant, controller and torque loop: forward sensitivities, exact.

The tangent of every accepted step follows from the implicit function theorem at its nodes, with the effects' exact
derivatives; the propagators change as complex matrix exponentials say (a step of 1e-30 along the imaginary axis loses
no digits). So the derivatives are those of the computed run, to rounding, as long as no value moves a switch: a torque
limit that is reached and a sensor's resolution make the run jump with its parameters, and are refused or left out.

Source: Hairer, Norsett, Wanner, Solving ODEs I, section II.6; Squire and Trapp, SIAM Review 40 (1998) 110.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace

import numpy as np

from feeddrive.effects.base import ChainEffect, TimingEffect
from feeddrive.effects.timing.channel_delay import ChannelDelay
from feeddrive.engine.engine import Feed, run_machine
from feeddrive.engine.program import CELL, TOLERANCE, Program, Stop, Tangents, Task
from feeddrive.engine.step.linear_part import state_matrices
from feeddrive.engine.step.step_constants import flattened, propagator_blocks
from feeddrive.errors import InputError
from feeddrive.plant.plant import Plant
from feeddrive.plant.structure import parameter_names
from feeddrive.servo.sampled_plant import SampledController
from feeddrive.simulate.controlled.controlled import (
    ControlledRun,
    ControlledState,
    TorqueLoop,
    fed_of,
    machine_for,
    resting_state,
    told_run,
)
from feeddrive.typing import FloatArray

TINY = 1e-30
"""Step along the imaginary axis, in shares of the value."""

CONTROLLER = "controller"
LAG = "torque_loop.lag"


@dataclass(frozen=True)
class Sensitivity:
    """A run and how it changes.

    Attributes:
        run: as `simulate_controlled` without the sensors' resolutions gives it.
        changes: parameter to the derivatives of the run's series, by the name of the series (command, torque,
            motor_angle, motor_speed, table_position, table_velocity), each shape (n,), SI per SI.
    """

    run: ControlledRun
    changes: Mapping[str, Mapping[str, FloatArray]]


SERIES = ("command", "torque", "motor_angle", "motor_speed", "table_position", "table_velocity")


def simulate_sensitivity(
    plant: Plant, controller: SampledController, reference: FloatArray, parameters: Sequence[str],
    load: FloatArray | None = None, torque_loop: TorqueLoop | None = None, tolerance: float = TOLERANCE,
    start: ControlledState | None = None,
) -> Sensitivity:  # fmt: skip
    """A controlled run and its derivatives.

    Args:
        plant: with its values; a value of 0 that may be left out is left out, and has no derivative.
        controller: as for `simulate_controlled`.
        reference: what it is fed, shape (n, number of its references), SI.
        parameters: names as in `feeddrive.plant.analysis.linear.ode_parameters` (`table_mass`,
            `guide_friction.coulomb`); `controller[i]` for a parameter of the controller, `torque_loop.lag` for the lag.
        load: cutting force on the table [N], shape (n,).
        torque_loop: lag and dead time of the motor torque.
        tolerance: error of the table position that a step may make [m].
        start: as for `simulate_controlled`; it is taken not to depend on the parameters. At rest at 0 if None.

    Returns:
        The run and its derivatives.

    Raises:
        InputError: unknown parameter, a delay, a lag of 0.
        SimulationError: as `simulate_controlled`.
    """
    loop = torque_loop or TorqueLoop()
    machine, timing = machine_for(plant, controller, loop, {}, tangents=True)
    directions = _Directions(plant, controller, loop, tuple(parameters), machine.program)
    begin = start or resting_state(plant, controller, loop)
    fed = fed_of(plant, controller, reference, load, begin.tick)
    settings = np.concatenate([controller.parameters, [plant.torque_limit]])
    feed = Feed(fed, controller.sample_time * np.array(timing.parts), settings, loop.lag)
    outcome = run_machine(machine, plant, feed, begin.position, tolerance, directions)
    end = ControlledState(begin.tick + len(fed), outcome.position)
    run = told_run(plant, controller, fed[:, -1], outcome.seen, end, outcome.report)
    seen = directions.tangents.seen
    changes = {
        name: {series: seen[i, :, k].copy() for k, series in enumerate(SERIES)} for i, name in enumerate(parameters)
    }
    return Sensitivity(run, changes)


class _Directions:
    """One direction per parameter; carried along by `run_machine`."""

    tangents: Tangents

    def __init__(
        self, plant: Plant, controller: SampledController, loop: TorqueLoop, names: tuple[str, ...], program: Program
    ) -> None:
        self.plant, self.loop, self.names, self.program = plant, loop, names, program
        self.count = len(controller.parameters)
        self.keys = parameter_names(plant)
        for name in names:
            self._refuse_unknown(name)

    def begun(self, task: Task) -> Tangents:
        """No change at the start: it is what it is whatever the values are."""
        sizes, d = self.program.sizes, len(self.names)
        carried = sizes["N_STATES"] + sizes["N_BRISTLES"]
        settings, values = np.zeros((d, sizes["N_SETTINGS"])), np.zeros((d, sizes["N_VALUES"]))
        for i, name in enumerate(self.names):
            if name.startswith(CONTROLLER):
                settings[i, self._index(name)] = 1.0
            elif name != LAG:
                values[i, self.keys.index(name)] = 1.0
        on_fixed = np.array([self._moves_chain(name) for name in self.names], dtype=np.uint8)
        self.tangents = Tangents(
            np.zeros((d, carried)), np.zeros((d, sizes["N_OWN"])), settings, values,
            np.zeros((d, *task.fixed.shape)), on_fixed, np.zeros((d, len(task.fed), sizes["N_BEFORE"])),
        )  # fmt: skip
        return self.tangents

    def make_constants(self, task: Task, stop: Stop) -> None:
        """How the propagators of a cell and level change in every direction that moves the chain."""
        reference = CELL * (task.first_cell + stop.cell) if self.program.varies else 0.0
        for i, name in enumerate(self.names):
            if not self.tangents.on_fixed[i]:
                continue
            for part, span in enumerate(task.spans):
                change = self._change(name, reference, float(span) / 2**stop.level)
                self.tangents.fixed[i, part, stop.cell, stop.level, : len(change)] = change

    def _change(self, name: str, reference: float, step: float) -> FloatArray:
        """Derivative of the flat propagators."""
        values, lag, size = self._values(name, 1j * TINY)
        layout = self.program.step.layout
        blocks, _ = propagator_blocks(state_matrices(self.plant.chain, values, layout, lag, reference), layout, step)
        change: FloatArray = flattened(blocks).imag / (TINY * size)
        return change

    def _values(self, name: str, shift: complex) -> tuple[Mapping[str, complex], complex, float]:
        """Chain values and lag with one parameter moved by a share of itself, and the size of that share."""
        if name == LAG:
            return self.plant.chain_values(), self.loop.lag * (1 + shift), self.loop.lag
        label, _, key = name.rpartition(".")
        if not label:
            given = dict(self.plant.chain.values)
            size = abs(given[key]) or 1.0
            given[key] = given[key] + shift * size  # type: ignore[assignment]
            moved = self.plant.with_chain_values(given)
            return moved.chain_values(), self.loop.lag, size
        effect = next(effect for effect in self.plant.effects if effect.label == label)
        size = abs(float(effect.values[key])) or 1.0  # type: ignore[arg-type]
        changed = effect.with_values(**{key: effect.values[key] + shift * size})  # type: ignore[operator, arg-type]
        others = tuple(changed if e is effect else e for e in self.plant.effects)
        return replace(self.plant, effects=others).chain_values(), self.loop.lag, size

    def _moves_chain(self, name: str) -> bool:
        if name == LAG or name in self.plant.chain.values:
            return True
        return any(isinstance(e, ChainEffect) and name.startswith(f"{e.label}.") for e in self.plant.effects)

    def _index(self, name: str) -> int:
        digits = name.removeprefix(f"{CONTROLLER}[").removesuffix("]")
        return int(digits) if digits.isdigit() else -1

    def _refuse_unknown(self, name: str) -> None:
        delays = tuple(f"{e.label}." for e in self.plant.effects if isinstance(e, TimingEffect))
        if delays and name.startswith(delays):
            raise InputError(f"no derivative with {name}", self.plant.name, "a delay moves switches; vary it by hand")
        if name.startswith(tuple(f"{e.label}." for e in self.plant.effects_of(ChannelDelay))):
            mend = "shift the recording; what moves is the same"
            raise InputError(f"no derivative with {name}, which acts on the recording alone", self.plant.name, mend)
        if name.startswith(CONTROLLER):
            if not 0 <= self._index(name) < self.count:
                raise InputError(f"unknown parameter {name!r}", self.plant.name, f"count from 0 to {self.count - 1}")
        elif name == LAG:
            if not self.loop.lag > 0:
                raise InputError("no derivative with a lag of 0", self.plant.name, "give the torque loop a lag")
        elif name not in self.keys:
            raise InputError(f"unknown parameter {name!r}", self.plant.name, f"known are {', '.join(self.keys)}")
