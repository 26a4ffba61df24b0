"""The question before unsaved work is left."""

from __future__ import annotations

from enum import Enum

from PySide6.QtWidgets import QMessageBox, QWidget

from apd_viewer.files.known_file import FileState
from apd_viewer.language import tr
from apd_viewer.session.model.status_text import lost_file_text
from apd_viewer.ui.filing.question import Question, ask_question


class UnsavedAnswer(Enum):
    """An answer to the question."""

    SAVE = tr("&Save session")
    EXPORT = tr("&Export mesh…")
    DISCARD = tr("&Don’t save")
    CANCEL = tr("Cancel")


_ROLES = {
    UnsavedAnswer.SAVE: QMessageBox.ButtonRole.AcceptRole,
    UnsavedAnswer.EXPORT: QMessageBox.ButtonRole.AcceptRole,
    UnsavedAnswer.DISCARD: QMessageBox.ButtonRole.DestructiveRole,
    UnsavedAnswer.CANCEL: QMessageBox.ButtonRole.RejectRole,
}


def ask_before_leaving(
    parent: QWidget, name: str, closes: bool, fate: FileState = FileState.SAME
) -> UnsavedAnswer:
    """Ask about unsaved work before closing, or before opening another file."""
    said = tr("Save changes to “{name}” before closing?")
    if not closes:
        said = tr("Save changes to “{name}” before opening another file?")
    kept = tr("A session keeps paint, handles, targets, settings and the shape; a mesh only the shape.")
    lost = lost_file_text("{name}", fate)
    question = Question(tr("Unsaved changes"), said, name, f"{lost}\n{kept}".lstrip())
    return ask_question(parent, question, _ROLES, UnsavedAnswer.SAVE, UnsavedAnswer.CANCEL)
