"""The one error that a user can act on."""


class InputError(ValueError):
    """What was given cannot be used; the message says in one sentence what is wrong and what to do.

    Raised only at the borders (files, command line, public functions). The window and the command
    line show the message as it is; anything else that escapes is a defect of the program.
    """
