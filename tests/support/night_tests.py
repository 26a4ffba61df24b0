"""Plugin of pytest: what is run by day, by night, and where extras are; what tests record is sent as text."""

import pytest


def pytest_addoption(parser):
    parser.addoption("--night", action="store_true", help="run what is too long for every day, too")
    parser.addoption("--extras", action="store_true", help="run what needs extras, and nothing else")


def pytest_collection_modifyitems(config, items):
    """Leave out what is for the night, or for where the extras are."""
    night, extras = config.getoption("night"), config.getoption("extras")

    def chosen(item):
        if extras or item.get_closest_marker("extra"):
            return extras and item.get_closest_marker("extra")
        return night or not item.get_closest_marker("night")

    config.hook.pytest_deselected(items=[item for item in items if not chosen(item)])
    items[:] = filter(chosen, items)


@pytest.hookimpl(tryfirst=True)
def pytest_runtest_makereport(item):
    """Turn recorded figures into text: workers cannot send NumPy's."""
    item.user_properties[:] = [(name, str(value)) for name, value in item.user_properties]
