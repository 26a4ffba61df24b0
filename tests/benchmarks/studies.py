"""Measure studies: overhead, memory, resumption, kills, and the efficiency of two workers.

    python tests/benchmarks/studies.py simulated [--cases 10000] [--pool local|tcp] [--seconds 0.02]
    python tests/benchmarks/studies.py bottles [--cases 400] [--pool local|tcp] [--workers 1 2]
    python tests/benchmarks/studies.py kills [--kills 30] [--pool local|tcp]
    python tests/benchmarks/studies.py bits

``simulated`` replaces the solver by a sleep and a result of the size of the sample bottle's; ``bottles`` runs
the sample bottle of 13,000 vertices; ``kills`` ends workers, scheduler and client at random and compares what
the resumed study found, bit for bit, with an undisturbed one. ``bits`` compares two cases by two, one and
eight processes, and the files of deform and sweep with 1, 2 and 4 threads. "tcp" starts a
scheduler and workers of Dask by their own commands, without any setting.
"""

from __future__ import annotations

import argparse
import csv
import os
import random
import resource
import signal
import subprocess
import sys
import tempfile
import threading
import time
from contextlib import contextmanager, suppress
from pathlib import Path

import numpy as np

from apd_viewer.cases.case_file import CaseResult, case_path, case_to_bytes, read_case
from apd_viewer.cases.case_worker import CaseAnswer, CaseTask, compile_kernels_once
from apd_viewer.cases.cluster import connect_cluster
from apd_viewer.cases.local_pool import LocalPool
from apd_viewer.cases.results import read_results
from apd_viewer.cases.study import Study

RESOURCES = Path(__file__).parents[2] / "resources"
VERTICES = 13_068
DASK = [sys.executable, "-m", "dask"]
PORT = 28_786


class Simulated:
    """Work of a worker that sleeps and returns a result of the real size."""

    def __init__(self, seconds):
        self.seconds = seconds

    def __call__(self, task):
        time.sleep(self.seconds)
        U = np.random.default_rng(0).normal(size=(VERTICES, 3))
        readings = dict.fromkeys((f"reading_{k}" for k in range(20)), 1.0 / 3.0)
        curves = {f"curve_{k}": [1.0 / 3.0] * 11 for k in range(12)}
        return CaseAnswer(
            case_to_bytes(CaseResult(task.case.key, task.case.to_json, "done", "", readings, curves, {}, U))
        )


def design(folder, cases, *more, mesh="bottle"):
    """Write the plan of a study, and return its path."""
    plan = folder / "plan.csv"
    words = [
        "--mesh",
        RESOURCES / f"{mesh}.obj",
        "--selection",
        RESOURCES / f"{mesh}.sel",
        "--samples",
        cases,
    ]
    words += ["--vary", "twist=10..170deg", "--vary", "push=1..40%", *more, "-o", plan]
    subprocess.run(
        [sys.executable, "-m", "apd_viewer", "study", "design", *map(str, words)],
        check=True,
        stdout=subprocess.DEVNULL,
    )
    return plan


QUIET = {"stdout": subprocess.DEVNULL, "stderr": subprocess.DEVNULL, "cwd": RESOURCES.parent}


def begun(workers, port=PORT):
    """A scheduler and workers, each a process, as somebody starts them by hand."""
    worker = [*DASK, "worker", f"tcp://127.0.0.1:{port}", "--nthreads", "1", "--no-dashboard"]
    words = ["scheduler", "--host", "127.0.0.1", "--port", str(port), "--no-dashboard"]
    return [subprocess.Popen(each, **QUIET) for each in ([*DASK, *words], *[worker] * workers)]


def stop(started):
    """End them, the scheduler last."""
    for process in started[::-1]:
        process.terminate()
    for process in started:
        process.wait()


@contextmanager
def dask(workers, port=PORT):
    """A scheduler and workers while they are needed; yields the address and their processes."""
    started = begun(workers, port)
    try:
        yield f"tcp://127.0.0.1:{port}", started
    finally:
        stop(started)


@contextmanager
def engine(pool, workers, work=None):
    """An engine of so many workers."""
    given = {} if work is None else {"work": work}
    if pool == "local":
        found = LocalPool(workers, **given)
        try:
            yield found
        finally:
            found.close(at_once=True)  # so that the time of the processes is counted
        return
    with dask(workers) as (address, _):
        found = connect_cluster(address, None, **given)
        while found.free_slot_count() < 2 * workers:
            time.sleep(0.1)
        try:
            yield found
        finally:
            found.close(at_once=False)


def memory_of(pid):
    """Resident memory of a process, MiB."""
    status = Path(f"/proc/{pid}/status").read_text()
    return int(next(line for line in status.splitlines() if line.startswith("VmRSS")).split()[1]) / 1024


