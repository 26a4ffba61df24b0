"""Ctrl+C at random moments: what becomes of commands, deformations and kernels.

    python tests/benchmarks/interrupts.py [deform] [press] [study] [steps] [kernel] [--count N] [--seed 1]

Each part is tried 200 times, the kernel 1,000 times. Commands run in processes that have everything imported,
so that the moments fall into their work; every second run is of the sample bottle, the others of a bar, whose
runs are short, so that some moments fall on their end. A count is printed for each way to end; none should be
"BROKEN". At the end a fixed case is to give the same bits as before.
"""

import argparse
import contextlib
import hashlib
import os
import signal
import sys
import tempfile
import threading
import time
from collections import Counter
from pathlib import Path

import numpy as np

sys.path.insert(0, str(Path(__file__).parents[1] / "support"))
from meshes import box, rotation

import apd_viewer
from apd_viewer.__main__ import main
from apd_viewer.commands import parsers  # noqa: F401  # imported before the first moment
from apd_viewer.geometry.contact.pair_search import PairSearch
from apd_viewer.geometry.contact.patches import Patches

PARTS = ["deform", "press", "study", "steps", "kernel"]
RESOURCES = Path(__file__).parents[2] / "resources"
LONGEST = 60.0  # s that a process may take to end
LATEST = {"bottle.obj": 5.0, "bar.obj": 2.5}  # s, of the moments
INTERRUPTED = "interrupted; no file is left unfinished\n"


def run(words, moments, folder):
    """Status, output and errors of a command that gets a Ctrl+C at each of the moments, in seconds."""
    sys.stdout.flush()
    process = os.fork()
    if process == 0:
        os.setpgid(0, 0)
        for stream, name in ((1, "out"), (2, "err")):
            os.dup2(os.open(folder / name, os.O_WRONLY | os.O_CREAT | os.O_TRUNC), stream)
        status = 99
        try:
            status = main([str(word) for word in words])
        except SystemExit as end:
            status = end.code
        finally:
            sys.stdout.flush()
            os._exit(status)
    with contextlib.suppress(PermissionError):  # done by itself
        os.setpgid(process, process)
    begun, left, ended = time.monotonic(), list(moments), 0
    while not ended:
        passed = time.monotonic() - begun
        if left and passed > left[0]:
            os.killpg(process, signal.SIGINT)
            left.pop(0)
        if passed > LONGEST + sum(moments):
            os.killpg(process, signal.SIGKILL)
        ended, code = os.waitpid(process, os.WNOHANG)
        time.sleep(0.002)
    said = [(folder / name).read_text() for name in ("out", "err")]
    return os.waitstatus_to_exitcode(code), *said


def outcome(status, err, there, whole, names):
    """The way in which a command ended that writes a mesh."""
    scratch = sorted(name for name in names if ".part" in name)
    if scratch:
        return f"BROKEN: left {scratch}"
    if status == 130 and err == INTERRUPTED:
        return "interrupted" if there is None else "interrupted at its end, with a whole file"
    if status == 0 and there == whole:
        return "done before"
    return f"BROKEN: status {status}, {err.strip().splitlines()[-1:]}"


def digest(path):
    return hashlib.sha256(path.read_bytes()).hexdigest() if path.exists() else None


def commands(name, words, count, rng):
    """Run ``deform`` or ``press`` so many times."""
    tally, whole = Counter(), {}
    with tempfile.TemporaryDirectory() as made:
        folder, said = Path(made) / "results", Path(made) / "said"
        for trial in range(-2, count):
            folder.mkdir(parents=True, exist_ok=True)
            said.mkdir(exist_ok=True)
            out = folder / "out.obj"
            mesh = list(words)[trial % 2]
            moment = [] if trial < 0 else [rng.uniform(0.05, LATEST[mesh])]
            status, _, err = run([name, *words[mesh], "-o", out], moment, said)
            if trial < 0:
                whole[mesh] = digest(out)
                assert status == 0, err
            else:
                names = [path.name for path in folder.iterdir()]
                tally[outcome(status, err, digest(out), whole[mesh], names)] += 1
            out.unlink(missing_ok=True)
    return tally


def studies(plan, count, rng):
    """Run ``study`` so many times, with one Ctrl+C or two, and then to its end."""
    tally, whole = Counter(), None
    with tempfile.TemporaryDirectory() as made:
        for trial in range(-1, count):
            folder, said = Path(made) / f"results-{trial}", Path(made)
            words = ["study", plan, "-o", folder, "--processes", "1"]
            first = rng.uniform(0.05, 4.0)
            moments = [] if trial < 0 else [first, first + rng.uniform(0.0, 1.0)][: 1 + trial % 2]
            status, _, err = run(words, moments, said)
            if trial < 0:
                assert status == 0, err
                whole = curves(folder)
                continue
            ways = {0: "done before", 130: "interrupted"}
            way = ways.get(status, f"BROKEN: status {status}, {err.strip().splitlines()[-1:]}")
            if trial % 10 == 0:
                status, _, err = run(words, [], said)
                way += ", then the same" if (status, curves(folder)) == (0, whole) else ", BROKEN afterwards"
            tally[way] += 1
    return tally


def curves(folder):
    """Text of a study's curves."""
    return (folder / "curves.csv").read_text()


