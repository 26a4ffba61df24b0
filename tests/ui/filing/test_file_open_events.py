"""A file that macOS asks the program to open, as an event of the application."""

from PySide6.QtCore import QEvent, QUrl
from PySide6.QtGui import QFileOpenEvent
from PySide6.QtWidgets import QApplication, QWidget

from apd_viewer.ui.filing.file_requests import FileOpenEvents, FileRequests


class Opened(list):
    """An opener that keeps the paths."""

    open_path = list.append


def test_file_open_events_open_a_file_from_the_finder_once_there_is_a_session(qapp, qtbot, tmp_path):
    window, opened = QWidget(), Opened()
    qtbot.addWidget(window)
    requests = FileRequests(window, None)
    events = FileOpenEvents(qapp, requests)
    try:
        path = str(tmp_path / "bottle.obj")
        assert QApplication.sendEvent(qapp, QFileOpenEvent(QUrl.fromLocalFile(path)))
        assert opened == []
        requests.set_opener(opened)
        assert opened == [path]
        QApplication.sendEvent(qapp, QEvent(QEvent.Type.ApplicationPaletteChange))
        QApplication.sendEvent(qapp, QFileOpenEvent(QUrl("https://example.org/bottle.obj")))
        assert opened == [path]
    finally:
        qapp.removeEventFilter(events)
        events.deleteLater()
