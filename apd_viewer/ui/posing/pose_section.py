"""Panel section of the named poses."""

from collections.abc import Sequence

from PySide6.QtCore import Signal
from PySide6.QtWidgets import QPushButton

from apd_viewer.language import tr, trc
from apd_viewer.ui.widgets.box_layouts import add_parts, row_layout
from apd_viewer.ui.widgets.fields import small_button
from apd_viewer.ui.widgets.folding_section import Section, quiet_label
from apd_viewer.ui.widgets.named_rows import NamedList, NamedRow
from apd_viewer.ui.widgets.theme import Theme, icon


class PoseRow(NamedRow):
    """Row of a named pose, with a button to update it."""

    def __init__(self, name: str) -> None:
        super().__init__(name, tr("Remove this pose"))
        self.setToolTip(tr("Click to move the handles there, double-click or F2 to rename, Delete to remove"))
        tip = tr("Update this pose: keep the present places of all handles under its name")
        self.update_pose = small_button(tr("Update this pose"), tip)
        row_layout(
            (self.name, 1), self.update_pose, self.remove, spacing=4, margins=(8, 3, 4, 3), parent=self
        )

    def set_active(self, on: bool) -> None:
        """Mark the pose as current; the update button is then hidden."""
        super().set_active(on)
        self.update_pose.setVisible(not on)

    def set_theme(self, theme: Theme) -> None:
        """Redraw the icons."""
        super().set_theme(theme)
        self.update_pose.setIcon(icon("save", theme))


class PoseList(NamedList[PoseRow]):
    """List of the named poses."""

    update_requested = Signal(int)

    def __init__(self) -> None:
        super().__init__(self._row)

    def _row(self, k: int, name: str) -> PoseRow:
        row = PoseRow(name)
        row.update_pose.clicked.connect(lambda: self.update_requested.emit(k))
        return row


class PoseSection(Section):
    """Named poses of all handles, to switch between.

    Attributes
    ----------
    keep_requested : Signal()
        The present pose is to be kept under a new name.
    """

    keep_requested = Signal()

    def __init__(self) -> None:
        super().__init__(tr("Poses"))
        about = tr("Keep where all handles are now, and return to it with a click.")
        self.empty = quiet_label(tr("About poses"), about)
        self.list = PoseList()
        self.add = QPushButton(
            tr("Keep pose"), toolTip=tr("Keep the present places of all handles under a name")
        )
        self.add.clicked.connect(self.keep_requested)
        add_parts(self.column, self.empty, self.list, 4, self.add)
        self.show_poses((), None)

    def show_poses(self, names: Sequence[str], active: int | None) -> None:
        """Show the poses, and mark the current one."""
        self.list.show_names(names, active)
        self.empty.setVisible(not names)
        self.heading.show_reading(f"{len(names)}" if names else trc("poses", "none"), only_folded=True)

    def set_theme(self, theme: Theme) -> None:
        """Redraw the icons."""
        super().set_theme(theme)
        self.list.set_theme(theme)
        self.add.setIcon(icon("add", theme))
