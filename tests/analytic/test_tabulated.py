"""Tabulated effects: values at and between breakpoints, outside them and a period on; plant files; linearisation."""

from __future__ import annotations

from pathlib import Path

import casadi as ca
import numpy as np
import pytest

from feeddrive.effects.base import Motion, Port
from feeddrive.effects.tabulated import TabulatedForce, TabulatedFriction, TabulatedTorque, TabulatedTravel
from feeddrive.errors import InputError
from feeddrive.files import plants_folder
from feeddrive.plant.analysis.ode import ode, ode_parameters, state_names
from feeddrive.plant.file.lumped_text import plant_text_with_effects
from feeddrive.plant.file.plant_file import read_plant

BENCH = read_plant(plants_folder() / "bench_axis.toml")
FORCE = TabulatedForce.of(place="position", position=(0.1, 0.2, 0.4), force=(1.0, 5.0, -3.0))
EFFECTS = (
    FORCE,
    TabulatedForce.of(place="periodic_position", position=(0.0, 0.01, 0.02), force=(0.0, 2.0, -2.0), period=0.03),
    TabulatedForce.of(place="velocity", velocity=(-0.3, 0.0, 0.3), force=(-9.0, 0.0, 12.0)),
    TabulatedTorque.of(place="periodic_angle", angle=(0.0, 1.0, 2.0), torque=(0.0, 0.1, -0.1), period=np.pi),
    TabulatedFriction.of(place="time", time=(3.0, 3.5), force=(0.0, 9.0)),
    TabulatedFriction.of(place="position", position=(0.1, 0.3), viscous=(0.0, 90.0)),
    TabulatedTravel.of(place="position", position=(0.1, 0.2, 0.3), travel=(0.0, 1e-6, 0.0)),
)


def at(effect: TabulatedForce | TabulatedTorque, motion: Motion) -> float:
    return float(ca.DM(effect.force(motion, effect.values)))


@pytest.mark.parametrize(("x", "force"), [(0.0, 1.0), (0.1, 1.0), (0.15, 3.0), (0.3, 1.0), (0.4, -3.0), (9.0, -3.0)])
def test_force_is_linear_between_and_constant_outside(x: float, force: float) -> None:
    assert at(FORCE, Motion(x, 0.7, 2.0)) == pytest.approx(force, rel=1e-12)


@pytest.mark.parametrize("turns", [-2, 0, 5])
def test_a_periodic_table_closes_and_repeats(turns: int) -> None:
    """Between its last point and the first of the next period it is linear as well."""
    effect = EFFECTS[1]
    assert isinstance(effect, TabulatedForce)
    for x, force in ((0.005, 1.0), (0.015, 0.0), (0.025, -1.0)):
        assert at(effect, Motion(x + 0.03 * turns, 0.0)) == pytest.approx(force, abs=1e-9)


def test_arrays_and_expressions_agree() -> None:
    effect = EFFECTS[3]
    assert isinstance(effect, TabulatedTorque)
    angle = np.linspace(-5.0, 7.0, 41)
    whole = np.asarray(effect.force(Motion(angle, angle, angle), effect.values)).ravel()
    assert whole == pytest.approx([at(effect, Motion(float(one), 0.0)) for one in angle], rel=1e-12)


def test_written_to_a_plant_file_they_come_back_as_they_were(tmp_path: Path) -> None:
    text = plant_text_with_effects((plants_folder() / "bench_axis.toml").read_text(encoding="utf-8"), EFFECTS)
    path = tmp_path / "after.toml"
    path.write_text(text, encoding="utf-8")
    back = read_plant(path).effects[-len(EFFECTS) :]
    assert [(e.name, e.port, e.place, dict(e.values)) for e in back] == [
        (e.name, e.port, e.place, dict(e.values)) for e in EFFECTS
    ]


def test_a_plant_with_them_has_the_slope_of_its_tables() -> None:
    """The force over the position is a spring of its slope: k = 40 N/m between 0.1 m and 0.2 m, on 134 kg."""
    names, inputs = state_names(BENCH), ca.DM([0.0, 0.0])
    column, row = names.index("table_position"), names.index("table_velocity")
    state = np.zeros(len(names))
    state[column] = 0.15

    def acceleration(x: float) -> float:
        moved = state.copy()
        moved[column] = x
        rates = [
            np.array(ode(plant)(moved, inputs, list(ode_parameters(plant).values()))[0]).ravel()[row]
            for plant in (BENCH, BENCH.with_effects(FORCE))
        ]
        return float(rates[1] - rates[0])

    slope = (acceleration(0.16) - acceleration(0.14)) / 0.02
    mass = BENCH.chain_values()["table_mass"]
    assert slope == pytest.approx(-40.0 / mass, rel=1e-6)  # differences of spring forces of 1e6 N


@pytest.mark.parametrize(
    ("values", "told"),
    [
        ({"position": (0.1, 0.2), "force": (1.0,)}, "values"),
        ({"position": (0.2, 0.1), "force": (1.0, 2.0)}, "does not ascend"),
        ({"position": (0.1, 0.2), "velocity": (0.1, 0.2), "force": (1.0, 2.0)}, "velocity is given"),
        ({"position": (0.1, 0.2), "force": (1.0, 2.0), "period": 0.5}, "period is given"),
    ],
)
def test_what_is_no_table_is_refused(values: dict[str, tuple[float, ...]], told: str) -> None:
    with pytest.raises(InputError, match=told):
        TabulatedForce.of(place="position", **values)


def test_breakpoints_that_span_the_period_are_refused() -> None:
    with pytest.raises(InputError, match="span the period"):
        TabulatedForce.of(place="periodic_position", position=(0.0, 0.03), force=(1.0, 2.0), period=0.03)


def test_friction_at_a_port_without_friction_is_refused() -> None:
    bare = read_plant(plants_folder() / "bench_axis.toml")
    alone = type(bare)("alone", bare.chain)
    with pytest.raises(InputError, match="declares none"):
        alone.with_effects(EFFECTS[4])
    assert EFFECTS[4].port == Port.TABLE
