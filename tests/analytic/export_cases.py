"""Machines that the exports are tested with: every structure, bristle, free play, time, and all effects."""

from __future__ import annotations

from feeddrive.effects.base import Effect
from feeddrive.effects.catalogue import EFFECTS
from feeddrive.files import plants_folder
from feeddrive.plant.file.plant_file import read_plant
from feeddrive.plant.plant import Plant

BENCH = read_plant(plants_folder() / "bench_axis.toml")
TESTBED = read_plant(plants_folder() / "kimm_testbed.toml")
EMPS = read_plant(plants_folder() / "emps.toml")

PRESLIDING = EFFECTS["presliding"].of(stiffness=5.5e6, damping=4000.0, break_away=0.8)
BACKLASH = EFFECTS["backlash"].of(width=7.5e-6)
LEAD_ERROR = EFFECTS["lead_error_periodic"].of(amplitude=2e-6, order=1.0, phase=0.3)
WITH_TIME: tuple[Effect, ...] = (
    EFFECTS["viscous_warmup"].of(share=0.5, time_constant=1.0),
    EFFECTS["thermal_growth"].of(strain=1e-4, time_constant=0.1),
)
MANY = (
    PRESLIDING,
    LEAD_ERROR,
    *WITH_TIME,
    EFFECTS["torque_ripple"].of(amplitude=0.1, order=6.0, phase=0.7),
    EFFECTS["stribeck"].of(delta_force=-22.0, velocity=0.05),
    EFFECTS["load_dependent_friction"].of(coefficient=0.05),
    EFFECTS["constant_force"].of(force=200.0),
    EFFECTS["friction_vs_position"].of(position=(0.0, 0.13, 0.2), delta_force=(0.0, 5.0, 1.0)),
    EFFECTS["payload"].of(mass=20.0),
    EFFECTS["drive_delay"].of(delay=3e-4),
)

PLANTS: dict[str, Plant] = {
    "rigid": EMPS,
    "rigid with lead error": EMPS.with_effects(LEAD_ERROR, *WITH_TIME),
    "three inertias": BENCH,
    "along the screw": TESTBED,
    "free play": BENCH.with_effects(BACKLASH),
    "many effects": BENCH.with_effects(*MANY),
}
