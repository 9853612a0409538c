"""The heat of a machine: the rig with its films, contact and friction, and what they are at a speed and a preload."""

from __future__ import annotations

import math
from collections.abc import Mapping
from dataclasses import dataclass, field, replace

import numpy as np

from feeddrive.effects.heat.thermal_effect import ThermalEffect
from feeddrive.thermal.full.full_model import FRONT, NUT, REAR, SHAFT, full_model, growth_name
from feeddrive.thermal.full.grid import Cells
from feeddrive.thermal.laws.films import Films, conductance_at_preload
from feeddrive.thermal.laws.friction import LOAD_EXPONENT, Friction
from feeddrive.thermal.reduced.parametric_model import HeatModel, Path
from feeddrive.thermal.rig import Body, Rig, Travel, refuse_negative, refuse_unless_positive
from feeddrive.thermal.thermal_coupling import Coupling
from feeddrive.typing import FloatArray

CHANNELS = {
    NUT: "nut_temperature",
    FRONT: "front_bearing_temperature",
    REAR: "rear_bearing_temperature",
    SHAFT: "shaft_travel_temperature",
}
"""Outputs and their names in recordings where no sensor is declared; "growth_200mm" is "table_growth_200mm"."""

THERMOMETER, SCALE = "thermometer", "scale"
"""Kinds of sensors."""

PLACES = {"nut": NUT, "front": FRONT, "rear": REAR, "shaft": SHAFT}
"""Where a thermometer may sit: outer surface of the nut, surfaces of the seats, mean of the shaft over the travel."""


@dataclass(frozen=True)
class HeatSensor:
    """A sensor for temperature or growth.

    Attributes:
        channel: in recordings.
        kind: "thermometer", or "scale" for a growth of the table's position.
        at: "nut", "front", "rear" or "shaft"; of a growth the position of the nut [m].
        noise: rms, of the channel's SI unit; 0 where it is to be read off the recording.
    """

    channel: str
    kind: str
    at: str | float
    noise: float = 0.0

    @property
    def output(self) -> str:
        """Output of the thermal model that it reads."""
        return growth_name(self.at) if isinstance(self.at, float) else PLACES[self.at]


@dataclass(frozen=True)
class Heat:
    """What a plant file declares about heat.

    Attributes:
        name: of the machine.
        rig: geometry and material.
        films: film coefficients against speed.
        contact: contact conductance at the declared preload [W/(m² K)].
        preload: declared [N].
        lead: [m/rad].
        nut: friction of the nut.
        front, rear: friction of the bearings; None for bearings without heat.
        ambient: reference temperature [degC].
        highest_speed: up to which the reduced model is made [rad/s].
        cells: grid of the full model.
        bodies: attached to nut and seats.
        effects: beyond the declared films, contact and friction.
        coupling: how friction follows the temperatures; None where it is as declared at all of them.
        sensors: channels and where they are read; those of the default names where none is declared.
        origins: source of a value, by `thermal.key` or `label.key`.
    """

    name: str
    rig: Rig
    films: Films
    contact: float
    preload: float
    lead: float
    nut: Friction
    front: Friction | None = None
    rear: Friction | None = None
    ambient: float = 23.0
    highest_speed: float = 1500 * math.pi / 30
    cells: Cells = field(default_factory=Cells)
    bodies: tuple[Body, ...] = ()
    effects: tuple[ThermalEffect, ...] = ()
    coupling: Coupling | None = None
    sensors: tuple[HeatSensor, ...] = ()
    origins: Mapping[str, str] = field(default_factory=dict)

    def __post_init__(self) -> None:
        refuse_negative(self.contact, "W/(m^2 K)", "contact_conductance")
        refuse_unless_positive(self.preload, "N", "preload")
        refuse_unless_positive(self.lead, "m/rad", "lead")
        refuse_unless_positive(self.highest_speed, "rad/s", "highest_speed")

    def joined(self, coupling: Coupling) -> Heat:
        """This network heated by the friction of the motion in place of its own."""
        nut, *ends = (
            None if one is None else replace(one, heat_share=0.0) for one in (self.nut, self.front, self.rear)
        )
        assert nut is not None
        return replace(self, coupling=coupling, nut=nut, front=ends[0], rear=ends[1])

    @property
    def attached(self) -> tuple[Body, ...]:
        """Bodies that effects attach to the nut."""
        held = [(effect.label, effect.attached(effect.values)) for effect in self.effects]
        return tuple(Body(label, NUT, body[1], body[0]) for label, body in held if body is not None)

    def full_model(self, travel: Travel | None = None) -> HeatModel:
        """The full model with the bodies, those of effects too, the nut averaged over a travel, None for the rig's."""
        model = full_model(self.rig, self.cells, travel)
        for body in (*self.bodies, *self.attached):
            model = model.with_body(body)
        return model

    def conductances(self, speeds: FloatArray, preload: float | None = None) -> dict[Path, FloatArray]:
        """Film coefficients and contact conductance at speeds (k,) [rad/s], (k,) each."""
        contact = conductance_at_preload(self.contact, preload or self.preload, self.preload)
        films = {Path.SCREW_FILM: self.films.on_screw(speeds), Path.NUT_FILM: self.films.on_nut(speeds)}
        for path, seat in ((Path.FRONT_FILM, self.rig.front), (Path.REAR_FILM, self.rig.rear)):
            films[path] = np.full(len(speeds), seat.film or 0.0)
        return {Path.CONTACT: np.full(len(speeds), contact), **films, Path.COOLING: np.zeros(len(speeds))}

    def at_speed(self, speed: float, preload: float | None = None) -> dict[Path, float]:
        """As `conductances` at one speed [rad/s]."""
        return {path: float(values[0]) for path, values in self.conductances(np.array([speed]), preload).items()}

    def heats(self, speeds: FloatArray, preload: float | None = None) -> dict[str, FloatArray]:
        """Friction heat of nut and bearings at speeds (k,) [rad/s], (k,) each [W]."""
        load = ((preload or self.preload) / self.preload) ** LOAD_EXPONENT
        found = {NUT: self.nut.heats(speeds, load)}
        for name, friction in ((FRONT, self.front), (REAR, self.rear)):
            found[name] = friction.heats(speeds) if friction is not None else np.zeros(len(speeds))
        return found

    def feed(self, speed: float) -> float:
        """Speed of the nut along the shaft [m/s] at a speed of the screw [rad/s]."""
        return abs(speed) * self.lead

    def limits(self, factor: float = 1.6) -> Mapping[Path, tuple[float, float]]:
        """Conductances between rest and the highest speed, widened by `factor` for what is not as declared.

        The contact goes further down, to where it hardly conducts, and the cooling from none to 5 W/K.
        """
        ends = self.conductances(np.array([0.0, self.highest_speed]))
        found = {path: (values.min() / factor, values.max() * factor) for path, values in ends.items()}
        found[Path.CONTACT] = (self.contact / 4, self.contact * 4)
        found[Path.COOLING] = (0.0, 5.0)
        return found
