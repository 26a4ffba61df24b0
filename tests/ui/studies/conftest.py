"""A window on a twisted bar for studies of it, and commands without a process of their own."""

import pytest
from command_here import CommandHere
from driving import idle, show
from in_thread import InThread
from PySide6.QtCore import QSettings
from study_driving import open_bar

from apd_viewer.session.posing.motion import MOTIONS
from apd_viewer.session.processes import shape_checker, solver_process
from apd_viewer.ui.filing import file_controller
from apd_viewer.ui.filing.file_controller import UnsavedAnswer
from apd_viewer.ui.shell import Shell
from apd_viewer.ui.studies import run_dialog
from apd_viewer.ui.workbench import Workbench


@pytest.fixture(scope="module")
def home(tmp_path_factory):
    """Where studies are put."""
    return tmp_path_factory.mktemp("studies")


@pytest.fixture(scope="module")
def twisted(qapp, home):
    """A window on a bar that is painted and twisted; its solver is a thread."""
    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(solver_process, "start_solver_process", InThread)
        patch.setattr(shape_checker, "FIRST_PAUSE", 1e6)
        patch.setattr(file_controller, "ask_before_leaving", lambda *_: UnsavedAnswer.DISCARD)
        settings = QSettings(str(home / "settings.ini"), QSettings.Format.IniFormat)
        settings.setValue("folder", str(home))
        window = Workbench(Shell(settings))
        window.shell.show()
        yield window
        window.case_studies.run.kill()
        window.shell.close()
        window.shell.deleteLater()


@pytest.fixture(scope="module")
def solved():
    """States of the twisted bar: one, once there is one."""
    return []


@pytest.fixture
def bar(qtbot, twisted, solved):
    """The same, on the twisted bar, whatever was opened since."""
    window = twisted
    show(qtbot, window.shell, window.canvas.viewport)
    if solved:
        window.session.files.open_result("mesh", lambda: solved[0], is_saved=False)
    else:
        open_bar(qtbot, window)
        window.session.handles.move_by(MOTIONS["TWIST"], "80deg", 0)
    idle(qtbot, window)
    solved[:] = [window.session.store.state]
    yield window
    if window.case_studies.dialog is not None:
        window.case_studies.dialog.close()


@pytest.fixture
def dialog(qtbot, bar):
    bar.actions_.simulate.study.trigger()
    dialog = bar.case_studies.dialog
    qtbot.waitExposed(dialog)
    dialog.activateWindow()
    return dialog


@pytest.fixture
def here(monkeypatch):
    """This process runs the commands of dialogs that are opened from now on."""
    monkeypatch.setattr(run_dialog, "CommandProcess", CommandHere)
