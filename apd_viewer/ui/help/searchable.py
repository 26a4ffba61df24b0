"""Entries of the search: menu entries, controls of the panel, settings."""

from __future__ import annotations

import re
from collections.abc import Callable, Iterator
from dataclasses import dataclass
from functools import partial
from typing import NamedTuple

from PySide6.QtCore import Qt, QTimer
from PySide6.QtGui import QAction
from PySide6.QtWidgets import (
    QAbstractButton,
    QAbstractItemView,
    QAbstractSlider,
    QAbstractSpinBox,
    QComboBox,
    QDockWidget,
    QLabel,
    QLineEdit,
    QMainWindow,
    QMenu,
    QMenuBar,
    QScrollArea,
    QWidget,
)

from apd_viewer.language import tr
from apd_viewer.session.state_store import StateStore
from apd_viewer.ui.actions.action_maker import without_mnemonic
from apd_viewer.ui.help.context_help import section_name
from apd_viewer.ui.help.manual import ManualPlace, action_place, section_place, setting_place
from apd_viewer.ui.help.search_query import SearchTexts
from apd_viewer.ui.help.synonyms import CONTROL_SYNONYMS, SYNONYMS
from apd_viewer.ui.panel.panel import Panel
from apd_viewer.ui.part_lists.named_rows import NamedRow
from apd_viewer.ui.part_lists.part_row import PartButtons
from apd_viewer.ui.preferences.shortcuts import ShortcutEntry, keys_of, native_keys
from apd_viewer.ui.settings_page.preference_table import GROUPS
from apd_viewer.ui.widgets.folding_section import Heading, Section
from apd_viewer.ui.widgets.slider_field import SliderField


@dataclass(frozen=True)
class Searchable:
    """A command, a control or a setting.

    Attributes
    ----------
    texts : SearchTexts
    location : str
        The menu, the section of the panel, or the settings.
    run : callable
    place : ManualPlace
        In the manual.
    keys : str
    disabled_reason : str
        Why it cannot be run now; empty if it can.
    image : str
        Name of its icon.
    """

    texts: SearchTexts
    location: str
    run: Callable[[], object]
    place: ManualPlace
    keys: str = ""
    disabled_reason: str = ""
    image: str = "panel"


def searchable_entries(
    shell: QMainWindow,
    entries: list[ShortcutEntry],
    panel: Panel,
    store: StateStore,
    open_settings: Callable[[str], object],
) -> list[Searchable]:
    """Commands, settings, and controls with other titles than commands."""
    found = list(command_entries(shell, entries, store))
    named = {each.texts.title for each in found}
    found += [each for each in control_entries(panel) if each.texts.title not in named]
    return [*found, *setting_entries(open_settings)]


def command_entries(
    shell: QMainWindow, entries: list[ShortcutEntry], store: StateStore
) -> Iterator[Searchable]:
    """All menu entries."""
    by_action = {entry.action: entry for entry in entries}
    for found in menu_entries(shell.menuBar()):
        menu, within, action = found
        entry = by_action.get(action)
        if entry is not None:
            where = tr("{menu} > {entry}").format(menu=menu, entry=within) if within else menu
            why_not = "" if action.isEnabled() else _why_not(entry, store)
            title = found.full_title(entry.title)
            texts = SearchTexts(title, entry.tip, SYNONYMS.get(entry.name, ""))
            keys = native_keys(keys_of(action))
            place = action_place(entry.name)
            yield Searchable(texts, where, action.trigger, place, keys, why_not, entry.image)


def _why_not(entry: ShortcutEntry, store: StateStore) -> str:
    """Reason against choosing an entry."""
    name = entry.name
    if store.state is None:
        return tr("open a mesh first")
    if name in ("undo", "redo"):
        return tr("there is no step to undo") if name == "undo" else tr("there is no step to redo")
    if name in ("reset", "bake"):
        return tr("the shape is at rest")
    if name == "clear_target" or name.startswith("measure:"):
        return tr("load a target shape first")
    if name.endswith("_obstacle"):
        return tr("click an obstacle first")
    said = entry.action.toolTip()  # such as: the file has no texture
    return said if said and said != entry.full_tip else tr("not with what is open")


