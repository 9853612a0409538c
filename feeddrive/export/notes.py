"""What an exported model includes and what it leaves out, in sentences."""

from __future__ import annotations

import math

import casadi as ca

from feeddrive.effects.base import BristleEffect, Kind, TimingEffect, TransmissionEffect
from feeddrive.effects.timing.channel_delay import ChannelDelay
from feeddrive.plant.analysis.ode import timed_ode
from feeddrive.plant.plant import Plant
from feeddrive.symbolic_turn import SYMBOLS
from feeddrive.units.quantity import format_quantity


def included(plant: Plant) -> tuple[str, ...]:
    """What the equations of motion hold."""
    follows = ", following the table position" if plant.chain.varies else ""
    lines = [f"inertias, springs and dampers of the structure {plant.chain.structure}{follows}"]
    lines += [f"effect {e.label} at port {e.port}" for e in plant.motion_effects if e.kind != Kind.TIMING]
    return tuple(lines)


def left_out(plant: Plant) -> tuple[str, ...]:
    """What the machine has and the equations of motion do not, and what to do about it."""
    lines = []
    for effect in plant.effects:
        if isinstance(effect, TimingEffect):
            delay = effect.delay({key: _number(value) for key, value in effect.values.items()})
            lines.append(
                f"{effect.label}: the motor torque acts {format_quantity(delay, 's')} late; shift the input so"
            )
        if isinstance(effect, ChannelDelay):
            late = format_quantity(_number(effect.values["delay"]), "s")
            lines.append(f"{effect.label}: {effect.place} is recorded {late} late; shift what is recorded so")
    if math.isfinite(plant.torque_limit):
        limit = format_quantity(plant.torque_limit, "N m")
        lines.append(f"the motor's torque limit of {limit}; limit the input")
    if plant.sensors:
        lines.append("sensors: outputs are exact, without resolution, noise or lag")
    if plant.controller is not None:
        lines.append("the controller; the model is the open axis")
    lines.append("end stops: nothing stops the table at the ends of its stroke")
    return tuple(lines)


def linear_notes(plant: Plant) -> tuple[str, ...]:
    """What linearising leaves out besides."""
    lines = ["every effect acts by its slope at the point: friction by the slope of sliding, not of sticking"]
    slots = [effect for effect in plant.effects if isinstance(effect, TransmissionEffect)]
    if any(effect.has_play for effect in slots):
        lines.append("free play: linear on the flank that bears the load, without the gap")
    if any(not effect.has_play for effect in slots):
        lines.append("the spring of the transmission acts by its stiffness at the transmitted force and the position")
    if plant.effects_of(BristleEffect):
        lines.append("bristle: sliding, about its steady deflection; v=0 is the sticking one")
    if changes_with_time(plant):
        lines.append("what changes with time is taken at the start")
    return tuple(lines)


@SYMBOLS.taken()
def changes_with_time(plant: Plant) -> bool:
    """Whether the equations of motion depend on time."""
    function = timed_ode(plant)
    time, *others = (ca.SX.sym(name, function.size1_in(name)) for name in function.name_in())
    return bool(ca.depends_on(ca.vertcat(*function(time, *others)), time))


def _number(value: float | tuple[float, ...]) -> float:
    return value if isinstance(value, int | float) else value[0]
