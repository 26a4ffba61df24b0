"""The question before unsaved work is left."""

from __future__ import annotations

from enum import Enum

from PySide6.QtWidgets import QMessageBox, QWidget

from apd_viewer.language import tr


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


def ask_before_leaving(parent: QWidget, name: str, closes: bool) -> Answer:
    """Ask about unsaved work before closing, or before opening another file."""
    box = QMessageBox(parent)
    box.setIcon(QMessageBox.Icon.Question)
    box.setWindowTitle(tr("Unsaved changes"))
    said = tr("Save changes to “{name}” before closing?")
    if not closes:
        said = tr("Save changes to “{name}” before opening another file?")
    box.setText(said.format(name=name))
    box.setInformativeText(
        tr("A session keeps paint, handles, targets, settings and the shape; a mesh only the shape.")
    )
    buttons = {answer: box.addButton(answer.value, role) for answer, role in _ROLES.items()}
    box.setDefaultButton(buttons[Answer.SAVE])
    box.setEscapeButton(buttons[Answer.CANCEL])
    box.exec()
    clicked = box.clickedButton()
    box.deleteLater()
    return next((answer for answer, button in buttons.items() if button is clicked), Answer.CANCEL)
