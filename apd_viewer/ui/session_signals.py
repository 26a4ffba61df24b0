"""The listener of a session as Qt signals."""

from __future__ import annotations

from PySide6.QtCore import QObject, Signal

from apd_viewer.session.listener import Listener


class SessionSignals(QObject):
    """One signal for each callback of a :class:`Listener`.

    Attributes
    ----------
    woken : Signal()
        Emitted on any thread; the others on the thread of the session.
    changed : Signal(State or None, State)
    status_changed, measured : Signal()
    told, failed : Signal(str)
    viewed : Signal(View)
    """

    woken = Signal()
    changed = Signal(object, object)
    status_changed = Signal()
    told = Signal(str)
    failed = Signal(str)
    viewed = Signal(object)
    measured = Signal()

    def listener(self) -> Listener:
        """Listener emitting the signals."""
        return Listener(
            wake=self.woken.emit,
            changed=self.changed.emit,
            status_changed=self.status_changed.emit,
            told=self.told.emit,
            failed=self.failed.emit,
            viewed=self.viewed.emit,
            measured=self.measured.emit,
        )
