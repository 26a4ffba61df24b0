"""The supernodal factor on a processor with no more than every x86-64 has, and on one thread."""

import os
import platform
import subprocess
import sys

import pytest

# Numba compiles for the processor that it is told.
PLAIN = {"NUMBA_CPU_NAME": "x86-64", "NUMBA_CPU_FEATURES": ""}
CHECK = """
from numba.core.registry import cpu_target

from apd_viewer.geometry.linalg.linear_solver import supernodal_solver_works

assert supernodal_solver_works()
print(cpu_target.target_context.codegen().magic_tuple())
"""


@pytest.mark.night
@pytest.mark.skipif(platform.machine() not in ("x86_64", "AMD64"), reason="needs an x86-64 processor")
def test_supernodal_factor_needs_no_wide_vectors(tmp_path):
    environment = {**os.environ, **PLAIN, "NUMBA_NUM_THREADS": "1", "NUMBA_CACHE_DIR": str(tmp_path)}
    run = subprocess.run(
        [sys.executable, "-c", CHECK],
        env=environment,
        capture_output=True,
        text=True,
        timeout=300,
        check=False,
    )
    assert run.returncode == 0, run.stderr
    assert "x86-64" in run.stdout
    assert "avx" not in run.stdout
