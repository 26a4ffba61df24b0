"""Progress of the compilation in the status bar."""

from types import SimpleNamespace

import pytest
from PySide6.QtWidgets import QMainWindow

from apd_viewer.ui.panel.compiling_progress import CompilingProgress


@pytest.fixture
def progress(qtbot):
    progress, window = CompilingProgress(), QMainWindow()
    window.setCentralWidget(progress)
    window.show()
    progress.hide()
    yield progress
    window.close()
    window.deleteLater()


def test_it_is_shown_while_the_solver_compiles_and_never_again(progress, qtbot):
    store = SimpleNamespace(compiled=None)
    progress.watch(store)
    qtbot.wait(700)
    assert progress.isHidden()
    store.compiled = 0.25
    qtbot.waitUntil(progress.isVisible)
    assert progress.bar.value() == 250
    store.compiled = 1.0
    qtbot.waitUntil(progress.isHidden)
    store.compiled = 0.5
    qtbot.wait(700)
    assert progress.isHidden()
