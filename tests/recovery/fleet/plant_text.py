"""The plant file of a drawn machine: what is declared of it, every value with the tolerance of its kind."""

from __future__ import annotations

import math
from collections.abc import Mapping

from tests.generator.drawn_effects import TOLERANCES
from tests.generator.machines import Machine


def plant_text(machine: Machine, name: str, tolerances: Mapping[str, float] = TOLERANCES) -> str:
    """Return the text of the plant file of a machine as it is declared, with the tolerance of every kind of value."""
    a = machine.axis

    def number(value: float, unit: str, kind: str) -> str:
        return f'{{ value = "{value:.10g} {unit}", tolerance = "{100 * tolerances[kind]:g} %" }}'

    def drag(name: str, port: str, of: str, coulomb: float, smoothing: str, per: str = "", viscous: float = 0.0) -> str:
        lines = ["[[effect]]", f'name = "{name}"', f'port = "{port}"', f"coulomb = {number(coulomb, of, 'friction')}"]
        lines += [smoothing, *([f"viscous = {number(viscous, per, 'friction')}"] if per else [])]
        return "\n".join(lines) + "\n"

    velocity = f'smoothing_velocity = "{a.guide_velocity:.10g} m/s"'
    speed = f'smoothing_speed = "{a.drag_speed:.10g} rad/s"'
    gear = f"ratio = {a.ratio:g}\n" if a.ratio != 1.0 else ""
    text = f"""format = "feeddrive-plant/1"
name = "{name}"
structure = "three_inertias"
source = "data sheets of a drawn machine"

[motor]
inertia = {number(a.motor_inertia, "kg m^2", "inertia")}
torque_limit = "{a.controller.torque_limit:g} N m"

[ball_screw]
lead = "{1e3 * a.lead:g} mm"
inertia = {number(a.screw_inertia, "kg m^2", "inertia")}

[transmission]
{gear}torsional_stiffness = {number(a.torsional_stiffness, "N m/rad", "stiffness")}
torsional_damping = {number(a.torsional_damping, "N m s/rad", "damping")}
axial_stiffness = {number(a.axial_stiffness, "N/m", "stiffness")}
axial_damping = {number(a.axial_damping, "N s/m", "damping")}

[table]
mass = {number(a.table_mass, "kg", "mass")}
stroke = ["{1e3 * a.travel[0]:g} mm", "{1e3 * a.travel[1]:g} mm"]
{_vertical(machine)}
{drag("guide_friction", "table", "N", a.guide_coulomb, velocity, "N s/m", a.guide_viscous)}
{drag("nut_drag", "screw", "N m", a.nut_coulomb, speed, "N m/(rad/s)^(2/3)", a.nut_power)}
{drag("bearing_drag", "screw", "N m", a.bearing_coulomb, speed)}
[[sensor]]
channel = "motor_torque"
kind = "current"
at = "motor"

[[sensor]]
channel = "motor_angle"
kind = "encoder"
at = "motor"
resolution = "{2.0 * math.pi / 2.0**a.sensors.encoder_bits:.12g} rad"
"""
    if machine.scale:
        text += f"""
[[sensor]]
channel = "table_position"
kind = "scale"
at = "table"
resolution = "{1e9 * a.sensors.scale_step:g} nm"
"""
    return text + _controller(machine)


def _vertical(machine: Machine) -> str:
    a = machine.axis
    if a.fall == 0.0:
        return ""
    held = f'counterbalance = "{a.counterbalance:g} N"\n' if a.counterbalance else ""
    return f'inclination = "90 deg"\n{held}'


def _controller(machine: Machine) -> str:
    """The loop, where its cycle is not the time between rows: what a torque was held for follows from it."""
    if machine.every == 1:
        return ""
    a, control = machine.axis, machine.axis.controller
    return f"""
[controller]
kind = "cascade"
velocity_rate = "{1.0 / a.sample_time:.10g} Hz"
position_rate = "{1.0 / a.sample_time:.10g} Hz"
position_gain = "{control.position_gain:.6g} 1/s"
velocity_gain = "{control.speed_gain:.6g} N m s/rad"
reset_time = "{control.integral_time:.6g} s"
torque_limit = "{control.torque_limit:g} N m"
[controller.feed_forward]
speed = 1.0
"""
