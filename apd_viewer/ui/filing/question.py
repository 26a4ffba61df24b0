"""Questions about files in a message box, with answers of their own."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from enum import Enum
from typing import NamedTuple, TypeVar

from PySide6.QtCore import Qt, QTimer
from PySide6.QtWidgets import QMessageBox, QWidget

from apd_viewer.files.known_file import FileState
from apd_viewer.language import tr
from apd_viewer.session.model.status_text import lost_file_text

_LONGEST_NAME = 300  # px
_Role = QMessageBox.ButtonRole


class Question(NamedTuple):
    """Words of a question.

    Attributes
    ----------
    title : str
    text : str
        The question, with ``{name}`` where the file is named.
    name : str
        Of the file; a long one is shortened.
    details : str
        What to know before it is answered, with ``{name}`` likewise.
    """

    title: str
    text: str
    name: str
    details: str


class Answer(Enum):
    """Text and role of a button; ``Enter`` gives the first answer, ``Esc`` the last."""

    def __init__(self, text: str, role: QMessageBox.ButtonRole) -> None:
        self.text, self.role = text, role


A = TypeVar("A", bound=Answer)


class UnsavedAnswer(Answer):
    """An answer to the question about unsaved work."""

    SAVE = tr("&Save session"), _Role.AcceptRole
    EXPORT = tr("&Export mesh…"), _Role.AcceptRole
    DISCARD = tr("&Don’t save"), _Role.DestructiveRole
    CANCEL = tr("Cancel"), _Role.RejectRole


class ChangedFileAnswer(Answer):
    """An answer to the question about a file changed on disk."""

    SAVE_AS = tr("Save &as…"), _Role.AcceptRole
    OVERWRITE = tr("&Overwrite"), _Role.DestructiveRole
    RELOAD = tr("&Reload"), _Role.ActionRole
    CANCEL = tr("Cancel"), _Role.RejectRole


def ask_question(parent: QWidget, question: Question, answers: type[A]) -> A:
    """Ask, and return the answer."""
    box = QMessageBox(parent)
    box.setIcon(QMessageBox.Icon.Question)
    box.setTextFormat(Qt.TextFormat.PlainText)
    box.setWindowTitle(question.title)
    elide = box.fontMetrics().elidedText
    name = elide(question.name, Qt.TextElideMode.ElideMiddle, _LONGEST_NAME)
    box.setText(question.text.format(name=name))
    box.setInformativeText(question.details.format(name=name))
    buttons = [(answer, box.addButton(answer.text, answer.role)) for answer in answers]
    box.setDefaultButton(buttons[0][1])
    box.setEscapeButton(buttons[-1][1])
    box.exec()
    clicked = box.clickedButton()
    box.deleteLater()
    return next((answer for answer, button in buttons if button is clicked), buttons[-1][0])


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
    return ask_question(parent, question, UnsavedAnswer)


def ask_about_changed_file(
    parent: QWidget, name: str, actions: Mapping[ChangedFileAnswer, Callable[[], object]]
) -> None:
    """Ask about a changed file in the next event, and go on as is decided.

    Whoever has found the change may still be at work. ``Enter`` loses nothing.
    """
    said = tr("“{name}” has been changed by another window or program. Overwrite it?")
    about = tr(
        "Overwrite loses what is in the file. Reload opens the file instead and takes this window’s "
        "changes away; Undo brings them back."
    )
    question = Question(tr("File changed"), said, name, about)

    def ask() -> None:
        actions.get(ask_question(parent, question, ChangedFileAnswer), lambda: None)()

    QTimer.singleShot(0, parent, ask)
