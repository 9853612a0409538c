"""Derivatives of a controlled run against complex steps through the same scheme, written here by hand in numpy."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace

import casadi as ca
import numpy as np
import pytest
from scipy.linalg import expm

from feeddrive.compiler import find_compiler
from feeddrive.effects.chain.payload import Payload
from feeddrive.effects.friction.guide_friction import GuideFriction
from feeddrive.effects.friction.presliding import Presliding
from feeddrive.effects.friction.shaft_drag import NutDrag
from feeddrive.errors import InputError
from feeddrive.plant.plant import Plant
from feeddrive.servo.sampled_plant import SampledController
from feeddrive.simulate.controlled.controlled import TorqueLoop, simulate_controlled
from feeddrive.simulate.controlled.sensitivity import simulate_sensitivity
from tests.claims.book import CLAIMS
from tests.convergence.test_simulate import BENCH

SAMPLE, LAG = 5e-4, 3e-4
GUIDE = {"coulomb": 60.0, "smoothing_velocity": 5e-3, "viscous": 300.0}
DRAG = {"coulomb": 0.25, "smoothing_speed": 1.5}
GAINS = {"position": 60.0, "velocity": 0.8}
NAMES = (
    "lead", "table_mass", "axial_stiffness", "axial_damping", "motor_inertia", "guide_friction.coulomb",
    "guide_friction.smoothing_velocity", "nut_drag.coulomb", "payload.mass", "controller[0]", "controller[1]",
    "torque_loop.lag",
)  # fmt: skip


@pytest.fixture(params=["compiled", "interpreted"])
def both_ways(request: pytest.FixtureRequest, without_compiler: Callable[[], None]) -> None:
    """The test is run twice: compiled, and in CasADi's virtual machine."""
    if request.param == "interpreted":
        without_compiler()
    elif find_compiler() is None:
        pytest.skip("no C compiler here")


def plant() -> Plant:
    guide = GuideFriction.of(**GUIDE)
    return Plant("bench", BENCH, (guide, NutDrag.of(**DRAG), Payload.of(mass=5.0)))


def controller() -> SampledController:
    state, wanted, measured, tick, p = (ca.SX.sym(*s) for s in (("s", 0), ("w", 1), ("m", 2), ("k", 1), ("p", 2)))
    torque = p[1] * (p[0] * (wanted - measured[0]) / BENCH.radius - measured[1])
    function = ca.Function("proportional", [state, wanted, measured, tick, p], [state, torque, ca.SX.zeros(0, 1)])
    gains, read = np.array(list(GAINS.values())), ("table_position", "motor_speed")
    return SampledController(function, np.zeros(0), gains, SAMPLE, ("position",), read, ())


def wanted(count: int) -> np.ndarray:
    return 0.01 * (1 - np.cos(2 * np.pi * 8 * SAMPLE * np.arange(count)))


