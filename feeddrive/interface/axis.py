"""A feed axis as its user holds it: a plant file, perhaps with other values or further effects, and what it answers."""

from __future__ import annotations

import json
import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from functools import cached_property
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np

from feeddrive.effects.base import Effect
from feeddrive.effects.source.weight import GRAVITY
from feeddrive.errors import InputError
from feeddrive.files import find_plant, write_text_atomically
from feeddrive.interface.machine.check import Check, Life, UsedLife
from feeddrive.interface.machine.modes import Modes
from feeddrive.interface.machine.summary import Stiffness, Summary
from feeddrive.interface.quantities import Quantities, Quantity, quantities, si
from feeddrive.plant.analysis.lumping import lump
from feeddrive.plant.analysis.mode_map import mode_map
from feeddrive.plant.analysis.modes import inertia_at_motor
from feeddrive.plant.analysis.plausibility import check_plant
from feeddrive.plant.analysis.rated_life import rated_life
from feeddrive.plant.analysis.stiffness_budget import stiffness_budget
from feeddrive.plant.analysis.summary import summarise
from feeddrive.plant.file.declared_check import check_declared
from feeddrive.plant.file.lumped_text import plant_text_with_effects
from feeddrive.plant.file.plant_file import plant_from_entries
from feeddrive.plant.file.plant_schema import plant_table
from feeddrive.plant.plant import Plant
from feeddrive.schema.toml_text import parse_toml
from feeddrive.simulate.scenario.scenario_overrides import with_overrides
from feeddrive.thermal.machine_heat import Heat

if TYPE_CHECKING:
    import casadi
    import control

    from feeddrive.interface.machine.bode import Bode
    from feeddrive.interface.machine.heat_summary import HeatSummary
    from feeddrive.interface.machine.modes import Lumped
    from feeddrive.interface.servo import Servo
    from feeddrive.recording.frequency_response import FrequencyResponse
    from feeddrive.recording.recording import Recording


def load(name: str | Path) -> Axis:
    """The axis of a plant file.

    Args:
        name: path of the file, or the name of a shipped machine, see `list_plants`.

    Raises:
        InputError: neither a file nor a shipped machine, or a file that cannot be used; one line with file, key and
            remedy.

    >>> import feeddrive as fd
    >>> axis = fd.load("bench_axis")
    >>> axis
    Axis 'bench axis': three_inertias, 3 effects
    """
    if not isinstance(name, str | Path):
        raise InputError(f"{name!r} is no path", "load", "give a string or a pathlib.Path")
    path = find_plant(str(name))
    try:
        text = path.read_text(encoding="utf-8-sig")
    except (OSError, UnicodeDecodeError) as error:
        raise InputError(f"cannot be read ({error})", str(path), "give a TOML file in UTF-8") from None
    return axis_of_text(text, path)


def axis_of(given: Axis | str | Path) -> Axis:
    """The axis itself, or that of a plant file or shipped machine. Errors as `load`."""
    return given if isinstance(given, Axis) else load(given)


def axis_of_text(text: str, path: Path) -> Axis:
    """The axis of the text of a plant file, checked whole; `path` is for messages and the name. Errors as `load`."""
    axis = Axis(path, text)
    axis.refuse_unusable()
    return axis


