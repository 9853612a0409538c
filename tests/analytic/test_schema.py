"""Schema = readers = reference = errors: every declared key is read, every key that is read is declared.

Each key in turn is given a value that nothing can mean. Its reader has to refuse that value at that very key; a key
that is declared and not read would pass, and one that is not declared would be called unknown.
"""

from __future__ import annotations

import copy
import warnings
from collections.abc import Callable, Iterator
from pathlib import Path
from typing import Any

import pytest

import feeddrive as fd
from feeddrive.diagnosis.numbers.measured_file import MEASURABLE, read_measured_numbers
from feeddrive.errors import InputError, ValidityWarning
from feeddrive.files import find_scenario_file, plants_folder
from feeddrive.interface.keys import ROOTS, every_section
from feeddrive.plant.file.plant_file import plant_from_entries
from feeddrive.plant.plant import DeclaredCascade
from feeddrive.recording.files.channel_mapping import read_mapping
from feeddrive.schema.key import Key, Kind
from feeddrive.schema.section import Section, UndeclaredKeyError
from feeddrive.schema.table import Origins, Table
from feeddrive.schema.toml_text import read_toml
from feeddrive.simulate.scenario.scenario_controller import read_cascade
from feeddrive.simulate.scenario.scenario_file import read_scenario
from feeddrive.units.quantity import unit_conversion

NONSENSE = {"nonsense": "nobody means this"}
PATH = Path("machine.toml")


def written(value: Any) -> str:
    """A value as TOML, tables inline."""
    if isinstance(value, bool):
        return str(value).lower()
    if isinstance(value, dict):
        return "{ " + ", ".join(f"{key} = {written(one)}" for key, one in value.items()) + " }"
    if isinstance(value, list | tuple):
        return "[" + ", ".join(map(written, value)) + "]"
    return f'"{value}"' if isinstance(value, str) else repr(value)


def saved(entries: dict[str, Any], folder: Path) -> Path:
    path = folder / "file.toml"
    path.write_text("\n".join(f"{key} = {written(value)}" for key, value in entries.items()), encoding="utf-8")
    return path


def example(key: Key) -> Any:
    """A value that the key may have."""
    if key.choices:
        return key.choices[0]
    if key.kind is Kind.WHOLE:
        return max(1, int(key.minimum)) if key.minimum > -1e300 else 1
    if key.kind is Kind.SWITCH:
        return False
    if key.kind in (Kind.TEXT, Kind.WORDS):
        return "word"
    low, high = max(key.minimum, -1e6), min(key.maximum, 1e6)
    inside = 1.0 if low < 1.0 < high else low + 0.3 * (high - low)
    inside = 2.0 if key.name == "duration" else inside  # a step has to end before it
    of_another = " rad/s" if key.name == "amplitude" else ""  # its unit depends on where an excitation acts
    unit = of_another if key.unit in ("", "1") else f" {key.unit}"
    one = inside if not unit else f"{inside!r}{unit}"
    return [one, f"{inside * 1.01!r}{unit}" if unit else inside * 1.01] if key.kind is Kind.QUANTITIES else one


def sample(section: Section, fixed: dict[str, Any]) -> dict[str, Any]:
    """A table with every key that is required, `fixed` before all."""
    needed = {key.name: example(key) for key in section.keys.values() if key.required}
    gains = {"position_gain": "20 1/s", "velocity_gain": "1 N m s/rad"} if "velocity_rate" in needed else {}
    return {**needed, **gains, **fixed}


def plants() -> Iterator[dict[str, Any]]:
    """Machines of every structure, of parts and of values, with heat and without."""
    shipped = {name: read_toml(plants_folder() / f"{name}.toml", "plant file") for name in fd.list_plants()}
    yield from (shipped[name] for name in ("warm_axis", "hsr_axis", "bench_axis", "emps", "vertical_axis"))
    geared = copy.deepcopy(shipped["vertical_axis"])
    geared["gear"] = geared.pop("belt")
    yield geared
    catalogued = copy.deepcopy(shipped["hsr_axis"])
    catalogued["guide"] = {"carriage": "HGH25HA", "carriages": 4}
    yield catalogued
    ground = copy.deepcopy(shipped["hsr_axis"])
    ground["guide"] = {
        "carriages": 4, "ball_diameter": "5.556 mm", "rail_conformity": 0.52, "carriage_conformity": 0.52,
        "contact_angle": "45 deg", "preload_oversize": "5 um", "balls_per_row": 12,
    }  # fmt: skip
    yield ground
    yield shipped["thermal_bench"]


PLANTS = list(plants())


def read_plant_entries(entries: dict[str, Any]) -> None:
    """Everything that any command reads of a plant file."""
    plant = plant_from_entries(entries, PATH)
    if isinstance(plant.controller, DeclaredCascade):
        read_cascade(Table(plant.controller.entries, plant.controller.where, Origins()), plant)


