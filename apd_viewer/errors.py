"""Exception for unusable input."""


class InputError(ValueError):
    """Unusable input; the message states the problem and the remedy in one sentence.

    Raised only at the boundaries (files, command line, public functions). The window and the command line
    show the message unchanged; any other uncaught exception is a bug.

    Examples
    --------
    >>> import apd_viewer
    >>> try:
    ...     apd_viewer.open_mesh("nothing.obj")
    ... except apd_viewer.InputError as error:
    ...     print(error)
    There is no file nothing.obj; check the name.
    """
