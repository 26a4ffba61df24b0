"""How long it takes to open a large file, against trimesh.

    python tests/benchmarks/opening.py [length of the edges] [turns]

With edges of 0.161, the default, the sample bottle has 503,000 vertices. All take turns, so that whatever
else the machine does falls on all of them; the figures are medians. "plain" is trimesh with process=False,
which looks at nothing; "default" joins vertices, which happens here only when a mesh is solved.
"""

import sys
import tempfile
import time
from pathlib import Path

import numpy as np
import trimesh

sys.path.insert(0, str(Path(__file__).parents[1] / "support"))
from meshes import sample_bottle

from apd_viewer.files.mesh_writing import save_mesh
from apd_viewer.files.meshes import open_mesh
from apd_viewer.geometry.mesh.mesh import Mesh

SUFFIXES = (".ply", ".stl", ".obj")
WAYS = {
    "open_mesh": open_mesh,
    "plain": lambda path: trimesh.load(path, process=False),
    "default": trimesh.load,
}


def main(edge: float = 0.161, turns: int = 9) -> None:
    V, F, _ = sample_bottle(edge)
    print(f"{len(V):,} vertices, {len(F):,} faces")
    print("file      MiB" + "".join(f"{name:>14}" for name in WAYS) + "   / plain   / default")
    with tempfile.TemporaryDirectory() as folder:
        for suffix in SUFFIXES:
            path = Path(folder) / f"bottle{suffix}"
            save_mesh(Mesh(V, F), V, path)
            took = {name: [] for name in WAYS}
            for turn in range(turns + 1):
                # Each in its turn comes first: memory that the one before gave back costs the next one less.
                for k in range(len(WAYS)):
                    name, way = list(WAYS.items())[(turn + k) % len(WAYS)]
                    started = time.perf_counter()
                    way(path)
                    if turn:  # at first, modules are loaded
                        took[name].append(1e3 * (time.perf_counter() - started))
            ours, plain, default = (float(np.median(took[name])) for name in WAYS)
            figures = "".join(f"{figure:11.1f} ms" for figure in (ours, plain, default))
            ratios = f"{ours / plain:10.2f}{ours / default:12.2f}"
            print(f"{suffix:5} {path.stat().st_size / 2**20:7.1f}{figures}{ratios}", flush=True)


if __name__ == "__main__":
    main(*(kind(given) for kind, given in zip((float, int), sys.argv[1:], strict=False)))
