"""The catalogues: each has every text of the program, with its fields and signs, and is compiled."""

import gettext
import importlib.util
import io
import re
from functools import cache

import pytest
from babel.messages.catalog import Catalog
from babel.messages.mofile import read_mo, write_mo
from babel.messages.pofile import read_po
from plain_markdown import escaped
from pseudo import KEPT, ROOT, messages
from translations_page import translations_page

FILES = sorted((ROOT / "apd_viewer" / "languages").glob("*/LC_MESSAGES/apd_viewer.po"))
EACH = pytest.mark.parametrize("path", FILES, ids=lambda path: path.parents[1].name)
WITHOUT_SPACES = {"zh"}
MNEMONIC = re.compile(r"&[^\s&]")
# Ends of sentences and the like, in the signs of other scripts too.
ENDS = {"。": ".", "：": ":", "？": "?", "！": "!", "，": ",", "、": ",", "；": ";"}


@cache
def read(path):
    with path.open("rb") as stream:
        return read_po(stream, locale=path.parents[1].name)


def forms(text):
    return (text,) if isinstance(text, str) else tuple(text)


def pairs(catalogue):
    """English and translated text of every message; the last form of a plural has many's fields."""
    for message in catalogue:
        if message.id:
            english, translated = forms(message.id), forms(message.string)
            if len(english) == 2 == len(translated):
                yield from zip(english, translated, strict=True)
            else:
                yield from ((english[-1], form) for form in translated)


def end(text):
    """Sign at the end of a text that says what kind of a text it is; empty if none."""
    last = text.rstrip()[-1:]
    last = ENDS.get(last, last)
    return last if last in ".…:?!,;" else ""


def faults(catalogue):
    """What is wrong with translations, apart from being missing."""
    for english, text in pairs(catalogue):
        if values(english) != values(text):
            yield "fields", text
        if end(english) != end(text):
            yield "end", text
        if len(MNEMONIC.findall(english)) != len(MNEMONIC.findall(text)):
            yield "mnemonic", text
        if catalogue.locale.language not in WITHOUT_SPACES and spaces(english) != spaces(text):
            yield "spaces", text


def values(text):
    """The fields and tags of a text; one with a name may stand twice: ``沿 {axis} (&{axis})``."""
    found = KEPT.findall(text)
    return sorted(one for one in found if one[0] != "{") + sorted({one for one in found if one[0] == "{"})


def spaces(text):
    """What is around a text, which is put together with others."""
    return text[: len(text) - len(text.lstrip())], text[len(text.rstrip()) :]


def test_translations_are_there():
    assert "de" in {path.parents[1].name for path in FILES}


@EACH
def test_translations_have_every_text_in_the_catalogue_and_none_that_is_gone(path):
    """``make texts`` adds what is new, and removes what is gone."""
    wanted = {(context, message) for message, context in messages()}
    there = {(message.context, message.id) for message in read(path) if message.id}
    assert wanted - there == set()
    assert there - wanted == set()
    assert not read(path).obsolete


@EACH
def test_translations_have_every_text_translated(path):
    catalogue = read(path)
    wrong = [
        message.id
        for message in catalogue
        if message.id
        and (
            not all(forms(message.string))
            or isinstance(message.id, tuple) != isinstance(message.string, tuple)
            or (isinstance(message.id, tuple) and len(message.string) != catalogue.num_plurals)
        )
    ]
    assert wrong == []


@EACH
def test_translations_keep_fields_signs_and_spaces(path):
    assert list(faults(read(path))) == []


@EACH
def test_translations_come_with_a_question_where_a_reader_must_check_them(path):
    assert [message.id for message in read(path) if message.fuzzy and not message.user_comments] == []


@EACH
def test_translations_have_their_catalogue_compiled(path):
    """``make texts`` compiles it; fuzzy texts are shown too. Its head may name another release of Babel."""
    wanted = io.BytesIO()
    write_mo(wanted, read(path), use_fuzzy=True)
    wanted.seek(0)
    with path.with_suffix(".mo").open("rb") as compiled:
        assert title_and_tip(read_mo(compiled)) == title_and_tip(read_mo(wanted))


def title_and_tip(catalogue):
    """Translation of each text of a catalogue, by context and text."""
    return {
        (message.context, forms(message.id)): forms(message.string) for message in catalogue if message.id
    }


