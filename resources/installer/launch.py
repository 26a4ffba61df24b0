"""Entry point of the installed program, in the place of Python's own.

The program starts its other processes as ``sys.executable -c CODE ARGUMENTS``. Here that is this program,
which therefore understands ``-c`` as Python does.
"""

import multiprocessing
import os
import sys
from pathlib import Path


def main() -> int:
    """Run the command line, or what another process of the program asks for."""
    multiprocessing.freeze_support()  # first: a worker of multiprocessing goes no further
    restore_environment()
    name_console()
    keep_caches()
    if sys.argv[1:2] == ["-c"] and len(sys.argv) > 2:
        return run_code()
    # Here, because the other processes start without it.
    from apd_viewer.__main__ import main

    return main()


def restore_environment() -> None:
    """Let programs of the system, such as a browser, find libraries of their own.

    The bootloader and the hook of Qt have pointed variables at those of this program, which has found them.
    """
    for name in ("QT_PLUGIN_PATH", "QML2_IMPORT_PATH"):
        os.environ.pop(name, None)
    if sys.platform == "linux":
        before = os.environ.pop("LD_LIBRARY_PATH_ORIG", None)
        if before is not None:
            os.environ["LD_LIBRARY_PATH"] = before
        else:
            os.environ.pop("LD_LIBRARY_PATH", None)


def name_console() -> None:
    """Let other processes be started with input and output, which a windowed program of Windows lacks."""
    if sys.platform == "win32":
        sys.executable = str(Path(sys.executable).with_name("apd-viewer.exe"))


def keep_caches() -> None:
    """Have libraries cache in the user's folder: that of the program cannot be written, or must not be.

    Kernels of another build of the program are removed, since numba knows the program's file, and not its
    sources.
    """
    # Here: freeze_support comes before all else.
    import shutil

    import platformdirs

    build = (Path(sys._MEIPASS) / "build").read_text(encoding="ascii")
    caches = Path(platformdirs.user_cache_dir("apd-viewer", appauthor=False))
    kernels = caches / f"kernels-{build}"
    if not kernels.exists():
        for other in caches.glob("kernels-*"):
            shutil.rmtree(other, ignore_errors=True)
    os.environ.setdefault("NUMBA_CACHE_DIR", str(kernels))
    os.environ["MPLCONFIGDIR"] = str(caches / "matplotlib")


def run_code() -> int:
    """Run the code after ``-c``, with the arguments after it."""
    code, sys.argv = sys.argv[2], ["-c", *sys.argv[3:]]
    # The code is the program's own, as that of `python -c`; who may start this program may start Python too.
    exec(code, {"__name__": "__main__", "__builtins__": __builtins__})
    return 0


if __name__ == "__main__":
    sys.exit(main())
