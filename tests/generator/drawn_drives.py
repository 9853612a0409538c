"""Plant files of drives drawn at random from the sizes that catalogues sell together."""

from __future__ import annotations

import numpy as np


def drawn_drive(seed: int) -> str:
    """The text of a plant file: a screw of 16 to 63 mm with parts of its size, direct or by a belt."""
    draw = np.random.default_rng(seed)
    diameter = float(draw.choice([16, 20, 25, 32, 40, 50, 63]))
    size = diameter / 40
    length = float(round(diameter * draw.uniform(14, 38)))
    ratio = float(draw.choice([1.0, 1.0, 1.5, 2.5]))
    stroke = round(0.7 * length)
    first = round(0.12 * length)
    kind = str(draw.choice(["fixed-supported", "fixed-fixed"]))

    def about(value: float, spread: float = 2.0) -> str:
        return f"{value * spread ** draw.uniform(-1, 1):.6g}"

    wheels = f"""
[belt]
ratio = {ratio}
torsional_stiffness = "{about(2e4 * size**3)} N m/rad"
motor_wheel_inertia = "{about(6e-4 * size**4)} kg m^2"
screw_wheel_inertia = "{about(2.5e-3 * size**4)} kg m^2"
"""
    coupling = f"""
[coupling]
torsional_stiffness = "{about(3e4 * size**3)} N m/rad"
inertia = "{about(2.5e-3 * size**4)} kg m^2"
"""
    far = f'[bearing.far]\naxial_stiffness = "{about(800 * size, 1.5)} N/µm"\n' if kind == "fixed-fixed" else ""
    return f"""format = "feeddrive-plant/1"
name = "drawn {seed}"
structure = "distributed_screw"
[motor]
rotor_inertia = "{about(5e-3 * size**4)} kg m^2"
torque_limit = "{about(30 * size**3)} N m"
shaft_stiffness = "{about(6e4 * size**3)} N m/rad"
{wheels if ratio > 1 else coupling}
[ball_screw]
lead = "{draw.choice([0.25, 0.5, 1.0]) * diameter:g} mm"
diameter = "{diameter:g} mm"
root_diameter = "{0.88 * diameter:g} mm"
length = "{length:g} mm"
stub = "{round(2 * diameter)} mm"
elements = {draw.choice([1, 2])}
[support]
kind = "{kind}"
[bearing.near]
axial_stiffness = "{about(800 * size, 1.5)} N/µm"
{far}
[nut]
axial_stiffness = "{about(1000 * size, 1.5)} N/µm"
[table]
mass = "{about(200 * size**2, 3)} kg"
stroke = ["0 mm", "{stroke} mm"]
first_nut_position = "{first} mm"
[damping]
ratio = 0.02
[[effect]]
name = "guide_friction"
coulomb = "{about(60 * size**2)} N"
smoothing_velocity = "0.5 mm/s"
viscous = "{about(250 * size**2)} N s/m"
[[effect]]
name = "nut_drag"
coulomb = "{about(0.3 * size**3)} N m"
smoothing_speed = "0.15 rad/s"
"""
