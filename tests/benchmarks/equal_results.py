"""Whether this working tree computes what a commit did, bit for bit.

    python tests/benchmarks/equal_results.py COMMIT [NAME ...]

Runs commands in both, in turns, on meshes made here, and compares all files that they write and all that
they print, but for times. Each line says whether a case is equal, or what differs, and how long both took.
The status is 1 if any differs. The commit is checked out in build/equal, and stays there with the kernels
that it has compiled.

A kernel whose products and sums may be contracted can have other bits after it was compiled again, from the
same source: the order of its code depends on what was compiled before it. Delete its files of both trees
(``*.nbc``) before a difference of 1e-16 is believed.
"""

import json
import os
import re
import shlex
import subprocess
import sys
import tempfile
import time
import zipfile
from pathlib import Path

import numpy as np

ROOT = Path(__file__).parents[2]
TUBE = "tube.obj --selection tube.sel"
FILES = "-o out.obj --report out.json"
TWIST = f"deform {TUBE} --twist 100deg {FILES}"
PRESS = f"press tube.obj --axis x --steps 5 --stiffness 0.001 {FILES} --curve out.csv"
COMMANDS = "deform", "deck", "info", "press", "replay", "study", "sweep", "volumes", "paper"
CASES = {
    "exact": TWIST,
    "exact, contact off": f"{TWIST} --no-contact --stiffness 0.001",
    "exact, calm off": f"{TWIST} --no-calm --no-contact",
    "exact, volume": f"{TWIST} --volume 70 --stiffness 0.0005",
    "exact, region": f"{TWIST} --area 102 --region Label label.sel 95",
    "local": f"{TWIST} --method local",
    "local, moduli": f"{TWIST} --method local --no-contact --area-stiffness 3 --shear-stiffness 0.4",
    "arap": f"{TWIST} --method arap",
    "arap, plain": f"{TWIST} --method arap --iterations 30",
    "paper": f"{TWIST} --method paper --most-iterations 300",
    "sr-arap": f"{TWIST} --method sr-arap --stiffness 0.02 --most-iterations 200",
    "push": f"deform {TUBE} --push 40% --stiffness 0.001 {FILES}",
    "motion": f'deform {TUBE} --motion "twist 200deg; move 0 0.3 0" {FILES}',
    "weld": f"deform torn.obj --selection torn.sel --weld --twist 60deg {FILES}",
    "finger": f'deform {TUBE} --move "0 0 0" --obstacles finger.json --stiffness 0.001 '
    f"{FILES} --scalars out.ply",
    "press": f"{PRESS} --to 50%",
    "press, creases": f"{PRESS} --to 50% --thickness 0.02 --yield-radius 0.1 --release",
    "press, gas": f"{PRESS} --to 60% --gas 1atm --unit cm --material pet-bottle --thickness 0.3mm",
    "press, local": f"{PRESS} --to 70% --method local",
    "sweep": f"sweep {TUBE} --twist 90deg --steps 4 --iterations 40 -o out --meshes",
    "sweep, contact": f"sweep {TUBE} --push 50% --steps 4 --methods exact,local --contact -o out",
    "replay": f"replay session.apd {FILES}",
    "replay from rest": f"replay session.apd --from-rest {FILES}",
    "study": "study plan.csv -o out --processes 1",
    "deck": f"deck {TUBE} --twist 40deg --steps 2 -o out.inp",
    "volumes": "volumes tube.obj --rest tube.obj --unit cm --bag 100 --thickness 0.3mm --json out.json",
    "info": "info torn.obj --json",
    "info, compare": "info tube.obj --compare torn.obj",
    "report, compare": f"{TWIST} --iterations 3 --compare tube.obj --triangle-scalars out.csv",
    "drag": "python drag.py",
    **{f"help, {name}": f"{name} --help" for name in COMMANDS},
}
# The frames of a drag there and half of the way back, a line each, and of the shape that it comes to rest in.
DRAG = """import hashlib
import numpy as np
import apd_viewer
mesh = apd_viewer.open_mesh("tube.obj")
label = np.loadtxt("tube.sel")
held, handle = np.flatnonzero(label != 1), np.flatnonzero(label == 2)
for settings in ({}, {"contact": True}, {"method": "local"}, {"method": "arap", "stiffness": 0.001},
                 {"method": "exact", "volume": 90}, {"method": "paper"}):
    solver = apd_viewer.Deformation(mesh.V, mesh.F, held, handle=handle, **settings)
    for turn in np.radians([*range(0, 61, 3), *range(60, 30, -3)]):
        targets = mesh.V.copy()
        x, z = targets[handle, 0].copy(), targets[handle, 2].copy()
        targets[handle, 0] = np.cos(turn) * x + np.sin(turn) * z
        targets[handle, 2] = np.cos(turn) * z - np.sin(turn) * x
        solver.aim(targets[held])
        for _ in range(2):
            frame = solver.step()
            print(settings, hashlib.sha256(frame.U.tobytes()).hexdigest(), frame.area_error, frame.energy)
    for _ in range(400):
        if frame.settled:
            break
        frame = solver.step()
    print("at rest", frame.iteration, hashlib.sha256(frame.U.tobytes()).hexdigest())
"""
PLAN = """mesh,selection,motion,steps,method,stiffness,contact,volume
tube.obj,tube.sel,twist 60deg,3,exact,0,no,
tube.obj,tube.sel,twist 60deg,3,local,0,yes,
tube.obj,tube.sel,push 20%,3,arap,0.001,auto,
tube.obj,tube.sel,push 20%,3,exact,0.001,yes,80
"""
FINGER = [{"kind": "sphere", "place": [2.0, 2.5, 0.0], "radius": 0.6, "shift": [-0.9, 0.0, 0.0]}]
# These hold seconds; what else is in them is in the tables beside them.
TIMED = (".case", ".sqlite", ".parquet")
# What differs from run to run.
TIMES = re.compile(r"[\d.,]+ (ms|s|min)\b|\d{4}-\d\d-\d\d[T ][\d:.]+(\+00:00|Z)?")


