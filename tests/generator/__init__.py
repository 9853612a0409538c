"""An independent simulator of a ball-screw axis with planted effects; it shares no code with the package under test."""

from tests.generator.axis import BENCH, LIGHT, AxisParameters
from tests.generator.effects import PlantedEffects
from tests.generator.pair import recording_pair
from tests.generator.profile import Profile, train_profile, validate_profile
from tests.generator.recording import simulate, write_csv
from tests.generator.sizing import SHARES, sized

__all__ = [
    "BENCH",
    "LIGHT",
    "SHARES",
    "AxisParameters",
    "PlantedEffects",
    "Profile",
    "recording_pair",
    "simulate",
    "sized",
    "train_profile",
    "validate_profile",
    "write_csv",
]
