"""Type names shared by the package."""

from __future__ import annotations

from typing import Any, TypeAlias

import numpy as np
from numpy.typing import NDArray

FloatArray: TypeAlias = NDArray[np.float64]
"""Array of SI values in double precision."""

ComplexArray: TypeAlias = NDArray[np.complex128]
"""Array of complex values, such as a frequency response."""

BoolArray: TypeAlias = NDArray[np.bool_]
"""Mask over samples."""

IntegerArray: TypeAlias = NDArray[np.int64]
"""Indices over samples."""

Expression: TypeAlias = Any
"""A CasADi SX or MX expression, or a number; casadi ships no type information."""
