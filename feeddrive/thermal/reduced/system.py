"""A linear heat system at fixed conductances, full or reduced, with the methods of both.

    C dθ/dt = -K θ + B u,    y = L θ

Sparse systems are stepped by an L-stable scheme of second order, dense ones exactly (`stepping`).
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
import scipy.linalg
import scipy.sparse as sparse
import scipy.sparse.linalg

from feeddrive.errors import InputError
from feeddrive.thermal.reduced.heat_propagators import held_states
from feeddrive.thermal.reduced.stepping import Stepper, stepper_of
from feeddrive.typing import Expression, FloatArray


@dataclass(frozen=True, eq=False)
class HeatSystem:
    """n states, m inputs, p outputs.

    Attributes:
        capacity: C, (n,) [J/K]; ones in a reduced system.
        conductance: K, (n, n), sparse or dense [W/K].
        gains: B, (n, m).
        rows: L, (p, n).
        input_names: m names: heats [W], temperatures of the surroundings [K].
        output_names: p names: rises [K], growths [m].
    """

    capacity: FloatArray
    conductance: Expression
    gains: FloatArray
    rows: FloatArray
    input_names: tuple[str, ...]
    output_names: tuple[str, ...]

    @property
    def order(self) -> int:
        """Number of states."""
        return len(self.capacity)

    @property
    def is_sparse(self) -> bool:
        """Whether it is the full system."""
        return bool(sparse.issparse(self.conductance))

    def column(self, name: str) -> int:
        """Index of an input.

        Raises:
            InputError: no such input.
        """
        return _index(name, self.input_names, "input")

    def row(self, name: str) -> int:
        """Index of an output.

        Raises:
            InputError: no such output.
        """
        return _index(name, self.output_names, "output")

    def poles(self, count: int = 6) -> FloatArray:
        """The slowest poles, real and negative, slowest first, (count,) [1/s]."""
        if self.is_sparse:
            mass = sparse.diags_array(self.capacity).tocsc()
            found = scipy.sparse.linalg.eigs(
                self.conductance.tocsc(), k=count, M=mass, sigma=0.0, which="LM", return_eigenvectors=False
            )
        else:
            found = scipy.linalg.eigvals(self.conductance / self.capacity[:, None])
        return -np.sort(found.real)[:count]

    def steady(self, inputs: FloatArray) -> FloatArray:
        """States at which the system settles under constant inputs, (m,) -> (n,).

        Raises:
            InputError: nothing leads heat away, so that there is no such state.
        """
        self._refuse_adiabatic()
        return _solve(self.conductance, self.gains @ inputs)

    def gain(self) -> FloatArray:
        """Steady outputs per unit of each input, (p, m).

        Raises:
            InputError: as `steady`.
        """
        self._refuse_adiabatic()
        return np.asarray(self.rows @ _solve(self.conductance, self.gains))

    def frequency_response(self, frequencies: FloatArray) -> FloatArray:
        """Transfer matrices at frequencies [Hz], complex (k, p, m)."""
        answers = np.empty((len(frequencies), len(self.output_names), len(self.input_names)), dtype=complex)
        for at, frequency in enumerate(frequencies):
            answers[at] = self.rows @ self.shifted_solve(2j * np.pi * frequency, self.gains)
        return answers

    def shifted_solve(self, shift: complex, right: FloatArray) -> FloatArray:
        """(shift·C + K)⁻¹ · right, (n, k)."""
        if self.is_sparse:
            return _solve(sparse.diags_array(shift * self.capacity) + self.conductance, right)
        return _solve(np.diag(shift * self.capacity) + self.conductance, right)

    def stepper(self, step: float, substeps: int = 1) -> Stepper:
        """What advances the states by `step` [s] with inputs held."""
        return stepper_of(self.capacity, self.conductance, self.gains, step, substeps)

    def simulate(self, inputs: FloatArray, step: float, start: FloatArray | None = None) -> FloatArray:
        """States at the end of each step, (k, n), with inputs (k, m) held over it.

        Args:
            inputs: one row a step.
            step: [s].
            start: states before the first step, (n,); None for zero.
        """
        if np.ndim(inputs) != 2 or inputs.shape[1] != len(self.input_names):
            what = f"inputs of shape {np.shape(inputs)}"
            raise InputError(what, "inputs", f"give one column each of {', '.join(self.input_names)}")
        advance = self.stepper(step)
        state = np.zeros(self.order) if start is None else start
        states = np.empty((len(inputs), self.order))
        for at, given in enumerate(inputs):
            state = states[at] = advance(state, given)
        return states

    def outputs(self, states: FloatArray) -> FloatArray:
        """Outputs (k, p) of states (k, n)."""
        return np.asarray(states @ self.rows.T)

    def _refuse_adiabatic(self) -> None:
        """Refuse a system whose heat stays where it is: K is singular to rounding."""
        if self.is_sparse:
            lost = np.abs(self.conductance.sum(axis=0)).max()
            stays = bool(lost <= 1e-12 * np.abs(self.conductance.diagonal()).max())
        else:
            stays = bool(np.linalg.cond(self.conductance) > 1e13)
        if stays:
            raise InputError("nothing leads heat away", "conductances", "write a film coefficient above zero")

    def step_response(self, name: str, size: float, times: int, step: float) -> FloatArray:
        """Outputs (times, p) after a step of one input at rest, every `step` [s]; of a reduced one a sum over modes."""
        given = np.zeros(len(self.input_names))
        given[self.column(name)] = size
        matrix = self.conductance
        if self.is_sparse or np.abs(matrix - matrix.T).max() > 1e-12 * np.abs(matrix).max():
            return self.outputs(self.simulate(np.tile(given, (times, 1)), step))
        root = np.sqrt(self.capacity)
        rates, modes = scipy.linalg.eigh(matrix / np.outer(root, root), driver="evd", check_finite=False)
        shown, driven = self.rows @ (modes / root[:, None]), modes.T @ (self.gains @ given / root)
        return np.asarray(held_states(rates, driven, times, step) @ shown.T)


def _solve(matrix: Expression, right: FloatArray) -> FloatArray:
    if sparse.issparse(matrix):
        factors = scipy.sparse.linalg.splu(matrix.tocsc(), permc_spec="MMD_AT_PLUS_A")
        return np.asarray(factors.solve(right.astype(matrix.dtype)))
    return np.asarray(np.linalg.solve(matrix, right))


def _index(name: str, names: tuple[str, ...], kind: str) -> int:
    if name not in names:
        raise InputError(f'no {kind} "{name}"', "", f"known are {', '.join(names)}")
    return names.index(name)