def places(root: Section) -> Iterator[tuple[tuple[str, ...], Section, str]]:
    """Steps into a file, the section with its keys, and the kind that has to be chosen there; "" for none."""

    def inside(section: Section, steps: tuple[str, ...]) -> Iterator[tuple[tuple[str, ...], Section, str]]:
        yield steps, section, ""
        for word in section.kinds:
            kind = section.of_kind(word)
            yield steps, kind, word
            for name, inner in section.kinds[word].sections.items():
                yield from ((at, one, f"{word}/{chosen}") for at, one, chosen in inside(inner, (*steps, name)))
        for name, inner in section.sections.items():
            yield from inside(inner, (*steps, "motor_torque" if name == "*" else name))

    yield from inside(root, ())


def cases(root: str) -> list[Any]:
    found: dict[str, Any] = {}
    for steps, section, kind in places(ROOTS[root]):
        for key in section.keys.values():
            label = ".".join((*steps, *([kind] if kind else []), key.name))
            found.setdefault(label, pytest.param(steps, section, kind, key, id=label))
    return list(found.values())


def put(
    entries: dict[str, Any], root: Section, steps: tuple[str, ...], section: Section, kind: str, key: Key
) -> dict[str, Any] | None:
    """The entries with nonsense at a key; None where this file has no such place."""
    made = copy.deepcopy(entries)
    at, declared = made, root
    outer, _, inner_kind = kind.partition("/")
    for step in steps:
        before = declared
        declared = before.sections.get(step) or before.sections.get("*") or before.kinds[outer].sections[step]
        if before.kinds and step in before.kinds[outer].sections if outer else False:
            at.update(sample(before.of_kind(outer), {before.kind_key: outer}))
        if declared.listed:
            word = inner_kind or outer
            fixed = {declared.kind_key: word} if declared.kinds and word in declared.kinds else {}
            held = at.get(step)
            first = sample(section, fixed) if fixed or not held else dict(held[0])
            at[step] = [first]
            at = first
            continue
        if not isinstance(at.get(step), dict):
            at[step] = sample(declared, {})
        at = at[step]
    if declared.kinds and kind and not declared.listed:
        word = inner_kind or outer
        at.clear()
        at.update(sample(declared.of_kind(word), {declared.kind_key: word}))
    at[key.name] = NONSENSE
    return made


def refused_at(key: Key, read: Callable[[], object]) -> str:
    """What the reader says of the nonsense; "" where it says nothing of this key."""
    with warnings.catch_warnings():
        warnings.simplefilter("ignore", ValidityWarning)
        try:
            read()
        except InputError as error:
            unknown = f'unknown key "{key.name}"' in error.what
            named = key.name in error.where.replace(",", ".").replace(" ", ".").split(".") or key.name in error.what
            return str(error) if named and not unknown else ""
    return ""


@pytest.mark.parametrize(("steps", "section", "kind", "key"), cases("plant"))
def test_every_key_of_a_plant_is_read(steps: tuple[str, ...], section: Section, kind: str, key: Key) -> None:
    if key.name == "format" and not steps:
        pytest.skip("told as a whole: the file is not of this version")
    told = []
    for entries in PLANTS:
        made = put(entries, ROOTS["plant"], steps, section, kind, key)
        if made is not None:
            told.append(refused_at(key, lambda made=made: read_plant_entries(made)))
            if told[-1]:
                return
    pytest.fail(f"no reader refuses nonsense at {'.'.join((*steps, key.name))}")


@pytest.mark.parametrize(("steps", "section", "kind", "key"), cases("controller"))
def test_every_key_of_a_controller_is_read(steps: tuple[str, ...], section: Section, kind: str, key: Key) -> None:
    plant = plant_from_entries(PLANTS[2], PATH)
    entries = {**read_toml(find_scenario_file("controllers/bench_axis.toml"), "controller file")}
    made = put(entries, ROOTS["controller"], steps, section, kind, key)
    assert refused_at(key, lambda: read_cascade(Table(made or {}, "controller.toml", Origins()), plant))


def scenario_entries() -> dict[str, Any]:
    return {
        "format": "feeddrive-scenario/1", "plant": "bench_axis",
        "controller": read_toml(find_scenario_file("controllers/bench_axis.toml"), "controller file"),
        "trajectory": {"kind": "hold", "position": "1 mm", "duration": "0.1 s"},
        "record": {"channels": list(fd.keys("scenario.record").keys[1].choices)},
    }  # fmt: skip


def of_scenario(section: Section) -> bool:
    """Whether a section is told apart from those of plants and controllers, which are looked at above."""
    return not section.path.startswith(("plant.", "controller", "scenario.effect", "scenario.controller"))


