"""The processor that kernels are compiled for, by what numba says of itself."""

import os
import platform
import subprocess
import sys

import pytest
from llvmlite import binding

from apd_viewer.geometry import processor

TOLD = """
from numba.core.registry import cpu_target
print(*cpu_target.target_context.codegen().magic_tuple()[1:])
"""
OURS = "import apd_viewer.geometry\n"

pytestmark = pytest.mark.skipif(
    platform.machine() not in ("x86_64", "AMD64"), reason="levels are those of x86-64"
)


def compiled_for(code, **environment):
    """The processor and its features, as numba names them."""
    kept = {name: value for name, value in os.environ.items() if not name.startswith("NUMBA_CPU")}
    said = subprocess.run(
        [sys.executable, "-c", code], env=kept | environment, check=True, capture_output=True, text=True
    )
    return said.stdout.rstrip("\n")


def test_compile_for_level_makes_kernels_fit_every_processor_of_the_level():
    there = binding.get_host_cpu_features()
    expected = f"{processor.PROCESSOR_LEVEL} " if there["avx2"] and there["fma"] else compiled_for(TOLD)
    assert compiled_for(OURS + TOLD) == expected


def test_compile_for_level_leaves_another_choice_and_a_user_s_own_kernels_alone():
    assert compiled_for(OURS + TOLD, NUMBA_CPU_NAME="x86-64", NUMBA_CPU_FEATURES="") == "x86-64 "
    assert compiled_for("import numba\n" + OURS + TOLD) == compiled_for(TOLD)


def test_compile_for_level_gives_an_older_processor_kernels_of_its_own(monkeypatch):
    monkeypatch.setattr(binding, "get_host_cpu_features", lambda: {"avx": True, "avx2": False})
    for name in ("NUMBA_CPU_NAME", "NUMBA_CPU_FEATURES"):
        monkeypatch.delenv(name, raising=False)
    monkeypatch.delitem(sys.modules, "numba")
    processor.compile_for_level()
    assert "NUMBA_CPU_NAME" not in os.environ
