"""Numbers in the notation of a language: what is shown can be typed, and what is doubtful is asked about."""

import os
import random
import re
import subprocess
import sys

import pytest

from apd_viewer.errors import InputError
from apd_viewer.language import languages, tr, trn
from apd_viewer.notation import Notation, notation, use_notation
from apd_viewer.presentation import number_format
from apd_viewer.presentation.obstacle_readings import coordinates_text
from apd_viewer.session.quantities.expressions import parse_length, parse_number, unambiguous_text
from apd_viewer.session.quantities.units import Unit
from apd_viewer.ui.widgets.fields import NumberField, percent_field

ENGLISH, GERMAN, FRENCH = Notation(), Notation(",", "."), Notation(",", "\u202f")
EACH = pytest.mark.parametrize("used", [ENGLISH, GERMAN, FRENCH], ids=["English", "German", "French"])


@pytest.fixture(autouse=True)
def restored():
    """The notation of the other tests afterwards."""
    before = notation()
    yield
    use_notation(before)


def some_numbers(count):
    """Numbers of all sizes and with few digits or many, with those that look like thousands."""
    chance = random.Random(5)
    yield from (0.0, 1.5, 1.234, 12.345, 123.456, 1.125, 1000.0, 13010.0, 0.123, 1234.567)
    for _ in range(count):
        size = 10.0 ** chance.randint(-6, 6)
        yield round(chance.uniform(-1.0, 1.0) * size, chance.randint(0, 8))


@EACH
def test_format_editable_shows_in_a_field_what_is_read_again(used):
    use_notation(used)
    for x in some_numbers(2000):
        text = number_format.format_editable(x, 12)
        assert parse_number(unambiguous_text(text), {}) == pytest.approx(x, rel=1e-11), text
        assert parse_length(unambiguous_text(text + "mm"), Unit.MILLIMETRE, {}) == pytest.approx(
            x, rel=1e-11
        ), text


@EACH
def test_parse_number_fields_show_what_is_entered_again(qtbot, used):
    use_notation(used)
    wide = {"minimum": -1e9, "maximum": 1e9}
    plain = NumberField(brief=True, decimals=9, **wide), NumberField(decimals=3, suffix=" mm", **wide)
    for field, sign in (*((each, "") for each in plain), (percent_field("", ""), "%")):
        qtbot.addWidget(field)
        for x in some_numbers(300):
            field.setValue(x)
            shown, text = field.value(), field.textFromValue(field.value())
            field.setValue(77.0)
            assert field.valueFromText(text + sign + field.suffix()) == pytest.approx(shown, rel=1e-9), text


@EACH
def test_coordinates_text_that_are_shown_can_be_typed(used):
    use_notation(used)
    chance = random.Random(3)
    for _ in range(200):
        point = [round(chance.uniform(-20.0, 20.0), chance.randint(0, 4)) for _ in range(3)]
        text = coordinates_text(point)
        parts = text.split(";" if ";" in text else ",")
        assert [parse_number(unambiguous_text(part), {}) for part in parts] == pytest.approx(point, rel=1e-5)


@EACH
def test_notation_tells_groups_and_decimals_apart(used):
    use_notation(used)
    for x in some_numbers(500):
        text = number_format.format_grouped(x, 3)
        plain = text.replace(used.group, "").replace(used.point, ".").replace("−", "-")
        assert float(plain) == pytest.approx(x, abs=6e-4)
        assert "," not in text or "," in used
        assert "." not in text or "." in used
    assert tr("{n:,} faces").format(n=13010).split()[0] == f"13{used.group}010".split()[0]
    assert trn("{n:,} vertex", "{n:,} vertices", 2000).format(n=2000).startswith(f"2{used.group}000")
    assert tr("{name}: {value:.2f}").format(name="a.b,c", value=0.5) == f"a.b,c: 0{used.point}50"


def test_parse_number_reads_as_ever_what_is_read_in_every_language():
    for used in (ENGLISH, GERMAN, FRENCH):
        use_notation(used)
        assert parse_number("0,3", {}) == parse_number("0.3", {}) == 0.3
        assert parse_number("1.500", {}) == 1.5, "in a file, and on the command line"
        with pytest.raises(InputError, match="“1,500” can mean"):
            parse_number("1,500", {})


def test_unambiguous_text_asks_about_a_point_that_the_window_puts_between_groups(qtbot):
    field = NumberField(brief=True, decimals=6, maximum=1e9)
    qtbot.addWidget(field)
    field.setValue(7.0)
    for used, doubtful in ((ENGLISH, ["1,500"]), (GERMAN, ["1,500", "1.500"]), (FRENCH, ["1,500"])):
        use_notation(used)
        for text in doubtful:
            assert field.valueFromText(text) == 7.0
        assert field.valueFromText("1.5") == field.valueFromText("1,5") == 1.5
    use_notation(GERMAN)
    with pytest.raises(InputError, match=r"“1\.500” can mean 1,5 or 1500; write 1,5 or 1500"):
        unambiguous_text("2 * 1.500 mm")
    with pytest.raises(InputError, match=r"can mean 1,2340 or 1234"):
        parse_number("1,234", {})
    assert unambiguous_text("1.5 + 0.125 + 10.1234 + 1.500.000") == "1.5 + 0.125 + 10.1234 + 1.500.000"


@pytest.mark.parametrize("language", languages())
def test_show_numbers_changes_the_point_in_the_window_which_the_command_line_keeps(language):
    code = (
        "from apd_viewer.language import localize_numbers, tr\n"
        "say = tr('{value:.3f} {n:,}').format\n"
        "print(say(value=0.5, n=13010)); localize_numbers(); print(say(value=0.5, n=13010))\n"
        "import subprocess, sys\n"
        "child = \"from apd_viewer.language import tr; print(tr('{x:.1f}').format(x=0.5))\"\n"
        "print(subprocess.run([sys.executable, '-c', child], capture_output=True, text=True).stdout)"
    )
    said = subprocess.run(
        [sys.executable, "-c", code],
        env=os.environ | {"APD_VIEWER_LANGUAGE": language, "APD_VIEWER_NUMBERS": ""},
        capture_output=True,
        text=True,
        check=True,
    ).stdout.split()
    plain, window, child = said[:2], said[2:4], said[4]
    assert plain == ["0.500", "13010" if language == "de" else "13,010"]
    assert window == (["0,500", "13.010"] if language == "de" else ["0.500", "13,010"])
    assert re.fullmatch(r"0\D5", child)
    assert child[1] == window[0][1], "commands of the window speak as it does"
