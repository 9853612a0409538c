"""Two short motions that show what a loop does: a step of the position, and a small circle with its reversals.

A circle of 5 mm at 3 m/min turns in 0.63 s: slow enough for friction to show at the reversals, short enough to be run
at every place of the stroke. The step is small enough for the limits of the usual drive.
"""

from __future__ import annotations

import math
from dataclasses import dataclass

from feeddrive.plant.plant import Plant
from feeddrive.servo.cascade import Cascade
from feeddrive.servo.mechanics_response import Case
from feeddrive.simulate.scenario.scenario import Evaluation, Recorder, Scenario, ScenarioResult
from feeddrive.simulate.scenario.scenario_run import run_scenario
from feeddrive.simulate.setpoints.cutting_force import NoForce
from feeddrive.simulate.setpoints.setpoint_motion import Limits, Trajectory
from feeddrive.simulate.setpoints.trajectories import Circle, position_step

RADIUS, FEED, TURNS = 0.005, 0.05, 1.15
"""Circle [m, m/s, 1]: a whole turn at constant feed is looked at, the rest runs up and out."""
HEIGHT, STEP_AT, STEP_LASTS = 20e-6, 0.005, 0.06
"""Step: height, begin and length [m, s, s]."""
_LIMITS, _DWELL = Limits(FEED, 1.0, 40.0), 0.01
_CHANNELS = ("setpoint", "motor_torque", "motor_angle", "table_position")


@dataclass(frozen=True)
class Trial:
    """A motion about a table position, and the same as the tables of a scenario file."""

    trajectory: Trajectory
    tables: str
    evaluation: Evaluation


def circle_about(plant: Plant, position: float) -> Trial:
    """The small circle, its centre at a position [m] or as near as the stroke allows."""
    centre = position
    if plant.stroke is not None:
        low, high = plant.stroke
        room = min(RADIUS, (high - low) / 2)
        centre = min(max(position, low + room), high - room)
    tables = (
        f'[trajectory]\nkind = "circle"\ncentre = "{centre!r} m"\nradius = "{RADIUS!r} m"\nturns = {TURNS}\n'
        f'velocity = "{FEED!r} m/s"\nacceleration = "{_LIMITS.acceleration!r} m/s^2"\njerk = "{_LIMITS.jerk!r} m/s^3"\n'
        f'dwell = "{_DWELL!r} s"\n\n[[evaluate]]\nkind = "circular"\n'
    )
    return Trial(Circle(centre, RADIUS, TURNS, _LIMITS, _DWELL), tables, Evaluation("circular", {}))


def step_at(plant: Plant, position: float) -> Trial:
    """A step towards the middle of the stroke from a position [m]."""
    height = -HEIGHT if plant.stroke is not None and position > plant.stroke[1] - HEIGHT else HEIGHT
    tables = (
        f'[trajectory]\nkind = "position_step"\nstart = "{position!r} m"\nheight = "{height!r} m"\n'
        f'at = "{STEP_AT!r} s"\n'
        f'duration = "{STEP_LASTS!r} s"\n\n[[evaluate]]\nkind = "step"\n'
        f'channel = "table_position"\nat = "{STEP_AT!r} s"\n'
    )
    evaluation = Evaluation("step", {"channel": "table_position", "at": STEP_AT})
    return Trial(position_step(position, height, STEP_AT, STEP_LASTS), tables, evaluation)


def trial_scenario(plant: Plant, cascade: Cascade, trial: Trial) -> Scenario:
    """The motion under a cascade, recorded at every tick."""
    ticks = math.ceil(trial.trajectory.duration / cascade.sample_time - 1e-6)
    recorder = Recorder(1, _CHANNELS, {}, False, 0)
    return Scenario(
        "trial", "", plant, cascade, trial.trajectory, NoForce(), None, recorder, ticks, (trial.evaluation,), ""
    )


def run_trial(plant: Plant, cascade: Cascade, case: Case, trial: Trial) -> ScenarioResult:
    """The run of a trial, the table with the payload of the case.

    Raises:
        SimulationError: a motion that cannot be followed.
    """
    return run_scenario(trial_scenario(case.on(plant), cascade, trial))
