"""One thread at a time makes equations; while a compiler runs another may."""

from __future__ import annotations

import threading
import traceback
from collections.abc import Callable
from concurrent.futures import ThreadPoolExecutor
from dataclasses import replace
from typing import Any

import casadi as ca
import numpy as np
import pytest

from feeddrive.effects.chain.payload import Payload
from feeddrive.effects.friction.guide_friction import GuideFriction
from feeddrive.effects.friction.presliding import Presliding
from feeddrive.export.c_source import source_text
from feeddrive.export.casadi_file import casadi_function
from feeddrive.export.fmu_description import description_text
from feeddrive.export.nonlinear_model import model_of
from feeddrive.export.notes import changes_with_time
from feeddrive.export.point import export_point
from feeddrive.files import shipped_scenarios
from feeddrive.plant.analysis.linear import linear_matrices
from feeddrive.plant.analysis.ode import ode
from feeddrive.plant.analysis.steady import steady_motion
from feeddrive.plant.plant import Plant, PositionVelocityController
from feeddrive.plant.structure import forget_machines
from feeddrive.servo import cascade_function
from feeddrive.servo.cascade import Cascade, Feedback
from feeddrive.servo.cascade_function import cascade_controller
from feeddrive.servo.linear_loop import open_velocity_loop, refuse_unstable
from feeddrive.servo.sampled_plant import SampledController, sampled_plant
from feeddrive.servo.scheduled import scheduled
from feeddrive.servo.state_feedback import state_feedback
from feeddrive.simulate.controlled import controlled_machine, declared_loop
from feeddrive.simulate.controlled.controlled import TorqueLoop, simulate_controlled
from feeddrive.simulate.controlled.declared_loop import position_velocity_controller
from feeddrive.simulate.controlled.sensitivity import simulate_sensitivity
from feeddrive.simulate.driven import motor_motion, simulate_driven
from feeddrive.simulate.held_torque import simulate_torque
from feeddrive.simulate.scenario.scenario_file import read_scenario
from feeddrive.simulate.scenario.scenario_run import run_scenario
from feeddrive.symbolic_turn import SYMBOLS, SymbolicTurn
from tests.convergence.test_simulate import BENCH


def test_turn_is_had_by_one_and_may_be_taken_again() -> None:
    turn, inside, most = SymbolicTurn(), 0, 0

    def work(_: int) -> None:
        nonlocal inside, most
        with turn.taken(), turn.taken():
            inside += 1
            most = max(most, inside)
            threading.Event().wait(1e-3)
            inside -= 1

    with ThreadPoolExecutor(4) as pool:
        list(pool.map(work, range(20)))
    assert most == 1


def test_turn_laid_down_is_free_for_another_and_comes_back() -> None:
    turn, had = SymbolicTurn(), threading.Event()

    def other() -> None:
        with turn.taken():
            had.set()

    with turn.taken(), turn.taken():
        thread = threading.Thread(target=other)
        thread.start()
        assert not had.wait(0.05)  # not while it is held
        with turn.laid_down():
            assert had.wait(5.0)
        thread.join()
        third = threading.Thread(target=other)
        had.clear()
        third.start()
        assert not had.wait(0.05)  # it is held again, at both depths
    third.join(5.0)
    assert had.is_set()
    with turn.laid_down():  # by who does not hold it: nothing
        pass


TIME = np.arange(60) * 1e-3
REFERENCE = np.zeros((20, 5))


def axis() -> Plant:
    """An elastic chain with friction, a bristle and a chain effect: every kind of equation but a travel error's."""
    effects = (
        GuideFriction.of(coulomb=60.0, smoothing_velocity=5e-3, viscous=300.0),
        Presliding.of(stiffness=5e6, damping=2e3, break_away=0.7),
        Payload.of(mass=1.0),
    )
    return Plant("axis", BENCH, effects, torque_limit=30.0)


