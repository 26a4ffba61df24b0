"""Entries of the command search, ranked by the words of a query."""

from __future__ import annotations

import re
import unicodedata
from collections.abc import Callable, Iterable, Iterator
from dataclasses import dataclass
from difflib import SequenceMatcher
from functools import partial
from typing import NamedTuple

from PySide6 import QtWidgets
from PySide6.QtCore import Qt
from PySide6.QtGui import QAction

from apd_viewer.language import tr
from apd_viewer.session.state_store import StateStore
from apd_viewer.ui.help.context_help import section_name
from apd_viewer.ui.help.manual import ManualPlace, action_place, section_place, setting_place
from apd_viewer.ui.help.synonyms import CONTROL_SYNONYMS, SYNONYMS
from apd_viewer.ui.panel.panel import Panel
from apd_viewer.ui.preferences.action_maker import without_mnemonic
from apd_viewer.ui.preferences.shortcuts import ShortcutEntry, keys_of, native_keys
from apd_viewer.ui.settings_page.preference_table import GROUPS
from apd_viewer.ui.widgets.folding_section import Heading, Section, reveal_widget
from apd_viewer.ui.widgets.named_rows import NamedRow
from apd_viewer.ui.widgets.part_row import PartButtons
from apd_viewer.ui.widgets.slider_field import SliderField


@dataclass(frozen=True)
class Searchable:
    """Search entry of a command, a control or a setting.

    Attributes
    ----------
    location : str
        The menu, the section of the panel, or the settings.
    place : ManualPlace
        In the manual.
    disabled_reason : str
        Reason for a disabled entry; empty if it can be run.
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
    shell: QtWidgets.QMainWindow,
    entries: list[ShortcutEntry],
    panel: Panel,
    store: StateStore,
    open_settings: Callable[[str], object],
) -> list[Searchable]:
    """All commands and settings, and the controls not titled like a command."""
    found = list(command_entries(shell, entries, store))
    named = {each.texts.title for each in found}
    found += [each for each in control_entries(panel) if each.texts.title not in named]
    return [*found, *setting_entries(open_settings)]


def command_entries(
    shell: QtWidgets.QMainWindow, entries: list[ShortcutEntry], store: StateStore
) -> Iterator[Searchable]:
    """Search entries of all menu actions."""
    by_action = {entry.action: entry for entry in entries}
    for found in menu_entries(shell.menuBar()):
        menu, within, action = found
        entry = by_action.get(action)
        if entry is not None:
            where = tr("{menu} > {entry}").format(menu=menu, entry=within) if within else menu
            why_not = "" if action.isEnabled() else _disabled_reason(entry, store)
            title = found.full_title(entry.title)
            texts = SearchTexts(title, entry.tip, SYNONYMS.get(entry.name, ""))
            keys = native_keys(keys_of(action))
            place = action_place(entry.name)
            yield Searchable(texts, where, action.trigger, place, keys, why_not, entry.image)


def _disabled_reason(entry: ShortcutEntry, store: StateStore) -> str:
    """Reason for a disabled menu action."""
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
    tip = entry.action.toolTip()  # for example, the file has no texture
    return tip if tip and tip != entry.full_tip else tr("not available now")


def control_entries(panel: Panel) -> Iterator[Searchable]:
    """Search entries of the panel's controls outside lists, unique in a section."""
    for section in (panel.area, *panel.sections):
        heading = section.title if isinstance(section, Section) else tr("Area")
        known = set()
        for widget in filter(is_control, section.findChildren(QtWidgets.QWidget)):
            title, tip = title_and_tip(widget)
            if not (title in known or _is_in_row(widget) or is_section_heading(widget)):
                known.add(title)
                also = CONTROL_SYNONYMS.get(re.split("[:,]", title)[0], "")
                yield Searchable(
                    SearchTexts(title, tip, f"{also} {heading}"),
                    tr("{menu} > {entry}").format(menu=tr("Panel"), entry=heading),
                    partial(reveal_control, widget),
                    section_place(section_name(widget)),
                    disabled_reason="" if _is_offered(widget, panel) else tr("not available now"),
                )


