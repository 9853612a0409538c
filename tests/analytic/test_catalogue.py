"""The parts catalogue: what it holds, that it is read as printed, and how a plant file takes and overrides it."""

from __future__ import annotations

import copy
import math
import warnings
from pathlib import Path
from typing import Any

import pytest

import feeddrive as fd
from feeddrive.errors import InputError
from feeddrive.files import plants_folder
from feeddrive.parts.catalogue.part_files import CataloguePart, catalogue
from feeddrive.parts.guide.guide_rating import rated_friction
from feeddrive.parts.values import check_values
from feeddrive.plant.file.drive_sections import BEARING_VALUES, PART_VALUES
from feeddrive.plant.file.plant_file import plant_from_entries
from feeddrive.plant.file.ratings import RATINGS
from feeddrive.schema.toml_text import read_toml
from feeddrive.units.quantity import parse

PARTS = list(catalogue().values())


def si(text: object, unit: str) -> float:
    return parse(text, unit, "catalogue")


@pytest.mark.parametrize(
    ("kind", "least"), [("screw", 60), ("bearing", 14), ("guide", 25), ("coupling", 15), ("motor", 20)]
)
def test_there_are_parts_of_every_kind(kind: str, least: int) -> None:
    assert len(fd.list_parts(kind)) >= least


@pytest.mark.parametrize("part", PARTS, ids=lambda one: one.name)
def test_every_value_is_possible_usual_and_has_a_source(part: CataloguePart) -> None:
    assert part.source and part.address and part.size and part.maker
    for section, values in part.sections.items():
        if section == "guide":
            assert si(values["seal_drag"], "N") > 0
            continue
        known = {one.key: one for one in (*PART_VALUES.get(section, ()), *RATINGS.get(section, ()))}
        if section == "bearing":
            known = {one.key: one for one in BEARING_VALUES}
        given = {key: si(value, known[key].unit) for key, value in values.items() if key in known}
        assert set(values) - set(given) <= {"torque_constant"}
        with warnings.catch_warnings():
            warnings.simplefilter("error")
            check_values(part.name, tuple(known[key] for key in given), given)


def test_screws_are_of_the_size_that_their_name_says() -> None:
    for part in fd.list_parts("screw"):
        first, second, *_ = part.name[1:].replace("K", "-").replace("T", "-").split("-")
        diameter, lead = float(first), float(second)
        screw = part.sections["ball_screw"]
        assert si(part.further["nominal_diameter"], "m") == pytest.approx(diameter * 1e-3)
        assert si(screw["lead"], "m") == pytest.approx(lead * 1e-3)
        # The balls of a screw of this size are 6 to 30 % of its diameter, and the root lies that far below it or less.
        assert 0.7 < si(screw["root_diameter"], "m") / si(screw["diameter"], "m") < 0.97
        if "nut" in part.sections:  # the maximum possible preload is a tenth of the dynamic rating
            share = si(part.sections["nut"]["catalogue_preload"], "N") / si(screw["dynamic_rating"], "N")
            assert share == pytest.approx(0.1, rel=1e-6)


SINGLE_NUTS = {
    "R14-10K3-FDC": 240, "R20-05K4-FDC": 420, "R20-10K3-FDC": 320, "R20-20K2-FDC": 210, "R25-05K4-FDC": 490,
    "R25-10K4-FDC": 560, "R25-20K3-FDC-22.3": 390, "R25-20K3-FDC-21.7": 430, "R32-05K4-FDC": 570,
    "R32-10K5-FDC-28.7": 850, "R32-10K5-FDC-28.1": 860, "R32-10K5-FDC-26.9": 900, "R32-20K3-FDC": 520,
    "R32-20K4-FDC": 720, "R32-32K2-FDC": 340, "R32-40K2-FDC": 320, "R38-10K4-FDC": 810, "R38-20K4-FDC": 830,
    "R38-25K4-FDC": 830, "R40-05K5-FDC": 850, "R40-10K5-FDC": 1060, "R40-20K4-FDC": 870, "R40-40K2-FDC": 420,
    "R50-05K5-FDC": 950, "R50-10K5-FDC": 1250, "R50-20K4-FDC-44.9": 1040, "R50-20K4-FDC-42.5": 1130,
    "R50-40K3-FDC": 790, "R63-10K5-FDC": 1440, "R63-20K5-FDC-57.9": 1570, "R63-20K5-FDC-55.5": 1680,
    "R63-40K2-FDC": 620,
}  # fmt: skip
"""Rigidity of the single nut of the same circuits at 30 % of the dynamic rating [N/µm], table 6.4 of the catalogue."""


