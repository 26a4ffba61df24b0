"""Places of menu entries, settings and controls in the manual, by their names."""

from __future__ import annotations

import re
from collections.abc import Iterator
from typing import NamedTuple

from PySide6.QtCore import QPoint, Qt
from PySide6.QtGui import QAction
from PySide6.QtWidgets import (
    QAbstractButton,
    QAbstractItemView,
    QAbstractSlider,
    QAbstractSpinBox,
    QComboBox,
    QLabel,
    QLineEdit,
    QMainWindow,
    QMenu,
    QMenuBar,
    QScrollBar,
    QToolButton,
    QWidget,
)

from apd_viewer.ui.actions.action_maker import NAME_PROPERTY
from apd_viewer.ui.part_lists.named_rows import NamedRow
from apd_viewer.ui.scene.viewport import Viewport
from apd_viewer.ui.settings_page.settings_dialog import SETTING_PROPERTY
from apd_viewer.ui.widgets.folding_section import Heading
from apd_viewer.ui.widgets.slider_field import SliderField

_CONTROLS = (
    QAbstractButton,
    QAbstractItemView,
    QAbstractSlider,
    QAbstractSpinBox,
    QComboBox,
    QLineEdit,
    SliderField,
)
_PATH = "manualPath"  # property of a widget that is no part of its owner
_SHARED = "RunBar", "PartButtons"  # the same in several owners, so named by their class
_PANEL = "panel"  # its sections are groups of their own
_DEEPEST = 1  # of the objects without a widget of their own that hold controls


class ManualPlace(NamedTuple):
    """Page of the manual, and an anchor in it.

    Parameters
    ----------
    page : str
        Without its suffix, relative to the manual.
    anchor : str
        Empty for the beginning of the page.
    """

    page: str
    anchor: str = ""


def slug(name: str) -> str:
    """Anchor made of a name; signs count, so that ``up:-X`` and ``up:+X`` differ."""
    spoken = name.lower().replace("-", " minus ").replace("+", " plus ")
    return re.sub(r"[^a-z0-9]+", "-", spoken).strip("-")


def action_place(name: str) -> ManualPlace:
    """Place of the menu entry ``name``."""
    return ManualPlace("reference/keys", f"action-{slug(name)}")


def setting_place(name: str) -> ManualPlace:
    """Place of the preference ``name``."""
    return ManualPlace("reference/settings", f"setting-{slug(name)}")


def control_place(path: tuple[str, ...]) -> ManualPlace:
    """Place of a control or a group of controls, by its path."""
    return ManualPlace("reference/window", "-".join(("control", *path)))


def widget_place(widget: QWidget, mouse: QPoint | None = None) -> ManualPlace | None:
    """Place of a widget; None without a name.

    Parameters
    ----------
    widget : QWidget
    mouse : QPoint, optional
        Global position of the mouse, if that chooses a part of the widget.
    """
    action = _action_at(widget, mouse)
    if action is not None and (place := menu_entry_place(action)) is not None:
        return place
    setting = widget.property(SETTING_PROPERTY)
    if setting:
        return setting_place(str(setting))
    path = _explained_path(widget)
    return control_place(path) if path else None


def _explained_path(widget: QWidget) -> tuple[str, ...]:
    """Path of the control that has a widget or its caption, or else of its group."""
    around = list(_with_owners(_control_beside(widget) or widget))
    for one in around:
        if is_named(one):
            return control_path(one)
    paths = [control_path(one) for one in around]
    sections = [path[:2] for path in paths if len(path) > 1 and path[0] == _PANEL]
    return next(iter(sections), () if (_PANEL,) in paths else paths[0][:1])


def _with_owners(widget: QWidget) -> Iterator[QWidget]:
    node: QWidget | None = widget
    while node is not None:
        yield node
        node = node.parentWidget()


