"""Processor level for compiling the kernels."""

import os
import platform
import sys

# x86-64-v3: supported by Intel processors since Haswell (2013), by AMD since Excavator (2015).
PROCESSOR_LEVEL = "x86-64-v3"
_FEATURES = ("avx2", "bmi", "bmi2", "f16c", "fma", "lzcnt", "movbe")


def compile_for_level() -> None:
    """Have numba compile for PROCESSOR_LEVEL if this processor supports it.

    Kernels brought by a wheel or an installer then fit, and sums have the same bits on all such processors:
    compiled for the processor at hand, they are portioned by the width of its vectors. Nothing is changed for
    a user of numba with another choice, or with kernels of their own already there.
    """
    chosen = {"NUMBA_CPU_NAME", "NUMBA_CPU_FEATURES"} & os.environ.keys()
    if chosen or "numba" in sys.modules or platform.machine() not in ("x86_64", "AMD64"):
        return
    # Imported here: llvmlite is needed only on x86-64; it is installed with Numba.
    from llvmlite import binding

    there = binding.get_host_cpu_features()
    if all(there.get(feature) for feature in _FEATURES):
        os.environ.update(NUMBA_CPU_NAME=PROCESSOR_LEVEL, NUMBA_CPU_FEATURES="")
