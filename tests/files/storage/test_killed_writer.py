"""A writer that is killed leaves the old file or the new one, never a part of it.

    python tests/files/storage/test_killed_writer.py [kills]

One process writes two versions of a mesh over each other without an end, and is killed at a random moment:
every other time at one when there is a scratch file, which is rarely there.
"""

import os
import random
import signal
import subprocess
import sys
import tempfile
import time
from collections import Counter
from pathlib import Path

import pytest

ROOT = Path(__file__).parents[3]
KILLS = 15
# A fork for every writer: imports take longer than what is tried here.
WRITER = """
import os, sys
from pathlib import Path
from meshes import grid
from apd_viewer.files.meshes import open_mesh
from apd_viewer.files.mesh_writing import save_mesh
from apd_viewer.geometry.mesh.mesh import Mesh

folder, name = Path(sys.argv[1]), sys.argv[2]
mesh = Mesh(*grid(100, 100))
save_mesh(mesh, mesh.V, folder / f"old {name}")
mesh = open_mesh(folder / f"old {name}")  # as it is of a file, the file is written again
versions = mesh.V, 2.0 * mesh.V
for target in (f"new {name}", name):
    save_mesh(mesh, versions[1], folder / target)
for _ in sys.stdin:
    child = os.fork()
    if not child:
        while True:
            for U in versions:
                save_mesh(mesh, U, folder / name)
    print(child, flush=True)
    os.waitpid(child, 0)
    print("dead", flush=True)
"""


def killed_writers(kills: int, folder: Path, name: str, seed: int = 0) -> Counter:
    """What was found at the target after the kills, by name; fails if it is a part of a file."""
    chance, found = random.Random(seed), Counter()
    paths = os.pathsep.join([str(ROOT), str(ROOT / "tests"), *filter(None, sys.path)])
    with subprocess.Popen(
        [sys.executable, "-c", WRITER, str(folder), name],
        env={**os.environ, "PYTHONPATH": paths},
        stdin=subprocess.PIPE,
        stdout=subprocess.PIPE,
        text=True,
    ) as writer:
        for kill in range(kills):
            writer.stdin.write("write\n")
            writer.stdin.flush()
            child = int(writer.stdout.readline())
            time.sleep(chance.uniform(0.0, 0.06))
            if kill % 2:
                _wait_for_scratch_file(folder)
            os.kill(child, signal.SIGKILL)
            assert writer.stdout.readline() == "dead\n"
            whole = {(folder / f"{kind} {name}").read_bytes(): kind for kind in ("old", "new")}
            content = (folder / name).read_bytes()
            assert content in whole, f"kill {kill}: {len(content):,} bytes are part of a file"
            found[whole[content]] += 1
            for path in folder.glob(".*"):
                found["scratch files left behind"] += 1
                path.unlink()
        writer.stdin.close()
    return found


def _wait_for_scratch_file(folder: Path) -> None:
    since = time.monotonic()
    while not any(folder.glob(".*")) and time.monotonic() - since < 2.0:
        pass


@pytest.mark.skipif(
    sys.platform != "linux", reason="forks, which Windows cannot and libraries of macOS do not survive"
)
def test_save_mesh_leaves_the_old_file_or_the_new_one_when_the_writer_is_killed(tmp_path):
    found = killed_writers(KILLS, tmp_path, "a mesh.ply")
    # Otherwise nothing was being written when it was killed.
    assert min(found["old"], found["new"], found["scratch files left behind"]) > 0, found


if __name__ == "__main__":
    for suffix in (".ply", ".stl", ".obj", ".off"):
        with tempfile.TemporaryDirectory() as folder:
            kills = int(sys.argv[1]) // 4 if sys.argv[1:] else 50
            print(suffix, dict(killed_writers(kills, Path(folder), f"a mesh{suffix}")))  # noqa: T201
