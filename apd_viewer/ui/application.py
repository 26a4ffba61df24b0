"""The Qt application, prepared for a VTK viewport."""

from __future__ import annotations

import contextlib
import gc
import logging
import os
import signal
import sys
from pathlib import Path
from typing import TYPE_CHECKING

from apd_viewer.language import LANGUAGE, localize_numbers, tr
from apd_viewer.session.processes.freed_memory import keep_freed_memory, share_freed_memory

# pyvistaqt uses the first Qt binding that it finds, and it looks for PyQt5 first.
os.environ["QT_API"] = "pyside6"
# Qt would split the translucent lines of the gizmo among threads: waking them takes several times as long as
# drawing, especially while the solver occupies the cores.
os.environ.setdefault("QT_NO_GUI_THREADPOOL", "1")

from PySide6 import QtCore
from PySide6.QtGui import QSurfaceFormat
from PySide6.QtWidgets import QApplication

from apd_viewer.errors import InputError
from apd_viewer.files.mesh_formats import SERIES
from apd_viewer.files.meshes import check_readable
from apd_viewer.files.samples import open_sample
from apd_viewer.geometry.mesh.mesh import Mesh
from apd_viewer.session.model.view import SESSION_SUFFIX
from apd_viewer.ui.background_imports import BackgroundImports
from apd_viewer.ui.display import display_connection, has_display
from apd_viewer.ui.preferences.preference_values import PreferenceValues

if TYPE_CHECKING:
    from apd_viewer.ui.shell import Shell
    from apd_viewer.ui.workbench import Workbench

# pyvistaqt sets the default format again for each viewport, to the values already set here.
HARMLESS_MESSAGE = "Setting a new default format"

INTERVAL = 500  # ms between two garbage collections
LOAD_DELAY = 1000  # ms; loading starts then even if no frame is drawn, as in a covered or minimized window

_LOGGER = logging.getLogger(__name__)
_LEVELS = {
    QtCore.QtMsgType.QtDebugMsg: logging.DEBUG,
    QtCore.QtMsgType.QtInfoMsg: logging.INFO,
    QtCore.QtMsgType.QtWarningMsg: logging.WARNING,
    QtCore.QtMsgType.QtCriticalMsg: logging.ERROR,
    QtCore.QtMsgType.QtFatalMsg: logging.CRITICAL,
}

SWITCH_INTERVAL = 0.001  # s; shortens the GUI thread's waits for workers that hold the interpreter lock


def make_application(argv: list[str]) -> QApplication:
    """Return the application, configured for VTK viewports on the first call.

    Parameters
    ----------
    argv : list of str
        Command line, program name first.
    """
    existing = QApplication.instance()
    if isinstance(existing, QApplication):
        return existing
    keep_freed_memory()
    share_freed_memory()
    # Lets a viewport keep its OpenGL context, with all VTK resources, when Qt moves it to another window.
    QtCore.QCoreApplication.setAttribute(QtCore.Qt.ApplicationAttribute.AA_ShareOpenGLContexts)
    QSurfaceFormat.setDefaultFormat(_surface_format())
    QtCore.qInstallMessageHandler(log_qt_message)
    QtCore.QLocale.setDefault(QtCore.QLocale.c())  # numbers are formatted by this program, not by Qt
    localize_numbers()
    application = QApplication(argv)
    application.setApplicationName("apd-viewer")
    application.setApplicationDisplayName("APD Viewer")
    application.setOrganizationName("apd-viewer")
    application.setDesktopFileName("apd-viewer")  # Wayland finds the icon by this name
    _translate(application)
    GuiThreadGC(application)
    sys.setswitchinterval(SWITCH_INTERVAL)
    return application


def _translate(application: QApplication) -> None:
    """Load Qt's own texts, such as button labels, in the program's language."""
    words = QtCore.QTranslator(application)
    if words.load(
        f"qtbase_{LANGUAGE}", QtCore.QLibraryInfo.path(QtCore.QLibraryInfo.LibraryPath.TranslationsPath)
    ):
        application.installTranslator(words)


def _surface_format() -> QSurfaceFormat:
    """Surface format of desktop OpenGL 3.2 core, required early by Wayland."""
    surface = QSurfaceFormat()
    surface.setRenderableType(QSurfaceFormat.RenderableType.OpenGL)
    surface.setProfile(QSurfaceFormat.OpenGLContextProfile.CoreProfile)
    surface.setVersion(3, 2)
    surface.setAlphaBufferSize(8)
    surface.setDepthBufferSize(8)
    surface.setStencilBufferSize(0)
    return surface


def log_qt_message(kind: QtCore.QtMsgType, context: QtCore.QMessageLogContext, message: str) -> None:
    """Log and print a Qt message, except the known harmless one."""
    if HARMLESS_MESSAGE not in message:
        _LOGGER.log(_LEVELS[kind], message)
        print(QtCore.qFormatLogMessage(kind, context, message), file=sys.stderr)  # noqa: T201