@pytest.mark.parametrize(
    ("steps", "section", "kind", "key"), [case for case in cases("scenario") if of_scenario(case.values[1])]
)
def test_every_key_of_a_scenario_is_read(
    steps: tuple[str, ...], section: Section, kind: str, key: Key, tmp_path: Path
) -> None:
    if key.name == "format":
        pytest.skip("told as a whole: the file is not of this version")
    made = put(scenario_entries(), ROOTS["scenario"], steps, section, kind, key)
    if made is not None and "excitation" in made:  # its keys depend on the waveform
        shapes = [{"waveform": word} for word in section.key("waveform").choices]
        told = [refused_at(key, lambda one=one: _scenario({**made, "excitation": {**made["excitation"], **one,
                "low": "1 Hz", "high": "9 Hz", "period": "1 s", "bit": "1 ms", "order": 5, "duration": "1 s",
                key.name: NONSENSE}}, tmp_path)) for one in shapes]  # fmt: skip
        assert any(told)
        return
    if kind == "wave":
        shapes = [{"waveform": word} for word in section.key("waveform").choices]
        told = [refused_at(key, lambda one=one: _scenario({**made, "trajectory": {**made["trajectory"], **one,
                "low": "1 Hz", "high": "9 Hz", "period": "1 s", "bit": "1 ms", "order": 5, "duration": "1 s",
                key.name: NONSENSE}}, tmp_path)) for one in shapes]  # fmt: skip
        assert any(told)
        return
    assert refused_at(key, lambda: _scenario(made, tmp_path))


def _scenario(entries: dict[str, Any] | None, folder: Path) -> object:
    return read_scenario(saved(entries or {}, folder))


@pytest.mark.parametrize(("steps", "section", "kind", "key"), cases("mapping"))
def test_every_key_of_a_mapping_is_read(
    steps: tuple[str, ...], section: Section, kind: str, key: Key, tmp_path: Path
) -> None:
    if key.name in ("format", "description"):
        pytest.skip("told as a whole, or never looked at: a sentence for people")
    variable = {"variable": "u", "unit": "N m"}
    entries: dict[str, Any] = {"format": "feeddrive-map/1", "channels": {"motor_torque": variable}}
    if steps[:1] == ("time",):
        entries["time"] = {"variable": "t", "unit": "s"}
    elif key.name != "rate":
        entries["sample_time"] = "1 ms"
    made = put(entries, ROOTS["mapping"], steps, section, kind, key)
    assert refused_at(key, lambda: read_mapping(saved(made or {}, tmp_path)))


@pytest.mark.parametrize(("steps", "section", "kind", "key"), cases("measured"))
def test_every_key_of_a_measured_number_is_read(
    steps: tuple[str, ...], section: Section, kind: str, key: Key, tmp_path: Path
) -> None:
    if key.name == "format":
        pytest.skip("told as a whole: the file is not of this version")
    plant = plant_from_entries(PLANTS[1], PATH)
    told = []
    for quantity, kind_of in MEASURABLE.items():
        number = {"quantity": quantity, "value": f"100 {kind_of.unit}", "at": "100 mm", "source": "measured"}
        made = put({"measured": [number]}, ROOTS["measured"], steps, section, kind, key)
        told.append(refused_at(key, lambda made=made: read_measured_numbers(saved(made or {}, tmp_path), plant)))
    assert any(told)


def test_measurable_quantities_are_the_declared_ones() -> None:
    assert ROOTS["measured"].inner("measured").keys["quantity"].choices == tuple(MEASURABLE)


SECTIONS = every_section()


@pytest.mark.parametrize("section", SECTIONS, ids=lambda one: one.path)
def test_every_key_says_what_it_is(section: Section) -> None:
    assert section.meaning
    for key in section.keys.values():
        assert key.meaning, f"{section.path}.{key.name}"
        if key.unit:
            unit_conversion(key.unit, key.unit, key.name)
        if key.default is not None and key.kind is Kind.QUANTITY and key.unit:
            fd.si(key.default if key.unit != "1" else float(key.default), key.unit, f"{section.path}.{key.name}")


def test_a_key_that_is_not_declared_cannot_be_read() -> None:
    guide = Table({"weight": "3 kg"}, "machine.toml, guide", Origins(), section=ROOTS["plant"].inner("guide"))
    with pytest.raises(UndeclaredKeyError, match="declares no key weight"):
        guide.quantity("weight", "kg", "")
    with pytest.raises(UndeclaredKeyError, match="declared in N and read in kg"):
        guide.quantity("load", "kg", "")
    with pytest.raises(UndeclaredKeyError, match="declares no weight"):
        guide.refuse_unknown(("weight",))
    with pytest.raises(UndeclaredKeyError, match="coefficients is declared as one of"):
        guide.choice("coefficients", ("A", "B", "C"), "A")


