"""An independent simulator of a ball-screw axis with planted effects; it shares no code with the package under test."""

from tests.generator.axis import BENCH, LIGHT, AxisParameters
from tests.generator.effects import PlantedEffects
from tests.generator.profile import Profile, train_profile, validate_profile
from tests.generator.recording import simulate, write_csv

__all__ = [
    "BENCH",
    "LIGHT",
    "AxisParameters",
    "PlantedEffects",
    "Profile",
    "simulate",
    "train_profile",
    "validate_profile",
    "write_csv",
]
