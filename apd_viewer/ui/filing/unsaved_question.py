"""The question before unsaved work is left."""

from __future__ import annotations

from enum import Enum

from PySide6.QtWidgets import QMessageBox, QWidget

from apd_viewer.files.known_file import Fate
from apd_viewer.language import tr
from apd_viewer.session.model.status_text import lost_file
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


def ask_before_leaving(parent: QWidget, name: str, closes: bool, found: Fate = Fate.SAME) -> Answer:
    """Ask about unsaved work before closing, or before opening another file."""
    said = tr("Save changes to “{name}” before closing?")
    if not closes:
        said = tr("Save changes to “{name}” before opening another file?")
    kept = tr("A session keeps paint, handles, targets, settings and the shape; a mesh only the shape.")
    lost = lost_file("{name}", found)
    question = Question(tr("Unsaved changes"), said, name, f"{lost}\n{kept}".lstrip())
    return ask(parent, question, _ROLES, Answer.SAVE, Answer.CANCEL)
