"""For pytest: what each test reaches and takes, or chosen tests in their order.

Loaded by ``tests/mutants.py``, with ``-p reach_plugin``: with notes under way (see ``reach``) it begins those
of each test; with a file of names in ``CHOSEN_TESTS`` it runs these alone, and tells in ``STARTED_TEST``
which one runs.
"""

import builtins
import json
import os
from pathlib import Path

import pytest


def pytest_configure(config):
    notes = getattr(getattr(builtins, "__entered__", None), "__self__", None)
    if notes is not None:
        config.pluginmanager.register(_Mapping(notes))
    if "CHOSEN_TESTS" in os.environ:
        files = (Path(os.environ[name]) for name in ("CHOSEN_TESTS", "STARTED_TEST"))
        config.pluginmanager.register(_Choice(*files))


class _Mapping:
    """Notes for each test, and at its end the seconds of the processor, with children, and how it went."""

    def __init__(self, notes):
        self._notes = notes
        self._outcomes = set()

    @pytest.hookimpl(wrapper=True, tryfirst=True)
    def pytest_runtest_protocol(self, item):
        self._outcomes.clear()
        self._notes.turn_to(item.nodeid)
        before = sum(os.times()[:4])
        result = yield
        outcome = next((each for each in ("failed", "skipped") if each in self._outcomes), "passed")
        self._notes.write("#" + json.dumps([round(sum(os.times()[:4]) - before, 3), outcome]))
        self._notes.turn_to("")
        return result

    def pytest_runtest_logreport(self, report):
        self._outcomes.add(report.outcome)


class _Choice:
    """Tests of a list, in its order."""

    def __init__(self, names, started):
        self._rank = {name: k for k, name in enumerate(names.read_text(encoding="utf-8").splitlines())}
        self._started = started

    @pytest.hookimpl(trylast=True)
    def pytest_collection_modifyitems(self, config, items):
        chosen = [item for item in items if item.nodeid in self._rank]
        config.hook.pytest_deselected(items=[item for item in items if item.nodeid not in self._rank])
        items[:] = sorted(chosen, key=lambda item: self._rank[item.nodeid])

    def pytest_runtest_logstart(self, nodeid):
        self._started.write_text(nodeid, encoding="utf-8")
