"""What is compiled behind the first picture is given up with the window."""

import time

from numba import njit

from apd_viewer.geometry import warmup
from apd_viewer.session.processes.compilation import CompilerProcesses
from apd_viewer.ui.background_imports import BackgroundImports


def test_background_imports_join_waits_for_no_more_than_the_kernel_being_compiled(qtbot, monkeypatch):
    compiled, others = [], []

    def compile_many(*_, is_cancelled):
        for _ in range(200):
            if is_cancelled():
                break
            njit(lambda x: x + 1)(1)
            compiled.append(time.monotonic())

    monkeypatch.setattr(warmup, "warm_up", compile_many)
    monkeypatch.setattr(CompilerProcesses, "start", lambda _: others.append("started"))
    monkeypatch.setattr(CompilerProcesses, "end", lambda _: others.append("ended"))
    imports = BackgroundImports()
    imports.begin()
    qtbot.waitUntil(lambda: len(compiled) > 1 and bool(others), timeout=60_000)
    left = time.monotonic()
    imports.join()
    assert len([when for when in compiled if when > left]) <= 1
    assert imports.error is None
    assert others[-1] == "ended"
