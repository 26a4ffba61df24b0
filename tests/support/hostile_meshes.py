"""Valid but hostile meshes to what is done in native code; run by ``make fuzz`` after the readers.

    python tests/support/hostile_meshes.py [minutes] [seed]
    python tests/support/hostile_meshes.py --one index seed library

The judge of contact (ipctk), decimation (fast-simplification), geodesics (potpourri3d), measuring, and the
remesher (MMG) if it is installed, have each mesh in a process of its own, so that a crash is a finding and
not the end. Each ends with a result, or with an InputError, within SECONDS and MEMORY.
"""

import os
import random
import resource
import sys
import time
import traceback
from collections import Counter
from importlib.util import find_spec
from pathlib import Path

import numpy as np
from meshes import box, grid, sphere

from apd_viewer.errors import InputError
from apd_viewer.files.formats.cad import even_triangles
from apd_viewer.geometry.analysis.inspection import inspect
from apd_viewer.geometry.analysis.self_intersections import crossings
from apd_viewer.geometry.measuring.geodesics import geodesic_path
from apd_viewer.geometry.mesh.decimation import decimated_mesh
from apd_viewer.geometry.mesh.mesh import Mesh

SECONDS = 60
MEMORY = 4 << 30  # bytes more than the process has at its start


# ---- meshes: each takes chance, and gives positions (n, 3) and triangles (m, 3)


def slivers(chance):
    V, F = grid(chance.choice((1, 8, 40)), chance.choice((1, 8, 40)))
    return V * [1.0, 10.0 ** -chance.randrange(1, 30), 1.0], F


def sharp_box(chance):
    V, F = box(4, 4, 4)
    return V * [1.0, 1.0, 10.0 ** -chance.randrange(1, 20)], F


