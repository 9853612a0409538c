"""One function of a measured variable, or of two, that what is left of a recording may follow."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from enum import StrEnum

import numpy as np

from feeddrive.typing import FloatArray

HARMONICS = 3
"""Sines of a periodic term: the order itself, twice and three times it."""


class Form(StrEnum):
    """What kind of function a term is."""

    CURVE = "curve"
    SINE = "periodic"
    STEP = "step"
    POWERS = "powers"
    LEVEL = "level"


@dataclass(frozen=True)
class Term:
    """A function of one variable, times a second one where `times` names it.

    Attributes:
        form: of the function.
        variable: whose function it is.
        times: factor, as "direction" or "table_velocity"; empty for none.
        nodes: breakpoints of a curve, the place of a step, the angle [rad] of one period of a sine, the largest value
            of powers; none for a level, which is the variable itself.
    """

    form: Form
    variable: str
    times: str = ""
    nodes: tuple[float, ...] = ()

    @property
    def size(self) -> int:
        """Number of columns."""
        return {Form.SINE: 2 * HARMONICS, Form.CURVE: len(self.nodes), Form.POWERS: 4}.get(self.form, 1)

    def columns(self, values: Mapping[str, FloatArray]) -> FloatArray:
        """The functions whose sum the term is, (n, size).

        Args:
            values: variable to its series, (n,), SI.
        """
        at = values[self.variable]
        if self.form is Form.CURVE:
            shape = hats(at, self.nodes)
        elif self.form is Form.STEP:
            shape = (at >= self.nodes[0]).astype(float)[:, None]
        elif self.form is Form.SINE:
            angles = 2 * np.pi * np.outer(at / self.nodes[0], np.arange(1, HARMONICS + 1))
            shape = np.hstack([np.sin(angles), np.cos(angles)])
        elif self.form is Form.POWERS:
            share = at / self.nodes[0]
            shape = np.column_stack([share, np.abs(share), share * np.abs(share), share**2])
        else:
            shape = at[:, None]
        return shape * values[self.times][:, None] if self.times else shape


def hats(at: FloatArray, nodes: tuple[float, ...]) -> FloatArray:
    """Hat functions of a table that is linear between its nodes and constant outside, (n, k)."""
    result = np.zeros((len(at), len(nodes)))
    if len(nodes) == 1:
        return result + 1.0
    clipped = np.clip(at, nodes[0], nodes[-1])
    left = np.clip(np.searchsorted(nodes, clipped, side="right") - 1, 0, len(nodes) - 2)
    points = np.array(nodes)
    share = (clipped - points[left]) / (points[left + 1] - points[left])
    rows = np.arange(len(at))
    result[rows, left] = 1 - share
    result[rows, left + 1] += share
    return result
