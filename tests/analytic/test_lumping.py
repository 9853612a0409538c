"""The three inertias nearest to a machine of parts: held against finite elements, and used by every command."""

from __future__ import annotations

import json
import math
from dataclasses import replace
from pathlib import Path

import casadi as ca
import numpy as np
import pytest

from feeddrive.cli.main import main
from feeddrive.effects.catalogue import EFFECTS
from feeddrive.effects.transmission.stiffness_vs_position import StiffnessVsPosition
from feeddrive.errors import InputError
from feeddrive.files import find_plant
from feeddrive.plant.analysis.lumping import Lumped, lump
from feeddrive.plant.analysis.modes import braked_modes, free_modes, inertia_at_motor
from feeddrive.plant.analysis.steady import steady_motion
from feeddrive.plant.chain.chain import ThreeInertias
from feeddrive.plant.file.plant_file import read_plant
from feeddrive.plant.plant import Plant
from feeddrive.units.quantity import format_quantity
from tests.generator.drawn_drives import drawn_drive
from tests.generator.screw_elements import Drive, at_nut, chains, drive_of, frequencies, matrices

SHIPPED = ("kimm_testbed", "hsr_axis", "vertical_axis")


def compliance(drive: Drive, position: float) -> np.ndarray:
    """Deflection of the screw's angle at the nut and of the table under torque and force, motor held."""
    _, K = matrices(drive, position)
    rows = np.zeros((2, len(K)))
    made = chains(drive)
    node, share, _ = at_nut(made.places, drive.first + position, drive.axial, drive.torsional, drive.radius)
    rows[0, made.first_node + node], rows[0, made.first_node + node + 1] = 1 - share, share
    rows[1, -1] = 1.0
    found: np.ndarray = rows[:, 1:] @ np.linalg.inv(K[1:, 1:]) @ rows[:, 1:].T
    return found


def refuse_unlike(found: Lumped, drive: Drive, nearest: float) -> None:
    """What is promised exactly is exact, and what is told of the rest is true."""
    values, x = found.plant.chain.values, found.position
    H = compliance(drive, x)
    r = drive.radius
    # Rounding over nine decades of stiffness; the angle between two nodes lacks what the rod itself gives way there.
    assert 1 / values["axial_stiffness"] + r**2 / values["torsional_stiffness"] == pytest.approx(H[1, 1], rel=1e-5)
    assert 1 / values["torsional_stiffness"] == pytest.approx(H[0, 0], rel=0.01)
    M = matrices(drive, x)[0]
    turning = chains(drive).turning[0].size
    whole = float(np.sum(M[:turning, :turning]))
    ratio = values.get("ratio", 1.0)
    assert ratio == drive.ratio
    assert values["motor_inertia"] * ratio**2 + values["screw_inertia"] == pytest.approx(whole, rel=1e-9)
    true = frequencies(drive, x, True, 2), frequencies(drive, x, False, 2)
    told = {row.name: row for row in found.compared}
    own = braked_modes(found.plant).frequencies, free_modes(found.plant).frequencies[1:]
    names = ("anti-resonance, motor held", "resonance, motor free")
    for name, machine, lumped in zip(names, true, own, strict=True):
        for i, number in enumerate(("first", "second")):
            # the elements and the standing waves agree to 0.2 % and better (tests/convergence/test_standing_waves.py)
            assert told[f"{number} {name}"].machine == pytest.approx(machine[i], rel=0.003)
            assert told[f"{number} {name}"].lumped == pytest.approx(lumped[i], rel=1e-9)
        assert lumped[0] == pytest.approx(machine[0], rel=nearest)


def refuse_unlike_along(found: Lumped, drive: Drive, stroke: tuple[float, float]) -> None:
    """The stiffness at the table is the elements' everywhere on the stroke, and the one of the chain where it was made.

    One end held or both: the compliance is a parabola of the place at most, so that nothing but rounding is left, and
    what the angle between two nodes lacks.
    """
    (law,) = (effect for effect in found.plant.effects if isinstance(effect, StiffnessVsPosition))
    values = found.plant.chain.values
    for x in np.linspace(*stroke, 7):
        axial = values["axial_stiffness"] * float(law.stiffness_factor(ca.DM(x), law.values))
        lumped = 1 / axial + drive.radius**2 / values["torsional_stiffness"]
        assert lumped == pytest.approx(compliance(drive, float(x))[1, 1], rel=1e-4)
    assert float(law.stiffness_factor(ca.DM(found.position), law.values)) == 1.0
    told = {row.name: row for row in found.compared}
    assert abs(told["static stiffness, where along the stroke it is furthest off"].error) < 1e-6
    for x in stroke:
        at = f"table at {format_quantity(x, 'm')}"
        assert told[f"static stiffness, {at}"].machine == pytest.approx(1 / compliance(drive, x)[1, 1], rel=1e-4)
        for held, name in ((True, "first anti-resonance, motor held"), (False, "first resonance, motor free")):
            row = told[f"{name}, {at}"]
            assert row.machine == pytest.approx(frequencies(drive, x, held, 1)[0], rel=0.003)


