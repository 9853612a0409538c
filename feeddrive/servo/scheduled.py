"""A controller whose parameters follow the table position: linear between designs made at some positions.

p(x) = p_i + (p_(i+1) - p_i) (x - x_i) / (x_(i+1) - x_i),   constant beyond the ends
"""

from __future__ import annotations

from collections.abc import Sequence

import casadi as ca
import numpy as np

from feeddrive.errors import InputError
from feeddrive.servo.sampled_plant import SampledController
from feeddrive.symbolic_turn import SYMBOLS
from feeddrive.typing import FloatArray

_PLACE = "table_position"


@SYMBOLS.taken()
def scheduled(positions: FloatArray, designs: Sequence[SampledController]) -> SampledController:
    """One controller out of k designs, 2 or more, at ascending positions of the table [m], (k,).

    Designs differ in parameters alone and read the table position. Their margins hold while the table moves slowly:
    parameters that change as fast as the loop are another system. Raises InputError: designs of other equations,
    positions that do not ascend, no table position to read, a limit that is infinite in some of them alone.
    """
    places, first = np.asarray(positions, dtype=float), designs[0]
    if len(places) != len(designs) or len(places) < 2 or not (np.diff(places) > 0).all():
        raise InputError("designs need ascending positions, two or more", "schedule", "give one position for each")
    if any(design.function is not first.function or design.sample_time != first.sample_time for design in designs):
        raise InputError("designs of different equations", "schedule", "let them differ in gains alone")
    if _PLACE not in first.measurements:
        raise InputError("the designs do not read the table position", "schedule", "use feedback from the table")
    settings = np.array([design.parameters for design in designs])
    if not (np.isfinite(settings).all(axis=0) | (settings == settings[0]).all(axis=0)).all():
        raise InputError("a limit is infinite in some designs alone", "schedule", "give the limit in every design")
    names = [first.function.name_in(i) for i in range(5)]
    count = first.function.size1_in(4)
    arguments = [ca.SX.sym(name, first.function.size1_in(i)) for i, name in enumerate(names[:4])]
    table = ca.SX.sym("parameters", len(places) * (count + 1))
    place = arguments[2][first.measurements.index(_PLACE)]
    results = first.function(*arguments, _between(place, table, len(places), count))
    shown = [first.function.name_out(i) for i in range(3)]
    function = ca.Function("scheduled", [*arguments, table], list(results), names, shown)
    parameters = np.concatenate([places, *(design.parameters for design in designs)])
    return SampledController(
        function, first.initial, parameters, first.sample_time, first.references, first.measurements, first.signals
    )


def _between(place: ca.SX, table: ca.SX, designs: int, count: int) -> ca.SX:
    """Parameters at a place: those of the first design and the share of every step towards the next."""
    values = table[designs : designs + count]
    for i in range(designs - 1):
        share = (place - table[i]) / (table[i + 1] - table[i])
        start, end = (table[designs + j * count : designs + (j + 1) * count] for j in (i, i + 1))
        step = ca.if_else(end == start, 0.0, end - start)  # limits that are infinite in both have no difference
        values = values + ca.fmin(ca.fmax(share, 0.0), 1.0) * step
    return values
