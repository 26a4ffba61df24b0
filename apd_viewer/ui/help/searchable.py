"""Entries of the search: menu entries, controls of the panel, settings."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from dataclasses import dataclass
from functools import partial
from typing import TYPE_CHECKING

from PySide6.QtCore import Qt, QTimer
from PySide6.QtWidgets import QDockWidget, QMainWindow, QScrollArea, QWidget

from apd_viewer.language import tr
from apd_viewer.ui.help import places
from apd_viewer.ui.help.control_texts import texts_of
from apd_viewer.ui.help.menu_entries import menu_entries
from apd_viewer.ui.help.places import ManualPlace
from apd_viewer.ui.help.synonyms import ALSO
from apd_viewer.ui.help.word_match import Texts
from apd_viewer.ui.preferences.shortcuts import ShortcutEntry, keys_of, native
from apd_viewer.ui.settings_page.preference_table import GROUPS
from apd_viewer.ui.widgets.folding_section import Heading, Section
from apd_viewer.ui.widgets.slider_field import Dial

if TYPE_CHECKING:
    from apd_viewer.session.store import Store
    from apd_viewer.ui.panel.panel import Panel


@dataclass(frozen=True)
class Searchable:
    """A command, a control or a setting.

    Attributes
    ----------
    texts : Texts
    where : str
        The menu, the section of the panel, or the settings.
    run : callable
    place : ManualPlace
        In the manual.
    keys : str
    why_not : str
        Why it cannot be run now; empty if it can.
    image : str
        Name of its icon.
    """

    texts: Texts
    where: str
    run: Callable[[], object]
    place: ManualPlace
    keys: str = ""
    why_not: str = ""
    image: str = "panel"


def everything(
    shell: QMainWindow,
    entries: list[ShortcutEntry],
    panel: Panel,
    store: Store,
    open_settings: Callable[[str], object],
) -> list[Searchable]:
    """Commands, settings, and controls with other titles than commands."""
    found = list(commands(shell, entries, store))
    named = {each.texts.title for each in found}
    found += [each for each in controls(panel) if each.texts.title not in named]
    return [*found, *settings(open_settings)]


def commands(shell: QMainWindow, entries: list[ShortcutEntry], store: Store) -> Iterator[Searchable]:
    """All menu entries."""
    by_action = {entry.action: entry for entry in entries}
    for found in menu_entries(shell.menuBar()):
        menu, within, action = found
        entry = by_action.get(action)
        if entry is not None:
            where = tr("{menu} > {entry}").format(menu=menu, entry=within) if within else menu
            why_not = "" if action.isEnabled() else _why_not(entry, store)
            title = found.full(entry.title)
            texts = Texts(title, entry.tip, ALSO.get(entry.name, ""))
            keys = native(keys_of(action))
            place = places.of_action(entry.name)
            yield Searchable(texts, where, action.trigger, place, keys, why_not, entry.image)


def _why_not(entry: ShortcutEntry, store: Store) -> str:
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
    return said if said and said != entry.whole_tip else tr("not with what is open")


def controls(panel: Panel) -> Iterator[Searchable]:
    """Controls of the panel, each path once."""
    known = set()
    for section in (panel.area, *panel.sections):
        heading = section.title if isinstance(section, Section) else tr("Area")
        for widget in section.findChildren(QWidget):
            path = places.path_of(widget) if places.is_named(widget) else ()
            title, tip = texts_of(widget)
            if len(path) > 2 and "rows" not in path and title and path not in known:
                known.add(path)
                yield Searchable(
                    Texts(title, tip, f"{ALSO.get('/'.join(path), '')} {heading}"),
                    tr("{menu} > {entry}").format(menu=tr("Panel"), entry=heading),
                    partial(reveal, widget),
                    places.of_control(path),
                    why_not="" if _is_offered(widget, panel) else tr("not with what is open"),
                )


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


def reveal(widget: QWidget) -> None:
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
    field = widget.field if isinstance(widget, Dial) else widget
    field.setFocus(Qt.FocusReason.TabFocusReason)


def settings(open_settings: Callable[[str], object]) -> Iterator[Searchable]:
    """All preferences."""
    for group in GROUPS:
        for preference in group.rows:
            yield Searchable(
                Texts(preference.title, f"{preference.tip} {preference.note}", ALSO.get(preference.name, "")),
                tr("{menu} > {entry}").format(menu=tr("Settings"), entry=group.title),
                partial(open_settings, preference.name),
                places.of_setting(preference.name),
                image="settings",
            )
