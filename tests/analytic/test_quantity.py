"""Units at the border, against factors known in closed form."""

from __future__ import annotations

import math

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from feeddrive.effects.catalogue import EFFECTS, THERMAL_EFFECTS
from feeddrive.errors import InputError
from feeddrive.plant.chain.chain import CHAINS
from feeddrive.plant.file.drive_sections import BEARING_VALUES, PART_VALUES
from feeddrive.plant.file.ratings import RATINGS
from feeddrive.units.quantity import format_quantity, parse, split_quantity, unit_conversion, unit_factor
from feeddrive.units.usual_ranges import USUAL

WRITTEN = [
    ("20 mm", "m", 0.020),
    ("2 ft", "m", 0.6096),
    ("3 thou", "m", 7.62e-5),
    ("10 lb", "kg", 4.5359237),
    ("10 lbf", "N", 44.482216152605),
    ("10 lbf in", "N m", 44.482216152605 * 0.0254),
    ("25mm", "m", 0.025),
    ("7.6 µm", "m", 7.6e-6),  # micro sign
    ("7.6 μm", "m", 7.6e-6),  # Greek mu
    ("7.6 um", "m", 7.6e-6),
    ("244.7 N/µm", "N/m", 244.7e6),
    ("244.7 N/um", "N/m", 244.7e6),
    ("8650 N s/m", "N s/m", 8650.0),
    ("11982.4 N m/rad", "N m/rad", 11982.4),
    ("0.074 N m s/rad", "N m s/rad", 0.074),
    ("0.074 N m s", "N m s/rad", 0.074),
    ("0.02 N m/(rad/s)^(2/3)", "N m/(rad/s)^(2/3)", 0.02),
    ("2.6e-3 kg m^2", "kg m^2", 2.6e-3),
    ("2.6e-3 kg m²", "kg m^2", 2.6e-3),
    ("26 kgcm²", "kg m^2", 2.6e-3),
    ("30 Nm", "N m", 30.0),
    ("30 N·m", "N m", 30.0),
    ("12 m/min", "m/s", 0.2),
    ("90 deg", "rad", math.pi / 2),
    ("90°", "rad", math.pi / 2),
    ("1 rev", "rad", 2 * math.pi),
    ("3000 rev/min", "rad/s", 100 * math.pi),
    ("3000 rpm", "rad/s", 100 * math.pi),
    ("50 rev/s", "rad/s", 100 * math.pi),
    ("180 deg/s", "rad/s", math.pi),
    ("2 kHz", "Hz", 2000.0),
    ("50 1/s", "Hz", 50.0),
    ("1 (m/min)/mm", "1/s", 1000 / 60),
    ("23 degC", "degC", 23.0),
    ("23 °C", "degC", 23.0),
    ("273.15 K", "degC", 0.0),
    ("212 degF", "degC", 100.0),
    ("5 K", "K", 5.0),
    ("11.7 µm/(m K)", "1/K", 11.7e-6),
    ("1000 W/(m² K)", "W/(m^2 K)", 1000.0),
    ("5 %", "1", 0.05),
    ("20 µm/m", "1", 20e-6),
    (" -3.2 N ", "N", -3.2),
    (0.5, "1", 0.5),
    (3, "1", 3.0),
    ("0.5", "1", 0.5),
]

