"""Forces at a node beyond the linear chain of the step: of the effects, and of a chain that varies beyond its cell.

    M(x) q'' = B u + f - C q' - K q,      f_beyond = f - (M(x) - M_ref) q''

so that M_ref q'' = B u + f_beyond - C q' - K q holds with the propagators of the cell, and the motion does not depend
on where cells begin. C and K are those of the cell; f has the springs' part
(see `feeddrive.plant.equations`).

| symbol | meaning |
|---|---|
| M(x), M_ref | mass matrix with the table at x, and at the reference of the cell |
| u, B | motor torque and cutting force, and how they act; a driven motor's acceleration takes their place |
"""

from __future__ import annotations

from dataclasses import dataclass, replace

import casadi as ca

from feeddrive.plant.chain.chain import symbolic
from feeddrive.plant.equations import Forces, effect_forces
from feeddrive.plant.plant import Plant
from feeddrive.plant.structure import Symbols, chain_symbols
from feeddrive.typing import Expression


@dataclass(frozen=True)
class Pull:
    """What moves the chain at an instant.

    Attributes:
        torque: of the motor [N m]; where the motor is driven, its acceleration [rad/s^2].
        force: on the table [N].
        driven: which of the two.
        beyond: torque that acts less `torque`, which the linear part passes on [N m]; None where they are the same.
    """

    torque: Expression
    force: Expression
    driven: bool
    beyond: Expression | None = None


def node_forces(
    plant: Plant,
    symbols: Symbols,
    q: Expression,
    rate: Expression,
    z: Expression,
    time: Expression,
    reference: Expression,
    pull: Pull,
) -> Forces:
    """Forces on the coordinates beyond the linear chain at `reference`, and the rates of the bristles.

    Args:
        plant: which effects there are.
        symbols: parameters.
        q, rate: coordinates and rates, shape (n, 1).
        z: bristle deflections [m].
        time: [s].
        reference: table position of the step's M, C and K [m].
        pull: what moves the chain.
    """
    found = effect_forces(plant, symbols, q, rate, z, time, reference)
    chain, p = plant.chain, chain_symbols(plant, symbols)
    if pull.beyond is not None:
        found = replace(found, on_coordinates=found.on_coordinates + ca.vertcat(*chain.motor(p)) * pull.beyond)
    if not plant.chain.varies:
        return found
    x = ca.mtimes(ca.horzcat(*chain.table(p)), q)
    here, there = (ca.sparsify(symbolic(chain.mass(p, at))) for at in (x, reference))
    damping, stiffness = (ca.sparsify(symbolic(matrix(p, reference))) for matrix in (chain.damping, chain.stiffness))
    pushed = found.on_coordinates - ca.mtimes(damping, rate) - ca.mtimes(stiffness, q)
    pushed += ca.vertcat(*chain.table(p)) * pull.force
    if pull.driven:
        others = ca.solve(here[1:, 1:], pushed[1:] - here[1:, 0] * pull.torque)
        acceleration = ca.vertcat(pull.torque, others)
    else:
        acceleration = ca.solve(here, pushed + ca.vertcat(*chain.motor(p)) * pull.torque)
    beyond = ca.mtimes(_difference(here, there), acceleration)
    return replace(found, on_coordinates=found.on_coordinates - beyond)


def _difference(here: Expression, there: Expression) -> Expression:
    """here - there, with nothing where both are the same expression."""
    rows, columns = here.shape
    result = ca.SX.zeros(rows, columns)
    for i in range(rows):
        for j in range(columns):
            if not ca.is_equal(here[i, j], there[i, j], 20):
                result[i, j] = here[i, j] - there[i, j]
    return ca.sparsify(result)