@pytest.mark.parametrize("name", SINGLE_NUTS)
def test_double_nut_over_single_nut_is_that_of_hertz(name: str) -> None:
    """Two nuts at 10 % preload over one at 30 % load: 2 (1/3)^(1/3) = 1.387 for contacts alone.

    What yields besides contacts (nut body, screw) brings both closer: to no less than 1.25 where it makes a third.
    """
    double = si(catalogue()[name].sections["nut"]["catalogue_stiffness"], "N/m")
    assert 1.25 < double / (SINGLE_NUTS[name] * 1e6) < 1.387


PRINTED_ACCELERATION = {
    "SGM7J-A5A": 40200, "SGM7J-01A": 48200, "SGM7J-C2A": 52100, "SGM7J-02A": 24200, "SGM7J-04A": 26100,
    "SGM7J-06A": 23800, "SGM7J-08A": 15000, "SGMSH-10AA": 18250, "SGMSH-15AA": 19840, "SGMSH-20AA": 19970,
    "SGMSH-30AA": 14000, "SGMSH-40AA": 13160, "SGMSH-50AA": 12780, "SGMAH-A3A": 57500, "SGMAH-A5B": 72300,
    "SGMAH-01B": 87400, "SGMAH-02B": 60100, "SGMAH-04A": 73600,
}  # fmt: skip
"""Rated angular acceleration [rad/s^2], printed beside torque and inertia by the same makers."""


@pytest.mark.parametrize("name", PRINTED_ACCELERATION)
def test_torque_over_inertia_is_the_printed_acceleration(name: str) -> None:
    """An inertia or a torque that were read wrongly would not give what the maker prints of both."""
    part = catalogue()[name]
    inertia = si(part.sections["motor"]["rotor_inertia"], "kg m^2")
    # three printed digits each, and the maker rounds the quotient to three or four
    assert si(part.further["rated_torque"], "N m") / inertia == pytest.approx(PRINTED_ACCELERATION[name], rel=0.012)


@pytest.mark.parametrize(
    ("name", "section", "key", "printed", "unit"),
    [
        ("R32-10K5-FDC-26.9", "nut", "catalogue_stiffness", "1190 N/um", "N/m"),
        ("R32-10K5-FDC-26.9", "ball_screw", "dynamic_rating", "56400 N", "N"),
        ("R63-10T6-FDI", "nut", "catalogue_stiffness", "2280 N/um", "N/m"),
        ("R40-40K4-DFSCDIN", "ball_screw", "root_diameter", "32.9 mm", "m"),
        ("35TAB07DF", "bearing", "axial_stiffness", "1230 N/um", "N/m"),
        ("GWB AKD 300", "coupling", "torsional_stiffness", "280e3 N m/rad", "N m/rad"),
        ("GWB AK 80", "coupling", "inertia", "0.65e-3 kg m^2", "kg m^2"),
        ("HG-KN73J", "motor", "rotor_inertia", "1.28e-4 kg m^2", "kg m^2"),
        ("HGH45HA", "guide", "seal_drag", "7.66 N", "N"),
    ],
)
def test_values_are_those_printed(name: str, section: str, key: str, printed: str, unit: str) -> None:
    assert si(catalogue()[name].sections[section][key], unit) == pytest.approx(si(printed, unit), rel=1e-9)


def axis() -> dict[str, Any]:
    entries = read_toml(plants_folder() / "hsr_axis.toml", "plant file")
    entries["ball_screw"] = {"part": "R32-10K5-FDC-26.9", "length": "1.2 m"}
    entries["nut"] = {"part": "R32-10K5-FDC-26.9", "preload": "2.82 kN"}
    entries["bearing"] = {"near": {"part": "20TAB04DF"}, "far": {"part": "20TAB04DF", "axial_stiffness": "700 N/um"}}
    entries["motor"] = {"part": "SGMSH-10AA"}
    entries["coupling"] = {"part": "GWB AKD 30"}
    return entries


