"""Inertia of motor or screw other than declared.

    J = J0 + J1

| symbol | key | meaning | unit |
|---|---|---|---|
| J1 | inertia | beyond the declared one, about the shaft's own axis; negative where there is less | kg m^2 |
| | where | "motor" (rotor, its coupling half, brake, fan) or "screw" | |

Along a distributed screw it is spread evenly over the length, so that it moves with the nut as the screw's own does.

Which shaft: an inertia at the motor asks for J1 theta'' and nothing else. One at the screw asks for J1 phi'', behind
the torsion spring, so that it differs by the share (f / f_a)^2 at frequencies f below the screw's anti-resonance f_a, a
fifth at the upper edge of the comparison; recordings without a chirp or jerk cannot tell the two. A mass on the table
moves the table against the scale besides (m x'' over the axial stiffness), and differs from both where a scale is
recorded. A rigid structure has one mass for all three: `payload` is the name there, and the other is listed with it.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import replace
from typing import Self

from feeddrive.effects.base import ChainEffect, Parameter, Port, Signature, Value
from feeddrive.errors import InputError
from feeddrive.typing import Expression


class InertiaDeviation(ChainEffect):
    """Inertia added to a shaft."""

    name = "inertia_deviation"
    words = "inertia other than declared"
    ports = (Port.MOTOR, Port.SCREW)
    parameters = (Parameter("inertia", "kg m^2", size=1e-4),)
    signature = Signature(
        ("motor_torque",), "motor acceleration", ("payload", "torque_constant_droop", "structural_mode")
    )
    place_key = "where"
    places = ("motor", "screw")
    repeatable = True
    additive = True

    @classmethod
    def of(cls, port: Port | None = None, place: str = "", **values: Value) -> Self:
        """As of any effect; the port is the shaft that `where` names, and may be left out.

        Raises:
            InputError: as of any effect, or a port that is not that shaft.
        """
        made = super().of(port, place, **values)
        if port is not None and port != place:
            what = f"port {port} and {cls.place_key} {place} are not the same shaft"
            raise InputError(what, cls.name, "leave the port out")
        return replace(made, port=Port(place))

    def chain(self, chain: dict[str, Expression], p: Mapping[str, Expression]) -> dict[str, Expression]:
        """The chain with the inertia on its shaft."""
        if self.place == "motor":
            return {**chain, "motor_inertia": chain["motor_inertia"] + p["inertia"]}
        if "inertia_per_length" in chain:
            per_length = p["inertia"] / (chain["drive_length"] + chain["screw_length"])
            return {**chain, "inertia_per_length": chain["inertia_per_length"] + per_length}
        return {**chain, "screw_inertia": chain["screw_inertia"] + p["inertia"]}


def declared_inertia(chain: Mapping[str, float], where: str) -> float:
    """Inertia of "motor" or "screw" in the values of a chain [kg m^2]."""
    if where == "motor":
        return chain["motor_inertia"]
    if "inertia_per_length" in chain:
        return chain["inertia_per_length"] * (chain["drive_length"] + chain["screw_length"])
    return chain["screw_inertia"]
