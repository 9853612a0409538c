"""What every effect must meet, by one shared test: limits, symmetry, passivity, refusals, docstring."""

from __future__ import annotations

import sys
from pathlib import Path
from typing import Any

import casadi as ca
import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from feeddrive.effects.base import Effect, Kind, Motion, Parameter, Port, SourceEffect, TimingEffect, Value
from feeddrive.effects.catalogue import EFFECTS, find_effect
from feeddrive.errors import InputError
from feeddrive.files import plants_folder
from feeddrive.plant.analysis.ode import ode, ode_parameters, state_names
from feeddrive.plant.analysis.stiffness_budget import stiffness_budget
from feeddrive.plant.file.plant_file import read_plant
from feeddrive.plant.friction_law import friction_force
from feeddrive.plant.plant import Plant
from feeddrive.plant.structure import parameter_symbols, parameter_values

BENCH = read_plant(plants_folder() / "bench_axis.toml")
DECLARED = ("guide_friction", "nut_drag", "bearing_drag", "nut_friction")

NEUTRAL: dict[str, dict[str, Value]] = {
    "guide_friction": {"coulomb": 0.0, "smoothing_velocity": 1e-3, "viscous": 0.0},
    "nut_drag": {"coulomb": 0.0, "smoothing_speed": 0.1, "viscous": 0.0},
    "bearing_drag": {"coulomb": 0.0, "smoothing_speed": 0.1, "viscous": 0.0},
    "nut_friction": {"friction_coefficient": 0.0, "pitch_diameter": 0.04, "preload": 2e3, "smoothing_speed": 0.1},
    "load_dependent_friction": {"coefficient": 0.0},
    "coulomb_asymmetry": {"delta_force": 0.0},
    "viscous_asymmetry": {"delta_viscous": 0.0},
    "stribeck": {"delta_force": 0.0, "velocity": 0.01},
    "friction_vs_position": {"peak": 0.0},
    "friction_deviation": {},
    "torque_ripple": {"amplitude": 0.0, "order": 3.0, "phase": 0.2},
    "constant_force": {"force": 0.0},
    "backlash": {"width": 0.0},
    "lead_error_periodic": {"amplitude": 0.0, "order": 1.0, "phase": 0.2},
    "payload": {"mass": 0.0},
    "ball_pass_ripple": {"amplitude": 0.0, "order": 3.7, "phase": 0.2},
    "position_spring": {"stiffness": 0.0, "zero": 0.1},
    "lead_error_cumulative": {"slope": 0.0},
    "thermal_growth": {"strain": 0.0, "time_constant": 100.0},
    "viscous_warmup": {"share": 0.0, "time_constant": 100.0},
    "stiffness_deviation": {"factor": 1.0},
    "stiffness_vs_position": {"share_over_stroke": 0.0, "low": 0.0, "high": 0.4},
    "preload_loss": {"ratio": 1.0, "force": 100.0},
    "inertia_deviation": {"inertia": 0.0},
    "torque_constant_droop": {"share": 0.0, "at_torque": 10.0},
    "drive_delay": {"delay": 0.0},
    "channel_delay": {"delay": 0.0},
    "tabulated_force": {},
    "tabulated_torque": {},
    "tabulated_friction": {},
    "tabulated_travel": {},
}
"""Values at which an effect is not there. `presliding` has none: it is another shape, stiffer or softer."""

PLACES = {"inertia_deviation": "screw", "channel_delay": "motor_angle"}
"""Where the effects that must say so are."""

DISSIPATIVE: dict[str, st.SearchStrategy[dict[str, Value]]] = {
    "guide_friction": st.fixed_dictionaries(
        {"coulomb": st.floats(0, 500), "smoothing_velocity": st.floats(1e-5, 1e-2), "viscous": st.floats(0, 2000)}
    ),
    "nut_drag": st.fixed_dictionaries(
        {"coulomb": st.floats(0, 5), "smoothing_speed": st.floats(1e-3, 10), "viscous": st.floats(0, 1)}
    ),
    "bearing_drag": st.fixed_dictionaries(
        {"coulomb": st.floats(0, 5), "smoothing_speed": st.floats(1e-3, 10), "viscous": st.floats(0, 1)}
    ),
    "nut_friction": st.fixed_dictionaries(
        {
            "friction_coefficient": st.floats(0, 0.3),
            "contact_angle": st.floats(0.53, 1.39),
            "pitch_diameter": st.floats(0.008, 0.2),
            "preload": st.floats(0, 2e4),
            "smoothing_speed": st.floats(1e-3, 10),
            "viscous": st.floats(0, 1),
        }
    ),
    "load_dependent_friction": st.fixed_dictionaries({"coefficient": st.floats(0, 1)}),
    # Above minus the declared 60 N and 300 N s/m, as the docstrings say.
    "coulomb_asymmetry": st.fixed_dictionaries({"delta_force": st.floats(-59, 200)}),
    "viscous_asymmetry": st.fixed_dictionaries({"delta_viscous": st.floats(-299, 900)}),
    "stribeck": st.fixed_dictionaries({"delta_force": st.floats(-59, 200), "velocity": st.floats(1e-4, 0.1)}),
    "friction_vs_position": st.fixed_dictionaries(
        {"peak": st.floats(-59, 200), "centre": st.floats(-1, 1), "half_width": st.floats(1e-3, 1)}
    ),
    "friction_deviation": st.fixed_dictionaries(
        {"coulomb_factor": st.floats(0, 10), "viscous_factor": st.floats(0, 10)}
    ),
    "viscous_warmup": st.fixed_dictionaries({"share": st.floats(-2, 1), "time_constant": st.floats(0.1, 1e4)}),
    # Below the 0.35 N m that the bench axis declares at its screw.
    "ball_pass_ripple": st.fixed_dictionaries({"amplitude": st.floats(0, 0.34), "order": st.floats(0.1, 50)}),
}
"""Friction effects that depend on motion and transmitted force alone, with physical values."""

