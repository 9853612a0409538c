"""How far the change that an effect makes is from what declared values within their tolerance make.

Changes of torque and position under the recorded motion are taken over the density of the sensors' noise, the encoder's
error carried through the chain included, and compared there: lengths are standard deviations.
"""

from __future__ import annotations

import math

import numpy as np

from tests.generator.drawn_effects import OFF_GROUPS, TOLERANCES
from tests.generator.effects import Effect
from tests.generator.machines import Machine
from tests.generator.recording import encoder_step
from tests.generator.runs import Array, Run, changes, impedance

HIGHEST = 150.0
"""Highest frequency that counts [Hz]; a fifth of the rate of the rows where that is less."""


def from_declared(run: Run, name: str) -> float:
    """Return how far the planted effect of this name is from declared values that are off within their tolerance."""
    without: tuple[Effect, ...] = tuple(other for other in run.effects if other.name != name)
    return distance(whitened(run.machine, *changes(run, without)), calibration(run), free=0)


def calibration(run: Run) -> Array:
    """Return what every group of declared values changes that is off by one tolerance, (k, groups).

    Quasi-static, as below the first resonance: x = r phi - F / k - r T / kt, the force F of the nut and the torque T of
    the screw being those of masses, friction and weight in the motion of the run.
    """
    a, cycle = run.machine.axis, run.machine.axis.sample_time
    r, gear = a.transmission, a.ratio
    velocity, turning = run.states[:, 5], run.states[:, 3]
    heavy = a.table_mass * (np.gradient(velocity, cycle) + a.fall)
    dry, wet = a.guide_coulomb * np.tanh(velocity / a.guide_velocity), a.guide_viscous * velocity
    spinning = a.screw_inertia * np.gradient(turning, cycle)
    drag = (a.nut_coulomb + a.bearing_coulomb) * np.tanh(turning / a.drag_speed)
    oil = a.nut_power * np.sign(turning) * np.abs(turning) ** (2.0 / 3.0)
    motor = a.motor_inertia * np.gradient(run.states[:, 1], cycle)
    force = heavy + dry + wet - a.counterbalance
    twisting = r * force + spinning + drag + oil
    none = np.zeros_like(force)

    def by_force(part: Array) -> tuple[Array, Array]:
        return part * r / gear, -part * (1.0 / a.axial_stiffness + r**2 / a.torsional_stiffness)

    def by_torque(part: Array) -> tuple[Array, Array]:
        return part / gear, -part * r / a.torsional_stiffness

    change: dict[str, tuple[Array, Array]] = {
        "table_mass": by_force(heavy),
        "motor_inertia": (motor, none),
        "screw_inertia": by_torque(spinning),
        "guide_coulomb": by_force(dry),
        "guide_viscous": by_force(wet),
        "nut_coulomb": by_torque(drag),
        "nut_power": by_torque(oil),
        "axial_stiffness": (none, force / a.axial_stiffness),
        "torsional_stiffness": (none, r * twisting / a.torsional_stiffness),
        "axial_damping": (none, a.axial_damping * np.gradient(force, cycle) / a.axial_stiffness**2),
        "torsional_damping": (none, r * a.torsional_damping * np.gradient(twisting, cycle) / a.torsional_stiffness**2),
        "torque_constant": (run.torque, none),
    }
    columns = []
    for names, kind in OFF_GROUPS:
        torque, position = (TOLERANCES[kind] * part[run.rows] for part in change[names[0]])
        columns.append(whitened(run.machine, torque, position))
    return np.column_stack(columns)


def whitened(machine: Machine, torque: Array, position: Array) -> Array:
    """Return both channels, Fourier transformed, over the noise's density: real numbers of unit variance, (k,)."""
    row_time, sensors = machine.row_time, machine.axis.sensors
    hertz = np.fft.rfftfreq(len(torque), row_time)
    inside = (hertz > 0.0) & (hertz <= min(HIGHEST, 0.2 / row_time))
    angle = encoder_step(sensors) ** 2 / 12.0
    to_torque, to_position = impedance(machine, hertz[inside])
    noises = [
        sensors.torque_noise**2 + sensors.torque_step**2 / 12.0 + np.abs(to_torque) ** 2 * angle,
        sensors.scale_noise**2 + sensors.scale_step**2 / 12.0 + np.abs(to_position) ** 2 * angle,
    ]
    series = [torque, position] if machine.scale else [torque]
    window = np.hanning(len(torque))
    parts = []
    for values, noise in zip(series, noises, strict=False):
        spectrum = np.fft.rfft((values - np.mean(values)) * window)[inside]
        scaled = spectrum * math.sqrt(2.0 / np.sum(window**2)) / np.sqrt(noise)
        parts += [scaled.real, scaled.imag]
    return np.concatenate(parts)


def distance(target: Array, columns: Array, free: int) -> float:
    """Return the length of what columns leave of a target; all but the last `free` have unit prior deviation."""
    count = columns.shape[1]
    scale = np.linalg.norm(columns, axis=0)
    scale[scale == 0.0] = 1.0
    prior = np.diag(np.concatenate([np.ones(count - free), np.zeros(free)]) / scale)
    stacked = np.vstack([columns / scale, prior])
    wanted = np.concatenate([target, np.zeros(count)])
    solution = np.linalg.lstsq(stacked, wanted, rcond=None)[0]
    return float(np.linalg.norm(wanted - stacked @ solution))
