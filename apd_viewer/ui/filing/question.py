"""A question with answers of its own in a message box."""

from __future__ import annotations

from collections.abc import Mapping
from enum import Enum
from typing import NamedTuple, TypeVar

from PySide6.QtCore import Qt
from PySide6.QtWidgets import QMessageBox, QWidget

E = TypeVar("E", bound=Enum)
_LONGEST_NAME = 300  # px


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


def ask_question(
    parent: QWidget, question: Question, roles: Mapping[E, QMessageBox.ButtonRole], default: E, escape: E
) -> E:
    """Ask; ``Enter`` gives the answer ``default``, ``Esc`` the answer ``escape``."""
    box = QMessageBox(parent)
    box.setIcon(QMessageBox.Icon.Question)
    box.setTextFormat(Qt.TextFormat.PlainText)
    box.setWindowTitle(question.title)
    elide = box.fontMetrics().elidedText
    name = elide(question.name, Qt.TextElideMode.ElideMiddle, _LONGEST_NAME)
    box.setText(question.text.format(name=name))
    box.setInformativeText(question.details.format(name=name))
    buttons = {answer: box.addButton(answer.value, role) for answer, role in roles.items()}
    box.setDefaultButton(buttons[default])
    box.setEscapeButton(buttons[escape])
    box.exec()
    clicked = box.clickedButton()
    box.deleteLater()
    return next((answer for answer, button in buttons.items() if button is clicked), escape)
