"""The window in each language that there is: no English word is left, nothing is cut off, and menus open."""

import json
import os
import re
import subprocess
import sys
from collections import Counter
from pathlib import Path

import pytest
from babel.messages.pofile import read_po
from pseudo import KEPT, ROOT

FILES = sorted((ROOT / "apd_viewer" / "languages").glob("*/LC_MESSAGES/apd_viewer.po"))
NATIVE = {"de": "Deutsch", "zh_CN": "简体中文"}
# Files have English names, and so have the folders of a test.
NAMES = re.compile(r"(/[\w.-]+)+|[\w-]+\.(obj|apd)\b")


LANGUAGES = [path.parents[1].name for path in FILES]


# By night: a text that is not marked, or has no room, is found by day in a language that nobody speaks.
@pytest.fixture(scope="module", params=[pytest.param(name, marks=pytest.mark.night) for name in LANGUAGES])
def shown(request, tmp_path_factory):
    """What the window shows in a language, on a system in that language, when it is as small as it can be."""
    folder = tmp_path_factory.mktemp("translated")
    plain = {name: value for name, value in os.environ.items() if name not in ("LC_ALL", "LC_MESSAGES")}
    language = {"APD_VIEWER_LANGUAGE": "", "LANGUAGE": "", "LANG": f"{request.param}.UTF-8"}
    done = subprocess.run(
        [sys.executable, str(Path(__file__).parents[1] / "support" / "reading_dialogs.py"), str(folder)],
        cwd=ROOT,
        env=plain | language | {"XDG_CONFIG_HOME": str(folder), "PYTHONUTF8": "1", "SIZE": "800x640"},
        capture_output=True,
        encoding="utf-8",
        check=False,
        timeout=300,
    )
    assert done.returncode == 0, done.stderr
    return json.loads(done.stdout) | {"language": request.param}


def words(text):
    """Words in Latin letters, but for fields and the names of files."""
    return {word.lower() for word in re.findall(r"[A-Za-zÀ-ÿ]{2,}", NAMES.sub(" ", KEPT.sub(" ", text)))}


def whole(text, where):
    """A text without the piece of a word that it ends in where it was drawn elided."""
    return text[:-1].rpartition(" ")[0] if where.endswith("drawn") and text.endswith("…") else text


def catalogue(language):
    """What is translated into a language."""
    path = ROOT / "apd_viewer" / "languages" / language / "LC_MESSAGES" / "apd_viewer.po"
    with path.open("rb") as stream:
        return [message for message in read_po(stream, locale=language) if message.id]


def only_english(language):
    """Words of the English texts that no translation has."""
    messages = catalogue(language)
    english, translated = (
        {word for text in texts for one in ([text] if isinstance(text, str) else text) for word in words(one)}
        for texts in ([m.id for m in messages], [m.string for m in messages])
    )
    return english - translated


def test_workbench_has_no_english_word_left_in_another_language(shown):
    foreign = only_english(shown["language"])
    assert len(foreign) > 500, "the test is blind"
    wrong = {text: where for text, where in shown["said"].items() if words(whole(text, where)) & foreign}
    assert wrong == {}
    assert len(shown["said"]) > 700, "the window was not read"


def test_workbench_cuts_nothing_off_in_any_language(shown):
    assert shown["cut"] == {}


def test_workbench_menus_open_by_keys_of_their_own_in_any_language(shown):
    twice = {
        menu: letters
        for menu, entries in shown["menus"].items()
        if (letters := [key for key, n in Counter(key for _, key in entries if key).items() if n > 1])
    }
    assert twice == {}
    assert all(key for _, key in shown["menus"]["menu bar"])


def test_languages_can_be_chosen_each_by_its_own_name(shown):
    assert {"English", *(NATIVE[name] for name in LANGUAGES)} <= set(shown["said"])


def test_workbench_shows_numbers_as_the_language_writes_them(shown):
    """In words, in readings and in fields; German has a decimal comma, and Chinese has not."""
    signs = {"de": (",", "."), "zh_CN": (".", ",")}
    point, group = signs[shown["language"]]
    texts = set(shown["said"])
    assert {f"100{point}00 %", f"100{point}000 %"} <= texts
    assert any(f"13{group}010" in text for text in texts)
    assert not any(f"13{point}010" in text for text in texts)
    if point == ",":
        # A point stands between groups of three digits, and nowhere else.
        wrong = re.compile(r"(?<![\w.])\d+\.(?!\d{3}(?!\d))\d+|(?<!\d)0\.\d|(?<![\w.,])\d{1,3},\d{3}\.")
        assert [text for text in texts if wrong.search(NAMES.sub("", text))] == []


def test_catalogue_has_the_quotation_marks_of_the_language():
    translated = [message.string for message in catalogue("de")]
    texts = [text for each in translated for text in ([each] if isinstance(each, str) else each)]
    assert [text for text in texts if "”" in text or re.search(r"“\w", text)] == []
    assert any("„" in text for text in texts)


def test_workbench_has_the_quotation_marks_of_the_language(shown):
    if shown["language"] == "de":
        assert [text for text in shown["said"] if "”" in text or re.search(r"“\w", text)] == []
        assert any("„" in text for text in shown["said"])
