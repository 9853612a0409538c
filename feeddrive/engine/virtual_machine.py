"""A CasADi function called on arrays, without CasADi's own conversions: they take longer than a step."""

from __future__ import annotations

import casadi as ca
import numpy as np

from feeddrive.typing import Expression, FloatArray


class Called:
    """A function whose arguments and results are columns, or matrices written as one row per column.

    May be called by several threads at once: every call has buffers to itself, which later calls use again.
    """

    def __init__(self, function: ca.Function) -> None:
        self._function = function
        self._idle = [_Buffers(function)]

    def __call__(self, *arguments: Expression) -> list[FloatArray]:
        """Results, one row per column; a single column is given as shape (n,)."""
        try:
            buffers = self._idle.pop()  # no other thread gets the same: a list gives an item to one alone
        except IndexError:
            buffers = _Buffers(self._function)
        try:
            return buffers.results(arguments)
        finally:
            self._idle.append(buffers)


class _Buffers:
    """Room for the arguments and results of one call, and for what CasADi needs in between."""

    def __init__(self, function: ca.Function) -> None:
        self._buffer, self._evaluate = function.buffer()
        self._given = [np.zeros(function.numel_in(i)) for i in range(function.n_in())]
        self._results = [np.zeros((function.size2_out(i), function.size1_out(i))) for i in range(function.n_out())]
        for i, array in enumerate(self._given):
            self._buffer.set_arg(i, array.data)  # type: ignore[call-arg]  # the stub is that of the C++ method
        for i, result in enumerate(self._results):
            self._buffer.set_res(i, result.data)  # type: ignore[call-arg]

    def results(self, arguments: tuple[Expression, ...]) -> list[FloatArray]:
        for array, argument in zip(self._given, arguments, strict=True):
            array[:] = argument if np.ndim(argument) < 2 else np.ravel(argument)
        self._evaluate()
        return [result[0].copy() if len(result) == 1 else result.copy() for result in self._results]