def write_inputs(folder):
    """A closed tube, one that is cut open along a line, and all else that the cases name."""
    around, along = 24, 20
    turns = 2 * np.pi * np.arange(around) / around
    rings = [[(np.cos(a), 5.0 * k / along, np.sin(a)) for a in turns] for k in range(along + 1)]
    V = np.array([*(point for ring in rings for point in ring), (0.0, 0.0, 0.0), (0.0, 5.0, 0.0)])
    quads = [(k * around + i, k * around + (i + 1) % around) for k in range(along) for i in range(around)]
    F = [(a, a + around, b) for a, b in quads] + [(a + around, b + around, b) for a, b in quads]
    base, top = len(V) - 2, len(V) - 1
    F += [(base, i, (i + 1) % around) for i in range(around)]
    F += [(top, along * around + (i + 1) % around, along * around + i) for i in range(around)]
    _write_mesh(folder, "tube", V, F)
    seam = np.arange(along + 1) * around
    torn = np.vstack([V, V[seam]])
    twin = dict(zip(seam.tolist(), range(len(V), len(torn)), strict=True))
    cut = [tuple(twin.get(v, v) if max(f) - min(f) > around and v % around == 0 else v for v in f) for f in F]
    _write_mesh(folder, "torn", torn, cut)
    label = np.where(np.abs(V[:, 1] - 2.5) < 0.6, 1, 0)
    (folder / "label.sel").write_text("\n".join(map(str, label)), encoding="utf-8")
    (folder / "finger.json").write_text(json.dumps(FINGER), encoding="utf-8")
    (folder / "plan.csv").write_text(PLAN, encoding="utf-8")
    (folder / "drag.py").write_text(DRAG, encoding="utf-8")
    session = ROOT / "docs" / "gallery" / "sessions" / "cloth_wrung.apd"
    (folder / "session.apd").write_bytes(session.read_bytes())


def _write_mesh(folder, name, V, F):
    lines = [f"v {x!r} {y!r} {z!r}" for x, y, z in V.tolist()] + [
        f"f {a + 1} {b + 1} {c + 1}" for a, b, c in F
    ]
    (folder / f"{name}.obj").write_text("\n".join(lines) + "\n", encoding="utf-8")
    labels = np.where(V[:, 1] < 0.3, 0, np.where(V[:, 1] > 4.7, 2, 1))
    (folder / f"{name}.sel").write_text("\n".join(map(str, labels)), encoding="utf-8")


