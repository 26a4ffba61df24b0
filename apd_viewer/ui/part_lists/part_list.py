"""A list of named parts of the mesh, each with its colour; one of them is active."""

from __future__ import annotations

from collections.abc import Callable, Sequence

from PySide6.QtCore import Signal

from apd_viewer.ui.part_lists.named_rows import NamedList
from apd_viewer.ui.part_lists.part_row import PartRow


class PartList(NamedList[PartRow]):
    """The rows, as many as there are parts.

    Parameters
    ----------
    colors : sequence of (int, int, int)
    make : callable
        From a name and a colour to a new row.

    Attributes
    ----------
    hidden, locked : Signal(int, bool)
    cleared : Signal(int)
    """

    hidden = Signal(int, bool)
    locked = Signal(int, bool)
    cleared = Signal(int)

    def __init__(
        self,
        colors: Sequence[tuple[int, int, int]],
        make: Callable[[int, str, tuple[int, int, int]], PartRow],
    ) -> None:
        super().__init__(lambda k, name: self._connected(k, make(k, name, colors[k % len(colors)])))

    def _connected(self, k: int, row: PartRow) -> PartRow:
        row.buttons.hide_requested.connect(lambda on: self.hidden.emit(k, on))
        row.buttons.lock_requested.connect(lambda on: self.locked.emit(k, on))
        row.buttons.clear_requested.connect(lambda: self.cleared.emit(k))
        return row