def is_control(widget: QtWidgets.QWidget) -> bool:
    """True for a named input field or button, and a named reading with a tooltip."""
    owner = widget.parentWidget()
    if isinstance(owner, SliderField) and widget in (owner.slider, owner.reset_button):
        return False  # only the number field of a slider is listed
    title, tip = title_and_tip(widget)
    return bool(title and (tip if isinstance(widget, QtWidgets.QLabel) else isinstance(widget, _INPUTS)))


_INPUTS = (
    QtWidgets.QAbstractButton,
    QtWidgets.QAbstractItemView,
    QtWidgets.QAbstractSlider,
    QtWidgets.QAbstractSpinBox,
    QtWidgets.QComboBox,
    QtWidgets.QLineEdit,
    NamedRow,
)


def is_section_heading(widget: QtWidgets.QWidget) -> bool:
    """True for the heading of a section of the panel."""
    return isinstance(widget.parentWidget(), Section) and isinstance(widget, Heading)


def _is_in_row(widget: QtWidgets.QWidget) -> bool:
    """True for a row of a list, its contents, and the buttons of a part's row."""
    node: QtWidgets.QWidget | None = widget
    while node is not None and not isinstance(node, NamedRow | PartButtons):
        node = node.parentWidget()
    return node is not None


def _is_offered(widget: QtWidgets.QWidget, panel: Panel) -> bool:
    """True if a control is enabled and shown, or would be in an unfolded section."""
    node: QtWidgets.QWidget | None = widget
    while node is not None and node is not panel:
        owner = node.parentWidget()
        heading = getattr(owner, "heading", None)
        folded = isinstance(heading, Heading) and not heading.isChecked()
        if node.isHidden() and not folded and not isinstance(owner, QtWidgets.QStackedWidget):
            return False
        node = owner
    return widget.isEnabled()


def reveal_control(widget: QtWidgets.QWidget) -> None:
    """Show a control of the panel and give it the keyboard focus."""
    reveal_widget(widget)
    node = widget.parentWidget()
    while node is not None:
        if isinstance(node, QtWidgets.QDockWidget):
            node.show()
            node.raise_()
        node = node.parentWidget()
    widget.setFocus(Qt.FocusReason.TabFocusReason)


def setting_entries(open_settings: Callable[[str], object]) -> Iterator[Searchable]:
    """Search entries of all preferences."""
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


def title_and_tip(widget: QtWidgets.QWidget) -> tuple[str, str]:
    """Title and tooltip of a control, each on one line; empty if missing."""
    title = widget.accessibleName()
    if isinstance(widget, QtWidgets.QAbstractButton) and not title:
        title = without_mnemonic(widget.text())
    return _single_line(title), _single_line(widget.toolTip())


def _single_line(text: str) -> str:
    """Text with its line breaks and repeated spaces collapsed."""
    return " ".join(text.split())


class MenuEntry(NamedTuple):
    """Action with the titles of its menu and of its submenu, if any."""

    menu: str
    submenu_title: str
    action: QAction

    def full_title(self, title: str) -> str:
        """Title prefixed with that of the submenu, unless it already starts with it."""
        if not self.submenu_title or title.startswith(self.submenu_title):
            return title
        return tr("{menu}: {title}").format(menu=self.submenu_title, title=title)


def menu_entries(bar: QtWidgets.QMenuBar) -> Iterator[MenuEntry]:
    """All entries of a menu bar, in order."""
    for top in bar.actions():
        for action, within in _actions_of_menu(submenu(top)):
            yield MenuEntry(without_mnemonic(top.text()), within, action)


