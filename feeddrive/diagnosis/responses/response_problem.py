"""A measured frequency response and a plant file: what may be other, and how the plant's response follows from it.

    r_k = ln(H_measured(f_k) / H(f_k; θ)),   complex: relative error of the magnitude, error of the phase in rad

| symbol | meaning | unit |
|---|---|---|
| H | response of the plant linearised about the operating point, with as many waves of the screw as f needs | SI |
| θ | logarithms of declared values over what is declared; dead time; mass, frequency, damping of a further mode | 1 |

Of the mechanics H is the plant's own; of the speed loop, closed or open, that of plant and cascade as the drive
samples them, current loop and dead time included.

The logarithm weighs a line by its relative error, as coherence tells it, at a resonance as in a valley.
"""

from __future__ import annotations

import math
import warnings
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, field, replace
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np

from feeddrive.diagnosis.numbers.declared_values import DeclaredPlant, values_of
from feeddrive.effects.base import Effect
from feeddrive.effects.chain.structural_mode import StructuralMode
from feeddrive.effects.timing.drive_delay import DriveDelay
from feeddrive.errors import InputError, ValidityWarning
from feeddrive.plant.analysis.ode import INPUTS, OUTPUTS
from feeddrive.plant.chain.resolution import resolved
from feeddrive.plant.plant import Plant
from feeddrive.recording.frequency_response import FrequencyResponse
from feeddrive.servo.cascade import Cascade
from feeddrive.servo.linear_loop import closed_velocity_loop, open_velocity_loop
from feeddrive.servo.margins import frequency_response
from feeddrive.servo.mechanics_response import Case, delay_of, transfer
from feeddrive.typing import ComplexArray, FloatArray

if TYPE_CHECKING:
    import control

FEWEST_LINES = 20
"""Lines that a fit of some ten values needs."""

DELAY_SIZE = 1e-3
"""Standard deviation of a dead time before anything is measured [s]: some cycles of a drive."""

MODE_SHARE, MODE_SHARE_SPREAD = 0.1, 1.2
"""Mass of a further mode over the table's: a tenth, known to a factor of three (one standard deviation)."""

MODE_DAMPING, MODE_DAMPING_SPREAD = 0.02, 1.0
"""Damping ratio of a further mode: bolted steel and iron, known to a factor of three."""

LOOPS: dict[str, Callable[[Plant, Cascade, float, float], control.StateSpace]] = {
    "speed_command": closed_velocity_loop,
    "speed_error": open_velocity_loop,
}
"""Inputs of the speed loop, to the measured speed: its set-point, loop closed; its error, loop open."""


@dataclass(frozen=True)
class Lines:
    """What is added to the plant beside its declared values.

    Attributes:
        delay: whether the torque has a dead time of its own.
        modes: starting frequencies of further modes [Hz].
    """

    delay: bool = False
    modes: tuple[float, ...] = ()

    @property
    def count(self) -> int:
        """Coordinates of the additions."""
        return int(self.delay) + 3 * len(self.modes)


