"""The callbacks of a session, and followers of every change within it."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace

from apd_viewer.session.model.state import State
from apd_viewer.session.model.view import View


@dataclass(frozen=True)
class Listener:
    """Callbacks of a session: ``wake`` on other threads, the rest on the owner's.

    Attributes
    ----------
    wake : callable
        Something waits to be received: call :meth:`Session.receive` on the owner's thread.
    changed : callable
        ``changed(old, new)``: the state was replaced, and activity, job or history may differ, too; old is
        None the first time.
    status_changed : callable
        Activity, job or history may differ, and the state does not.
    message_sent : callable
        ``message_sent(sentence)``: something the user should read.
    failed : callable
        ``failed(sentence)``: something the user asked for was not done, and why.
    view_opened : callable
        ``view_opened(view)``: a session was opened, and this is how it was looked at; after ``changed``.
    measurements_changed : callable
        More is known about the shape on screen, or less, because it is another one.
    """

    wake: Callable[[], object]
    changed: Callable[[State | None, State], object]
    status_changed: Callable[[], object]
    message_sent: Callable[[str], object]
    failed: Callable[[str], object]
    view_opened: Callable[[View], object] = lambda _: None
    measurements_changed: Callable[[], object] = lambda: None


def with_followers(listener: Listener, followers: Sequence[Callable[[], object]]) -> Listener:
    """The listener, with each follower called after a change of state or status."""

    def changed(old: State | None, new: State) -> None:
        listener.changed(old, new)
        for follow in followers:
            follow()

    def status_changed() -> None:
        listener.status_changed()
        for follow in followers:
            follow()

    return replace(listener, changed=changed, status_changed=status_changed)
