"""Equations of a load that a given motor motion drives: what runs them, their outputs, their start, a flank."""

from __future__ import annotations

import math

import casadi as ca

from feeddrive.engine.engine import Machine, machine_of
from feeddrive.engine.program import Program
from feeddrive.engine.step.linear_part import Layout
from feeddrive.engine.step.step import driven_step
from feeddrive.plant.chain.chain import symbolic
from feeddrive.plant.equations import Forces, effect_forces
from feeddrive.plant.plant import Plant
from feeddrive.plant.structure import Symbols, chain_symbols, parameter_symbols, per_structure, without_left_out
from feeddrive.plant.transmission_law import travel_deviation
from feeddrive.typing import Expression

PASSES = 3
"""For the table position at the start; travel per length is below 1e-3, so each gains three digits."""


@per_structure
def driven_machine(plant: Plant) -> tuple[Machine, ca.Function, ca.Function]:
    """What runs a structure, its outputs and its start."""
    step = driven_step(plant)
    outputs = _outputs(plant, step.layout)
    memory, own, fed, settings = (ca.SX.sym(*a) for a in (("m", step.layout.memory), ("o", 0), ("f", 6), ("s", 1)))
    values = ca.SX.sym("values", outputs.size1_in(5))
    arguments = [memory, own, fed, settings, values]
    read = outputs(memory, fed[2], fed[3], fed[4], fed[5] + settings[0], values)
    before = ca.Function("feeddrive_before", arguments, [own, fed[:4], ca.SX.zeros(0, 1)])
    after = ca.Function("feeddrive_after", arguments, [read])
    return machine_of(Program(step, before, after, 1, plant.chain.varies)), outputs, _start(plant)


def _start(plant: Plant) -> ca.Function:
    """(theta, theta', parameters) -> free coordinates and rates with no stretch anywhere, travel errors included."""
    symbols = parameter_symbols(plant)
    theta, speed, place = (ca.SX.sym(name) for name in ("theta", "speed", "place"))
    p = chain_symbols(plant, symbols)
    r, motion = p["lead"] / (2 * math.pi), plant.chain.rigid_motion(p)
    turned = theta / motion[0]  # r phi
    delta = travel_deviation(plant, symbols, turned / r, place, ca.SX(0))
    x = turned
    for _ in range(PASSES):
        (found,) = ca.substitute([delta], [place], [x])
        x = turned + found
    slopes = ca.substitute([ca.jacobian(delta, theta), ca.jacobian(delta, place)], [place], [x])
    velocity = speed * (1 / motion[0] + slopes[0]) / (1 - slopes[1])
    shafts = ca.vertcat(*[entry / motion[0] for entry in motion[1:-1]])
    return ca.Function(
        "start", [theta, speed, symbols.vector], [ca.vertcat(theta * shafts, x, speed * shafts, velocity)]
    )


def _outputs(plant: Plant, layout: Layout) -> ca.Function:
    """(memory, theta, theta', theta'', t, parameters) -> [phi, phi', x, x', motor torque, F of the nut].

    The torque is the motor's row of M q'' + C q' + K q = T + f; what rides with the motor on a common hub moves with
    the acceleration that the other rows give it.
    """
    symbols, given = without_left_out(plant, parameter_symbols(plant)), _given(layout)
    chain, p = plant.chain, chain_symbols(plant, symbols)
    acceleration, time = given[3:]
    q, rate, mass, unmoved, found = _unmoved(plant, layout, symbols, given)
    screw, table = ca.horzcat(*chain.screw(p)), ca.horzcat(*chain.table(p))
    phi, x = ca.mtimes(screw, q), ca.mtimes(table, q)
    if chain.elastic:
        others = ca.solve(ca.sparsify(mass[1:, 1:]), -unmoved[1:] - mass[1:, 0] * acceleration)
        row = ca.vertcat(acceleration, others)
    else:
        row = acceleration / chain.motor(p)[0]
    torque = (ca.mtimes(mass[0, :], row) + unmoved[0]) / chain.motor(p)[0]
    if not chain.elastic:
        x = x + travel_deviation(plant, symbols, phi, x, time)
    result = ca.vertcat(phi, ca.mtimes(screw, rate), x, ca.mtimes(table, rate), torque, found.transmitted)
    return ca.Function("outputs", [*given, symbols.vector], [result])


@per_structure
def riding_on_flank(plant: Plant, layout: Layout) -> ca.Function:
    """What keeps the load from moving as rigidly as its rates say, for a search for its coordinates.

    It takes as long to make as the outputs, and few structures have a play to rest on a flank of.

    (memory, theta, theta', theta'', t, parameters) -> (rows of M q'' + C q' + K q - f without the motor's, how they
    change with the free coordinates, the table over these).
    """
    symbols, given = parameter_symbols(plant), _given(layout)
    memory, acceleration, free = given[0], given[3], layout.coordinates
    if not plant.chain.elastic:
        return ca.Function("riding", [*given, symbols.vector], [ca.SX.zeros(0, 1)] * 3)
    p = chain_symbols(plant, symbols)
    _, _, mass, unmoved, _ = _unmoved(plant, layout, symbols, given)
    motion = plant.chain.rigid_motion(p)
    along = ca.vertcat(*[entry / motion[0] for entry in motion])
    rows = (unmoved + ca.mtimes(mass, along) * acceleration)[1:]
    change = ca.jacobian(rows, memory)[:, :free]
    table = ca.vertcat(*list(plant.chain.table(p))[1:])
    return ca.Function("riding", [*given, symbols.vector], [rows, change, table])


def _given(layout: Layout) -> list[Expression]:
    """Symbols (memory, theta, theta', theta'', t)."""
    names = ("theta", "speed", "acceleration", "time")
    return [ca.SX.sym("memory", layout.memory), *(ca.SX.sym(name) for name in names)]


def _unmoved(
    plant: Plant, layout: Layout, symbols: Symbols, given: list[Expression]
) -> tuple[Expression, Expression, Expression, Expression, Forces]:
    """(q, q', M, C q' + K q - f, forces of effects): M q'' is the motor torque less the fourth."""
    memory, theta, speed, _, time = given
    chain, p, free = plant.chain, chain_symbols(plant, symbols), layout.coordinates
    if chain.elastic:
        q, rate = ca.vertcat(theta, memory[:free]), ca.vertcat(speed, memory[free : 2 * free])
    else:
        q, rate = theta / chain.motor(p)[0], speed / chain.motor(p)[0]
    x = ca.mtimes(ca.horzcat(*chain.table(p)), q)
    z = memory[layout.states : layout.states + layout.bristles]
    found = effect_forces(plant, symbols, q, rate, z, time, None)
    mass, damping, stiffness = (symbolic(m(p, x)) for m in (chain.mass, chain.damping, chain.stiffness))
    return q, rate, mass, ca.mtimes(damping, rate) + ca.mtimes(stiffness, q) - found.on_coordinates, found