@dataclass(frozen=True, eq=False)
class ResponseProblem(DeclaredPlant):
    """A plant file and a frequency response measured on the machine.

    Attributes:
        response: as measured, frequencies above zero.
        case: operating point.
        cascade: the controller, where the response is one of its speed loop.
    """

    response: FrequencyResponse
    case: Case
    cascade: Cascade | None = None
    _known: dict[bytes, ComplexArray] = field(default_factory=dict, init=False)

    def spreads(self, beyond: Sequence[int], lines: Lines, wide: float) -> FloatArray:
        """Standard deviations of the coordinates before anything is measured, (k,)."""
        own = np.array([one.deviation for one in self.values])
        own[list(beyond)] = wide
        # an even density over the logarithm of the frequency has this standard deviation
        even = math.log(float(self.response.frequency[-1] / self.response.frequency[0])) / math.sqrt(12)
        modes = [MODE_SHARE_SPREAD, even, MODE_DAMPING_SPREAD] * len(lines.modes)
        return np.concatenate([own, [1.0] * int(lines.delay), modes])

    def effects(self, extra: FloatArray, lines: Lines) -> tuple[Effect, ...]:
        """The additions at their coordinates."""
        found: list[Effect] = []
        rest = list(map(float, extra))
        if lines.delay:
            found.append(DriveDelay.of(delay=max(rest.pop(0), 0.0) * DELAY_SIZE))
        table = self.plant.chain_values()["table_mass"]
        for start in lines.modes:
            share, place, damping = rest[:3]
            rest = rest[3:]
            mass = MODE_SHARE * math.exp(_bounded(share, 5.0)) * table
            ratio = min(MODE_DAMPING * math.exp(_bounded(damping, 4.0)), 1.0)
            found.append(StructuralMode.of(mass=mass, frequency=start * math.exp(_bounded(place, 5.0)), damping=ratio))
        return tuple(found)

    def predicted(self, coordinates: FloatArray, lines: Lines) -> ComplexArray:
        """Response at the measured frequencies, (n,) SI; each is computed once."""
        key = coordinates.tobytes() + repr(lines).encode()
        if key not in self._known:
            if len(self._known) > 200:  # some iterations' worth
                self._known.clear()
            self._known[key] = self._computed(coordinates, lines)
        return self._known[key]

    def _computed(self, coordinates: FloatArray, lines: Lines) -> ComplexArray:
        with warnings.catch_warnings():
            warnings.simplefilter("ignore", ValidityWarning)  # values that no part has are tried on the way
            count = len(self.values)
            plant = self.plant_with(np.clip(coordinates[:count], -5.0, 5.0))
            plant = plant.with_effects(*self.effects(coordinates[count:], lines))
            frequency = self.response.frequency
            fine = resolved(self.case.on(plant), float(frequency[-1]), [self.case.position])
            if self.cascade is not None:
                loop = LOOPS[self.response.given](fine, self.cascade, self.case.velocity, self.case.position)
                return frequency_response(loop, frequency)
            system = transfer(
                fine, self.response.given, self.response.output, Case(self.case.position, self.case.velocity)
            )
        late = delay_of(plant) if self.response.given == "motor_torque" else 0.0
        found: ComplexArray = frequency_response(system, frequency) * np.exp(-2j * math.pi * frequency * late)
        return found

    def residual(self, coordinates: FloatArray, lines: Lines) -> FloatArray:
        """Real parts of all r_k, then imaginary parts, (2 n,)."""
        ratio = np.log(self.response.values / self.predicted(coordinates, lines))
        return np.concatenate([ratio.real, ratio.imag])


def response_problem(
    entries: Mapping[str, Any], path: Path, plant: Plant, response: FrequencyResponse, case: Case,
    cascade: Cascade | None = None,
) -> ResponseProblem:  # fmt: skip
    """The problem of a plant file and a measured frequency response.

    Args:
        entries: of the plant file.
        path: of it.
        plant: read from it.
        response: as measured.
        case: operating point at which it was measured.
        cascade: the controller under which a response of the speed loop was measured.

    Raises:
        InputError: channels that are not compared, too few lines, values of zero, a response of the speed loop without
            its controller, or a file that declares nothing that could be other.
    """
    where = response.source or response.name
    used = response.positive
    if response.given in LOOPS:
        used = _of_the_loop(used, cascade, where)
    else:
        cascade = None
        for name, known, word in ((response.given, (*INPUTS, *LOOPS), "from"), (response.output, OUTPUTS, "to")):
            if name not in known:
                mend = f"{word} is one of {', '.join(known)}"
                raise InputError(f"a response {word} {name} is not compared", where, mend)
    if len(used.frequency) < FEWEST_LINES:
        raise InputError(f"{len(used.frequency)} lines above 0 Hz", where, f"measure at least {FEWEST_LINES}")
    if np.any(used.values == 0):
        raise InputError("a value of the response is zero", where, "leave that line out")
    values = values_of(entries, path, plant, case.position)
    return ResponseProblem(entries, path, plant, values, used, case, cascade)


def _of_the_loop(response: FrequencyResponse, cascade: Cascade | None, where: str) -> FrequencyResponse:
    """The lines of a response of the speed loop that its drive can show.

    Raises:
        InputError: another output than the motor's speed, or no controller.
    """
    if response.output != "motor_speed":
        mend = "write to = motor_speed"
        raise InputError(f"a response from {response.given} to {response.output} is not compared", where, mend)
    if cascade is None:
        what = f"a response from {response.given} is one of the speed loop, and the controller is not known"
        raise InputError(what, where, "give --controller FILE with K_p, T_n, filters, rates and dead time")
    below = response.frequency < 0.5 / cascade.sample_time
    return replace(response, frequency=response.frequency[below], values=response.values[below],
                   coherence=response.coherence[below])  # fmt: skip


def _bounded(value: float, most: float) -> float:
    return min(max(value, -most), most)
