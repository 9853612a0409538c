"""The declared numbers of the two simulated axes, their controllers and their sensors."""

from __future__ import annotations

import dataclasses
import math
from collections.abc import Mapping
from dataclasses import dataclass, field


@dataclass(frozen=True)
class Controller:
    """Cascade sampled once per recording sample, working on the quantised motor angle.

    position_gain [1/s], speed_gain [N m s/rad], integral_time [s], torque_limit [N m].
    soft_speed_gain: for axes with a delay, which would make speed_gain oscillate on the torsional mode.
    speed_share: of a new difference quotient in the measured speed, 1 without a filter.
    """

    position_gain: float
    speed_gain: float
    integral_time: float
    torque_limit: float
    soft_speed_gain: float
    speed_share: float = 1.0


@dataclass(frozen=True)
class Sensors:
    """What the recording adds: torque_noise [N m rms], encoder_bits, scale_step [m], scale_noise [m rms].

    torque_step: resolution of the recorded torque [N m], 0 for none."""

    torque_noise: float = 0.04
    encoder_bits: int = 22
    scale_step: float = 10e-9
    scale_noise: float = 15e-9
    torque_step: float = 0.0

    def noisier(self, factor: float) -> Sensors:
        """Return the sensors with `factor` times the noise; their steps stay."""
        return dataclasses.replace(self, torque_noise=factor * self.torque_noise, scale_noise=factor * self.scale_noise)


@dataclass(frozen=True)
class AxisParameters:
    """A ball-screw axis as three inertias (motor, screw, table), SI units.

    Guide friction: guide_coulomb * tanh(v / guide_velocity) + guide_viscous * v.
    Nut drag: nut_coulomb * tanh(w / drag_speed) + nut_power * sign(w) |w|^(2/3); bearing drag: bearing_coulomb * tanh.
    travel: (lowest, highest) table position of the long strokes [m]; top_speed [m/s]; acceleration [m/s^2];
    chirp_amplitude: injected torque [N m]; sample_time [s]. ratio: motor turns per screw turn.
    fall: acceleration of fall against positive motion [m/s^2], counterbalance [N] against it.
    """

    lead: float
    motor_inertia: float
    screw_inertia: float
    table_mass: float
    torsional_stiffness: float
    torsional_damping: float
    axial_stiffness: float
    axial_damping: float
    guide_coulomb: float
    guide_viscous: float
    guide_velocity: float
    nut_coulomb: float
    nut_power: float
    bearing_coulomb: float
    drag_speed: float
    travel: tuple[float, float]
    top_speed: float
    acceleration: float
    chirp_amplitude: float
    controller: Controller
    sensors: Sensors = field(default_factory=Sensors)
    sample_time: float = 5e-4
    ratio: float = 1.0
    fall: float = 0.0
    counterbalance: float = 0.0

    @property
    def transmission(self) -> float:
        """Table travel per radian of the screw [m/rad]."""
        return self.lead / (2.0 * math.pi)

    @property
    def stroke_low(self) -> float:
        """Lowest table position of the long strokes [m]."""
        return self.travel[0]

    @property
    def stroke_high(self) -> float:
        """Highest table position of the long strokes [m]."""
        return self.travel[1]

    def off_by(self, factors: Mapping[str, float]) -> AxisParameters:
        """Return the axis with these numbers multiplied; ValueError for a name that is no number of the mechanics."""
        if unknown := sorted(set(factors) - set(MECHANICAL)):
            raise ValueError(f"no number {unknown[0]} of the axis; known are {', '.join(MECHANICAL)}")
        values = {name: factor * getattr(self, name) for name, factor in factors.items()}
        return dataclasses.replace(self, **values)


MECHANICAL = (
    "motor_inertia",
    "screw_inertia",
    "table_mass",
    "torsional_stiffness",
    "torsional_damping",
    "axial_stiffness",
    "axial_damping",
    "guide_coulomb",
    "guide_viscous",
    "guide_velocity",
    "nut_coulomb",
    "nut_power",
    "bearing_coulomb",
    "drag_speed",
)
"""What may be other than declared. Not the lead: set-points are planned with it."""


BENCH = AxisParameters(
    lead=0.020,
    motor_inertia=2.6e-3,
    screw_inertia=2.37e-3,
    table_mass=134.0,
    torsional_stiffness=11_982.4,
    torsional_damping=0.074,
    axial_stiffness=244.7e6,
    axial_damping=8650.0,
    guide_coulomb=60.0,
    guide_viscous=300.0,
    guide_velocity=0.5e-3,
    nut_coulomb=0.25,
    nut_power=0.02,
    bearing_coulomb=0.10,
    drag_speed=0.15,
    travel=(0.04, 0.36),
    top_speed=0.30,
    acceleration=3.1,
    chirp_amplitude=2.2,
    controller=Controller(
        position_gain=60.0, speed_gain=1.9, integral_time=0.02, torque_limit=30.0, soft_speed_gain=0.7
    ),
)

LIGHT = AxisParameters(
    lead=0.010,
    motor_inertia=6e-4,
    screw_inertia=4e-4,
    table_mass=60.0,
    torsional_stiffness=4000.0,
    torsional_damping=0.05,
    axial_stiffness=120e6,
    axial_damping=3600.0,
    guide_coulomb=35.0,
    guide_viscous=180.0,
    guide_velocity=0.5e-3,
    nut_coulomb=0.12,
    nut_power=0.01,
    bearing_coulomb=0.05,
    drag_speed=0.15,
    travel=(0.03, 0.18),
    top_speed=0.24,
    acceleration=2.5,
    chirp_amplitude=0.7,
    controller=Controller(
        position_gain=60.0, speed_gain=0.35, integral_time=0.02, torque_limit=10.0, soft_speed_gain=0.13
    ),
)

AXES = {"bench": BENCH, "light": LIGHT}
