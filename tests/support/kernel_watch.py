"""A run of several workers has all kernels compiled before, and fails where one is compiled after all.

A kernel called with other types than those in the table of kernels costs a user seconds in the middle of
something, and a test as well.
"""

import os
import subprocess
import sys
from pathlib import Path

import pytest
from kernel_rows import row
from numba.core import event

from apd_viewer import geometry
from apd_viewer.geometry.linalg.kernels import KernelCache
from apd_viewer.geometry.warmup import kernel_table

PACKAGE = Path(geometry.__file__).parents[1]
WARM_UP = "import sys; from apd_viewer.geometry.warmup import warm_up; warm_up(*sys.argv[1:])"


def pytest_configure(config):
    if hasattr(config, "workerinput"):
        config.pluginmanager.register(Watch(config.workeroutput))
    elif config.getoption("numprocesses", None):
        config.pluginmanager.register(Judge())


class Watch(event.Listener):
    """Notes in a worker which kernels are called that are not in the table, and by which test."""

    def __init__(self, output):
        self.found = output["kernels"] = {}
        self.compiling = 0
        self.known = {each for rows in kernel_table().values() for each in rows}
        event.register("numba:compile", self)
        load = KernelCache.load_overload

        def noted(cache, types, target):
            self.note(cache, types)
            return load(cache, types, target)

        KernelCache.load_overload = noted

    def note(self, cache, types):
        """Note a kernel that is no part of another."""
        if self.compiling or not cache.function.__module__.startswith(geometry.__name__):
            return
        called = row(cache.function, types)
        if called not in self.known:
            self.found.setdefault(called, os.environ.get("PYTEST_CURRENT_TEST", "").partition(" ")[0])

    def on_start(self, _):
        self.compiling += 1

    def on_end(self, _):
        self.compiling -= 1


class Judge:
    """Has the kernels compiled before the workers start, and tells at the end what they compiled."""

    def __init__(self):
        self.found = {}

    def pytest_sessionstart(self, session):
        reporter = session.config.pluginmanager.get_plugin("terminalreporter")
        reporter.write_line("Compiling the kernels that are not in the cache (100 s at first)")
        environment = {**os.environ, "PYTHONPATH": os.pathsep.join(filter(None, sys.path))}
        sections = list(kernel_table())
        commands = [[sys.executable, "-c", WARM_UP, *sections[k::2]] for k in range(2)]
        processes = [subprocess.Popen(command, env=environment) for command in commands]
        assert [process.wait() for process in processes] == [0, 0], "a kernel cannot be compiled"
        self.before = kernel_files()

    @pytest.hookimpl(optionalhook=True)
    def pytest_testnodedown(self, node):
        self.found.update(getattr(node, "workeroutput", {}).get("kernels", {}))

    @pytest.hookimpl(trylast=True)
    def pytest_sessionfinish(self, session):
        self.compiled = sorted(kernel_files() - self.before)
        if self.found:  # what only a process of a test has compiled is told, and is no failure yet
            session.exitstatus = pytest.ExitCode.TESTS_FAILED

    def pytest_terminal_summary(self, terminalreporter):
        say = terminalreporter.write_line
        if self.found:
            terminalreporter.section("kernels missing in apd_viewer/geometry/kernels.txt", red=True)
        for called, test in sorted(self.found.items()):
            say(f"{called}\n    by {test}")
        if self.compiled:
            terminalreporter.section("kernels compiled by this run", red=True)
        for file in self.compiled:
            say(str(file))


def kernel_files():
    """Names of the compiled kernels."""
    return {path.relative_to(PACKAGE) for path in PACKAGE.rglob("*.nbc")}
