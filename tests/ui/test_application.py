import gc
import sys
import weakref

from PySide6.QtCore import QCoreApplication, QMessageLogContext, QObject, Qt, QtMsgType

from apd_viewer.ui.application import HARMLESS_MESSAGE, GuiThreadGC, log_qt_message, make_application


def test_make_application_gives_the_one_application(qapp):
    assert make_application(["again"]) is qapp
    assert QCoreApplication.testAttribute(Qt.ApplicationAttribute.AA_ShareOpenGLContexts)
    assert sys.getswitchinterval() <= 0.001


def test_log_qt_message_passes_messages_on_but_for_the_harmless_one(qapp, capsys):
    log_qt_message(
        QtMsgType.QtWarningMsg, QMessageLogContext(), f"{HARMLESS_MESSAGE} with a different version"
    )
    assert capsys.readouterr().err == ""
    log_qt_message(QtMsgType.QtWarningMsg, QMessageLogContext(), "something else")
    assert "something else" in capsys.readouterr().err


def test_gui_thread_gc_collects_cyclic_garbage_from_the_event_loop_only(qtbot, monkeypatch):
    monkeypatch.setattr("apd_viewer.ui.application.INTERVAL", 10)
    enabled = gc.isenabled()
    collector = GuiThreadGC()
    assert not gc.isenabled()
    cycle = QObject()
    cycle.itself = cycle
    gone = weakref.ref(cycle)
    del cycle
    [[] for _ in range(10)]
    keep = [[] for _ in range(3 * gc.get_threshold()[0])]
    assert gone() is not None
    qtbot.waitUntil(lambda: gone() is None)
    collector.close()
    assert gc.isenabled()
    assert keep
    if not enabled:
        gc.disable()
