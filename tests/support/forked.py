"""Child processes that are forks of one which has imported what they need.

A process of the program takes a second of the processor for its libraries, and another for kernels that few
tests need. What tests do to it, kill it or have it do something else first, is the same for a fork. That it
starts at all is tested with real ones, and elsewhere than on Linux all are real.
"""

import atexit
import contextlib
import os
import signal
import socket
import subprocess
import sys
import textwrap
import threading
import time
from functools import cache

from apd_viewer.session.processes.child_process import ChildProcess

MAIN = "main(replies)\n"  # the end of what a child process runs
LINUX = sys.platform.startswith("linux")
NURSERY = """
import os, signal, socket, sys, traceback
sys.path[:] = sys.argv[2:]
from apd_viewer.session.processes import factor_main, geodesic_main, shape_check_main, solver_main
from apd_viewer.session.processes.compilation import Compilation
from apd_viewer.geometry.warmup import kernel_of, kernel_table
for section in ("drag", "contact", "factor", "methods"):
    for kernel, types in map(kernel_of, kernel_table()[section]):
        if not kernel.targetoptions.get("parallel"):  # those begin threads, which a fork does not have
            kernel.compile(types)
Compilation.run = lambda *_: None
line = socket.socket(fileno=int(sys.argv[1]))

def reap(*_):
    try:
        while os.waitpid(-1, os.WNOHANG)[0]:
            pass
    except ChildProcessError:
        pass

signal.signal(signal.SIGCHLD, reap)  # nobody asks how a child has ended
sys.argv[1:] = [str(os.getpid()), *sys.path]
line.send(b"ready")
while True:
    script, ends, *_ = socket.recv_fds(line, 1 << 16, 3)
    if not script:
        break
    child = os.fork()
    if not child:
        signal.signal(signal.SIGCHLD, signal.SIG_DFL)
        line.close()
        for number, end in enumerate(ends):
            os.dup2(end, number)
            os.close(end)
        try:
            exec(script, {"__name__": "__main__"})
        except Exception:
            traceback.print_exc()
        finally:
            os._exit(0)
    for end in ends:
        os.close(end)
    line.send(b"%d" % child)
"""


class Nursery:
    """A process that forks, and ends with this one."""

    def __init__(self) -> None:
        self.line, theirs = socket.socketpair()
        self.one_at_a_time = threading.Lock()
        with theirs:
            ignoring = [sys.executable, "-W", "ignore::DeprecationWarning"]  # that there are other threads
            call = [*ignoring, "-c", NURSERY, str(theirs.fileno()), *sys.path]
            self.process = subprocess.Popen(call, pass_fds=[theirs.fileno()], stdin=subprocess.DEVNULL)
        assert self.line.recv(32) == b"ready"
        atexit.register(self.close)

    def fork(self, script: str, *ends: int) -> int:
        """Number of a new process that runs ``script`` between such ends of pipes."""
        with self.one_at_a_time:
            socket.send_fds(self.line, [script.encode()], ends)
            return int(self.line.recv(32))

    def close(self) -> None:
        """End it, without a look at its children."""
        self.line.close()
        self.process.wait()


nursery = cache(Nursery)


class Forked(ChildProcess):
    """A child process that has nothing to import."""

    def _spawn(self) -> "Fork":
        return Fork(self._script)


class Fork:
    """What a ChildProcess needs of a process."""

    def __init__(self, script: str) -> None:
        (source, stdin), (stdout, sink), (stderr, errors) = (os.pipe() for _ in range(3))
        self.pid = nursery().fork(script, source, sink, errors)
        for end in (source, sink, errors):
            os.close(end)
        self.stdin, self.stdout = os.fdopen(stdin, "wb"), os.fdopen(stdout, "rb")
        self.stderr = os.fdopen(stderr, "rb")

    @property
    def lives(self) -> bool:
        """False as soon as the process is gone."""
        with contextlib.suppress(ProcessLookupError):
            os.kill(self.pid, 0)
            return True
        return False

    def kill(self) -> None:
        """End it at once."""
        with contextlib.suppress(ProcessLookupError):
            os.kill(self.pid, signal.SIGKILL)

    def wait(self, timeout: float = 10.0) -> int:
        """Wait until it has ended."""
        end = time.monotonic() + timeout
        while self.lives:
            if time.monotonic() > end:
                raise subprocess.TimeoutExpired("fork", timeout)
            time.sleep(0.001)
        return 0


def prepare() -> None:
    """Import everything, so that no test has to wait for it."""
    if LINUX:
        nursery()


Quick = Forked if LINUX else ChildProcess


def altered(code: str) -> type[ChildProcess]:
    """Child processes that do something else before they serve."""

    class Altered(Quick):
        def __init__(self, title: str, script: str) -> None:
            assert script.endswith(MAIN)
            super().__init__(title, script.removesuffix(MAIN) + textwrap.dedent(code) + MAIN)

    return Altered
