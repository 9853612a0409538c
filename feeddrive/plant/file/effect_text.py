"""Effects as text of a plant file, so that a plant with what was found can be read again."""

from __future__ import annotations

import math
from collections.abc import Sequence

from feeddrive.effects.base import Effect, Value
from feeddrive.errors import InputError
from feeddrive.plant.file.entries import parse_toml


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
