"""Plants described by their parts: computed values, what is replaced by measured ones, weight, brake, friction."""

from __future__ import annotations

import dataclasses
import math
from pathlib import Path

import numpy as np
import pytest

from feeddrive.effects.base import FrictionEffect, Motion, Port
from feeddrive.effects.catalogue import EFFECTS
from feeddrive.effects.friction.guide_friction import guide_effect
from feeddrive.errors import InputError
from feeddrive.files import plants_folder
from feeddrive.parts.combined_stiffness import combined_stiffness
from feeddrive.parts.guide.guide_coefficients import SET_A
from feeddrive.parts.guide.guide_geometry import HSR_30R
from feeddrive.plant.analysis.modes import braked_modes, free_modes
from feeddrive.plant.analysis.screw_limits import buckling_force, critical_speed
from feeddrive.plant.analysis.steady import steady_motion
from feeddrive.plant.analysis.stiffness_budget import stiffness_budget
from feeddrive.plant.analysis.summary import summarise
from feeddrive.plant.composition import refuse_what_cannot_compose
from feeddrive.plant.file.plant_file import read_plant
from feeddrive.plant.plant import Plant
from tests.analytic.screw_fem import ScrewDrive, frequencies

KIMM = read_plant(plants_folder() / "kimm_testbed.toml")
HSR = read_plant(plants_folder() / "hsr_axis.toml")
VERTICAL = read_plant(plants_folder() / "vertical_axis.toml")
TESTED = 0.464
"""Table position of the rig at which its nut is 564 mm from the bearing [m]."""

LUMPED = """
format = "feeddrive-plant/1"
structure = "three_inertias"
[transmission]
nut_position = "564 mm"
[damping]
ratio = 0.02
frequency = "190 Hz"
"""


def _changed(name: str, folder: Path, *changes: tuple[str, str]) -> Plant:
    text = (plants_folder() / f"{name}.toml").read_text(encoding="utf-8")
    for old, new in changes:
        assert old in text
        text = text.replace(old, new)
    path = folder / "machine.toml"
    path.write_text(text, encoding="utf-8")
    return read_plant(path)


def test_testbed_is_that_of_the_source() -> None:
    """Paper 004: 244.7, 202.7 N/µm, 11982.4 N m/rad, 83 and 17 %; half of the last digit printed."""
    budget = stiffness_budget(KIMM, TESTED)
    assert budget.axial / 1e6 == pytest.approx(244.7, abs=0.05)
    assert budget.torsional * KIMM.chain.radius**2 == pytest.approx(11982.4, abs=0.6)  # of rounded 27000 and 69930
    assert budget.total / 1e6 == pytest.approx(202.7, abs=0.1)
    assert (budget.axial_share, budget.torsional_share) == pytest.approx((0.83, 0.17), abs=0.005)


def test_testbed_against_finite_elements() -> None:
    drive = ScrewDrive()
    for position in (0.0, TESTED, 1.0):
        nut = position + 0.1
        # Six coordinates: 0.15 % for the first mode.
        assert braked_modes(KIMM, position).frequencies[0] == pytest.approx(frequencies(drive, nut)[0], rel=0.0015)
        found = free_modes(KIMM, position).frequencies[1]
        assert found == pytest.approx(frequencies(drive, nut, braked=False)[0], rel=0.0015)


def test_second_mode_of_the_axis_in_two_elements() -> None:
    """What the file says of them: 0.2 % with the motor held, 0.5 % with it free; measured 0.19 and 0.51."""
    drive, values = HSR.drive, HSR.chain.values
    assert drive is not None and drive.coupling is not None and HSR.stroke is not None
    screw = drive.screw
    area, polar = math.pi * screw.diameter**2 / 4, math.pi * screw.diameter**4 / 32
    elements = ScrewDrive(
        diameter=screw.diameter, lead=screw.lead, length=screw.length, stub=screw.stub, density=screw.material.density,
        # the core carries, the whole diameter weighs
        young=values["axial_rigidity"] / area, shear=values["torsional_rigidity"] / polar,
        nut=values["nut_stiffness"], bearing=values["bearing_stiffness"], far_bearing=values["far_bearing_stiffness"],
        coupling=drive.coupling.torsional_stiffness, motor_shaft=drive.motor.shaft_stiffness,
        coupling_inertia=drive.coupling.inertia, rotor_inertia=drive.motor.rotor_inertia, table=values["table_mass"],
        elements=300,
    )  # fmt: skip
    held, free = [], []
    for position in np.linspace(*HSR.stroke, 8):
        nut = position + values["first_nut_position"]
        held.append(braked_modes(HSR, position).frequencies[1] / frequencies(elements, nut)[1] - 1)
        free.append(free_modes(HSR, position).frequencies[2] / frequencies(elements, nut, braked=False)[1] - 1)
    assert max(np.abs(held)) == pytest.approx(0.0019, abs=0.0003)
    assert max(np.abs(free)) == pytest.approx(0.0051, abs=0.0003)


