"""How fast this working tree is beside a commit: medians of pairs in turns.

    python tests/benchmarks/pace.py COMMIT [pairs]

Each row is the ratio of CPU time, now over then: 30 iterations on the sample bottle, 30 frames of a drag with
contact and with all readings, what a window imports, a sweep by four methods, and a study of 40 cases in one
process. Each measurement is a process of its own, and both trees take turns. The commit is checked out in
build/equal, and its kernels are compiled by a first round that does not count.
"""

import os
import resource
import statistics
import subprocess
import sys
import tempfile
from pathlib import Path

from equal_results import ROOT, checked_out, write_inputs

BEGIN = """
import time
import numpy as np
import apd_viewer
root = {root!r}
mesh = apd_viewer.open_mesh(root + "/resources/bottle.obj")
label = np.loadtxt(root + "/resources/bottle.sel")
held, handle = np.flatnonzero(label != 1), np.flatnonzero(label == 2)

def turned(degrees):
    targets, a = mesh.V.copy(), np.radians(degrees)
    x, z = mesh.V[handle, 0], mesh.V[handle, 2]
    targets[handle, 0], targets[handle, 2] = np.cos(a) * x + np.sin(a) * z, np.cos(a) * z - np.sin(a) * x
    return targets[held]

solver = apd_viewer.Deformation(mesh.V, mesh.F, held, handle=handle, contact={contact})
solver.aim(turned(1.0))
for _ in range(5):
    solver.step()
began = time.process_time()
"""
ITERATE = "solver.aim(turned(60.0))\nfor _ in range(30):\n    solver.iterate()\n"
DRAG = "for k in range(30):\n    solver.aim(turned(2.0 + k))\n    solver.step()\n"
END = "print(time.process_time() - began)\n"
IMPORT = "import time\nbegan = time.process_time()\nimport apd_viewer.ui.workbench\n"
PLAN = "mesh,selection,motion,steps,method,contact\n" + "".join(
    f"tube.obj,tube.sel,twist {10 + k}deg,2,exact,no\n" for k in range(40)
)


def measured(tree, title):
    """CPU seconds of a measurement in a tree."""
    environment = {name: value for name, value in os.environ.items() if not name.startswith("PYTHON")}
    environment |= {"PYTHONPATH": str(tree), "OPENBLAS_NUM_THREADS": "1"}
    with tempfile.TemporaryDirectory() as scratch:
        write_inputs(Path(scratch))
        (Path(scratch) / "plan.csv").write_text(PLAN, encoding="utf-8")
        before = _children()
        words = [sys.executable, *MEASUREMENTS[title]]
        done = subprocess.run(words, cwd=scratch, env=environment, capture_output=True, text=True, check=True)
        return float(done.stdout) if "-c" in words else _children() - before


def _children():
    used = resource.getrusage(resource.RUSAGE_CHILDREN)
    return used.ru_utime + used.ru_stime


def _code(body, contact=False):
    return "-c", BEGIN.format(root=str(ROOT), contact=contact) + body + END


MEASUREMENTS = {
    "30 iterations": _code(ITERATE),
    "30 frames of a drag": _code(DRAG, contact=True),
    "imports of a window": ("-c", IMPORT + END),
    "sweep by four methods": (
        *("-m", "apd_viewer", "sweep", "tube.obj", "--selection", "tube.sel", "--twist", "90deg"),
        *("--steps", "4", "--iterations", "60", "-o", "out"),
    ),
    "study of 40 cases": ("-m", "apd_viewer", "study", "plan.csv", "-o", "out", "--processes", "1"),
}


def main(commit, pairs="7"):
    tree = checked_out(commit)
    print("| measurement | then, s | now, s | now / then |\n|---|---|---|---|")
    for title in MEASUREMENTS:
        rounds = [(measured(tree, title), measured(ROOT, title)) for _ in range(1 + int(pairs))][1:]
        then, now = (statistics.median(each) for each in zip(*rounds, strict=True))
        ratio = statistics.median(b / a for a, b in rounds)
        print(f"| {title} | {then:.3f} | {now:.3f} | {ratio:.3f} |", flush=True)


if __name__ == "__main__":
    main(*sys.argv[1:])
