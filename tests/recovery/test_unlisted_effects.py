"""Forces and travel errors that stand in no list: variable, shape, period, and the error with what is carried.

The recordings are those of `tests/generator`, which shares no code with the package. No search is run before, so that
no named effect can take any of it: what a search leaves is looked at in the cases marked slow.
"""

from __future__ import annotations

import json

import numpy as np
import pytest

from feeddrive.diagnosis.diagnose import diagnose
from feeddrive.diagnosis.likelihood.outputs import diagnosis_record
from tests.generator.axis import AXES
from tests.generator.effects import LeadErrorPeriodic
from tests.generator.effects.unlisted import CableDrag, Cogging, ForceSpot, LaterFriction, SquareDrag
from tests.generator.pair import recording_pair
from tests.recovery.planted import axis_plant
from tests.recovery.unlisted import curve, recording, said_of

BENCH_RADIUS = AXES["bench"].transmission

# Carried, the error is the noise floor: 5 % is what the floor is known to, and 10 % what a table leaves of a form.
AT_THE_FLOOR = 1.15


@pytest.mark.parametrize(
    ("axis", "seed", "noise_factor"),
    [
        ("bench", 11, 1.0),
        pytest.param("light", 23, 1.0, marks=pytest.mark.slow),
        *(
            pytest.param(axis, seed, factor, marks=pytest.mark.slow)
            for axis in ("bench", "light")
            for seed, factor in ((31, 0.3), (37, 3.0), (41, 1.0), (43, 1.0), (47, 1.0))
        ),
    ],
)
def test_nothing_is_claimed_where_nothing_is_planted(axis: str, seed: int, noise_factor: float) -> None:
    said = said_of(axis, (), (seed, seed + 1), noise_factor=noise_factor)
    for channel, left in said.rest.unexplained.items():
        assert left.depends_on == () and left.carried == (), channel
        assert left.above is not None
        # at a third of the noise the steps of scale (10 nm) and encoder are larger than it, which is not white
        if noise_factor >= 1.0:
            assert not left.above.is_left and "Nothing is left above the noise" in left.statement, channel
    assert said.rest.effects == ()


def test_a_force_periodic_over_the_position_is_found_with_its_pitch_and_carried() -> None:
    said = said_of("bench", (Cogging(6.0, 0.03, 0.4),), (1, 2))
    for channel in ("motor_torque", "table_position"):
        one = said.first(channel)
        assert (one.variable, one.times, one.form) == ("table_position", "", "periodic")
        assert one.table is not None
        assert one.table.period == pytest.approx(0.03, rel=0.005)  # as is asked of an order
    torque = said.first("motor_torque")
    assert torque.amplitude == pytest.approx(6.0 * BENCH_RADIUS, rel=0.10)  # as is asked of a size
    (carried,) = said.rest.unexplained["motor_torque"].carried
    assert (carried.name, carried.variable) == ("tabulated_force", "periodic_position")
    assert 0.5 * np.ptp(carried.table.values) == pytest.approx(6.0, rel=0.05)  # both channels know it
    assert all(said.over_floor(channel) < AT_THE_FLOOR for channel in said.after)


def test_friction_that_sets_in_is_found_at_its_time_and_carried() -> None:
    said = said_of("bench", (LaterFriction(12.0, 4.1),), (3, 4))
    one = said.first("motor_torque")
    assert (one.variable, one.times, one.form) == ("time", "direction", "step")
    assert one.table is not None
    assert one.table.breakpoints[-1] == pytest.approx(4.1, abs=0.05)  # a tenth of a block
    assert one.table.values[-1] == pytest.approx(12.0 * BENCH_RADIUS, rel=0.10)
    (carried,) = said.rest.unexplained["motor_torque"].carried
    assert carried.name == "tabulated_friction" and carried.table.values[-1] == pytest.approx(12.0, rel=0.05)
    assert said.after["motor_torque"].after.rms < 0.7 * said.before["motor_torque"].after.rms


@pytest.mark.slow
def test_drag_with_the_square_of_the_velocity_is_found_with_its_form() -> None:
    said = said_of("bench", (SquareDrag(250.0),), (5, 6))
    one = said.first("motor_torque")
    assert (one.variable, one.times) == ("table_velocity", "")
    at = np.linspace(-0.28, 0.28, 15)
    wanted = 250.0 * at * np.abs(at) * BENCH_RADIUS
    # a twentieth of the largest: the noise of the table's nodes
    assert curve(one, at) - np.mean(curve(one, at)) == pytest.approx(wanted, abs=0.05 * wanted.max() + 0.002)
    assert "100 % of it odd" in one.statement or "99 % of it odd" in one.statement
    assert all(said.over_floor(channel) < AT_THE_FLOOR for channel in said.after)


