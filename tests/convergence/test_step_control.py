"""Step control: cases in which one step a sample is not enough, or was no number at all; both ways to run."""

from __future__ import annotations

import dataclasses
import math
from collections.abc import Callable, Iterator

import numpy as np
import pytest

from feeddrive.compiler import find_compiler
from feeddrive.effects.base import Effect
from feeddrive.effects.chain.structural_mode import StructuralMode
from feeddrive.effects.friction.friction_vs_position import FrictionVsPosition
from feeddrive.effects.friction.presliding import Presliding
from feeddrive.effects.friction.stribeck import Stribeck
from feeddrive.effects.timing.drive_delay import DriveDelay
from feeddrive.effects.transmission.backlash import Backlash
from feeddrive.effects.transmission.preload_loss import PreloadLoss
from feeddrive.effects.transmission.stiffness_vs_position import StiffnessVsPosition
from feeddrive.engine.engine import forget_constants
from feeddrive.engine.program import TOLERANCE
from feeddrive.engine.step import step_constants
from feeddrive.engine.step.linear_part import SimulationError
from feeddrive.plant.plant import Plant
from feeddrive.plant.structure import forget_machines
from feeddrive.simulate.driven import motor_motion, simulate_driven
from feeddrive.simulate.held_torque import simulate_torque
from feeddrive.typing import FloatArray
from tests.convergence.test_simulate import SAMPLE, bench, torque_curve

PLAY = Backlash.of(width=7.5e-6)
STIFF = Presliding.of(stiffness=6e8, damping=2e3, break_away=0.9)
CASES: dict[str, tuple[Effect, ...]] = {
    "declared": (),
    "stiff_bristle": (STIFF,),
    "soft_bristle": (Presliding.of(stiffness=5.5e6, damping=0.0, break_away=0.0),),
    "free_play": (PLAY,),
    "free_play_and_bristle": (PLAY, STIFF),
    "stribeck": (Stribeck.of(delta_force=-30.0, velocity=2e-3),),
    "soft_along": (
        PreloadLoss.of(ratio=0.3, force=150.0),
        StiffnessVsPosition.of(share_over_stroke=0.4, low=-0.1, high=0.1),
    ),
    "table_mode": (StructuralMode.of(mass=16.0, frequency=70.0, damping=0.03),),
    "delay_and_bump": (DriveDelay.of(delay=1.3e-3), FrictionVsPosition.of(peak=40.0, centre=0.0, half_width=0.01)),
}


@pytest.mark.parametrize("case", [case for case in CASES if "play" not in case])
def test_position_does_not_depend_on_the_steps(case: str) -> None:
    plant = bench(*CASES[case])
    time, torque = torque_curve(300)
    run = simulate_torque(plant, time, torque)
    fine = simulate_torque(plant, time, torque, tolerance=1e-14)
    assert fine.report.steps > 3 * run.report.steps
    # 5 nm, half a step of a good scale, after 0.3 s in which nothing but friction holds the axis to its place
    assert np.abs(run.position - fine.position).max() < 5e-9
    assert run.report.last_sweep < 1 and run.report.over == 0


@pytest.fixture
def to_the_last_digit(monkeypatch: pytest.MonkeyPatch) -> Iterator[Callable[[], None]]:
    """Lets Newton go on to a billionth, a hundredth of that where forces are sharp, as long as the test lasts."""

    def begin() -> None:
        monkeypatch.setattr(step_constants, "CONVERGED", 1e-9)
        monkeypatch.setattr(step_constants, "CONVERGED_WHERE_SHARP", 1e-11)
        forget_machines()
        forget_constants()

    yield begin
    forget_machines()
    forget_constants()


