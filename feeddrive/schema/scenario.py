"""Keys of a scenario file; `feeddrive.simulate.scenario.scenario_file` and its neighbours read them."""

from __future__ import annotations

from dataclasses import replace

from feeddrive.schema.controller import CONTROLLER
from feeddrive.schema.key import SOURCE, keys
from feeddrive.schema.section import Section, keyed, sections

_RECORDED = (
    "setpoint, motor_torque, motor_angle, motor_speed, table_position, table_velocity, cutting_force, injected_torque, "
    "injected_speed"
)
_NOISE = "\n".join(f"{name} | | >= 0 | | standard deviation of its noise" for name in _RECORDED.split(", "))
_FIGURES = "following, settling, positioning, circular, friction_map, force_loop, torque_loop, step, response"
_LIMITS = """
acceleration | m/s^2 | > 0 | required | greatest acceleration
jerk | m/s^3 | > 0 | required | greatest jerk
"""
_WAVEFORM = """
waveform | text | sweep, multisine, prbs | required | its shape over time
low | Hz | > 0 | | least frequency | of a sweep or a multisine
high | Hz | > 0 | | greatest frequency | of a sweep or a multisine
duration | s | > 0 | | of the sweep | of a sweep
period | s | > 0 | | of the multisine | of a multisine
periods | whole | [0, 1e9] | = 1 | how often it is repeated | of a multisine or a binary sequence
lines | whole | [0, 1e9] | = 0 | about so many frequencies in equal ratios; 0 for all | of a multisine
bit | s | > 0 | | shortest time between changes | of a binary sequence
order | whole | [0, 1e9] | | of the shift register: 2^order - 1 bits | of a binary sequence
"""

