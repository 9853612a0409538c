"""What a written unit may be, asked before any library sees it: names, a product, small exponents, nothing else.

    product  = power { ("*" | "/" | space) power }
    power    = (name | "1" | "(" product ")") [ ("^" | "**") exponent ]
    exponent = [sign] number | "(" [sign] number [ "/" number ] ")"

A number other than 1 stands only in an exponent. The library evaluates what it is given as arithmetic: 9**9**9 in a
heading would fill the memory.
"""

from __future__ import annotations

import re
from fractions import Fraction

LONGEST = 80
"""Letters of a unit at most; the longest in use, N m/(rad/s)^(2/3), has 17."""

DEEPEST = 4
"""Brackets in brackets at most; a product of a mapping, ((m/min)/mm) * (V), has two."""

LARGEST_EXPONENT = 6
"""The largest in use is 4, of a second moment of area; a unit to the seventh is none that is measured."""

MOST_FACTORS = 20
"""Sum of the sizes of all exponents at most: the largest prefix, to this power, is still a number."""

_TOKEN = re.compile(r"\s*(?:(?P<name>(?:[^\W\d]|[°%])+)|(?P<number>\d{1,3}(?:\.\d{1,3})?)|(?P<sign>\*\*|[\^*/()+-]))")


class GrammarError(ValueError):
    """A text that is no unit; the message says what stands in it that must not."""


def check_unit(text: str) -> None:
    """Refuse a text that is not a product of names with small exponents.

    Raises:
        GrammarError: too long, a letter or sign that does not belong there, a number, an exponent beyond
            `LARGEST_EXPONENT`, too many factors, brackets that do not match or lie too deep.
    """
    if len(text) > LONGEST:
        raise GrammarError(f"has {len(text)} letters")
    reader = _Reader(_tokens(text))
    if reader.product(0) > MOST_FACTORS:
        raise GrammarError(f"is a product of more than {MOST_FACTORS} factors")
    if reader.next:
        raise GrammarError(f'has "{reader.next}" where a unit ends')


def _tokens(text: str) -> list[str]:
    found, place, end = [], 0, len(text.rstrip())
    while place < end:
        match = _TOKEN.match(text, place)
        if match is None:
            raise GrammarError(f'holds "{text[place:].lstrip()[:1]}"')
        found.append(match[0].strip())
        place = match.end()
    return found


class _Reader:
    """The tokens of a text, read from the left."""

    def __init__(self, tokens: list[str]) -> None:
        self.tokens, self.place = tokens, 0

    @property
    def next(self) -> str:
        return self.tokens[self.place] if self.place < len(self.tokens) else ""

    def take(self) -> str:
        token = self.next
        self.place += 1
        return token

    def product(self, depth: int) -> Fraction:
        """Read a product; return the sum of the sizes of its exponents."""
        factors = self.power(depth)
        while self.next and self.next not in (")", "^", "**", "+", "-"):
            if self.next in ("*", "/"):
                self.take()
            factors += self.power(depth)
        return factors

    def power(self, depth: int) -> Fraction:
        token, factors = self.take(), Fraction(1)
        if token == "(":
            if depth == DEEPEST:
                raise GrammarError("has too many brackets in brackets")
            factors = self.product(depth + 1)
            self.expect(")")
        elif token and token[0].isdigit():
            if token != "1":
                raise GrammarError(f"holds the number {token}")
        elif not token or token[0] in "*/^)+-":
            raise GrammarError(f'has "{token}" where a name is needed' if token else "ends where a name is needed")
        if self.next in ("^", "**"):
            self.take()
            factors *= abs(self.exponent())
        return factors

    def exponent(self) -> Fraction:
        if self.next == "(":
            self.take()
            value = self.signed()
            if self.next == "/":
                self.take()
                below = self.number()
                if not below:
                    raise GrammarError("divides an exponent by 0")
                value /= below
            self.expect(")")
        else:
            value = self.signed()
        if abs(value) > LARGEST_EXPONENT:
            raise GrammarError(f"has the exponent {float(value):g}, beyond {LARGEST_EXPONENT}")
        return value

    def signed(self) -> Fraction:
        sign = -1 if self.next == "-" else 1
        if self.next in ("+", "-"):
            self.take()
        return sign * self.number()

    def number(self) -> Fraction:
        token = self.take()
        if not token or not token[0].isdigit():
            raise GrammarError("has an exponent that is no number")
        return Fraction(token)

    def expect(self, token: str) -> None:
        if self.take() != token:
            raise GrammarError("has a bracket that is not closed")