@pytest.mark.parametrize("path", [one.path for one in SECTIONS if "*" not in one.path])
def test_reference_is_the_schema(path: str) -> None:
    if path.startswith(("plant.controller.cascade", "scenario.effect", "scenario.controller")):
        pytest.skip("a section of another file, shown there")
    shown = fd.keys(path)
    section = next(one for one in SECTIONS if one.path == path)
    assert {key.name for key in section.keys.values()} <= {key.name for key in shown.keys}
    rows = {row[0]: row for row in shown.listing().rows}
    for key in section.keys.values():
        assert key.meaning in rows[key.name][-1] and (key.unit or str(key.kind)) == rows[key.name][1]


def test_errors_quote_unit_and_range() -> None:
    bench = copy.deepcopy(PLANTS[2])
    bench["table"]["mass"] = 134
    with pytest.raises(InputError, match=r"bare number.*mass \[kg\] is mass that moves with the table.*usual 0.2 kg"):
        plant_from_entries(bench, PATH)
    parts = copy.deepcopy(PLANTS[1])
    parts["table"]["mass"] = 320
    with pytest.raises(InputError, match="320 is a bare number") as refused:
        plant_from_entries(parts, PATH)
    assert refused.value.where == "machine.toml, table.mass"
    del bench["table"]["mass"]
    with pytest.raises(InputError, match=r"is missing.*mass \[kg\] is mass that moves with the table"):
        plant_from_entries(bench, PATH)


@pytest.mark.parametrize(
    ("base", "section", "key", "value", "words"),
    [
        (1, "support", "kind", "fixed-simple",
         "write one of fixed-free, fixed-supported, supported-supported, fixed-fixed"),
        (1, "guide", "carriage", "HSR-25R",
         r"HSR-20R, HSR-30R the geometry is known; or write a geometry in place of the name: ball_diameter"),
        (2, "ball_screw", "diameter", "32 mm", "it counts in a machine described by its parts"),
        (2, "transmission", "drive_stiffness", "1 N m/rad", 'use structure = "distributed_screw"'),
        (2, "motor", "part", "SGM7J-04A", "it counts in a machine described by its parts"),
        (1, "ball_screw", "part", "R32-10K5", "near are R32-10K5-FDC"),
        (1, "motor", "part", "R32-32K2-FDC", "is a screw, not a motor"),
    ],
)  # fmt: skip
def test_near_misses_name_what_is_meant(base: int, section: str, key: str, value: str, words: str) -> None:
    entries = copy.deepcopy(PLANTS[base])
    entries.setdefault(section, {})[key] = value
    with pytest.raises(InputError) as refused:
        plant_from_entries(entries, PATH)
    assert words in str(refused.value)


_SAME = [(section, key) for section in ROOTS["plant"].inner("effect").kinds.values() for key in section.keys.values()
         if key.default is not None and not key.choices and key.kind is Kind.QUANTITY]  # fmt: skip


@pytest.mark.parametrize(("section", "key"), _SAME, ids=lambda one: getattr(one, "path", getattr(one, "name", "")))
def test_a_declared_default_is_what_is_read_without_it(section: Section, key: Key) -> None:
    """The reference's default, written, gives the effect that leaving it out gives; it is shown in four digits."""
    name = section.path.rpartition(".")[2]
    bare = sample(section, {})
    if name == "stiffness_vs_position":  # an effect by itself has no stroke from which its ends could follow
        bare |= {"low": "0 mm", "high": "400 mm"}
    without = fd.effect(name, **bare)
    value = float(key.default or 0) if key.unit == "1" else key.default
    found = fd.effect(name, **bare, **{key.name: value}).values
    for name, held in without.values.items():
        assert found[name] == (held if isinstance(held, tuple) else pytest.approx(held, rel=1e-3))


def test_defaults_of_sections_are_those_of_the_readers() -> None:
    """Shown defaults of parts, written out, make the same chain as leaving them out."""
    parts = copy.deepcopy(PLANTS[1])
    without = plant_from_entries(parts, PATH)
    for name in ("ball_screw", "coupling", "guide", "table"):
        for key in ROOTS["plant"].inner(name).keys.values():
            if key.default is not None and key.name not in parts[name] and "carriage" not in key.when:
                text = int(key.default) if key.kind is Kind.WHOLE else key.default
                parts[name][key.name] = float(text) if key.unit == "1" and key.kind is Kind.QUANTITY else text
    with_all = plant_from_entries(parts, PATH)
    assert with_all.chain.values == pytest.approx(without.chain.values, rel=1e-3)
    assert [one.values for one in with_all.effects] == [one.values for one in without.effects]
