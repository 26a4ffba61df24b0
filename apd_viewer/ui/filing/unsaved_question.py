"""The question before unsaved work is left."""

from __future__ import annotations

from enum import Enum

from PySide6.QtWidgets import QMessageBox, QWidget

from apd_viewer.files.known_file import Fate
from apd_viewer.language import tr
from apd_viewer.ui.filing.question import Question, ask


class Answer(Enum):
    """An answer to the question."""

    SAVE = tr("&Save session")
    EXPORT = tr("&Export mesh…")
    DISCARD = tr("&Don’t save")
    CANCEL = tr("Cancel")


_ROLES = {
    Answer.SAVE: QMessageBox.ButtonRole.AcceptRole,
    Answer.EXPORT: QMessageBox.ButtonRole.AcceptRole,
    Answer.DISCARD: QMessageBox.ButtonRole.DestructiveRole,
    Answer.CANCEL: QMessageBox.ButtonRole.RejectRole,
}
_LOST = {
    Fate.GONE: tr("The file has been moved or deleted."),
    Fate.CHANGED: tr("The file has been changed by another window or program."),
    Fate.INCOMPLETE: tr("The mesh of the session has been moved, changed or deleted."),
}


def ask_before_leaving(parent: QWidget, name: str, closes: bool, found: Fate = Fate.SAME) -> Answer:
    """Ask about unsaved work before closing, or before opening another file."""
    said = tr("Save changes to “{name}” before closing?")
    if not closes:
        said = tr("Save changes to “{name}” before opening another file?")
    kept = tr("A session keeps paint, handles, targets, settings and the shape; a mesh only the shape.")
    about = f"{_LOST[found]}\n{kept}" if found in _LOST else kept
    question = Question(tr("Unsaved changes"), said, name, about)
    return ask(parent, question, _ROLES, Answer.SAVE, Answer.CANCEL)
