"""The machine of a plant under a sampled controller: what is done at a tick, and when its torque acts."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from functools import lru_cache

import casadi as ca

from feeddrive.engine.engine import Machine, machine_of
from feeddrive.engine.program import Program
from feeddrive.engine.step.step import torque_step
from feeddrive.engine.timing import Timing, timing_of
from feeddrive.errors import InputError
from feeddrive.plant.motor_torque import acting_torque
from feeddrive.plant.plant import Plant
from feeddrive.plant.structure import parameter_symbols, per_structure
from feeddrive.servo.sampled_plant import MEASUREMENTS, SampledController
from feeddrive.simulate.held_torque import readings_of
from feeddrive.symbolic_turn import SYMBOLS
from feeddrive.typing import Expression


@dataclass(frozen=True)
class TorqueLoop:
    """How the motor torque follows its command.

    Attributes:
        lag: time constant [s]; 0 for none.
        dead_time: [s], of any length.

    Raises:
        InputError: a negative time.
    """

    lag: float = 0.0
    dead_time: float = 0.0

    def __post_init__(self) -> None:
        for name, value in (("lag", self.lag), ("dead time", self.dead_time)):
            if not 0 <= value < float("inf"):
                raise InputError(f"{name} {value:g} s", "torque loop", "give a time of 0 s or more")


def machine_for(
    plant: Plant, controller: SampledController, loop: TorqueLoop, steps: Mapping[str, float], tangents: bool = False
) -> tuple[Machine, Timing]:
    """The machine of a controlled run and how its torque meets the samples."""
    timing = timing_of(plant, controller.sample_time, loop.dead_time)
    key = ControllerKey(controller.function, controller.measurements, tuple(steps))
    return controlled_machine(plant, key, loop.lag > 0, timing.late, len(timing.parts), tangents), timing


@lru_cache(maxsize=64)
@SYMBOLS.taken()
def _written(function: ca.Function) -> str:
    """The function as text, once per function: runs of one controller follow one another."""
    return function.serialize()


class ControllerKey:
    """A controller's equations; two functions with the same content are one."""

    def __init__(self, function: ca.Function, measurements: tuple[str, ...], quantised: tuple[str, ...]) -> None:
        self.function, self.measurements, self.quantised = function, measurements, quantised
        self._content = (_written(function), measurements, quantised)

    def __eq__(self, other: object) -> bool:
        return isinstance(other, ControllerKey) and self._content == other._content

    def __hash__(self) -> int:
        return hash(self._content)


@per_structure
def controlled_machine(
    plant: Plant, key: ControllerKey, lagging: bool, late: int, parts: int, tangents: bool
) -> Machine:
    """What runs a plant under a controller; `late` and `parts` as in `Timing`."""
    step, function = torque_step(plant, lagging), key.function
    layout, past, kept = step.layout, late + parts - 1, function.size1_in(0)
    references = function.size1_in(1)
    memory, own = ca.SX.sym("memory", layout.memory), ca.SX.sym("own", kept + past)
    fed = ca.SX.sym("fed", references + 3)
    settings = ca.SX.sym("settings", function.size1_in(4) + len(key.quantised) + 1)
    symbols = parameter_symbols(plant)
    values = symbols.vector
    readings = readings_of(plant, layout)(memory, fed[references + 2], values)
    measured = _measured(key, readings, settings[function.size1_in(4) :])
    after, asked, signals = function(
        own[:kept], fed[:references], measured, fed[references + 1], settings[: function.size1_in(4)]
    )
    limit = settings[settings.numel() - 1]
    command = ca.fmin(ca.fmax(asked, -limit), limit)
    torques = ca.vertcat(own[kept:], command)  # oldest first
    asked_for = [torques[i] for i in range(parts)]
    given = asked_for if lagging else [acting_torque(plant, symbols, torque) for torque in asked_for]
    held = ca.vertcat(*[ca.vertcat(torque, fed[references]) for torque in given])
    acting = memory[layout.states - 1] if lagging else torques[0]
    states = ca.vertcat(memory[: 2 * layout.coordinates], memory[layout.states : layout.states + layout.bristles])
    seen = ca.vertcat(command, acting, readings, states, signals)
    arguments = [memory, own, fed, settings, values]
    own_after = ca.vertcat(after, torques[1:] if past else ca.SX.zeros(0, 1))
    before = ca.Function("feeddrive_before", arguments, [own_after, held, seen])
    nothing = ca.Function("feeddrive_after", arguments, [ca.SX.zeros(0, 1)])
    return machine_of(Program(step, before, nothing, parts, plant.chain.varies, tangents))


def _measured(key: ControllerKey, readings: Expression, steps: Expression) -> Expression:
    """What the controller reads, in whole steps where a sensor has them."""
    columns = []
    for name in key.measurements:
        reading = readings[list(MEASUREMENTS).index(name)]
        if name in key.quantised:
            step = steps[key.quantised.index(name)]
            reading = step * ca.floor(reading / step + 0.5)
        columns.append(reading)
    return ca.vertcat(*columns)


def resolutions_of(plant: Plant, controller: SampledController) -> dict[str, float]:
    """Measurement to resolution, of those that have one."""
    declared = {sensor.channel: sensor.resolution for sensor in plant.sensors}
    return {name: declared[name] for name in controller.measurements if declared.get(name, 0.0) > 0}