ODD = (
    "guide_friction",
    "nut_drag",
    "bearing_drag",
    "stribeck",
    "friction_vs_position",
    "friction_deviation",
    "viscous_warmup",
    "ball_pass_ripple",
    "load_dependent_friction",
)
"""`nut_friction` is odd in velocity and force together: driving and back-driving lose different shares."""


def _friction(plant: Plant, port: Port, position: float, velocity: float, transmitted: float = 0.0) -> float:
    symbols = parameter_symbols(plant)
    motion = Motion(ca.SX(position), ca.SX(velocity), force=ca.SX(transmitted), radius=ca.SX(R_TABLE))
    force = friction_force(plant, symbols, port, motion)
    return float(ca.Function("force", [symbols.vector], [force])(parameter_values(plant)))


def _plant(effect: Effect) -> Plant:
    return Plant("alone", BENCH.chain, (effect,)) if effect.name in DECLARED else BENCH.with_effects(effect)


def _xdot(plant: Plant, state: np.ndarray) -> np.ndarray:
    return np.array(ode(plant)(state, [1.0, -20.0], list(ode_parameters(plant).values()))[0].full())[:, 0]


def test_every_effect_has_a_neutral_value_or_is_a_bristle() -> None:
    # a structural mode adds a coordinate: what it does at no mass stands in test_table_mode.py
    assert set(NEUTRAL) | {"presliding", "structural_mode"} == set(EFFECTS)


@pytest.mark.parametrize("name", NEUTRAL)
def test_vanishes_at_its_neutral_value(name: str, generator: np.random.Generator) -> None:
    effect = EFFECTS[name].of(place=PLACES.get(name, ""), **NEUTRAL[name])
    if isinstance(effect, TimingEffect):
        assert effect.delay(effect.values) == 0.0
        return
    base = Plant("alone", BENCH.chain) if name in DECLARED else BENCH
    for _ in range(20):
        state = generator.normal(size=len(state_names(base))) * np.array([1, 1, R_TABLE, 5, 5, 0.05])
        # The same terms in another order: rounding of spring forces.
        assert _xdot(base.with_effects(effect), state) == pytest.approx(_xdot(base, state), rel=1e-10)


R_TABLE = BENCH.chain.radius


@pytest.mark.parametrize("name", ODD)
@given(data=st.data(), velocity=st.floats(1e-6, 1.0), position=st.floats(-1, 1), force=st.floats(-2e4, 2e4))
def test_odd_in_velocity(name: str, data: st.DataObject, velocity: float, position: float, force: float) -> None:
    plant = _plant(effect := EFFECTS[name].of(**data.draw(DISSIPATIVE[name])))
    there, back = (_friction(plant, effect.port, position, sign * velocity, force) for sign in (1, -1))
    assert there == pytest.approx(-back, rel=1e-12)  # the same operations with the other sign


@pytest.mark.parametrize("name", DISSIPATIVE)
@given(data=st.data(), velocity=st.floats(-1, 1), position=st.floats(-1, 1), force=st.floats(-2e4, 2e4))
def test_friction_never_creates_power(
    name: str, data: st.DataObject, velocity: float, position: float, force: float
) -> None:
    plant = _plant(effect := EFFECTS[name].of(**data.draw(DISSIPATIVE[name])))
    assert _friction(plant, effect.port, position, velocity, force) * velocity >= 0.0