@pytest.mark.parametrize("plant", [KIMM, HSR, VERTICAL], ids=lambda plant: plant.name)
def test_budget_adds_up_and_is_that_of_chain_and_parts(plant: Plant) -> None:
    assert plant.stroke is not None and plant.drive is not None
    for position in (*plant.stroke, plant.middle):
        budget = stiffness_budget(plant, position)
        assert math.fsum(part.share for part in budget.parts) == pytest.approx(1, rel=1e-12)
        nut = position + plant.chain.values["first_nut_position"]
        assert budget.total == pytest.approx(combined_stiffness(plant.drive, nut).total, rel=1e-9)


def test_measured_value_takes_the_place_of_the_computed_one(tmp_path: Path) -> None:
    section = '[transmission]\ndrive_stiffness = { value = "15000 N m/rad", source = "measured" }\n\n[support]'
    plant = _changed("kimm_testbed", tmp_path, ("[support]", section))
    assert plant.chain.values["drive_stiffness"] == 15000
    assert plant.origins["drive_stiffness"].startswith("measured (in place of 19480 N m/rad computed from")
    # The budget is then that of the chain's springs, whose drive is one.
    assert [part.part for part in stiffness_budget(plant, 0.2).parts] == ["nut", "axial", "screw torsion", "drive"]


def test_three_inertias_from_parts(tmp_path: Path) -> None:
    text = (plants_folder() / "kimm_testbed.toml").read_text(encoding="utf-8")
    parts = text[text.index("[motor]") : text.index("[damping]")]
    parts = "\n".join(line for line in parts.splitlines() if not line.startswith(("stroke", "first_nut")))
    path = tmp_path / "machine.toml"
    path.write_text(LUMPED + parts, encoding="utf-8")
    plant = read_plant(path)
    values = plant.chain.values
    # Paper 004 prints both; the coupling's split is rounded.
    assert values["axial_stiffness"] / 1e6 == pytest.approx(244.7, abs=0.05)
    assert values["torsional_stiffness"] == pytest.approx(11982.4, abs=0.6)
    assert values["motor_inertia"] == pytest.approx(9e-3, rel=1e-12)
    assert values["axial_damping"] == pytest.approx(0.02 / (math.pi * 190) * values["axial_stiffness"], rel=1e-12)
    assert "564 mm" in plant.origins["axial_stiffness"]


def test_damping_ratio_is_that_of_the_first_mode() -> None:
    for plant, ratio in ((KIMM, 0.03), (HSR, 0.02), (VERTICAL, 0.02)):
        # C = tau K: exact for the mode whose frequency tau is made of.
        assert free_modes(plant, plant.middle).damping[1] == pytest.approx(ratio, rel=1e-6)


def test_weight_less_counterbalance_pulls_down() -> None:
    force = 260 * 9.80665 - 1800
    up, down = (steady_motion(VERTICAL, v, 0.25).torque for v in (0.1, -0.1))
    # Friction is alike either way, so the mean is the weight at the motor: the ratio counts.
    assert 0.5 * (up + down) == pytest.approx(force * VERTICAL.chain.radius / 1.5, rel=1e-3)


def test_brake_gives_way(tmp_path: Path) -> None:
    """A stiffer brake raises the first mode towards that of a motor held ideally."""
    stiff = _changed("vertical_axis", tmp_path, ('stiffness = "25000 N m/rad"', 'stiffness = "1e7 N m/rad"'))
    soft, firm = (braked_modes(plant, 0.25).frequencies[0] for plant in (VERTICAL, stiff))
    held = braked_modes(dataclasses.replace(VERTICAL, drive=None), 0.25).frequencies[0]
    assert soft < 0.99 * held
    # 1e7 N m/rad beside the 2e4 of the belt, which is a tenth of the compliance.
    assert firm == pytest.approx(held, rel=2e-4) and firm < held


def test_guide_friction_is_that_of_its_carriages() -> None:
    expected = guide_effect(HSR_30R, SET_A, 4, 320 * 9.80665 / 4, 6.0)
    found = {key.removeprefix("guide_friction."): value for key, value in HSR.effect_values().items() if "guide" in key}
    assert found == expected.values


def test_inertias_add_up() -> None:
    for plant in (KIMM, HSR, VERTICAL):
        summary = summarise(plant)
        rigid = np.array(plant.chain.rigid_motion(plant.chain.values), dtype=float)
        M = np.array(plant.chain.mass(plant.chain.values, 0.1), dtype=float)
        # The same wherever the nut stands, since the shaft turns as one.
        assert summary.mass_at_table == pytest.approx(float(rigid @ M @ rigid), rel=1e-12)
        assert summary.inertia_at_motor == pytest.approx(summary.mass_at_table * plant.chain.motor_radius**2, rel=1e-12)


