"""The fuzz harness sees every way in which a command can break its promise."""

from __future__ import annotations

from tests.analytic.fuzz_culprits import CULPRITS
from tests.fuzz.harness import generator_of, run_cases

MODULE = "tests.analytic.fuzz_culprits"

SAID = {
    "answers": "",
    "refuses": "",
    "hangs": "no answer within 1 s",
    "waits": "no answer within 1 s",
    "dies": "the process died with 9",
    "raises": "ZeroDivisionError",
    "exits": "status 1",
    "swallows": "memory grew",
    "wants_all": "MemoryError",
    "warns": "RuntimeWarning",
    "two_lines": "2 lines",
    "hidden": "0x1b",
    "long": "300007 letters",
    "other_status": "status 1",
}


def test_every_broken_promise_is_seen() -> None:
    numbers: dict[str, int] = {}
    for number in range(1000):
        numbers.setdefault(generator_of(MODULE, 4, number).choice(list(CULPRITS)), number)
    assert set(numbers) == set(SAID)
    seen = {outcome.what: outcome for outcome in run_cases(MODULE, 4, sorted(numbers.values()))}
    for name, said in SAID.items():
        assert said in seen[name].fault, name
        assert bool(seen[name].fault) == bool(said), name
    assert seen["refuses"].line == "error: a.csv: no number; write one\n"


def test_a_case_comes_again_by_seed_and_number() -> None:
    first = [generator_of(MODULE, 4, number).random() for number in range(3)]
    assert len(set(first)) == 3
    assert first == [generator_of(MODULE, 4, number).random() for number in range(3)]