def run(mesh: object = None, shows_errors: bool = False) -> None:
    """Show the window with ``mesh`` or the sample bottle; return when it is closed.

    Parameters
    ----------
    mesh : Mesh, pyvista.PolyData, trimesh.Trimesh, path or None
    shows_errors : bool
        Whether to report an unusable file in the window, given a display.

    Raises
    ------
    InputError
        If the mesh cannot be used, or there is no display.
    """
    shown = Path(mesh) if shows_errors and isinstance(mesh, str) and has_display() else mesh_or_path(mesh)
    with display_connection():
        application = make_application(sys.argv[:1])
    # Imported only now: pyvistaqt must find the application prepared above.
    from apd_viewer.ui.filing.file_requests import FileOpenEvents
    from apd_viewer.ui.settings_page.preference_table import THREADS
    from apd_viewer.ui.settings_page.settings_dialog import limit_threads
    from apd_viewer.ui.shell import Shell

    settings = user_settings()
    limit_threads(PreferenceValues(settings)[THREADS])
    shell = Shell(settings)
    if shown is None:
        shell.canvas.show_loading_mesh(*open_sample("bottle"))
        shell.requests.open_sample("bottle")
    elif isinstance(shown, Mesh):
        shell.requests.show_mesh(shown)
    else:
        shell.requests.open_path(shown)
    if sys.platform == "darwin":
        FileOpenEvents(application, shell.requests)
    shell.show()
    imports = BackgroundImports()
    imports.loaded.connect(
        lambda: shell.close() if imports.error else build_workbench(shell, recovery_folder(), shown is None)
    )
    shell.canvas.viewport.frameSwapped.connect(imports.begin, QtCore.Qt.ConnectionType.SingleShotConnection)
    QtCore.QTimer.singleShot(LOAD_DELAY, imports.begin)
    signal.signal(signal.SIGINT, lambda *_: application.closeAllWindows())
    for name in ("SIGTERM", "SIGHUP"):  # quit without asking: unsaved work is offered at the next start
        number = getattr(signal, name, None)
        if number is not None and signal.getsignal(number) is signal.SIG_DFL:
            signal.signal(number, lambda number, _: application.exit(128 + number))
    gc.freeze()  # imported modules stay alive: scanning them for garbage would delay the first frame
    status = application.exec()
    gc.unfreeze()
    imports.join()
    if imports.error is not None:
        raise ImportError(str(imports.error)) from imports.error
    if status:
        raise SystemExit(status)


def user_settings() -> QtCore.QSettings:
    """The user's settings; anything but a file in their place is renamed first."""
    folder = Path(
        QtCore.QStandardPaths.writableLocation(QtCore.QStandardPaths.StandardLocation.GenericConfigLocation)
    )
    name = f"{QtCore.QCoreApplication.applicationName()}.conf"
    for path in (folder / name, folder / QtCore.QCoreApplication.organizationName() / name):
        with contextlib.suppress(OSError):
            if path.exists() and not path.is_file():
                path.rename(path.with_name(f"{name}.damaged"))
    return QtCore.QSettings()


def recovery_folder() -> Path:
    """Folder of the autosaved sessions."""
    place = QtCore.QStandardPaths.StandardLocation.AppLocalDataLocation
    return Path(QtCore.QStandardPaths.writableLocation(place)) / "recovery"


def build_workbench(shell: Shell, recovery: Path | None, opens_sample: bool) -> Workbench | None:
    """Build the workbench on an open shell; start the tour on the first run.

    Parameters
    ----------
    recovery : Path or None
        Folder for autosaves; None keeps nothing.
    opens_sample : bool
        Whether the sample bottle is about to be opened.
    """
    if shell.is_closed:
        return None
    gc.freeze()
    # Imported only now: it takes longer to import than everything needed for the first frame.
    from apd_viewer.ui.workbench import Workbench

    workbench = Workbench(shell, recovery)
    workbench.help.plan_first_tour(opens_sample)
    if refusal := shell.preferences.storage_problem:
        # Shown after the first document has opened, which hides earlier notices.
        once = QtCore.Qt.ConnectionType.SingleShotConnection
        workbench.signals.changed.connect(lambda *_: workbench.notice.show_failure(refusal), once)
    _LOGGER.info("OpenGL %s", shell.canvas.viewport.opengl_info)
    return workbench


def mesh_or_path(mesh: object) -> Mesh | Path | None:
    """Mesh to show, or the path of a readable file for the window to open."""
    if mesh is None or isinstance(mesh, Mesh):
        return mesh
    if isinstance(mesh, str | Path):
        check_readable(Path(mesh), more_suffixes=(SESSION_SUFFIX, SERIES))
        return Path(mesh)
    if hasattr(mesh, "regular_faces"):  # pyvista.PolyData
        surface = mesh.triangulate()  # type: ignore[attr-defined]
        return Mesh(surface.points, surface.regular_faces.reshape(-1, 3))
    if hasattr(mesh, "vertices") and hasattr(mesh, "faces"):  # trimesh.Trimesh
        return Mesh(mesh.vertices, mesh.faces)
    raise InputError(
        tr("A {kind} cannot be shown; pass a mesh or the path of a mesh file.").format(
            kind=type(mesh).__name__
        )
    )


class GuiThreadGC(QtCore.QObject):
    """Collect cyclic garbage from a timer of the GUI thread.

    Python collects garbage on any allocating thread. A QTimer destroyed on a worker thread would crash the
    process.
    """

    def __init__(self, parent: QtCore.QObject | None = None) -> None:
        super().__init__(parent)
        gc.disable()
        self._threshold = gc.get_threshold()
        self._timer = QtCore.QTimer(self, timeout=self._check)
        self._timer.start(INTERVAL)

    def _check(self) -> None:
        counts = gc.get_count()
        for generation in (2, 1, 0):
            if counts[generation] > self._threshold[generation]:
                gc.collect(generation)
                return

    def close(self) -> None:
        """Enable Python's automatic garbage collection again."""
        self._timer.stop()
        gc.enable()
