"""Installation: its kind, its version, and the folders of its kernels."""

import hashlib
import os
import sys
from functools import cache
from importlib import metadata
from pathlib import Path

import platformdirs

from apd_viewer.errors import InputError
from apd_viewer.language import tr


def is_packaged() -> bool:
    """True in the self-contained program from the installer, without Python or pip."""
    return getattr(sys, "frozen", False)


@cache
def program_version() -> str:
    """Version of the program; "unknown" in a copy of its source that is not installed."""
    try:
        return metadata.version("apd-viewer")
    except metadata.PackageNotFoundError:
        return "unknown"


def missing_extra(what: str, extra: str) -> InputError:
    """InputError where an extra, which ``what`` need, is not installed."""
    said = tr('{what} need more libraries: pip install "apd-viewer[{extra}]".')
    if is_packaged():
        said = tr('{what} need an installation by Python: pip install "apd-viewer[{extra}]".')
    return InputError(said.format(what=what, extra=extra))


def kernel_folders(modules: Path) -> list[Path]:
    """Folders for a package's compiled kernels, in order of preference.

    A folder in NUMBA_CACHE_DIR if set; otherwise the one beside the modules, filled by a wheel, and then the
    user's. The packaged program contains its own.
    """
    named = os.environ.get("NUMBA_CACHE_DIR")
    if named:
        folders = [Path(named) / cache_name(modules)]
    else:
        users = Path(platformdirs.user_cache_dir("apd-viewer", appauthor=False))
        folders = [modules / "__pycache__", users / "kernels" / cache_name(modules)]
    if is_packaged():
        program = Path(__file__).parents[1]
        folders.append(program / "kernels" / modules.relative_to(program))
    return folders


def cache_name(modules: Path) -> str:
    """Name of a package's subfolder in a kernel cache shared by all packages."""
    return f"{modules.name}_{hashlib.sha1(str(modules).encode()).hexdigest()}"