def test_critical_speed_and_buckling_of_a_catalogue() -> None:
    """The known ratios between the kinds of support, and a 36.4 mm root over 1 m by the beam's closed form."""
    assert VERTICAL.drive is not None
    screw, kind = VERTICAL.drive.screw, VERTICAL.drive.supports.kind
    inertia, density = math.pi * 0.0364**4 / 64, 7850 * math.pi * 0.04**2 / 4
    # 0.8 lambda^2 sqrt(EI/mu) with lambda = 4.730, E = 206 GPa.
    assert critical_speed(screw, kind, 1.0) == pytest.approx(0.8 * 4.73**2 * math.sqrt(206e9 * inertia / density))
    assert buckling_force(screw, kind, 1.0) == pytest.approx(2 * math.pi**2 * 206e9 * inertia)
    assert buckling_force(screw, kind, 2.0) == pytest.approx(buckling_force(screw, kind, 1.0) / 4)


def test_effect_on_a_value_that_the_structure_lacks() -> None:
    with pytest.raises(InputError, match="stiffness_deviation changes axial_stiffness, which the structure"):
        read_plant(plants_folder() / "emps.toml").with_effects(EFFECTS["stiffness_deviation"].of(factor=0.9))


def test_force_is_handed_to_friction_and_refused_in_a_rigid_structure() -> None:
    class Reader(FrictionEffect):
        name = "reader"
        ports = (Port.SCREW,)
        reads_force = True
        declared = True

    with pytest.raises(InputError, match=r"reader reads the force that the nut transmits, which a rigid structure"):
        refuse_what_cannot_compose([Reader(port=Port.SCREW)], elastic=False, where="machine")
    assert Motion(0.0, 0.0).force == 0.0
    for v in (0.05, -0.05):
        # The drag of a nut that transmits nothing but guide friction, here 60 N and 300 N s/m: c |F| r.
        friction = EFFECTS["load_dependent_friction"].of(coefficient=0.5)
        more = steady_motion(KIMM.with_effects(friction), v, 0.5).torque - steady_motion(KIMM, v, 0.5).torque
        assert more == pytest.approx(0.5 * math.copysign(75, v) * KIMM.chain.radius, rel=1e-6)


def test_every_value_of_the_chain_may_be_written_instead(tmp_path: Path) -> None:
    """A machine known by measured values alone: the chain's own keys, no parts."""
    sections: dict[str, list[str]] = {}
    for value in KIMM.chain.required:
        number = KIMM.chain.values[value.key]
        written = repr(number) if value.unit == "1" else f'"{number!r} {value.unit}"'
        sections.setdefault(value.section, []).append(f"{value.section_key} = {written}")
    lines = ['format = "feeddrive-plant/1"', 'structure = "distributed_screw"']
    for section, entries in sections.items():
        lines += [f"[{section}]", *entries]
    path = tmp_path / "machine.toml"
    path.write_text("\n".join(lines), encoding="utf-8")
    plant = read_plant(path)
    assert plant.chain == KIMM.chain
    assert plant.drive is None
    assert stiffness_budget(plant, TESTED).total == pytest.approx(stiffness_budget(KIMM, TESTED).total, rel=1e-9)


GEOMETRY = """ball_diameter = "5.556 mm"
rail_conformity = {conformity}
carriage_conformity = 0.52
contact_angle = "{angle}"
preload_oversize = "5 µm"
balls_per_row = 12"""


def _with_geometry(tmp_path: Path, conformity: str, angle: str) -> Path:
    """hsr_axis with its carriage described by geometry in place of the name."""
    text = (plants_folder() / "hsr_axis.toml").read_text(encoding="utf-8")
    written = GEOMETRY.format(conformity=conformity, angle=angle)
    changed = tmp_path / "geometry.toml"
    changed.write_text(text.replace('carriage = "HSR-30R"', written), encoding="utf-8")
    return changed


def test_a_carriage_may_be_written_as_its_geometry(tmp_path: Path) -> None:
    named = read_plant(plants_folder() / "hsr_axis.toml")
    written = read_plant(_with_geometry(tmp_path, "0.52", "45 deg"))
    assert written.effect_values() == named.effect_values()  # the same numbers reach the same formulas


@pytest.mark.parametrize(("conformity", "angle"), [("0.49", "45 deg"), ("0.52", "0 deg"), ("1.2", "45 deg")])
def test_impossible_grooves_are_refused_with_the_range(tmp_path: Path, conformity: str, angle: str) -> None:
    with pytest.raises(InputError, match="write a value between"):
        read_plant(_with_geometry(tmp_path, conformity, angle))
