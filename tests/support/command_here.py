"""The command of a dialog, run by this process: most tests are about what is asked for and shown of it."""

import io
import json
from contextlib import redirect_stdout

from PySide6.QtCore import QTimer

from apd_viewer.__main__ import main
from apd_viewer.ui.studies.command_process import CommandProcess


class CommandHere(CommandProcess):
    """Runs one command at a time, all of it in one turn of the event loop."""

    def __init__(self, parent):
        super().__init__(parent)
        self._words = None

    @property
    def is_running(self):
        return self._words is not None

    def start(self, words, **_):
        self._words = words
        QTimer.singleShot(0, self, self._run)

    def _run(self):
        said = io.StringIO()
        with redirect_stdout(said):
            status = main(self._words)
        self._words = None
        assert status == 0, said.getvalue()
        lines = said.getvalue().splitlines()
        for line in lines:
            if line.startswith('{"done"'):
                self.reported.emit(json.loads(line))
        self.ended.emit("\n".join(line for line in lines if not line.startswith('{"done"')).strip())