def _control_beside(widget: QWidget) -> QWidget | None:
    """Nearest control to the right of a caption, in its row."""
    row = widget.parentWidget()
    if row is None or not isinstance(widget, QLabel) or is_control(widget):
        return None
    place = widget.geometry()
    beside = [
        one
        for one in row.findChildren(QWidget, options=Qt.FindChildOption.FindDirectChildrenOnly)
        if is_named(one) and one.isVisible()
        if one.x() > place.right() and one.y() <= place.center().y() <= one.geometry().bottom()
    ]
    return min(beside, key=QWidget.x, default=None)


def menu_entry_place(action: QAction) -> ManualPlace | None:
    """Place of a menu entry; of a submenu, the place of its first entry."""
    menu = action.menu()
    while isinstance(menu, QMenu) and menu.actions():
        action = menu.actions()[0]
        menu = action.menu()
    name = action.property(NAME_PROPERTY)
    return action_place(str(name)) if name else None


def _action_at(widget: QWidget, at: QPoint | None) -> QAction | None:
    """Action behind a widget, if any."""
    if isinstance(widget, QMenu | QMenuBar):
        under = widget.actionAt(widget.mapFromGlobal(at)) if at is not None else None
        return under or widget.activeAction()
    return widget.defaultAction() if isinstance(widget, QToolButton) else None


def is_control(widget: QWidget) -> bool:
    """True for input fields and buttons, and for readings with a tip."""
    if isinstance(widget, QLabel):
        return bool(widget.toolTip() and widget.accessibleName())
    return isinstance(widget, (*_CONTROLS, NamedRow)) and not isinstance(widget, QScrollBar)


def is_named(widget: QWidget) -> bool:
    """True for a control with a name of its own, rather than a part of one."""
    has_name = _owner(widget)[0] is not None or (_is_own(widget) and not _is_general(widget))
    return is_control(widget) and has_name


def control_path(widget: QWidget) -> tuple[str, ...]:
    """Names of a widget from its outermost owner down; empty if it has none.

    The outermost owner is named by its class, all others by the attribute that holds them. Members of a list
    or mapping share the name of the attribute, as the rows of a list do. What has no name is part of what
    contains it.
    """
    if given := widget.property(_PATH):
        return tuple(str(given).split("/"))
    names: list[str] = []
    node: QWidget | None = widget
    while node is not None:
        owner, name = (None, "") if type(node).__name__ in _SHARED else _owner(node)
        if owner is not None:
            if not isinstance(node, Heading):  # which stands for its section
                names.insert(0, name)
            node = owner
        elif isinstance(node, QMainWindow):
            break
        elif _is_own(node) and not _is_general(node):
            return (class_slug(type(node)), *names)
        else:
            node = node.parentWidget()
    return ()


def _is_general(widget: QWidget) -> bool:
    return type(widget).__module__.startswith("apd_viewer.ui.widgets.")


def class_slug(kind: type) -> str:
    """Name of a class in an anchor: ``sweep-dialog`` for SweepDialog."""
    return re.sub(r"(?<=[a-z])(?=[A-Z])", "-", kind.__name__.strip("_")).lower()


def _owner(widget: QWidget) -> tuple[QWidget | None, str]:
    """Nearest owner of ``widget`` with an attribute for it, and its name."""
    owner = widget.parentWidget()
    # A main window holds what has the name of its class; what is part of a control belongs to it.
    while owner is not None and not isinstance(owner, QMainWindow):
        if not isinstance(owner, (*_CONTROLS, Viewport)):
            for name, part in _parts(owner, _DEEPEST):
                if part is widget:
                    return owner, name
        owner = owner.parentWidget()
    return None, ""


def _parts(owner: object, depth: int) -> Iterator[tuple[str, object]]:
    """Attributes of an object and of its parts, with their names."""
    for name, value in vars(owner).items():
        members = value.values() if isinstance(value, dict) else value
        for part in members if isinstance(value, dict | list | tuple) else [value]:
            if isinstance(part, QWidget):
                yield slug(name), part
            elif depth and _is_own(part) and hasattr(part, "__dict__"):
                yield from ((f"{slug(name)}-{inner}", found) for inner, found in _parts(part, depth - 1))


def _is_own(thing: object) -> bool:
    return type(thing).__module__.startswith("apd_viewer.ui.")
