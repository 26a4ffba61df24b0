"""Compile the kernels for a package, so that its users need not wait for them.

    python resources/installer/kernels.py

leaves those for a wheel in build/kernels, where hatch_build.py finds them. The program looks for kernels
beside their modules, and takes those whose sources, processor, Python and version of numba are the same.
Others are compiled as ever.
"""

from __future__ import annotations

import os
import shutil
import subprocess
import sys
import tempfile
from pathlib import Path

from apd_viewer.installation import cache_name

ROOT = Path(__file__).resolve().parents[2]
FOLDER = ROOT / "build" / "kernels"

_PROGRAM = """
import os
from apd_viewer.geometry.processor import PROCESSOR_LEVEL
from apd_viewer.geometry.warmup import warm_up
if os.environ.get("NUMBA_CPU_NAME") == PROCESSOR_LEVEL:
    warm_up()
"""


def compile_kernels(python: list[str], package: Path, folder: Path) -> int:
    """Compile all kernels; the number of files, 0 on a processor unlike others.

    Parameters
    ----------
    python : list of str
        Starts Python, or a program that understands ``-c`` as Python does.
    package : Path
        The folder apd_viewer, as that Python imports it.
    folder : Path
        Where the files go: each into the folder of its module, below that of the package.
    """
    shutil.rmtree(folder, ignore_errors=True)
    with tempfile.TemporaryDirectory() as cache:
        environment = {**os.environ, "NUMBA_CACHE_DIR": cache, "PYTHONPATH": str(ROOT)}
        for name in ("NUMBA_CPU_NAME", "NUMBA_CPU_FEATURES"):
            environment.pop(name, None)
        subprocess.run([*python, "-c", _PROGRAM], env=environment, check=True)
        for module_folder in (package, *(path for path in package.rglob("*") if path.is_dir())):
            compiled = Path(cache) / cache_name(module_folder)
            if compiled.is_dir():
                shutil.copytree(compiled, folder / module_folder.relative_to(package.parent))
    return sum(path.is_file() for path in folder.rglob("*"))


def main() -> None:
    """Compile them for a wheel."""
    number = compile_kernels([sys.executable], ROOT / "apd_viewer", FOLDER)
    print(f"{FOLDER}: {number} files" if number else "Kernels for this processor would fit no other.")


if __name__ == "__main__":
    main()
