"""Someone at a window who answers its questions with a real mouse and real keys."""

from PySide6.QtCore import Qt, QTimer
from PySide6.QtTest import QTest
from PySide6.QtWidgets import QApplication, QMessageBox

LEFT = Qt.MouseButton.LeftButton
EVERY = 20  # ms
TRIES = 500


def once(is_there, act, tries=TRIES):
    """Act as soon as something is there, also from within the loop of events of a menu or a dialog.

    A fixed delay instead comes before a menu that a busy machine has not shown yet, which takes no keys.
    """

    def look():
        if is_there():
            act()
        elif tries:
            once(is_there, act, tries - 1)

    QTimer.singleShot(EVERY, look)


def once_shown(menu, act):
    """Act as soon as a menu is on the screen and has the keys."""

    def is_shown():
        window = menu.windowHandle()
        return QApplication.activePopupWidget() is menu and window is not None and window.isExposed()

    once(is_shown, act)


def once_asked(act):
    """Act as soon as a dialog is on the screen."""

    def is_asked():
        dialog = QApplication.activeModalWidget()
        return dialog is not None and dialog.isVisible()

    once(is_asked, act)


class Person:
    """Answers the real question, and the dialogs of files; a question is noted.

    Attributes
    ----------
    answers : list
        Yet to be given: a key, an answer, or the words of its button.
    asked : list of str
    target : path
        What the dialogs of files return; nothing cancels them.
    """

    def __init__(self, window=None):
        self.window = window
        self.answers = []
        self.asked = []
        self.target = ""

    def will(self, *answers):
        self.answers = list(answers)
        QTimer.singleShot(EVERY, self._answer)

    def _answer(self):
        box = QApplication.activeModalWidget()
        if isinstance(box, QMessageBox):
            answer = self.answers.pop(0)
            self.asked.append(box.text())
            if isinstance(answer, Qt.Key):
                QTest.keyClick(box, answer)
            else:
                words = getattr(answer, "text", answer)
                button = next(
                    each for each in box.buttons() if each.text().replace("&", "") == words.replace("&", "")
                )
                QTest.mouseClick(button, LEFT)
        if self.answers:
            QTimer.singleShot(EVERY, self._answer)

    def choose(self, *_):
        path = self.target
        kind = "Session (*.apd)" if str(path).endswith("apd") else "OBJ (*.obj)"
        return (str(path), kind) if path else ("", "")