def cascade(feedback: Feedback = Feedback.MOTOR) -> Cascade:
    return Cascade(BENCH.radius, 1e-3, 2, 10.0, 1.0, 0.1, 0.1, feedback=feedback, current_lag=2e-4)


def feedback_design(plant: Plant) -> SampledController:
    machine = sampled_plant(plant, cascade())
    return state_feedback(machine, 1e-3, np.zeros(len(machine.a)), np.zeros((len(machine.a) + 1, 2)))


def exported(plant: Plant) -> None:
    model = model_of(plant, export_point(plant))
    casadi_function(model), source_text(model), description_text(model, "0", (), 0), changes_with_time(plant)


def scenario(plant: Plant) -> None:
    (path,) = (path for path in shipped_scenarios() if path.stem == "step_velocity")
    run_scenario(replace(read_scenario(path), plant=plant, ticks=50))


WORK: dict[str, Callable[[Plant], object]] = {
    "equations": ode,
    "steady motion": steady_motion,
    "linear plant": linear_matrices,
    "driven run": lambda plant: simulate_driven(plant, motor_motion(TIME, 0.3 * np.sin(60 * TIME))),
    "torque run": lambda plant: simulate_torque(plant, TIME, np.sin(60 * TIME)),
    "stability": lambda plant: refuse_unstable(plant, cascade(), "", 0.0),
    "open loop": lambda plant: open_velocity_loop(plant, cascade()),
    "controlled run": lambda plant: simulate_controlled(plant, cascade_controller(cascade()), REFERENCE),
    "sensitivity": lambda plant: simulate_sensitivity(
        plant, cascade_controller(cascade()), REFERENCE, ("table_mass",), torque_loop=TorqueLoop(2e-4)
    ),
    "scenario": scenario,
    "declared controller": lambda plant: position_velocity_controller(
        plant, PositionVelocityController(160.0, 243.0, 10.0, 0.1), 1e-3
    ),
    "state feedback": feedback_design,
    "schedule": lambda plant: scheduled(np.array([0.0, 0.1]), [cascade_controller(cascade(Feedback.TABLE))] * 2),
    "exported functions": exported,
}


def watched(made: Any, name: str, out_of_turn: list[str]) -> Any:
    """A maker of expressions that notes when the one who calls it does not hold the turn."""
    inner = getattr(made, name)

    def noting(*given: Any, **named: Any) -> Any:
        if not SYMBOLS.mine:
            out_of_turn.append(f"{made.__name__}.{name} in {traceback.extract_stack()[-2].name}")
        return inner(*given, **named)

    return noting if name.startswith("__") or made is ca.Function else staticmethod(noting)


@pytest.mark.parametrize("way", ["compiled", "interpreted"])
@pytest.mark.parametrize("work", WORK)
def test_no_expression_is_made_out_of_turn(
    work: str, way: str, monkeypatch: pytest.MonkeyPatch, without_compiler: Callable[[], None]
) -> None:
    """In a thread of a pool, with nothing made before: whoever makes symbols or functions holds the turn."""
    if way == "interpreted":
        without_compiler()
    forget_machines()
    for kept in (cascade_function._function, declared_loop._function, controlled_machine._written):
        kept.cache_clear()
    out_of_turn: list[str] = []
    for made, name in ((ca.SX, "sym"), (ca.MX, "sym"), (ca.Function, "__init__"), (ca.Function, "map")):
        monkeypatch.setattr(made, name, watched(made, name, out_of_turn))
    with ThreadPoolExecutor(1) as pool:
        pool.submit(WORK[work], axis()).result()
    assert out_of_turn == []


def test_the_watch_sees_who_is_out_of_turn(monkeypatch: pytest.MonkeyPatch) -> None:
    out_of_turn: list[str] = []
    monkeypatch.setattr(ca.SX, "sym", watched(ca.SX, "sym", out_of_turn))
    with SYMBOLS.taken():
        ca.SX.sym("x")
    assert not out_of_turn
    ca.SX.sym("x")
    assert out_of_turn == ["SX.sym in test_the_watch_sees_who_is_out_of_turn"]
