"""The energy of a cycle closes whatever acts in it: losses come from the plant's own laws."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from feeddrive.effects.base import Effect
from feeddrive.effects.catalogue import EFFECTS
from feeddrive.plant.file.plant_file import read_plant
from feeddrive.plant.plant import Plant
from feeddrive.servo.cascade_function import cascade_controller
from feeddrive.simulate.controlled.controlled import ControlledRun, TorqueLoop, resting_state, simulate_controlled
from feeddrive.simulate.scenario.cycle_losses import CycleLosses, cycle_losses
from tests.analytic.warm_cases import PLANT_FILE, short_cycle

PLANT = read_plant(PLANT_FILE)
LOOP = TorqueLoop(1.6e-4, 1.25e-4)


def _cycle(plant: Plant, rate: float = 8e3) -> tuple[ControlledRun, CycleLosses]:
    """One short cycle; the controller's tick, and with it the trapezoids of the losses, as fine as asked for."""
    scenario = short_cycle(controller__velocity_rate=f"{rate} Hz", controller__position_rate=f"{rate / 4} Hz")
    time = np.arange(scenario.ticks, dtype=np.float64) * scenario.cascade.sample_time
    motion, nothing = scenario.trajectory.at(time), np.zeros(scenario.ticks)
    reference = np.column_stack([motion.position, motion.velocity, motion.acceleration, nothing, nothing])
    controller = cascade_controller(scenario.cascade)
    start = resting_state(plant, controller, LOOP, float(motion.position[0]))
    run = simulate_controlled(plant, controller, reference, None, LOOP, start)
    return run, cycle_losses(plant, run, LOOP)


BACKLASH = EFFECTS["backlash"].of(width=20e-6)
SETS: dict[str, tuple[Effect, ...]] = {
    "backlash": (BACKLASH,),
    "preload loss": (EFFECTS["preload_loss"].of(ratio=0.5, force=400.0),),
    "stiffness along the stroke": (EFFECTS["stiffness_vs_position"].of(share_over_stroke=-0.4, low=0.0, high=0.14),),
    "lead error": (EFFECTS["lead_error_periodic"].of(amplitude=5e-6, order=4.0, phase=0.0),),
    "bristle": (EFFECTS["presliding"].of(stiffness=2e7, damping=1e3, break_away=0.5),),
    "all": (
        BACKLASH, EFFECTS["lead_error_periodic"].of(amplitude=5e-6, order=4.0, phase=0.0),
        EFFECTS["presliding"].of(stiffness=2e7, damping=1e3, break_away=0.5),
        EFFECTS["ball_pass_ripple"].of(amplitude=0.05, order=7.3), EFFECTS["constant_force"].of(force=200.0),
    ),
}  # fmt: skip


@pytest.mark.parametrize("name", SETS)
def test_balance_closes(name: str) -> None:
    _, losses = _cycle(PLANT.with_effects(*SETS[name]))
    # Measured 4e-7 to 2.6e-6: trapezoids over ticks. A spring without the play or the travel error: 2e-4 to 9e-4.
    assert abs(losses.imbalance) < 1e-5


def test_play_neither_stores_nor_damps() -> None:
    # At both ends of the cycle the table stands in the middle of a play that is wider than all that stretches.
    plant = PLANT.with_effects(EFFECTS["backlash"].of(width=200e-6))
    run, losses = _cycle(plant)
    phi, x = (run.states[:, run.state_names.index(name)] for name in ("screw_angle", "table_position"))
    inside = np.abs(plant.chain.radius * phi - x) < 100e-6
    assert inside[0]
    assert 0.01 < np.mean(inside) < 0.99
    # A spring across the play would hold k s^2 / 2 = 1.7 J at its flank; the balance would miss it.
    assert abs(losses.imbalance) < 1e-5


def test_what_the_bristle_holds_is_not_lost() -> None:
    """A run that ends amid the stroke, its bristle bent: s0 z^2 / 2 is stored, the rest of its work is lost."""
    plant = PLANT.with_effects(EFFECTS["presliding"].of(stiffness=2e4))  # so soft that it holds 55 N over 2.75 mm
    run, _ = _cycle(plant)
    half = 1600  # 0.2 s: the table has gone some 15 mm
    rows = ("time", "command", "torque", "motor_angle", "motor_speed", "table_position", "table_velocity", "states")
    cut = replace(run, **{name: getattr(run, name)[:half] for name in rows})
    losses = cycle_losses(plant, cut, LOOP)
    held = 0.5 * 2e4 * run.states[half - 1, -1] ** 2
    assert held > 0.05
    assert losses.stored > held
    assert abs(losses.imbalance) < 1e-4  # trapezoids of a motion that does not end at rest
