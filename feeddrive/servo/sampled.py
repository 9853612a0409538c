"""What every sampled controller is to the engine and to the linear loop: one function of one tick.

The simulation runs the function, the linear loop differentiates it, the export prints it; nobody writes it twice.
"""

from __future__ import annotations

from dataclasses import dataclass

import casadi as ca

from feeddrive.errors import InputError
from feeddrive.typing import FloatArray

MEASUREMENTS: dict[str, str] = {
    "motor_angle": "rad",
    "motor_speed": "rad/s",
    "table_position": "m",
    "table_velocity": "m/s",
}
"""What a controller may measure, with its SI unit: readings of the plant at the instant of the tick."""


@dataclass(frozen=True)
class SampledController:
    """A controller that is called once per tick and whose torque is held until the next.

    The tick counts from zero and is an integer: slower loops run where it is a multiple of their divider, so that no
    rate depends on rounded times.

    Attributes:
        function: (state (nc,), reference (nr,), measurement (nm,), tick (), parameters (np,)) ->
            (state after (nc,), torque command () [N m], signals (ns,)), CasADi SX.
        initial: state before tick 0, shape (nc,).
        parameters: values of the last argument, SI, shape (np,).
        sample_time: from one tick to the next [s].
        references: names of what is fed, in order.
        measurements: keys of `MEASUREMENTS`, in order.
        signals: names of what it shows of itself, in order.

    Raises:
        InputError: sizes that do not fit the function, an unknown measurement, a sample time that is not positive.
    """

    function: ca.Function
    initial: FloatArray
    parameters: FloatArray
    sample_time: float
    references: tuple[str, ...]
    measurements: tuple[str, ...]
    signals: tuple[str, ...]

    def __post_init__(self) -> None:
        name = self.function.name()
        given = (len(self.initial), len(self.references), len(self.measurements), 1, len(self.parameters))
        needed = tuple(self.function.size1_in(i) for i in range(5))
        if given != needed:
            raise InputError(f"sizes {given} of a controller whose function takes {needed}", name)
        shown = tuple(self.function.size1_out(i) for i in range(3))
        if shown != (given[0], 1, len(self.signals)):
            raise InputError(f"the function returns sizes {shown}", name, "return state after, torque and signals")
        unknown = [measurement for measurement in self.measurements if measurement not in MEASUREMENTS]
        if unknown:
            raise InputError(f"unknown measurement {unknown[0]!r}", name, f"known are {', '.join(MEASUREMENTS)}")
        if not self.sample_time > 0:
            raise InputError(f"sample time {self.sample_time:g} s is not positive", name)
