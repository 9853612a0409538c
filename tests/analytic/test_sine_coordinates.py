"""Coordinates of a sine over an angle: its phase is told where the axis moves, not at an angle of zero."""

from __future__ import annotations

import math
from dataclasses import replace

import numpy as np
import pytest

from feeddrive.diagnosis.likelihood.coordinates import ORDER_SIZE, read_coordinates, write_coordinates
from feeddrive.effects.base import Effect, Port, number
from feeddrive.effects.source.ball_pass_ripple import BallPassRipple
from feeddrive.effects.source.torque_ripple import TorqueRipple
from feeddrive.effects.travel.lead_error_periodic import LeadErrorPeriodic
from feeddrive.files import plants_folder
from feeddrive.plant.file.plant_file import read_plant
from feeddrive.plant.plant import Plant
from feeddrive.typing import FloatArray

SINES: tuple[Effect, ...] = (
    TorqueRipple.of(amplitude=0.12, order=6.0, phase=1.3),
    BallPassRipple.of(amplitude=0.12, order=7.69, phase=-2.0),
    LeadErrorPeriodic.of(amplitude=3e-6, order=1.0, phase=0.4),
)


def axis() -> Plant:
    """The bench axis with a stroke whose middle is twenty turns of the screw from zero."""
    return replace(read_plant(plants_folder() / "bench_axis.toml"), stroke=(0.2, 0.6))


def angles(plant: Plant, effect: Effect) -> FloatArray:
    """Angles of the effect's shaft over five turns to each side of mid-stroke, (n,)."""
    travel = plant.chain.motor_radius if effect.port is Port.MOTOR else plant.chain.radius
    return plant.middle / travel + 2 * math.pi * np.linspace(-5, 5, 2001)


def sine(effect: Effect, angle: FloatArray) -> FloatArray:
    """Values of an effect over an angle, (n,)."""
    amplitude, order, phase = (number(effect.values[key]) for key in ("amplitude", "order", "phase"))
    return amplitude * np.sin(order * angle + phase)


@pytest.mark.parametrize("effect", SINES, ids=lambda one: one.name)
def test_values_come_back(effect: Effect) -> None:
    plant = axis()
    (back,) = write_coordinates([effect], plant, read_coordinates([effect], plant))
    # rounding of a phase of some hundred rad
    assert {k: number(v) for k, v in back.values.items()} == pytest.approx(
        {k: number(v) for k, v in effect.values.items()}, rel=1e-12
    )


@pytest.mark.parametrize("effect", SINES, ids=lambda one: one.name)
def test_another_order_leaves_the_sine_as_it_is_in_the_middle_of_the_stroke(effect: Effect) -> None:
    plant = axis()
    angle = angles(plant, effect)
    vector = read_coordinates([effect], plant)
    (other,) = write_coordinates([effect], plant, vector + np.array([0.0, 0.0, 1.0]))
    assert number(other.values["order"]) == pytest.approx(number(effect.values["order"]) + ORDER_SIZE)
    at = len(angle) // 2
    # rounding of an angle of some hundred rad
    assert sine(other, angle)[at] == pytest.approx(
        sine(effect, angle)[at], abs=1e-11 * number(effect.values["amplitude"])
    )


@pytest.mark.parametrize("effect", SINES, ids=lambda one: one.name)
def test_a_plain_step_leads_to_an_order_that_is_off_by_a_fifth_of_a_turn_over_the_stroke(effect: Effect) -> None:
    """Undamped, with the phase right in the middle. Of components at zero the step led to three times the error."""
    plant, off = axis(), 0.02
    angle = angles(plant, effect)
    order, phase, amplitude = (number(effect.values[key]) for key in ("order", "phase", "amplitude"))
    start = effect.with_values(order=order + off, phase=phase - off * float(np.mean(angle)))
    vector, here = read_coordinates([start], plant), sine(start, angle)
    moved = [write_coordinates([start], plant, vector + 1e-6 * unit)[0] for unit in np.eye(3)]
    slopes = np.column_stack([(sine(one, angle) - here) / 1e-6 for one in moved])
    step = np.linalg.lstsq(slopes, sine(effect, angle) - here, rcond=None)[0]
    (after,) = write_coordinates([start], plant, vector + step)
    # the angle by which the ends are off is met to its square: half of 0.63^2, and half of that is another order
    assert np.max(np.abs(sine(after, angle) - sine(effect, angle))) < 0.1 * amplitude
