"""The libraries of a session, imported behind the first picture."""

from __future__ import annotations

import threading

from PySide6.QtCore import QObject, Signal


class BackgroundImports(QObject):
    """Imports and compiles the workbench's modules on a thread.

    Attributes
    ----------
    loaded : Signal()
        The workbench can be built, unless there is an ``error``.
    error : Exception or None
        A library is missing or broken.
    """

    loaded = Signal()

    def __init__(self) -> None:
        super().__init__()
        self.error: Exception | None = None
        self._thread = threading.Thread(target=self._run, name="imports", daemon=True)

    def begin(self) -> None:
        """Begin; once is enough."""
        if self._thread.ident is None:
            self._thread.start()

    def join(self) -> None:
        """Wait for the thread: compiling at interpreter exit would crash it."""
        if self._thread.ident is not None:
            self._thread.join()

    def _run(self) -> None:
        try:
            # All slow imports are made here, behind the first picture; an installed library may be broken.
            import apd_viewer.ui.workbench  # noqa: F401
            from apd_viewer.geometry.picking import surface_index

            surface_index.warm_up()
        except (ImportError, OSError) as error:
            self.error = error
        finally:
            self.loaded.emit()
