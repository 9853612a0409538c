"""The one law of the transmission: travel errors enter the stretch of the nut; gap and stiffness are its spring's.

    e = e_0 + delta(phi, x, t),  e_0 = w q
    F = y - l(y) + c e' outside the gap,     y = k g(x) dz(e)

delta is the travel deviation. By virtual work the force on the coordinates is -(w + delta_phi L_phi + delta_x L_x)' F
with the rows w of the stretch, L_phi of the screw angle and L_x of the table position; and on the table -dU/dx of the
spring's energy where its stiffness depends on the position:

    U = (y^2 / 2 - L(y)) / (k g),     -dU/dx = -(y^2 / 2 - y l + L) g' / (k g^2)     with dL/dy = l

| symbol | meaning | unit |
|---|---|---|
| e, e_0 | stretch of the nut, and without travel errors: r phi - x less what the screw gives way | m |
| F | force of the nut on the table | N |
| k, c | stiffness and damping of the nut's spring (the combined axial one of three inertias) | N/m, N s/m |
| dz | dead zone: stretch beyond the flank of the free play | m |
| g | factor on the stiffness with the table at x | 1 |
| l, L | force that the spring loses, and its integral over y | N, N^2 |
"""

from __future__ import annotations

from dataclasses import dataclass

import casadi as ca

from feeddrive.effects.base import TransmissionEffect, TravelEffect
from feeddrive.plant.chain.linear_chain import Spring
from feeddrive.plant.plant import Plant
from feeddrive.plant.structure import Symbols
from feeddrive.typing import Expression

CONTACT_SMOOTHING = 1e-9
"""Stretch over which the flank of a free play takes up its damper [m]; a tenth of a good scale's resolution."""


@dataclass(frozen=True)
class NutForce:
    """What the nut transmits.

    Attributes:
        force: F on the table [N].
        beyond_linear: force on the coordinates beyond the chain's -w' (k w q + c w q'), shape (n, 1) [N or N m].
        energy: U that the spring holds [J].
        damped: power that the damper takes [W].
    """

    force: Expression
    beyond_linear: Expression
    energy: Expression
    damped: Expression


def nut_force(
    plant: Plant,
    symbols: Symbols,
    nut: Spring,
    rows: tuple[Expression, Expression],
    q: Expression,
    rate: Expression,
    time: Expression,
) -> NutForce:
    """Force of the nut, and what of it the linear chain does not hold.

    Args:
        plant: which effects there are.
        symbols: parameters.
        nut: spring of the chain.
        rows: of screw angle and table position, each shape (1, n).
        q, rate: coordinates and rates, shape (n, 1).
        time: [s].
    """
    stretch_row = ca.horzcat(*nut.row)
    stretch, stretch_rate = ca.mtimes(stretch_row, q), ca.mtimes(stretch_row, rate)
    linear = nut.stiffness * stretch + nut.damping * stretch_rate
    if not plant.has_travel and not plant.effects_of(TransmissionEffect):
        energy, damped = 0.5 * nut.stiffness * stretch * stretch, nut.damping * stretch_rate * stretch_rate
        return NutForce(linear, ca.SX.zeros(q.numel(), 1), energy, damped)
    screw, table = rows
    delta, by_angle, by_position = _travel(plant, symbols, ca.mtimes(screw, q), ca.mtimes(table, q), time)
    stretch += delta
    stretch_rate += by_angle * ca.mtimes(screw, rate) + by_position * ca.mtimes(table, rate)
    spring = spring_law(plant, symbols, nut, stretch, ca.mtimes(table, q))
    damper = spring.contact * nut.damping * stretch_rate
    force = spring.force + damper
    along = stretch_row + by_angle * screw + by_position * table
    beyond = stretch_row.T * linear - along.T * force + table.T * spring.pull
    return NutForce(force, beyond, spring.energy, damper * stretch_rate)


def travel_deviation(plant: Plant, symbols: Symbols, phi: Expression, x: Expression, time: Expression) -> Expression:
    """Sum of the travel deviations [m] at screw angle phi [rad] and table position x [m]."""
    delta = ca.SX(0)
    for effect in plant.effects:
        if isinstance(effect, TravelEffect):
            delta += effect.travel(phi, x, time, symbols.effects[effect.label])
    return delta


@dataclass(frozen=True)
class SpringLaw:
    """The spring of the transmission at one stretch and position.

    Attributes:
        force: along the stretch, without the damper [N].
        contact: share of the damper that acts: 1 outside the gap, 0 inside.
        energy: U [J].
        pull: -dU/dx on the table at constant stretch [N].
    """

    force: Expression
    contact: Expression
    energy: Expression
    pull: Expression


def spring_law(plant: Plant, symbols: Symbols, nut: Spring, stretch: Expression, position: Expression) -> SpringLaw:
    """The one spring law of the transmission at nut stretch [m] and table position [m].

    Free plays add, factors on the stiffness multiply, lost forces add.
    """
    slots = [effect for effect in plant.effects if isinstance(effect, TransmissionEffect)]
    factor, slope = _stiffness_factor(slots, symbols, position)
    stiffness = nut.stiffness * factor
    beyond, contact = _beyond_gap(slots, symbols, stretch)
    whole = stiffness * beyond
    lost = sum((effect.lost_force(whole, symbols.effects[effect.label]) for effect in slots), ca.SX(0))
    lost_energy = sum((effect.lost_energy(whole, symbols.effects[effect.label]) for effect in slots), ca.SX(0))
    energy = (0.5 * whole**2 - lost_energy) / stiffness
    pull = -(0.5 * whole**2 - whole * lost + lost_energy) * slope / (stiffness * factor)
    return SpringLaw(whole - lost, contact, energy, pull)


def _stiffness_factor(
    slots: list[TransmissionEffect], symbols: Symbols, position: Expression
) -> tuple[Expression, Expression]:
    """g and its slope with the table position [1, 1/m]."""
    x = ca.SX.sym("x")
    factor = ca.SX(1)
    for effect in slots:
        factor *= effect.stiffness_factor(x, symbols.effects[effect.label])
    at = ca.substitute([factor, ca.jacobian(factor, x)], [x], [ca.SX(position)])
    return at[0], at[1]


def _beyond_gap(
    slots: list[TransmissionEffect], symbols: Symbols, stretch: Expression
) -> tuple[Expression, Expression]:
    """Stretch beyond the flank of the free play [m], and the share of the damper that acts there."""
    gaps = [effect for effect in slots if effect.has_play]
    if not gaps:
        return stretch, ca.SX(1)
    play = sum((effect.free_play(symbols.effects[effect.label]) for effect in gaps), ca.SX(0))
    beyond = ca.fabs(stretch) - 0.5 * play
    contact = ca.fmin(ca.fmax(beyond / CONTACT_SMOOTHING, 0), 1)
    return ca.sign(stretch) * ca.fmax(beyond, 0), contact


def _travel(
    plant: Plant, symbols: Symbols, angle: Expression, position: Expression, time: Expression
) -> tuple[Expression, Expression, Expression]:
    """delta [m] and its slopes with screw angle [m/rad] and table position [1]."""
    phi, x = ca.SX.sym("phi"), ca.SX.sym("x")
    delta = travel_deviation(plant, symbols, phi, x, time)
    parts = [delta, ca.jacobian(delta, phi), ca.jacobian(delta, x)]
    at = ca.substitute(parts, [phi, x], [angle, position])
    return at[0], at[1], at[2]
