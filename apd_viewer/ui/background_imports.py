"""What the window works with, imported behind its first picture."""

from __future__ import annotations

import threading

from PySide6.QtCore import QObject, Signal


class Loading(QObject):
    """Imports and compiles what the window itself needs, on a thread of its own.

    Attributes
    ----------
    loaded : Signal()
        The window can start, unless there is an ``error``.
    error : Exception or None
        What is missing or broken.
    """

    loaded = Signal()

    def __init__(self) -> None:
        super().__init__()
        self.error: Exception | None = None
        self._thread = threading.Thread(target=self._run, name="loading", daemon=True)

    def begin(self) -> None:
        """Begin; once is enough."""
        if self._thread.ident is None:
            self._thread.start()

    def join(self) -> None:
        """Wait for the end: a thread that compiles while the interpreter ends would take it down."""
        if self._thread.ident is not None:
            self._thread.join()

    def _run(self) -> None:
        # All that takes long to import is imported here; a library that is there may still be broken.
        try:
            import apd_viewer.session.session  # noqa: F401
            from apd_viewer.geometry.picking import surface_index

            surface_index.warm_up()
        except (ImportError, OSError) as error:
            self.error = error
        finally:
            self.loaded.emit()
