"""What a reduction costs: the largest error of each output after a step of each input, and over frequency.

And the smallest system at one operating point: two-sided balancing, against which the common basis is judged.
"""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np
import scipy.linalg

from feeddrive.thermal.reduced.reduction import Sizes, balance, compressed
from feeddrive.thermal.reduced.system import HeatSystem
from feeddrive.typing import FloatArray

FREQUENCIES = np.logspace(-6, 0, 37)
"""At which the transfer functions are compared [Hz]: from a fortnight to a second."""


@dataclass(frozen=True, eq=False)
class ReductionError:
    """Errors with every input at its working size.

    Attributes:
        order: of the reduced system.
        input_names, output_names: m and p names.
        steps: largest error after a step, (p, m) [K, m].
        frequencies: largest error of the transfer function times the input's size, (p, m) [K, m].
    """

    order: int
    input_names: tuple[str, ...]
    output_names: tuple[str, ...]
    steps: FloatArray
    frequencies: FloatArray

    def largest(self, *, growth: bool, inputs: tuple[str, ...] | None = None) -> float:
        """Largest step error of the temperatures [K], or of the growths [m], over some inputs (None for all)."""
        rows = [name.startswith("growth") == growth for name in self.output_names]
        columns = [inputs is None or name in inputs for name in self.input_names]
        return float(self.steps[np.ix_(rows, columns)].max())

    def text(self) -> str:
        """The table as people read it: mK and nm."""
        head = f"order {self.order}; largest error after a step | over frequency, in mK (growth: nm)"
        width = max(map(len, self.output_names))
        lines = [head, " " * width + "".join(f"{name:>18}" for name in self.input_names)]
        for i, name in enumerate(self.output_names):
            scale = 1e9 if name.startswith("growth") else 1e3
            cells = zip(self.steps[i] * scale, self.frequencies[i] * scale, strict=True)
            lines.append(f"{name:<{width}}" + "".join(f"{a:>9.3g}|{b:<8.3g}" for a, b in cells))
        return "\n".join(lines)


def reduction_error(
    full: HeatSystem, reduced: HeatSystem, sizes: Sizes | None = None, duration: float = 12 * 3600.0
) -> ReductionError:
    """Compare a reduced system with the full one at the same operating point.

    Args:
        full: K symmetric; it is made dense, so take the default grid.
        reduced: of the same inputs and outputs.
        sizes: working sizes.
        duration: up to which steps are followed [s].
    """
    scale = (sizes or Sizes()).of_inputs(full.input_names)
    times = np.concatenate([[0.0], np.geomspace(0.5, duration, 240)])
    steps = np.abs(exact_steps(full, times) - exact_steps(reduced, times)).max(axis=0)
    answers = np.abs(full.frequency_response(FREQUENCIES) - reduced.frequency_response(FREQUENCIES)).max(axis=0)
    return ReductionError(reduced.order, full.input_names, full.output_names, steps * scale, answers * scale)


def exact_steps(system: HeatSystem, times: FloatArray) -> FloatArray:
    """Outputs at times (k,) after unit steps of each input at rest, exact by its modes, (k, p, m)."""
    dense = system.conductance.toarray() if system.is_sparse else system.conductance
    if np.allclose(dense, dense.T, rtol=0, atol=1e-12 * float(np.abs(dense).max())):
        root = 1 / np.sqrt(system.capacity)[:, None]
        rates, vectors = np.linalg.eigh(root * dense * root.T)
        seen, driven = system.rows @ (root * vectors), (root * vectors).T @ system.gains
    else:
        rates, vectors = scipy.linalg.eig(dense / system.capacity[:, None])
        seen, driven = system.rows @ vectors, np.linalg.solve(vectors, system.gains / system.capacity[:, None])
    grown = -np.expm1(-np.multiply.outer(times, rates)) / rates
    return np.asarray(np.einsum("pn,kn,nm->kpm", seen, grown, driven).real)


def reduced_system(system: HeatSystem, order: int, sizes: Sizes | None = None) -> HeatSystem:
    """A system at one operating point, balanced to `order` states.

    Args:
        system: full, or dense with every C one.
        order: number of states.
        sizes: working sizes.

    Raises:
        InputError: an order that is not possible.
    """
    sizes = sizes or Sizes()
    small = compressed(system, sizes) if system.is_sparse else system
    return truncated(small, order, sizes.of_inputs(small.input_names), sizes.of_outputs(small.output_names))


def truncated(system: HeatSystem, order: int, input_sizes: FloatArray, output_sizes: FloatArray) -> HeatSystem:
    """The system on its strongest balanced states; args and errors as `balance`."""
    found = balance(system, order, input_sizes, output_sizes)
    return replace(
        system,
        capacity=np.ones(order),
        conductance=found.left.T @ system.conductance @ found.right,
        gains=found.left.T @ system.gains,
        rows=system.rows @ found.right,
    )
