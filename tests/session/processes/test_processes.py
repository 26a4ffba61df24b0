"""What memory processes keep."""

import ctypes
import subprocess
import sys

import pytest
from driven_session import BENT

from apd_viewer.session.processes import request_solver

# More than glibc keeps by itself, in pieces that it does not map one by one.
CHURN = """
import resource, sys
import numpy as np
from apd_viewer.session.processes.freed_memory import keep_freed_memory
if sys.argv[1] == "keep":
    keep_freed_memory()
def frame():
    arrays = [np.ones(1 << 19) for _ in range(16)]
for _ in range(3):
    frame()
before = resource.getrusage(resource.RUSAGE_SELF).ru_minflt
for _ in range(10):
    frame()
print(resource.getrusage(resource.RUSAGE_SELF).ru_minflt - before)
"""
GLIBC = sys.platform.startswith("linux") and hasattr(ctypes.CDLL(None), "mallopt")


def faults(way):
    """How many pages the system had to give while much was freed and needed again."""
    done = subprocess.run([sys.executable, "-c", CHURN, way], capture_output=True, text=True, check=True)
    return int(done.stdout)


@pytest.mark.skipif(not GLIBC, reason="other C libraries have no such setting")
def test_keep_freed_memory_leaves_what_is_freed_there_for_the_next_frame():
    assert faults("keep") < 100
    assert faults("leave") > 10_000, "it is not this that glibc does by itself"


ARENAS = """
import ctypes, sys, threading
from apd_viewer.session.processes.freed_memory import share_freed_memory
if sys.argv[1] == "share":
    share_freed_memory()
libc = ctypes.CDLL(None)
libc.malloc.restype = libc.fopen.restype = ctypes.c_void_p
threads = [threading.Thread(target=lambda: libc.malloc(ctypes.c_size_t(1000))) for _ in range(3)]
for thread in threads:
    thread.start()
for thread in threads:
    thread.join()
file = ctypes.c_void_p(libc.fopen(sys.argv[2].encode(), b"w"))
libc.malloc_info(0, file)
libc.fclose(file)
"""


@pytest.mark.skipif(not GLIBC, reason="other C libraries have no such setting")
@pytest.mark.parametrize(("way", "is_shared"), [("share", True), ("leave", False)])
def test_share_freed_memory_gives_all_threads_one_arena(way, is_shared, tmp_path):
    file = tmp_path / "arenas.xml"
    subprocess.run([sys.executable, "-c", ARENAS, way, str(file)], check=True)
    assert (file.read_text().count("<heap nr=") == 1) == is_shared


GIVEN_BACK = """
import numpy as np
from apd_viewer.session.processes.freed_memory import release_freed_memory, keep_freed_memory
def resident():
    with open("/proc/self/statm") as stream:
        return int(stream.read().split()[1]) * 4096
keep_freed_memory()
arrays = [np.ones(1 << 19) for _ in range(16)]
del arrays
kept = resident()
release_freed_memory()
print(kept - resident())
"""


@pytest.mark.skipif(not GLIBC, reason="needs glibc")
def test_release_freed_memory_gives_kept_memory_back():
    done = subprocess.run([sys.executable, "-c", GIVEN_BACK], capture_output=True, text=True, check=True)
    assert int(done.stdout) >= 15 * (1 << 22), "the arrays have 64 MiB"


def test_request_solver_gives_freed_memory_back_in_a_pause(session, monkeypatch):
    given = []
    monkeypatch.setattr(request_solver, "PAUSE", 1.0)
    monkeypatch.setattr(request_solver, "release_freed_memory", lambda: given.append("all"))
    session.drag(BENT)
    session.settle()
    assert not given, "the frames of the next gesture can use it"
    session.until(lambda: given)
