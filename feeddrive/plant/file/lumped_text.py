"""A machine of three inertias as the text of a plant file."""

from __future__ import annotations

import json
import math
from collections.abc import Mapping, Sequence
from typing import Any

from feeddrive.effects.base import Effect, Value
from feeddrive.effects.catalogue import EFFECTS
from feeddrive.effects.source.weight import Weight
from feeddrive.errors import InputError
from feeddrive.plant.chain.chain import ThreeInertias
from feeddrive.plant.file.ratings import RATINGS
from feeddrive.plant.motor_torque import declared_gain
from feeddrive.plant.plant import DeclaredCascade, Plant, PositionVelocityController
from feeddrive.recording.channels import channel_unit
from feeddrive.schema.toml_text import parse_toml


def plant_text_with_effects(original_text: str, effects: Sequence[Effect], remarks: Sequence[str] = ()) -> str:
    """The text of a plant file with further effects at its end.

    Args:
        original_text: of the plant file; kept as it is.
        effects: what is appended, each as a block `[[effect]]` with its values in full precision and SI units.
        remarks: one comment per effect, in their order; none of them, or as many as effects.

    Returns:
        Text that `read_plant` reads with identical values; an effect of a name that occurs already is numbered there.

    Raises:
        ValueError: another number of remarks than of effects.
        InputError: a value outside its physical range, or a text to which no block can be appended.
    """
    remarks = tuple(remarks) or ("",) * len(effects)
    blocks = [_block(effect, remark) for effect, remark in zip(effects, remarks, strict=True)]
    text = "\n".join([original_text.rstrip("\r\n") + "\n", *blocks]) if blocks else original_text
    try:
        parse_toml(text.removeprefix("\ufeff"), "plant with effects")
    except InputError as error:
        raise InputError(error.what, "plant with effects", "write the effects of the plant as [[effect]]") from None
    return text


def _block(effect: Effect, remark: str) -> str:
    effect.complete(effect.values)
    lines = [f"# {' '.join(_printable(remark).split())}"] if remark.strip() else []
    lines += ["[[effect]]", f'name = "{effect.name}"', f'port = "{effect.port}"']
    lines += [f'{effect.place_key} = "{effect.place}"'] if effect.place != effect.default_place else []
    given = [p for p in effect.parameters if p.key in effect.values]
    lines += [f"{p.key} = {_written(effect.values[p.key], p.unit)}" for p in given]
    return "\n".join(lines) + "\n"


def _printable(remark: str) -> str:
    """The remark without control characters, which a TOML comment may not hold."""
    return "".join(letter if letter.isprintable() else " " for letter in remark)


def _written(value: Value, unit: str) -> str:
    if isinstance(value, tuple):
        return f"[{', '.join(_written(number, unit) for number in value)}]"
    number = float(value)
    if not math.isfinite(number):
        raise InputError(f"{number} cannot be written to a plant file", mend="leave this effect out")
    return repr(number) if unit == "1" else f'"{number!r} {unit}"'


_SHOWN = {"N/m": (1e-6, "N/µm"), "m": (1e3, "mm"), "rad": (180 / math.pi, "deg")}
"""Units in which the files of this project write a value."""

_SECTIONS = ("motor", "ball_screw", "transmission", "table")


