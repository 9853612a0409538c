"""Is it the recording that is wrong? A sign, a factor or a clock that makes the declared plant fit is refused.

A search finds effects that turn any recording into a machine: a torque of the other sign into negative inertias. Such
faults of a recording are known, and each is one number at most. With a the torque that the declared inertias take in
the measured motion and c the rest of the declared plant's prediction p = a + c (friction, mostly), all in the band and
with their means left free, the mean squares of what is left of the measured torque m are compared:

    one fault      m = g p                            g: a sign, a unit, an rms for a peak value
                   m = |p|                            a current without its sign
                   m = g p(t / s)                     the time stamps are s times the true ones, s = 2, 1/2
    one cause      m = f a + c'  or  m = a' + h c     inertia or friction anything that is not negative, the other
                                                      within TOLERANCE of what is declared (a', c')
    any machine    m = f a + h c                      both anything that is not negative

The recording is refused where a fault leaves a quarter of what any single cause leaves, and no more than any machine
does: of all masses and levels, none explains better than one number that is the same for all of them. A payload moves f
alone, other friction h alone; a torque constant a few percent off stays inside TOLERANCE and is not refused. A motion
that takes no torque to accelerate, or has no friction, tells no factor from a mass or a friction, and is not refused.
A clock of double or half the rate has no number that could be fitted: of N blocks it is likelier by N/2 ln(left of one
cause over its own), and that must outweigh how rare it is (RARE). Inertias that are a quarter of those declared look
nearly the same where friction turns with the direction alone.

A torque that follows the motion of no machine is refused as well, where the motion asks for a torque that varies by
more than its mean. In a stroke at one speed it asks for less: there what friction varies by along the way may be all.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np
from scipy.optimize import lsq_linear

from feeddrive.diagnosis.likelihood.evidence import Evidence
from feeddrive.diagnosis.likelihood.problem import Problem
from feeddrive.diagnosis.motion.axis_evidence import AxisEvidence
from feeddrive.diagnosis.motion.prediction import AxisPredictor
from feeddrive.errors import InputError
from feeddrive.plant.analysis.modes import inertia_at_motor
from feeddrive.plant.plant import Plant
from feeddrive.typing import FloatArray

TOLERANCE = 1.1 / 0.9
"""Factor on a torque, an inertia or a friction within which the machine itself may be other than declared: a tenth
each for the torque constant (the usual tolerance of motor data) and for inertias (those of catalogues), together."""

FAR_LESS = 0.25
"""Share of the mean square that one cause leaves, below which a fault explains far more: half of its rms."""

RARE = 1e-3
"""Share of recordings whose clock runs at double or half the rate: one in a thousand."""

AS_GOOD = 1.1
"""Mean square over that of any machine within which a fault does as well; f and h of noise alone lower it by less."""

CLOCKS = (2.0, 0.5)
"""Time stamps over true times that are tried: those of a wrong rate, of double and of half."""

LEAST_LIKENESS = 0.5
"""Correlation with the torque of any machine, below which a channel is something else."""


@dataclass(frozen=True)
class Fault:
    """One way in which a recording may be wrong.

    Attributes:
        left: mean square of the torque that is left with it, over that of the torque.
        what, mend: for the person whose recording it is.
        least: share of what one cause leaves, below which it is the fault.
    """

    left: float
    what: str
    mend: str
    least: float = FAR_LESS


def refuse_faulty(problem: Problem, recordings: Sequence[Evidence]) -> None:
    """Refuse recordings of which a fault of the recording explains far more than any one thing about the machine.

    Args:
        problem: declared plant and its predictor.
        recordings: fitted and judged.

    Raises:
        InputError: which fault, and how to mend it.
    """
    for evidence in dict.fromkeys(recordings):
        if isinstance(evidence, AxisEvidence) and "motor_torque" in evidence.channels:
            _refuse(problem, problem.plant, evidence)


def _refuse(problem: Problem, plant: Plant, evidence: AxisEvidence) -> None:
    seen = torque_parts(problem, plant, evidence)
    if seen is None or seen.as_declared < (1 - 1 / TOLERANCE) ** 2:
        return  # no factor beyond the tolerance leaves so little
    any_machine, where = seen.any_machine, evidence.recording.name
    best = min((sign_or_factor(seen), magnitude(seen), *clocks(problem, plant, evidence)), key=lambda fault: fault.left)
    follows = best.left < 1 - LEAST_LIKENESS**2
    if follows and best.left < best.least * seen.one_cause and best.left < AS_GOOD * any_machine:
        if best.what:
            shares = (f"{100 * math.sqrt(left):.3g} %" for left in (best.left, seen.as_declared))
            explained = "{} of its rms are left unexplained then, {} as it is".format(*shares)
            raise InputError(f"{best.what}; {explained}", where, best.mend)
    elif seen.varies and any_machine > 1 - LEAST_LIKENESS**2:
        likeness = math.sqrt(max(1 - any_machine, 0.0))
        what = f"the torque does not follow the motion (correlation {likeness:.2f} with that of any such machine)"
        mend = "check both columns: which they are, their units, and jumps or lost rows in the motion"
        raise InputError(what, where, mend)


@dataclass(frozen=True)
class TorqueParts:
    """Measured torque m and its parts a and c as the declared plant predicts them, about their means; (n,) [N m].

    `mean` is that of the prediction [N m].
    """

    measured: FloatArray
    inertial: FloatArray
    rest: FloatArray
    mean: float

    @property
    def varies(self) -> bool:
        """Whether the motion asks for a torque that varies by more than its mean."""
        return float(np.std(self.predicted)) > abs(self.mean)

    @property
    def predicted(self) -> FloatArray:
        """p = a + c."""
        return self.inertial + self.rest

    @property
    def as_declared(self) -> float:
        """Share of the mean square that the declared plant leaves."""
        return self.left(self.predicted)

    @property
    def one_cause(self) -> float:
        """Least that inertia or friction alone leaves, whichever it is, the other within the tolerance."""
        near = (1 / TOLERANCE, TOLERANCE)
        return min(self._bounded((0.0, np.inf), near), self._bounded(near, (0.0, np.inf)))

    @property
    def any_machine(self) -> float:
        """Least that any inertia and any friction leave."""
        return self._bounded((0.0, np.inf), (0.0, np.inf))

    @property
    def factor(self) -> float:
        """g, the factor on the prediction that fits best."""
        energy = float(self.predicted @ self.predicted)
        return float(self.measured @ self.predicted) / energy if energy > 0 else 1.0

    def left(self, explained: FloatArray) -> float:
        """Share of the mean square that an explanation (n,) leaves."""
        return float(np.sum((self.measured - explained) ** 2) / np.sum(self.measured**2))

    def _bounded(self, inertia: tuple[float, float], friction: tuple[float, float]) -> float:
        columns = np.column_stack([self.inertial, self.rest])
        found = lsq_linear(columns, self.measured, bounds=tuple(zip(inertia, friction, strict=True)), method="bvls")
        return self.left(columns @ found.x)


def torque_parts(problem: Problem, plant: Plant, evidence: AxisEvidence) -> TorqueParts | None:
    """The torque and its parts at the samples that count; None where the plant cannot be followed, or nothing acts."""
    rows = evidence.thinned(evidence.counted)
    predicted = problem.predictor.predict(plant, evidence)["motor_torque"][rows]
    assert isinstance(problem.predictor, AxisPredictor)
    scale = problem.predictor.scale(plant) if evidence.scaled_from else 1.0
    accelerating = evidence.motion.acceleration[evidence.motion.samples]
    inertial = scale * inertia_at_motor(plant) * evidence.band.filter(accelerating)[rows]
    series = [one - np.mean(one) for one in (evidence.measured["motor_torque"][rows], inertial, predicted - inertial)]
    if not all(np.all(np.isfinite(one)) and one.any() for one in series):
        return None
    measured, pushed, rest = series
    return TorqueParts(measured, pushed, rest, float(np.mean(predicted)))


def sign_or_factor(seen: TorqueParts) -> Fault:
    """The best factor on the torque; without words where the machine itself may be so."""
    g = seen.factor
    left = seen.left(g * seen.predicted)
    if 1 / TOLERANCE <= g <= TOLERANCE:
        return Fault(left, "", "")
    if abs(math.log(abs(g) + 1e-300)) <= math.log(TOLERANCE):
        mend = 'multiply it by -1 in the mapping ("factor = -1"), or turn the sign of the motion'
        return Fault(left, "the torque is the negative of what this machine needs", mend)
    what = f"the torque is {g:.4g} times what this machine needs, accelerating and rubbing alike"
    kinds = {math.sqrt(0.5): ("rms", "peak"), math.sqrt(2.0): ("peak", "rms")}
    for factor, (is_now, meant) in kinds.items():
        # met to 3 %: as near as a torque constant is known beside a factor of 1.41
        if abs(g / factor - 1) < 0.03:
            mend = (
                f"the current is a {is_now} value, its torque constant that of {meant} values: divide by {factor:.4g}"
            )
            return Fault(left, what, mend)
    mend = f"check unit, percentage and torque constant, and divide it by {g:.4g} in the mapping; or correct all masses"
    return Fault(left, what, mend)


def magnitude(seen: TorqueParts) -> Fault:
    """The torque without its sign."""
    size = np.abs(seen.predicted)
    size = size - np.mean(size)
    energy = float(size @ size)
    g = float(seen.measured @ size) / energy if energy > 0 else 0.0
    what = "the torque has lost its sign: it follows the size of what this machine needs"
    return Fault(seen.left(g * size) if g > 0 else math.inf, what, "record the signed torque or current")


def clocks(problem: Problem, plant: Plant, evidence: AxisEvidence) -> list[Fault]:
    """The recording with its time stamps corrected."""
    faults, blocks = [], evidence.counted.sum() * evidence.recording.sample_time / evidence.block
    least = max(FAR_LESS, float(RARE ** (2 / max(blocks, 1.0))))
    for clock in CLOCKS:
        recording = evidence.recording
        step = recording.sample_time / clock
        corrected = replace(recording, time=recording.time / clock, sample_time=step)
        again = replace(evidence.at_other_times(corrected), scaled_from="")  # g is its scale
        seen = torque_parts(replace(problem, predictor=AxisPredictor()), plant, again)
        if seen is not None:
            g = seen.factor if evidence.scaled_from else 1.0
            what = f"the time stamps are {clock:g} times what the motion of this machine needs"
            mend = f"check unit and rate of the time column: a row every {step:.4g} s fits"
            faults.append(Fault(seen.left(g * seen.predicted), what, mend, least))
    return faults
