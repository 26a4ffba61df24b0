"""A study run by the command line in a process of its own."""

from __future__ import annotations

import json
from collections.abc import Sequence
from pathlib import Path
from typing import Any

from PySide6.QtCore import QObject, Signal

from apd_viewer.cases.local_pool import core_count
from apd_viewer.files.storage.atomic_file import replacing_file
from apd_viewer.files.storage.regular_files import read_bytes
from apd_viewer.language import tr
from apd_viewer.ui.studies.command_process import CommandProcess
from apd_viewer.ui.studies.study_files import PLAN_FILE

RUN_FILE = "run.json"
_SCHEDULERS = "--scheduler", "--scheduler-file"
_PROCESSES = "--processes"
# Each with a value. A folder may come from anybody: nothing else reaches the command.
_KEPT = (*_SCHEDULERS, _PROCESSES, "--limit")


class StudyRun(QObject):
    """Runs one study at a time; what it has finished stays in its folder.

    Attributes
    ----------
    folder : Path or None
        Of the study that runs.
    stopping : bool
        Whether it only finishes the running cases.
    reported : Signal(object)
        Its progress, a dict as in a line of ``--progress-lines``.
    ended : Signal(object, str)
        The folder of the study that runs no more; a sentence if it has not ended by itself.
    command : CommandProcess
    """

    reported = Signal(object)
    ended = Signal(object, str)

    def __init__(self, parent: QObject) -> None:
        super().__init__(parent)
        self.folder: Path | None = None
        self.stopping = False
        self.command = CommandProcess(self)
        self.command.reported.connect(self.reported)
        self.command.ended.connect(lambda _: self._end(""))
        self.command.failed.connect(self._fail)

    @property
    def running(self) -> bool:
        """True while a study runs."""
        return self.command.running

    def begin(self, folder: Path, options: Sequence[str] | None = None, retry_failed: bool = False) -> None:
        """Run the plan of a folder, or go on with it.

        Parameters
        ----------
        folder : Path
        options : sequence of str or None
            Of the command, about where it runs; None for those of the last time.
        retry_failed : bool
            Whether failed cases are run again.

        Raises
        ------
        InputError
            If the folder cannot be written.
        """
        if options is None:
            options = stored_options(folder)
        else:
            _keep_options(folder, options)
        self.folder, self.stopping = folder, False
        words = ["study", str(folder / PLAN_FILE), "-o", str(folder), *options, "--progress-lines"]
        words += ["--retry-failed"] if retry_failed else []
        self.command.start(words)

    def stop(self) -> None:
        """Finish the running cases; at the second call end at once."""
        if not self.running:
            return
        if self.stopping or not self.command.interrupt():
            self.kill()
        else:
            self.stopping = True

    def kill(self) -> None:
        """End it; what runs is computed again when it goes on."""
        if self.running:
            self.command.cancel()
            self._end(_stopped())

    def _fail(self, sentence: str) -> None:
        self._end(_stopped() if self.stopping else sentence)

    def _end(self, sentence: str) -> None:
        folder, self.folder, self.stopping = self.folder, None, False
        self.ended.emit(folder, sentence)


def _stopped() -> str:
    return tr("Stopped; the finished cases are kept.")


def _keep_options(folder: Path, options: Sequence[str]) -> None:
    with replacing_file(folder / RUN_FILE) as scratch:
        scratch.write_text(json.dumps({"options": list(options)}), encoding="utf-8")


def stored_options(folder: Path) -> list[str]:
    """Options of the command of the last time, as the folder has them."""
    try:
        said: Any = json.loads(read_bytes(folder / RUN_FILE))
        words = [str(word) for word in said["options"]]
    except (OSError, ValueError, KeyError, TypeError, RecursionError):
        return []  # begun elsewhere, or edited: it runs here
    if not set(words[::2]) <= set(_KEPT) or len(words) % 2:
        return []
    said = dict(zip(words[::2], words[1::2], strict=True))
    if said.get(_PROCESSES, "").isdecimal():  # perhaps of a larger machine
        said[_PROCESSES] = str(min(int(said[_PROCESSES][:4]), core_count()))
    return [word for pair in said.items() for word in pair]


def scheduler_option(options: Sequence[str]) -> str:
    """Address or file of a scheduler among the options; empty without one."""
    values = dict(zip(options[::2], options[1::2], strict=True))
    return next((values[name] for name in _SCHEDULERS if name in values), "")


def may_continue(folder: Path) -> bool:
    """True if the folder holds the plan of a study."""
    return (folder / PLAN_FILE).is_file()
