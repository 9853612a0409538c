"""A production axis: hundreds of short recordings of one cyclic programme over days, in which things change.

500 Hz, an encoder and a scale of 1 µm, a current with ripple of several orders and structure far above its steps;
strokes of 100 mm at one speed, the period of the cycle a whole part of the recording, so that reversals fall at the
same places of every block of it; masses, inertia and friction are guesses. The screw has a lead error per revolution, a
lead that is other and curved along the stroke, elastic lost motion and a bristle at every reversal. It warms up from
cold each day, with no thermometer; free play grows slowly, and by a jump on one day.
"""

from __future__ import annotations

import dataclasses
import math
from collections.abc import Iterator
from dataclasses import dataclass
from typing import Any

import numpy as np

from tests.generator import drawn_effects
from tests.generator.axis import AxisParameters, Controller, Sensors
from tests.generator.effects import (
    Backlash,
    BallPassRipple,
    Effect,
    LeadErrorCumulative,
    LeadErrorPeriodic,
    Presliding,
    TorqueRipple,
)
from tests.generator.effects.relatives import Relative
from tests.generator.effects.unlisted import Cogging
from tests.generator.machines import Machine, Random, with_loop
from tests.generator.programmes import Path
from tests.generator.runs import Array, Channels, run

ROW, CYCLES = 2e-3, 4
"""Time between rows [s], and cycles of the loop in it."""

STROKE = 0.100
BLOCKS = 6
"""Cycles of the programme in a recording: reversals fall at the same place of each sixth of it."""

RUNS_A_DAY = 25
MINUTES = 12.0
"""Between two recordings of a day."""


@dataclass(frozen=True)
class Day:
    """State of the axis at one recording.

    number, minute: of the recording in the series and since the cold start [min]. strain: growth of the screw.
    play: free play [m]. friction: factor on the viscous drag.
    """

    number: int
    minute: float
    strain: float
    play: float
    friction: float


@dataclass(frozen=True)
class Production:
    """The axis of a seed.

    declared, true: as guessed and as it is. constant: effects that stay. days: one a recording.
    torque_constant: true and declared [N m/A]. seed: of everything.
    """

    seed: int
    declared: Machine
    true: Machine
    constant: tuple[Effect, ...]
    days: tuple[Day, ...]
    torque_constant: float
    speed: float

    @property
    def truth(self) -> dict[str, Any]:
        """What is to be found (SI)."""
        lead = {one.name: dataclasses.asdict(one) for one in self.constant if not isinstance(one, Relative)}
        a, b = self.declared.axis, self.true.axis
        off = {key: getattr(b, key) / getattr(a, key) for key in GUESSED}
        return {"seed": self.seed, "constant": lead, "off": off, "days": [dataclasses.asdict(one) for one in self.days]}

    def recordings(self, first: int = 0, last: int | None = None) -> Iterator[Channels]:
        """Return the recordings of the series, `motor_current` among the channels."""
        for day in self.days[first:last]:
            yield self.recording(day)

    def recording(self, day: Day) -> Channels:
        """Return one recording."""
        effects = self.constant
        if day.play > 0.0:
            effects = (*effects, Backlash(day.play))
        effects = tuple(_warm(one, day) for one in effects)
        warm = self.true.with_axis(guide_viscous=self.true.axis.guide_viscous * day.friction)
        setpoint, injected = cyclic(warm, self.speed, np.random.default_rng([self.seed, day.number]))
        channels = run(warm, effects, setpoint, injected).recorded(self.seed + 7919 * (day.number + 1))
        torque = channels.pop("motor_torque")
        step = 1e-3 * self.true.axis.controller.torque_limit / self.torque_constant
        return channels | {"motor_current": np.round(torque / self.torque_constant / step) * step}


GUESSED = ("table_mass", "motor_inertia", "screw_inertia", "guide_coulomb", "guide_viscous", "nut_coulomb")
"""Numbers that nobody knows: 0.4 to 2.5 times what is declared."""

TOLERANCES = {**drawn_effects.TOLERANCES, "mass": 1.5, "inertia": 1.5, "friction": 1.5}
"""What the plant file says of how well its values are known: a guess may be wrong by a factor of 2.5, either way."""


def _warm(effect: Effect, day: Day) -> Effect:
    """Return the lead of a warm screw."""
    if not isinstance(effect, Relative):
        return effect
    lead = effect.base
    assert isinstance(lead, LeadErrorCumulative)
    slope = lead.slope + day.strain
    changes = {"lead_curve": effect.changes["lead_curve"] * lead.slope / slope}
    return Relative(LeadErrorCumulative(slope), effect.law, changes)