def children_of(pid):
    """Processes below a process."""
    found = []
    for task in Path(f"/proc/{pid}/task").glob("*/children"):
        for child in task.read_text().split():
            found += [int(child), *children_of(child)]
    return found


def simulated(options):
    with tempfile.TemporaryDirectory() as folder:
        folder = Path(folder)
        plan = design(folder, options.cases)
        study = Study(plan, folder / "out")
        sizes, work = [], Simulated(options.seconds)

        def told(now):
            if not sizes or now.finished >= sizes[-1][0] + options.cases // 10:
                sizes.append((now.finished, memory_of(os.getpid())))

        workers = options.workers[-1]
        with engine(options.pool, workers, work) as pool:
            pool.start(next(iter(CaseTask(case) for case in study.unfinished_cases.values()))).result()
            started, before = time.perf_counter(), time.process_time()
            study.run(pool, on_progress=told)
            wall, own = time.perf_counter() - started, time.process_time() - before
        study.close()
        over = (wall - options.cases * options.seconds / workers) / options.cases
        print(f"{options.cases} simulated cases, {options.pool}, {workers} workers: {wall:.1f} s")
        print(f"  overhead {1e3 * over:.2f} ms a case, {1e3 * own / options.cases:.2f} by the client")
        print("  memory of the client, MiB:", ", ".join(f"{done}: {size:.0f}" for done, size in sizes))
        last = Study(plan, folder / "out")
        key = list(last.plan.cases)[-1]
        last.close()
        case_path(folder / "out", key).unlink()
        started = time.perf_counter()
        study = Study(plan, folder / "out")
        with engine("local", 1, work) as pool:
            study.run(
                pool,
                on_progress=lambda now: (
                    now.running and print(f"  resumed after {time.perf_counter() - started:.1f} s")
                ),
            )
        study.close()