def submenu(action: QAction) -> QtWidgets.QMenu:
    """Submenu opened by an action."""
    menu = action.menu()
    assert isinstance(menu, QtWidgets.QMenu)
    return menu


def _actions_of_menu(menu: QtWidgets.QMenu, within: str = "") -> Iterator[tuple[QAction, str]]:
    """Actions of a menu with the titles of their submenus."""
    for action in menu.actions():
        if action.menu() is not None:
            yield from _actions_of_menu(submenu(action), without_mnemonic(action.text()))
        elif not action.isSeparator():
            yield action, within


# Stop words of a query, in lower case.
_EMPTY = frozenset(
    tr("a an and can do for get have how i in is it make me my of on or the to want with").split()
)
# Words for the mesh that fit any command; they count only if nothing else was typed.
_GENERAL = frozenset(tr("bottle mesh model object shape thing").split())
_TITLE, _ALSO, _TIP = 3.0, 3.0, 1.0
_WHOLE = 2.0  # bonus if the query matches every word of the title
_MESH = 1.5  # bonus for commands on the whole mesh if the query names it
_LONG = 5  # shortest word that may contain a typo
_PART = 4  # shortest word that may match inside another
_ALIKE = 0.8


class SearchTexts(NamedTuple):
    """Searchable texts of a command, control or setting.

    Parameters
    ----------
    synonyms : str
        Other words for the same.
    """

    title: str
    tip: str
    synonyms: str = ""


def normalized_words(text: str) -> list[str]:
    """Words of a text in lower case, without accents and punctuation."""
    flat = unicodedata.normalize("NFKD", text.casefold())
    return re.findall(r"[^\W_]+", "".join(letter for letter in flat if not unicodedata.combining(letter)))


class SearchQuery(NamedTuple):
    """Meaningful words of a query, and whether it names the mesh as a whole."""

    words: tuple[str, ...]
    is_general: bool

    @classmethod
    def from_text(cls, text: str) -> SearchQuery:
        """Query from typed text; if all words are stop words, all of them count."""
        words = normalized_words(text)
        telling = [word for word in words if word not in _EMPTY]
        special = [word for word in telling if word not in _GENERAL]
        return cls(tuple(special or telling or words), bool(special) and special != telling)


def match_score(query: SearchQuery, texts: SearchTexts) -> float:
    """Score of texts for a query; 0 unless most of its words are found."""
    title, tip, also = (normalized_words(text) for text in texts)
    total, found = 0.0, 0
    for word in query.words:
        best = max(
            _TITLE * _best_similarity(word, title),
            _ALSO * _best_similarity(word, also),
            _TIP * _best_similarity(word, tip),
        )
        total += best
        found += best > 0.0
    if not query.words or 2 * found <= len(query.words):
        return 0.0
    named = sum(max(_similarity(word, other) for word in query.words) for other in title) / max(1, len(title))
    general = query.is_general and not _GENERAL.isdisjoint(also)
    return total / len(query.words) + _WHOLE * named + _MESH * general


def _best_similarity(word: str, others: Iterable[str]) -> float:
    return max((_similarity(word, other) for other in others), default=0.0)


def _similarity(word: str, other: str) -> float:
    """Similarity of two words: 1 if equal, less for a prefix, a variant or a typo."""
    if word == other:
        return 1.0
    if other.startswith(word):
        return 0.9
    if word in other and (len(word) >= _PART or not word.isascii()):
        return 0.7  # match inside a compound word
    if not word.isascii() and len(other) > 1 and other in word:
        return 0.7  # scripts without spaces between words
    shared = len(word) >= _LONG - 1 and word[: max(4, len(word) - 3)] == other[: max(4, len(word) - 3)]
    if shared and abs(len(word) - len(other)) <= 3:
        return 0.8
    if min(len(word), len(other)) >= _LONG and SequenceMatcher(None, word, other).ratio() >= _ALIKE:
        return 0.6
    return 0.0