def production(seed: int, runs: int = 250) -> Production:
    """Return the axis of a seed with so many recordings."""
    random = np.random.default_rng([seed, 16])
    true = _true_machine(random)
    factors = {key: float(np.exp(random.uniform(math.log(0.4), math.log(2.5)))) for key in GUESSED}
    guessed = {key: float(f"{getattr(true.axis, key) / factor:.2g}") for key, factor in factors.items()}
    a = true.axis
    drag, r = a.nut_coulomb + a.bearing_coulomb, a.transmission
    level = a.guide_coulomb * r + drag
    slope = float(random.uniform(20e-6, 60e-6)) * float(random.choice([-1, 1]))
    constant: tuple[Effect, ...] = (
        LeadErrorPeriodic(float(random.uniform(2e-6, 8e-6)), 1.0, float(random.uniform(0, 2 * math.pi))),
        Relative(LeadErrorCumulative(slope), "a parabola beside the line", {"lead_curve": float(random.uniform(1, 3))}),
        Presliding(a.guide_coulomb / float(random.uniform(10e-6, 30e-6)), 0.0),
        TorqueRipple(0.15 * level, 6.0, float(random.uniform(0, 2 * math.pi))),
        BallPassRipple(0.25 * drag, float(random.uniform(7.1, 7.8)), 1.0),
        Cogging(0.1 * a.guide_coulomb, float(random.uniform(0.015, 0.03)), 0.4),
    )
    return Production(seed, true.with_axis(**guessed), true, constant, _days(random, runs), 0.9, a.top_speed)


def _days(random: Random, runs: int) -> tuple[Day, ...]:
    warm, tau = float(random.uniform(60e-6, 120e-6)), float(random.uniform(40.0, 90.0))
    slow, jump = float(random.uniform(10e-9, 30e-9)), float(random.uniform(120e-6, 200e-6))
    when = int(random.uniform(0.5, 0.8) * runs)
    days = []
    for number in range(runs):
        minute = MINUTES * (number % RUNS_A_DAY)
        share = 1.0 - math.exp(-minute / tau)
        play = 3e-6 + slow * number + (jump if number >= when else 0.0)
        days.append(Day(number, minute, warm * share, play, 1.0 - 0.35 * share))
    return tuple(days)


def _true_machine(random: Random) -> Machine:
    mass = float(random.uniform(150.0, 600.0))
    axis = AxisParameters(
        lead=0.010,
        motor_inertia=float(random.uniform(2e-3, 6e-3)),
        screw_inertia=float(random.uniform(1.5e-3, 4e-3)),
        table_mass=mass,
        torsional_stiffness=float(random.uniform(8e3, 2e4)),
        torsional_damping=0.08,
        axial_stiffness=float(random.uniform(1e8, 2.5e8)),
        axial_damping=9000.0,
        guide_coulomb=float(random.uniform(80.0, 200.0)),
        guide_viscous=float(random.uniform(300.0, 900.0)),
        guide_velocity=0.5e-3,
        nut_coulomb=float(random.uniform(0.2, 0.5)),
        nut_power=0.02,
        bearing_coulomb=0.1,
        drag_speed=0.2,
        travel=(0.15, 0.65),
        top_speed=float(random.uniform(0.08, 0.16)),
        acceleration=1.5,
        chirp_amplitude=0.0,
        controller=Controller(1.0, 1.0, 1.0, 20.0, 1.0),
        sensors=Sensors(
            torque_noise=0.02, encoder_bits=int(random.choice([17, 20])), scale_step=1e-6, scale_noise=0.3e-6
        ),
        sample_time=ROW / CYCLES,
    )
    return with_loop(Machine(axis, CYCLES, True, 0.032), 0.6)


def cyclic(machine: Machine, speed: float, random: Random) -> tuple[Array, Array]:
    """Return set-point [m] and injected torque of BLOCKS equal strokes there and back."""
    path = Path(machine, 0.35 + float(random.uniform(-1e-3, 1e-3)), [])
    for _ in range(BLOCKS):
        path.move(path.position + STROKE, speed)
        path.rest(0.1)
        path.move(path.position - STROKE, speed)
        path.rest(0.1)
    setpoint = np.concatenate(path.pieces)
    window = np.ones(20) / 20
    for _ in range(2):
        setpoint = np.convolve(np.concatenate([np.full(19, setpoint[0]), setpoint]), window, mode="valid")
    rows = len(setpoint) // machine.every * machine.every
    return setpoint[:rows], np.zeros(rows)