def coincident_points(chance):
    """A surface whose triangles share places and no vertices, or many of whose vertices are at one place."""
    V, F = sphere(chance.choice((1, 2, 3)))
    if chance.random() < 0.5:
        return V[F].reshape(-1, 3), np.arange(F.size).reshape(-1, 3)
    V = V.copy()
    V[chance.sample(range(len(V)), len(V) // chance.choice((2, 4, 10)))] = V[0]
    return V, F


def nonmanifold_edges(chance):
    """A book: many pages at one edge."""
    count = chance.choice((3, 50, 3000))
    turn = np.linspace(0.0, 2.0 * np.pi, count, endpoint=False)
    pages = np.column_stack([np.cos(turn), np.sin(turn), chance.choice((0.5, 0.0)) * np.ones(count)])
    F = np.column_stack([np.zeros(count), np.ones(count), 2 + np.arange(count)]).astype(int)
    return np.vstack([[[0, 0, 0], [0, 0, 1]], pages]), F


def fan(chance):
    """Thousands of triangles around one vertex; flat, or folded on itself."""
    count, turns = chance.choice((3, 1000, 20_000)), chance.choice((1, 2, 7))
    turn = np.linspace(0.0, 2.0 * np.pi * turns, count, endpoint=False)
    rim = np.column_stack([np.cos(turn), np.sin(turn), chance.choice((0.0, 0.1)) * np.sin(3 * turn)])
    at = 1 + np.arange(count)
    return np.vstack([[[0, 0, 0]], rim]), np.column_stack([0 * at, at, np.roll(at, -1)])


def flat_triangles(chance):
    """Triangles without area: corners on a line, at a place, or the same twice."""
    V, F = sphere(2)
    V, F = V.copy(), F.copy()
    for k in chance.sample(range(len(F)), len(F) // chance.choice((2, 5, 20))):
        match chance.randrange(3):
            case 0:
                V[F[k, 2]] = V[F[k, :2]].mean(axis=0)
            case 1:
                V[F[k]] = V[F[k, 0]]
            case 2:
                F[k, 1] = F[k, 0]
    return V, F


def one_triangle(chance):
    return np.eye(3) * 10.0 ** chance.randrange(-37, 38), np.array([[0, 1, 2]])


def many_parts(chance):
    count = chance.choice((2, 500, 5000))
    V, F = box(1, 1, 1) if chance.random() < 0.5 else (np.eye(3), np.array([[0, 1, 2]]))
    spread = chance.choice((0.0, 0.1, 100.0))
    shifts = spread * np.array([[chance.random() for _ in range(3)] for _ in range(count)])
    if spread == 0.0:
        shifts = shifts[:40]  # all at one place: each pierces all others
    return (
        (V + shifts[:, None]).reshape(-1, 3),
        (F + len(V) * np.arange(len(shifts))[:, None, None]).reshape(-1, 3),
    )


def coincident_sheets(chance):
    """Sheets at one place, with the same or other diagonals, facing the same or the other side."""
    V, F = grid(chance.choice((2, 20)), chance.choice((2, 20)))
    sheets, count = [], chance.choice((2, 5, 30))
    for k in range(count):
        turned = F[:, ::-1] if chance.random() < 0.5 else F
        sheets.append((V[:, [1, 0, 2]] if chance.random() < 0.5 else V, turned + k * len(V)))
    return np.vstack([each[0] for each in sheets]), np.vstack([each[1] for each in sheets])


def noise(chance):
    """Triangles among a few vertices, drawn by lot."""
    many = np.random.default_rng(chance.randrange(1 << 30))
    n = chance.choice((4, 30, 300))
    return many.normal(size=(n, 3)), many.integers(0, n, size=(chance.choice((5, 100, 1000)), 3))


def spikes(chance):
    """Some vertices so far away that all others are at one place for single precision."""
    V, F = sphere(3)
    V = V.copy()
    V[chance.sample(range(len(V)), 3)] *= 10.0 ** chance.choice((3, 8, 15, 30))
    return V, F


KINDS = (
    slivers,
    sharp_box,
    coincident_points,
    nonmanifold_edges,
    fan,
    flat_triangles,
    one_triangle,
    many_parts,
    coincident_sheets,
    noise,
    spikes,
)


def hostile_mesh(index, seed):
    """Kind, positions and triangles of the mesh number ``index``: always the same."""
    chance = random.Random(f"{seed} {index}")
    kind = KINDS[index % len(KINDS)]
    V, F = kind(chance)
    V = np.array(V, dtype=float)
    match chance.randrange(4):
        case 0:  # up to the program's limits
            V *= 0.99e38 / max(np.abs(V).max(), 1e-300) * 10.0 ** -chance.choice((0, 1, 19, 60))
        case 1:  # far from the origin
            V += np.abs(V).max() * 10.0 ** chance.choice((3, 7, 12))
    return kind.__name__, V, np.asarray(F, dtype=np.int64)


# ---- what is done with them


def contact(mesh, chance):
    crossings(mesh.V, mesh.joined_F)


def decimation(mesh, chance):
    proper = np.unique(mesh.joined_F)
    decimated_mesh(mesh.V, mesh.joined_F, max(4, int(len(proper) * chance.choice((0.05, 0.3)))))


def geodesics(mesh, chance):
    for _ in range(3):
        ends = [int(mesh.F[chance.randrange(len(mesh.F)), chance.randrange(3)]) for _ in range(2)]
        try:
            path = geodesic_path(mesh.V, mesh.joined_F, *ends)
        except InputError:
            continue
        assert np.isfinite(path).all(), "a path of no numbers"


def measuring(mesh, chance):
    inspect(mesh)


def remesher(mesh, chance):
    V, _, _ = even_triangles(mesh.V, mesh.joined_F)
    assert np.isfinite(V).all(), "positions that are no numbers"


LIBRARIES = {each.__name__: each for each in (contact, decimation, geodesics, measuring)}
if find_spec("mmgpy"):  # of an extra
    LIBRARIES["remesher"] = remesher


def outcome(index, seed, name):
    """What came of a mesh, in this process: "done", "refused", or what went wrong."""
    _, V, F = hostile_mesh(index, seed)
    try:
        mesh = Mesh(V, F)
        with np.errstate(all="ignore"):
            LIBRARIES[name](mesh, random.Random(index))
    except InputError:
        return "refused"
    except BaseException:
        return traceback.format_exc()
    return "done"


def watched_outcome(index, seed, name):
    """The same in a process of its own, and the seconds that it took."""
    began, (source, sink) = time.monotonic(), os.pipe()
    if (process := os.fork()) == 0:
        used = int(Path("/proc/self/statm").read_text().split()[0]) * resource.getpagesize()
        resource.setrlimit(resource.RLIMIT_AS, (used + MEMORY, resource.RLIM_INFINITY))
        os.write(sink, outcome(index, seed, name).encode()[-4000:])
        os._exit(0)
    os.close(sink)
    done, status = os.waitpid(process, os.WNOHANG)
    while not done and time.monotonic() - began < SECONDS:
        time.sleep(0.002)
        done, status = os.waitpid(process, os.WNOHANG)
    if not done:
        os.kill(process, 9)
        os.waitpid(process, 0)
    said = os.read(source, 4096).decode()
    os.close(source)
    if not done:
        said = f"it takes more than {SECONDS} s"
    elif status:
        said = f"the process ended with {os.waitstatus_to_exitcode(status)}"
    return said, time.monotonic() - began


def main(minutes=10.0, seed=None):
    seed = random.randrange(1 << 30) if seed is None else seed
    for name in LIBRARIES:
        if name != "contact":  # whose threads would not live in the processes split off
            outcome(1, 0, name)  # compiles what is compiled
    rows = {name: Counter() for name in LIBRARIES}
    worst, index, known = dict.fromkeys(LIBRARIES, 0.0), 0, set()
    ends = time.monotonic() + 60.0 * minutes
    while time.monotonic() < ends:
        for name in LIBRARIES:
            said, took = watched_outcome(index, seed, name)
            worst[name] = max(worst[name], took)
            rows[name]["meshes"] += 1
            rows[name][said if said in ("done", "refused") else "found"] += 1
            kind = (name, KINDS[index % len(KINDS)], said.strip().splitlines()[-1] if said else "nothing")
            if said not in ("done", "refused") and kind not in known:
                known.add(kind)
                place = f"python tests/support/hostile_meshes.py --one {index} {seed} {name}"
                print(f"\n{name}, {kind[1].__name__}: {place}\n{said}", flush=True)
        index += 1
    print(f"\n{'library':12} {'meshes':>8} {'done':>8} {'refused':>8} {'found':>6} {'worst':>8}")
    for name, row in rows.items():
        counts = f"{row['meshes']:8,} {row['done']:8,} {row['refused']:8,} {row['found']:6}"
        print(f"{name:12} {counts} {worst[name]:6.2f} s")
    return 1 if any(row["found"] for row in rows.values()) else 0


if __name__ == "__main__":
    match sys.argv[1:]:
        case ["--one", index, seed, name]:
            print(hostile_mesh(int(index), int(seed)))
            print(outcome(int(index), int(seed), name))
        case [*rest]:
            sys.exit(main(*map(float, rest[:1]), *map(int, rest[1:])))