@pytest.mark.parametrize("name", SHIPPED)
def test_shipped_machines(name: str) -> None:
    plant = read_plant(find_plant(name))
    assert plant.stroke is not None
    for x in (plant.stroke[0], plant.middle, plant.stroke[1]):
        # One value is free for two frequencies; on these machines both come to 1 %.
        refuse_unlike(lump(plant, x), drive_of(find_plant(name)), 0.012)
        refuse_unlike_along(lump(plant, x), drive_of(find_plant(name)), plant.stroke)


@pytest.mark.parametrize("seed", range(8))
def test_drawn_machines(seed: int, tmp_path: Path) -> None:
    path = tmp_path / "drawn.toml"
    path.write_text(drawn_drive(seed), encoding="utf-8")
    # A table no heavier than the screw is no three inertias any more; what is off is told in the file.
    plant = read_plant(path)
    refuse_unlike(lump(plant), drive_of(path), 0.06)
    assert plant.stroke is not None
    refuse_unlike_along(lump(plant), drive_of(path), plant.stroke)


@pytest.mark.parametrize("name", SHIPPED)
def test_what_does_not_bend_moves_alike(name: str) -> None:
    """Torque and stretch at constant speed, inertia at the motor: friction, weight and gear are carried over."""
    plant = read_plant(find_plant(name))
    lumped = lump(plant).plant
    assert inertia_at_motor(lumped) == pytest.approx(inertia_at_motor(plant), rel=1e-9)
    assert lumped.chain.motor_radius == pytest.approx(plant.chain.motor_radius, rel=1e-12)
    for velocity in (-0.2, 0.002, 0.1):
        one, other = (steady_motion(machine, velocity, plant.middle) for machine in (plant, lumped))
        # Newton ends where the springs' rounding begins: 1e-12 of forces of 1e9 N/m over 0.5 m, some mN.
        assert other.torque == pytest.approx(one.torque, rel=1e-4)
        # The motor stands as far ahead of the table, by some 1e-4 rad; what Newton leaves, as above.
        assert other.state[0] == pytest.approx(one.state[0], abs=1e-6)
    assert lumped.torque_limit == plant.torque_limit
    assert lumped.stroke == pytest.approx(plant.stroke)
    assert tuple(replace(sensor, model_error=0.0) for sensor in lumped.sensors) == plant.sensors
    for key, datum in lumped.data.items():
        assert datum.value == pytest.approx(plant.data[key].value)


def test_declared_deviations_are_in_the_values() -> None:
    plant = read_plant(find_plant("kimm_testbed"))
    changed = plant.with_effects(
        EFFECTS["payload"].of(mass=40.0),
        EFFECTS["inertia_deviation"].of(place="motor", inertia=1e-3),
        EFFECTS["stiffness_deviation"].of(factor=0.8),
    )
    found = lump(changed, 0.464)
    assert found.plant.chain.values["table_mass"] == 174.0
    assert inertia_at_motor(found.plant) == pytest.approx(inertia_at_motor(plant) + 1e-3 + 40 * plant.chain.radius**2)
    before = lump(plant, 0.464).plant.chain.values["axial_stiffness"]
    assert found.plant.chain.values["axial_stiffness"] == pytest.approx(0.8 * before, rel=1e-9)
    assert {effect.name for effect in found.plant.effects} == {
        "guide_friction", "nut_drag", "bearing_drag", "stiffness_vs_position",
    }  # fmt: skip
    assert any("payload" in line for line in found.left_out)


def test_laws_of_the_nut_are_converted() -> None:
    """A nut that has lost its preload is as soft at the table in the chain of parts and in three inertias."""
    plant = read_plant(find_plant("kimm_testbed"))
    worn = plant.with_effects(EFFECTS["preload_loss"].of(ratio=0.3, force=200.0))
    lumped = lump(worn, 0.464).plant
    nut = float(plant.chain.nut(plant.chain_values()).stiffness)
    axial = lumped.chain.values["axial_stiffness"]
    ratio = next(e for e in lumped.effects if e.name == "preload_loss").values["ratio"]
    # springs in series: 1 / k = 1 / k_N + rest, with k_N softer by 0.3
    assert 1 / (axial * ratio) == pytest.approx(1 / (0.3 * nut) + 1 / axial - 1 / nut, rel=1e-9)


def test_what_changes_along_the_stroke_by_itself_multiplies() -> None:
    """A law of the nut's own spring stays one, converted; beside it the screw's."""
    plant = read_plant(find_plant("kimm_testbed"))
    worn = plant.with_effects(StiffnessVsPosition.of(share_over_stroke=0.4, low=0.0, high=1.0))
    found = lump(worn, 0.0)
    screw, nut = (effect for effect in found.plant.effects if isinstance(effect, StiffnessVsPosition))
    assert screw.values == lump(plant, 0.0).plant.effects_of(StiffnessVsPosition)[0].values
    axial = found.plant.chain.values["axial_stiffness"]
    left = 1 - float(nut.values["share_over_stroke"])  # type: ignore[arg-type]
    own = float(plant.chain.nut(plant.chain_values()).stiffness)
    assert 1 / (axial * left) == pytest.approx(1 / axial + (1 / 0.6 - 1) / own, rel=1e-9)


