"""The site has a place for every command, option, key, setting and Python name, and no link is broken."""

import importlib.util
import re
import subprocess
import sys
from pathlib import Path
from urllib.parse import unquote

import commands_page
import control_words
import generated_pages
import keys_page
import pytest
import python_page
import settings_page
import verification_page
import window_facts
import window_page
from plain_markdown import escaped
from pseudo import messages

import apd_viewer
from apd_viewer.__main__ import COMMANDS
from apd_viewer.files.mesh_formats import CAD_FORMATS, MESH_FORMATS
from apd_viewer.ui.help.manual import action_place, setting_place, slug
from apd_viewer.ui.settings_page.preference_table import PREFERENCES
from apd_viewer.verification.case_table import CASES

ROOT = Path(__file__).parents[1]
DOCS = ROOT / "docs"


def options():
    """Command and name of every option."""
    return [
        (parser.prog, name)
        for parser in commands_page.parsers()
        for action in commands_page.options(parser)
        for name in commands_page.names(action)
    ]


@pytest.fixture(scope="module")
def keys():
    """Menu entries of the window; a process of its own finds them."""
    return window_facts.entries()


def test_site_has_every_command_and_every_option_on_its_page():
    page = commands_page.commands_page()
    assert set(re.findall(r"(?m)^## apd-viewer (\w+)", page)) == set(COMMANDS)
    sections = dict(re.findall(r"(?ms)^```\{program\} ([\w -]+)$(.*?)(?=^```\{program\}|\Z)", page))
    assert len(options()) > 100
    given = {command: re.findall(r"(?m)^````\{option\} (.*)$", text) for command, text in sections.items()}
    listed = {(c, one.split()[0]) for c, lines in given.items() for line in lines for one in line.split(", ")}
    assert listed == set(options())


def test_site_says_of_an_option_what_its_help_says():
    page = commands_page.commands_page()
    assert escaped("4x4 matrix that moves the handle; repeat for each handle") in page
    assert "%(default)s" not in page


def test_site_has_every_python_name_on_its_page():
    assert set(re.findall(r":: apd_viewer\.(\w+)", python_page.python_page())) == set(apd_viewer.__all__)


def test_site_has_an_anchor_of_every_setting_and_nothing_of_this_machine():
    page = settings_page.settings_page()
    anchors = re.findall(r"\{#([\w-]+)\}", page)
    assert anchors == [setting_place(row.name).anchor for row in PREFERENCES]
    assert "All cores (" not in page


def test_site_has_the_errors_and_the_source_of_every_case():
    page = verification_page.verification_page()
    assert page.count("\n| **") == sum(len(case.quantities) for case in CASES.values())
    assert [case.letter for case in CASES.values() if escaped(case.source) not in page] == []


def test_site_has_every_format_on_its_page():
    assert re.findall(r"`(\.\w+)`", generated_pages.WRITERS["formats"]()) == [*MESH_FORMATS, *CAD_FORMATS]


@pytest.mark.night
def test_site_has_an_anchor_of_its_own_for_every_menu_entry(keys):
    assert {"File", "Edit", "Tools", "Select", "Handle", "Simulate", "View", "Help"} == {
        entry.menu for entry in keys
    }
    anchors = [action_place(entry.name).anchor for entry in keys]
    assert len(anchors) > 140
    assert len(set(anchors)) == len(anchors)


@pytest.mark.night
def test_site_names_the_keys_of_the_window_in_its_pages(keys):
    """A menu entry in bold type with keys behind it: ``**Menu > Entry** (`Ctrl+X`)``."""
    pattern = r"\*\*(?:\w+ > )+([^*>]+)\*\*\s+\(`([^`]+)`\)"
    named = [found for page in DOCS.rglob("*.md") for found in re.findall(pattern, page.read_text("utf-8"))]
    real = {entry.title.split(": ")[-1]: entry.keys.split("; ") for entry in keys}
    assert len(named) > 3
    assert [(title, key) for title, key in named if key not in real[title]] == []


def test_site_names_in_its_tutorial_what_the_window_shows():
    """What stands in italics is a text of the window, but for capitals."""
    said = re.findall(
        r"(?<!\*)\*([^*\s](?:[^*\n]*[^*\s])?)\*(?!\*)", (DOCS / "tutorial.md").read_text("utf-8")
    )
    texts = {
        part.lower()
        for message, _ in messages()
        for part in ([message] if isinstance(message, str) else message)
    }
    assert len(said) > 5
    assert [words for words in said if words.lower() not in texts] == []


@pytest.mark.night
def test_site_lists_every_control_once_with_a_sentence():
    found = window_facts.controls()
    assert len(found) > 150
    groups = [group.name for group in control_words.GROUPS]
    assert len(set(groups)) == len(groups)
    assert {control.section for control in found} <= set(groups)
    rows = {}
    for name in groups:
        own = window_page.rows_of([each for each in found if each.section == name])
        rows |= {f"{name}/{title}": sentence for title, sentence in own.items()}
    assert [title for title, sentence in rows.items() if len(sentence) < 7] == []
    assert {key for key in control_words.SENTENCES if "/" in key} <= set(rows)


@pytest.mark.night
def test_site_says_something_at_each_menu_entry_and_setting():
    pages = [generated_pages.WRITERS[page]() for page in ("keys", "settings")]
    said = [row for page in pages for row in page.splitlines() if "{#" in row]
    assert len(said) > 150
    assert [row for row in said if len(row.strip("| ").rsplit(" | ", 1)[-1]) < 8] == []