@pytest.mark.parametrize("case", [case for case in CASES if "play" not in case])
def test_newton_is_not_asked_for_more_than_shows(case: str, to_the_last_digit: Callable[[], None]) -> None:
    plant = bench(*CASES[case])
    time, torque = torque_curve(300)
    run = simulate_torque(plant, time, torque)
    to_the_last_digit()
    exact = simulate_torque(plant, time, torque)
    assert exact.report.sweeps > run.report.sweeps  # it did go on
    # a hundredth of what one of the 300 steps may miss by itself
    assert np.abs(run.position - exact.position).max() < 0.01 * TOLERANCE


def test_free_play_does_not_depend_on_the_steps() -> None:
    """Until the play makes the motion chaotic: three crossings."""
    plant = bench(PLAY)
    time = np.arange(400) * SAMPLE
    torque = 1.5 * np.sin(2 * math.pi * 6 * time)
    run = simulate_torque(plant, time, torque)
    fine = simulate_torque(plant, time, torque, tolerance=1e-14)
    stretch = run.motor_angle * plant.chain.radius - run.position
    assert np.ptp(np.sign(stretch[np.abs(stretch) > 3.75e-6])) == 2  # both flanks were met
    # 10 nm, a step of a good scale: free play multiplies the 0.01 nm of each step some hundred times
    assert np.abs(run.position - fine.position).max() < 1e-8


@pytest.mark.parametrize("case", CASES)
def test_compiled_and_virtual_machine_agree(case: str, without_compiler: Callable[[], None]) -> None:
    if find_compiler() is None:
        pytest.skip("no C compiler here")
    plant = bench(*CASES[case])
    time, torque = torque_curve(60)
    fast = simulate_torque(plant, time, torque)
    without_compiler()
    slow = simulate_torque(plant, time, torque)
    # free play multiplies rounding as it does everything: there the range is that of the axis, 0.5 m and 0.5 m/s
    ranges = {"position": 0.5, "velocity": 0.5, "motor_angle": 0.5 / plant.chain.radius}
    for name, full in ranges.items():
        a, b = getattr(fast, name), getattr(slow, name)
        # rounding, and Newton's last correction where the virtual machine takes one more
        assert np.abs(a - b).max() <= 1e-12 * (full if "play" in case else np.abs(a).max()), name
    for key in ("steps", "refused", "finest", "over"):
        assert getattr(fast.report, key) == getattr(slow.report, key)


def test_driven_runs_agree_too(without_compiler: Callable[[], None]) -> None:
    plant = bench(STIFF)
    time = np.arange(200) * SAMPLE
    motion = motor_motion(time, 0.3 * np.sin(2 * math.pi * 9 * time))
    fast = simulate_driven(plant, motion)
    without_compiler()
    slow = simulate_driven(plant, motion)
    assert np.abs(fast.table_position - slow.table_position).max() <= 1e-12 * np.abs(fast.table_position).max()
    assert np.abs(fast.torque - slow.torque).max() <= 1e-12 * np.abs(fast.torque).max()


def test_driven_motion_does_not_depend_on_the_grid() -> None:
    plant = bench(STIFF)
    time = np.arange(400) * SAMPLE
    angle: FloatArray = 0.3 * np.sin(2 * math.pi * 9 * time)
    coarse, fine = (simulate_driven(plant, motor_motion(time, angle, steps)) for steps in (1, 8))
    # the quintic spline as cubics: (h omega)^4 / 384 of 1 mm, 0.03 nm; the steps' own tolerance 0.1 nm
    assert np.abs(coarse.table_position - fine.table_position).max() < 2e-10


@pytest.mark.parametrize(
    ("key", "words"), [("table_mass", "not positive"), ("axial_stiffness", r"cannot be followed after 0\.\d+ s")]
)
def test_motion_that_cannot_be_followed_is_refused(key: str, words: str) -> None:
    """No mass, or a spring that pushes away until the numbers end: the message says what, and when."""
    chain = dataclasses.replace(bench().chain, values={**bench().chain.values, key: -1e8})
    time, torque = torque_curve(2000)
    with pytest.raises(SimulationError, match=words):
        simulate_torque(Plant("impossible", chain, bench().effects), time, torque)
