"""Study run by the command line in its own process."""

import json
import os
from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import Any, NamedTuple

from PySide6.QtCore import QObject, Signal

from apd_viewer.cases.case import Case
from apd_viewer.cases.design import DesignVariable, design_table
from apd_viewer.cases.local_pool import core_count
from apd_viewer.cases.plan_columns import SETTING_COLUMNS
from apd_viewer.errors import InputError
from apd_viewer.files.storage.atomic_file import replacing_file
from apd_viewer.files.storage.regular_files import read_bytes
from apd_viewer.files.tables import write_table
from apd_viewer.language import tr
from apd_viewer.session.model.document import Document
from apd_viewer.session.model.handle_paths import handle_paths
from apd_viewer.session.model.state import State
from apd_viewer.session.model.view import View
from apd_viewer.session.posing.motion_path import motion_paths
from apd_viewer.session.posing.motion_text import motion_steps
from apd_viewer.session.quantities.units import Unit
from apd_viewer.session.storage.session_file import save_session
from apd_viewer.ui.studies.command_process import CommandProcess
from apd_viewer.ui.studies.varied_fields import SHARE_COLUMN, QuantityRange

PLAN_FILE, SESSION_FILE = "plan.csv", "session.apd"
PlanRows = tuple[list[str], list[list[str]]]
RUN_FILE = "run.json"
_SCHEDULERS = "--scheduler", "--scheduler-file"
_PROCESSES = "--processes"
# Options accepted from a study folder, which may be untrusted, each with one value.
_KEPT = (*_SCHEDULERS, _PROCESSES, "--limit")


class StudyDesign(NamedTuple):
    """Design of a study: ranges, methods and sampling of its cases.

    Attributes
    ----------
    methods : tuple of str
        Of deformation; at least one.
    method : str
        One of ``DESIGNS``.
    samples : int
        Cases; of a grid, levels of a range.
    steps : int
        Of each case.
    handle : int
        Index of the handle moved by typed motions.
    """

    spans: tuple[QuantityRange, ...]
    methods: tuple[str, ...]
    method: str
    samples: int
    steps: int
    handle: int

    @property
    def has_motion(self) -> bool:
        """True if a typed motion replaces the motion of the session."""
        return any(span.quantity.is_motion for span in self.spans)

    def plan_rows(self, default_method: str) -> PlanRows:
        """Columns and distinct rows of the plan.

        Parameters
        ----------
        default_method : str
            Method of the session, for which no column is needed.

        Raises
        ------
        InputError
            If nothing varies.
        """
        vary = [span.design_variable for span in self.spans if span.high is not None]
        vary += [DesignVariable("method", self.methods)] if len(self.methods) > 1 else []
        if not vary:
            raise InputError(tr("Nothing varies; give both ends of a range, or tick several methods."))
        columns, rows = design_table(self._common_cells(default_method), vary, self.method, self.samples, 0)
        # Designs with only categorical variables yield fewer distinct cases than samples.
        return columns, [list(row) for row in dict.fromkeys(map(tuple, rows))]

    def _common_cells(self, usual: str) -> dict[str, str]:
        """Cells common to all rows, by column."""
        fixed = {s.quantity.name: s.low for s in self.spans if s.high is None and not s.quantity.is_motion}
        fixed |= {"method": self.methods[0]} if len(self.methods) == 1 and self.methods[0] != usual else {}
        given = {"session": SESSION_FILE, "steps": str(self.steps), **fixed}
        if self.has_motion:
            words = [
                f"{s.quantity.name} {s.low}" for s in self.spans if s.high is None and s.quantity.is_motion
            ]
            whose = f"handle {self.handle + 1}: " if self.handle else ""
            given |= {"motion": whose + "; ".join(words)} if whose or words else {}
        return given


def path_from_text(text: str) -> Path:
    """Absolute path from a text, with ~ expanded to the home folder.

    An unknown user's ``~`` stays as it is, instead of raising RuntimeError.
    """
    return Path(os.path.expanduser(text.strip())).absolute()  # noqa: PTH111


