"""Every text of the window is in the language of its user: one that nobody speaks, made from the sources."""

import json
import os
import re
import subprocess
import sys

import pytest
from pseudo import LANGUAGE, MARKED, ROOT, write_catalogue

# What is no word of a language, or none of ours.
EXCEPTIONS = {
    r"<[^<>]+>": "a tag",
    r"⟦[^⟦⟧]*…$": "a sentence for which there was no room",
    r"[\w/*. -]*\.(obj|xyz|apd|json|sel|npz|ply|dmat|stl|off|glb|gltf|3mf|vt[pku]|inp)\b": "a file or ending",
    r"\b\w+\.(html|png)\b|\*\.(html|png)": "what others are given to look at",
    r"^(GLB|JSON|NPZ|SEL|DMAT|HTML|PNG) $|\b(OBJ|PLY|STL|OFF|GLB|glTF|3MF|VT[PUK])\b": "the name of a format",
    r"\b(STEP|IGES)\b": "the name of a format of CAD",
    r"\b([cm]m[²³]?|ml|m?bar|GPa|[MG]iB|\d+deg|asin|pi)\b|“x”": "a unit, or what is typed for a number",
    r"^tcp://host:8786$": "an address, as it is typed",
    r"^[\w/.-]*-study$": "a folder",
    r"^(English|Deutsch)$": "the name of a language in itself",
    r"^(Blender|Rhino|Fusion|Maya|MeshLab)$": "the name of a program",
    r"\bqqq\b": "what was searched for",
    r"^APD Viewer$": "the name of the program",
    r"\b(Esc|Strg|Umschalt|Alt)\b(\+\w)?": "keys, as Qt calls them in this language",
    r"\bVerbindung verweigert\b": "why a socket failed, as Qt says it",
    r"^(Schließen|Lösen|Schließt das Dock-Widget|Löst das Dock-Widget .*)$": "Qt's own words",
    r"^Nach (links|rechts) scrollen$": "buttons of tabs, as Qt calls them",
}


# The acts of a walk through the window: by day those that compute little, which say most of it.
DAILY, ALL = ["start", "settings", "many_cases", "dialogs", "mistakes", "questions"], []


@pytest.fixture(
    scope="module", params=[DAILY, pytest.param(ALL, marks=pytest.mark.night)], ids=["daily", "all"]
)
def said(request, tmp_path_factory):
    """What a window says from its start on, in many scenes, when it is as small as it can be."""
    folder = tmp_path_factory.mktemp("language")
    write_catalogue(folder / "languages")
    (folder / "work").mkdir()
    spoken = {"APD_VIEWER_LANGUAGE": LANGUAGE, "APD_VIEWER_LANGUAGES": str(folder / "languages")}
    done = subprocess.run(
        [
            sys.executable,
            str(ROOT / "tests" / "support" / "reading.py"),
            str(folder / "work"),
            *request.param,
        ],
        cwd=ROOT,
        env=os.environ | spoken | {"PYTHONIOENCODING": "utf-8", "SIZE": "800x640"},
        capture_output=True,
        encoding="utf-8",
        check=False,
        timeout=300,
    )
    assert done.returncode == 0, done.stderr
    return json.loads(done.stdout)


def foreign(text, keys):
    """What is left of a text without what was translated and what need not be."""
    for key in sorted(keys, key=len, reverse=True):
        text = text.replace(key, "") if len(key) > 1 else text
    while MARKED.search(text):
        text = MARKED.sub("", text)
    for pattern in EXCEPTIONS:
        text = re.sub(pattern, "", text)
    return re.findall(r"[^\W\d_]{2,}", text)


def test_workbench_says_everything_in_the_language_of_its_user(said):
    wrong = {text: where for text, where in said["said"].items() if foreign(text, said["keys"])}
    assert wrong == {}


def test_workbench_writes_all_numbers_in_the_signs_of_its_language(said):
    """A point between digits is English; what was typed, and the names of files and versions, stay."""
    plain = re.compile(r"(?<![\w.])\d+\.\d+(?![\w.])")
    texts = {text: re.sub(r"[\w/.-]*\.(obj|apd|png|html|xyz)\b", "", text) for text in said["said"]}
    wrong = {text: said["said"][text] for text, rest in texts.items() if plain.search(MARKED.sub("", rest))}
    assert wrong == {}
    assert sum(bool(re.search(r"\d,\d", text)) for text in texts) > 50, "numbers were read"
    assert any("13’010" in text for text in texts)


def test_workbench_does_not_cut_off_words_that_are_much_longer(said):
    assert said["cut"] == {}


def test_workbench_was_listened_to_by_the_tests_of_its_language(said):
    """A scene that could not be reached would say nothing wrong."""
    texts = said["said"]
    assert len(texts) > 1000
    assert sum(bool(MARKED.search(text)) for text in texts) > 800
    kinds = {where.partition(": ")[2] for where in texts.values()}
    assert {"drawn", "a question", "a choice", "a row", "statusTip of a QAction"} <= kinds


def test_language_of_window_check_notices_a_word_that_was_forgotten():
    assert foreign("Measurements", []) == ["Measurements"]
    assert foreign("⟦Mmeeaasurements⟧ of the mesh", []) == ["of", "the", "mesh"]
    assert foreign("<b>⟦Ooppen⟧</b> (Ctrl+O)<br>⟦Ooppen a mmeesh⟧", ["Ctrl+O"]) == []


@pytest.mark.night
@pytest.mark.parametrize("said", [ALL], indirect=True, ids=["all"])
def test_language_of_window_exceptions_are_all_needed(said):
    for pattern in EXCEPTIONS:
        assert any(re.search(pattern, text) for text in said["said"]), pattern
