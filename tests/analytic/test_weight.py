"""The weight follows whatever moves with the table: payload, further mass, calibrated mass, lumped file, other file."""

from __future__ import annotations

import math
from pathlib import Path

import pytest

from feeddrive.diagnosis.calibration.declared import calibrated_values, with_values
from feeddrive.diagnosis.certainty.same_by_law import twins_of
from feeddrive.diagnosis.suspicion.quality import read_otherwise
from feeddrive.effects.base import Effect
from feeddrive.effects.catalogue import EFFECTS
from feeddrive.errors import InputError
from feeddrive.files import find_plant
from feeddrive.plant.analysis.lumping import lump
from feeddrive.plant.analysis.plausibility import check_plant
from feeddrive.plant.analysis.steady import steady_motion
from feeddrive.plant.file.lumped_text import plant_text_with_effects
from feeddrive.plant.file.plant_file import read_plant
from feeddrive.plant.plant import Plant

FALL = 9.80665
VERTICAL = read_plant(find_plant("vertical_axis"))
PAYLOAD: Effect = EFFECTS["payload"].of(mass=40.0)
CLOSE = 1e-6
"""What a screw that softens along the stroke gives back to the table is a millionth of newtons."""

MODE: Effect = EFFECTS["structural_mode"].of(mass=15.0, frequency=60.0, damping=0.02)


def pulled(plant: Plant) -> float:
    """Force that resists + motion and that the way of the motion does not turn, from the motor's torque [N].

    Friction is alike either way, but for the drag of the screw that follows the load.
    """
    up, down = (steady_motion(plant, v, 0.25).torque for v in (0.1, -0.1))
    return 0.5 * (up + down) / plant.chain.motor_radius


def written(tmp_path: Path, name: str, text: str) -> Plant:
    path = tmp_path / f"{name}.toml"
    path.write_text(text, encoding="utf-8")
    return read_plant(path)


@pytest.mark.parametrize(("effects", "mass"), [((), 260.0), ((PAYLOAD,), 300.0), ((MODE, PAYLOAD), 315.0)])
def test_the_weight_is_that_of_all_that_moves(effects: tuple[Effect, ...], mass: float) -> None:
    assert pulled(VERTICAL.with_effects(*effects)) == pytest.approx(mass * FALL - 1800, rel=CLOSE)


def test_a_calibrated_mass_weighs_what_a_file_with_it_says(tmp_path: Path) -> None:
    values = calibrated_values(VERTICAL)
    at = [0.5 if one.key == "table_mass" else 0.0 for one in values]
    calibrated = with_values(VERTICAL, values, at)  # type: ignore[arg-type]
    mass = calibrated.chain_values()["table_mass"]
    assert mass > 261.0
    text = find_plant("vertical_axis").read_text(encoding="utf-8").replace('"260 kg"', f'"{mass!r} kg"')
    assert pulled(calibrated) == pytest.approx(pulled(written(tmp_path, "heavier", text)), rel=CLOSE)
    assert pulled(calibrated) == pytest.approx(mass * FALL - 1800, rel=CLOSE)


def test_a_payload_that_a_file_holds_hangs_as_well(tmp_path: Path) -> None:
    text = plant_text_with_effects(find_plant("vertical_axis").read_text(encoding="utf-8"), [PAYLOAD])
    assert pulled(written(tmp_path, "loaded", text)) == pytest.approx(300 * FALL - 1800, rel=CLOSE)


@pytest.mark.parametrize(("angle", "held"), [("30 deg", 100.0), ("-20 deg", 100.0), ("-90 deg", 0.0)])
def test_the_lumped_file_hangs_as_its_machine_does(angle: str, held: float, tmp_path: Path) -> None:
    text = find_plant("vertical_axis").read_text(encoding="utf-8")
    text = text.replace('"90 deg"', f'"{angle}"').replace('"1800 N"', f'"{held} N"')
    machine = written(tmp_path, "inclined", text).with_effects(PAYLOAD)
    sine = math.sin(math.radians(float(angle.split()[0])))
    expected = 300 * FALL * sine - math.copysign(held, sine)
    assert pulled(machine) == pytest.approx(expected, rel=CLOSE)
    lumped = written(tmp_path, "lumped", lump(machine).text)
    # numbers of a lumped file are written with twelve digits
    assert pulled(lumped) == pytest.approx(expected, rel=CLOSE)
    assert pulled(lumped.with_effects(PAYLOAD)) == pytest.approx(expected + 40 * FALL * sine, rel=CLOSE)


def test_the_brake_holds_the_payload_too() -> None:
    def asked(plant: Plant) -> float:
        (rule,) = (one for one in check_plant(plant) if one.rule.startswith("torque of the weight"))
        assert rule.value is not None
        return rule.value

    radius = VERTICAL.chain.motor_radius
    assert asked(VERTICAL) == pytest.approx((260 * FALL - 1800) * radius, rel=1e-12)
    assert asked(VERTICAL.with_effects(PAYLOAD)) == pytest.approx((300 * FALL - 1800) * radius, rel=1e-12)


RIGID = """
format = "feeddrive-plant/1"
name = "rigid"
structure = "rigid"
[motor]
inertia = "1e-3 kg m^2"
[ball_screw]
lead = "10 mm"
[table]
mass = "50 kg"
"""


def test_a_rigid_axis_tells_a_hanging_mass_from_an_inertia(tmp_path: Path) -> None:
    """Level, one mass moves and nothing tells where it sits; what hangs weighs."""
    level, inclined = written(tmp_path, "level", RIGID), written(tmp_path, "up", RIGID + 'inclination = "90 deg"\n')
    assert [twin.name for twin in twins_of(PAYLOAD, level, ())] == ["inertia_deviation"]
    assert not twins_of(PAYLOAD, inclined, ())
    assert pulled(inclined.with_effects(PAYLOAD)) == pytest.approx(90 * FALL, rel=CLOSE)


def test_a_force_is_no_offset_of_a_torque_that_was_not_recorded() -> None:
    """With a scale alone a constant force shows by what the transmission gives way."""
    plant, found = read_plant(find_plant("bench_axis")), [EFFECTS["constant_force"].of(force=6.0)]
    (offset,) = read_otherwise(found, plant, has_torque=True)
    assert (offset.kind, offset.channel) == ("channel_offset", "motor_torque")
    assert read_otherwise(found, plant, has_torque=False) == ()


def test_a_counterbalance_that_pulls_down_is_refused(tmp_path: Path) -> None:
    text = RIGID + 'inclination = "90 deg"\ncounterbalance = "-5 N"\n'
    with pytest.raises(InputError, match="counterbalance"):
        written(tmp_path, "pulled", text)
