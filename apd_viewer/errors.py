"""Exception for unusable input, and the test for work that nobody waits for."""

from collections.abc import Callable
from contextvars import ContextVar

# Told by whoever runs work in a thread; asked by work that can be ended early.
is_cancelled: ContextVar[Callable[[], bool]] = ContextVar("is_cancelled", default=bool)
# Unprintable to Python, but not to people: spaces between a number and its unit, and what joins signs.
_KEPT = "\u00a0\u202f\u200c\u200d"


class InputError(ValueError):
    """Unusable input; the message states the problem and the remedy in one sentence.

    Raised only at the boundaries (files, command line, public functions). The window and the command line
    show the message unchanged; any other uncaught exception is a bug. Unprintable characters of quoted
    input, such as line breaks and lone surrogates, are shown as spaces.

    Examples
    --------
    >>> import apd_viewer
    >>> try:
    ...     apd_viewer.open_mesh("nothing.obj")
    ... except apd_viewer.InputError as error:
    ...     print(error)
    There is no file nothing.obj; check the name.
    """

    def __str__(self) -> str:
        return printable_text(super().__str__())


def printable_text(text: str) -> str:
    """Text on one line, with spaces for unprintable characters."""
    return "".join(sign if sign.isprintable() or sign in _KEPT else " " for sign in text)
