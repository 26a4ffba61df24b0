"""Command of the command line, run in its own process.

A QProcess, because it emits signals on the GUI thread; a ChildProcess would need another thread.
"""

import json
import os
import signal
import sys
from functools import partial
from pathlib import Path

from PySide6.QtCore import QObject, QProcess, QProcessEnvironment, Signal

from apd_viewer.language import tr

# Started with -c, since -m would import modules from the current folder.
_START = """
import os, sys
count = int(sys.argv[1])
sys.path[:], words = sys.argv[2 : 2 + count], sys.argv[2 + count :]
if hasattr(os, "nice"):
    os.nice(10)  # the window comes first
from apd_viewer.__main__ import main
sys.exit(main(words))
"""
_ERROR = "error: "
_PATIENCE = 5000  # ms to wait for a killed process


class CommandProcess(QObject):
    """Runs one command at a time.

    Attributes
    ----------
    reported : Signal(object)
        Its progress: a dict of ``done``, a share, of ``doing`` and of whatever else the command tells.
    process_id : int
        Of the process started last, as the operating system counts them; 0 before.
    ended : Signal(str)
        Output of a successful command.
    failed : Signal(str)
        Sentence on the reason of a failure.
    """

    reported = Signal(object)
    ended = Signal(str)
    failed = Signal(str)

    def __init__(self, parent: QObject) -> None:
        super().__init__(parent)
        self._process: QProcess | None = None
        self._said: list[str] = []
        self.process_id = 0

    @property
    def is_running(self) -> bool:
        """True while a command runs."""
        return self._process is not None

    def start(self, arguments: list[str], scratch: Path | None = None) -> None:
        """Start the command with the given arguments; none may be running.

        Its temporary files are in ``scratch``, since a killed command cannot remove them.
        """
        assert self._process is None
        self._said = []
        self._process = process = QProcess(self)
        process.readyReadStandardOutput.connect(partial(self._read, process))
        process.finished.connect(partial(self._finish, process))
        process.errorOccurred.connect(partial(self._report_failed_start, process))
        if scratch is not None:
            process.setProcessEnvironment(_with_temporary_files_in(scratch))
        process.start(sys.executable, ["-c", _START, str(len(sys.path)), *sys.path, *arguments])
        self.process_id = process.processId()

    def cancel(self) -> None:
        """Kill the command; neither ``ended`` nor ``failed`` is emitted."""
        process, self._process = self._process, None
        if process is not None:
            process.kill()
            process.waitForFinished(_PATIENCE)
            process.deleteLater()

    def interrupt(self) -> bool:
        """Interrupt the command as Ctrl+C does; False if signals are unsupported."""
        if self._process is None or not hasattr(os, "getuid"):  # a process cannot be sent SIGINT on Windows
            return False
        os.kill(self._process.processId(), signal.SIGINT)
        return True

    def _read(self, process: QProcess) -> None:
        while process is self._process and process.canReadLine():
            line = process.readLine().toStdString().rstrip()
            if line.startswith('{"done"'):
                self.reported.emit(json.loads(line))
            else:
                self._said.append(line)

    def _finish(self, process: QProcess, status: int, way: QProcess.ExitStatus) -> None:
        self._read(process)
        if process is not self._process:  # the process was cancelled
            return
        self._process = None
        process.deleteLater()
        if status == 0 and way is QProcess.ExitStatus.NormalExit:
            self.ended.emit("\n".join(self._said).strip())
            return
        errors = process.readAllStandardError().toStdString().splitlines()
        sentences = [line.removeprefix(_ERROR) for line in errors if line.startswith(_ERROR)]
        self.failed.emit(sentences[-1] if sentences else tr("The work ended unexpectedly; try again."))

    def _report_failed_start(self, process: QProcess, error: QProcess.ProcessError) -> None:
        if error is QProcess.ProcessError.FailedToStart and process is self._process:
            self._process = None
            process.deleteLater()
            self.failed.emit(tr("The process could not be started; close other programs."))


def _with_temporary_files_in(folder: Path) -> QProcessEnvironment:
    environment = QProcessEnvironment.systemEnvironment()
    for name in ("TMPDIR", "TEMP", "TMP"):
        environment.insert(name, str(folder))
    return environment
