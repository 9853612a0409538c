"""One thread at a time makes equations; while a compiler runs another may."""

from __future__ import annotations

import threading
from concurrent.futures import ThreadPoolExecutor

from feeddrive.effects.base import Effect
from feeddrive.effects.constant_force import ConstantForce
from feeddrive.effects.payload import Payload
from feeddrive.effects.position_spring import PositionSpring
from feeddrive.plant.ode import ode
from feeddrive.plant.plant import Plant
from feeddrive.plant.structure import forget_machines
from feeddrive.plant.symbolic_turn import SymbolicTurn
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


def test_equations_made_by_two_threads_at_once() -> None:
    spring = PositionSpring.of(stiffness=100.0, zero=0.1)
    effects: list[Effect] = [Payload.of(mass=1.0), ConstantForce.of(force=1.0), spring]
    plants = [Plant("axis", BENCH, tuple(effects[:k] + effects[j:])) for k in range(3) for j in range(k, 3)]
    forget_machines()
    with ThreadPoolExecutor(2) as pool:
        made = list(pool.map(lambda plant: ode(plant).size1_in("x"), plants))
    assert len(made) == len(plants) and len(set(made)) == 1
