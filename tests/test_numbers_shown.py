"""Numbers are shown in the signs of the language: by formats that know them, and by no others."""

import ast
import re
from pathlib import Path

ROOT = Path(__file__).parents[1] / "apd_viewer"
FOLDERS = "commands", "presentation", "session", "ui"
# Formats that write a sign between groups or before decimals.
SIGNS = re.compile(r",|\.[0-9]*[1-9][0-9]*[fge%]|\.\{|g$")
# What writes a number as it is shown or typed.
WRITERS = {"localized_number", "editable_number"}
# What is read by programs: shaders, pictures, settings, options, decks, and what no window shows of commands.
FOR_PROGRAMS = {
    "commands/info_command.py",
    "commands/paper_command.py",
    "presentation/color_maps.py",
    "presentation/legend_svg.py",
    "ui/scene/surface_shading.py",
    "ui/studies/varied_fields.py",
    "ui/studies/engine_fields.py",
    "ui/overlays/display_options.py",
    "ui/preferences/preference_values.py",
}


def spec_of(part):
    """Format of a value in an f-string, with what is put into it as braces."""
    pieces = part.format_spec.values if part.format_spec else []
    return "".join(piece.value if isinstance(piece, ast.Constant) else "{}" for piece in pieces)


def strangers(source):
    """Lines with a number that is formatted in English signs, and shown."""
    tree = ast.parse(source)
    inside = {
        id(node)
        for call in ast.walk(tree)
        if isinstance(call, ast.Call) and getattr(call.func, "id", "") in WRITERS | {"float"}
        for node in ast.walk(call)
    }
    for node in ast.walk(tree):
        specs = [spec_of(node)] if isinstance(node, ast.FormattedValue) and id(node) not in inside else []
        if isinstance(node, ast.Attribute) and node.attr == "format" and isinstance(node.value, ast.Constant):
            specs = re.findall(r":([^{}]*)\}", node.value.value)
        if any(map(SIGNS.search, specs)):
            yield node.lineno


def test_numbers_shown_are_all_written_in_the_notation_in_use():
    found = {
        f"{path.relative_to(ROOT)}:{line}"
        for folder in FOLDERS
        for path in (ROOT / folder).rglob("*.py")
        if path.relative_to(ROOT).as_posix() not in FOR_PROGRAMS | {"presentation/number_format.py"}
        for line in strangers(path.read_text(encoding="utf-8"))
    }
    assert found == set()


def test_numbers_shown_have_only_exceptions_that_are_needed():
    for name in FOR_PROGRAMS:
        assert list(strangers((ROOT / name).read_text(encoding="utf-8"))), name


def test_numbers_shown_in_english_signs_are_noticed():
    assert list(strangers('f"{x:.3f} %"')) == [1]
    assert list(strangers('f"{n:,}"')) == [1]
    assert list(strangers('f"{x:g}"')) == [1]
    assert list(strangers('"{:,.2f}".format(x)')) == [1]
    assert list(strangers('f"{n:.0f}" + f"{name}" + localized_number(f"{x:.3f}")')) == []
    assert list(strangers('tr("{n:,} faces").format(n=n)')) == []
