"""The question before a file changed elsewhere is replaced."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from enum import Enum

from PySide6.QtCore import QTimer
from PySide6.QtWidgets import QMessageBox, QWidget

from apd_viewer.language import tr
from apd_viewer.ui.filing.question import Question, ask_question


class ChangedFileAnswer(Enum):
    """An answer to the question."""

    SAVE_AS = tr("Save &as…")
    OVERWRITE = tr("&Overwrite")
    RELOAD = tr("&Reload")
    CANCEL = tr("Cancel")


_ROLES = {
    ChangedFileAnswer.SAVE_AS: QMessageBox.ButtonRole.AcceptRole,
    ChangedFileAnswer.OVERWRITE: QMessageBox.ButtonRole.DestructiveRole,
    ChangedFileAnswer.RELOAD: QMessageBox.ButtonRole.ActionRole,
    ChangedFileAnswer.CANCEL: QMessageBox.ButtonRole.RejectRole,
}


def ask_about_changed_file(
    parent: QWidget, name: str, actions: Mapping[ChangedFileAnswer, Callable[[], object]]
) -> None:
    """Ask about a changed file in the next event, and go on as is decided.

    Whoever has found the change may still be at work. ``Enter`` loses nothing.
    """
    QTimer.singleShot(0, parent, lambda: actions.get(_decision(parent, name), lambda: None)())


def _decision(parent: QWidget, name: str) -> ChangedFileAnswer:
    said = tr("“{name}” has been changed by another window or program. Overwrite it?")
    about = tr(
        "Overwrite loses what is in the file. Reload opens the file instead and takes this window’s "
        "changes away; Undo brings them back."
    )
    question = Question(tr("File changed"), said, name, about)
    return ask_question(parent, question, _ROLES, ChangedFileAnswer.SAVE_AS, ChangedFileAnswer.CANCEL)
