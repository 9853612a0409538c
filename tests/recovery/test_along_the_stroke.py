"""A stiffness along the stroke that was met beside a declared stiffness which stood in for it."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest

from feeddrive.diagnosis.diagnose import diagnose
from feeddrive.diagnosis.forms.along_the_stroke import _as_compliant
from feeddrive.effects.base import number
from feeddrive.effects.transmission.stiffness_vs_position import StiffnessVsPosition
from feeddrive.plant.file.plant_file import read_plant
from feeddrive.recording import read_recording
from tests.recovery.fleet.case import case


def _compliance(law: StiffnessVsPosition, places: np.ndarray) -> np.ndarray:
    """1 + b u + 4 m u (1 - u) of a law at places [m], (n,)."""
    low, high, share = (number(law.values[key]) for key in ("low", "high", "share_over_stroke"))
    u = (places - low) / (high - low)
    return 1 + share / (1 - share) * u + 4 * number(law.values["middle_compliance"]) * u * (1 - u)


@pytest.mark.parametrize("seed", range(6))
def test_the_same_compliance_is_written_about_another_stiffness(seed: int) -> None:
    random = np.random.default_rng([seed, 51])
    places = np.linspace(*np.sort(random.uniform(0.4, 0.9, 2)), 200)
    law = StiffnessVsPosition.of(share_over_stroke=float(random.uniform(0.1, 0.6)), low=0.0, high=1.0)
    softer = float(random.uniform(1.05, 1.4))
    laws = list(_as_compliant(law, softer, places))
    assert [number(one.values["middle_compliance"]) == 0.0 for one in laws] == [True, False]
    wanted = softer * _compliance(law, places)
    missed = [np.abs(_compliance(one, places) - wanted) for one in laws]
    assert np.linalg.norm(missed[1]) <= np.linalg.norm(missed[0]) + 1e-12  # the line is one of the parabolas
    # of the constant softer - 1 a parabola through zero misses up to 0.117 over 0.4 to 0.9
    assert np.max(missed[1]) < 0.12 * (softer - 1)


def test_a_law_that_no_plant_may_hold_is_none() -> None:
    law = StiffnessVsPosition.of(share_over_stroke=0.9, low=0.0, high=1.0)
    assert not list(_as_compliant(law, 8.0, np.linspace(0.5, 1.0, 50)))  # 0.986 of the stiffness lost: beyond 0.95


@pytest.mark.slow
def test_a_stiffness_that_stood_in_for_the_law_goes_back(tmp_path: Path) -> None:
    """0.68 of the stiffness lost along the stroke, met as 0.2 beside a stiffness thirteen deviations off."""
    drawn = case(9906)
    plant, fit, judge = drawn.write(tmp_path)
    result, (law,) = diagnose(read_plant(plant), [read_recording(fit)], [read_recording(judge)])
    assert law.name == "stiffness_vs_position"
    # the declared stiffness is 0.87 of the true one: within what is declared the two share what is told
    assert number(law.values["share_over_stroke"]) == pytest.approx(0.683, abs=0.1)
    torque = next(channel for channel in result.channels if channel.name == "motor_torque")
    assert torque.after.rms < 0.06 * torque.before.rms  # 0.11 beside the stiffness that stood in


@pytest.mark.slow
@pytest.mark.parametrize(
    ("seed", "names", "left"),
    [
        # a load that hangs on a spring that gives way with the square of the place: a lead error took as much alone
        (10003, {"stiffness_vs_position"}, 0.9),
        # the same law beside a late scale: a parabola that begins at none had the slope the wrong way round
        (10023, {"stiffness_vs_position", "channel_delay"}, 0.05),
    ],
)
def test_a_stiffness_along_the_stroke_is_found_where_the_declared_one_bends(
    seed: int, names: set[str], left: float, tmp_path: Path
) -> None:
    drawn = case(seed)
    plant, fit, judge = drawn.write(tmp_path)
    result, found = diagnose(read_plant(plant), [read_recording(fit)], [read_recording(judge)])
    assert {law.name for law in found} == names
    torque = next(channel for channel in result.channels if channel.name == "motor_torque")
    assert torque.after.rms < left * torque.before.rms  # 1.02 and 0.30 without it
