"""What a scenario may ask for: kinds of figures and their settings; `metrology.evaluate` works them out.

[[evaluate]] kind =
  following       start, end                    following error in a stretch of time
  settling        window                        at every stop of the set-point
  positioning     average                       ISO 230-2; mean over the last `average` of each dwell
  circular                                      ISO 230-4 of one axis, quadrant glitches
  friction_map    skip                          mean torque at each constant velocity, the first `skip` left out
  force_loop      start, period                 stiffness and lost motion of one loading cycle
  step            channel, at                   rise, overshoot, settling
  response        input, output, segment, start frequency response by averaged spectra
"""

from __future__ import annotations

from feeddrive.errors import InputError
from feeddrive.plant.file.entries import Table
from feeddrive.simulate.scenario.scenario import Evaluation
from feeddrive.simulate.scenario.scenario_result import SERIES

_WORD = "word"
KINDS: dict[str, dict[str, str]] = {
    "following": {"start": "s", "end": "s"},
    "settling": {"window": "m"},
    "positioning": {"average": "s"},
    "circular": {},
    "friction_map": {"skip": "s"},
    "force_loop": {"start": "s", "period": "s"},
    "torque_loop": {"start": "s", "period": "s"},
    "step": {"channel": _WORD, "at": "s"},
    "response": {"input": _WORD, "output": _WORD, "segment": "s", "start": "s"},
}
"""Kind to its settings: key to SI unit, or a word for one of `SERIES`."""

_MAY_BE_LEFT_OUT = {("following", "start"), ("following", "end"), ("friction_map", "skip"), ("response", "start")}


def read_evaluations(tables: list[Table]) -> tuple[Evaluation, ...]:
    """The figures of the tables [[evaluate]].

    Raises:
        InputError: unknown kind, key or series, or a value that is missing.
    """
    return tuple(_evaluation(table) for table in tables)


def _evaluation(table: Table) -> Evaluation:
    kind = table.choice("kind", KINDS)
    keys = KINDS[kind]
    table = table.of_kind(kind)
    table.refuse_undeclared()
    settings: dict[str, float | str] = {}
    for key, unit in keys.items():
        if key not in table.entries and (kind, key) in _MAY_BE_LEFT_OUT:
            continue
        settings[key] = table.choice(key, SERIES) if unit == _WORD else table.quantity(key, unit, key)
    for key, value in settings.items():
        if isinstance(value, float) and value < 0:
            raise InputError("is negative", table.place(key), "write zero or more")
    return Evaluation(kind, settings)
