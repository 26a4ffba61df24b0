"""A scheduler of Dask and its workers as somebody starts them by hand, without any setting."""

import json
import os
import subprocess
import sys
import time
from contextlib import contextmanager
from pathlib import Path

ROOT = Path(__file__).parents[2]
SUPPORT = ROOT / "tests" / "support"
_PATIENCE, _GRACE = 60.0, 20.0  # s


@contextmanager
def dask_cluster(folder, workers):
    """Run them on the loopback; yields the file that the scheduler writes."""
    file = folder / "scheduler.json"
    environment = {
        **os.environ,
        "PYTHONPATH": os.pathsep.join(map(str, (ROOT, SUPPORT))),
        "DEADLY_ONCE": str(folder / "once"),
    }
    quiet = {"env": environment, "cwd": folder, "stdout": subprocess.DEVNULL, "stderr": subprocess.DEVNULL}
    dask = [sys.executable, "-m", "dask"]
    words = ["--host", "127.0.0.1", "--port", "0", "--no-dashboard", "--scheduler-file", file]
    started = [subprocess.Popen([*dask, "scheduler", *map(str, words)], **quiet)]
    worker = [*dask, "worker", "--scheduler-file", str(file), "--nthreads", "1", "--no-dashboard"]
    started += [subprocess.Popen(worker, **quiet) for _ in range(workers)]
    try:
        end = time.monotonic() + _PATIENCE
        while not file.exists() and time.monotonic() < end:
            time.sleep(0.1)
        yield file
    finally:
        for process in started[::-1]:
            process.terminate()
        for process in started[::-1]:
            _end(process)


def _end(process):
    """Wait for the end of a process, which Dask delays where a connection has died meanwhile."""
    try:
        process.wait(_GRACE)
    except subprocess.TimeoutExpired:
        process.kill()
        process.wait()


def address_in(file):
    """Address of a scheduler, by the file that it has written."""
    return json.loads(file.read_text(encoding="utf-8"))["address"]