def twisted():
    """The bottle with contact, its neck to be turned far, as it is when it has been aimed."""
    mesh = apd_viewer.open_mesh(RESOURCES / "bottle.obj")
    base, neck = np.flatnonzero(mesh.V[:, 1] < 1.2), np.flatnonzero(mesh.V[:, 1] > 18.7)
    fixed = np.r_[base, neck]
    solver = apd_viewer.Deformation(mesh.V, mesh.F, fixed, handle=neck, contact=True)
    solver.aim(np.vstack([mesh.V[base], mesh.V[neck] @ rotation([0, 1, 0], 2.5).T]))
    return solver


def shape(iterations):
    """Digest of the fixed case."""
    solver = twisted()
    for _ in range(iterations):
        solver.iterate()
    return hashlib.sha256(solver.frame().U.tobytes()).hexdigest()


def interrupted(work, moment):
    """The way in which ``work``, repeated for at most 20 s, is interrupted at a moment."""
    timer = threading.Timer(moment, os.kill, (os.getpid(), signal.SIGINT))
    end = time.monotonic() + moment + 20.0
    try:
        timer.start()
        while time.monotonic() < end:
            work()
    except KeyboardInterrupt:
        return "KeyboardInterrupt"
    except BaseException as error:
        return f"BROKEN: {type(error).__name__}: {error}"[:90]
    finally:
        timer.join()
    return "BROKEN: swallowed"


def steps(count, rng):
    """Interrupt a deformation so many times, and go on with it; it is made anew every 20 times."""
    tally, most = Counter(), 0
    solver = twisted()
    for trial in range(count):
        if trial % 20 == 0:
            solver = twisted()
        tally[interrupted(solver.step, rng.uniform(0.001, 1.0))] += 1
        frame = solver.frame()
        if trial % 20 == 19:
            most = frame.iteration
            same = hashlib.sha256(frame.U.tobytes()).hexdigest() == shape(most)
            tally["20 times interrupted: the same bits" if same else "BROKEN: other bits"] += 1
    return tally


def kernels(count, rng):
    """Interrupt a loop of the kernel that lists near pairs."""
    mesh = apd_viewer.open_mesh(RESOURCES / "bottle.obj")
    V, F = mesh.V, mesh.F
    E = np.unique(np.sort(F[:, [0, 1, 1, 2, 2, 0]].reshape(-1, 2)), axis=0)
    patches = Patches(V, F, E)
    search = PairSearch(V, F, E, patches, np.zeros((0, len(V)), np.int64), 0.02)
    between = patches.near_pairs(patches.boxes(V), 0.05)[0][::20]
    beyond = np.full(len(between), 0.01)
    before = search.near_pairs(V, between, beyond)[0]
    work, tally = lambda: search.near_pairs(V, between, beyond), Counter()
    for _ in range(count):
        tally[interrupted(work, rng.uniform(0.0001, 0.05))] += 1
    same = all(map(np.array_equal, before, search.near_pairs(V, between, beyond)[0]))
    tally["the same bits afterwards" if same else "BROKEN: other bits"] += 1
    return tally


def bar_in(folder):
    """Words of commands for a bar in a folder."""
    V, F = box(3, 3, 10)
    mesh = apd_viewer.Mesh(V, F)
    apd_viewer.save_mesh(mesh, V, folder / "bar.obj")
    np.savetxt(folder / "bar.sel", np.where(V[:, 2] > 9.5, 2, np.where(V[:, 2] < 0.5, 1, 0)), fmt="%d")
    motions = "\n".join(f"bar.obj,bar.sel,twist {angle}deg,yes,4" for angle in (40, 80))
    (folder / "plan.csv").write_text(f"mesh,selection,motion,contact,steps\n{motions}\n")
    return folder / "bar.obj", "--selection", folder / "bar.sel"


def say(name, tally):
    """Print the ways to end of a part."""
    print(f"{name}:", flush=True)
    for way, count in tally.most_common():
        print(f"  {count:5d}  {way}", flush=True)


def commands_tried(parts, count, rng, folder):
    """Try those commands that are among the parts."""
    bar = bar_in(folder)
    bottle = RESOURCES / "bottle.obj", "--selection", RESOURCES / "bottle.sel"
    twist, down = ("--twist", "60deg", "--contact"), ("--to", "80%", "--steps", "2")
    work = {
        "deform": {"bottle.obj": (*bottle, *twist), "bar.obj": (*bar, *twist)},
        "press": {"bottle.obj": (bottle[0], *down), "bar.obj": (bar[0], *down)},
    }
    for name in work:
        if name in parts:
            say(name, commands(name, work[name], count or 200, rng))
    if "study" in parts:
        say("study", studies(folder / "plan.csv", count or 200, rng))


def begin():
    """Try the parts that are asked for."""
    parser = argparse.ArgumentParser()
    parser.add_argument("parts", nargs="*", default="all", choices=[*PARTS, "all"])
    parser.add_argument("--count", type=int)
    parser.add_argument("--seed", type=int, default=1)
    options = parser.parse_args()
    parts = PARTS if "all" in options.parts else options.parts
    rng = np.random.default_rng(options.seed)
    signal.signal(signal.SIGINT, signal.default_int_handler)  # also where started in the background
    with tempfile.TemporaryDirectory() as made:
        commands_tried(parts, options.count, rng, Path(made))
    # No kernel may run in this process before: GNU's OpenMP ends those that fork after it.
    before = shape(30)
    if "steps" in parts:
        say("steps", steps(options.count or 200, rng))
    if "kernel" in parts:
        say("kernel", kernels(options.count or 1000, rng))
    print("fixed case:", "the same bits" if shape(30) == before else "BROKEN: other bits")


if __name__ == "__main__":
    begin()
