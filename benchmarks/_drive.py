"""The drive that the engines are compared on: five coordinates, torque loop, bristle friction, sampled cascade.

Rotor, two torsional screw coordinates, axial screw coordinate and table; stiffness-proportional damping; a torque loop
of first order; friction with a bristle stiffer than any mode. Velocity PI at 8 kHz with a clamped integrator, position
P at a quarter of that.
"""

from __future__ import annotations

import math
from dataclasses import dataclass

import casadi as ca
import numpy as np

from feeddrive.effects.friction.friction_vs_position import FrictionVsPosition
from feeddrive.effects.friction.guide_friction import GuideFriction
from feeddrive.effects.friction.presliding import Presliding
from feeddrive.effects.friction.stribeck import Stribeck
from feeddrive.plant.chain.linear_chain import Chain, ChainValue, Matrix, Row, Spring, Values
from feeddrive.plant.plant import Plant
from feeddrive.servo.sampled_plant import SampledController
from feeddrive.typing import Expression, FloatArray

SAMPLE = 1 / 8000
DURATION = 2.0
LAG = 0.25e-3
DIVIDER = 4


@dataclass(frozen=True)
class FiveCoordinates(Chain):
    """Motor, drive end, screw at the nut, axial screw, table."""

    structure = "five_coordinates"
    required = tuple(ChainValue(key, "", "") for key in ("lead", "table_mass"))

    @property
    def coordinates(self) -> tuple[str, ...]:
        return ("motor", "drive_end", "screw", "axial", "table")

    def springs(self, p: Values, position: Expression = 0.0) -> tuple[Spring, ...]:
        rows = ([1.0, -1.0, 0.0, 0.0, 0.0], [0.0, 1.0, -1.0, 0.0, 0.0], [0.0, 0.0, 0.0, 1.0, 0.0])
        keys = ("coupling_stiffness", "torsional_stiffness", "axial_stiffness")
        springs = [Spring(key, row, p[key], p["damping_time"] * p[key]) for key, row in zip(keys, rows, strict=True)]
        return (*springs, self.nut(p))

    def nut(self, p: Values) -> Spring:
        row = [0.0, 0.0, p["lead"] / (2 * math.pi), 1.0, -1.0]
        return Spring("nut", row, p["nut_stiffness"], p["damping_time"] * p["nut_stiffness"])

    def mass(self, p: Values, position: Expression = 0.0) -> Matrix:
        keys = ("motor_inertia", "drive_end_inertia", "screw_inertia", "axial_mass", "table_mass")
        return [[p[key] if i == j else 0.0 for j in range(5)] for i, key in enumerate(keys)]

    def motor(self, p: Values) -> Row:
        return [1.0, 0.0, 0.0, 0.0, 0.0]

    def screw(self, p: Values) -> Row:
        return [0.0, 0.0, 1.0, 0.0, 0.0]

    def rigid_motion(self, p: Values) -> Row:
        turn = 2 * math.pi / p["lead"]
        return [turn, turn, turn, 0.0, 1.0]


CHAIN = FiveCoordinates(
    {
        "lead": 0.020, "motor_inertia": 6.8e-3, "drive_end_inertia": 2.0e-3, "screw_inertia": 1.2e-3,
        "coupling_stiffness": 1.95e4, "torsional_stiffness": 3.6e4, "axial_mass": 6.0, "axial_stiffness": 260e6,
        "nut_stiffness": 1500e6, "table_mass": 134.0, "damping_time": 5e-5,
    }
)  # fmt: skip
FRICTION = {"coulomb": 60.0, "viscous": 300.0, "stiffness": 5e7, "damping": 2e4, "extra": 20.0, "stribeck": 5e-3}
BUMP = {"peak": 40.0, "centre": 0.1, "half_width": 0.03}


def drive(bump: bool = False) -> Plant:
    """The plant with its friction, and with a bump in its Coulomb level; 18 N m at most."""
    f = FRICTION
    guide = GuideFriction.of(coulomb=f["coulomb"], smoothing_velocity=1e-3, viscous=f["viscous"])
    bristle = Presliding.of(stiffness=f["stiffness"], damping=f["damping"], break_away=0.0)
    stribeck = Stribeck.of(delta_force=f["extra"], velocity=f["stribeck"])
    more = (FrictionVsPosition.of(**BUMP),) if bump else ()
    return Plant("drive", CHAIN, (guide, bristle, stribeck, *more), torque_limit=18.0)


GAINS = {"position_gain": 40.0, "velocity_gain": 2.5, "integral_gain": 2.5 * SAMPLE / 0.02, "limit": 18.0}


def controller() -> SampledController:
    """The cascade as one function of a tick; parameters as in `GAINS`, the radius last."""
    state, wanted, measured = ca.SX.sym("state", 2), ca.SX.sym("wanted"), ca.SX.sym("measured", 2)
    tick, p = ca.SX.sym("tick"), ca.SX.sym("p", 5)
    speed = ca.if_else(ca.fmod(tick, DIVIDER) == 0, p[0] * (wanted - measured[0]), state[1])
    error = speed / p[4] - measured[1]
    asked = p[1] * error + state[0]
    torque = ca.fmin(ca.fmax(asked, -p[3]), p[3])
    integral = state[0] + ca.if_else(torque == asked, p[2] * error, 0)
    function = ca.Function("cascade", [state, wanted, measured, tick, p], [ca.vertcat(integral, speed), torque, speed])
    values = np.array([*GAINS.values(), CHAIN.radius])
    return SampledController(
        function, np.zeros(2), values, SAMPLE, ("position",), ("table_position", "motor_speed"), ("speed",)
    )


def wanted_position(count: int = round(DURATION / SAMPLE)) -> FloatArray:
    """A stroke there and back, 0.4 m/s at most [m], shape (n,)."""
    turn = 2 * math.pi * 0.5
    position: FloatArray = 0.4 / turn * (1 - np.cos(turn * SAMPLE * np.arange(count)))
    return position
