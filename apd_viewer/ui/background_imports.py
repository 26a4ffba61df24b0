"""Imports of the session's libraries, started after the first frame."""

from __future__ import annotations

import threading
from typing import TYPE_CHECKING

from PySide6.QtCore import QObject, Signal

if TYPE_CHECKING:
    from apd_viewer.session.processes.compilation import CompilerProcesses


class BackgroundImports(QObject):
    """Thread importing the workbench's modules and compiling its kernels.

    Attributes
    ----------
    loaded : Signal()
        The workbench can be built, unless there is an ``error``.
    error : Exception or None
        A library is missing or broken.
    """

    loaded = Signal()
    _compiles = Signal()

    def __init__(self) -> None:
        super().__init__()
        self._compilers: CompilerProcesses | None = None
        self._given_up = False
        self._compiles.connect(self._compile_beside)
        self.error: Exception | None = None
        self._thread = threading.Thread(target=self._run, name="imports", daemon=True)

    def begin(self) -> None:
        """Start the thread; further calls have no effect."""
        if self._thread.ident is None:
            self._thread.start()

    def join(self) -> None:
        """Stop compiling and wait for the thread.

        Compiling at interpreter exit would crash it.
        """
        self._given_up = True
        if self._compilers is not None:
            self._compilers.end()
        if self._thread.ident is not None:
            self._thread.join()

    def _run(self) -> None:
        try:
            # All slow imports happen here, after the first frame; an installed library may be broken.
            import apd_viewer.ui.workbench  # noqa: F401
            from apd_viewer.geometry.warmup import report_compilations, warm_up
            from apd_viewer.session.processes import compilation  # noqa: F401

            stop = report_compilations(lambda _: self._compiles.emit())
            warm_up("window", is_cancelled=lambda: self._given_up)
            stop()
        except (ImportError, OSError) as error:
            self.error = error
        finally:
            self.loaded.emit()

    def _compile_beside(self) -> None:
        """Compile the kernels of a first drag in parallel, as they are not cached yet."""
        # The thread has already imported this module, after the first frame.
        from apd_viewer.session.processes.compilation import CompilerProcesses

        if self._compilers is None:
            self._compilers = CompilerProcesses()
            self._compilers.start()