def run(tree, words):
    """What a command writes and prints in a tree, by name, and the seconds it took."""
    with tempfile.TemporaryDirectory() as scratch:
        folder = Path(scratch)
        write_inputs(folder)
        before = {path.name for path in folder.iterdir()}
        began = time.perf_counter()
        words = words.removeprefix("python ") if words.startswith("python ") else f"-m apd_viewer {words}"
        command = [sys.executable, *shlex.split(words)]
        environment = {"PYTHONPATH": str(tree), "APD_VIEWER_LANGUAGE": "en", "OPENBLAS_NUM_THREADS": "1"}
        done = subprocess.run(
            command, cwd=folder, env=_inherited() | environment, capture_output=True, check=False
        )
        seconds = time.perf_counter() - began
        found = {"status": str(done.returncode).encode(), "printed": done.stdout, "errors": done.stderr}
        for path in sorted(folder.rglob("*")):
            if (
                path.is_file()
                and path.suffix not in TIMED
                and path.relative_to(folder).parts[0] not in before
            ):
                found |= _contents(path.relative_to(folder).as_posix(), path)
    return {name: comparable(name, content) for name, content in found.items()}, seconds


def _inherited():
    return {name: value for name, value in os.environ.items() if not name.startswith("PYTHON")}


def _contents(name, path):
    """Content of a file; of an archive, that of each member."""
    if path.suffix not in (".apd", ".npz"):
        return {name: path.read_bytes()}
    with zipfile.ZipFile(path) as archive:
        return {f"{name}/{member}": archive.read(member) for member in archive.namelist()}


def comparable(name, content):
    """Content without times."""
    if name.endswith(".json"):
        return json.dumps(_timeless(json.loads(content)), sort_keys=True).encode()
    if name.endswith(".csv"):
        rows = [line.split(",") for line in content.decode().splitlines()]
        kept = [k for k, head in enumerate(rows[0]) if "second" not in head]
        return "\n".join(",".join(row[k] for k in kept if k < len(row)) for row in rows).encode()
    if name in ("printed", "errors"):
        return TIMES.sub("", content.decode()).encode()
    return content


def _timeless(value):
    if isinstance(value, dict):
        return {
            key: _timeless(each) for key, each in value.items() if "second" not in key and key != "created"
        }
    return [_timeless(each) for each in value] if isinstance(value, list) else value


def difference(one, other):
    """Names of what only one wrote, or wrote otherwise; numbers tell by how much."""
    said = []
    for name in sorted(one.keys() | other.keys()):
        a, b = one.get(name), other.get(name)
        if a != b:
            said.append(f"{name} ({_distance(a, b)})")
    return said


def _distance(a, b):
    if a is None or b is None:
        return "missing"
    if keys := _keys(a) ^ _keys(b):
        return f"keys {', '.join(sorted(keys))}"
    x, y = (np.array(re.findall(rb"-?\d+\.?\d*(?:e[-+]\d+)?", each), dtype=float) for each in (a, b))
    if x.shape != y.shape or not len(x):
        return f"{len(a):,} and {len(b):,} bytes"
    return f"numbers differ by up to {np.abs(x - y).max():.1e}"


def checked_out(commit):
    """Folder with a commit in it."""
    tree = ROOT / "build" / "equal"
    if not tree.exists():
        _git("worktree", "add", "--quiet", "--detach", tree, commit)
    _git("-C", tree, "checkout", "--quiet", "--detach", commit)
    return tree


def _git(*words):
    subprocess.run(["git", *words], cwd=ROOT, check=True)


def _keys(content):
    """Names in an object of JSON."""
    try:
        found = json.loads(content)
    except ValueError:
        return set()
    return set(found) if isinstance(found, dict) else set()


def main(commit, *names):
    tree = checked_out(commit)
    unequal = [name for name in names or CASES if not _is_equal(tree, name)]
    print(f"{len(names or CASES) - len(unequal)} of {len(names or CASES)} cases are equal.")
    return 1 if unequal else 0


def _is_equal(tree, name):
    (before, first), (now, second) = run(tree, CASES[name]), run(ROOT, CASES[name])
    said = difference(before, now)
    if now["status"] != b"0":  # alike or not: nothing was computed that could be compared
        said.append(f"status {now['status'].decode()}: {now['errors'].decode().strip()}")
    print(f"{name}: {'; '.join(said) or 'equal'} ({first:.1f} s, now {second:.1f} s)", flush=True)
    return not said


if __name__ == "__main__":
    sys.exit(main(*sys.argv[1:]))