def lumped_text(
    plant: Plant,
    values: Mapping[str, float],
    effects: Sequence[Effect],
    remarks: Sequence[str],
    heading: Sequence[str],
    missed: Mapping[str, float],
) -> str:
    """The plant file of three inertias that stand for a machine.

    Args:
        plant: the machine, for what is carried over as it is: limits, ratings, stroke, sensors, controller.
        values: of the chain of three inertias, SI.
        effects, remarks: what acts on it, and a comment for each; what a section declares is not written twice.
        heading: lines of the comment at the top.
        missed: channel to the rms of what three inertias miss of it.
    """
    lines = [f"# {line}".rstrip() for line in heading]
    lines += [
        'format = "feeddrive-plant/1"',
        f"name = {_text(plant.name + ', lumped')}",
        'structure = "three_inertias"',
    ]
    lines += [f"source = {_text('lumped from ' + plant.name)}"]
    for section in _SECTIONS:
        lines += ["", f"[{section}]", *_section(plant, section, values)]
    for sensor in plant.sensors:
        lines += ["", "[[sensor]]", f"channel = {_text(sensor.channel)}", f"kind = {_text(sensor.kind)}"]
        lines += [f"at = {_text(sensor.at)}"]
        unit = channel_unit(sensor.channel, sensor.channel)
        for key, value in (("resolution", sensor.resolution), ("model_error", missed.get(sensor.channel, 0.0))):
            lines += [f"{key} = {_text(f'{value!r} {unit}')}"] if value else []
    lines += _controller(plant)
    written = [(effect, remark) for effect, remark in zip(effects, remarks, strict=True) if effect.name in EFFECTS]
    return plant_text_with_effects("\n".join(lines) + "\n", [e for e, _ in written], [r for _, r in written])


def _section(plant: Plant, section: str, values: Mapping[str, float]) -> list[str]:
    known = (*ThreeInertias.required, *ThreeInertias.optional)
    lines = [
        f"{value.section_key} = {_quantity(values[value.key], value.unit)}"
        for value in known
        if value.section == section and value.key in values
    ]
    if section == "motor" and math.isfinite(plant.torque_limit):
        lines.append(f"torque_limit = {_quantity(plant.torque_limit, 'N m')}")
    if section == "motor" and plant.torque_constant is not None:
        lines.append(f"torque_constant = {_quantity(plant.torque_constant, 'N m/A')}")
    if section == "motor" and declared_gain(plant) != 1.0:
        lines.append(f"torque_factor = {1 / declared_gain(plant):.6g}")
    if section == "table" and plant.stroke is not None:
        lines.append(f"stroke = [{', '.join(_quantity(end, 'm') for end in plant.stroke)}]")
    for effect in plant.effects_of(Weight) if section == "table" else ():
        lines += [f"{p.key} = {_quantity(float(effect.values[p.key]), p.unit)}" for p in effect.parameters]  # type: ignore[arg-type]
    for rating in RATINGS.get(section, ()):
        datum = plant.data.get(f"{section}.{rating.key}")
        if datum is not None:
            lines.append(f"{rating.key} = {_quantity(datum.value, datum.unit)}")
    return lines


def _controller(plant: Plant) -> list[str]:
    controller = plant.controller
    if isinstance(controller, PositionVelocityController):
        lines = [
            "",
            "[controller]",
            'kind = "position_velocity"',
            f'position_gain = "{controller.position_gain!r} 1/s"',
            f'velocity_gain = "{controller.velocity_gain!r} V s/m"',
            f'output_limit = "{controller.output_limit!r} V"',
            f'torque_per_output = "{controller.torque_per_output!r} N m/V"',
        ]
        return lines + ([f"velocity_samples = {controller.velocity_samples}"] if controller.velocity_samples else [])
    if isinstance(controller, DeclaredCascade):
        return ["", *_table("controller", {"kind": "cascade", **controller.entries})]
    return []


def _table(name: str, entries: Mapping[str, Any]) -> list[str]:
    """A table of TOML, its plain entries first, then its tables."""
    lines = [f"[{name}]"]
    later: list[str] = []
    for key, value in entries.items():
        if isinstance(value, Mapping):
            later += ["", *_table(f"{name}.{key}", value)]
        elif isinstance(value, list) and value and all(isinstance(one, Mapping) for one in value):
            for one in value:
                head, *rest = _table(f"{name}.{key}", one)
                later += ["", f"[{head}]", *rest]
        else:
            lines.append(f"{key} = {json.dumps(value, ensure_ascii=False)}")
    return [*lines, *later]


def _quantity(value: float, unit: str) -> str:
    if unit == "1":
        return repr(float(value))
    factor, shown = _SHOWN.get(unit, (1.0, unit))
    return _text(f"{value * factor:.12g} {shown}")


def _text(value: str) -> str:
    """A string of TOML; its basic strings are written as those of JSON."""
    return json.dumps(value, ensure_ascii=False)
