"""The words of the program: all are marked, all can be translated, and the language is the user's."""

import ast
import os
import subprocess
import sys
from pathlib import Path

import pytest
from babel.messages.pofile import read_po
from pseudo import LANGUAGE, MARKED, ROOT, fields, messages, write_catalogue

from apd_viewer import language
from apd_viewer.__main__ import VARIABLES
from apd_viewer.files.mesh_formats import READABLE_NAMES
from apd_viewer.language import catalogue, preferred_languages

FUNCTIONS = {"tr": 1, "trn": 3, "trc": 2}


def calls():
    """Every call of a function that translates: file and line, its name, its arguments."""
    for path in sorted((ROOT / "apd_viewer").rglob("*.py")):
        for node in ast.walk(ast.parse(path.read_text(encoding="utf-8"))):
            if isinstance(node, ast.Call) and isinstance(node.func, ast.Name) and node.func.id in FUNCTIONS:
                yield f"{path.name}:{node.lineno}", node.func.id, node.args


def is_text(node):
    return isinstance(node, ast.Constant) and isinstance(node.value, str) and bool(node.value.strip())


def test_language_translates_only_what_can_be_found_in_the_sources():
    """An f-string or a name in tr() would be looked up, but in no catalogue."""
    found = list(calls())
    assert len(found) > 800, "the test is blind"
    wrong = [
        where
        for where, name, given in found
        if len(given) != FUNCTIONS[name] or not all(map(is_text, given[: min(FUNCTIONS[name], 2)]))
    ]
    assert wrong == []
    assert len(found) == len(messages()), "the extraction misses some"


def test_language_has_a_name_for_every_value_in_a_sentence():
    """A translation may need another order."""
    texts = [
        text for message, _ in messages() for text in ((message,) if isinstance(message, str) else message)
    ]
    wrong = [text for text in texts for field in fields(text) if field[1:2] in "}:!" or field[1].isdigit()]
    assert wrong == []
    assert any(map(fields, texts)), "the test is blind"


def test_language_takes_the_same_values_in_one_and_many():
    pairs = [message for message, _ in messages() if isinstance(message, tuple)]
    assert len(pairs) > 10
    for one, many in pairs:
        assert set(fields(one)) <= set(fields(many)), one


def strangers(content):
    """Translations in a .po file with fields that their English has not: there would be no value for them."""
    return [
        text
        for message in read_po(content.splitlines(keepends=True))
        if message.id
        for text in ([message.string] if isinstance(message.string, str) else message.string)
        if set(fields(text)) - set(fields(message.id if isinstance(message.id, str) else message.id[-1]))
    ]


def test_language_has_no_translation_with_a_value_of_its_own():
    assert strangers(b'msgid "{n} faces"\nmsgstr "{m} Dreiecke"\n') == ["{m} Dreiecke"]
    assert strangers(b'msgid "{n} faces in {name}"\nmsgstr "in {name} sind {n} Dreiecke"\n') == []
    for path in (ROOT / "apd_viewer" / "languages").glob("*/LC_MESSAGES/*.po"):
        assert strangers(path.read_bytes()) == [], path


@pytest.mark.parametrize(
    ("environment", "names"),
    [
        ({"LANG": "de_DE.UTF-8"}, ["de_DE"]),
        ({"LANG": "de_DE.UTF-8", "LC_MESSAGES": "fr_FR"}, ["fr_FR"]),
        ({"LC_MESSAGES": "fr_FR", "LC_ALL": "es_ES@euro"}, ["es_ES@euro"]),
        ({"LC_ALL": "es_ES", "LANGUAGE": "pt_BR:ja"}, ["pt_BR", "ja"]),
        ({"LANGUAGE": "pt_BR", "APD_VIEWER_LANGUAGE": "ja"}, ["ja"]),
        ({"APD_VIEWER_LANGUAGE": "", "LANGUAGE": "", "LANG": "ja_JP.eucJP"}, ["ja_JP"]),
        ({"LANGUAGE": "de:en_GB:fr"}, ["de"]),  # whoever reads English would not have French instead
        ({"LANG": "C.UTF-8"}, []),
        ({"LC_ALL": "POSIX", "LANG": "de_DE"}, []),
        ({"LANG": "en_US.UTF-8"}, []),
        ({"APD_VIEWER_LANGUAGE": "zh-Hans-CN"}, ["zh_Hans_CN", "zh_CN"]),
        ({"LANG": "zh_CN.UTF-8"}, ["zh_CN"]),
        ({"LANG": "zh_SG.UTF-8"}, ["zh_SG", "zh_CN"]),
        ({"APD_VIEWER_LANGUAGE": "zh-Hans"}, ["zh_Hans", "zh_CN"]),
        ({"APD_VIEWER_LANGUAGE": "zh-Hans-HK"}, ["zh_Hans_HK", "zh_HK", "zh_CN"]),
        ({"LANG": "zh_TW.UTF-8"}, ["zh_TW"]),
    ],
)
def test_preferred_languages_language_is_that_of_the_environment(environment, names):
    assert preferred_languages(environment) == names


def test_chosen_language_goes_before_that_of_the_system(tmp_path, monkeypatch):
    assert preferred_languages({"LANG": "de_DE.UTF-8"}, "fr") == ["fr"]
    assert preferred_languages({"LANG": "de_DE.UTF-8"}, "en") == []
    assert preferred_languages({"APD_VIEWER_LANGUAGE": "ja"}, "fr") == ["ja"]
    monkeypatch.setattr(language, "language_file", lambda: tmp_path / "config" / "language")
    assert language.chosen_language() == ""
    for name in ("fr", "", ""):
        language.choose_language(name)
        assert language.chosen_language() == name
    (tmp_path / "config" / "language").write_bytes(b"\xff")
    assert language.chosen_language() == ""


