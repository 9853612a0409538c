"""From an axis, planted effects and a profile to the recorded channels and their CSV file."""

from __future__ import annotations

import gzip
import io
import math
from pathlib import Path

import numpy as np
import numpy.typing as npt

from tests.generator.axis import AxisParameters, Sensors
from tests.generator.constants import Constants, declared_constants
from tests.generator.effects import PlantedEffects
from tests.generator.loop import Sampling, closed_loop
from tests.generator.motion import State
from tests.generator.profile import Profile, setpoint_and_chirp

Array = npt.NDArray[np.float64]

LEAST_STEPS = 96
BRISTLE_SHARE = 0.25
COLUMNS = {
    "time": ("s", "%.4f"),
    "setpoint": ("m", "%.7f"),
    "motor_torque": ("N m", "%.3f"),
    "motor_angle": ("rad", "%.7f"),
    "table_position": ("m", "%.8f"),
}


def simulate(axis: AxisParameters, effects: PlantedEffects, profile: Profile, seed: int) -> dict[str, Array]:
    """Return the recorded channels, each (n,): time, setpoint, motor_torque, motor_angle, table_position (SI units)."""
    setpoint, injected = setpoint_and_chirp(profile, axis.sample_time)
    constants = effects.planted(declared_constants(axis))
    sampling = sampling_of(axis, constants)
    torque, states = closed_loop(setpoint, injected, state_at_rest(setpoint[0], constants), sampling, constants)
    if not np.all(np.isfinite(states)):
        raise FloatingPointError("the simulated axis diverged")
    time = np.asarray(np.arange(setpoint.size) * axis.sample_time, dtype=np.float64)
    return {"time": time, "setpoint": setpoint} | measured(torque, states, axis.sensors, seed)


def sampling_of(axis: AxisParameters, constants: Constants) -> Sampling:
    """Return the loop's numbers; the step resolves the sliding bristle, whose rate is stiffness * speed / level."""
    steps = LEAST_STEPS
    if constants.bristle_stiffness > 0.0:
        level = min(constants.guide_coulomb, constants.guide_coulomb + constants.stribeck_force)
        rate = constants.bristle_stiffness * 1.2 * axis.top_speed / level
        steps = max(steps, math.ceil(rate * axis.sample_time / BRISTLE_SHARE))
    control = axis.controller
    return Sampling(
        axis.sample_time,
        axis.sample_time / steps,
        encoder_step(axis.sensors),
        control.position_gain,
        control.speed_gain,
        control.integral_time,
        control.torque_limit,
    )


def encoder_step(sensors: Sensors) -> float:
    """Return one increment of the motor encoder [rad]."""
    return 2.0 * math.pi / float(2**sensors.encoder_bits)


def state_at_rest(setpoint: float, constants: Constants) -> State:
    """Return the unloaded state in which the motor stands at the set-point [m] and the nut carries no force."""
    angle = setpoint / constants.transmission
    travel = constants.travel_amplitude * math.sin(constants.travel_order * angle + constants.travel_phase)
    return (angle, 0.0, angle, 0.0, setpoint + travel, 0.0, 0.0)


def measured(torque: Array, states: Array, sensors: Sensors, seed: int) -> dict[str, Array]:
    """Return what the sensors make of commanded torque (n,) [N m] and states (n, 7)."""
    random = np.random.default_rng(seed)
    noisy = states[:, 4] + sensors.scale_noise * random.standard_normal(torque.size)
    increment = encoder_step(sensors)
    return {
        "motor_torque": torque + sensors.torque_noise * random.standard_normal(torque.size),
        "motor_angle": np.round(states[:, 0] / increment) * increment,
        "table_position": np.round(noisy / sensors.scale_step) * sensors.scale_step,
    }


def write_csv(path: Path, data: dict[str, Array]) -> None:
    """Write the channels of `simulate` to a CSV file, compressed where the name ends in .gz (same bytes every time)."""
    text = io.StringIO()
    text.write(",".join(f"{name} [{unit}]" for name, (unit, _) in COLUMNS.items()) + "\n")
    table = np.column_stack([data[name] for name in COLUMNS])
    np.savetxt(text, table, fmt=[form for _, form in COLUMNS.values()], delimiter=",")
    content = text.getvalue().encode()
    path.parent.mkdir(parents=True, exist_ok=True)
    path.write_bytes(gzip.compress(content, 9, mtime=0) if path.suffix == ".gz" else content)
