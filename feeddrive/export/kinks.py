"""Where the equations of motion have kinks, so that a solver can stop there: event indicators and held branches.

Every kink of the generated equations comes from |a|, sign a, min(a, b), max(a, b) or a comparison: the flanks of a free
play, the break-away of a bristle, the direction of a motion, the points of a table, the top of a drooping torque. The
equations are walked once; each such operation gives an indicator g = a, or a - b, and in its place stands the branch of

    m = 1 where g > 0, else 0:     |a| = (2 m - 1) a,   sign a = 2 m - 1,   max(a, b) = b + m (a - b),   (a > b) = m

With m held between events the equations are smooth, whatever a solver tries beyond the kink. An indicator changes sign
a little late, by `HYSTERESIS` of what a typical motion changes it, so that a state found at an event is beyond it.
"""

from __future__ import annotations

from dataclasses import dataclass

import casadi as ca
import numpy as np

from feeddrive.export.nonlinear_model import Model, nominals
from feeddrive.symbolic_turn import SYMBOLS
from feeddrive.typing import Expression, FloatArray

HYSTERESIS = 1e-8
"""Hysteresis of an indicator over its change with the nominal change of the states: 0.01 pm, far above rounding."""

_LEAST = 1e-14
"""Least hysteresis, of an indicator that states do not change at the start; against 0."""


@dataclass(frozen=True)
class Kinks:
    """The equations with their branches held.

    Attributes:
        held: (time, x, u, p, m) -> (xdot, y), SI columns.
        indicators: (time, x, u, p) -> g, shape (k, 1); above 0 where m is 1.
        hysteresis: by which each indicator passes 0 before m changes, shape (k,).
    """

    held: ca.Function
    indicators: ca.Function
    hysteresis: FloatArray

    @property
    def count(self) -> int:
        """Number of indicators k."""
        return len(self.hysteresis)


@SYMBOLS.taken()
def kinks_of(model: Model) -> Kinks:
    """The kinks of a model that states, inputs or time can pass; those that values alone decide stay as they are."""
    function = model.function
    arguments = [ca.SX.sym(name, function.size1_in(name)) for name in function.name_in()]
    walk = _Walk(function, arguments)
    branches = ca.vertcat(*walk.branches) if walk.branches else ca.SX.sym("m", 0)
    held = ca.Function("held", [*arguments, branches], walk.results, [*function.name_in(), "m"], function.name_out())
    column = ca.vertcat(*walk.indicators) if walk.indicators else ca.SX(0, 1)
    indicators = ca.Function("indicators", arguments, [ca.densify(column)], function.name_in(), ["g"])
    return Kinks(held, indicators, _hysteresis(model, indicators))


def _hysteresis(model: Model, indicators: ca.Function) -> FloatArray:
    """By how much each indicator has to pass 0, from its slopes at the start and beside it."""
    size = nominals(model)
    arguments = [ca.SX.sym(name, indicators.size1_in(name)) for name in indicators.name_in()]
    slopes = ca.Function("slopes", arguments, [ca.jacobian(indicators(*arguments), arguments[1])])
    start = np.array([row.value for row in model.states])
    given = [row.value for row in model.inputs], [row.value for row in model.parameters]
    beside = (start, start + size, start - size)
    changes = [np.abs(np.array(slopes(0.0, x, *given))) @ size for x in beside]
    hysteresis: FloatArray = HYSTERESIS * np.max(changes, axis=0) + _LEAST
    return hysteresis


class _Walk:
    """A generated function written anew, once as it is and once with its branches held."""

    def __init__(self, function: ca.Function, arguments: list[Expression]) -> None:
        self.branches: list[Expression] = []
        self.indicators: list[Expression] = []
        self._moving = ca.vertcat(*arguments[:3])
        self._work: dict[int, tuple[Expression, Expression]] = {}
        self.results = [ca.SX.zeros(*function.size_out(i)) for i in range(function.n_out())]
        nonzeros = [ca.SX.zeros(function.nnz_out(i), 1) for i in range(function.n_out())]
        for k in range(function.n_instructions()):
            code, inner, outer = (
                function.instruction_id(k), function.instruction_input(k), function.instruction_output(k)
            )  # fmt: skip
            if code == ca.OP_OUTPUT:
                nonzeros[outer[0]][outer[1]] = self._work[inner[0]][1]
            elif code == ca.OP_INPUT:
                self._work[outer[0]] = (arguments[inner[0]][inner[1]],) * 2
            elif code == ca.OP_CONST:
                self._work[outer[0]] = (ca.SX(function.instruction_constant(k)),) * 2
            else:
                self._work[outer[0]] = self._operation(code, [self._work[i] for i in inner])
        self.results = [ca.densify(ca.SX(function.sparsity_out(i), rows)) for i, rows in enumerate(nonzeros)]

    def _operation(self, code: int, given: list[tuple[Expression, Expression]]) -> tuple[Expression, Expression]:
        """The operation on what is true, and on what is held."""
        true, held = [one for one, _ in given], [other for _, other in given]
        if len(given) == 1:
            whole = ca.SX.unary(code, true[0])
            branch = self._branch(true[0]) if code in (ca.OP_FABS, ca.OP_SIGN) else None
            if branch is None:
                return whole, ca.SX.unary(code, held[0])
            side = 2 * branch - 1
            return whole, side * held[0] if code == ca.OP_FABS else side
        whole = ca.SX.binary(code, *true)
        apart = {ca.OP_FMAX: 1, ca.OP_FMIN: 1, ca.OP_LT: -1, ca.OP_LE: -1}.get(code)
        branch = None if apart is None else self._branch(apart * (true[0] - true[1]))
        if branch is None:
            return whole, ca.SX.binary(code, *held)
        if code in (ca.OP_LT, ca.OP_LE):
            return whole, branch
        greater, lesser = (held[0], held[1]) if code == ca.OP_FMAX else (held[1], held[0])
        return whole, ca.if_else(branch, greater, lesser)

    def _branch(self, indicator: Expression) -> Expression | None:
        """The held branch of an indicator; None where neither state, input nor time changes it."""
        if not ca.depends_on(indicator, self._moving):
            return None
        for known, branch in zip(self.indicators, self.branches, strict=True):
            if ca.is_equal(known, indicator, _DEPTH):
                return branch
        branch = ca.SX.sym(f"m{len(self.branches)}")
        self.indicators.append(indicator)
        self.branches.append(branch)
        return branch


_DEPTH = 12
"""To which two indicators are compared; deeper, equal ones may count twice, which does no harm."""
