"""The pages for readers: links lead somewhere, commands parse, code runs, menus and rooms exist."""

import ast
import contextlib
import inspect
import io
import json
import re
import shlex
from pathlib import Path

import numpy as np
import pytest
from pseudo import messages

import apd_viewer
import apd_viewer.__main__ as command_line

ROOT = Path(__file__).parents[1]
PAGES = sorted(
    [*ROOT.glob("*.md"), *(ROOT / "docs").rglob("*.md"), ROOT / "resources" / "README.md"], key=str
)
TEXTS = {path.relative_to(ROOT).as_posix(): path.read_text(encoding="utf-8") for path in PAGES}
MAKEFILE = (ROOT / "Makefile").read_text(encoding="utf-8")
MENUS = r"File|Edit|Tools|Select|Handle|Simulate|View|Help"


def found(pattern, flags=re.DOTALL):
    """Every match of a pattern in the pages: page and groups."""
    return [
        (page, match.groups()) for page, text in TEXTS.items() for match in re.finditer(pattern, text, flags)
    ]


def blocks(language):
    return [(page, code) for page, (code,) in found(rf"```{language}\n(.*?)```")]


def anchors(text):
    """Anchors of the headings of a page, as GitHub makes them."""
    headings = re.findall(r"^#+ (.*)$", re.sub(r"```.*?```", "", text, flags=re.DOTALL), re.MULTILINE)
    return {re.sub(r"[^\w\- ]", "", heading.lower()).replace(" ", "-") for heading in headings}


# Commands up to a pipe, also of several lines, and in loops.
COMMANDS = [
    (page, line.partition(" | ")[0].strip())
    for page, code in blocks("sh")
    for line in code.replace("\\\n", "").splitlines()
    if line.strip().startswith("apd-viewer")
]
SNIPPETS = blocks("python")


def test_documentation_has_a_short_readme():
    assert len(TEXTS["README.md"].split()) <= 700


def sentences(text):
    """Sentences of the running text of a page, code and formulas as one word each; no tables or headings."""
    for left_out in (r"(?ms)^(```+|:::+).*?^\1", r"(?s)<!--.*?-->", r"(?m)^[|#].*$", r"!\[[^\]]*\]\([^)]*\)"):
        text = re.sub(left_out, "\n", text)
    text = re.sub(r"(?s)\$\$.*?\$\$|\$[^$]+\$|`[^`]*`", "X", text)
    text = re.sub(r"\[([^\]]*)\]\([^)]*\)", r"\1", text).replace("**", "")
    for paragraph in re.split(r"\n\s*\n|\n(?=\s*(?:\*|\d+\.) )", text):
        yield from re.split(r"(?<=[.!?:;])\s+(?=[A-Z*\[(“\"])", " ".join(paragraph.split()))


def test_documentation_has_short_sentences():
    """What counts stands in the first words; a sentence of more than thirty has another one in it."""
    found = [
        (page, sentence)
        for page, text in TEXTS.items()
        if re.fullmatch(r"docs/(howto/)?[\w-]+\.md", page)
        for sentence in sentences(text)
    ]
    assert len(found) > 500
    assert [each for each in found if len(re.findall(r"[\w'’-]+", each[1])) > 30] == []


def test_documentation_has_relative_links_that_lead_somewhere():
    links = [(page, target) for page, (target,) in found(r"\]\(([^)\s]+)\)") if "://" not in target]
    assert len(links) > 40, "the test is blind"
    broken = []
    for page, target in links:
        path, _, anchor = target.partition("#")
        there = (ROOT / page).parent / path if path else ROOT / page
        if not there.exists() or (anchor and anchor not in anchors(there.read_text(encoding="utf-8"))):
            broken.append((page, target))
    assert broken == []


@pytest.mark.parametrize(("page", "line"), COMMANDS)
def test_documentation_names_commands_that_parse(page, line):
    command_line.parse_arguments(shlex.split(line, comments=True)[1:])


def test_documentation_on_scripting_has_lines_that_find_their_files():
    """In resources, written by a line above, or named as the reader's own."""
    page = TEXTS["docs/scripting.md"]
    (own,) = re.findall(r"two files of your own\.\n(.*?)\n\n", page, re.DOTALL)
    there = {path.name for path in (ROOT / "resources").iterdir()} | set(re.findall(r"`([\w.]+)`", own))
    lines = [shlex.split(line) for where, line in COMMANDS if where == "docs/scripting.md"]
    assert len(lines) > 12
    for words in lines:
        written = {words[k + 1] for k, word in enumerate(words) if word == "-o"}
        read = {word for word in words if re.search(r"\.(obj|sel|def|txt|apd)$", word)}
        assert read - written <= there, words
        there |= written


def test_documentation_names_commands_and_targets_of_make_that_exist():
    assert len(COMMANDS) > 8
    named = {name for _, (name,) in found(r"`apd-viewer ([a-z]+)")}
    assert named <= set(command_line.COMMANDS)
    targets = {name for _, (name,) in found(r"(?:^|`)make ([a-z]+)", re.MULTILINE)}
    assert targets >= {"run", "test"}
    assert [name for name in targets if not re.search(rf"(?m)^{name}:", MAKEFILE)] == []


