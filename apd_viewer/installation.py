"""Kind of installation: by pip, or a program of its own."""

import hashlib
import os
import shutil
import sys
import tempfile
from contextlib import suppress
from pathlib import Path


def is_packaged() -> bool:
    """True in the self-contained program of an installer, with neither Python nor pip."""
    return getattr(sys, "frozen", False)


def bring_kernels() -> None:
    """Copy the packaged program's kernels to the user's folder, if that has none.

    Numba looks for them in NUMBA_CACHE_DIR, and adds those that were not brought or fit no other processor.
    """
    kernels = Path(os.environ.get("NUMBA_CACHE_DIR", os.curdir))
    if is_packaged() and not kernels.exists():
        # Without them the program compiles its kernels, which takes a minute and nothing else.
        with suppress(OSError):
            _copy_kernels(Path(__file__).parents[1], kernels)


def _copy_kernels(program: Path, kernels: Path) -> None:
    """Copy kernels from folders like those of their modules; all, or none."""
    kernels.parent.mkdir(parents=True, exist_ok=True)
    with tempfile.TemporaryDirectory(dir=kernels.parent) as unfinished:
        copied = Path(unfinished) / "kernels"
        for file in (program / "kernels").rglob("*.nb?"):
            named = copied / numba_folder(program / file.parent.relative_to(program / "kernels"))
            named.mkdir(parents=True, exist_ok=True)
            shutil.copy(file, named)
        if copied.exists():
            copied.rename(kernels)


def numba_folder(modules: Path) -> str:
    """Name of numba's folder in NUMBA_CACHE_DIR for the modules of a folder."""
    return f"{modules.name}_{hashlib.sha1(str(modules).encode()).hexdigest()}"