@pytest.mark.night
def test_site_leads_from_menu_entries_to_the_pages_about_them(keys):
    entry = next(entry for entry in keys if entry.name == "bake")
    assert "[Undo, and begin from a new rest shape](../howto/undo.md)" in keys_page.keys_page()
    assert keys_page.page_about(entry).name == "undo.md"


@pytest.mark.night
@pytest.mark.parametrize(
    ("name", "page"),
    [("open", "open.md"), ("settings", "settings.md"), ("way:SLAB", "choose.md"), ("cut", "look.md")],
)
def test_site_leads_from_menu_entries_to_the_page_that_begins_with_them(keys, name, page):
    entry = next(entry for entry in keys if entry.name == name)
    assert keys_page.page_about(entry).name == page


def test_slug_counts_signs_in_anchors():
    assert slug("up:-X") != slug("up:+X")
    assert slug("nudge:(-1,0,0)") == "nudge-minus-1-0-0"


def test_site_keeps_the_signs_of_a_text():
    assert escaped("a_b *c*\n<d>") == r"a\_b \*c\* \<d\>"


def test_site_shows_a_file_on_a_page_and_links_lead_from_there(tmp_path):
    (tmp_path / "docs" / "sub").mkdir(parents=True)
    (tmp_path / "NEWS.md").write_text("# News\n\n[Here](docs/page.md#a), [there](https://a.example/b)\n")
    (tmp_path / "docs" / "page.md").write_text("[News](../NEWS.md)\n")
    shows = tmp_path / "docs" / "sub" / "news.md"
    shows.write_text("# News\n\nSee [the file](../../NEWS.md).\n\n<!-- file: ../../NEWS.md -->\n")
    shown = generated_pages.shown_files(tmp_path / "docs")
    assert shown == {tmp_path / "NEWS.md": shows}
    text = generated_pages.completed(shows, shows.read_text(), shown)
    assert text == "# News\n\n[Here](../page.md#a), [there](https://a.example/b)\n"
    page = tmp_path / "docs" / "page.md"
    assert generated_pages.completed(page, page.read_text(), shown) == "[News](sub/news.md)\n"


needs_sphinx = pytest.mark.skipif(
    importlib.util.find_spec("sphinx") is None, reason="the group docs is not installed"
)


@pytest.mark.night
@needs_sphinx
def test_site_has_a_page_follow_what_it_is_made_of(tmp_path):
    """Built again beside its doctrees, as by ``make docs``, it shows the file as it has become."""
    docs, news = tmp_path / "docs", tmp_path / "NEWS.md"
    docs.mkdir()
    (docs / "conf.py").write_text(
        f"import sys\nsys.path.insert(0, {str(DOCS / '_extensions')!r})\n"
        "extensions = ['myst_parser', 'generated_pages']\n"
    )
    (docs / "index.md").write_text("# News\n\n<!-- file: ../NEWS.md -->\n")
    for said in ("It is early.", "It is late."):
        news.write_text(f"# News\n\n{said}\n")
        command = [sys.executable, "-m", "sphinx", "-q", str(docs), str(tmp_path / "site")]
        subprocess.run(command, cwd=ROOT, check=True)
        assert said in (tmp_path / "site" / "index.html").read_text(encoding="utf-8")


@pytest.mark.night
@needs_sphinx
def test_site_is_built_without_a_warning(tmp_path):
    command = [sys.executable, "-m", "sphinx", "-W", "-n", "-q", "-d", str(tmp_path / "trees")]
    done = subprocess.run(
        [*command, str(DOCS), str(tmp_path / "site")], cwd=ROOT, capture_output=True, text=True, check=False
    )
    assert done.stderr == ""
    assert done.returncode == 0
    page = (tmp_path / "site" / "reference" / "commands.html").read_text(encoding="utf-8")
    ids = set(re.findall(r'id="([^"]+)"', page))
    assert [one for one in options() if commands_page.anchor(*one) not in ids] == []
    check_without_network(tmp_path / "site")
    named = {"window": window_page.window_page(), "keys": keys_page.keys_page()}
    for name, text in named.items():
        page = (tmp_path / "site" / "reference" / f"{name}.html").read_text(encoding="utf-8")
        anchors = {one or other for one, other in re.findall(r"\{#([\w-]+)\}|^\(([\w-]+)\)=$", text, re.M)}
        assert len(anchors) > 30
        assert anchors <= set(re.findall(r'id="([^"]+)"', page))


def check_without_network(site):
    """Pages of at most 25 MB fetch nothing from elsewhere, and what they link to is there."""
    pages = {path: path.read_text(encoding="utf-8") for path in site.rglob("*.html")}
    pages = {path: text for path, text in pages.items() if "{{" not in text}  # of the theme itself
    assert len(pages) > 30
    assert sum(path.stat().st_size for path in site.rglob("*") if path.is_file()) < 25e6
    fetched = r'(?:<script[^>]*src|<link[^>]*rel="stylesheet"[^>]*href|<img[^>]*src)="(?:https?:)?//'
    assert [path.name for path, text in pages.items() if re.search(fetched, text)] == []
    linked = [
        (path, link.partition("#")[0].partition("?")[0])
        for path, text in pages.items()
        for link in re.findall(r'(?:href|src)="([^"]+)"', text)
    ]
    local = [(path, unquote(link)) for path, link in linked if link and not re.match(r"\w+:|//", link)]
    assert len(local) > 1000
    assert [(path.name, link) for path, link in local if not (path.parent / link).exists()] == []
