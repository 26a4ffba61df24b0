"""What is typed into a field: arithmetic is Python's, units convert, and nonsense gets one clear sentence."""

import math

import pytest
from hypothesis import example, given, strategies as st

from apd_viewer.errors import InputError
from apd_viewer.session.quantities.expressions import MOST_CHARACTERS, parse_angle, parse_length, parse_number
from apd_viewer.session.quantities.units import Unit

NAMES = {"L": 2.0, "D": 3.5}
MM, CM, M = Unit.MILLIMETRE, Unit.CENTIMETRE, Unit.METRE
KNOWN = (MM, CM, M)
finite = st.floats(allow_nan=False, allow_infinity=False)
positive = st.floats(1e-6, 1e6)


def refused(call, *given):
    """The sentence that is said instead of a value."""
    with pytest.raises(InputError) as error:
        call(*given)
    sentence = str(error.value)
    assert sentence.endswith(".")
    assert sentence.isprintable()
    assert sentence[0].isupper() or sentence[0] == "“" or sentence.split()[0] in WORDS
    return sentence


WORDS = ("sqrt", "sin", "cos", "tan", "asin", "acos", "atan", "abs")


@given(finite)
def test_expressions_read_a_printed_number_back(value):
    for text in (repr(value), f"  {value!r}\u00a0", f"({value!r})", repr(value).replace("-", "−")):
        assert parse_number(text, {}) == value
        assert parse_length(text, Unit.NONE, {}) == value
        assert parse_angle(text, {}) == math.radians(value)


@given(st.integers(0, 10**6), st.integers(0, 10**6))
def test_parse_number_reads_a_decimal_comma_unless_it_could_part_thousands(whole, part):
    text = f"{whole},{part}"
    if 0 < whole < 1000 and 100 <= part < 1000:
        assert "can mean" in refused(parse_number, text, {})
    else:
        assert parse_number(text, {}) == float(f"{whole}.{part}")


@st.composite
def infix(draw, parts):
    left, right = draw(parts), draw(parts)
    sign = draw(st.sampled_from(["+", "-", "*", "/", " + ", " - ", " * ", " / "]))
    return f"{left}{sign}{right}"


numerals = st.floats(1e-3, 1e3).map(repr) | st.integers(0, 20).map(lambda k: f"{k}.0")
arithmetic = st.recursive(
    numerals,
    lambda parts: (
        infix(parts)
        | parts.map("({})".format)
        | parts.map("-{}".format)
        | st.builds("{}**{}".format, parts.map("({})".format), st.sampled_from(["2.0", "-1.0", "0.5"]))
        | st.builds("{}**{}".format, numerals, st.sampled_from(["-2.0", "2.0**3.0", "(1.0-2.0)"]))
    ),
    max_leaves=8,
).filter(lambda text: len(text) <= MOST_CHARACTERS)


@given(arithmetic)
@example("-2.0**2.0")
@example("2.0**-2.0**2.0")
@example("(-8.0)**0.5")
@example("1.0/(2.0-2.0)")
@example("(0.0)**-1.0")
@example("(9.0)**2.0**2.0**2.0**2.0**2.0")
def test_parse_number_does_the_arithmetic_of_python(text):
    try:
        expected = eval(text)
    except (ZeroDivisionError, OverflowError):
        expected = math.nan
    if isinstance(expected, complex) or not math.isfinite(expected):
        refused(parse_number, text, {})
    else:
        assert parse_number(text, {}) == expected
        assert parse_number(text.replace("**", "^").replace("*", "×").replace("/", "÷"), {}) == expected


@pytest.mark.parametrize(
    ("text", "expected"),
    [
        ("0.15L", 0.3),
        ("0,15 L", 0.3),
        ("2(1+1)", 4.0),
        ("(1+1)(1+2)", 6.0),
        ("1/2 L", 1.0),
        ("1/2L", 1.0),
        ("L/2", 1.0),
        ("2L^2/D", 8 / 3.5),
        ("L D / L", 3.5),
        ("15% L", 0.3),
        ("50%^2 L", 0.5),
        ("L/50%", 4.0),
        ("sqrt(L L)", 2.0),
        ("sqrt(L² + D²)", math.sqrt(4 + 3.5**2)),
        ("(L³)^(1/3)", 2.0),
        ("-abs(-L)", -2.0),
        ("min(L, D, 1)", 1.0),
        ("max(1,5)", 5.0),
        ("max((0,5), 0.25)", 0.5),
        ("sqrt(0,25)", 0.5),
        ("L sin(30)", 1.0),
        ("L sin 30", None),
        ("L cos(60 deg)", 1.0),
        ("L sin(π/6 rad)", 1.0),
        ("D tan(1/8 turn)", 3.5),
        ("L sin(asin(0.5))", 1.0),
        ("60deg/30deg L", 4.0),
        ("L + 1", 3.0),
        ("1 - L", -1.0),
        ("10−2×3", 4.0),
        ("2\u00a0·\u202fL", 4.0),
        ("1e1L", 20.0),
        (".5L", 1.0),
        ("2.L", 4.0),
        ("--+L", 2.0),
    ],
)
def test_parse_length_reads_names(text, expected):
    if expected is None:
        refused(parse_length, text, Unit.NONE, NAMES)
    else:
        assert parse_length(text, Unit.NONE, NAMES) == pytest.approx(expected, rel=1e-14)