def write_study(folder: Path, rows: PlanRows, state: State, view: View) -> None:
    """Write plan and session of a new study.

    Parameters
    ----------
    folder : Path
        Folder of the study, created if missing.
    rows : tuple
        Columns and rows of the plan.
    state, view
        State and view of the session, saved with its mesh.

    Raises
    ------
    InputError
        If they cannot be written.
    """
    try:
        folder.mkdir(parents=True, exist_ok=True)
    except OSError as error:
        raise InputError(
            tr("The folder {folder} cannot be created ({reason}); choose another location.").format(
                folder=folder, reason=error.strerror or error
            )
        ) from error
    save_session(folder / SESSION_FILE, state, view, embed=True)
    write_table(folder / PLAN_FILE, *rows)


def document_with_values(state: State, unit: Unit, handle: int, values: Mapping[str, str]) -> Document:
    """Document with its handles and settings at given values of the quantities.

    Parameters
    ----------
    handle : int
        Index of the handle moved by typed motions.
    values : mapping of str to str
        Values by the names of quantities, as a plan has them.

    Raises
    ------
    InputError
        If there is no such value or no such motion.
    """
    settings = {
        name: SETTING_COLUMNS[name].parse(text) for name, text in values.items() if name in SETTING_COLUMNS
    }
    part = float(settings.pop(SHARE_COLUMN, 1.0))
    document = state.document.relative_to_rest.with_settings(**settings)
    words = "; ".join(f"{name} {text}" for name, text in values.items() if name not in SETTING_COLUMNS)
    typed = motion_steps(document, f"handle {handle + 1}: {words}", unit) if words else ()
    paths = motion_paths(document, typed) if typed else handle_paths(document)
    return Case(document, paths, (part,)).end_document


class StudyRun(QObject):
    """Runs one study at a time; finished cases stay in its folder.

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
    def is_running(self) -> bool:
        """True while a study runs."""
        return self.command.is_running

    def begin(self, folder: Path, options: Sequence[str] | None = None, retry_failed: bool = False) -> None:
        """Start or continue the plan in a folder.

        Parameters
        ----------
        options : sequence of str or None
            Command options on the engine; None for those of the last run.
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
        """Stop after the running cases; a second call stops at once."""
        if not self.is_running:
            return
        if self.stopping or not self.command.interrupt():
            self.kill()
        else:
            self.stopping = True

    def kill(self) -> None:
        """Stop at once; running cases are computed again on continuation."""
        if self.is_running:
            self.command.cancel()
            self._end(_stopped_sentence())

    def _fail(self, sentence: str) -> None:
        self._end(_stopped_sentence() if self.stopping else sentence)

    def _end(self, sentence: str) -> None:
        folder, self.folder, self.stopping = self.folder, None, False
        self.ended.emit(folder, sentence)


def _stopped_sentence() -> str:
    return tr("Stopped; the finished cases are kept.")


def _keep_options(folder: Path, options: Sequence[str]) -> None:
    with replacing_file(folder / RUN_FILE) as scratch:
        scratch.write_text(json.dumps({"options": list(options)}), encoding="utf-8")


def stored_options(folder: Path) -> list[str]:
    """Command options of the last run, read from the study folder."""
    try:
        said: Any = json.loads(read_bytes(folder / RUN_FILE))
        words = [str(word) for word in said["options"]]
    except (OSError, ValueError, KeyError, TypeError, RecursionError):
        return []  # no valid options stored: run on this machine
    if not set(words[::2]) <= set(_KEPT) or len(words) % 2:
        return []
    said = dict(zip(words[::2], words[1::2], strict=True))
    if said.get(_PROCESSES, "").isdecimal():  # the options may stem from a machine with more cores
        said[_PROCESSES] = str(min(int(said[_PROCESSES][:4]), core_count()))
    return [word for pair in said.items() for word in pair]


def scheduler_option(options: Sequence[str]) -> str:
    """Scheduler address or file among the options; empty if none."""
    values = dict(zip(options[::2], options[1::2], strict=True))
    return next((values[name] for name in _SCHEDULERS if name in values), "")


def may_continue(folder: Path) -> bool:
    """True if the folder holds the plan of a study."""
    return (folder / PLAN_FILE).is_file()
