"""A CasADi function called on arrays that stay where they are: a call from Python costs a microsecond, not fifty."""

from __future__ import annotations

from collections.abc import Mapping, Sequence

import casadi as ca

from feeddrive.typing import Expression, FloatArray


class BoundFunction:
    """A function with its arguments and results at fixed places; of one thread, and kept with its arrays."""

    def __init__(
        self, function: ca.Function, arguments: Sequence[FloatArray], results: Mapping[int, FloatArray]
    ) -> None:
        self._buffer, self._call = function.buffer()
        self._kept = (function, tuple(arguments), dict(results))  # the buffer holds addresses alone
        buffer: Expression = self._buffer
        for i, array in enumerate(arguments):
            buffer.set_arg(i, memoryview(array.data))
        for i, array in results.items():
            buffer.set_res(i, memoryview(array.data))

    def __call__(self) -> None:
        """Evaluate: reads the arguments where they are, writes the results."""
        self._call()