@given(positive, st.sampled_from(KNOWN))
def test_parse_length_converts_units(value, unit):
    for text in (f"{value!r}{unit.value}", f"{value!r} {unit.value}", f"({value!r})\u00a0{unit.value}"):
        assert parse_length(text, unit, {}) == value
    for smaller, larger, times in (
        ("mm", "cm", 10),
        ("um", "mm", 1000),
        ("in", "ft", 12),
        ("mm", "in", 25.4),
    ):
        one, many = (
            parse_length(f"{v!r}{w}", unit, {}) for v, w in ((value, larger), (value * times, smaller))
        )
        assert one == pytest.approx(many, rel=1e-14)


@pytest.mark.parametrize(
    ("text", "unit", "expected"),
    [
        ("1 in", MM, 25.4),
        ("1ft", M, 0.3048),
        ("5 mm + 1 cm", MM, 15.0),
        ("5 mm + 1", CM, 1.5),
        ("3µm", MM, 0.003),
        ("3 μm", MM, 0.003),
        ("1/2 in", MM, 12.7),
        ("3*1/2in", MM, 38.1),
        ("10mm/5mm", MM, 2.0),
        ("L/2mm mm", MM, 1.0),
        ("mm", CM, 0.1),
        ("2^3mm", MM, 8.0),
        ("6mm²/2mm", MM, 3.0),
        ("sqrt(4 mm^2)", MM, 2.0),
        ("1/4 mm^-1", MM, None),
        ("2 (3 mm)", MM, 6.0),
        ("max(1 mm, 1 cm, 0.5)", MM, 10.0),
    ],
)
def test_parse_length_reads_expressions_with_units(text, unit, expected):
    if expected is None:
        refused(parse_length, text, unit, NAMES)
    else:
        assert parse_length(text, unit, NAMES) == pytest.approx(expected, rel=1e-14)


@given(st.floats(-1e6, 1e6))
def test_parse_angle_converts_units(value):
    text = repr(value)
    for degrees in (f"{text}deg", f"{text}°", f"{text} °", f"{text} deg", text):
        assert parse_angle(degrees, {}) == math.radians(value)
    assert parse_angle(f"{text} rad", {}) == pytest.approx(value, rel=1e-14)
    assert parse_angle(f"{text} turn", {}) == pytest.approx(2 * math.pi * value, rel=1e-14)


@pytest.mark.parametrize(
    ("text", "expected"),
    [
        ("60deg", 60),
        ("90°/2", 45),
        ("1/2°", 0.5),
        ("pi rad", 180),
        ("π/2 rad", 90),
        ("45 + 0.125 turn", 90),
        ("atan(1)", 45),
        ("acos(0.5) + 1°", 61),
        ("asin(L/(2L))", 30),
        ("atan(L/D)", math.degrees(math.atan(2 / 3.5))),
        ("max(10deg, 20)", 20),
        ("1/8 turn", 45),
    ],
)
def test_parse_angle_reads_expressions_of_angles(text, expected):
    assert parse_angle(text, NAMES) == pytest.approx(math.radians(expected), rel=1e-14)


def test_parse_number_reads_percentages_ratios_functions_and_commas():
    assert parse_number("15%", {}) == 0.15
    assert parse_number("7 %", {}) == 0.07
    assert parse_number("D/L", NAMES) == 1.75
    assert parse_number("cos(60) + sin(30deg)", {}) == pytest.approx(1.0)
    assert parse_number("2pi", {}) == 2 * math.pi
    assert parse_number("1234,567", {}) == 1234.567
    assert parse_number("0,125", {}) == 0.125


