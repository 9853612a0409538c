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
from tests.generator.lateness import as_recorded, lateness
from tests.generator.loop import Sampling, closed_loop
from tests.generator.profile import Profile, setpoint_and_chirp
from tests.generator.state import State

Array = npt.NDArray[np.float64]

LONGEST_STEP = 5e-4 / 96
"""Step [s] of the committed recordings: 0.2 nm and better against a reference integrator."""

QUICK_STEP = 5e-4 / 24
"""Step [s] of recordings made on the fly."""

BRISTLE_SHARE = 0.25
COLUMNS = {
    "time": ("s", "%.4f"),
    "setpoint": ("m", "%.7f"),
    "motor_torque": ("N m", "%.3f"),
    "motor_angle": ("rad", "%.7f"),
    "table_position": ("m", "%.8f"),
}


def simulate(
    axis: AxisParameters, effects: PlantedEffects, profile: Profile, seed: int, longest_step: float = LONGEST_STEP
) -> dict[str, Array]:
    """Return the recorded channels, each (n,): time, setpoint, motor_torque, motor_angle, table_position (SI units)."""
    setpoint, injected = setpoint_and_chirp(profile, axis.sample_time)
    constants = effects.planted(declared_constants(axis))
    sampling = sampling_of(axis, constants, longest_step)
    at_rest = state_at_rest(setpoint[0], constants)
    torque, states, read = closed_loop(setpoint, injected, at_rest, sampling, constants)
    if not np.all(np.isfinite(states)):
        raise FloatingPointError("the simulated axis diverged")
    time = np.asarray(np.arange(setpoint.size) * axis.sample_time, dtype=np.float64)
    rows = lateness(axis.sample_time, constants).rows
    exact = as_recorded(torque, states, read, rows, constants)
    return {"time": time, "setpoint": setpoint} | measured(*exact, axis.sensors, seed)


def sampling_of(axis: AxisParameters, constants: Constants, longest_step: float = LONGEST_STEP) -> Sampling:
    """Return the loop's numbers; the step resolves the sliding bristle, whose rate is stiffness * speed / level."""
    steps = math.ceil(axis.sample_time / longest_step - 1e-9)
    if constants.bristle_stiffness > 0.0:
        rate = constants.bristle_stiffness * 1.2 * axis.top_speed / least_level(constants)
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
        lateness(axis.sample_time, constants).reading,
        control.speed_share,
    )


def least_level(constants: Constants) -> float:
    """Return the lowest sliding friction level of the guide [N]; ValueError where it is not positive."""
    parts = (constants.coulomb_asymmetry, constants.stribeck_force, constants.bump_peak)
    level = constants.guide_coulomb + sum(min(part, 0.0) for part in parts)
    if level <= 0.0:
        raise ValueError("the guide's friction level is not positive everywhere, which a bristle needs")
    return level


def encoder_step(sensors: Sensors) -> float:
    """Return one increment of the motor encoder [rad]."""
    return 2.0 * math.pi / float(2**sensors.encoder_bits)


def state_at_rest(setpoint: float, constants: Constants) -> State:
    """Return the unloaded state in which the motor stands at the set-point [m] and the nut carries no force."""
    screw = setpoint / constants.transmission
    travel = constants.travel_amplitude * math.sin(constants.travel_order * screw + constants.travel_phase)
    return State(constants.ratio * screw, 0.0, screw, 0.0, (setpoint + travel) / (1.0 - constants.lead_slope), 0.0)


def measured(torque: Array, angle: Array, position: Array, sensors: Sensors, seed: int) -> dict[str, Array]:
    """Return what the sensors make of torque [N m], motor angle [rad] and table position [m], each (n,)."""
    random = np.random.default_rng(seed)
    noisy = position + sensors.scale_noise * random.standard_normal(torque.size)
    increment = encoder_step(sensors)
    return {
        "motor_torque": stepped(
            torque + sensors.torque_noise * random.standard_normal(torque.size), sensors.torque_step
        ),
        "motor_angle": np.round(angle / increment) * increment,
        "table_position": np.round(noisy / sensors.scale_step) * sensors.scale_step,
    }


def stepped(values: Array, step: float) -> Array:
    """Return `values` in steps; as they are where the step is 0."""
    return np.asarray(np.round(values / step) * step) if step > 0.0 else values


def write_csv(path: Path, data: dict[str, Array]) -> None:
    """Write the channels of `simulate` to a CSV file, compressed where the name ends in .gz (same bytes every time).

    Times have the decimals that the sample time needs, four at least.
    """
    text = io.StringIO()
    text.write(",".join(f"{name} [{unit}]" for name, (unit, _) in COLUMNS.items()) + "\n")
    table = np.column_stack([data[name] for name in COLUMNS])
    forms = COLUMNS | {"time": ("s", time_form(data["time"]))}
    np.savetxt(text, table, fmt=[form for _, form in forms.values()], delimiter=",")
    content = text.getvalue().encode()
    path.parent.mkdir(parents=True, exist_ok=True)
    path.write_bytes(gzip.compress(content, 9, mtime=0) if path.suffix == ".gz" else content)


def time_form(time: Array) -> str:
    """Return the format of the time column: enough decimals for the sample time, four at least, nine at most."""
    sample = float(time[1] - time[0])
    digits = next((d for d in range(4, 9) if abs(round(sample, d) - sample) < 1e-12), 9)
    return f"%.{digits}f"
