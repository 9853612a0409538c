"""Parts of the thermal compensation against closed forms: error, sensors, filter, placement, line."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from feeddrive.compensation.heat.thermal_augmented import Augmented, Row, Transition
from feeddrive.compensation.heat.thermal_error import table_error
from feeddrive.compensation.heat.thermal_line import Convention, LineTable, line_table, straight_line
from feeddrive.compensation.heat.thermal_observer import ThermalObserver, advance, thermal_observer
from feeddrive.compensation.heat.thermal_placement import expected_deviation, placements
from feeddrive.compensation.heat.thermal_sensors import Sensor, lagged, mountable_places
from feeddrive.compensation.heat.thermal_trial import random_duty
from feeddrive.compensation.heat.thermal_unknowns import Unknowns, deviating, stationary_step
from feeddrive.errors import InputError
from feeddrive.thermal.full.full_model import full_model
from feeddrive.thermal.rig import Body
from feeddrive.thermal.run.warm_up import declared_rows
from feeddrive.typing import FloatArray
from tests.analytic.thermal_compensation_cases import BENCH, ERROR, MODEL, RPM, STEP

SPEEDS = np.array([0.0, 250, 750, 1500]) * RPM


def _observer(*places: str) -> ThermalObserver:
    return thermal_observer(BENCH, MODEL, ERROR, [Sensor(place) for place in places], step=STEP)


def test_evenly_warm_screw_grows_in_proportion() -> None:
    full = full_model(BENCH.rig)
    warm = np.full((1, full.order), 4.0)
    free = table_error(BENCH, full)
    # Rounding; the interpolation between the sections' edges is exact for a line.
    np.testing.assert_allclose(free.of(warm)[0], 11.7e-6 * 4.0 * free.positions, rtol=1e-9)


def test_lag_of_a_ramp() -> None:
    times = STEP * np.arange(1, 61)
    shown = lagged(0.01 * times, STEP, 60.0)
    np.testing.assert_allclose(shown, 0.01 * (times - 60.0 * -np.expm1(-times / 60.0)), rtol=1e-9, atol=1e-12)
    np.testing.assert_array_equal(lagged(times, STEP, 0.0), times)


def test_filter_shows_what_a_lagging_sensor_shows() -> None:
    system = Augmented(MODEL, (Sensor("nut", lag=60.0), Sensor("front", lag=0.0)), Unknowns(), STEP)
    _, row, at = _moving(system)
    n, z = MODEL.order, np.zeros(system.size)
    rises, shown = [], []
    for _ in range(40):
        z, _ = system.predicted(z, row, at)
        rises.append(z[:n] @ MODEL.readings["nut"])
        shown.append(z[n])
        # 0.3 s of lag in place of none.
        assert z[n + 1] == pytest.approx(z[:n] @ MODEL.readings["front"], abs=1e-3)
    # The trials take the temperature for straight over a row; the nut answers the first one in seconds: 1.3 mK of 4 K.
    np.testing.assert_allclose(shown, lagged(np.array(rises), STEP, 60.0), atol=3e-3)


def _moving(system: Augmented) -> tuple[FloatArray, Row, Transition]:
    """A state that moves, its row and transition, at 600 rev/min."""
    observer = ThermalObserver(BENCH, system, ERROR)
    (row,), (at,) = observer.rows(np.array([600 * RPM]), np.array([BENCH.ambient]))
    z = np.random.default_rng(4).normal(size=system.size)
    z[system.shown :] *= 0.05
    return z, row, at


def test_derivative_of_a_row_is_that_of_differences() -> None:
    system = Augmented(MODEL, (Sensor("nut"),), Unknowns(heats=(("front", 1.0),)), STEP)
    z, row, at = _moving(system)
    _, slope = system.predicted(z, row, at)
    small = 1e-5
    for i, unit in enumerate(np.eye(system.size)):
        up, down = (system.predicted(z + sign * small * unit, row, at)[0] for sign in (1, -1))
        # The map is bilinear, so that central differences are exact but for rounding.
        np.testing.assert_allclose((up - down) / (2 * small), slope[:, i], rtol=1e-6, atol=1e-6)


def test_films_and_heat_act_as_on_the_machine() -> None:
    system = Augmented(MODEL, (), Unknowns(), STEP)
    z = np.zeros(system.size)
    z[system.shown : system.shown + 3] = -0.1, 0.1, 0.1
    observer = ThermalObserver(BENCH, system, ERROR)
    speeds, air = np.full(400, 600 * RPM), np.full(400, BENCH.ambient)
    rows, transitions = observer.rows(speeds, air)
    kept = z[system.shown :].copy()
    for row, at in zip(rows, transitions, strict=True):
        z, _ = system.predicted(z, row, at)
        z[system.shown :] = kept
    given = deviating(declared_rows(BENCH, STEP, speeds, air), 0.9, 1.1, 1.1)
    point = {path: float(values[0]) for path, values in given.conductances.items()}
    true = MODEL.at(point).simulate(np.tile([float(given.inputs["nut"][0]), 0, 0, 0, 0], (400, 1)), STEP)[-1]
    # Held over a row, second order in the row: settled they agree but for the row's 30 s beside the film's minutes.
    np.testing.assert_allclose(ERROR.of(z[: MODEL.order]), ERROR.of(true), rtol=2e-3)


def test_walks_keep_their_spread() -> None:
    unknowns = Unknowns(heats=(("front", 2.0),))
    variance = unknowns.deviations**2
    np.testing.assert_allclose(unknowns.kept(STEP) ** 2 * variance + stationary_step(unknowns, STEP), variance)


def test_expected_error_is_where_the_filter_settles() -> None:
    hour = Unknowns(factor_time=3600.0, ambient_time=3600.0, heats=())
    observer = thermal_observer(BENCH, MODEL, ERROR, [Sensor("nut"), Sensor("front")], hour, STEP)
    wanted = expected_deviation(observer, 750 * RPM)
    (row,), (at,) = observer.rows(np.array([750 * RPM]), np.array([BENCH.ambient]))
    n = MODEL.order
    z, P = observer.system.cold()
    z[:n] = np.linalg.solve(np.eye(n) - at.propagator[:n, :n], at.spread[:n] @ row.heat)
    z[n : n + 2] = [z[:n] @ MODEL.readings[place] for place in ("nut", "front")]
    settled = z[n : n + 2].copy()
    for _ in range(1000):
        # Settled, as foretold: the readings correct nothing.
        z, P = advance(observer.system, z, P, row, at, settled)
    shown = np.sqrt(np.einsum("pn,nm,pm->p", ERROR.rows, P[:n, :n], ERROR.rows))
    # 8 h are eight times of the walks.
    np.testing.assert_allclose(shown, wanted, rtol=1e-3)


def test_places_are_ordered_by_what_is_left() -> None:
    best = [placements(BENCH, MODEL, ERROR, count, SPEEDS) for count in range(4)]
    assert [len(one) for one in best] == [1, 3, 3, 1]
    assert best[1][0].places == ("front",)
    assert set(best[2][0].places) == {"nut", "front"} and best[2][-1].places == ("nut", "rear")
    left = [one[0].rms for one in best]
    # Measured 17, 4.1, 0.67, 0.14 µm: each sensor parts one more unknown from the others.
    assert left[1] < left[0] / 3 and left[2] < left[1] / 5 and left[3] < left[2] / 3
    assert all(one.largest >= one.rms for group in best for one in group)


def test_no_sensor_on_the_screw_and_none_under_a_body() -> None:
    housing = Body("housing", "front", 1000.0, 2.0, 0.3)
    plant = replace(BENCH, bodies=(housing,))
    assert mountable_places(BENCH) == ("nut", "front", "rear")
    assert mountable_places(plant) == ("nut", "rear", "housing")
    for place in ("shaft_travel", "growth_250mm", "growth_end", "screw"):
        with pytest.raises(InputError, match="the screw turns; choose among nut, front, rear"):
            _observer(place)
    with pytest.raises(InputError, match="two sensors at one place"):
        _observer("nut", "nut")
    with pytest.raises(InputError, match="up to the 3 places"):
        placements(BENCH, MODEL, ERROR, 4, SPEEDS)


def test_line_through_a_line_is_that_line() -> None:
    positions = np.linspace(0.2, 0.3, 5)
    readings = np.linspace(23.0, 33.0, 41)
    offset, slope = 2e-6 * (readings - 23), 8e-6 * (readings - 23)
    error = offset[:, None] + np.multiply.outer(slope, positions - 0.21)
    found = straight_line(error, positions, 0.21)
    np.testing.assert_allclose(found.offset, offset, atol=1e-15)
    np.testing.assert_allclose(found.at(positions), error, atol=1e-15)
    table = line_table(readings, error, positions, 0.21, 3)
    # Linear in the temperature: the breakpoints hold it exactly.
    np.testing.assert_allclose(table.slopes, [0.0, 40e-6, 80e-6], atol=1e-12)
    np.testing.assert_allclose(table.line(readings).at(positions), error, atol=1e-12)


def test_table_is_written_in_the_units_of_controls_and_says_its_sign() -> None:
    table = LineTable(0.2, np.array([23.0, 33.0]), np.array([0.0, 12.5e-6]), np.array([0.0, 90e-6]))
    measured = table.text(Convention.MEASURED_ERROR).splitlines()
    assert measured[1:3] == ["# K is the measured error, actual minus commanded position", "# P0 = 200.000 mm"]
    assert measured[3:] == ["temperature [degC],K0 [um],tan_beta [um/m]", "23.00,0.00,0.00", "33.00,12.50,90.00"]
    added = table.text(Convention.ADD_TO_SETPOINT).splitlines()
    assert added[1] == "# K is added to the commanded position"
    assert added[4:] == ["23.00,0.00,0.00", "33.00,-12.50,-90.00"]


def test_table_of_a_sensor_that_does_not_move_is_refused() -> None:
    with pytest.raises(InputError, match="moves by 0 K only"):
        line_table(np.full(5, 23.0), np.zeros((5, 2)), np.array([0.2, 0.3]), 0.2)
    with pytest.raises(InputError, match="4 readings for 5 rows"):
        line_table(np.arange(4.0), np.zeros((5, 2)), np.array([0.2, 0.3]), 0.2)
    with pytest.raises(InputError, match="two positions at least"):
        straight_line(np.zeros((5, 3)), np.array([0.2, 0.3]), 0.2)


def test_duties_have_rests_and_stretches(generator: np.random.Generator) -> None:
    duty = random_duty(generator, 2000, np.array([10.0, 20.0]), 60)
    assert duty.shape == (2000,) and set(duty) == {0.0, 10.0, 20.0}
    lengths = np.diff(np.flatnonzero(np.diff(duty)))
    assert lengths.min() >= 10
    # 57 stretches: three standard deviations of the share of rests.
    assert 0.1 < np.mean(duty == 0.0) < 0.5