@pytest.mark.slow
def test_a_loop_over_the_position_is_position_times_direction() -> None:
    said = said_of("bench", (CableDrag(60.0),), (7, 8))
    one = said.first("motor_torque")
    assert (one.variable, one.times) == ("table_position", "direction")
    reach = np.linspace(0.1, 0.9, 9)
    at = AXES["bench"].stroke_low + reach * (AXES["bench"].stroke_high - AXES["bench"].stroke_low)
    wanted = 60.0 * reach * (1 - reach) * BENCH_RADIUS
    assert curve(one, at) == pytest.approx(wanted, abs=0.1 * wanted.max())  # as is asked of a size
    (carried,) = said.rest.unexplained["motor_torque"].carried
    assert (carried.name, carried.variable) == ("tabulated_friction", "position")
    assert all(said.over_floor(channel) < AT_THE_FLOOR for channel in said.after)


@pytest.mark.slow
def test_a_spot_of_force_is_found_at_its_place() -> None:
    said = said_of("bench", (ForceSpot(15.0, 0.21, 0.01),), (9, 10))
    one = said.first("motor_torque")
    assert (one.variable, one.times, one.form) == ("table_position", "", "curve")
    assert one.table is not None
    peak = one.table.breakpoints[int(np.argmax(one.table.values))]
    assert peak == pytest.approx(0.21, abs=0.011)  # half the distance of 16 breakpoints
    # narrower than two breakpoints: more is left than of a smooth form, and nearly all of it is explained
    assert all(said.over_floor(channel) < 1.3 for channel in said.after)
    explained = said.rest.unexplained["motor_torque"].carried[0].explains
    assert explained["table_position"] > 0.8


@pytest.mark.slow
def test_a_travel_error_of_no_period_of_the_screw_is_found_and_carried() -> None:
    said = said_of("bench", (LeadErrorPeriodic(4e-7, 0.61, 0.3),), (12, 13))
    one = said.first("table_position")
    assert (one.variable, one.form) == ("table_position", "periodic")
    assert one.order == pytest.approx(0.61, rel=0.005)
    assert one.amplitude == pytest.approx(4e-7, rel=0.05)
    assert said.rest.unexplained["motor_torque"].depends_on == ()
    (carried,) = said.rest.unexplained["table_position"].carried
    assert carried.name == "tabulated_travel"
    assert said.over_floor("table_position") < AT_THE_FLOOR


@pytest.mark.slow
def test_two_at_once_are_told_apart_and_fitted_together() -> None:
    said = said_of("bench", (SquareDrag(150.0), Cogging(6.0, 0.03, 0.4)), (1, 2))
    for channel in ("motor_torque", "table_position"):
        drag, cogging = said.rest.unexplained[channel].depends_on
        assert (drag.variable, cogging.variable) == ("table_velocity", "table_position")
        assert cogging.table is not None and cogging.table.period == pytest.approx(0.03, rel=0.005)
        assert said.over_floor(channel) < AT_THE_FLOOR
    assert len(said.rest.effects) == 2


@pytest.mark.slow
@pytest.mark.parametrize(
    "effect", [SquareDrag(250.0), LaterFriction(12.0, 4.1), Cogging(6.0, 0.03, 0.4)], ids=lambda effect: effect.name
)
def test_after_the_search_the_error_is_the_floor_or_the_rest_is_said(effect: SquareDrag) -> None:
    """A named effect may take some of it; then what is carried takes the rest, or the rest is said to be there."""
    pair = recording_pair(AXES["bench"], (effect,), (15, 16), (12.0, 7.6))
    fitted, judged = (recording(one, name) for one, name in zip(pair, ("train", "validate"), strict=True))
    result, effects = diagnose(axis_plant("bench"), [fitted], [judged])
    json.dumps(diagnosis_record(result))
    for channel in result.channels:
        left = result.unexplained[channel.name]
        assert left.above is not None
        at_the_floor = channel.after.rms < AT_THE_FLOOR * left.above.floor
        assert at_the_floor or left.above.is_left, left.statement
        assert channel.after.rms < 0.8 * channel.before.rms, left.statement
    assert len(effects) == len(result.effects) + sum(len(one.carried) for one in result.unexplained.values())
