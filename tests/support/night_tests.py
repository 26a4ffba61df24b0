"""Plugin of pytest: what is run by day, by night, and in a step apart; what tests record is sent as text."""

import pytest

# Marks of tests that only a run with such an option has, and no others.
APART = {"extra": "extras", "alone": "alone"}


def pytest_addoption(parser):
    parser.addoption("--night", action="store_true", help="run what is too long for every day, too")
    parser.addoption("--extras", action="store_true", help="run what needs extras, and nothing else")
    parser.addoption("--alone", action="store_true", help="run what needs all cores, and nothing else")


def pytest_collection_modifyitems(config, items):
    """Leave out what is for the night, or for a step apart."""
    asked = {mark for mark, option in APART.items() if config.getoption(option)}
    night = asked or config.getoption("night")

    def chosen(item):
        marks = {mark.name for mark in item.iter_markers()}
        return marks & APART.keys() == asked and (night or "night" not in marks)

    config.hook.pytest_deselected(items=[item for item in items if not chosen(item)])
    items[:] = filter(chosen, items)


@pytest.hookimpl(tryfirst=True)
def pytest_runtest_makereport(item):
    """Turn recorded figures into text: workers cannot send NumPy's."""
    item.user_properties[:] = [(name, str(value)) for name, value in item.user_properties]