def test_languages_are_english_and_that_of_every_catalogue(tmp_path, monkeypatch):
    monkeypatch.setattr(language, "CATALOGUE_FOLDER", tmp_path)
    assert language.languages() == ["en"]
    write_catalogue(tmp_path)
    assert language.languages() == ["en", LANGUAGE]


@pytest.mark.parametrize(
    ("names", "found"),
    [
        ([LANGUAGE], LANGUAGE),
        (["de_AT"], LANGUAGE),
        (["xx", "de_DE.UTF-8"], LANGUAGE),
        (["xx"], "en"),
        ([], "en"),
    ],
)
def test_catalogue_is_that_of_the_first_language_that_there_is(tmp_path, monkeypatch, names, found):
    monkeypatch.setenv("LANGUAGE", LANGUAGE)  # gettext looks there too, unless it is hindered
    write_catalogue(tmp_path)
    name, words = catalogue(tmp_path, names)
    assert name == found
    assert bool(MARKED.search(words.gettext("There is no file {path}; check the name."))) == (found != "en")


def test_catalogue_that_is_damaged_is_no_reason_to_stop(tmp_path, capsys):
    write_catalogue(tmp_path)
    path = tmp_path / LANGUAGE / "LC_MESSAGES" / "apd_viewer.mo"
    for content in (b"", b"no catalogue", path.read_bytes()[:300]):
        path.write_bytes(content)
        name, words = catalogue(tmp_path, [LANGUAGE])
        assert (name, words.gettext("Measurements")) == ("en", "Measurements")
        assert "compile it again" in capsys.readouterr().err


def test_language_says_in_english_what_is_still_to_be_translated(tmp_path, monkeypatch):
    write_catalogue(tmp_path, spoken=lambda _: "")
    monkeypatch.setattr(language, "CATALOGUE", language.catalogue(tmp_path, [LANGUAGE])[1])
    assert language.tr("No issues") == "No issues"
    assert language.trc("view", "Back") == "Back"
    assert [language.trn("{n} day ago", "{n} days ago", n) for n in (1, 2)] == ["{n} day ago", "{n} days ago"]


@pytest.fixture(scope="module")
def spoken(tmp_path_factory):
    """A folder with the language that nobody speaks."""
    folder = tmp_path_factory.mktemp("languages")
    write_catalogue(folder)
    return folder


def run(folder, *words):
    """What a command says in the language of a folder."""
    environment = os.environ | {"APD_VIEWER_LANGUAGE": LANGUAGE, "APD_VIEWER_LANGUAGES": str(folder)}
    return subprocess.run(
        [sys.executable, "-m", "apd_viewer", *words],
        cwd=ROOT,
        env=environment | {"PYTHONIOENCODING": "utf-8", "COLUMNS": "400"},
        capture_output=True,
        encoding="utf-8",
        check=False,
        timeout=60,
    )


def unmarked(text):
    """What is left of a text without what was translated."""
    while MARKED.search(text):
        text = MARKED.sub("", text)
    return text


def test_main_speaks_the_language_in_its_help(spoken):
    done = run(spoken, "--help")
    assert done.returncode == 0
    words = {word.strip("-,") for word in unmarked(done.stdout).split()}
    names = {*READABLE_NAMES, *VARIABLES}
    assert words <= {"FILE", "h", "help", "version", "clicked", "log-level", "LEVEL", "", ":"} | names


def test_deform_speaks_the_language_in_its_help(spoken):
    """Of which the names of options, and what stands for their values, are no words."""
    done = run(spoken, "deform", "--help")
    assert done.returncode == 0
    usage, _, rest = unmarked(done.stdout).partition("\n\n")
    assert usage.split()[0] == "apd-viewer"
    left = {
        word for word in rest.replace("[", " ").replace("]", " ").split() if word.isalpha() and word.islower()
    }
    assert left <= {"exact", "go"}


def test_main_says_in_the_language_what_is_wrong(spoken):
    done = run(spoken, "info", "gone.obj")
    assert done.returncode == 2
    assert unmarked(done.stderr).split() == ["gone.obj"]
    assert len(MARKED.findall(done.stderr)) == 3


@pytest.mark.parametrize(
    ("words", "left"),
    [
        pytest.param(["deform"], {"MESH", "-o/--output", "--output/-o", "-o"}, marks=pytest.mark.night),
        pytest.param(["info"], {"MESH"}, marks=pytest.mark.night),
        pytest.param(["info", "a.obj", "--reference"], {"--reference"}, marks=pytest.mark.night),
        pytest.param(["info", "a.obj", "--no"], {"--no"}, marks=pytest.mark.night),
        (["thumbnail"], {"FILE", "OUT.png"}),
        (["desktop", "--log-level", "loud"], {"--log-level", "loud", "debug", "info", "warning", "error"}),
        (["thumbnail", "a.obj", "b.png", "--size", "many"], {"--size", "many", "int", "_size"}),
    ],
)
def test_parser_says_in_the_language_what_is_wrong_with_the_options(spoken, words, left):
    """By argparse, in whose sentences there are the names of options and values."""
    done = run(spoken, *words)
    assert done.returncode == 2
    said = {word.strip("',():;") for word in unmarked(done.stderr).split()}
    assert said <= left | {"", "apd-viewer", "--help", words[0]}
    assert len(MARKED.findall(done.stderr)) >= 3


def test_info_says_in_the_language_what_a_mesh_is_like(spoken):
    done = run(spoken, "info", str(Path("resources") / "bottle.obj"))
    assert done.returncode == 0, done.stderr
    assert not [word for word in unmarked(done.stdout).split() if word.isalpha() and word != "x"]
