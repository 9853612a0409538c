"""The development data: five simulated cases of another simulator, and the recorded EMPS drive.

Not part of the project: skipped where they are absent (see `shared_data` in tests/conftest.py).
"""

from __future__ import annotations

import tomllib
from pathlib import Path
from typing import Any

import pytest

from feeddrive.diagnosis.diagnose import diagnose
from feeddrive.files import plants_folder
from feeddrive.plant.file.plant_file import read_plant
from feeddrive.recording import read_recording
from tests.claims.book import CLAIMS
from tests.recovery.planted import Verdict, axis_plant, declared_errors

pytestmark = pytest.mark.slow

# The names of that folder's truth.toml, which uses words and a folder name for an effect.
EFFECTS = {
    "null": "",
    "backlash": "backlash",
    "torque_ripple": "torque_ripple",
    "friction_bump": "friction_vs_position",
    "presliding": "presliding",
}
KEYS = {
    "order per motor revolution": "order",
    "height": "peak",
    "width": "half_width",
    "bristle stiffness": "stiffness",
    "backlash": "width",
}


@pytest.mark.parametrize("case", EFFECTS)
def test_what_was_planted_is_found_and_nothing_else(case: str, shared_data: Path) -> None:
    folder = shared_data / "axis_cases"
    plant = axis_plant("bench")
    fitted, judged = (read_recording(folder / case / f"{part}.csv.gz") for part in ("train", "validate"))
    result, _ = diagnose(plant, [fitted], [judged])
    null = declared_errors(plant, read_recording(folder / "null" / "validate.csv.gz"))
    verdict = Verdict(result, planted(folder, case), null)
    print(f"\n{verdict.line('shared/' + case)}")
    assert verdict.misses == []


def planted(folder: Path, case: str) -> dict[str, dict[str, Any]]:
    """Effect and parameters of a case, under the names of the contract."""
    values = tomllib.loads((folder / "truth.toml").read_text(encoding="utf-8"))[case]
    if not EFFECTS[case]:
        return {}
    # `width` is half the width (1/e) of the bump, and of no other case.
    return {EFFECTS[case]: {KEYS.get(key, key): value for key, value in values.items()}}


def test_recorded_drive(shared_data: Path) -> None:
    folder = plants_folder()
    recording = read_recording(shared_data / "emps" / "DATA_EMPS.mat", folder / "emps_map.toml")
    result, _ = diagnose(read_plant(folder / "emps.toml"), [recording], split=0.75, simulate=True)
    (torque,) = result.channels
    assert result.simulation is not None
    names = ", ".join(effect.name for effect in result.effects)
    print(f"\nEMPS {names} | inverse {torque.before.relative:.2%} -> {torque.after.relative:.2%}", end="")
    print(f" | closed loop {result.simulation.before:.2%} -> {result.simulation.after:.2%}")
    # Errors of the motor torque over its rms. The four cycles themselves repeat to 0.64 %.
    CLAIMS["emps.declared"].check(100 * torque.before.relative)
    CLAIMS["emps.declared_loop"].check(100 * result.simulation.before)
    CLAIMS["emps.force"].check(100 * torque.after.relative)
    CLAIMS["emps.loop"].check(100 * result.simulation.after)
    # The published rigid model's own error on this file, 4.083 %, to a tenth: other filter, last quarter only.
    assert torque.before.relative == pytest.approx(0.04083, rel=0.10)
