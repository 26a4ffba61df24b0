"""A program that can write nothing but its results: of another user, on a disk that is read-only."""

import ctypes
import os
import shutil
import subprocess
import sys
from pathlib import Path

import numpy as np
import pytest

import apd_viewer

PACKAGE = Path(apd_viewer.__file__).parent
PR_CAPBSET_DROP, CAP_DAC_OVERRIDE = 24, 1  # of linux/prctl.h and linux/capability.h

pytestmark = pytest.mark.skipif(not sys.platform.startswith("linux"), reason="permissions are those of Linux")


def bind_to_permissions():
    """Have the next program keep to permissions, also if it is root's."""
    ctypes.CDLL(None).prctl(PR_CAPBSET_DROP, CAP_DAC_OVERRIDE, 0, 0, 0)


def set_mode(folder, of_folders, of_files):
    for path in (folder, *folder.rglob("*")):
        path.chmod(of_folders if path.is_dir() else of_files)


@pytest.fixture
def installed(compiled, tmp_path):
    """A copy of the program with its kernels that nobody may write, and a home of the same kind."""
    left_out = shutil.ignore_patterns("*.pyc", "*.nbi", "ui")
    shutil.copytree(PACKAGE, tmp_path / "there" / "apd_viewer", ignore=left_out)
    (tmp_path / "there" / "home").mkdir()
    yield tmp_path / "there"
    set_mode(tmp_path / "there", 0o755, 0o644)


def deformed(installed, out):
    """Result of a twist, and what was said, in a process that starts from there."""
    V = np.array([(x, y, z) for z in range(4) for x, y in ((0, 0), (1, 0), (1, 1), (0, 1))], float)
    around = [(0, 1), (1, 2), (2, 3), (3, 0)]
    F = [
        t
        for k in (0, 4, 8)
        for a, b in around
        for t in ((k + a, k + b, k + a + 4), (k + b, k + b + 4, k + a + 4))
    ]
    out.mkdir(exist_ok=True)
    lines = [f"v {x} {y} {z}" for x, y, z in V] + ["f {} {} {}".format(*np.add(t, 1)) for t in F]
    (out / "tube.obj").write_text("\n".join(lines))
    np.savetxt(out / "tube.sel", [0] * 4 + [1] * 8 + [2] * 4, "%d")
    words = "deform tube.obj --selection tube.sel --twist 20deg --iterations 3 -o out.obj --log-level info"
    kept = {name: value for name, value in os.environ.items() if not name.startswith(("XDG", "NUMBA"))}
    done = subprocess.run(
        [sys.executable, "-m", "apd_viewer", *words.split()],
        env=kept | {"PYTHONPATH": str(installed), "HOME": str(installed / "home"), "MPLCONFIGDIR": str(out)},
        cwd=out,
        capture_output=True,
        text=True,
        preexec_fn=bind_to_permissions,
    )
    assert done.returncode == 0, done.stderr
    assert "Traceback" not in done.stderr
    return (out / "out.obj").read_bytes(), done.stderr


@pytest.mark.night
def test_deform_needs_no_place_for_its_kernels(installed, tmp_path):
    folder = installed / "apd_viewer" / "geometry" / "mesh" / "__pycache__"
    content, said = deformed(installed, tmp_path / "usual")
    assert "kernels" not in said, "all are there"
    files = list(folder.glob("edges_and_components.opposite_half_edges-*.nbc"))
    assert files
    for file in files:
        file.write_bytes(file.read_bytes()[:-1])
    set_mode(installed, 0o555, 0o444)
    again, said = deformed(installed, tmp_path / "read-only")
    assert again == content
    assert "the file is damaged" in said
    assert "Compiled kernels are not kept (Permission denied)" in said
