"""A plant of motion, of heat, and of both: the same class, and what one does not have is a plain answer."""

from __future__ import annotations

from pathlib import Path

import pytest

import feeddrive as fd
from feeddrive.effects.catalogue import EFFECTS, THERMAL_EFFECTS
from feeddrive.errors import InputError
from feeddrive.files import find_plant
from feeddrive.plant.analysis.lumping import lump
from feeddrive.plant.analysis.plausibility import check_plant
from feeddrive.plant.file.plant_file import read_plant
from feeddrive.plant.structure import parameter_names, structure_key

MOTION, HEAT, BOTH = (read_plant(find_plant(name)) for name in ("bench_axis", "thermal_bench", "warm_axis"))
SINK = THERMAL_EFFECTS["heat_sink"].of(conductance=0.5, capacity=900.0)
LEAD = EFFECTS["lead_error_cumulative"].of(slope=1e-5)


def test_what_is_not_declared_is_said() -> None:
    for ask, told in (
        (lambda: HEAT.chain, "heat alone, and this needs a machine with masses"),
        (lambda: lump(HEAT), "heat alone"),
        (lambda: HEAT.with_effects(LEAD), "lead_error_cumulative acts on motion"),
        (lambda: MOTION.heat, r"declares no heat; add \[thermal\]"),
        (lambda: MOTION.with_effects(SINK), "heat_sink acts on heat, and none is declared"),
        (lambda: HEAT.joined_heat, r"no \[thermal.coupling\]"),
    ):
        with pytest.raises(InputError, match=told):
            ask()
    assert (MOTION.has_motion, MOTION.has_heat) == (True, False)
    assert (HEAT.has_motion, HEAT.has_heat) == (False, True)
    assert (BOTH.has_motion, BOTH.has_heat) == (True, True)


def test_effects_stand_in_one_list_and_act_where_they_belong() -> None:
    plant = BOTH.with_effects(SINK, LEAD, SINK)
    count = len(BOTH.effects)
    assert [one.label for one in plant.effects[count:]] == ["heat_sink", "lead_error_cumulative", "heat_sink_2"]
    assert [one.label for one in plant.heat.effects] == ["heat_sink", "heat_sink_2"]
    assert [body.name for body in plant.heat.attached] == ["heat_sink", "heat_sink_2"]
    # effects on heat are no part of the equations of motion, nor of what they are compiled for
    assert parameter_names(plant) == parameter_names(BOTH.with_effects(LEAD))
    assert structure_key(plant) == structure_key(BOTH.with_effects(LEAD))


def test_friction_of_the_motion_heats_in_place_of_the_network_s_own() -> None:
    silent = BOTH.joined_heat
    assert silent.coupling == BOTH.coupling and BOTH.heat.coupling is None
    own = (BOTH.heat.nut, BOTH.heat.front, BOTH.heat.rear)
    assert all(one is not None and one.heat_share > 0 for one in own)
    assert all(one is not None and one.heat_share == 0 for one in (silent.nut, silent.front, silent.rear))


def test_a_file_may_be_wrong_in_either_part(tmp_path: Path) -> None:
    text = find_plant("warm_axis").read_text(encoding="utf-8")
    for old, new in (('\nmass = "250 kg"', '\nmass = "-250 kg"'), ('nut_length = "', 'nut_length = "-')):
        assert old in text
        path = tmp_path / "wrong.toml"
        path.write_text(text.replace(old, new), encoding="utf-8")
        with pytest.raises(InputError):
            read_plant(path)


def test_the_same_questions_are_answered_for_both_parts() -> None:
    rules = [finding.rule for finding in check_plant(BOTH)]
    assert {"motor torque to accelerate", "slowest time constant"} <= set(rules)
    assert [finding.rule for finding in check_plant(HEAT)] == rules[-len(check_plant(HEAT)) :]
    shown = fd.load("warm_axis").summary()
    assert "warm axis, heat" in [one.title for one in shown.tables()]
    alone = fd.load("thermal_bench").summary().record()
    assert set(shown.record()["heat"]) == set(alone) - {"format", "name", "structure"}


def test_lumping_says_that_it_leaves_the_heat_out() -> None:
    kimm = read_plant(find_plant("kimm_testbed"))
    assert not any("heat" in line for line in lump(kimm, kimm.middle).left_out)
    made = lump(BOTH)
    assert any(line.startswith("heat:") for line in made.left_out)
    assert not made.plant.has_heat
