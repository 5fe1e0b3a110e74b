"""Converts names, numbers and paths for the extension, or raises an exception."""

from __future__ import annotations

import operator
import os
import re
from datetime import datetime
from typing import Any, Optional


def number(value: Any, name: str) -> float:
    """A real number, including numpy's; text that spells a number is refused."""
    try:
        if not isinstance(value, (str, bytes, bytearray)):
            return float(value)
    except OverflowError:
        raise ValueError(f"{name}: {value!r} is given; a float is expected") from None
    except (TypeError, ValueError):
        pass
    raise TypeError(f"{name}: {value!r} is given; a real number is expected")


def text(value: Any, name: str) -> str:
    """Text that can be encoded in UTF-8."""
    if not isinstance(value, str):
        raise TypeError(f"{name}: {value!r} is given; a str is expected")
    try:
        value.encode()
    except UnicodeEncodeError:
        raise ValueError(
            f"{name}: {value!r} is given, which UTF-8 cannot write; a name in UTF-8 is expected"
        ) from None
    return value


def is_second(value: Any, name: str, first: str, second: str) -> bool:
    """Whether the value is `second`; raises an exception if it is neither word."""
    if not isinstance(value, str) or value not in (first, second):
        wrong = ValueError if isinstance(value, str) else TypeError
        raise wrong(f'{name}: {value!r} is given; "{first}" or "{second}" is expected')
    return value == second


def text_or_index(value: Any, name: str) -> tuple[str, Optional[int]]:
    """A name; or an integer as its digits, and as a number if it is small enough."""
    if isinstance(value, str):
        return text(value, name), None
    try:
        number = operator.index(value)
    except TypeError:
        raise TypeError(f"{name}: {value!r} is given; a str or an integer is expected") from None
    return str(number), number if 0 <= number < 2**32 else None


def point(value: Any, name: str) -> tuple[float, float, float]:
    """Three real numbers."""
    if isinstance(value, (str, bytes, bytearray)):
        raise TypeError(f"{name}: {value!r} is given; three real numbers are expected")
    try:
        x, y, z = value
    except (TypeError, ValueError):
        raise ValueError(f"{name}: {value!r} is given; three real numbers are expected") from None
    return number(x, name), number(y, name), number(z, name)


def sun(value: Any, name: str) -> tuple[tuple[float, float, float], bool]:
    """Three real numbers, and whether they are a place and a time in seconds since 1970."""
    try:
        time = value[2]
    except (TypeError, IndexError, KeyError):
        time = None
    if not isinstance(time, datetime):
        return point(value, name), False
    if time.tzinfo is None:
        raise ValueError(f"{name}: {time!r} is given; a datetime with a tzinfo is expected")
    north, east, seconds = point((value[0], value[1], time.timestamp()), name)
    if not (abs(north) <= 90 and abs(east) <= 360):
        raise ValueError(
            f"{name}: {north:g} and {east:g} are given; degrees north, -90 to 90, and east are expected"
        )
    return (north, east, seconds), True


_COLOURS = {"white": (255, 255, 255, 255), "black": (0, 0, 0, 255), "transparent": (0, 0, 0, 0)}


def background(value: Any, name: str) -> tuple[int, int, int, int]:
    """sRGB and alpha from a colour's name or "#rrggbb"."""
    word = text(value, name)
    if word in _COLOURS:
        return _COLOURS[word]
    if re.fullmatch("#[0-9a-fA-F]{6}", word):
        red, green, blue = bytes.fromhex(word[1:])
        return red, green, blue, 255
    raise ValueError(
        f"{name}: {value!r} is given; \"white\", \"black\", \"transparent\" or \"#rrggbb\" is expected"
    )


def file_name(value: Any, name: str) -> str:
    """The path of a file, as Python opens it."""
    try:
        path = os.fsdecode(value)
    except TypeError:
        raise TypeError(
            f"{name}: {value!r} is given; a str, bytes or os.PathLike is expected"
        ) from None
    if "\0" in path:
        raise ValueError(f"{name}: {path!r} has a null character in it; a path is expected")
    return path


def path_in_utf8(value: Any, name: str) -> str:
    """The path of a file in UTF-8, as the extension opens it."""
    return text(file_name(value, name), name)