class Memory:
    """Resident memory of the largest process below this one, least and most in each block of 50 cases.

    At a single moment it is that of a case in its midst; so it is looked at all the time.
    """

    def __init__(self):
        self.blocks, self.done, self.over = {}, 0, False
        self._thread = threading.Thread(target=self._watch, daemon=True)

    def _watch(self):
        while not self.over:
            with suppress(OSError, StopIteration):  # a process has ended meanwhile
                found = max(map(memory_of, children_of(os.getpid())), default=0.0)
                low, high = self.blocks.get(self.done // 50, (found, found))
                self.blocks[self.done // 50] = min(low, found), max(high, found)
            time.sleep(0.2)

    def __enter__(self):
        self._thread.start()
        return self

    def __exit__(self, *_):
        self.over = True
        self._thread.join()

    def tell(self, now):
        """Note how many cases are done."""
        self.done = now.finished


def bottles(options):
    """Wall time by numbers of workers in turns, and memory of the workers; kernels are compiled before."""
    compile_kernels_once()
    for workers in options.workers:
        with tempfile.TemporaryDirectory() as folder:
            folder = Path(folder)
            plan = design(folder, options.cases, "--set", "steps=2", "--set", "iterations=60")
            study = Study(plan, folder / "out")
            with engine(options.pool, workers) as pool, Memory() as memory:
                before = resource.getrusage(resource.RUSAGE_CHILDREN)
                started = time.perf_counter()
                table = study.run(pool, on_progress=memory.tell)
                wall = time.perf_counter() - started
            own = sum(row.readings["seconds"] for row in table.rows)
            study.close()
            after = resource.getrusage(resource.RUSAGE_CHILDREN)
            spent = after.ru_utime + after.ru_stime - before.ru_utime - before.ru_stime
            print(
                f"{options.cases} bottles, {options.pool}, {workers} workers: {wall:.1f} s by the clock",
                flush=True,
            )
            print(f"  {own:.1f} s in the cases, {spent:.1f} s of the processors by all processes")
            said = ", ".join(
                f"from {50 * k}: {low:.0f} to {high:.0f}" for k, (low, high) in memory.blocks.items()
            )
            print(f"  memory of the largest process, MiB: {said}", flush=True)


class Killed:
    """A study that runs by its command and is killed now and then."""

    def __init__(self, plan, out, pool, chance):
        self.plan, self.out, self.pool, self.chance = plan, out, pool, chance

    def run(self, words, kills, started=()):
        """Run it until it has ended by itself; return how often something was killed."""
        done, killed, redone = {}, 0, 0
        while True:
            client = subprocess.Popen(
                [sys.executable, "-m", "apd_viewer", "study", str(self.plan), "-o", str(self.out), *words],
                stdout=subprocess.DEVNULL,
                stderr=subprocess.DEVNULL,
                cwd=RESOURCES.parent,
            )
            while client.poll() is None:
                time.sleep(self.chance.uniform(0.5, 4.0))
                if killed < kills and client.poll() is None:
                    self._kill(client, started)
                    killed += 1
            now = self._files()
            redone += sum(now.get(name) != when for name, when in done.items())
            done = now
            if client.returncode == 0:
                return killed, redone

    def _kill(self, client, started):
        """Kill the client, a worker or the scheduler; another scheduler takes its place."""
        workers = (
            children_of(client.pid)
            if self.pool == "local"
            else [pid for each in started[1:] for pid in children_of(each.pid)]
        )
        targets = [client.pid, *workers[-2:], *(each.pid for each in started[:1])]
        target = self.chance.choice(targets)
        os.kill(target, signal.SIGKILL)
        if started and target == started[0].pid:
            # Its workers end with it.
            stop(started)
            started[:] = begun(len(started) - 1)

    def _files(self):
        return {path.name: path.stat().st_mtime_ns for path in self.out.glob("cases/*/*.case")}


def alike(one, other):
    """Whether two studies found the same, bit for bit, but for the time."""
    tables = read_results(one), read_results(other)
    for a, b in zip(*(table.rows for table in tables), strict=True):
        x, y = read_case(one, a.key, with_shape=True), read_case(other, b.key, with_shape=True)
        if {**a.readings, "seconds": 0} != {**b.readings, "seconds": 0} or x.curves != y.curves:
            return False
        if a.status != "done" or not np.array_equal(x.U, y.U):
            return False
    return True


def kills(options):
    chance, left = random.Random(0), options.kills
    with tempfile.TemporaryDirectory() as folder:
        folder = Path(folder)
        plan = design(folder, options.cases, "--set", "steps=1", "--set", "iterations=30")
        whole = Killed(plan, folder / "whole", "local", chance)
        whole.run(["--processes", "2"], 0)
        rounds = 0
        while left > 0:
            rounds += 1
            out = folder / f"killed-{rounds}"
            if options.pool == "local":
                killed, redone = Killed(plan, out, "local", chance).run(["--processes", "2"], left)
            else:
                with dask(2) as (address, started):
                    killed, redone = Killed(plan, out, "tcp", chance).run(
                        ["--scheduler", address], left, started
                    )
            left -= killed
            with (out / "results.csv").open(encoding="utf-8") as stream:
                rows = len(list(csv.DictReader(stream)))
            same = alike(folder / "whole", out)
            print(
                f"round {rounds}: {killed} kills, {rows} rows of {options.cases}, {redone} finished cases "
                f"computed again, results {'equal' if same else 'DIFFERENT'}",
                flush=True,
            )


def bits(_):
    with tempfile.TemporaryDirectory() as folder:
        folder = Path(folder)
        plan = design(folder, 2, "--set", "steps=2", "--set", "iterations=60")
        runs = {f"by {count} processes": ["--processes", str(count)] for count in (2, 1, 8)}
        for name, words in runs.items():
            command = [
                sys.executable,
                "-m",
                "apd_viewer",
                "study",
                str(plan),
                "-o",
                str(folder / name),
                *words,
            ]
            subprocess.run(command, check=True, **QUIET)
            same = alike(folder / next(iter(runs)), folder / name)
            print(f"{name}: {'equal' if same else 'DIFFERENT'}", flush=True)
        for command, out in (
            (["deform", "--report", folder / "report.json", "-o"], folder / "bottle.obj"),
            (["sweep", "--steps", "2", "--methods", "exact", "--meshes", "-o"], folder / "sweep"),
        ):
            words = [RESOURCES / "bottle.obj", "--selection", RESOURCES / "bottle.sel", "--twist", "120deg"]
            found = []
            for threads in (1, 2, 4):
                given = [sys.executable, "-m", "apd_viewer", command[0], *words, *command[1:], out]
                environment = {**os.environ, "NUMBA_NUM_THREADS": str(threads)}
                subprocess.run(list(map(str, given)), check=True, env=environment, **QUIET)
                files = [out] if out.is_file() else sorted(out.rglob("*.obj")) + [out / "sweep.csv"]
                found.append([path.read_bytes() for path in files])
            same = found[0] == found[1] == found[2]
            print(f"{command[0]} with 1, 2 and 4 threads: {'equal' if same else 'DIFFERENT'}", flush=True)


def main():
    parser = argparse.ArgumentParser(description=__doc__.partition("\n")[0])
    parser.add_argument("what", choices=("simulated", "bottles", "kills", "bits"))
    parser.add_argument("--cases", type=int, default=400)
    parser.add_argument("--pool", choices=("local", "tcp"), default="local")
    parser.add_argument("--workers", type=int, nargs="+", default=[1, 2])
    parser.add_argument("--seconds", type=float, default=0.02)
    parser.add_argument("--kills", type=int, default=30)
    options = parser.parse_args()
    {"simulated": simulated, "bottles": bottles, "kills": kills, "bits": bits}[options.what](options)


if __name__ == "__main__":
    main()
