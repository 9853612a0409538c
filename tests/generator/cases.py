"""Which recordings are committed and what is planted in each."""

from __future__ import annotations

from dataclasses import dataclass

from tests.generator.axis import AXES
from tests.generator.effects import (
    Backlash,
    ConstantForce,
    CoulombAsymmetry,
    DriveDelay,
    Effect,
    FrictionDeviation,
    FrictionVsPosition,
    LeadErrorPeriodic,
    Payload,
    PlantedEffects,
    Presliding,
    Stribeck,
    TorqueRipple,
    ViscousAsymmetry,
)
from tests.generator.pair import Channels, recording_pair
from tests.generator.recording import LONGEST_STEP

SECONDS = {"bench": (12.0, 7.6), "light": (6.8, 6.0)}


@dataclass(frozen=True)
class Case:
    """One pair of recordings: axis name, file name, effects and the seeds of training and validation.

    off: (name, factor) of the declared numbers that the true axis has otherwise. noise_factor: noise over declared.
    seconds: lengths of training and validation [s], those of SECONDS where not given.
    """

    axis: str
    name: str
    effects: PlantedEffects
    seeds: tuple[int, int]
    off: tuple[tuple[str, float], ...] = ()
    noise_factor: float = 1.0
    seconds: tuple[float, float] | None = None

    def recordings(self) -> tuple[Channels, Channels]:
        """Return the channels for fitting and for judging, with the step of the committed recordings."""
        return recording_pair(
            AXES[self.axis],
            self.effects.effects,
            self.seeds,
            self.seconds or SECONDS[self.axis],
            self.noise_factor,
            dict(self.off),
            LONGEST_STEP,
        )


BENCH_EFFECTS: tuple[Effect, ...] = (
    TorqueRipple(amplitude=0.09, order=6.0, phase=0.7),
    Backlash(width=7.5e-6),
    FrictionVsPosition(peak=41.0, centre=0.23, half_width=0.042),
    Presliding(stiffness=5.5e6),
    ConstantForce(force=-28.0),
    Payload(mass=22.0),
    DriveDelay(delay=180e-6),
    LeadErrorPeriodic(amplitude=1.8e-6, order=1.0, phase=2.2),
    Stribeck(delta_force=-22.0, velocity=6e-3),
    CoulombAsymmetry(delta_force=14.0),
    ViscousAsymmetry(delta_viscous=-90.0),
    FrictionDeviation(port="table", coulomb_factor=1.25, viscous_factor=0.8),
)

LIGHT_EFFECTS: tuple[Effect, ...] = (
    Backlash(width=4.2e-6),
    Stribeck(delta_force=11.0, velocity=9e-3),
    FrictionDeviation(port="screw", coulomb_factor=0.7, viscous_factor=1.3),
)

DEMO_EFFECTS = PlantedEffects(
    (
        LeadErrorPeriodic(amplitude=2.1e-6, order=1.0, phase=0.6),
        FrictionVsPosition(peak=38.0, centre=0.16, half_width=0.045),
    )
)


def _cases(axis: str, effects: tuple[Effect, ...], first_seed: int) -> list[Case]:
    """Return the case with nothing planted and one case per effect."""
    cases = [Case(axis, "null", PlantedEffects(), (first_seed, first_seed + 1))]
    for number, effect in enumerate(effects, start=1):
        seed = first_seed + 2 * number
        cases.append(Case(axis, effect.name, PlantedEffects((effect,)), (seed, seed + 1)))
    return cases


CASES = (*_cases("bench", BENCH_EFFECTS, 100), *_cases("light", LIGHT_EFFECTS, 200))