@pytest.mark.parametrize(
    ("english", "text", "kinds"),
    [
        ("{n:,} faces", "{n:,} Dreiecke", []),
        ("{n:,} faces", "{n} Dreiecke", ["fields"]),
        ("{n:,} faces", "{m:,} Dreiecke", ["fields"]),
        ("missing: %s", "es fehlt: %r", ["fields"]),
        ("<b>{name}</b>", "{name}", ["fields"]),
        ("&Open…", "Ö&ffnen…", []),
        ("&Open…", "Öffnen…", ["mnemonic"]),
        ("&Open…", "Ö&ffnen", ["end"]),
        ("Done.", "Fertig", ["end"]),
        (" px", "px", ["spaces"]),
        (("{n} face", "{n} faces"), ("{n} Dreieck", "{n} Dreiecke"), []),
        (("a face", "{n} faces"), ("ein Dreieck", "Dreiecke"), ["fields"]),
    ],
)
def test_translations_with_faults_are_noticed(english, text, kinds):
    catalogue = Catalog(locale="de")
    catalogue.add(english, text)
    assert [kind for kind, _ in faults(catalogue)] == kinds


@pytest.fixture
def texts(tmp_path, monkeypatch):
    """The script behind ``make texts``, for a folder of the test."""
    spec = importlib.util.spec_from_file_location("texts", ROOT / ".ci" / "texts.py")
    script = importlib.util.module_from_spec(spec)
    spec.loader.exec_module(script)
    monkeypatch.setattr(script, "LANGUAGES", tmp_path)
    monkeypatch.setattr(script, "template", cache(script.template))  # the sources stay as they are
    return script


def test_translations_have_a_catalogue_begun_and_followed(texts, tmp_path, capsys):
    """What is new is added without a guess, what is gone is removed, what is translated stays."""
    texts.main(["de"])
    path = tmp_path / "de" / "LC_MESSAGES" / "apd_viewer.po"
    begun = path.read_text(encoding="utf-8")
    assert begun.count('\nmsgstr ""\n') > 2000
    gone = '\n#: gone.py\nmsgid "No issues of any kind"\nmsgstr "Gar keine Befunde"\n'
    there = 'msgid "No issues"\nmsgstr ""'
    assert there in begun
    path.write_text(begun.replace(there, there[:-2] + '"Keine Befunde"') + gone, encoding="utf-8")
    texts.main([])
    followed = path.read_text(encoding="utf-8")
    assert followed == begun.replace(there, there[:-2] + '"Keine Befunde"')
    with path.with_suffix(".mo").open("rb") as stream:
        assert gettext.GNUTranslations(stream).gettext("No issues") == "Keine Befunde"
    assert capsys.readouterr().out.count("to translate") == 2


def test_translations_to_be_checked_are_listed_on_the_site():
    page = translations_page()
    for path in FILES:
        catalogue = read(path)
        assert f"{sum(message.fuzzy for message in catalogue)} to check" in page
        assert all(escaped(message.user_comments[0]) in page for message in catalogue if message.fuzzy)
    assert "German (Deutsch)" in page


def test_translations_into_chinese_have_signs_of_their_own_and_no_spaces():
    catalogue = Catalog(locale="zh_CN")
    catalogue.add("usage: ", "用法：")
    catalogue.add("along &{axis}…", "沿 {axis} (&{axis})…")
    assert list(faults(catalogue)) == []
    catalogue.add("Done.", "完成：")
    assert [kind for kind, _ in faults(catalogue)] == ["end"]


def test_translations_into_german_tell_the_volume_of_a_box_from_that_of_a_hull():
    titles = {english: text for path in FILES if "de" in path.parts for english, text in pairs(read(path))}
    volumes = {english: text for english, text in titles.items() if english.endswith("volume")}
    assert {"Bounding box volume", "Smallest box volume", "Convex hull volume"} <= set(volumes)
    # The panel has no room for the word in the title of the smallest box.
    assert {text for text in volumes.values() if "volumen" not in text.lower()} <= {"Kleinster Quader"}
    for english, text in volumes.items():
        assert ("box" in english) == ("quader" in text.lower())
        assert ("hull" in english) == ("Hülle" in text)
