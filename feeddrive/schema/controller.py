"""Keys of a controller: a file of its own, [controller] of a scenario, and a cascade that a plant file declares."""

from __future__ import annotations

from dataclasses import replace

from feeddrive.schema.key import SOURCE
from feeddrive.schema.section import sections

CONTROLLER = sections(f"""
[controller] a cascade of position and velocity loop
format | text | | | its first line, "feeddrive-controller/1" | in a file of its own
name | text | | | of the controller
{SOURCE}
velocity_rate | Hz | > 0 | required | of the velocity loop, an integer multiple of position_rate
position_rate | Hz | > 0 | required | of the position loop
position_gain | 1/s | > 0 | | K_v; also in (m/min)/mm; needed where the position loop is closed
velocity_gain | N m s/rad | > 0 | | K_p; needed where the velocity loop is closed
reset_time | s | > 0 | | T_n of the velocity loop; no integrator if left out
tracking_time | s | > 0 | | of the anti-windup; the reset time if left out
position_feedback | text | motor, table | = motor | which position is controlled
current_bandwidth | Hz | > 0 | | -3 dB of the closed current loop; no lag if left out
dead_time | s | >= 0 | = 0 s | between command and torque
torque_limit | N m | > 0 | | at most that of the motor; that of the motor if left out
current_limit | A | > 0 | | with torque_constant another torque limit
torque_constant | N m/A | > 0 | | of the motor, with current_limit
speed_limit | rad/s | > 0 | | of the speed command; none if left out
balancing_time | s | >= 0 | = 0 s | time constant by which the position loop's set-point waits
torque_offset | N m | | = 0 N m | added to the torque command
mode | text | position, velocity, torque | = position | which loops are closed
allow_unstable | switch | | = false | whether an unstable loop may run

[controller.feed_forward] what is added ahead of the loops
speed | 1 | >= 0 | = 0 | share of the set-point's speed
torque | 1 | >= 0 | = 0 | share of the torque that accelerates the inertia
inertia | kg m^2 | >= 0 | | at the motor; that of the plant if left out
coulomb | N m | >= 0 | = 0 N m | friction torque
smoothing_speed | rad/s | >= 0 | = 1 rad/s | motor speed at which the friction turns
viscous | N m s/rad | >= 0 | = 0 N m s/rad | torque per speed

[[controller.filter]] one filter of the torque or the speed
kind | text | PT1, PT2, notch, biquad | required | of the filter
at | text | torque, speed | = torque | where the filter acts

(controller.filter.PT1) lag of first order
frequency | Hz | > 0 | required | corner frequency

(controller.filter.PT2) low-pass of second order
frequency | Hz | > 0 | required | corner frequency
damping | 1 | > 0 | required | damping ratio

(controller.filter.notch) notch
frequency | Hz | > 0 | required | its middle
bandwidth | Hz | > 0 | required | width at -3 dB
depth | dB | > 0 | required | attenuation at its middle

(controller.filter.biquad) zeros and poles of second order
zero_frequency | Hz | > 0 | required | of the zeros
zero_damping | 1 | > 0 | required | damping ratio of the zeros
pole_frequency | Hz | > 0 | required | of the poles
pole_damping | 1 | > 0 | required | damping ratio of the poles
""")
"""A controller file, or the table of it; names of drives' makers stand for these (`feeddrive.servo.vendor_names`)."""

_SERVO = sections(f"""
[plant.controller] the controller of the machine
kind | text | position_velocity, cascade | required | of the controller
{SOURCE}

(plant.controller.position_velocity) a servo that commands a voltage: position over velocity, both proportional
position_gain | 1/s | > 0 | required | speed command per following error
velocity_gain | V s/m | > 0 | required | output per error of velocity
output_limit | V | > 0 | required | of the output
torque_per_output | N m/V | > 0 | required | motor torque per output
velocity_samples | whole | [0, 64] | = 0 | velocity from the position over so many samples; 0 for velocity itself
""")
DECLARED_CONTROLLER = replace(
    _SERVO, kinds={**_SERVO.kinds, "cascade": replace(CONTROLLER, path="plant.controller.cascade")}
)
"""[controller] of a plant file."""
