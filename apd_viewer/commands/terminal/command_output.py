"""Output of a command at its end: lines for people, and JSON for scripts."""

import json
from collections.abc import Callable, Sequence
from pathlib import Path
from typing import Any, NamedTuple

# Option value for JSON on the standard output, in place of the lines.
STANDARD_OUTPUT = "-"


def json_text(fields: Any) -> str:
    """JSON of an output, ending with a line break."""
    return json.dumps(fields, indent=2) + "\n"


def json_path(asked: str | None) -> Path | None:
    """File named by ``--json``; None without one."""
    return None if asked in (None, STANDARD_OUTPUT) else Path(asked)


class CommandOutput(NamedTuple):
    """Result of a command.

    Attributes
    ----------
    lines : sequence of str
        For people.
    fields : callable
        Computes what ``--json`` prints or writes; not called without it.
    status : int
        Exit status.
    """

    lines: Sequence[str]
    fields: Callable[[], Any]
    status: int = 0

    def show(self, asked: str | None) -> None:
        """Print the lines, or JSON instead of them, or write JSON beside them.

        Parameters
        ----------
        asked : str or None
            Value of ``--json``: a file, STANDARD_OUTPUT, or None without the option.

        Raises
        ------
        InputError
            If the file cannot be written.
        """
        if asked is not None:
            said = json_text(self.fields())
            if (path := json_path(asked)) is None:
                print(said, end="")
                return
            # Imported here: options and errors should not wait for numpy.
            from apd_viewer.files.storage.atomic_file import replacing_file

            with replacing_file(path) as scratch:
                scratch.write_text(said, encoding="utf-8")
        for line in self.lines:
            print(line)
