"""Mutants are small valid changes, chosen by seed, and told apart by the tests that reach them."""

import ast
import json
import time

import pytest
from mutant_runs import choice_of, make_map, run_mutant
from mutations import Place, chosen_places, places
from reach import with_notes

pytestmark = pytest.mark.night  # tools of the tests and the site

SOURCE = '''
def changed(a, b=1, *, c: "a < b" = 0.5):
    """Texts and annotations stay: 1 < 2."""
    if not a.ready and b is not None:
        a.count = (
            len(b)
        )
        raise ValueError(f"{a < b}")
    for each in a:  # < is no operator here
        each -= -b ** 2
        if each in (1, True):
            continue
    while a.left(b):
        a.go(
            b,
        )
    return (a
            < b < "ä")
'''
KINDS = {"comparison", "arithmetic", "constant", "boolean", "not", "condition", "return", "statement"}


def told(found):
    return {(place.line, str(place)) for place in found}


def test_mutants_are_valid_code_of_as_many_lines_that_does_something_else():
    source = SOURCE.encode()
    found = places(source)
    assert {place.kind for place in found} == KINDS
    for place in found:
        changed = place.applied(source)
        assert changed.count(b"\n") == source.count(b"\n")
        assert ast.dump(ast.parse(changed)) != ast.dump(ast.parse(source))
        lines = zip(source.splitlines(), changed.splitlines(), strict=True)
        differing = [k for k, (before, after) in enumerate(lines, 1) if before != after]
        assert differing[0] >= place.line
        assert differing[-1] <= place.line + place.old.count("\n")


def test_mutants_are_made_where_the_code_decides_and_computes():
    assert told(places(SOURCE.encode())) == {
        (2, "1 -> 2"),
        (2, "0.5 -> 1.5"),
        (4, "not -> nothing"),
        (4, "and -> or"),
        (4, "not a.ready and b is not None -> (not (not a.ready and b is not None))"),
        (4, "is not -> is"),
        (5, "a.count = ( len(b) ) -> pass"),
        (8, 'raise ValueError(f"{a < b}") -> pass'),
        (10, "each -= -b ** 2 -> pass"),
        (10, "- -> +"),
        (10, "** -> *"),
        (10, "2 -> 3"),
        (11, "in -> not in"),
        (11, "1 -> 2"),
        (11, "True -> False"),
        (12, "continue -> pass"),
        (13, "a.left(b) -> (not (a.left(b)))"),
        (14, "a.go( b, ) -> pass"),
        (17, 'a < b < "ä" -> None'),
        (18, "< -> <="),
        (18, "< -> >="),
    }


def test_mutants_are_chosen_alike_by_the_same_seed_and_their_areas_take_turns(tmp_path):
    for name in "abcdefgh":
        (tmp_path / name).mkdir()
        (tmp_path / name / "code.py").write_text(SOURCE, encoding="utf-8")
    areas = {"first": ["a", "b", "c", "d"], "second": ["e", "f", "g", "h"]}
    chosen = chosen_places(tmp_path, areas, 7, seed=3)
    assert chosen == chosen_places(tmp_path, areas, 7, seed=3)
    assert chosen != chosen_places(tmp_path, areas, 7, seed=4)
    assert [area for area, _ in chosen] == ["first", "second"] * 3 + ["second"]


def test_mutants_are_not_chosen_if_they_are_no_code(tmp_path):
    (tmp_path / "a.py").write_text("def f(x):\n    with x():\n        return [*x, -1]\n", encoding="utf-8")
    chosen = {
        str(place) for seed in range(30) for _, place in chosen_places(tmp_path, {"all": ["."]}, 1, seed)
    }
    assert chosen == {"[*x, -1] -> None", "- -> +", "1 -> 2"}


def test_mutants_note_which_functions_are_entered_except_what_numba_compiles():
    source = """
class A:
    def f(self):
        "Docstring."
        return [1 for _ in range(2)]

    @property
    def g(self):
        def h():
            return 2
        return h()

@njit(cache=True)
def kernel():
    def inner():
        return 3
    return 4
"""
    entered = []
    names = {"__entered__": entered.append, "njit": lambda **_: lambda function: function}
    exec(compile(with_notes(source, "a.py"), "a.py", "exec"), names)
    assert (names["A"]().f(), names["A"]().g, names["kernel"]()) == ([1, 1], 2, 4)
    assert names["A"].f.__doc__ == "Docstring."
    assert entered == ["a.py::A.f", "a.py::A.g", "a.py::A.g.<locals>.h"]


