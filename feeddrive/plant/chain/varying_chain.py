"""What a chain whose springs depend on the table position x does beyond the chain frozen at a reference x_ref.

    V(q) = 1/2 sum_i k_i(x) s_i^2,     f = -dV/dq - sum_i w_i' c_i(x) s_i'  beyond  -K(x_ref) q - C(x_ref) q':

    f = -sum_i w_i' [ (k_i(x) - k_i(x_ref)) s_i + (c_i(x) - c_i(x_ref)) s_i' ] - L_x' 1/2 sum_i k_i'(x) s_i^2

which is -(K(x) - K(x_ref)) q - (C(x) - C(x_ref)) q' and, on the table, -1/2 q' K'(x) q. The last term is what a
spring that softens along the stroke gives back to the table as it moves there; without it energy is not kept. It is
small: at 10 kN and 330 N/µm (40 mm, 0.5 m) it is 0.2 N. Written with stretches and not with matrices, since q holds
angles of thousands of radians and the stretches are microns.

The nut's own spring is the same everywhere; the law of the transmission has it.

| symbol | meaning | unit |
|---|---|---|
| w_i, s_i = w_i q | row and stretch of spring i | m, or rad |
| k_i, c_i | stiffness and damping of spring i with the table at x | N/m, N s/m, or N m/rad, N m s/rad |
| L_x | row of the table position | 1 |
"""

from __future__ import annotations

import casadi as ca

from feeddrive.plant.chain.linear_chain import Chain, Spring, Values
from feeddrive.typing import Expression


def force_beyond_reference(
    chain: Chain, p: Values, q: Expression, rate: Expression, reference: Expression | None
) -> Expression:
    """Generalised force beyond the chain frozen at `reference`, shape (n, 1) [N or N m].

    Args:
        chain: the chain; zero is returned where it does not vary.
        p: its values.
        q, rate: coordinates and rates, shape (n, 1).
        reference: table position at which the caller's K and C are frozen [m]; None where they follow the table, so
            that only the term on the table is left.
    """
    force = ca.SX.zeros(len(chain.coordinates), 1)
    if not chain.varies:
        return force
    table = ca.horzcat(*chain.table(p))
    x = ca.mtimes(table, q)
    at = ca.SX.sym("position")
    for spring in chain.springs(p, at):
        if not ca.depends_on(ca.SX(spring.stiffness), at):
            continue
        row = ca.horzcat(*spring.row)
        stretch = ca.mtimes(row, q)
        slope = ca.substitute(ca.jacobian(spring.stiffness, at), at, x)
        force -= table.T * (0.5 * slope * stretch * stretch)
        if reference is not None:
            force -= row.T * _beyond(spring, at, x, reference, stretch, ca.mtimes(row, rate))
    return force


def _beyond(
    spring: Spring, at: Expression, x: Expression, reference: Expression, stretch: Expression, rate: Expression
) -> Expression:
    """Force of the spring at x beyond its force at the reference [N or N m]."""
    parts = [ca.SX(spring.stiffness), ca.SX(spring.damping)]
    k, c = (
        here - there
        for here, there in zip(
            ca.substitute(parts, [at], [x]), ca.substitute(parts, [at], [ca.SX(reference)]), strict=True
        )
    )
    return k * stretch + c * rate