def control_entries(panel: Panel) -> Iterator[Searchable]:
    """Controls of the panel outside list rows, each title of a section once."""
    for section in (panel.area, *panel.sections):
        heading = section.title if isinstance(section, Section) else tr("Area")
        known = set()
        for widget in filter(is_control, section.findChildren(QWidget)):
            title, tip = texts_of(widget)
            if not (title in known or _is_in_row(widget) or is_section_heading(widget)):
                known.add(title)
                also = CONTROL_SYNONYMS.get(re.split("[:,]", title)[0], "")
                yield Searchable(
                    SearchTexts(title, tip, f"{also} {heading}"),
                    tr("{menu} > {entry}").format(menu=tr("Panel"), entry=heading),
                    partial(reveal_control, widget),
                    section_place(section_name(widget)),
                    disabled_reason="" if _is_offered(widget, panel) else tr("not with what is open"),
                )


def is_control(widget: QWidget) -> bool:
    """True for a named input field or button, and for a named reading with a tip."""
    owner = widget.parentWidget()
    if isinstance(owner, SliderField) and widget in (owner.slider, owner.reset_button):
        return False  # besides its field
    title, tip = texts_of(widget)
    return bool(title and (tip if isinstance(widget, QLabel) else isinstance(widget, _INPUTS)))


_INPUTS = (
    QAbstractButton,
    QAbstractItemView,
    QAbstractSlider,
    QAbstractSpinBox,
    QComboBox,
    QLineEdit,
    NamedRow,
)


def is_section_heading(widget: QWidget) -> bool:
    """True for the heading of a section of the panel."""
    return isinstance(widget.parentWidget(), Section) and isinstance(widget, Heading)


def _is_in_row(widget: QWidget) -> bool:
    """True for a row of a list, its contents, and the buttons of a part."""
    node: QWidget | None = widget
    while node is not None and not isinstance(node, NamedRow | PartButtons):
        node = node.parentWidget()
    return node is not None


def _is_offered(widget: QWidget, panel: Panel) -> bool:
    """True if a control is shown, or would be in an unfolded section."""
    node: QWidget | None = widget
    while node is not None and node is not panel:
        owner = node.parentWidget()
        heading = getattr(owner, "heading", None)
        folded = isinstance(heading, Heading) and not heading.isChecked()
        if node.isHidden() and not folded:
            return False
        node = owner
    return widget.isEnabled()


def reveal_control(widget: QWidget) -> None:
    """Show a control of the panel and give it the keys."""
    node = widget.parentWidget()
    while node is not None:
        if isinstance(heading := getattr(node, "heading", None), Heading):
            heading.setChecked(True)
        elif isinstance(node, QDockWidget):
            node.show()
            node.raise_()
        elif isinstance(node, QScrollArea):
            QTimer.singleShot(0, node, partial(node.ensureWidgetVisible, widget))  # once it has its place
        node = node.parentWidget()
    widget.setFocus(Qt.FocusReason.TabFocusReason)


def setting_entries(open_settings: Callable[[str], object]) -> Iterator[Searchable]:
    """All preferences."""
    for group in GROUPS:
        for preference in group.rows:
            yield Searchable(
                SearchTexts(
                    preference.title, f"{preference.tip} {preference.note}", SYNONYMS.get(preference.name, "")
                ),
                tr("{menu} > {entry}").format(menu=tr("Settings"), entry=group.title),
                partial(open_settings, preference.name),
                setting_place(preference.name),
                image="settings",
            )


def texts_of(widget: QWidget) -> tuple[str, str]:
    """Title and tip of a control, each on one line; empty if missing."""
    title = widget.accessibleName()
    if isinstance(widget, QAbstractButton) and not title:
        title = without_mnemonic(widget.text())
    return _flat(title), _flat(widget.toolTip())


def _flat(text: str) -> str:
    """Text on one line."""
    return " ".join(text.split())


class MenuEntry(NamedTuple):
    """An entry, with the titles of its menu and of its submenu, if any."""

    menu: str
    submenu_title: str
    action: QAction

    def full_title(self, title: str) -> str:
        """Title prefixed by the submenu's, unless they repeat each other."""
        if not self.submenu_title or title.startswith(self.submenu_title):
            return title
        return tr("{menu}: {title}").format(menu=self.submenu_title, title=title)


def menu_entries(bar: QMenuBar) -> Iterator[MenuEntry]:
    """All entries of a menu bar, in its order."""
    for top in bar.actions():
        for action, within in _leaves(submenu(top)):
            yield MenuEntry(without_mnemonic(top.text()), within, action)


def submenu(action: QAction) -> QMenu:
    """Menu of an action."""
    menu = action.menu()
    assert isinstance(menu, QMenu)
    return menu


def _leaves(menu: QMenu, within: str = "") -> Iterator[tuple[QAction, str]]:
    """Actions of a menu with the titles of their submenus."""
    for action in menu.actions():
        if action.menu() is not None:
            yield from _leaves(submenu(action), without_mnemonic(action.text()))
        elif not action.isSeparator():
            yield action, within