def test_a_part_gives_what_the_file_leaves_out() -> None:
    plant = plant_from_entries(axis(), Path("axis.toml"))
    assert plant.drive is not None
    assert plant.drive.screw.lead == 0.01 and plant.drive.screw.root_diameter == 0.02691
    # half the catalogue's preload: R_n = 0.8 R (F_pr / 0.1 C)^(1/3), as the catalogue itself says
    assert plant.drive.nut.axial_stiffness == pytest.approx(0.8 * 1190e6 * 0.5 ** (1 / 3), rel=1e-9)
    assert plant.drive.supports.near.axial_stiffness == 735e6
    assert plant.drive.supports.far is not None and plant.drive.supports.far.axial_stiffness == 700e6
    assert plant.torque_limit == 9.54 and plant.torque_constant == 0.636
    assert plant.origins["ball_screw.lead"].startswith("catalogue: R32-10K5-FDC-26.9, HIWIN Ballscrews")
    assert plant.data["ball_screw.dynamic_rating"].value == 56400


def test_a_nut_of_its_own_takes_the_place_of_the_catalogues() -> None:
    entries = axis()
    entries["nut"] = {"part": "R32-10K5-FDC-26.9", "axial_stiffness": "500 N/um"}
    plant = plant_from_entries(entries, Path("axis.toml"))
    assert plant.drive is not None and plant.drive.nut.axial_stiffness == 500e6
    entries["nut"] = {"part": "R32-10K5-FSCDIN"}
    with pytest.raises(InputError, match=r"prints no stiffness of the nut.*write axial_stiffness"):
        plant_from_entries(entries, Path("axis.toml"))


def test_check_tells_what_differs_from_its_part(tmp_path: Path) -> None:
    text = (plants_folder() / "hsr_axis.toml").read_text(encoding="utf-8")
    text = text.replace('lead = "16 mm"', 'part = "R32-10K5-FDC-26.9"\nlead = "12 mm"\n')
    copied = 'diameter = { value = "40 mm", source = "catalogue: R32-10K5-FDC-26.9, HIWIN Ballscrews" }'
    text = text.replace('\ndiameter = "40 mm"', f"\n{copied}").replace('root_diameter = "35.2 mm"\n', "")
    path = tmp_path / "axis.toml"
    path.write_text(text, encoding="utf-8")
    found = {one.rule: one for one in fd.load(path).check().warnings}
    lead, diameter = found["ball_screw.lead as its part"], found["ball_screw.diameter as its part"]
    assert (lead.value, lead.limit) == (0.012, 0.01)
    assert lead.source == "prints R32-10K5-FDC-26.9"
    assert diameter.source == "prints R32-10K5-FDC-26.9; the file's source still names it"
    assert not any(rule.startswith("ball_screw.root_diameter") for rule in found)


def test_what_is_the_parts_own_value_is_no_departure() -> None:
    entries = axis()
    entries["ball_screw"]["lead"] = "1 cm"
    from feeddrive.plant.file.named_parts import departures

    entries["guide"] = {"carriage": "HGH25HA", "carriages": 4, "seal_drag": "3.92 N", "friction_coefficient": 0.006}
    found = {one.key: (one.written, one.catalogue) for one in departures(entries, "axis.toml")}
    assert found == {"bearing.far.axial_stiffness": (7e8, 7.35e8), "guide.friction_coefficient": (0.006, 0.004)}


def test_friction_of_a_rated_carriage() -> None:
    """Without load both pairs carry the preload; beyond 2 sqrt(2) of it one is free and the other carries the load."""
    assert rated_friction(0.0, 500.0, 0.004, 4.0) == pytest.approx(0.004 * 1000 + 4, rel=1e-9)
    assert rated_friction(5000.0, 500.0, 0.004, 4.0) == pytest.approx(0.004 * 5000 + 4, rel=1e-6)
    assert rated_friction(-5000.0, 0.0, 0.004, 4.0) == pytest.approx(0.004 * 5000 + 4, rel=1e-6)
    # in between the catalogue's own F = mu W + S is exceeded, and the sum of loads lies between both ends
    assert 0.004 * 1000 < rated_friction(800.0, 500.0, 0.004, 0.0) < 0.004 * math.sqrt(8) * 500
    # Hertz: F_A^(2/3) + F_B^(2/3) = 2 F_0^(2/3); with F_A = 800 N the other is known, and so are load and sum
    other = (2 * 500 ** (2 / 3) - 800 ** (2 / 3)) ** 1.5
    assert rated_friction(800 - other, 500.0, 0.004, 0.0) == pytest.approx(0.004 * (800 + other), rel=1e-6)


