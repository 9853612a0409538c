"""Runs in two threads at once are those of one after the other, compiled and in CasADi's virtual machine."""

from __future__ import annotations

import sys
import threading
from collections.abc import Callable, Iterator
from concurrent.futures import ThreadPoolExecutor
from typing import Any

import casadi as ca
import numpy as np
import pytest

from feeddrive.compiler import find_compiler
from feeddrive.effects.chain.payload import Payload
from feeddrive.effects.friction.presliding import Presliding
from feeddrive.engine.virtual_machine import Called
from feeddrive.plant.structure import forget_machines
from feeddrive.servo.cascade import Cascade
from feeddrive.servo.cascade_function import cascade_controller
from feeddrive.simulate.controlled.controlled import TorqueLoop, simulate_controlled
from feeddrive.simulate.controlled.sensitivity import simulate_sensitivity
from feeddrive.simulate.driven import motor_motion, simulate_driven
from feeddrive.simulate.held_torque import simulate_torque
from feeddrive.typing import FloatArray
from tests.convergence.test_simulate import SAMPLE, bench, torque_curve

PLANT = bench(Presliding.of(stiffness=6e8, damping=2e3, break_away=0.9), Payload.of(mass=2.0))
TIME = np.arange(300) * SAMPLE
CASCADE = Cascade(PLANT.chain.motor_radius, SAMPLE, 2, 10.0, 1.0, 0.1, 0.1, current_lag=2e-4)
PLACE = 1e-3 * (1 - np.cos(50 * TIME[:100]))
REFERENCE = np.column_stack([PLACE, np.gradient(PLACE, SAMPLE), *np.zeros((3, 100))])


def driven(scale: float) -> FloatArray:
    run = simulate_driven(PLANT, motor_motion(TIME, scale * np.sin(60 * TIME)))
    return np.concatenate([run.table_position, run.torque])


def pushed(scale: float) -> FloatArray:
    time, torque = torque_curve(150)
    return simulate_torque(PLANT, time, scale * torque).position


def controlled(scale: float) -> FloatArray:
    run = simulate_controlled(PLANT, cascade_controller(CASCADE), scale * REFERENCE, None, TorqueLoop(2e-4))
    return np.concatenate([run.table_position, run.torque])


def differentiated(scale: float) -> FloatArray:
    names = ("table_mass", "guide_friction.coulomb")
    found = simulate_sensitivity(
        PLANT, cascade_controller(CASCADE), scale * REFERENCE, names, torque_loop=TorqueLoop(2e-4)
    )
    return np.concatenate([change["table_position"] for change in found.changes.values()])


RUNS: dict[str, Callable[[float], FloatArray]] = {
    "driven": driven,
    "pushed": pushed,
    "controlled": controlled,
    "differentiated": differentiated,
}


@pytest.fixture
def threads_change_often() -> Iterator[None]:
    """Python hands over to another thread as often as it can; otherwise a run is done before the other begins."""
    before = sys.getswitchinterval()
    sys.setswitchinterval(1e-6)
    yield
    sys.setswitchinterval(before)


@pytest.mark.usefixtures("threads_change_often")
@pytest.mark.parametrize("way", ["compiled", "interpreted"])
@pytest.mark.parametrize("kind", RUNS)
def test_runs_of_one_structure_at_once(kind: str, way: str, without_compiler: Callable[[], None]) -> None:
    """Machines are made while both ask for them, then shared; not a bit of the results may differ."""
    if way == "interpreted":
        without_compiler()
    elif find_compiler() is None:
        pytest.skip("no C compiler here")
    run, scales = RUNS[kind], (0.3, 0.5, 0.7, 0.9)
    alone = [run(scale) for scale in scales]
    for _ in range(3):
        forget_machines()
        with ThreadPoolExecutor(2) as pool:
            together = list(pool.map(run, scales))
        for one, other in zip(alone, together, strict=True):
            assert np.array_equal(one, other)


class Waiting:
    """A number that is told only after somebody else has called the function."""

    ndim = 0

    def __init__(self, value: float, reached: threading.Event, go_on: threading.Event) -> None:
        self.value, self.reached, self.go_on = value, reached, go_on

    def __array__(self, dtype: Any = None, copy: bool | None = None) -> FloatArray:
        self.reached.set()
        assert self.go_on.wait(10.0)
        return np.array(self.value)


def test_a_call_within_another() -> None:
    """The second call comes when the first has laid down half its arguments: it must not overwrite them."""
    x, y = ca.SX.sym("x"), ca.SX.sym("y")
    added = Called(ca.Function("added", [x, y], [x + y]))
    reached, go_on = threading.Event(), threading.Event()
    with ThreadPoolExecutor(1) as pool:
        first = pool.submit(added, 1.0, Waiting(2.0, reached, go_on))
        assert reached.wait(10.0)
        assert added(10.0, 20.0)[0].item() == 30.0
        go_on.set()
        assert first.result()[0].item() == 3.0
