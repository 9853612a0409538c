"""Which effects may act together in one plant; what has no meaning is refused, never ignored."""

from __future__ import annotations

from collections.abc import Mapping, Sequence

from feeddrive.effects.base import BristleEffect, ChainEffect, Effect, FrictionEffect, Port, TransmissionEffect
from feeddrive.effects.friction.viscous_asymmetry import ViscousAsymmetry
from feeddrive.errors import InputError


def refuse_what_cannot_compose(effects: Sequence[Effect], elastic: bool, where: str) -> None:
    """Refuse effects that cannot act together in a plant whose transmission is elastic or not, whatever their values.

    Two bristles at one port, an effect of the transmission or one that reads its force in a rigid structure, one effect
    twice that does not add, or an effect on a friction that is not declared.
    """
    _refuse_two_bristles(effects, where)
    _refuse_duplicates(effects, where)
    _refuse_friction_without_level(effects, where)
    if not elastic:
        _refuse_what_needs_springs(effects, where)


def refuse_what_misses_values(effects: Sequence[Effect], values: Mapping[str, float], structure: str) -> None:
    """Refuse effects that change a value of the chain which its structure does not have.

    Raises:
        InputError: names effect, value and structure.
    """
    for effect in effects:
        if isinstance(effect, ChainEffect):
            try:
                effect.chain(dict(values), effect.values)
            except KeyError as missing:
                what = f"{effect.name} changes {missing.args[0]}, which the structure {structure} does not have"
                raise InputError(what, effect.name, "use another structure or effect") from None


def _refuse_what_needs_springs(effects: Sequence[Effect], where: str) -> None:
    mend = 'use structure = "three_inertias" with the stiffness of the transmission'
    for effect in effects:
        adds = isinstance(effect, ChainEffect) and effect.adds_coordinate
        if isinstance(effect, TransmissionEffect) or adds:
            raise InputError(f"{effect.name} needs an elastic transmission, the structure is rigid", where, mend)
        if effect.reads_force:
            what = f"{effect.name} reads the force that the nut transmits, which a rigid structure does not tell"
            raise InputError(what, where, mend)


def _refuse_two_bristles(effects: Sequence[Effect], where: str) -> None:
    bristles = [effect.name for effect in effects if isinstance(effect, BristleEffect)]
    if len(bristles) > 1:
        raise InputError(f"two bristles at one port: {' and '.join(bristles)}", where, "keep one of them")


def _refuse_duplicates(effects: Sequence[Effect], where: str) -> None:
    seen: set[tuple[str, Port]] = set()
    for effect in effects:
        if not effect.additive and (effect.name, effect.port) in seen:
            what = f"{effect.name} acts twice at port {effect.port}"
            raise InputError(what, where, "keep one, its values those of both together")
        seen.add((effect.name, effect.port))


def _refuse_friction_without_level(effects: Sequence[Effect], where: str) -> None:
    """Refuse an effect on the Coulomb level of a port that declares no friction: it would act on nothing."""
    declared = {effect.port for effect in effects if isinstance(effect, FrictionEffect) and effect.declared}
    for effect in effects:
        free = not isinstance(effect, FrictionEffect) or isinstance(effect, ViscousAsymmetry)
        if not free and effect.port not in declared:
            needed = "guide_friction" if effect.port == Port.TABLE else "nut_drag or bearing_drag"
            what = f"{effect.name} acts on the friction of port {effect.port}, which declares none"
            raise InputError(what, where, f"add {needed}")
