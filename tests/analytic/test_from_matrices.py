"""What a diagnosis needs of a machine, from the matrices of its chain: closed forms, and finite elements for parts."""

from __future__ import annotations

import math

import numpy as np
import pytest
from scipy.linalg import eigh

from feeddrive.diagnosis.motion.band import SHARE_OF_ANTIRESONANCE, WIDEST_BAND, comparison_band
from feeddrive.effects.catalogue import EFFECTS
from feeddrive.effects.chain.stiffness_deviation import PARTS, parts_of
from feeddrive.errors import InputError
from feeddrive.files import find_plant
from feeddrive.plant.analysis.modes import inertia_at_motor, lag_per_acceleration, screw_frequency
from feeddrive.plant.analysis.steady import steady_motion
from feeddrive.plant.analysis.stiffness_budget import participation, static_stiffness
from feeddrive.plant.file.lumped_text import plant_text_with_effects
from feeddrive.plant.file.plant_file import read_plant
from feeddrive.plant.plant import Plant
from tests.generator.screw_elements import at_nut, chains, drive_of, matrices

BENCH = read_plant(find_plant("bench_axis"))
SHIPPED = ("kimm_testbed", "hsr_axis", "vertical_axis")


def test_closed_forms_of_three_inertias() -> None:
    p, r = BENCH.chain.values, BENCH.chain.radius
    assert screw_frequency(BENCH) == pytest.approx(
        math.sqrt(p["torsional_stiffness"] / p["screw_inertia"]) / 2 / math.pi
    )
    torsion = r**2 / p["torsional_stiffness"]
    assert static_stiffness(BENCH, 0.0) == pytest.approx(1 / (1 / p["axial_stiffness"] + torsion))
    assert inertia_at_motor(BENCH) == pytest.approx(p["motor_inertia"] + p["screw_inertia"] + p["table_mass"] * r**2)
    # The table's inertia stretches both springs, the screw's own one of them.
    mass, screw = p["table_mass"] * r, p["screw_inertia"] / r
    lag = mass / p["axial_stiffness"] + (mass + screw) * torsion
    assert lag_per_acceleration(BENCH) == pytest.approx(lag)


def test_a_mode_on_the_table_is_not_the_screw() -> None:
    carrying = BENCH.with_effects(EFFECTS["structural_mode"].of(mass=20.0, frequency=40.0, damping=0.02))
    assert screw_frequency(carrying) == pytest.approx(screw_frequency(BENCH))


def test_rigid_machines_have_no_limit() -> None:
    emps = read_plant(find_plant("emps"))
    assert screw_frequency(emps) == math.inf
    assert lag_per_acceleration(emps) == 0.0
    assert static_stiffness(emps, 0.0) == math.inf


@pytest.mark.parametrize("name", SHIPPED)
def test_machines_of_parts_against_elements(name: str) -> None:
    plant, drive = read_plant(find_plant(name)), drive_of(find_plant(name))
    M, K = matrices(drive, plant.middle)
    made = chains(drive)
    node, share, soft = at_nut(made.places, drive.first + plant.middle, drive.axial, drive.torsional, drive.radius)
    row = np.zeros(len(K))
    for i, weight in ((node, 1 - share), (node + 1, share)):
        row[made.first_node + i] += drive.radius * weight
        row[made.turning[0].size + i] += weight
    row[-1] = -1.0
    opened = (K - drive.nut / (1 + drive.nut * soft) * np.outer(row, row))[1:-1, 1:-1]
    lowest = math.sqrt(eigh(opened, M[1:-1, 1:-1], eigvals_only=True)[0]) / 2 / math.pi
    # The screw's own first motion is where a chain of few coordinates is at its limit.
    assert screw_frequency(plant, plant.middle) == pytest.approx(lowest, rel=0.02)
    band = comparison_band(plant, 2000.0)
    assert band.edge == pytest.approx(min(WIDEST_BAND, SHARE_OF_ANTIRESONANCE * lowest), rel=0.02)
    rigid = np.concatenate([np.ones(made.turning[0].size), np.zeros(made.along[0].size), [drive.radius]]) / drive.ratio
    assert inertia_at_motor(plant) == pytest.approx(float(rigid @ M @ rigid), rel=1e-9)
    held = K[1:, 1:]
    lag = np.linalg.solve(held, (M @ rigid)[1:])[-1]
    # Halves of the span's inertia at its ends: J / 2 where the rod has J / 3 + J / 6, exact for a twist that is linear.
    assert lag_per_acceleration(plant) == pytest.approx(lag, rel=0.005)
    load = np.zeros(len(held))
    load[-1] = 1.0
    assert static_stiffness(plant, plant.middle) == pytest.approx(1 / np.linalg.solve(held, load)[-1], rel=1e-6)


def test_every_play_starts_steady_motion_on_a_flank() -> None:
    """Steady motion asks every effect for its gap, whatever its name or keys."""
    loose = BENCH.with_effects(EFFECTS["backlash"].of(width=2e-3))
    found = steady_motion(loose, 0.05, 0.1)
    # The motor stands ahead by half the gap, and by the stretch under friction.
    ahead = BENCH.chain.radius * found.state[0] - 0.1
    assert ahead == pytest.approx(1e-3, abs=1e-5)


def test_participation_adds_up() -> None:
    plant = read_plant(find_plant("kimm_testbed"))
    # All springs but the screw in torsion, which no part names.
    shares = {part: participation(plant, PARTS[part], 0.464) for part in parts_of(plant.chain.values)}
    k = static_stiffness(plant, 0.464)
    assert shares["nut"] == pytest.approx(k / 1499e6, rel=1e-3)
    assert shares["bearing"] == pytest.approx(k / 780e6, rel=1e-3)
    assert shares["drive"] == pytest.approx(k * plant.chain.radius**2 / plant.chain.values["drive_stiffness"], rel=1e-3)
    assert "far_bearing" not in shares


def test_stiffness_of_a_part_is_written_and_read(tmp_path) -> None:  # type: ignore[no-untyped-def]
    effect = EFFECTS["stiffness_deviation"]
    text = find_plant("kimm_testbed").read_text(encoding="utf-8")
    path = tmp_path / "soft.toml"
    path.write_text(
        plant_text_with_effects(text, [effect.of(place="nut", factor=0.8), effect.of(place="drive", factor=0.9)])
    )
    read = read_plant(path)
    assert [e.place for e in read.effects if e.name == "stiffness_deviation"] == ["nut", "drive"]
    assert read.chain_values()["nut_stiffness"] == pytest.approx(0.8 * 1499e6)
    assert read.chain_values()["drive_stiffness"] == pytest.approx(0.9 * read.chain.values["drive_stiffness"])
    whole = plant_text_with_effects(text, [effect.of(factor=0.8)])
    assert "part" not in whole.split("[[effect]]")[-1]
    with pytest.raises(InputError, match="changes nut_stiffness, which the structure three_inertias does not have"):
        Plant("bench", BENCH.chain, (effect.of(place="nut", factor=0.8),))