@dataclass(frozen=True, repr=False)
class Axis:
    """A feed axis: what `load` gives. Never changed; `with_values` and `with_effects` give another one.

    Attributes:
        path: of the plant file.
        text: of the plant file.
        values: put in place of the file's, keys as of `--set` without "plant.".
        added: effects beyond those of the file.
    """

    path: Path
    text: str
    values: tuple[tuple[str, str], ...] = ()
    added: tuple[Effect, ...] = ()

    def __repr__(self) -> str:
        """Name, structure, effects, stroke."""
        plant = self.plant
        if not plant.has_motion:
            return f"Axis {plant.name!r}: heat alone, {len(plant.effects)} effects"
        low, high = ("" if plant.stroke is None else _short(end) for end in plant.stroke or (0.0, 0.0))
        stroke = f", stroke {low} to {high}" if plant.stroke else ""
        heat = ", with heat" if plant.has_heat else ""
        return f"Axis {plant.name!r}: {plant.chain.structure}, {len(plant.effects)} effects{stroke}{heat}"

    @cached_property
    def entries(self) -> dict[str, Any]:
        """What the file holds, with the values that were put in."""
        written = parse_toml(self.text, str(self.path))
        return with_overrides(written, dict(self.values))

    @cached_property
    def plant(self) -> Plant:
        """The machine with chain, effects and drive, and its heat where it is declared."""
        return plant_from_entries(self.entries, self.path).with_effects(*self.added)

    @property
    def has_motion(self) -> bool:
        """Whether the file declares masses and drives."""
        return self.plant.has_motion

    @property
    def has_heat(self) -> bool:
        """Whether the file declares heat."""
        return self.plant.has_heat

    @property
    def heat(self) -> Heat:
        """The heat of the machine.

        Raises:
            InputError: the file declares none.
        """
        return self.plant.heat

    @property
    def name(self) -> str:
        """Name of the machine."""
        return self.plant.name

    @property
    def inertia_at_motor(self) -> float:
        """Inertia of everything that moves, as the motor feels it [kg m^2]."""
        return inertia_at_motor(self.plant)

    @property
    def travel_per_turn(self) -> float:
        """Table travel per turn of the motor, which is the lead behind its transmission [m]."""
        return 2 * math.pi * self.plant.chain.motor_radius

    def refuse_unusable(self) -> None:
        """Read everything that the file declares.

        Raises:
            InputError: the first thing that cannot be used.
        """
        _ = self.plant

    def with_values(self, values: Mapping[str, Quantity | Sequence[str]]) -> Axis:
        """The axis with other values.

        Args:
            values: key as of `--set`, "table.mass" or "effect.guide_friction.coulomb", to a quantity with its unit.

        Raises:
            InputError: a key or a value that the file could not hold either.

        >>> import feeddrive as fd
        >>> axis = fd.load("bench_axis").with_values({"table.mass": "160 kg"})
        >>> axis.plant.chain_values()["table_mass"]
        160.0
        """
        written = {key: _as_written(value) for key, value in values.items()}
        changed = replace(self, values=tuple({**dict(self.values), **written}.items()))
        changed.refuse_unusable()
        return changed

    def with_effects(self, *effects: Effect) -> Axis:
        """The axis with further effects, see `effect`.

        Raises:
            InputError: an effect that cannot act here, or two that cannot act together.

        >>> import feeddrive as fd
        >>> worn = fd.load("bench_axis").with_effects(fd.effect("backlash", width="7.5 um"))
        >>> worn.plant.effects[-1].name
        'backlash'
        """
        for one in effects:
            if not isinstance(one, Effect):
                raise InputError(f"{one!r} is no effect", "with_effects", 'give fd.effect("backlash", width="7.5 um")')
        changed = replace(self, added=(*self.added, *effects))
        changed.refuse_unusable()
        return changed

    def with_body(
        self, name: str, port: str, *, capacity: Quantity, conductance: Quantity, to_air: Quantity = "0 W/K"
    ) -> Axis:
        """The axis with a further body that takes heat: motor, bearing housing, bed; a `[[thermal.body]]` of the file.

        Args:
            name: of the body, for its temperature and for heats that act on it.
            port: "front", "rear" or "nut", where it is attached.
            capacity: [J/K].
            conductance: to the surface at the port [W/K].
            to_air: to the surroundings [W/K].

        Raises:
            InputError: a machine without heat, an unknown port, a value that is not possible.

        >>> import feeddrive as fd
        >>> axis = fd.load("thermal_bench")
        >>> axis.with_body("bed", "front", capacity="60 kJ/K", conductance="0.2 W/K").heat.bodies[0].capacity
        60000.0
        """
        given = {"name": name, "port": port}
        for key, value, unit in (("capacity", capacity, "J/K"), ("conductance", conductance, "W/K"),
                                 ("to_air", to_air, "W/K")):  # fmt: skip
            given[key] = f"{si(value, unit, key)!r} {unit}"
        written = "".join(f"{key} = {json.dumps(value, ensure_ascii=False)}\n" for key, value in given.items())
        _ = self.heat
        changed = replace(self, text=f"{self.text.rstrip()}\n\n[[thermal.body]]\n{written}")
        changed.refuse_unusable()
        return changed

    def save(self, path: str | Path) -> Path:
        """Write the plant file, with the effects that were added at its end.

        Raises:
            InputError: values were put in, which a text cannot take; or the file cannot be written.
        """
        if self.values:
            keys = ", ".join(key for key, _ in self.values)
            raise InputError(f"{keys} differ from the file", "save", "write them into the plant file itself")
        target = Path(path)
        write_text_atomically(target, plant_text_with_effects(self.text, self.added))
        return target

    def _place(self, at: Quantity | None) -> float:
        """A table position on the stroke [m], its middle if left out."""
        place = self.plant.middle if at is None else si(at, "m", "at")
        self.plant.refuse_off_stroke(place, "at")
        return place

    def summary(
        self, at: Quantity | None = None, recording: Recording | str | Path | None = None
    ) -> Summary | HeatSummary:
        """Values with their sources, inertias, stiffness budget, friction, modes and life; of heat alone its own.

        Args:
            at: table position for stiffness and modes; the middle of the stroke if left out.
            recording: whose share of the life is added, see `used_life`; none if left out.

        Raises:
            InputError: a position off the stroke, a recording without motor angle, or of a machine of heat alone.

        >>> import feeddrive as fd
        >>> [one.title for one in fd.load("bench_axis").summary().tables()][2]
        'Inertia'
        """
        from feeddrive.interface.machine.heat_summary import HeatSummary

        if not self.has_motion:
            if recording is not None:
                raise InputError(
                    "declares heat alone, so no load of a nut is known", self.name, "leave the recording out"
                )
            return HeatSummary(self.heat)
        from feeddrive.plant.file.guide_section import declared_carriages  # Hertz's contacts take time to import

        found = summarise(self.plant, self._place(at))
        carriages = declared_carriages(plant_table(self.entries, str(self.path)), GRAVITY)
        used = None if recording is None else self.used_life(recording)
        return Summary(self.plant, found, rated_life(self.plant), carriages, used)

    def lumped(self, at: Quantity | None = None) -> Lumped:
        """The three inertias that are nearest to a machine of parts, and how near they are.

        Args:
            at: table position; the middle of the stroke if left out.

        Raises:
            InputError: a machine that is not described by parts, or a position off the stroke.

        >>> import feeddrive as fd
        >>> fd.load("kimm_testbed").lumped(at="600 mm").text.startswith("#")
        True
        """
        from feeddrive.interface.machine.modes import Lumped

        further = ("the [thermal] sections; temperatures are predicted with the file of the parts",)
        return Lumped(self.name, lump(self.plant, self._place(at), further if self.has_heat else ()))

    def modes(self, at: Quantities = None) -> Modes:
        """Natural frequencies, motor held and free.

        Args:
            at: table position or several; along the stroke if left out.

        Raises:
            InputError: a position off the stroke.

        >>> import feeddrive as fd
        >>> modes = fd.load("kimm_testbed").modes(["0 mm", "600 mm"])
        >>> modes.held.shape[0]
        2
        """
        places = quantities(at, "m", "at")
        for place in places:
            self.plant.refuse_off_stroke(place, "at")
        return Modes(self.name, mode_map(self.plant, np.array(places) if places else None), self.plant)

    def stiffness(self, at: Quantity | None = None) -> Stiffness:
        """Static stiffness at the table with the motor held, and whose compliance it is.

        Args:
            at: table position; the middle of the stroke if left out.

        Raises:
            InputError: a rigid machine, or a position off the stroke.
        """
        place = self._place(at)
        if not self.plant.chain.elastic:
            raise InputError("nothing is elastic in a rigid machine", self.name, "declare another structure")
        return Stiffness(self.name, place, stiffness_budget(self.plant, place), self.plant)

    def check(self, position_gain: Quantity | None = None) -> Check:
        """Rules of plausibility, values that differ from the part that the file names, and what is still a guess.

        Args:
            position_gain: K_v of the controller, "60 1/s"; the declared one if left out.

        Raises:
            InputError: a gain that is not above zero.
        """
        gain = None if position_gain is None else si(position_gain, "1/s", "position_gain")
        if gain is not None and not gain > 0:
            raise InputError(f"{position_gain} is no gain", "position_gain", "write one above zero, such as '50 1/s'")
        declared = check_declared(self.entries, str(self.path), self.plant)
        return Check(self.name, (*check_plant(self.plant, gain), *declared))

    def life(self) -> Life:
        """Rated life of the ball screw, survived by 90 %."""
        return Life(self.name, rated_life(self.plant), self.plant)

    def used_life(self, recording: Recording | str | Path) -> UsedLife:
        """What a recorded motion has taken of the life of each nut of the ball screw.

        Args:
            recording: with the motor angle; a cutting force counts where it was recorded.

        Raises:
            InputError: a recording without motor angle.
        """
        from feeddrive.diagnosis.motion.band import comparison_band
        from feeddrive.interface.measured.reading import as_recording
        from feeddrive.simulate.driven import used_life

        rec = as_recording(recording, "recording")
        if "motor_angle" not in rec:
            raise InputError("no channel motor_angle", rec.name, "record it: its revolutions are what wears the nuts")
        angle = comparison_band(self.plant, 1 / rec.sample_time).filter(rec["motor_angle"])
        force = rec.channels.get("cutting_force")
        return UsedLife(rec.name, rec.time, used_life(self.plant, rec.time, angle, force))

    def linear(self, at: str = "") -> control.StateSpace:
        """The axis linearised exactly about a steady motion, states, inputs and outputs named, SI.

        Args:
            at: "x=600 mm, v=3 m/min"; without x the middle of the stroke, without v at a slow motion: at rest the
                slope of the friction swamps everything.

        Raises:
            InputError: a point off the stroke, or where no steady motion is found.

        >>> import feeddrive as fd
        >>> G = fd.load("bench_axis").linear(at="x=200 mm, v=3 m/min")
        >>> G.input_labels
        ['motor_torque', 'cutting_force']
        """
        from feeddrive.export.point import export_point
        from feeddrive.plant.analysis.linear import state_space

        point = export_point(self.plant, at, "at")
        return state_space(self.plant, point.linearised_at, point.position)

    def ode(self) -> casadi.Function:
        """The equations of motion as a CasADi function (x, u, p) -> (dx/dt, y), SI, with all effects."""
        from feeddrive.plant.analysis.ode import ode

        return ode(self.plant)

    def bode(
        self,
        given: str = "",
        output: str = "",
        *,
        at: str = "",
        positions: Quantities = None,
        payload: Quantities = None,
        controller: Servo | str | Path | None = None,
        loop: str = "",
        frequencies: Sequence[Quantity] = ("1 Hz", "2 kHz"),
        measured: Recording | FrequencyResponse | None = None,
    ) -> Bode:
        """Frequency responses: of the mechanics, or with a controller of its loops.

        Args:
            given: input, "motor_torque" if left out; of a closed loop also a set-point.
            output: such as "table_position"; "motor_speed" if left out.
            at: operating point, "x=200 mm, v=3 m/min".
            positions: of the table, one curve each; that of `at` if left out.
            payload: masses on the table beyond the declared one, one curve each.
            controller: of `tune`, or a controller or scenario file; its loops are shown then.
            loop: "open" (all open loops with their margins, as if left out), "closed", "velocity" or "position" (that
                open loop alone).
            frequencies: lowest and highest.
            measured: recording, or frequency response of a file, that is laid over the mechanics.

        Raises:
            InputError: an unknown signal or loop, a point off the stroke, an unstable loop.

        >>> import feeddrive as fd
        >>> bode = fd.load("bench_axis").bode("motor_torque", "motor_speed", payload=["0 kg", "60 kg"])
        >>> len(bode.curves)
        2
        """
        from feeddrive.interface.machine.bode import frequency_range, loops_bode, mechanics_bode, operating_cases

        cases, ends = operating_cases(self.plant, at, positions, payload), frequency_range(frequencies)
        if not loop and controller is None:
            return mechanics_bode(self.plant, given, output, cases, ends, measured)
        if measured is not None:
            raise InputError("a recording is laid over the mechanics, not loops", "recording", "leave out the loop")
        return loops_bode(self.plant, given, output, cases, ends, controller, loop)

    def export(self, form: str, folder: str | Path, at: str = "", heat: bool = False) -> tuple[Path, ...]:
        """Write the axis in the form of another tool.

        Args:
            form: "ss", "mat", "json" (linear), "casadi", "c", "fmu" (nonlinear, with all effects).
            folder: for the files; made if it is not there.
            at: operating point.
            heat: the heat of the machine in place of its motion: temperatures and growth from the speed of the screw;
                without masses and drives in the file in any case. "ss", "casadi", "c" or "fmu".

        Returns:
            The files.

        Raises:
            InputError: an unknown form, a point off the stroke, or a folder that cannot be written.
        """
        from feeddrive.export.exported_plant import Form, write_export, write_heat_export
        from feeddrive.export.point import export_point
        from feeddrive.schema.toml_text import nearest

        forms = {str(one): one for one in Form}
        if form not in forms:
            raise InputError(f'no form "{form}"', "export", nearest(form, forms))
        if heat or not self.has_motion:
            return write_heat_export(self.heat, forms[form], heat_velocity(self, at), Path(folder))
        return write_export(self.plant, forms[form], export_point(self.plant, at, "at"), Path(folder))


def heat_velocity(axis: Axis, at: str) -> float:
    """Velocity of the table about which the heat is linearised [m/s], from an operating point such as "v=3 m/min".

    Raises:
        InputError: a point that cannot be read, or that says where the table is to a machine without one.
    """
    from feeddrive.export.point import Point, export_point, written_point
    from feeddrive.plant.analysis.steady import MOVING

    point = export_point(axis.plant, at, "at") if axis.has_motion else Point(0.0, written_point(at, "at").get("v"))
    return MOVING if point.velocity is None else point.velocity


def _short(length: float) -> str:
    from feeddrive.units.quantity import format_quantity

    return format_quantity(length, "m")


def _as_written(value: object) -> str:
    """A value as it is written behind `--set key=`."""
    if isinstance(value, str):
        return value
    if isinstance(value, list | tuple):
        return f"[{', '.join(repr(one) if not isinstance(one, str) else chr(34) + one + chr(34) for one in value)}]"
    return repr(value).lower() if isinstance(value, bool) else repr(value)