_SCENARIO = sections(f"""
[scenario] an experiment
format | text | | required | its first line, "feeddrive-scenario/1"
name | text | | | of the experiment
description | text | | | in a sentence
plant | text | | required | shipped name, or path from the folder of the scenario
controller | text | | required | path of a controller file, or a table [controller]
travel | m list | | | least and greatest set-point; the plant's stroke if left out
{SOURCE}

[scenario.run] how long
duration | s | > 0 | | that of the trajectory if left out

[scenario.record] what is written down
rate | Hz | > 0 | | of the rows; velocity_rate is an integer multiple of it; position_rate if left out
channels | words | {_RECORDED} | | what is written down
quantised | switch | | = false | round to the resolution of the plant's sensors
seed | whole | [0, 1e9] | = 0 | of the noise
{SOURCE}

[scenario.record.noise] standard deviation of white noise on a recorded channel, in its unit
{_NOISE}
{SOURCE}

[scenario.trajectory] the set-point
kind | text | hold, moves, staircase, position_step, velocity_steps, circle, sine, wave | required | of motion
{SOURCE}

(scenario.trajectory.hold) rest at one position
position | m | | required | of the table
duration | s | > 0 | required | how long

(scenario.trajectory.moves) from target to target
start | m | | required | first position
targets | m list | | required | positions in their order
velocity | m/s list | | required | greatest velocity, one or one per target
{_LIMITS}
dwell | s | >= 0 | = 0 s | rest at each target
repeat | whole | [0, 10000] | = 1 | how often all targets are gone through

(scenario.trajectory.staircase) forward and backward through targets, as ISO 230-2 asks
targets | m list | | required | positions, ascending
runs | whole | [0, 10000] | required | runs in each direction
overrun | m | > 0 | required | beyond the ends before turning
velocity | m/s | > 0 | required | greatest velocity
{_LIMITS}
dwell | s | > 0 | required | rest at each target

(scenario.trajectory.position_step) a step of the position
start | m | | required | before the step
height | m | | required | of the step
at | s | > 0 | required | when it steps
duration | s | > 0 | required | of the whole run, longer than `at`

(scenario.trajectory.velocity_steps) constant velocities one after the other
start | m | | required | first position
velocities | m/s list | | required | with their sign
durations | s list | | required | one per velocity

(scenario.trajectory.circle) one axis of a circle
centre | m | | required | of the circle
radius | m | > 0 | required | of the circle
turns | 1 | > 0 | required | how many
velocity | m/s | > 0 | required | the feed along the circle
{_LIMITS}
dwell | s | >= 0 | = 0 s | rest before and after

(scenario.trajectory.sine) a sine that fades in and out
centre | m | | required | of the sine
amplitude | m | > 0 | required | of the sine
frequency | Hz | > 0 | required | of the sine
duration | s | > 0 | required | of the whole
fade | s | > 0 | required | in and out

(scenario.trajectory.wave) a velocity as a waveform
start | m | | required | first position
offset_velocity | m/s | | = 0 m/s | added to the waveform
amplitude | m/s | > 0 | required | of the velocity
{_WAVEFORM}

[scenario.excitation] a waveform added inside the controller
at | text | speed, torque | required | where it is added
amplitude | | > 0 | required | in rad/s at the speed, in N m at the torque
start | s | >= 0 | = 0 s | when it begins
{_WAVEFORM}
{SOURCE}

[[scenario.force]] one force on the table; several add
kind | text | step, triangle, sine, file, milling | required | of force
{SOURCE}

(scenario.force.step) a constant force for a time
force | N | | required | with its sign
start | s | | = 0 s | when it begins
end | s | | | when it ends; never if left out

(scenario.force.triangle) up, down, and back
amplitude | N | > 0 | required | greatest force
period | s | > 0 | required | of one cycle
cycles | whole | [0, 1e9] | = 1 | how many
start | s | | = 0 s | when it begins

(scenario.force.sine) a sine
amplitude | N | > 0 | required | of the sine
frequency | Hz | > 0 | required | of the sine
mean | N | | = 0 N | added
start | s | | = 0 s | when it begins

(scenario.force.file) as recorded
path | text | | required | of a CSV with the columns time [s] and cutting_force [N], from the folder of the scenario

(scenario.force.milling) of a milling cutter
teeth | whole | [0, 1000] | required | of the cutter
spindle_speed | rad/s | > 0 | required | of the cutter
depth | m | > 0 | required | of cut, axial
feed_per_tooth | m | > 0 | required | of each tooth
tangential | Pa | > 0 | required | cutting coefficient along the speed
radial | Pa | | = 0 Pa | cutting coefficient across it
entry | rad | | = 0 deg | angle at which a tooth enters
exit | rad | | = 180 deg | angle at which it leaves
start | s | | = 0 s | when it begins
end | s | | | when it ends; never if left out

[[scenario.evaluate]] one set of figures worked out from the run
kind | text | {_FIGURES} | required | of figures

(scenario.evaluate.following) following error
start | s | >= 0 | | of the stretch
end | s | >= 0 | | of the stretch

(scenario.evaluate.settling) settling at every stop
window | m | >= 0 | required | half-width that counts as settled

(scenario.evaluate.positioning) accuracy and repeatability, ISO 230-2
average | s | >= 0 | required | mean over the last of each dwell

(scenario.evaluate.circular) circular deviation of one axis, ISO 230-4

(scenario.evaluate.friction_map) mean torque at each constant velocity
skip | s | >= 0 | | left out at the beginning of each

(scenario.evaluate.force_loop) stiffness and lost motion of a loading cycle
start | s | >= 0 | required | of the first cycle
period | s | >= 0 | required | of one cycle

(scenario.evaluate.torque_loop) the same under torque at the motor
start | s | >= 0 | required | of the first cycle
period | s | >= 0 | required | of one cycle

(scenario.evaluate.step) rise, overshoot, settling of a step
channel | text | {_RECORDED}, speed_command | required | that is looked at
at | s | >= 0 | required | when it steps

(scenario.evaluate.response) frequency response by averaged spectra
input | text | {_RECORDED}, speed_command | required | of the response
output | text | {_RECORDED}, speed_command | required | of the response
segment | s | >= 0 | required | length of one spectrum
start | s | >= 0 | | left out before
""")
_ORDER = ("controller", "run", "record", "trajectory", "excitation", "force", "effect", "evaluate")


def scenario(effect: Section) -> Section:
    """The sections of a scenario file.

    Args:
        effect: [[effect]], as a plant file has it.
    """
    file = keyed(*keys("file | text | | | controller file that the rest of the table changes"))
    held = replace(CONTROLLER, path="scenario.controller", keys={**CONTROLLER.keys, **file})
    inner = {**_SCENARIO.sections, "controller": held, "effect": replace(effect, path="scenario.effect")}
    return replace(_SCENARIO, sections={name: inner[name] for name in _ORDER})
