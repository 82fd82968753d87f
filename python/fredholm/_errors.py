"""Exceptions of the same kinds as the exit codes of the command line."""

from __future__ import annotations

from typing import Any, Optional


class FredholmError(Exception):
    """An error that ends a study. Its text has all of what follows in it.

    Attributes
    ----------
    file : str or None
        File that is wrong, or that names what is wrong.
    line, column : int or None
        Place in a text file, from 1.
    byte : int or None
        Place in a file that is not text, from 0.
    help : str or None
        How to mend it.
    """

    file: Optional[str] = None
    line: Optional[int] = None
    column: Optional[int] = None
    byte: Optional[int] = None
    help: Optional[str] = None


class InputError(FredholmError, ValueError):
    """A scene, or what is asked of it, is not what it has to be (exit code 2)."""


class NotConvergedError(FredholmError, ArithmeticError):
    """A computation came to no usable result (exit code 3)."""


class ResourceError(FredholmError, MemoryError):
    """Memory, addresses or threads do not suffice; nothing was taken (exit code 4)."""


class FileError(FredholmError, OSError):
    """A file could not be read or written (exit code 5)."""


class Interrupted(KeyboardInterrupt):
    """Ctrl-C ended a study (exit code 130).

    Attributes
    ----------
    partial : object or None
        What the study would have returned, with what it had found by then; none where it had
        nothing.
    """

    def __init__(self, partial: Optional[object] = None) -> None:
        kept = "there is no partial result" if partial is None else "what was found is in .partial"
        super().__init__(f"interrupted; {kept}")
        self.partial: Any = partial


class FredholmWarning(UserWarning):
    """Something the user should know of a scene or a result."""


_KINDS = {kind.__name__: kind for kind in (InputError, NotConvergedError, ResourceError, FileError)}


def made(
    kind: str,
    message: str,
    file: Optional[str],
    line: Optional[int],
    column: Optional[int],
    byte: Optional[int],
    help: Optional[str],
) -> BaseException:
    """The exception of an error that the compiled part has met."""
    if kind == "Interrupted":
        return Interrupted()
    error = _KINDS[kind](message)
    error.file, error.line, error.column, error.byte, error.help = file, line, column, byte, help
    return error


def wrong(message: str, help: str) -> InputError:
    """The exception of an argument that is wrong, and how to mend it."""
    error = InputError(f"{message}\n  help: {help}")
    error.help = help
    return error
