"""Actions to select vertices: selection modes, operations on a whole part."""

from functools import partial

from PySide6.QtGui import QAction
from PySide6.QtWidgets import QMenu

from apd_viewer.geometry.pose.constraints import BASE, HANDLE
from apd_viewer.language import tr
from apd_viewer.session.model.document import Document
from apd_viewer.session.part_operations import PartOperation
from apd_viewer.ui.actions.commands import Commands
from apd_viewer.ui.actions.edit_controller import PartController
from apd_viewer.ui.filing.file_controller import FileController
from apd_viewer.ui.preferences.action_maker import ActionMaker
from apd_viewer.ui.tools.tool_modes import SelectionMode

_LARGER, _SMALLER = 1.25, 0.8
_GROW = tr("Add the neighbouring vertices to the active part")
_SHRINK = tr("Remove the outermost vertices from the active part")
_SMOOTH = tr("Smooth the boundary of the active part")
_INVERT = tr("Paint the unpainted vertices and clear the active part")
# Title, icon, tooltip, keys and operation on the active part.
_CHANGES = (
    (tr("&Grow"), "grow", _GROW, "Ctrl++", PartOperation.GROW),
    (tr("S&hrink"), "shrink", _SHRINK, "Ctrl+-", PartOperation.SHRINK),
    (tr("&Smooth boundary"), "smooth-border", _SMOOTH, "Ctrl+B", PartOperation.SMOOTH),
    (tr("In&vert"), "invert", _INVERT, "Ctrl+Shift+I", PartOperation.INVERT),
)
_MIRRORED = PartOperation.MIRROR_X, PartOperation.MIRROR_Y, PartOperation.MIRROR_Z
_MIRRORS = tuple(
    (
        tr("Along {axis}").format(axis=axis),
        f"mirror-{axis.lower()}",
        tr("Add the mirror image of the active part along {axis}").format(axis=axis),
        None,
        operation,
    )
    for axis, operation in zip("XYZ", _MIRRORED, strict=True)
)


class SelectActions:
    """Actions to select vertices."""

    def __init__(self, maker: ActionMaker, commands: Commands) -> None:
        self._make_modes(maker, commands)
        self._make_sizes(maker, commands)
        self._make_files(maker, commands.files)
        self._make_parts(maker, commands.parts)
        editing = commands.edits
        self.changes, self.mirrors = (
            [
                maker.make(
                    f"reshape:{operation.name}", title, image, tip, key, partial(editing.edit_part, operation)
                )
                for title, image, tip, key, operation in changes
            ]
            for changes in (_CHANGES, _MIRRORS)
        )

    def _make_modes(self, maker: ActionMaker, commands: Commands) -> None:
        self.modes = {}
        for way in SelectionMode:
            name, traits, command = f"way:{way.name}", way.traits, partial(commands.choose_mode, way)
            self.modes[way] = maker.make(name, traits.title, traits.icon, traits.tip, traits.key, command)
        maker.make_exclusive(self.modes.values())
        tip = tr("Let box, lasso and polygon also select hidden vertices")
        self.select_hidden = maker.make_checkable(
            "through",
            tr("&X-ray (select hidden)"),
            "through",
            tip,
            "T",
            commands.canvas.set_selects_hidden_vertices,
        )

    def _make_sizes(self, maker: ActionMaker, commands: Commands) -> None:
        make, brush, editing = maker.make, commands.canvas.brush.size, commands.edits
        larger, smaller = partial(brush.scale_radius, _LARGER), partial(brush.scale_radius, _SMALLER)
        tip = tr("Enter the brush radius, in pixels or as a length on the mesh")
        self.sizes = [
            make("larger", tr("&Larger brush"), "brush-larger", tr("Make the brush larger"), "]", larger),
            make(
                "smaller", tr("Smalle&r brush"), "brush-smaller", tr("Make the brush smaller"), "[", smaller
            ),
            make("type_brush", tr("Brush si&ze…"), "brush-size", tip, "Shift+D", editing.open_brush_entry),
        ]
        self.by_expression = make(
            "choose_by_numbers",
            tr("Select by ID or expressio&n…"),
            "type",
            tr("Select vertices by ID or by conditions on their coordinates"),
            "Ctrl+L",
            editing.open_vertex_entry,
        )

    def _make_parts(self, maker: ActionMaker, parts: PartController) -> None:
        self.clears = [
            maker.make(f"clear:{name}", title, f"clear-{name}", tip, None, command)
            for name, title, tip, command in (
                ("base", tr("Clear &base"), tr("Clear the base"), parts.clear_base),
                ("handle", tr("Clear &handle"), tr("Clear the active handle"), parts.clear_handle),
                ("region", tr("Clear &region"), tr("Clear the active region"), parts.clear_region),
                ("all", tr("Clear &all"), tr("Clear base, handles and regions"), parts.clear_all),
            )
        ]
        self._clear_tips = {action: (action.statusTip(), action.toolTip()) for action in self.clears}
        for action in self.clears:
            action.setEnabled(False)
        lock, hide = tr("Lock the active part against painting"), tr("Hide the colour of the active part")
        self.flags = [
            maker.make("lock_part", tr("Loc&k or unlock part"), "locked", lock, "K", parts.toggle_lock),
            maker.make("hide_part", tr("Hi&de or show part"), "hidden", hide, "Ctrl+H", parts.toggle_hidden),
        ]

    def _make_files(self, maker: ActionMaker, filing: FileController) -> None:
        load = tr("Load base, handles and regions from a file")
        save = tr("Save base, handles and regions to a file")
        self.files = [
            maker.make(name, title, image, tip, None, command)
            for name, title, image, tip, command in (
                ("load_selection", tr("L&oad selection…"), "load-selection", load, filing.load_selection),
                ("save_selection", tr("Save selec&tion…"), "save-selection", save, filing.save_selection),
            )
        ]

    def follow_document(self, document: Document) -> None:
        """Enable the clearing of parts that the document has."""
        counts = document.label_counts
        has = bool(counts[BASE]), bool(counts[HANDLE:].any()), bool(document.member.any())
        lacks = tr("There is no base"), tr("There is no handle"), tr("There is no region")
        rows = *zip(has, lacks, strict=True), (any(has), tr("Nothing is painted"))
        for action, (is_there, lack) in zip(self.clears, rows, strict=True):
            said, tip = self._clear_tips[action] if is_there else (lack, lack)
            action.setEnabled(is_there)
            action.setStatusTip(said)
            action.setToolTip(tip)

    @property
    def groups(self) -> list[list[QAction]]:
        """Actions of the tool bar shown while a painting tool is active."""
        return [list(self.modes.values()), [self.select_hidden], self.changes]

    def add_to_menu(self, menu: QMenu) -> None:
        """Add the selection actions to a menu."""
        menu.addActions(list(self.modes.values()))
        menu.addSeparator()
        menu.addActions([self.by_expression, self.select_hidden, *self.sizes])
        menu.addSeparator()
        menu.addActions(self.changes)
        self.mirror = menu.addMenu(tr("&Mirror"))
        self.mirror.addActions(self.mirrors)
        self.clear = menu.addMenu(tr("&Clear"))
        self.clear.addActions(self.clears)
        menu.addSeparator()
        menu.addActions(self.flags)
        menu.addSeparator()
        menu.addActions(self.files)
