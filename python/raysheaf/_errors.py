"""The exceptions of raysheaf."""

from __future__ import annotations


class Error(Exception):
    """An error of raysheaf: one sentence that states what is wrong, and a place.

    All errors of the raysheaf library are of this class. Its subclasses also derive from the class
    that Python users expect: ``except ValueError`` catches an `InvalidError`.

    Attributes
    ----------
    code : str
        ``"invalid_argument"``, ``"invalid_data"``, ``"unsupported"``, ``"not_found"``, ``"io"``,
        ``"out_of_memory"``, ``"no_graphics"``, ``"wrong_state"``, ``"cancelled"`` or ``"internal"``.
    sentence : str
        What is wrong.
    place : str
        An argument, a field such as ``meshes[3].positions[17]``, a file; may be empty.
    """

    def __init__(self, code: str, sentence: str, place: str = "") -> None:
        super().__init__(f"{place}: {sentence}" if place else sentence)
        self.code = code
        self.sentence = sentence
        self.place = place

    def __reduce__(self) -> tuple[type, tuple[str, str, str]]:
        return type(self), (self.code, self.sentence, self.place)


class InvalidError(Error, ValueError):
    """A value is invalid: a vertex that is not finite, an index out of range, a zero direction."""


class NotFoundError(Error, LookupError):
    """A mesh, instance, camera, file or built-in scene does not exist, or no longer."""


class OutOfMemoryError(Error, MemoryError):
    """There is not enough memory. The scene is unchanged."""


class UnsupportedError(Error, NotImplementedError):
    """Valid, but not supported by this build or this machine."""


for _class in (Error, InvalidError, NotFoundError, OutOfMemoryError, UnsupportedError):
    _class.__module__ = "raysheaf"  # where users find them in the documentation

_CLASSES = {
    "invalid_argument": InvalidError,
    "invalid_data": InvalidError,
    "not_found": NotFoundError,
    "out_of_memory": OutOfMemoryError,
    "unsupported": UnsupportedError,
}


def error_of(code: str, sentence: str, place: str) -> Error:
    """The exception for an error of the C++ library; the extension calls this."""
    return _CLASSES.get(code, Error)(code, sentence, place)
