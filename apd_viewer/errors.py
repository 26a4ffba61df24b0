"""Exception for unusable input, and the test for work that nobody waits for."""

import re
from collections.abc import Callable
from contextvars import ContextVar

# Told by whoever runs work in a thread; asked by work that can be ended early.
is_cancelled: ContextVar[Callable[[], bool]] = ContextVar("is_cancelled", default=bool)


# What would break a line, act on a terminal or not be encoded: control characters and lone surrogates.
_CONTROL = re.compile("[\x00-\x1f\x7f-\x9f\u2028\u2029\ud800-\udfff]")


class InputError(ValueError):
    """Unusable input; the message states the problem and the remedy in one sentence.

    Raised only at the boundaries (files, command line, public functions). The window and the command line
    show the message unchanged; any other uncaught exception is a bug. Control characters of quoted input are
    shown as spaces.

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
        return _CONTROL.sub(" ", super().__str__())