CODE = """
import time

def sign(x):
    while x != x:
        time.sleep(0.01)
    return x > 0

def unreached(x):
    return x + 1

def half(x):
    return x / 2

def double(x):
    return x * 2
"""
TESTS = """
import pathlib, subprocess, sys, tempfile
from tiny.inner import code

def test_sign_of_large_numbers():
    assert code.sign(5) and not code.sign(-5)

def test_half():
    code = "from tiny.inner.code import half; assert half(4) == 2"
    subprocess.run([sys.executable, "-c", code], check=True)

def test_that_fails():
    assert code.sign(0)

def test_that_fails_by_chance():
    once = pathlib.Path(tempfile.gettempdir(), "once")
    assert code.double(2) == 4 or once.exists() or once.touch()

def test_double_of_zero():
    assert code.double(0) == 0
"""


@pytest.fixture(scope="module")
def tiny(tmp_path_factory):
    """A package with tests of its own, and the map of what they reach."""
    root = tmp_path_factory.mktemp("tiny")
    (root / "tiny" / "inner").mkdir(parents=True)
    (root / "tests").mkdir()
    (root / "tiny" / "inner" / "code.py").write_text(CODE, encoding="utf-8")
    (root / "tests" / "test_code.py").write_text(TESTS, encoding="utf-8")
    make_map(root / "tiny", ["inner"], ["tests"], root / "build")
    return root, json.loads((root / "build" / "map.json").read_text(encoding="utf-8"))


def test_mutants_map_says_which_tests_reach_a_function_and_how_they_went(tiny):
    _, found = tiny
    assert found["reached"] == {
        "inner/code.py::double": [
            "tests/test_code.py::test_double_of_zero",
            "tests/test_code.py::test_that_fails_by_chance",
        ],
        "inner/code.py::half": ["tests/test_code.py::test_half"],
        "inner/code.py::sign": [
            "tests/test_code.py::test_sign_of_large_numbers",
            "tests/test_code.py::test_that_fails",
        ],
    }
    outcomes = {name.rpartition("::")[2]: outcome for name, (_, outcome) in found["tests"].items()}
    assert outcomes.pop("test_that_fails") == "failed"
    assert list(outcomes.values()) == ["passed"] * 4


def verdict_on(tiny, change, function, seconds=60.0):
    root, found = tiny
    source = (root / "tiny" / "inner" / "code.py").read_bytes()
    named = [
        each for each in places(source, "inner/code.py") if (str(each), each.function) == (change, function)
    ]
    choice = choice_of(named[0], found)
    end = time.monotonic() + seconds
    verdict = run_mutant(named[0], root / "tiny", choice, root / "log", lambda: time.monotonic() > end)
    assert (root / "tiny" / "inner" / "code.py").read_bytes() == source
    return verdict.outcome, verdict.test


@pytest.mark.parametrize(
    ("change", "function", "outcome", "test"),
    [
        ("> -> <=", "sign", "killed", "tests/test_code.py::test_sign_of_large_numbers"),
        ("> -> >=", "sign", "survived", ""),  # the test that would notice fails without the change, too
        pytest.param("/ -> *", "half", "killed", "tests/test_code.py::test_half", marks=pytest.mark.night),
        # A failure that is none when it is looked at again.
        pytest.param("* -> /", "double", "survived", "", marks=pytest.mark.night),
        ("+ -> -", "unreached", "not reached", ""),
    ],
)
def test_mutants_that_are_killed_and_survivors_are_told_apart(tiny, change, function, outcome, test):
    assert verdict_on(tiny, change, function) == (outcome, test)


def test_mutants_that_hang_are_ended(tiny):
    assert verdict_on(tiny, "!= -> ==", "sign", seconds=2.0)[0] == "broken off"


def test_mutants_meet_tests_of_their_module_first_and_then_files_take_turns():
    place = Place("geometry/contact/gap.py", "f", "constant", 1, 0, 1, "1", "2")
    costs = {
        "tests/ui/test_window.py::test_a": 0.5,
        "tests/geometry/contact/test_gap.py::test_b": 20.0,
        "tests/geometry/contact/test_other.py::test_c": 2.5,
        "tests/geometry/contact/test_other.py::test_d": 2.0,
        "tests/geometry/contact/test_third.py::test_e": 17.0,
    }
    found = {
        "tests": {name: [cost, "passed"] for name, cost in costs.items()},
        "reached": {place.key: [*costs]},
    }
    choice = choice_of(place, found)
    assert [name[-1] for name in choice.tests] == ["a", "d", "e", "b"]
    assert choice.reaching == 5
    assert choice.is_cut
    assert not choice_of(place, found, limit=100.0).is_cut
    assert [name[-1] for name in choice_of(place, found, limit=3.0).tests] == ["b"]
