"""Work on a thread of its own: what was asked for last counts, and nothing outlives the window."""

import threading

import numpy as np
import pytest
from driving import idle
from meshes import sphere
from PySide6.QtCore import QObject
from PySide6.QtWidgets import QApplication

from apd_viewer.geometry.analysis.deviation import Deviation
from apd_viewer.geometry.mesh.mesh import Mesh
from apd_viewer.presentation.scales import Measure
from apd_viewer.ui.widgets.background_task import BackgroundTask


@pytest.fixture
def task(qapp):
    parent = QObject()
    task = BackgroundTask(parent)
    yield task
    task.close()


@pytest.fixture
def told(task):
    results = []
    task.done.connect(results.append)
    return results


def measuring():
    """Threads that are still at work."""
    return [thread for thread in threading.enumerate() if thread.name == "measuring"]


def patient(started, result):
    """Work that ends when nobody wants it any more."""

    def work(enough):
        started.set()
        while not enough():
            threading.Event().wait(0.001)
        return result

    return work


def test_background_task_tells_a_result_on_the_thread_of_the_window(qtbot, task):
    threads = []
    task.done.connect(lambda result: threads.append((result, threading.get_ident())))
    task.begin(lambda _: threading.get_ident())
    assert task.is_busy
    qtbot.waitUntil(lambda: not task.is_busy)
    ((worked, told),) = threads
    assert told == threading.get_ident() != worked


def test_background_task_tells_only_of_what_is_asked_for_last(qtbot, task, told):
    started = threading.Event()
    task.begin(patient(started, "old"))
    assert started.wait(5)
    task.begin(lambda _: "older than the next")
    task.begin(lambda _: "new")
    qtbot.waitUntil(lambda: not task.is_busy)
    assert told == ["new"]


def test_cancel_keeps_a_result_from_being_told(qtbot, task, told):
    started = threading.Event()
    task.begin(patient(started, "old"))
    assert started.wait(5)
    task.cancel()
    assert not task.is_busy
    qtbot.waitUntil(lambda: not measuring())
    QApplication.processEvents()
    task.begin(lambda _: "new")
    qtbot.waitUntil(lambda: not task.is_busy)
    assert told == ["new"]


def test_background_task_tells_a_lack_of_memory_as_one(qtbot, task, told):
    def work(_):
        raise MemoryError

    task.begin(work)
    qtbot.waitUntil(lambda: not task.is_busy)
    assert told == [None]


def test_background_task_lets_a_closed_window_wait_for_no_measurement(qtbot, window, monkeypatch):
    window.files.show_mesh(Mesh(*sphere(3)))
    idle(qtbot, window)
    started = threading.Event()

    def slow(_change, U, enough=None):
        return np.zeros(len(U)) if enough is None else patient(started, None)(enough)

    monkeypatch.setattr(Deviation, "rest_distance", slow)
    window.actions_.display.measures[Measure.DISTANCE].trigger()
    qtbot.waitUntil(started.is_set, timeout=60_000)
    window.shell.close()
    assert not measuring()


def test_legend_says_that_there_is_too_little_memory_to_measure(qtbot, window, monkeypatch):
    def no_memory(*_):
        raise MemoryError

    monkeypatch.setattr(Deviation, "__init__", no_memory)
    window.files.show_mesh(Mesh(*sphere(2)))
    idle(qtbot, window)
    window.actions_.display.measures[Measure.AREA].trigger()
    qtbot.waitUntil(lambda: "memory" in window.display_options.legend.note.text(), timeout=60_000)
    assert window.canvas.surface.color_map is None
