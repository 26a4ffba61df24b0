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
from apd_viewer.geometry.warmup import kernel_of, kernel_table

PACKAGE = Path(geometry.__file__).parents[1]
# Kernels that tests call directly, or with types that nothing else calls them with.
ROWS = Path(__file__).with_name("kernels.txt").read_text(encoding="utf-8").splitlines()[1:]
PROCESSES = 2


def pytest_configure(config):
    if hasattr(config, "workerinput"):
        config.pluginmanager.register(Watch(config.workeroutput))
    elif config.getoption("numprocesses", None):
        config.pluginmanager.register(Judge())


class Watch(event.Listener):
    """Notes in a worker which kernels are called that are not in the table, and by which test.

    Those that have to be compiled are apart from those that a file is found of: an earlier run may have made
    it, or a kernel around it that is in the table.
    """

    def __init__(self, output):
        self.compiled = output["compiled"] = {}
        self.loaded = output["loaded"] = {}
        self.compiling = 0
        self.known = set(all_rows())
        event.register("numba:compile", self)
        load = KernelCache.load_overload

        def noted(cache, types, target):
            kernel = load(cache, types, target)
            self.note(cache, types, self.compiled if kernel is None else self.loaded)
            return kernel

        KernelCache.load_overload = noted

    def note(self, cache, types, found):
        """Note a kernel that is no part of another."""
        if self.compiling or not cache.function.__module__.startswith(geometry.__name__):
            return
        called = row(cache.function, types)
        if called not in self.known:
            found.setdefault(called, os.environ.get("PYTEST_CURRENT_TEST", "").partition(" ")[0])

    def on_start(self, _):
        self.compiling += 1

    def on_end(self, _):
        self.compiling -= 1


class Judge:
    """Has the kernels compiled before the workers start, and tells at the end what they compiled."""

    def __init__(self):
        self.compiled, self.loaded = {}, {}

    def pytest_sessionstart(self, session):
        reporter = session.config.pluginmanager.get_plugin("terminalreporter")
        reporter.write_line("Compiling the kernels that are not in the cache (about 2 minutes at first)")
        environment = {**os.environ, "PYTHONPATH": os.pathsep.join(filter(None, sys.path))}
        commands = [[sys.executable, __file__, str(k)] for k in range(PROCESSES)]
        processes = [subprocess.Popen(command, env=environment) for command in commands]
        assert [process.wait() for process in processes] == [0] * PROCESSES, "a kernel cannot be compiled"
        self.before = kernel_files()

    @pytest.hookimpl(optionalhook=True)
    def pytest_testnodedown(self, node):
        output = getattr(node, "workeroutput", {})
        self.compiled.update(output.get("compiled", {}))
        self.loaded.update(output.get("loaded", {}))

    @pytest.hookimpl(trylast=True)
    def pytest_sessionfinish(self, session):
        self.files = sorted(kernel_files() - self.before)
        if self.compiled or self.files:
            session.exitstatus = pytest.ExitCode.TESTS_FAILED

    def pytest_terminal_summary(self, terminalreporter):
        say = terminalreporter.write_line
        if self.compiled or self.files:
            terminalreporter.section("compiled, as apd_viewer/geometry/kernels.txt lacks them", red=True)
        for called, test in sorted(self.compiled.items()):
            say(f"{called}\n    by {test}")
        for file in self.files:  # of kernels within those too, and of what a process of a test has compiled
            say(str(file))
        if self.loaded:
            terminalreporter.section("loaded, though apd_viewer/geometry/kernels.txt lacks them")
        for called, test in sorted(self.loaded.items()):
            say(f"{called}\n    by {test}")


def all_rows():
    """Rows of the table of the program, then those of the tests."""
    return [*(each for rows in kernel_table().values() for each in rows), *ROWS]


def kernel_files():
    """Names of the compiled kernels."""
    return {path.relative_to(PACKAGE) for path in PACKAGE.rglob("*.nbc")}


if __name__ == "__main__":
    for each in all_rows()[int(sys.argv[1]) :: PROCESSES]:
        kernel, arguments = kernel_of(each)
        kernel.compile(arguments)