@pytest.mark.parametrize(
    ("guide", "coulomb"),
    [
        # 320 kg on four carriages; Z0 is a hundredth of 42.2 kN: load 784.5 N, preload 422 N, seals 3.92 N each
        ({"carriage": "HGH25HA"}, None),
        ({"carriage": "HGH25HA", "preload": "0 N"}, 4 * (0.004 * 320 * 9.80665 / 4 + 3.92)),
        ({"carriage": "HGH25HA", "load": "9 kN", "friction_coefficient": 0.003, "seal_drag": "1 N"}, 4 * (27 + 1)),
        ({"carriage": "HGH25HA", "load": "0 N", "preload_class": "ZB"}, 4 * (0.004 * 2 * 0.11 * 42200 + 3.92)),
    ],
)
def test_guide_of_the_catalogue(guide: dict[str, Any], coulomb: float | None) -> None:
    entries = read_toml(plants_folder() / "hsr_axis.toml", "plant file")
    entries["guide"] = {**guide, "carriages": 4}
    plant = plant_from_entries(entries, Path("axis.toml"))
    found = next(one for one in plant.effects if one.name == "guide_friction")
    expected = 4 * rated_friction(320 * 9.80665 / 4, 422.0, 0.004, 3.92) if coulomb is None else coulomb
    assert found.values["coulomb"] == pytest.approx(expected, rel=1e-6)
    assert "HGH25HA" in plant.origins["guide_friction.coulomb"]


@pytest.mark.parametrize(
    ("guide", "words"),
    [
        ({"carriage": "HGH25CA"}, 'write the preload of one carriage, such as preload = "400 N"'),
        ({"carriage": "HGH25HA", "preload_class": "heavy"}, "write one of Z0, ZA, ZB"),
        ({"carriage": "HGH25HA", "coefficients": "A"}, "it counts with a geometry"),
    ],
)
def test_guide_refusals_carry_their_remedy(guide: dict[str, Any], words: str) -> None:
    entries = read_toml(plants_folder() / "hsr_axis.toml", "plant file")
    entries["guide"] = {**guide, "carriages": 4}
    with pytest.raises(InputError) as refused:
        plant_from_entries(entries, Path("axis.toml"))
    assert words in str(refused.value)


def test_measured_numbers_see_the_values_of_parts(tmp_path: Path) -> None:
    """Values that a part gives may be other than declared like any other."""
    from feeddrive.diagnosis.numbers.declared_values import declared_values
    from feeddrive.plant.file.named_parts import with_named_parts

    filled = with_named_parts(axis(), "axis.toml")
    keys = {one.key for one in declared_values(filled, 1e8)}
    assert {"nut.catalogue_stiffness", "bearing.near.axial_stiffness", "coupling.torsional_stiffness"} <= keys
    again = with_named_parts(copy.deepcopy(filled), "axis.toml")
    assert again == filled


def test_asking_for_parts() -> None:
    names = [one.name for one in fd.list_parts("screw", diameter="32mm", lead=0.01)]
    assert "R32-10K5-FDC-26.9" in names and "R32-10K5-FSCDIN" in names and len(names) == 6
    assert all(si(one.further["rated_torque"], "N m") >= 50 for one in fd.list_parts("coupling", torque="50 N m"))
    none = fd.list_parts("screw", diameter="33 mm")
    assert (
        len(none) == 0
        and none.listing().caption == "none has a diameter of 33 mm; the nearest have 32 mm, 38 mm, 40 mm"
    )
    with pytest.raises(InputError, match="one can ask for diameter, lead"):
        fd.list_parts("screw", bore="20 mm")
    with pytest.raises(InputError, match="write one of screw, bearing, guide, coupling, motor"):
        fd.list_parts("nut")
