"""The structure stays readable: limits on sizes, on late construction and on the words of docstrings."""

from pathlib import Path

import pytest
from structure import (
    QUESTION,
    RELATIVE,
    Module,
    body_lengths,
    first_lines,
    folder_sizes,
    forwarders,
    homonyms,
    import_share,
    late_starts,
    local_imports,
    method_comparisons,
    method_counts,
    misnamed_files,
    misnamed_tests,
    modules,
    percentile,
    private_names,
    single_importers,
)


@pytest.fixture(scope="module")
def found():
    return modules()


@pytest.fixture(scope="module")
def tests():
    found = modules(Path(__file__).parent)
    return [module for module in found if not module.where.startswith("benchmarks/")]


def test_structure_has_small_files(found):
    assert percentile([len(module.lines) for module in found], 0.9) <= 340


def test_structure_is_not_cut_into_pieces(found):
    assert len([module for module in found if not module.where.endswith("__init__.py")]) <= 480
    assert len(single_importers(found)) <= 120
    assert import_share(found) <= 0.11
    assert len(misnamed_files(found)) <= 5


def test_structure_has_small_functions_and_classes(found):
    assert percentile(body_lengths(found), 0.9) <= 15
    assert {name: count for name, count in method_counts(found).items() if count > 25} == {}


def test_structure_has_few_methods_that_only_forward(found):
    assert len(forwarders(found)) < 0.02 * len(body_lengths(found))


def test_structure_completes_nothing_in_the_window_after_its_constructor(found):
    assert late_starts(found) == []


def test_structure_lets_traits_decide_and_not_the_names_of_methods(found):
    assert method_comparisons(found) == []


def test_structure_gives_imports_in_functions_their_reason(found):
    assert [place for place, explained in local_imports(found) if not explained] == []


def test_structure_lets_tests_use_no_private_names(tests):
    assert private_names(tests) == []


def test_structure_names_tests_after_what_they_test(tests, found):
    assert misnamed_tests(tests, found) == []


def test_structure_gives_each_class_a_name_of_its_own(found):
    assert homonyms(found) == []


def test_structure_begins_docstrings_with_a_name_or_an_imperative(found):
    lines = first_lines(found)
    assert [place for place, text in lines if QUESTION.match(text)] == []
    assert [place for place, text in lines if len(text) > 80] == []


def test_structure_keeps_relative_clauses_rare_in_first_lines(found):
    texts = [text for _, text in first_lines(found)]
    assert sum(len(RELATIVE.findall(text)) for text in texts) <= 0.1 * len(texts)


BAD = Module(
    "ui/odd.py",
    '''
class Odd:
    """What is odd, which nobody names."""

    def start(self):
        import json

        return self.part.of(json)

    def forward(self, a, b):
        return self.part.forward(a, b)

    @property
    def length(self):
        """Length."""
        return self.part.length

    def total(self, a):
        return self.part.total(a, 1)

    def reach(self, patch):
        from elsewhere import _hidden

        patch.setattr("elsewhere._other", self._own)
        patch.setattr(_hidden, "_third", self.part._fourth)


def odd(method):
    return method == "paper" or method in ("exact", "local")
''',
)


def test_structure_has_figures_that_see_what_they_should():
    """A measure that finds nothing would keep all limits."""
    assert [line.split()[1] for line in forwarders([BAD])] == ["forward", "length"]
    assert len(method_comparisons([BAD])) == 2
    assert [line.split()[1] for line in late_starts([BAD])] == ["start"]
    assert [explained for _, explained in local_imports([BAD])] == [False, False]
    assert sorted(line.split()[1] for line in private_names([BAD])) == [
        "_fourth",
        "_hidden",
        "_other",
        "_third",
    ]
    odd, right = (
        Module("test_odd.py", f"def test_{name}(): ...") for name in ("what_is_odd", "length_is_odd")
    )
    assert misnamed_tests([odd, right], [BAD]) == ["test_odd.py test_what_is_odd"]
    assert method_counts([BAD]) == {"Odd": 5}
    texts = [text for _, text in first_lines([BAD])]
    assert [bool(QUESTION.match(text)) for text in texts] == [True, False]
    assert len(RELATIVE.findall(texts[0])) == 2
    assert homonyms([BAD, BAD]) == ["Odd"]
    assert import_share([BAD]) == pytest.approx(2 / 17)
    user = Module("ui/user.py", "from apd_viewer.ui.odd import Odd\nfrom apd_viewer.ui import odd\n")
    assert single_importers([BAD, user]) == ["apd_viewer.ui.odd"]
    assert misnamed_files([BAD]) == []
    assert misnamed_files([Module("ui/even.py", BAD.text)]) == ["ui/even.py Odd"]
    assert folder_sizes([BAD]) == {"ui": 1}
