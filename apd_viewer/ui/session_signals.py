"""The listener of a session as Qt signals."""

from __future__ import annotations

from PySide6.QtCore import QObject, Signal

from apd_viewer.session.model.state import State
from apd_viewer.session.state_store import Listener


class SessionSignals(QObject):
    """One signal for each callback of a :class:`Listener`.

    Attributes
    ----------
    woken : Signal()
        Emitted on any thread; the others on the thread of the session.
    changed : Signal(State or None, State)
    status_changed : Signal()
        Emitted after ``changed``, too.
    measured : Signal()
    message_sent, failed : Signal(str)
    view_opened : Signal(View)
    """

    woken = Signal()
    changed = Signal(object, object)
    status_changed = Signal()
    message_sent = Signal(str)
    failed = Signal(str)
    view_opened = Signal(object)
    measured = Signal()

    def listener(self) -> Listener:
        """Listener emitting the signals."""
        return Listener(
            wake=self.woken.emit,
            changed=self._change,
            status_changed=self.status_changed.emit,
            message_sent=self.message_sent.emit,
            failed=self.failed.emit,
            view_opened=self.view_opened.emit,
            measurements_changed=self.measured.emit,
        )

    def _change(self, old: State | None, new: State) -> None:
        self.changed.emit(old, new)
        self.status_changed.emit()