REFUSED = [
    (20, "m", "bare number"),
    ("20", "m", "bare number"),
    (20.0, "rad/s", "rev/min"),
    ("20 N", "m", "a length"),
    ("20 mm/rev", "m", "a length"),
    ("50 Hz", "rad/s", "a frequency, not a rotational speed"),
    ("50 1/s", "rad/s", "rev/min"),
    ("3000 min-1", "rad/s", "rev/min"),
    ("3000 rev/min", "Hz", "a frequency"),
    ("3000 rpm", "Hz", "a frequency"),
    ("314 rad/s", "Hz", "a frequency"),
    ("5 Hz", "1/s", "a frequency"),
    ("30 J", "N m", "an energy"),
    ("30 kJ", "N m", "an energy"),
    ("30 N m/rad", "N m", "a torque"),
    ("30 N m", "N m/rad", "it needs N m/rad"),
    ("5 rad", "1", "no unit"),
    ("5 °C", "K", "a difference"),
    ("20,5 mm", "m", "decimal comma"),
    ("20 MM", "m", 'did you mean "mm"'),
    ("1/3 mm", "m", "not one number"),
    ("2 2 mm", "m", "not one number"),
    ("mm", "m", "number"),
    ("", "m", "number"),
    ("1e999 m", "m", "finite"),
    ("nan m", "m", "number"),
    (float("nan"), "1", "number"),
    (True, "1", "not a quantity"),
    (None, "m", "not a quantity"),
    (["1 mm"], "m", "not a quantity"),
    ("5 " + "m" * 300, "m", "not a unit"),
    ("5 __import__('os').getcwd()", "m", "unknown unit"),
]


@pytest.mark.parametrize(("text", "unit", "expected"), WRITTEN)
def test_written_quantity_in_si(text: object, unit: str, expected: float) -> None:
    # Two roundings, of the factor and of the product; the offset of K and degF costs the digits of 273.15.
    assert parse(text, unit, "plant.toml, key") == pytest.approx(expected, rel=4e-16, abs=1e-13)


@pytest.mark.parametrize(("text", "unit", "said"), REFUSED)
def test_unusable_quantity_is_refused_in_one_line(text: object, unit: str, said: str) -> None:
    with pytest.raises(InputError) as caught:
        parse(text, unit, "plant.toml, screw.lead")
    message = str(caught.value)
    assert message.startswith("plant.toml, screw.lead: ")
    assert said in message
    assert caught.value.mend
    assert "\n" not in message


def test_bare_number_is_shown_with_its_unit() -> None:
    with pytest.raises(InputError, match=r'write it with its unit, e\.g\. "20 mm"'):
        parse(20, "m", "plant.toml, screw.lead")


@given(st.integers(min_value=-(10**9), max_value=10**9))
def test_whole_numbers_of_decimal_multiples_are_the_nearest_double(number: int) -> None:
    assert parse(f"{number} µm", "m", "") == float(f"{number}e-6")


@given(st.floats(min_value=-200.0, max_value=1e7).filter(lambda value: value == 0 or abs(value) > 1e-8))
def test_any_number_survives_its_own_unit(value: float) -> None:
    # Sizes that are possible in each of the units: a temperature is above the absolute zero.
    for unit in ("m", "N m/rad", "degC", "1"):
        assert parse(f"{value!r} {unit}" if unit != "1" else value, unit, "") == value


@given(
    st.floats(min_value=1e-9, max_value=1e9),
    st.sampled_from(
        [("mm", "m"), ("rev/min", "rad/s"), ("deg", "rad"), ("N/µm", "N/m"), ("m/min", "m/s"), ("g", "kg")]
    ),
)
def test_factor_is_linear_and_positive(value: float, units: tuple[str, str]) -> None:
    written, si = units
    factor = unit_factor(written, si, "")
    assert factor > 0.0
    # Each side rounds twice.
    assert parse(f"{value!r} {written}", si, "") == pytest.approx(value * factor, rel=4e-16)


@given(st.text(max_size=40))
def test_any_text_is_a_number_or_an_input_error(text: str) -> None:
    for unit in ("m", "rad/s", "degC", "1"):
        try:
            assert math.isfinite(parse(text, unit, "file"))
        except InputError as error:
            assert "\n" not in str(error)


def test_factor_refuses_an_offset() -> None:
    assert unit_factor("rev/min", "rad/s", "") == pytest.approx(math.pi / 30, rel=4e-16)
    with pytest.raises(InputError, match="offset"):
        unit_factor("K", "degC", "x.csv")


