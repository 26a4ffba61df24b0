"""The solver's compilation of kernels, alone and beside other processes."""

import os
import subprocess
import sys
import time

import pytest
from meshes import tube

from apd_viewer.geometry.mesh.mesh import Mesh
from apd_viewer.session.model.state import initial_state
from apd_viewer.session.processes import compilation, solver_main
from apd_viewer.session.processes.child_process import START_SCRIPT, ChildProcess
from apd_viewer.session.processes.compilation import Compilation
from apd_viewer.session.processes.request_and_reply import Request, RequestStage
from apd_viewer.session.processes.solver_worker import SolverWorker

TOLD = """
from apd_viewer.geometry.warmup import kernel_table, report_compilations, warm_up
from numba import njit

told = []
stop = report_compilations(told.append)
plain = njit(lambda x: x + 1)
plain(1)
plain(2)
assert told == [0.0], told
warm_up("plots")
plain(1.0)
share = len(kernel_table()["plots"]) / sum(map(len, kernel_table().values()))
assert told[-1] == share, told
stop()
plain(1j)
assert told[-1] == share and len(told) < 10, told
"""


def test_report_compilations_tells_every_compilation_and_no_call():
    environment = {**os.environ, "PYTHONPATH": os.pathsep.join(filter(None, sys.path))}
    subprocess.run([sys.executable, "-c", TOLD], check=True, env=environment, timeout=60)


def test_compilation_tells_all_last_and_once(monkeypatch):
    told, stopped = [], []

    def listening(tell):
        monkeypatch.setattr(compilation, "warm_up", lambda **_: [tell(share) for share in (0.5, 1.0, 1.0)])
        return lambda: stopped.append(len(told))

    monkeypatch.setattr(compilation, "report_compilations", listening)
    Compilation(lambda message: told.append(message.fraction)).run(lambda: False)
    assert told[0] == 0.5
    assert [share == 1.0 for share in told] == [False, False, False, True]
    assert stopped == [3]


def test_solver_main_is_not_silent_while_it_compiles(monkeypatch):
    monkeypatch.setattr(solver_main, "BEAT", 0.2)
    told, (source, end) = [], os.pipe()

    def work_until_something_is_told(_):
        late = time.monotonic() + 30.0
        while not told and time.monotonic() < late:
            pass
        os.close(end)

    with os.fdopen(source, "rb") as orders:
        solver_main.serve(orders, told.append, when_idle=work_until_something_is_told)
    assert told[0].stage is RequestStage.UNDER_WAY


@pytest.mark.usefixtures("process")
def test_compilation_tells_that_it_is_done_with_all_kernels_in_the_cache():
    worker = SolverWorker(lambda: None)
    try:
        state = initial_state(Mesh(*tube(8, 8)))
        worker.put_request(Request(state.document, 0, state.frame.U, iterate=False))
        end = time.monotonic() + 120.0
        while worker.compiled_fraction != 1.0 and time.monotonic() < end:
            time.sleep(0.05)
        assert worker.compiled_fraction == 1.0
    finally:
        worker.close()


def test_compilation_compiles_a_part_in_another_process():
    process = ChildProcess("compiler", START_SCRIPT.format(module="processes.compilation"))
    process.start()
    try:
        assert process.send_messages(b"factor")
        assert process.receive_message() == b""
    finally:
        process.end()
