"""Machines drawn at random from the sizes that are built: screw, drive, table, friction, sensors and a loop for them.

Lead 4 to 40 mm, 5 to 3000 kg, 0.2 to 3 m of stroke, direct or by a belt, horizontal or vertical, encoders of 12 to 24
bits, scales of 1 nm to 5 µm or none, 250 Hz to 20 kHz. Stiffness and inertia follow from the screw's size, friction
from weight and seals, the loop from the first locked resonance, the cycle and the encoder.
"""

from __future__ import annotations

import dataclasses
import math
from dataclasses import dataclass

import numpy as np

from tests.generator.axis import AxisParameters, Controller, Sensors

STEEL, SHEAR, DENSITY = 2.06e11, 7.9e10, 7850.0
FALL = 9.80665
DIAMETERS = (12, 14, 16, 20, 25, 28, 32, 36, 40, 45, 50, 63, 80)
LEADS = (4, 5, 6, 8, 10, 12, 15, 16, 20, 25, 30, 32, 40)
BITS = (12, 14, 16, 17, 18, 19, 20, 22, 23, 24)
BITS_OFTEN = (0.05, 0.06, 0.10, 0.12, 0.12, 0.05, 0.15, 0.15, 0.08, 0.12)
STEPS = (1e-9, 5e-9, 10e-9, 50e-9, 100e-9, 500e-9, 1e-6, 5e-6)
RATES = (250.0, 500.0, 1000.0, 2000.0, 4000.0, 8000.0, 16000.0, 20000.0)
RATES_OFTEN = (0.06, 0.10, 0.24, 0.28, 0.18, 0.08, 0.03, 0.03)
WITHOUT_SCALE = 0.15
BELT, VERTICAL, BOX_WAYS = 0.25, 0.2, 0.25
HEAVIEST_VERTICAL = 800.0

Random = np.random.Generator


@dataclass(frozen=True)
class Machine:
    """A machine and how it is recorded.

    axis: its numbers; sample_time is the cycle of the loop. every: cycles in a row of the recording.
    scale: whether the table position is recorded. diameter: of the screw [m].
    """

    axis: AxisParameters
    every: int
    scale: bool
    diameter: float

    @property
    def row_time(self) -> float:
        """Time between rows [s]."""
        return self.every * self.axis.sample_time

    @property
    def radius(self) -> float:
        """Table travel per radian of the motor [m/rad]."""
        return self.axis.transmission / self.axis.ratio

    @property
    def inertia(self) -> float:
        """Of all that moves, at the motor [kg m^2]."""
        a = self.axis
        return a.motor_inertia + a.screw_inertia / a.ratio**2 + a.table_mass * self.radius**2

    @property
    def friction_torque(self) -> float:
        """Coulomb friction of guide and screw at the motor [N m]."""
        a = self.axis
        return a.guide_coulomb * self.radius + (a.nut_coulomb + a.bearing_coulomb) / a.ratio

    def with_axis(self, **changes: object) -> Machine:
        """Return the machine with other numbers."""
        return dataclasses.replace(self, axis=dataclasses.replace(self.axis, **changes))  # type: ignore[arg-type]


