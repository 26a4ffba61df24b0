"""The search for commands: by what one wants to do, with the keyboard alone."""

import pytest
from driving import LEFT
from PySide6.QtCore import Qt

from apd_viewer.language import CATALOGUE_FOLDER, catalogue
from apd_viewer.ui.help import manual
from apd_viewer.ui.help.searchable import SearchQuery, SearchTexts, match_score
from apd_viewer.ui.help.synonyms import CONTROL_SYNONYMS, SYNONYMS

CTRL = Qt.KeyboardModifier.ControlModifier
# Wishes, and a title that is among the first three.
WISHES = {
    "mirror": "Mirror: Along X",
    "make the bottle smaller": "Enter motion",
    "make the brush smaller": "Smaller brush",
    "thickness of the wall": "Wall thickness",
    "save as stl": "Export",
    "screenshot": "Save picture",
    "wireframe": "Edges",
    "hold the bottom in place": "Paint base",
    "squeeze": "Press between plates",
    "top load": "Press",
    "side load test": "Press between plates",
    "panelling by vacuum": "Volume target",
    "fill level": "Volume target",
    "brimful capacity": "Volume target",
    "heat map": "Overlay: Local area change",
    "stiffnes": "Stiffness",
    "preferences": "Settings",
    "keyboard": "Shortcuts",
    "dark": "Appearance: Dark",
    "autosave": "Autosave",
    "rotate the handle": "Move handle",
    "bottle": "Open sample: PET bottle",
    "smallest": "Study",
    "smallest volume": "Study",
    "how small": "Study",
}

# Words of the trade, and where the program does what they name.
TRADE = {
    "top load": "Press",
    "side load": "Press",
    "squeeze": "Press",
    "crush": "Press",
    "vacuum": "Volume target",
    "panelling": "Volume target",
    "fill level": "Volume target",
    "brimful": "Volume target",
    "dent": "Obstacles: Add sphere",
    "fold": "Move handle",
}
# The same in other languages, and the command or control whose synonyms have them.
ABROAD = {
    "de": {
        "Topload Kopflast Seitenlast quetschen zerdrücken stauchen": "press",
        "Vakuum Unterdruck Paneling Füllstand Füllhöhe randvoll": "Volume target",
        "Delle eindellen": "add_obstacle:SPHERE",
        "falten": "take:MOVE",
    },
    "zh_CN": {
        "顶压 顶部载荷 侧压 侧向载荷 挤压 压扁": "press",
        "真空 瘪陷 液位 灌装量 满口容量": "Volume target",
        "凹痕 凹陷": "add_obstacle:SPHERE",
        "折叠 对折": "take:MOVE",
    },
}


@pytest.fixture
def search(qtbot, bottle):
    """The search in a window that has the keys, opened by its key."""
    bottle.shell.activateWindow()
    qtbot.waitUntil(bottle.shell.isActiveWindow)
    bottle.canvas.viewport.setFocus()
    qtbot.keyClick(bottle.canvas.viewport, Qt.Key.Key_F, CTRL)
    assert bottle.help.search.isVisible()
    assert bottle.shell.focusWidget() is bottle.help.search.search
    return bottle.help.search


def found(search, text):
    """Titles found for a text, typed anew."""
    search.search.setText(text)
    items = [search.list.topLevelItem(k) for k in range(search.list.topLevelItemCount())]
    return [item.text(0) for item in items]


def test_command_search_finds_wishes_under_their_words_and_others(search):
    missed = {wish: found(search, wish)[:3] for wish in WISHES if WISHES[wish] not in found(search, wish)[:3]}
    assert missed == {}
    assert found(search, "xqzw") == ["Search the manual for “xqzw”"]
    assert found(search, " ") == []


@pytest.mark.parametrize("word", TRADE)
def test_command_search_finds_by_a_word_of_the_trade(qtbot, search, word):
    qtbot.keyClicks(search.search, word)
    titles = [search.list.topLevelItem(k).text(0) for k in range(search.list.topLevelItemCount())]
    assert TRADE[word] in titles[:3]


@pytest.mark.parametrize(
    ("language", "word", "name"),
    [
        (language, word, name)
        for language, words in ABROAD.items()
        for each, name in words.items()
        for word in each.split()
    ],
)
def test_synonyms_have_the_words_of_the_trade_in_other_languages(language, word, name):
    _, texts = catalogue(CATALOGUE_FOLDER, [language])
    found = texts.gettext((SYNONYMS | CONTROL_SYNONYMS)[name])
    assert match_score(SearchQuery.from_text(word), SearchTexts("", "", found)) > 0.0