@pytest.mark.parametrize(
    ("text", "words"),
    [
        ("60deg", "an angle"),
        ("L*L", "an area"),
        ("L D L", "a volume"),
        ("1/L", "product"),
        ("L deg", "product"),
        ("L + 60deg", "a length and an angle"),
        ("60deg - L", "an angle and a length"),
        ("L + L*L", "a length and an area"),
        ("min(L, 3°)", "a length and an angle"),
        ("2^L", "exponent cannot be a length"),
        ("sin(L)", "angle"),
        ("acos(L)", "number"),
        ("acos(1.01)", "from -1 to 1"),
        ("tan(90)", "infinite"),
        ("tan(-3/4 turn)", "infinite"),
        ("sqrt(-1)", "negative"),
        ("sqrt(1, 2)", "one value"),
        ("sqrt", "parentheses"),
        ("sqrt 2", "parentheses"),
        ("sqrt()", "“)”"),
        ("1/0", "divides by zero"),
        ("1/(L-L)", "divides by zero"),
        ("0^-1", "divides by zero"),
        ("1e999", "too large"),
        ("9^9^9", "too large"),
        ("1e200*1e200", "too large"),
        ("", "Nothing was entered"),
        (" \u00a0\n", "Nothing was entered"),
        ("5 $", "“$”"),
        ("5\x00", "U+0000"),
        ("\ud800", "U+D800"),
        ("\u200b5", "U+200B"),
        ("½", "“½”"),
        ("__import__('os')", "“_”"),
        ("L.real", "“.”"),
        ("l", "L, D, pi"),
        ("x" * 150, "…” is unknown"),
        ("2 3", "before “3”"),
        ("1.2.3", "before “.3”"),
        ("L 2", "before “2”"),
        ("5 ft 6 in", "before “6”"),
        ("1,2,3", "“,”"),
        ("1,234", "1.234 or 1234"),
        ("2 +", "is incomplete"),
        ("(2", "close it"),
        ("(2 3)", "before “3”"),
        ("2)", "“)”"),
        ("*2", "“*”"),
        ("2 * / 3", "“/”"),
        ("5mm%", "“%”"),
        ("()", "“)”"),
        ("(" * 100 + "1" + ")" * 99, "nested"),
        ("2^" * 99 + "1", "nested"),
        ("1" * (MOST_CHARACTERS + 1), "too long"),
    ],
)
def test_parse_length_refuses_what_is_none_in_a_sentence_that_says_why(text, words):
    assert words in refused(parse_length, text, MM, NAMES)


def test_parse_length_with_a_unit_needs_that_of_the_mesh():
    assert "choose" in refused(parse_length, "5mm", Unit.NONE, NAMES)
    assert parse_length("5", Unit.NONE, NAMES) == 5.0


@pytest.mark.parametrize("text", ["5mm", "L", "5 in"])
def test_parse_angle_and_number_refuse_a_length(text):
    for call in (parse_angle, parse_number):
        assert "length" in refused(call, text, NAMES)
    assert "an angle" in refused(parse_number, "60deg", NAMES)


def test_parse_length_takes_a_name_before_a_unit():
    assert parse_length("2m", MM, {"m": 7.0}) == 14.0
    assert parse_length("min", MM, {"min": 7.0}) == 7.0


def test_parse_number_takes_long_sums_and_many_signs_as_not_nested():
    assert parse_number("+".join("1" * 100), {}) == 100.0
    assert parse_number("-" * 100 + "1", {}) == 1.0


pieces = st.sampled_from(
    [*"0123456789.,+-*/^()%°πLDe² \n", "**", "mm", " in", "deg", "rad", "sqrt(", "min(", "tan(", "atan("]
)
garbage = st.text() | st.lists(pieces | st.characters(), max_size=40).map("".join)
likely = st.lists(pieces, min_size=1, max_size=12).map("".join)


@given(garbage | likely | likely)
@example("0**(1e300^1e300)")
@example("(L^1e300)^1e300")
@example("(L/L L^1e300)^1e300 - L")
def test_expressions_make_whatever_is_typed_a_finite_number_or_a_sentence(text):
    for names in (NAMES, {"L": 1.0, "D": 0.0}):
        for read, given_ in (
            (parse_length, (MM, names)),
            (parse_length, (Unit.NONE, names)),
            (parse_angle, (names,)),
            (parse_number, (names,)),
        ):
            try:
                value = read(text, *given_)
            except InputError:
                refused(read, text, *given_)
            else:
                assert math.isfinite(value)