def drawn_machine(random: Random, bits: int = 0, rate: float = 0.0) -> Machine:
    """Return a machine; `bits` of the encoder and `rate` of the recording [Hz] where they are given."""
    mass = _between(random, 5.0, 3000.0)
    diameter = _nearest(DIAMETERS, 12.0 * (mass / 5.0) ** 0.27 * random.uniform(0.85, 1.3))
    stroke = min(_between(random, 0.2, 3.0), 0.04 * diameter)
    leads = [lead for lead in LEADS if 0.18 * diameter <= lead <= 1.25 * diameter]
    lead = float(random.choice(leads)) * 1e-3
    ratio = float(random.choice([1.5, 2.0, 2.5])) if random.random() < BELT else 1.0
    falls = mass <= HEAVIEST_VERTICAL and random.random() < VERTICAL / 0.75
    size, d = diameter / 40.0, diameter * 1e-3
    length = stroke + 6.0 * d
    r = lead / (2.0 * math.pi)
    screw_inertia = math.pi / 32.0 * DENSITY * d**4 * length
    screw_inertia += (2.5e-3 if ratio > 1.0 else 8e-4) * size**4 * random.uniform(0.6, 1.6)
    load = (screw_inertia + mass * r**2) / ratio**2
    torsional = _series(
        SHEAR * math.pi / 32.0 * (0.88 * d) ** 4 / (0.5 * length),
        (2.5e4 if ratio > 1.0 else 4e4) * size**3 * _between(random, 0.5, 2.0),
    )
    axial = _series(
        STEEL * math.pi / 4.0 * (0.88 * d) ** 2 / (0.5 * length),
        diameter * random.uniform(8e6, 20e6),
        diameter * random.uniform(10e6, 25e6),
    )
    acceleration = _between(random, 0.8, 8.0) * (mass / 100.0) ** -0.25
    turns = min(random.uniform(1500.0, 4000.0) / ratio, 1e5 / diameter)
    top_speed = min(turns / 60.0 * lead, 0.8 * math.sqrt(acceleration * stroke), 1.2)
    guide = random.uniform(5.0, 20.0) * diameter / 25.0
    boxes = mass > 200.0 and random.random() < BOX_WAYS
    guide += mass * FALL * (random.uniform(0.03, 0.08) if boxes else random.uniform(0.003, 0.01)) * (not falls)
    drag = 0.12 * (diameter / 25.0) ** 2.5 * random.uniform(0.5, 1.8)
    top_turn = top_speed / r
    weight = mass * FALL if falls else 0.0
    held = 0.0 if weight < 1500.0 and random.random() < 0.6 else weight * random.uniform(0.5, 0.95)
    motor_inertia = load * _between(random, 0.3, 1.5)
    friction = (guide * r + 1.4 * drag) / ratio
    peak = (motor_inertia + load) * acceleration * ratio / r + 2.2 * friction + abs(weight - held) * r / ratio
    limit = float(f"{peak * random.uniform(1.5, 2.5):.2g}")
    rate = rate or float(random.choice(RATES, p=RATES_OFTEN))
    row_time = 1.0 / rate
    every = max(1, round(row_time / float(random.choice([250e-6, 500e-6, row_time])))) if rate <= 1000.0 else 1
    every = max(every, math.ceil(row_time / 2e-3 - 1e-9))
    axis = AxisParameters(
        lead=lead,
        motor_inertia=_three(motor_inertia),
        screw_inertia=_three(screw_inertia),
        table_mass=_three(mass),
        torsional_stiffness=_three(torsional),
        torsional_damping=_three(2.0 * random.uniform(0.01, 0.05) * math.sqrt(torsional * screw_inertia)),
        axial_stiffness=_three(axial),
        axial_damping=_three(2.0 * random.uniform(0.01, 0.05) * math.sqrt(axial * mass)),
        guide_coulomb=_three(guide),
        guide_viscous=_three(guide * random.uniform(0.2, 1.2) / top_speed),
        guide_velocity=_three(max(_between(random, 0.2e-3, 1.5e-3), 2e-3 * top_speed)),
        nut_coulomb=_three(drag),
        nut_power=_three(drag * random.uniform(0.2, 1.0) / top_turn ** (2.0 / 3.0)),
        bearing_coulomb=_three(drag * random.uniform(0.2, 0.5)),
        drag_speed=_three(max(_between(random, 0.1, 0.5), 2e-3 * top_turn)),
        travel=(0.05, 0.05 + round(stroke, 3)),
        top_speed=top_speed,
        acceleration=acceleration,
        chirp_amplitude=min(random.uniform(1.0, 4.0) * friction, 0.2 * limit),
        controller=Controller(1.0, 1.0, 1.0, limit, 1.0),
        sensors=_sensors(random, limit, bits),
        sample_time=row_time / every,
        ratio=ratio,
        fall=FALL if falls else 0.0,
        counterbalance=_three(held),
    )
    return with_loop(Machine(axis, every, random.random() >= WITHOUT_SCALE, d))


def _sensors(random: Random, limit: float, bits: int) -> Sensors:
    step = float(random.choice(STEPS))
    return Sensors(
        torque_noise=limit * _between(random, 3e-4, 2e-3),
        encoder_bits=bits or int(random.choice(BITS, p=BITS_OFTEN)),
        scale_step=step,
        scale_noise=max(step * random.uniform(0.3, 1.0), _between(random, 3e-9, 20e-9)),
        torque_step=limit / float(2 ** random.integers(11, 15)),
    )


QUIET = 0.02
"""Torque that one increment of the encoder asks for, over the limit, at most."""


def with_loop(machine: Machine, gain: float = 1.0) -> Machine:
    """Return the machine with gains that suit it, times `gain`."""
    a = machine.axis
    cycle = a.sample_time
    at_table = 1.0 / (1.0 / a.axial_stiffness + a.transmission**2 / a.torsional_stiffness)
    locked = math.sqrt(min(at_table / a.table_mass, a.torsional_stiffness / a.screw_inertia))
    crossover = gain * min(0.3 * locked, 0.1 / cycle, 2.0 * math.pi * 60.0)
    crossover = min(crossover, gain * 0.3 * a.motor_inertia / (cycle * machine.inertia))
    increment = 2.0 * math.pi / 2.0**a.sensors.encoder_bits
    share = 1.0
    for _ in range(20):
        asked = crossover * machine.inertia * increment / cycle
        share = min(1.0, QUIET * a.controller.torque_limit / asked)
        lag = cycle * (1.0 - share) / share
        if crossover * lag <= 0.35:
            break
        crossover *= 0.8
    speed_gain = crossover * machine.inertia
    return machine.with_axis(
        controller=Controller(
            position_gain=min(0.22 * crossover, 120.0),
            speed_gain=speed_gain,
            integral_time=6.0 / crossover,
            torque_limit=a.controller.torque_limit,
            soft_speed_gain=0.4 * speed_gain,
            speed_share=share,
        )
    )


def _between(random: Random, low: float, high: float) -> float:
    """Return a number whose logarithm is uniform."""
    return float(math.exp(random.uniform(math.log(low), math.log(high))))


def _nearest(values: tuple[int, ...], wanted: float) -> float:
    return float(min(values, key=lambda value: abs(math.log(value / wanted))))


def _series(*stiffness: float) -> float:
    return 1.0 / sum(1.0 / one for one in stiffness)


def _three(value: float) -> float:
    """Return the value as a data sheet prints it."""
    return float(f"{value:.3g}")