def by_hand(count: int, moved: str, shift: complex) -> np.ndarray:
    """Table position of the loop, a step a sample, one of the values times 1 + shift [m]."""

    def value(name: str, number: float) -> complex:
        return number * (1 + shift) if name == moved else number

    v = {key: value(key, number) for key, number in BENCH.values.items()}
    coulomb, width = value("guide_friction.coulomb", 60.0), value("guide_friction.smoothing_velocity", 5e-3)
    drag = value("nut_drag.coulomb", 0.25)
    mass = v["table_mass"] + value("payload.mass", 5.0)
    gains = [value(f"controller[{i}]", number) for i, number in enumerate(GAINS.values())]
    lag, r = value("torque_loop.lag", LAG), v["lead"] / (2 * np.pi)
    twist, stretch = np.array([1.0, -1.0, 0.0]), np.array([0.0, r, -1.0])
    inverse = np.diag([1 / v["motor_inertia"], 1 / v["screw_inertia"], 1 / mass])
    K = v["torsional_stiffness"] * np.outer(twist, twist) + v["axial_stiffness"] * np.outer(stretch, stretch)
    C = v["torsional_damping"] * np.outer(twist, twist) + v["axial_damping"] * np.outer(stretch, stretch)
    A = np.zeros((12, 12), dtype=complex)  # q, q', torque, command, then both forces and their slopes
    A[:3, 3:6], A[3:6, :3], A[3:6, 3:6] = np.eye(3), -inverse @ K, -inverse @ C
    A[3, 6], A[6, 6], A[6, 7] = inverse[0, 0], -1 / lag, 1 / lag
    A[4, 8], A[5, 9] = inverse[1, 1], inverse[2, 2]
    A *= SAMPLE
    A[8, 10] = A[9, 11] = 1.0
    maps = [expm(A / 3), expm(A)]

    def forces(rate: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        """Friction at screw and table, and its slopes."""
        t = np.tanh(np.array([rate[0] / DRAG["smoothing_speed"], rate[1] / width]))
        levels, widths = np.array([drag, coulomb]), np.array([DRAG["smoothing_speed"], width])
        viscous = np.array([0.0, GUIDE["viscous"]])
        return -levels * t - viscous * rate, -levels * (1 - t**2) / widths - viscous

    x, nodes, positions = np.zeros(7, dtype=complex), np.zeros(4, dtype=complex), []
    for target in wanted(count):
        positions.append(x[2])
        command = gains[1] * (gains[0] * (target - x[2]) / BENCH.radius - x[3])
        free = [m[:7, :7] @ x + m[:7, 7] * command for m in maps]
        on_first = [1.5 * m[:7, 8:10] - 1.5 * m[:7, 10:12] for m in maps]
        on_second = [1.5 * m[:7, 10:12] - 0.5 * m[:7, 8:10] for m in maps]
        for _ in range(12):  # Newton, far beyond what doubles resolve
            states = [free[i] + on_first[i] @ nodes[:2] + on_second[i] @ nodes[2:] for i in range(2)]
            found = [forces(s[4:6]) for s in states]
            jacobian = np.eye(4, dtype=complex)
            for i in range(2):
                slope = found[i][1][:, None]
                jacobian[2 * i : 2 * i + 2] -= np.hstack([slope * on_first[i][4:6], slope * on_second[i][4:6]])
            nodes = nodes - np.linalg.solve(jacobian, nodes - np.concatenate([found[0][0], found[1][0]]))
        x = free[1] + on_first[1] @ nodes[:2] + on_second[1] @ nodes[2:]
    return np.array(positions)


def size_of(name: str) -> float:
    sizes = {**BENCH.values, "payload.mass": 5.0, "torque_loop.lag": LAG, "nut_drag.coulomb": 0.25}
    sizes |= {f"guide_friction.{key}": number for key, number in GUIDE.items()}
    return float(sizes[name] if name in sizes else list(GAINS.values())[int(name[-2])])


@pytest.mark.usefixtures("both_ways")
def test_against_complex_steps_through_the_same_scheme() -> None:
    count, loop = 250, TorqueLoop(lag=LAG)
    found = simulate_sensitivity(
        plant(), controller(), wanted(count)[:, None], NAMES, torque_loop=loop, tolerance=np.inf
    )
    assert found.run.report.steps == count
    # rounding of spring forces, a step a sample; the scheme is the same
    assert np.abs(found.run.table_position - by_hand(count, "", 0.0).real).max() < 1e-13
    for name in NAMES:
        exact = by_hand(count, name, 1e-30j).imag / 1e-30 / size_of(name)
        error = np.abs(found.changes[name]["table_position"] - exact).max()
        # a damping of which all moves the table by 60 nm is felt to rounding, 1e-13 m as above
        CLAIMS["gradient.error"].check(max(error - 1e-13 / size_of(name), 0.0) / np.abs(exact).max())


@pytest.mark.usefixtures("both_ways")
def test_derivatives_with_step_control_and_bristle() -> None:
    """Steps of the run's own choice: differences agree as far as the choice does not change with the value."""
    bristle = Presliding.of(stiffness=5e6, damping=2e3, break_away=0.7)
    axis = Plant("bench", BENCH, (GuideFriction.of(**GUIDE), bristle))
    drive, reference, loop = controller(), wanted(200)[:, None], TorqueLoop(lag=LAG, dead_time=2e-4)
    found = simulate_sensitivity(axis, drive, reference, ["presliding.stiffness"], torque_loop=loop)
    positions = []
    for factor in (0.999, 1.001):
        effects = (axis.effects[0], bristle.with_values(stiffness=5e6 * factor))
        run = simulate_controlled(replace(axis, effects=effects), drive, reference, None, loop)
        positions.append(run.table_position)
    difference = (positions[1] - positions[0]) / (0.002 * 5e6)
    # second order of the difference, 1e-6, and 0.01 nm of step error over 1e4 N/m beside 1e-14 m/(N/m)
    assert (
        np.abs(found.changes["presliding.stiffness"]["table_position"] - difference).max()
        < 0.02 * np.abs(difference).max()
    )


@pytest.mark.parametrize(
    ("name", "words"), [("mass", "known are"), ("controller[2]", "count from 0 to 1"), ("torque_loop.lag", "lag of 0")]
)
def test_unknown_parameters_are_refused(name: str, words: str) -> None:
    with pytest.raises(InputError, match=words):
        simulate_sensitivity(plant(), controller(), wanted(10)[:, None], [name])


def test_compiled_and_interpreted_derivatives_agree(without_compiler: Callable[[], None]) -> None:
    """With a bristle, steps that are halved, and a torque that acts late: everything that a sample may hold."""
    if find_compiler() is None:
        pytest.skip("no C compiler here")
    bristle = Presliding.of(stiffness=5e8, damping=2e3, break_away=0.7)
    axis = Plant("bench", BENCH, (GuideFriction.of(**GUIDE), bristle, Payload.of(mass=5.0)))
    drive, reference, loop = controller(), wanted(150)[:, None], TorqueLoop(lag=LAG, dead_time=2e-4)
    names = (*(name for name in NAMES if name != "nut_drag.coulomb"), "presliding.stiffness")
    fast = simulate_sensitivity(axis, drive, reference, names, torque_loop=loop)
    without_compiler()
    slow = simulate_sensitivity(axis, drive, reference, names, torque_loop=loop)
    assert fast.run.report.refused > 0 and fast.run.report.steps == slow.run.report.steps
    for name in names:
        for series, change in fast.changes[name].items():
            # 8e-15 apart are the runs; a derivative with a stiff spring is the difference of terms 1e5 times as large
            assert np.abs(change - slow.changes[name][series]).max() <= 1e-9 * np.abs(change).max(), (name, series)