def test_documentation_of_make_names_quick_tests_that_exist():
    paths = re.findall(r"tests/[\w./]+", MAKEFILE.partition("quick_tests = ")[2].partition("\n\n")[0])
    assert len(paths) > 5
    assert [path for path in paths if not (ROOT / path).exists()] == []


LONG = {"docs/scripting.md"}  # its code runs by night


@pytest.mark.parametrize(
    ("page", "code"),
    [
        pytest.param(page, code, id=page, marks=pytest.mark.night if page in LONG else ())
        for page, code in SNIPPETS
    ],
)
def test_documentation_has_python_snippets_that_run(page, code, compiled, tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    exec(compile(code.replace('"resources/', f'"{ROOT.as_posix()}/resources/'), page, "exec"), {})


@pytest.fixture(scope="module")
def cells():
    """Code of the cells of the notebook."""
    notebook = json.loads((ROOT / "docs" / "notebook.ipynb").read_text(encoding="utf-8"))
    assert (notebook["nbformat"], notebook["nbformat_minor"]) == (4, 5)
    cells = [cell for cell in notebook["cells"] if cell["cell_type"] == "code"]
    assert [cell["outputs"] for cell in cells] == [[]] * 5  # they would grow old
    return [
        "".join(cell["source"]).replace('"../resources/', f'"{ROOT.as_posix()}/resources/') for cell in cells
    ]


def test_documentation_uses_names_and_arguments_of_the_package_in_snippets_and_cells(cells):
    calls = [
        call
        for code in (*(code for _, code in SNIPPETS), *cells)
        for call in ast.walk(ast.parse(code))
        if isinstance(call, ast.Call) and ast.unparse(call.func).startswith("apd_viewer.")
    ]
    assert len(calls) > 10
    for call in calls:
        name = ast.unparse(call.func).partition(".")[2]
        assert name in apd_viewer.__all__
        parameters = inspect.signature(getattr(apd_viewer, name)).parameters
        assert {each.arg for each in call.keywords} <= set(parameters), name


@pytest.mark.night
def test_documentation_has_a_notebook_that_runs(cells, compiled, tmp_path, monkeypatch):
    """Cell after cell; the value of a name in a last line is shown, as a notebook does."""
    monkeypatch.chdir(tmp_path)
    names, printed, shown = {}, io.StringIO(), []
    for code in cells:
        body, _, last = code.rpartition("\n")
        is_name = re.fullmatch(r"\w+(\[\"\w+\"\])?", last) is not None
        with contextlib.redirect_stdout(printed):
            exec(body if is_name else code, names)
        if is_name:
            shown.append(eval(last, names)._repr_html_())
    assert [text.count("<img") for text in shown] == [1, 1]
    assert "total area 100.000000 %" in printed.getvalue()
    table = [line.split() for line in printed.getvalue().splitlines()[-4:]]
    changes = {method: float(change) for method, _, _, change, *_ in table}
    assert set(changes) == {"arap", "paper", "exact", "local"}
    assert min(changes, key=changes.get) == "local"
    written = apd_viewer.open_mesh("twisted.obj")
    np.testing.assert_allclose(written.V, names["results"]["local"].U, rtol=0, atol=1e-9)


def test_documentation_names_the_system_packages_of_the_makefile_in_the_readme():
    (listed,) = re.findall(r"(?m)^packages = ((?:.*\\\n)*.*)$", MAKEFILE)
    packages = listed.replace("\\", "").split()
    assert len(packages) > 5
    assert set(packages) <= set(re.findall(r"[\w.-]+", TEXTS["README.md"]))


def test_documentation_names_menu_entries_that_exist():
    named = found(rf"\*\*({MENUS}) > ([^*]+)\*\*")
    assert len(named) > 5
    texts = {
        text.replace("&", "").rstrip("…")
        for message, _ in messages()
        for text in ((message,) if isinstance(message, str) else message)
    }
    assert [(page, path) for page, (_, path) in named if not texts.issuperset(path.split(" > "))] == []


def test_documentation_names_every_room_on_the_architecture_page():
    page = TEXTS["docs/architecture.md"]
    folders = [path.parent for path in (ROOT / "apd_viewer").glob("**/__init__.py")]
    rooms = [folder.name for folder in folders if folder.name != "apd_viewer"]
    assert len(rooms) > 30
    assert [room for room in rooms if f"`{room}/`" not in page] == []


def test_documentation_names_files_that_exist():
    named = found(r"`((?:apd_viewer|tests|docs|resources)/[\w/.-]*)`")
    assert len(named) > 8
    made = "apd_viewer/languages/"  # begun with the first translation
    assert [name for name in named if not (ROOT / name[1][0]).exists() and made not in name[1][0]] == []