def test_command_search_runs_the_marked_command_by_enter(qtbot, bottle, search):
    qtbot.keyClicks(search.search, "wireframe")
    assert not bottle.canvas.surface.shows_edges
    qtbot.keyClick(search.search, Qt.Key.Key_Return)
    assert bottle.canvas.surface.shows_edges
    assert not search.isVisible()
    assert bottle.shell.focusWidget() is bottle.canvas.viewport


def test_command_search_marks_another_by_the_arrows_and_shows_keys_and_place(qtbot, bottle, search):
    titles = found(search, "brush")
    qtbot.keyClick(search.search, Qt.Key.Key_Down)
    assert search.list.currentItem().text(0) == titles[1]
    rows = {
        item.text(0): (item.text(1), item.text(2))
        for item in (search.list.topLevelItem(k) for k in range(len(titles)))
    }
    assert rows["Brush"] == ("Select", "D")
    assert rows["Brush radius"] == ("Settings > Painting", "")
    qtbot.keyClick(search.search, Qt.Key.Key_Escape)
    assert not search.isVisible()


def test_command_search_says_why_a_command_is_disabled_and_does_not_run_it(qtbot, bottle, search):
    qtbot.keyClicks(search.search, "undo")
    items = [search.list.topLevelItem(k) for k in range(search.list.topLevelItemCount())]
    item = next(item for item in items if item.text(0) == "Undo")
    assert item.isDisabled()
    assert item.text(1) == "there is no step to undo"
    search.list.setCurrentItem(item)
    qtbot.keyClick(search.search, Qt.Key.Key_Return)
    assert search.isVisible()


def test_command_search_says_of_most_commands_that_a_mesh_is_missing(window):
    window.help.toggle_search()
    search = window.help.search

    def why(title):
        found(search, title)
        (item,) = search.list.findItems(title, Qt.MatchFlag.MatchExactly)
        return item.text(1) if item.isDisabled() else ""

    assert why("Export") == why("Undo") == "open a mesh first"
    assert why("Open") == why("Settings") == ""
    assert why("Stiffness") == "not available now"


def test_command_search_shows_a_control_and_gives_it_the_keys(qtbot, bottle, search):
    bottle.panel.measures.is_folded = True
    bottle.docks["readings"].hide()
    qtbot.keyClicks(search.search, "density")
    qtbot.keyClick(search.search, Qt.Key.Key_Return)
    qtbot.waitUntil(lambda: bottle.shell.focusWidget() is bottle.panel.measures.wall_fields.density)
    assert not bottle.panel.measures.is_folded
    qtbot.waitUntil(lambda: not bottle.panel.measures.wall_fields.density.visibleRegion().isEmpty())


def test_command_search_opens_a_setting(qtbot, bottle, search):
    qtbot.keyClicks(search.search, "undo memory")
    row = search.list.visualItemRect(search.list.topLevelItem(0))
    qtbot.mouseClick(search.list.viewport(), LEFT, pos=row.center())
    dialog = bottle.settings_page.dialog
    assert dialog.focusWidget().objectName() == "undo_memory"


def test_command_search_explains_the_marked_entry_by_f1_and_its_last_one_searches_the_manual(
    qtbot, search, monkeypatch
):
    opened = []
    monkeypatch.setattr(manual, "open_manual", opened.append)
    monkeypatch.setattr(manual, "search_manual", opened.append)
    qtbot.keyClicks(search.search, "wireframe")
    qtbot.keyClick(search.search, Qt.Key.Key_F1)
    assert opened == [manual.action_place("edges")]
    assert found(search, "xqzw")
    qtbot.keyClick(search.search, Qt.Key.Key_Return)
    assert opened[1:] == ["xqzw"]


def test_match_score_matches_words_by_their_beginning_ending_and_with_a_slip():
    def rank(wish, title):
        return match_score(SearchQuery.from_text(wish), SearchTexts(title, ""))

    assert rank("export", "Export") > rank("exp", "Export") > rank("exprot", "Export") > 0
    assert rank("rotating", "Rotate") > 0
    assert rank("été", "Ete") == rank("ete", "Ete")
    assert rank("export", "Import") < rank("export", "Export")
    assert rank("nothing of this", "Export") == 0
    assert rank("ziel", "Flächenziel") > 0
    assert rank("把壁变薄", "变薄") > 0
    assert rank("button", "To") == 0
