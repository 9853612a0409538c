"""Frequencies of a screw with standing waves against 60 finite elements, on shipped machines and on drawn ones."""

from __future__ import annotations

import json
import math
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

from feeddrive.cli.main import main
from feeddrive.files import find_plant
from feeddrive.plant.analysis.modes import braked_modes, free_modes
from feeddrive.plant.chain.drive_values import without_brake
from feeddrive.plant.chain.resolution import ACCURACY, GOOD, resolved, resolved_modes
from feeddrive.plant.chain.standing_waves import reach
from feeddrive.plant.file.plant_file import read_plant
from feeddrive.plant.plant import Plant
from feeddrive.servo.mechanics_response import Case, mechanics
from tests.generator.drawn_drives import drawn_drive
from tests.generator.screw_elements import Drive, drive_of, frequencies, motor_response

SHIPPED = ("kimm_testbed", "hsr_axis", "vertical_axis")
DRAWN = range(12)

# 60 linear elements: a wave of length l is (2 pi h / l)^2 / 24 high; the fourth modes have two waves on the screw.
ELEMENTS = 0.002


def unbraked(path: Path) -> Plant:
    """The plant with its motor held ideally where it is held, as the elements hold it."""
    plant = read_plant(path)
    return replace(plant, drive=without_brake(plant.drive)) if plant.drive is not None else plant


def places(plant: Plant) -> list[float]:
    assert plant.stroke is not None
    low, high = plant.stroke
    return [low, 0.5 * (low + high), high]


def refuse_wrong_modes(plant: Plant, drive: Drive) -> int:
    """Every mode shown is right, and the chain is as good as is said of it; how many of its modes are not."""
    beyond = 0
    for x in places(plant):
        found = resolved_modes(plant, x)
        for held, modes in ((True, braked_modes), (False, free_modes)):
            first = 0 if held else 1
            shown = (found.braked if held else found.free).frequencies[first:]
            true = frequencies(drive, x, held, len(shown))
            assert shown == pytest.approx(true, rel=ACCURACY + ELEMENTS)
            own = modes(plant, x).frequencies[first : first + len(shown)]
            for ours, truth in zip(own, true, strict=True):
                if truth <= found.chain_valid_to * (1 - ELEMENTS):
                    assert ours == pytest.approx(truth, rel=GOOD + ELEMENTS)
                beyond += abs(ours / truth - 1) > GOOD
    return beyond


@pytest.mark.parametrize("name", SHIPPED)
def test_modes_of_shipped_machines(name: str) -> None:
    path = find_plant(name)
    # Each has modes that its own chain tells wrong: without standing waves they would be shown so.
    assert refuse_wrong_modes(unbraked(path), drive_of(path)) > 0


@pytest.mark.parametrize("seed", DRAWN)
def test_modes_of_drawn_machines(seed: int, tmp_path: Path) -> None:
    path = tmp_path / "drawn.toml"
    path.write_text(drawn_drive(seed), encoding="utf-8")
    refuse_wrong_modes(unbraked(path), drive_of(path))


@pytest.mark.parametrize("name", SHIPPED)
def test_bode_to_two_kilohertz(name: str) -> None:
    """Magnitude of motor speed over motor torque beside the elements, which have no friction."""
    plant, drive = replace(unbraked(find_plant(name)), effects=()), drive_of(find_plant(name))
    at = plant.middle

    def worst(machine: Plant) -> float:
        response = mechanics(machine, "motor_torque", "motor_speed", Case(at), 5.0, 2000.0)
        return float(
            np.max(np.abs(np.abs(response.values) / np.abs(motor_response(drive, at, response.frequency)) - 1))
        )

    # Frequencies are some 0.01 % off, which at a resonance of damping 2 % is 0.5 % of its height.
    assert worst(resolved(plant, 2000.0, [at])) < 0.005
    assert worst(plant) > 0.05  # the chain of the file


def test_bound_of_the_waves_left_out() -> None:
    """A free rod has the frequencies c k / 2 l; with m waves those within reach are at most `tolerance` too high."""
    for waves in (1, 2, 4, 7):
        size = waves + 2
        M, K = np.zeros((size, size)), np.zeros((size, size))
        M[:2, :2] = np.array([[2, 1], [1, 2]]) / 6
        K[:2, :2] = [[1, -1], [-1, 1]]
        for k in range(1, waves + 1):
            M[k + 1, k + 1], K[k + 1, k + 1] = 0.5, 0.5 * (k * math.pi) ** 2
            M[k + 1, 0] = M[0, k + 1] = 1 / (k * math.pi)
            M[k + 1, 1] = M[1, k + 1] = (1 if k % 2 else -1) / (k * math.pi)
        found = np.sort(np.sqrt(np.abs(np.linalg.eigvals(np.linalg.solve(M, K)).real)))[1:]
        exact = math.pi * np.arange(1, size)
        for tolerance in (1e-3, 1e-2):
            within = exact <= reach(waves, tolerance)
            assert (found[within] / exact[within] - 1 <= tolerance).all()
            assert (found >= exact * (1 - 1e-9)).all()  # a Ritz approximation comes from above


def test_commands_say_where_the_chain_ends(capsys: pytest.CaptureFixture[str]) -> None:
    true = frequencies(drive_of(find_plant("kimm_testbed")), 0.5, True, 3)
    for command in (["modes", "kimm_testbed", "--at", "500mm"], ["show", "kimm_testbed"], ["bode", "kimm_testbed"]):
        assert main(command) == 0
        shown = " ".join(capsys.readouterr().out.split())
        assert "declared chain, whose modes are within 1 % up to 424 Hz" in shown
        # Printed to 0.1 Hz or four digits; the chain of the file has 865 Hz.
        assert any(f"{true[2] + off:.1f}" in shown for off in (-0.1, 0.0, 0.1))
    assert main(["modes", "kimm_testbed", "--at", "500mm", "--json"]) == 0
    assert json.loads(capsys.readouterr().out)["chain_valid_to"] == [pytest.approx(424.1, abs=0.2)]
    assert main(["modes", "bench_axis", "--json"]) == 0
    assert json.loads(capsys.readouterr().out)["chain_valid_to"] == [None]
