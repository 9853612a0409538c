"""Every effect of both catalogues has a reading in words."""

from __future__ import annotations

import pytest

from feeddrive.diagnosis.judging.physical_reading import physical_reading
from feeddrive.effects.catalogue import EFFECTS, THERMAL_EFFECTS

ALL = {**EFFECTS, **THERMAL_EFFECTS}


@pytest.mark.parametrize("name", ALL)
def test_effect_has_a_reading(name: str) -> None:
    effect = ALL[name]
    values = {
        parameter.key: (0.1,) if parameter.table else min(max(parameter.size, parameter.minimum), parameter.maximum)
        for parameter in effect.parameters
    }
    made = effect(values=values, port=effect.ports[0], label=name, place=next(iter(effect.places), "nut"))
    sentence = physical_reading(made)
    assert sentence.endswith(".") and len(sentence.split()) > 4
