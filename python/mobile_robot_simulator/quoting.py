"""Quoting: values as error messages show them, cut to a length that can be read."""

from __future__ import annotations

import math
import reprlib
from collections.abc import Iterable
from difflib import get_close_matches

import numpy as np

LONGEST = 200
"""Largest number of characters of a quoted value."""

SIMILARITY = 0.77
"""Similarity of two names, 0 to 1, from which one may be a misspelling of the other."""

SHORTEST_PART = 3
"""Smallest number of characters of a name that a longer one may begin or end with."""

_LONGEST_INT = 40
_CUT = "..."


class _Quoter(reprlib.Repr):
    """Formats like `repr`, but looks at a few items of each container and at a few levels only.

    Containers can share their items, as YAML aliases do. Nine levels of ten references each stand for a billion items, so
    the text must be cut while it is made, not afterwards.
    """

    def __init__(self) -> None:
        super().__init__()
        self.maxlevel = 3
        self.maxlist = self.maxtuple = self.maxdict = self.maxset = self.maxfrozenset = self.maxdeque = 8
        self.maxstring = self.maxother = LONGEST
        self.maxlong = _LONGEST_INT

    def repr_int(self, value: int, level: int) -> str:
        """Returns a large integer as its number of bits. Python takes quadratic time for its digits, or refuses."""
        return repr(value) if value.bit_length() <= 128 else f"an integer of {value.bit_length()} bits"

    def repr_instance(self, value: object, level: int) -> str:
        """Returns a NumPy number like a number of Python."""
        return super().repr_instance(value.item() if isinstance(value, np.generic) else value, level)

    def repr_bytes(self, value: bytes, level: int) -> str:
        """Returns the start of long bytes."""
        return _ended(repr(value[:LONGEST]))


def quoted(value: object) -> str:
    """Returns a value as `repr` shows it, cut to at most `LONGEST` characters.

    Args:
        value: Any object. Large or deeply nested containers are cut before their text is made.

    Example:
        >>> quoted("map.pgm")
        "'map.pgm'"
        >>> quoted(list(range(1000)))
        '[0, 1, 2, 3, 4, 5, 6, 7, ...]'
    """
    return _ended(_Quoter().repr(value))


def quoted_angle(angle: float) -> str:
    """Returns an angle that is out of range, with what it is in radians if it was meant in degrees.

    Args:
        angle: The angle [rad].

    Example:
        >>> quoted_angle(-90)
        '-90; -90° is -1.5708 rad'
        >>> quoted_angle(math.inf)
        'inf'
    """
    return f"{angle:g}; {angle:g}° is {math.radians(angle):.4f} rad" if math.isfinite(angle) else f"{angle}"


def shortened(text: object) -> str:
    """Returns the text of an object, on one line and cut to at most `LONGEST` characters.

    Args:
        text: An object whose text is short to make, for example the message of another error.
    """
    return _ended(" ".join(str(text).split()))


def misspelled(name: object, known: Iterable[str], count: int = 1) -> list[str]:
    """Returns the known names of which a name may be a misspelling, the most similar one first.

    Args:
        name: The name, in upper or lower case. Anything that is not text is like no name.
        known: The names that there are.
        count: Largest number of names to return.

    Example:
        >>> misspelled("laser_fow", ["laser_fov", "laser_seed"])
        ['laser_fov']
    """
    if not isinstance(name, str):
        return []
    by_lower = {other.lower(): other for other in known}
    return [by_lower[other] for other in get_close_matches(name[:100].lower(), by_lower, count, SIMILARITY)]


def nearest(name: object, known: Iterable[str], count: int = 1) -> list[str]:
    """Returns the known names that a user may have meant by an unknown one, the most similar one first.

    These are the names of which it may be a misspelling. If there are none, they are those that begin with it, or else those
    that end with it, unless these are more than `count`.

    Args:
        name: The name, in upper or lower case. Anything that is not text is like no name.
        known: The names that there are.
        count: Largest number of names to return.

    Example:
        >>> nearest("laser_fow", ["laser_fov", "laser_seed"])
        ['laser_fov']
        >>> nearest("sigma", ["incidence_sigma", "sigma_hit"])
        ['sigma_hit']
        >>> nearest("/foo", ["/odom", "/scan"])
        []
    """
    known = list(known)
    found = misspelled(name, known, count)
    if found or not isinstance(name, str) or len(name) < SHORTEST_PART:
        return found
    part = name.lower()
    begin, end = ([other for other in known if test(other.lower(), part)] for test in (str.startswith, str.endswith))
    longer = begin or end
    return longer if len(longer) <= count else []


def _ended(text: str) -> str:
    return text if len(text) <= LONGEST else text[: LONGEST - len(_CUT)] + _CUT