def test_conversion_of_an_array() -> None:
    kelvin = np.array([273.15, 300.0])
    # 273.15 has an ulp of 5.7e-14.
    np.testing.assert_allclose(unit_conversion("K", "degC", "").apply(kelvin), [0.0, 26.85], atol=6e-14)


def test_split_keeps_the_unit_as_written() -> None:
    assert split_quantity("0.4 mm/rad", "") == (0.4, "mm/rad")
    assert split_quantity("-2", "") == (-2.0, "1")


@pytest.mark.parametrize(
    ("value", "unit", "shown"),
    [
        (7.6e-6, "m", "7.6 µm"),
        (-7.6e-6, "m", "-7.6 µm"),
        (0.020, "m", "20 mm"),
        (1.2, "m", "1200 mm"),
        (1e-8, "m", "10 nm"),
        (0.0, "m", "0 mm"),
        (244.7e6, "N/m", "244.7 N/µm"),
        (100 * math.pi, "rad/s", "3000 rev/min"),
        (0.5, "m/s", "30 m/min"),
        (math.pi / 2, "rad", "90°"),
        (23.04, "degC", "23.04 °C"),
        (2.6e-3, "kg m^2", "0.0026 kg m²"),
        (11982.4, "N m/rad", "11980 N m/rad"),
        (21600.0, "s", "6 h"),
        (0.93214, "1", "0.9321"),
    ],
)
def test_shown_to_people(value: float, unit: str, shown: str) -> None:
    assert format_quantity(value, unit) == shown


@given(st.floats(min_value=1e-9, max_value=1e7), st.sampled_from(["m", "N/m", "N m", "m/s", "Hz", "rad/s", "N", "s"]))
def test_shown_quantity_reads_back_to_four_digits(value: float, unit: str) -> None:
    # Half a unit of the fourth digit is at most 5e-4 of the value.
    assert parse(format_quantity(value, unit), unit, "") == pytest.approx(value, rel=5.01e-4)


@pytest.mark.parametrize(
    ("text", "unit", "told"),
    [
        ("1e150 kg", "kg", ["above what is usual", "0.001 kg to 1000000 kg", "check the number and its unit"]),
        ("-1e150 N", "N", ["above what is usual"]),
        ("1e-300 N/µm", "N/m", ["below what is usual"]),
        ("1e300 N", "N", ["above what is usual"]),
        ("-275 degC", "degC", ["below the absolute zero", "-273.15 degC"]),
        ("-1 K", "degC", ["below the absolute zero"]),
        (1e14, "1", ["above what is usual"]),
    ],
)
def test_what_nobody_means_is_refused(text: object, unit: str, told: list[str]) -> None:
    with pytest.raises(InputError) as refused:
        parse(text, unit, "machine.toml, table.mass")
    line = str(refused.value)
    assert line.startswith("machine.toml, table.mass: ")
    assert not [part for part in told if part not in line]


def test_range_of_a_key_stands_before_that_of_its_unit() -> None:
    assert parse("1e6 m", "m", "") == 1e6
    with pytest.raises(InputError, match=r"0.5 mm to 200 mm"):
        parse("1e6 m", "m", "ball_screw.lead", usual=(5e-4, 0.2))


def test_zero_and_what_is_next_to_it() -> None:
    assert parse("0 N", "N", "") == 0.0
    assert parse("1e-300 N", "N", "", may_vanish=True) == 1e-300
    with pytest.raises(InputError, match="below what is usual"):
        parse("1e-300 N", "N", "")


def test_units_of_everything_declared_have_a_usual_range() -> None:
    declared = {parameter.unit for effect in [*EFFECTS.values(), *THERMAL_EFFECTS.values()]
                for parameter in effect.parameters}  # fmt: skip
    declared |= {value.unit for chain in CHAINS.values() for value in chain.required}
    parts = [*PART_VALUES.values(), *RATINGS.values(), BEARING_VALUES]
    declared |= {value.unit for values in parts for value in values}
    assert declared <= set(USUAL)
    assert all(0 < low < high for low, high in USUAL.values())
