"""Progress of the compilation in the status bar."""

from PySide6.QtWidgets import QMainWindow

from apd_viewer.ui.panel.status_bar import CompilingProgress


def test_compiling_progress_is_shown_while_something_is_left_to_compile(qtbot):
    progress, window = CompilingProgress(), QMainWindow()
    window.setCentralWidget(progress)
    window.show()
    for share, shown, value in ((None, False, 0), (0.25, True, 250), (0.75, True, 750), (1.0, False, 1000)):
        progress.show_fraction(share)
        assert progress.isVisible() == shown
        assert max(0, progress.bar.value()) == value
    window.close()
    window.deleteLater()