@given(
    st.floats(1e5, 1e8), st.floats(0, 0.95), st.floats(-1.0, 1.0), st.floats(1e-5, 0.3), st.sampled_from([1.0, -1.0])
)  # fmt: skip
def test_bristle_takes_no_more_than_it_stored(
    stiffness: float, break_away: float, share: float, speed: float, sign: float
) -> None:
    """F v less the rate of s0 z^2 / 2 is not negative, without damper, for |z| up to the steady deflection."""
    effect: Any = EFFECTS["presliding"].of(stiffness=stiffness, damping=0.0, break_away=break_away)
    level, velocity = 60.0, sign * speed
    z, motion = share * level / stiffness, Motion(0.0, velocity)
    rate = float(ca.DM(effect.deflection_rate(ca.DM(z), motion, level, effect.values)))
    force = float(ca.DM(effect.force(ca.DM(z), ca.DM(rate), motion, level, effect.values)))
    assert force * velocity - stiffness * z * rate >= -1e-12 * level * speed  # rounding of equal powers


@pytest.mark.parametrize("name", ["torque_ripple", "constant_force", "position_spring"])
def test_source_is_conservative(name: str) -> None:
    """The force does not depend on velocity, so the work over a closed path is none."""
    effect = EFFECTS[name].of(**{**NEUTRAL[name], next(iter(NEUTRAL[name])): 2.0})
    assert isinstance(effect, SourceEffect)
    forces = {float(ca.DM(effect.force(Motion(0.3, v), effect.values))) for v in (-1.0, 0.0, 2.0)}
    assert len(forces) == 1


@pytest.mark.parametrize("name", EFFECTS)
def test_unknown_key_is_refused(name: str) -> None:
    with pytest.raises(InputError, match="unknown key 'nonsense'"):
        EFFECTS[name].of(place=PLACES.get(name, ""), nonsense=1.0)


@pytest.mark.parametrize(
    ("name", "parameter"),
    [pytest.param(name, p, id=f"{name}.{p.key}") for name, effect in EFFECTS.items() for p in effect.parameters],
)
def test_value_outside_its_range_is_refused(name: str, parameter: Parameter) -> None:
    good = {p.key: p.default if p.default is not None else p.size for p in EFFECTS[name].parameters}
    place = PLACES.get(name, "")
    EFFECTS[name].of(place=place, **good)
    for end, outward in ((parameter.minimum, -1.0), (parameter.maximum, 1.0)):
        if np.isfinite(end):
            with pytest.raises(InputError, match="outside its range"):
                EFFECTS[name].of(place=place, **{**good, parameter.key: end + outward * max(1e-9, abs(end))})
    with pytest.raises(InputError, match="outside its range"):
        EFFECTS[name].of(place=place, **{**good, parameter.key: float("nan")})


@pytest.mark.parametrize("name", EFFECTS)
def test_impossible_port_is_refused(name: str) -> None:
    effect = EFFECTS[name]
    impossible = next(port for port in Port if port not in effect.ports)
    with pytest.raises(InputError, match="cannot act at port"):
        effect.of(impossible, **NEUTRAL.get(name, {"stiffness": 1e6}))


@pytest.mark.parametrize("name", EFFECTS)
def test_docstring_tells_law_and_keys(name: str) -> None:
    """The file says its law as an indented equation, and every key with its unit in a table."""
    effect = EFFECTS[name]
    text = sys.modules[effect.__module__].__doc__ or ""
    assert any(line.startswith("    ") and "=" in line for line in text.splitlines())
    rows = [line for line in text.splitlines() if line.startswith("|")]
    for parameter in effect.parameters:
        units = [row.strip("| ").split(" | ")[-1].split(", ") for row in rows if parameter.key in row]
        assert any(parameter.unit in listed for listed in units), parameter.key


@pytest.mark.parametrize("name", EFFECTS)
def test_signature_names_channels_and_a_variable(name: str) -> None:
    signature = EFFECTS[name].signature
    assert set(signature.channels) <= {"motor_torque", "table_position"}
    assert signature.channels and signature.variable


@pytest.mark.parametrize("name", EFFECTS)
def test_kind_is_said(name: str) -> None:
    assert EFFECTS[name].kind in Kind


def test_one_effect_a_file() -> None:
    """Only nut and bearing drag share one, the same law on the same shaft, and the four tables."""
    files = [Path(sys.modules[effect.__module__].__file__ or "").stem for effect in EFFECTS.values()]
    assert len(set(files)) == len(files) - 1 - 3


def test_misspelt_effect_names_the_nearest() -> None:
    with pytest.raises(InputError, match="did you mean backlash"):
        find_effect("backlsh")


def test_stiffness_deviation_scales_the_combined_stiffness_of_every_structure() -> None:
    for name in ("bench_axis", "kimm_testbed"):
        plant = read_plant(plants_folder() / f"{name}.toml")
        softer = plant.with_effects(EFFECTS["stiffness_deviation"].of(factor=0.8))
        before, after = (stiffness_budget(p).axial for p in (plant, softer))
        assert after == pytest.approx(0.8 * before, rel=1e-12)  # the same series with every member scaled
