"""Shapes handed from process to process: whole, whatever order the processor stores in."""

import inspect
import re
import subprocess
import sys

import numpy as np
import pytest
from llvmlite import binding as llvm
from numba import njit

from apd_viewer.geometry.linalg import atomic_access
from apd_viewer.session.processes import shared_memory
from apd_viewer.session.processes.shared_memory import SharedShapeBuffer

# Puts shapes of one number each, as soon as the last one has been copied.
WRITER = """
import sys
import numpy as np
from apd_viewer.session.processes.shared_memory import SharedShapeBuffer, untrack_shared_memory
untrack_shared_memory()
name, n, times = sys.argv[1], int(sys.argv[2]), int(sys.argv[3])
tray = SharedShapeBuffer(n, name)
for k in range(1, times + 1):
    while not tray.is_free:
        pass
    tray.write_shape(np.full((n, 3), float(k)))
"""


@pytest.mark.parametrize("times", [5_000, pytest.param(20_000, marks=pytest.mark.night)])
def test_shared_shape_buffer_hands_shapes_over_whole(times):
    """The litmus test of message passing, both ways: no torn shape, no message but the counters."""
    n = 50
    tray = SharedShapeBuffer(n)
    command = [sys.executable, "-c", WRITER, tray.name, str(n), str(times)]
    with subprocess.Popen(command) as writer:
        for k in range(1, times + 1):
            U = tray.take_shape(k)
            assert np.ptp(U) == 0.0
            assert U[0, 0] == k
        assert writer.wait(60) == 0


def test_atomic_access_loads_counters_with_acquire_and_stores_with_release():
    load, store = compiled()
    assert re.search(r"load atomic i64, .* acquire, align 8", load)
    assert re.search(r"store atomic i64 .* release, align 8", store)


def test_atomic_access_becomes_the_instructions_that_order_memory_on_arm():
    """What the compiler makes of them for Apple silicon, here or wherever the test runs."""
    llvm.initialize_all_targets()
    llvm.initialize_all_asmprinters()
    load, store = (assembly(code, "arm64-apple-darwin") for code in compiled())
    assert re.search(r"\bldap?r\b", load)
    assert re.search(r"\bstlr\b", store)


def test_shared_counters_are_accessed_through_their_class_alone():
    source = inspect.getsource(shared_memory)
    assert len(re.findall(r"_view\(.*np\.int64", source)) == 1
    assert re.search(r"SharedCounters\(_view\(.*np\.int64", source), "nothing else has a view of them"
    assert len(re.findall(r".*_places\b.*", source)) == 1, "kept alive, and nothing else"


def compiled() -> list[str]:
    """The intermediate code of a load and a store."""
    place = np.zeros(1, np.int64)
    # Compiled anew: what comes from the cache has no such code any more.
    load, store = (njit(code.py_func) for code in (atomic_access.load_acquire, atomic_access.store_release))
    store(place.ctypes.data, 7)
    assert load(place.ctypes.data) == place[0] == 7
    return [next(iter(function.inspect_llvm().values())) for function in (load, store)]


def assembly(code: str, triple: str) -> str:
    module = llvm.parse_assembly(code)
    module.triple = triple
    machine = llvm.Target.from_triple(triple).create_target_machine()
    module.data_layout = str(machine.target_data)
    return machine.emit_assembly(module)
