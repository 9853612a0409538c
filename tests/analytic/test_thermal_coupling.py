"""What temperatures do to the drive, in closed form; the losses of a cycle against the friction laws written out."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

from feeddrive.effects.base import Effect
from feeddrive.errors import InputError
from feeddrive.files import find_plant
from feeddrive.parts.bearings.bearing_friction import palmgren_torque
from feeddrive.parts.lubricant import Lubricant
from feeddrive.plant.file.plant_file import read_plant
from feeddrive.plant.plant import Plant
from feeddrive.plant.warmed import warmed
from feeddrive.servo.cascade_function import cascade_controller
from feeddrive.simulate.controlled.controlled import ControlledRun, TorqueLoop, resting_state, simulate_controlled
from feeddrive.simulate.scenario.cycle_losses import CycleLosses, cycle_losses
from feeddrive.thermal.thermal_coupling import Changes, Coupling, Spacer, Temperatures, viscous_share
from tests.analytic.warm_cases import COUPLING, PLANT_FILE, THERMAL, short_cycle

PITCH, PRELOAD, STEEL = 0.0335, 2200.0, 11.7e-6


def _changes(coupling: Coupling, nut: float, shaft: float, front: float = 20.0, rear: float = 20.0) -> Changes:
    return coupling.changes(Temperatures(nut, shaft, front, rear), 20.0, PRELOAD, PITCH, STEEL)


def test_equal_temperatures_change_nothing_but_oil() -> None:
    assert _changes(COUPLING, 20.0, 20.0) == Changes()
    warm = _changes(COUPLING, 35.0, 35.0, 40.0, 30.0)
    assert (warm.preload, warm.nut_stiffness) == (1.0, 1.0)
    assert warm.nut_viscous == pytest.approx(viscous_share(COUPLING.nut_oil, 35.0, 20.0))
    # A quarter of the bearings' friction is at the rear one.
    assert warm.bearing_viscous == pytest.approx(viscous_share(COUPLING.bearing_oil, 37.5, 20.0))


def test_viscous_share_is_that_of_palmgrens_torque() -> None:
    oil = Lubricant(100e-6, 11.2e-6)
    torques = [float(palmgren_torque(10.0, oil.viscosity(at), 200.0, PITCH)) for at in (20.0, 45.0)]
    assert viscous_share(oil, 45.0, 20.0) == pytest.approx(torques[1] / torques[0], rel=1e-12)


def test_declared_friction_and_oil_of_the_warm_axis_are_one() -> None:
    """Viscosity and lubricant torque declared for 20 degC are those of the oils, to the digits written."""
    plant = read_plant(PLANT_FILE)
    nut, bearing = (oil.viscosity(THERMAL.ambient) for oil in (COUPLING.nut_oil, COUPLING.bearing_oil))
    assert THERMAL.nut.viscosity == pytest.approx(nut, rel=2e-3)
    assert THERMAL.front is not None and THERMAL.rear is not None
    for seat in (THERMAL.front, THERMAL.rear):
        assert seat.viscosity == pytest.approx(bearing, rel=2e-3)
    speed = 200.0
    for name, factor, viscosity, diameter in (
        ("nut_friction", 10.0, nut, PITCH),
        ("bearing_drag", 6.0, bearing, 0.037),
    ):
        torque = float(palmgren_torque(factor, viscosity, speed, diameter))
        assert _value(plant, name, "viscous") == pytest.approx(torque / speed ** (2 / 3), rel=2e-3)


def test_preload_follows_the_spacer_and_stiffness_its_third_root() -> None:
    for spacer in Spacer:
        found = _changes(replace(COUPLING, spacer=spacer), 22.0, 20.0)
        axial = spacer.value * COUPLING.nut_stiffness / 4 * COUPLING.group_distance
        radial = COUPLING.nut_stiffness / 2 * PITCH / 2
        assert found.preload == pytest.approx(1 + STEEL * 2.0 * (axial - radial) / PRELOAD, rel=1e-12)
        assert found.nut_stiffness == pytest.approx(found.preload ** (1 / 3), rel=1e-12)
    pulled = replace(COUPLING, spacer=Spacer.UNDERSIZE)
    assert _changes(COUPLING, 22.0, 20.0).preload > 1 > _changes(pulled, 22.0, 20.0).preload


def test_nut_that_runs_loose_is_refused() -> None:
    with pytest.raises(InputError, match="of its preload"), pytest.warns(match="is loose"):
        _changes(replace(COUPLING, spacer=Spacer.UNDERSIZE), 60.0, 20.0)


def _value(plant: Plant, name: str, key: str) -> float:
    found: Effect = next(effect for effect in plant.effects if effect.name == name)
    value = found.values[key]
    assert isinstance(value, float)
    return value


def test_warmed_plant_has_other_values_only() -> None:
    cold = read_plant(PLANT_FILE)
    hot = warmed(cold, Changes(0.5, 0.7, 1.2, 1.2 ** (1 / 3)), 2e-5, 560e6)
    assert _value(hot, "nut_friction", "viscous") == 0.5 * _value(cold, "nut_friction", "viscous")
    assert _value(hot, "nut_friction", "preload") == pytest.approx(1.2 * PRELOAD)
    assert _value(hot, "bearing_drag", "viscous") == 0.7 * _value(cold, "bearing_drag", "viscous")
    assert _value(hot, "bearing_drag", "coulomb") == _value(cold, "bearing_drag", "coulomb")
    assert _value(hot, "lead_error_cumulative", "slope") == 2e-5
    softness = [1 / plant.chain.values["axial_stiffness"] for plant in (cold, hot)]
    nut = 1 / 560e6
    assert softness[0] - nut == pytest.approx(softness[1] - nut / 1.2 ** (1 / 3), rel=1e-12)
    distributed = read_plant(find_plant("hsr_axis"))
    stiffer = warmed(distributed, Changes(nut_stiffness=1.1), 0.0, 1.0)
    assert stiffer.chain.values["nut_stiffness"] == pytest.approx(1.1 * distributed.chain.values["nut_stiffness"])


def _cycle(plant: Plant, loop: TorqueLoop) -> tuple[ControlledRun, CycleLosses]:
    scenario = short_cycle()
    time = np.arange(scenario.ticks, dtype=np.float64) * scenario.cascade.sample_time
    motion, nothing = scenario.trajectory.at(time), np.zeros(scenario.ticks)
    reference = np.column_stack([motion.position, motion.velocity, motion.acceleration, nothing, nothing])
    controller = cascade_controller(scenario.cascade)
    start = resting_state(plant, controller, loop, float(motion.position[0]))
    run = simulate_controlled(plant, controller, reference, None, loop, start)
    return run, cycle_losses(plant, run, loop)


@pytest.mark.parametrize("loop", [TorqueLoop(), TorqueLoop(1.6e-4, 1.25e-4), TorqueLoop(1e-4, 6e-4)])
def test_losses_are_those_of_the_laws_written_out(loop: TorqueLoop) -> None:
    plant = warmed(read_plant(PLANT_FILE), Changes(), 0.0, 560e6)
    run, losses = _cycle(plant, loop)
    v, w, step = run.table_velocity, run.states[:, run.state_names.index("screw_speed")], run.time[1]
    guide = (55.0 * np.tanh(v / 0.5e-3) + 180.0 * v) * v
    bearings = 0.12 * np.tanh(w / 0.15) * w + 2.7e-3 * np.abs(w) ** (5 / 3)
    # Rectangles in place of trapezoids, the same between two rests; the law is smoothed below 0.01 rad/s.
    assert losses.guide == pytest.approx(float(np.sum(guide)) * step, rel=1e-4)
    assert losses.bearings == pytest.approx(float(np.sum(bearings)) * step, rel=1e-3)
    # Measured 1e-6 to 1.2e-5: sums over the ticks.
    assert abs(losses.imbalance) < 5e-5


def test_nut_loses_what_its_preload_torque_takes() -> None:
    """With the lubricant torque out and no force to speak of beside the preload: 4 f r F over the way.

    For lead angles that go to 0 and balls at 45 deg either nut loses 2 f of its load; at 5.4 deg 0.3 % more.
    """
    cold = read_plant(PLANT_FILE)
    run, losses = _cycle(warmed(cold, Changes(nut_viscous=0.0), 0.0, 560e6), TorqueLoop())
    turned = float(np.sum(np.abs(np.diff(run.motor_angle))))
    friction = _value(cold, "nut_friction", "friction_coefficient")
    torque = 4 * friction * cold.chain.radius * PRELOAD
    # 2 %: the lead angle, the smoothing about rest, and the force that accelerates the table.
    assert losses.nut / turned == pytest.approx(torque, rel=0.02)
    assert THERMAL.nut.load_torque == pytest.approx(torque, rel=0.02)


def test_file_without_coupling_and_bad_values_are_refused(tmp_path: Path) -> None:
    with pytest.raises(InputError, match=r"no \[thermal.coupling\]"):
        _ = read_plant(find_plant("thermal_bench")).coupling
    text = PLANT_FILE.read_text(encoding="utf-8")
    for old, new, told in (
        ('group_distance = "70 mm"', 'group_distance = "-70 mm"', "not possible"),
        ('spacer = "oversize"', 'spacer = "large"', "is not possible"),
        ("rear_share = 0.25", "rear_share = 2", "no share"),
        ('viscosity_100 = "11.2 mm^2/s"', 'viscosity_100 = "112 mm^2/s"', "not thinner"),
        ('nut_at_zero = "250 mm"', 'nut_zero = "250 mm"', "unknown key"),
    ):
        bad = tmp_path / "bad.toml"
        assert old in text
        bad.write_text(text.replace(old, new), encoding="utf-8")
        with pytest.raises(InputError, match=told):
            read_plant(bad)