@pytest.mark.parametrize("name", SHIPPED)
def test_what_is_missed_is_the_twist_by_the_drag_of_the_screw(name: str) -> None:
    """r T (1 / k_TS(x) - 1 / k_TS) both ways, T being what the screw's own friction takes and k_TS(x) the elements'."""
    plant, drive = read_plant(find_plant(name)), drive_of(find_plant(name))
    found = lump(plant)
    assert plant.stroke is not None
    (told,) = (sensor.model_error for sensor in found.plant.sensors if sensor.channel == "table_position")
    assert {s.channel for s in found.plant.sensors if s.model_error} == {"table_position"}
    declared = {"hsr_axis": 40 / 60, "vertical_axis": 24 / 60}
    v, radius = declared.get(name, 0.25), plant.chain.motor_radius
    twist = [
        compliance(drive, x)[0, 0] - compliance(drive, found.position)[0, 0] for x in np.linspace(*plant.stroke, 5)
    ]
    drags = []
    for way in (v, -v):
        state, torque = (motion := steady_motion(found.plant, way, found.position)).state, motion.torque
        stretch = found.plant.chain.radius * state[1] - found.position
        force = found.plant.chain.values["axial_stiffness"] * stretch
        drags.append(torque / radius * drive.radius - drive.radius * force)
    missed = np.std(drive.radius * np.outer(twist, drags))
    # the nut's drag changes a little with the load, and stands between two elements of the screw
    assert told == pytest.approx(missed, rel=0.03)
    assert any("twist of the screw by its own drag" in line for line in found.left_out)


def test_a_gear_of_three_inertias_is_a_motor_counted_so_often() -> None:
    bench = read_plant(find_plant("bench_axis"))
    values = dict(bench.chain.values)
    geared = Plant("geared", ThreeInertias({**values, "motor_inertia": values["motor_inertia"] / 4, "ratio": 2.0}))
    direct = Plant("direct", ThreeInertias(values))
    assert free_modes(geared).frequencies[1:] == pytest.approx(free_modes(direct).frequencies[1:], rel=1e-9)
    assert geared.chain.motor_radius == pytest.approx(direct.chain.motor_radius / 2, rel=1e-15)
    assert inertia_at_motor(geared) == pytest.approx(inertia_at_motor(direct) / 4, rel=1e-12)


def test_a_rigid_machine_is_refused() -> None:
    with pytest.raises(InputError, match="nothing to lump"):
        lump(read_plant(find_plant("emps")))
    with pytest.raises(InputError, match="not on the screw"):
        lump(read_plant(find_plant("kimm_testbed")), 5.0)


@pytest.mark.parametrize("name", SHIPPED)
def test_file_in_every_command(name: str, tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    path = tmp_path / "lumped.toml"
    assert main(["lump", name, "--out", str(path)]) == 0
    shown = " ".join(capsys.readouterr().out.split())
    assert "first anti-resonance, motor held" in shown
    text = path.read_text(encoding="utf-8")
    assert "first resonance, motor free:" in text
    assert "Not in this file:" in text
    for command in (["show"], ["check"], ["modes"], ["bode", "--range", "5 Hz,500 Hz"], ["tune"]):
        assert main([command[0], str(path), *command[1:]]) == 0, command
    capsys.readouterr()
    scenario = tmp_path / "step.toml"
    scenario.write_text(_scenario(path), encoding="utf-8")
    assert main(["run", str(scenario), "--out", str(tmp_path / "run")]) == 0


def _scenario(plant: Path) -> str:
    return f"""format = "feeddrive-scenario/1"
name = "a stroke"
plant = "{plant}"
[controller]
velocity_rate = "8 kHz"
position_rate = "2 kHz"
position_gain = "40 1/s"
velocity_gain = "1.5 N m s/rad"
reset_time = "20 ms"
current_bandwidth = "1 kHz"
[trajectory]
kind = "moves"
start = "200 mm"
targets = ["210 mm"]
velocity = "5 m/min"
acceleration = "2 m/s^2"
jerk = "100 m/s^3"
dwell = "0.1 s"
"""


def test_json_and_refusals(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    assert main(["lump", "kimm_testbed", "--at", "464mm", "--json"]) == 0
    content = json.loads(capsys.readouterr().out)
    assert content["format"] == "feeddrive-lumped/1"
    assert content["position"] == pytest.approx(0.464)
    assert math.isclose(content["compared"][0]["error"], 0.0, abs_tol=1e-9)
    assert content["file"] is None
    for arguments in (["--at", "5 m"], ["--at", "464"], ["--out", str(tmp_path)]):
        assert main(["lump", "kimm_testbed", *arguments]) == 2
        assert capsys.readouterr().err.startswith("error: ")
    assert main(["lump", "emps"]) == 2
