"""What all rooms' tests share. pytest puts this folder on sys.path, so ``from meshes import box`` works."""

import gc
import os
import random
import sys
from itertools import groupby

os.environ["APD_VIEWER_LANGUAGE"] = "en"  # what the tests expect, wherever they are run
os.environ.setdefault("LP_NUM_THREADS", "0")  # pictures drawn by the processor: each worker has one core

import pytest
from hypothesis import settings
from in_thread import InThread
from new_threads import note_threads

from apd_viewer.geometry.warmup import warm_up
from apd_viewer.session.processes import shape_checker, solver_process

# What Python has compiled is kept, or each process that tests start would compile all modules anew.
os.environ.pop("PYTHONDONTWRITEBYTECODE", None)
sys.dont_write_bytecode = False

pytest_plugins = ["kernel_watch", "night_tests"]

START = solver_process.start_solver_process

# The kernels compile on first use, which no deadline can foresee; the same examples on every machine.
settings.register_profile("suite", deadline=None, derandomize=True, max_examples=60)
settings.load_profile("suite")


def pytest_addoption(parser):
    parser.addoption("--shuffle", metavar="SEED", help="run files, and the tests of each, in a random order")


def pytest_xdist_auto_num_workers():
    """One more than there are cores, as some tests wait; four at most, each with a gigabyte."""
    return min((os.cpu_count() or 1) + 1, 4)


def pytest_report_header(config):
    return f"shuffled with seed {config.getoption('shuffle')}" if config.getoption("shuffle") else None


def pytest_collection_modifyitems(config, items):
    """Shuffle the tests if asked to."""
    if seed := config.getoption("shuffle"):
        chance = random.Random(seed)
        files = [list(tests) for _, tests in groupby(items, lambda item: item.path)]
        chance.shuffle(files)
        items[:] = [test for tests in files for test in chance.sample(tests, len(tests))]


@pytest.hookimpl(tryfirst=True)
def pytest_runtest_setup():
    """Tell threads of the test from those of the window that tests share."""
    note_threads()


def pytest_collection_finish():
    """Look no more through what is there to the end, in which no garbage is to be found."""
    gc.collect()
    gc.freeze()
    gc.set_threshold(10_000)


@pytest.fixture(scope="session", autouse=True)
def logs(tmp_path_factory):
    """No test writes to the user's own log; nor do the processes that it starts."""
    os.environ["APD_VIEWER_LOGS"] = str(tmp_path_factory.mktemp("logs"))


@pytest.fixture(scope="session")
def qapp_cls():
    """What pytest-qt calls to make the application, whichever test is the first to need one."""
    from apd_viewer.ui.application import make_application  # most tests need no Qt

    yield make_application
    gc.enable()  # GuiThreadGC had taken it over


@pytest.fixture(autouse=True)
def solver_in_a_thread(monkeypatch):
    """The solver is a thread, where a test can change it, unless the test is about the process."""
    monkeypatch.setattr(solver_process, "start_solver_process", InThread)


@pytest.fixture(autouse=True)
def nothing_is_checked(monkeypatch):
    """No process is started to check shapes, unless the test is about that."""
    monkeypatch.setattr(shape_checker, "FIRST_PAUSE", 1e6)


@pytest.fixture(scope="session")
def compiled():
    """The kernels are in the cache: what tests time is no compiler."""
    warm_up()


@pytest.fixture
def process(compiled, solver_in_a_thread, monkeypatch):
    """The solver is a process, as it is for the user."""
    monkeypatch.setattr(solver_process, "start_solver_process", START)
